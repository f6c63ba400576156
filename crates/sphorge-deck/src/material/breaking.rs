//! What of the way a material breaks is probably not meant.

use sphorge_engine::model::Material;
use sphorge_physics::SymmetricTensor;
use sphorge_physics::damage::{DamageState, Softening};

/// Largest triaxiality that is looked at: notches and the front of cracks have less.
const LARGEST_TRIAXIALITY: f64 = 3.0;

/// What of the way a material breaks is probably not meant; failure strains are looked at where the law is plausible.
pub(super) fn breaking(material: &Material, is_plausible: bool) -> Vec<String> {
    let Some(damage) = material.damage else { return Vec::new() };
    let (name, law) = (&material.name, damage.law.key());
    let mut told = Vec::new();
    let of_stress = damage.law.strength().is_some();
    if !of_stress && !material.flow_law.yields() {
        told.push(format!(
            "material `{name}`: `damage = \"{law}\"` grows with the plastic strain, which `strength = \"{}\"` has none of: it never breaks",
            material.flow_law.key()
        ));
    }
    let pulled = |triaxiality: f64| DamageState {
        deviator: SymmetricTensor::diagonal(2.0 / 3.0, -1.0 / 3.0, -1.0 / 3.0),
        pressure: -triaxiality,
        von_mises: 1.0,
        triaxiality,
        rate: 0.0,
        temperature: material.reference_temperature,
    };
    let is_least = |triaxiality: &f64| damage.law.growth(&pulled(*triaxiality)) * damage.smallest_strain > 1.0;
    let first = (0..=300).map(|k| f64::from(k) * LARGEST_TRIAXIALITY / 300.0).find(is_least);
    if let Some(triaxiality) = first.filter(|_| !of_stress && is_plausible) {
        told.push(format!(
            "material `{name}`: from a triaxiality of {triaxiality:.2} on the failure strain of `{law}` is below \
             `minimum-failure-strain`, {}, which counts there",
            damage.smallest_strain
        ));
    }
    if let Softening::Share(_) = damage.softening {
        told.push(format!(
            "material `{name}`: what a crack takes depends on the spacing, because its integrity falls over a share of the failure strain: give \
             `fracture-energy` or `softening-displacement`, or compare several spacings"
        ));
    }
    told
}

#[cfg(test)]
mod tests {
    use super::super::constants::Constants;
    use super::super::{advice, build, entry};

    fn advice_of(constants: &Constants) -> Vec<String> {
        advice(constants, &build("metal", constants).unwrap())
    }

    #[test]
    fn what_is_doubtful_about_breaking_is_told() {
        let law = |key: &str, values: &[(&'static str, f64)]| {
            let law = sphorge_physics::damage::DAMAGE_LAWS.iter().position(|entry| entry.key == key).unwrap();
            Some(super::super::constants::LawConstants { law, values: values.to_vec() })
        };
        let mut copper = entry("ofhc-copper").unwrap().clone();
        (copper.damage, copper.breaks) = (law("failure-strain", &[("strain", 0.5)]), true);
        let told = advice_of(&copper);
        assert!(told.len() == 1 && told[0].contains("what a crack takes depends on the spacing"), "{told:?}");
        copper.softening.energy = Some(2e4);
        assert_eq!(advice_of(&copper), Vec::<String>::new());
        // -0.77 + 1.45 exp(-0.47 eta) is 0.05 at eta = 1.213, and 0.001 at 1.345.
        copper.damage = law("johnson-cook", &[("D1", -0.77), ("D2", 1.45), ("D3", -0.47)]);
        let told = advice_of(&copper);
        assert!(told.len() == 1 && told[0].contains("from a triaxiality of 1.35 on"), "{told:?}");
        copper.minimum_failure_strain = Some(0.05);
        assert!(advice_of(&copper)[0].contains("from a triaxiality of 1.22 on"), "{:?}", advice_of(&copper));
        let mut rubber = entry("copper-elastic").unwrap().clone();
        (rubber.damage, rubber.breaks, rubber.softening.energy) = (law("hancock-mackenzie", &[]), true, Some(1e3));
        let told = advice_of(&rubber);
        assert!(told.len() == 1 && told[0].contains("it never breaks"), "{told:?}");
        rubber.damage = law("principal-stress", &[("strength", 1e9)]);
        assert_eq!(advice_of(&rubber), Vec::<String>::new());
    }
}
