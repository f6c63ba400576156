//! What a user should know of a material that can be used.

use super::constants::Constants;
use sphorge_engine::model::Material;

/// Poisson's ratios of metals: uranium has 0.20, lead 0.44. Beryllium alone has far less, 0.05.
const OF_METALS: (f64, f64) = (0.20, 0.45);

/// How far Poisson's ratio of bulk and shear modulus may be from the one a material states.
const STATED_WITHIN: f64 = 0.03;

/// One sentence for each thing that is probably not meant.
pub(crate) fn advice(constants: &Constants, material: &Material) -> Vec<String> {
    poisson_ratio(constants, material).into_iter().chain(temperature(material)).collect()
}

/// Poisson's ratio of waves: bulk modulus `rho_0 c_0^2` of the pressure law and shear modulus `G` come from different tables, and
/// may belong to different metals. `nu = (3 K - 2 G) / (2 (3 K + G))`.
fn poisson_ratio(constants: &Constants, material: &Material) -> Option<String> {
    let (bulk, shear) =
        (material.density * material.equation_of_state.reference_sound_speed().powi(2), material.shear_modulus);
    if shear == 0.0 {
        return None;
    }
    let nu = (3.0 * bulk - 2.0 * shear) / (2.0 * (3.0 * bulk + shear));
    let given =
        format!("material `{}`: its pressure law and shear modulus give Poisson's ratio {nu:.2}", material.name);
    match constants.elastic.completed().and_then(|elastic| elastic.poisson) {
        Some(stated) => ((nu - stated).abs() > STATED_WITHIN).then(|| {
            format!("{given}, its elastic constants give {stated:.2}: one of them may belong to another metal")
        }),
        None => {
            let (least, most) = OF_METALS;
            (material.flow_law.yields() && !(least..=most).contains(&nu)).then(|| {
                format!(
                    "{given}; metals have {least:.2} to {most:.2}: one of them may belong to another metal; add `poisson-ratio` beside \
                     `shear-modulus` if the value is intended"
                )
            })
        }
    }
}

/// Without a specific heat work does not heat. That is chosen where no work turns to heat at all.
fn temperature(material: &Material) -> Option<String> {
    let isothermal = material.flow_law.depends_on_temperature() && !material.heats() && material.taylor_quinney > 0.0;
    isothermal.then(|| {
        format!(
            "material `{}` has no `specific-heat`: its temperature is constant, and `{}` does not soften with plastic flow; \
             set `taylor-quinney = 0` if this is intended",
            material.name,
            material.flow_law.key()
        )
    })
}

#[cfg(test)]
mod tests {
    use super::super::{build, entry};
    use super::*;

    fn advice_of(constants: &Constants) -> Vec<String> {
        advice(constants, &build("metal", constants).unwrap())
    }

    #[test]
    fn moduli_of_different_metals_are_told() {
        // Armco iron of the papers: K = 7890 3630^2 = 103.97 GPa, G = 80 GPa: 151.90/783.8 = 0.194.
        let iron = entry("armco-iron").unwrap().clone();
        let told = advice_of(&iron);
        assert!(told.len() == 1 && told[0].contains("ratio 0.19; metals have 0.20 to 0.45"), "{told:?}");
        // G = 78 GPa: 155.9/779.8 = 0.1999, G = 77.9 GPa: 156.1/779.6 = 0.2002; G = 10.7 GPa: 0.4504, G = 10.8 GPa: 0.4498.
        for (shear, is_told) in [(78.0e9, true), (77.9e9, false), (10.8e9, false), (10.7e9, true)] {
            let mut other = iron.clone();
            other.elastic.shear = Some(shear);
            assert_eq!(advice_of(&other).len(), usize::from(is_told), "{shear}");
        }
        // Stated, it is what counts: 0.194 is within 0.03 of 0.20, not of 0.29.
        for (poisson, is_told) in [(0.20, false), (0.29, true), (0.16, true)] {
            let mut stated = iron.clone();
            stated.elastic.poisson = Some(poisson);
            let told = advice_of(&stated);
            assert_eq!(told.len(), usize::from(is_told), "{told:?}");
            assert!(told.iter().all(|text| text.contains("ratio 0.19, its elastic constants")), "{told:?}");
        }
        // What never yields is no metal.
        let mut rubber = iron;
        rubber.strength = entry("rubber-plate").unwrap().strength.clone();
        assert_eq!(advice_of(&rubber), Vec::<String>::new());
    }

    #[test]
    fn a_metal_that_cannot_warm_is_told_unless_it_is_meant() {
        let mut copper = entry("ofhc-copper").unwrap().clone();
        assert_eq!(advice_of(&copper), Vec::<String>::new());
        copper.specific_heat = None;
        let told = advice_of(&copper);
        assert!(told.len() == 1 && told[0].contains("`johnson-cook` does not soften"), "{told:?}");
        copper.taylor_quinney = Some(0.0);
        assert_eq!(advice_of(&copper), Vec::<String>::new());
        // A law that temperature does not change needs none.
        copper.taylor_quinney = None;
        copper.strength = entry("copper-piston").unwrap().strength.clone();
        assert_eq!(advice_of(&copper), Vec::<String>::new());
    }
}
