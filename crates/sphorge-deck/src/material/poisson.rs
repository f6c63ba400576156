//! Poisson's ratios that no metal has, or that make it hard to compute.

use super::constants::Constants;
use sphorge_engine::model::Material;

/// Poisson's ratios of metals: uranium has 0.20, lead 0.44, indium and thallium up to 0.47. Beryllium alone has far less, 0.05.
pub(super) const OF_METALS: (f64, f64) = (0.20, 0.47);
/// Those of what is lighter or stiffer than metals: diamond 0.07, ceramics and rocks 0.1 to 0.3, polymers in waves up to 0.49.
const OF_OTHERS: (f64, f64) = (0.0, 0.495);
/// Density, kg/m^3, up to which matter is no usual metal but polymer, glass, rock, beryllium or magnesium; aluminium alloys have 2650.
const LIGHT: f64 = 2600.0;
/// Speed of shear waves, m/s, that of metals beryllium alone exceeds: chromium has 4.0 km/s, ceramics 6 to 9.
const STIFF: f64 = 4200.0;
/// Shear modulus, Pa, up to which light matter is a polymer.
const POLYMER: f64 = 5e9;

/// Poisson's ratios that matter of a density and a shear modulus has.
fn usual(material: &Material) -> (f64, f64) {
    let is_stiff = material.shear_modulus > STIFF * STIFF * material.density;
    if material.density < LIGHT || is_stiff { OF_OTHERS } else { OF_METALS }
}

/// How much higher that of waves may be in polymers, which are stiffer in shocks than in tests: polyethylene and PMMA by 0.05 and 0.08.
const STATED_OF_POLYMER: f64 = 0.12;

/// How far Poisson's ratio of bulk and shear modulus may be from the one a material states, and how far where it shows which unit is meant.
pub(super) const STATED_WITHIN: f64 = 0.03;
pub(super) const STATED_NEARLY: f64 = 0.1;

/// Poisson's ratio of waves: bulk modulus `rho_0 c_0^2` of the pressure law and shear modulus `G` come from different tables, and
/// may belong to different metals. `nu = (3 K - 2 G) / (2 (3 K + G))`.
pub(super) fn ratio_of_waves(material: &Material) -> f64 {
    let (bulk, shear) =
        (material.density * material.equation_of_state.reference_sound_speed().powi(2), material.shear_modulus);
    (3.0 * bulk - 2.0 * shear) / (2.0 * (3.0 * bulk + shear))
}

/// That ratio where it is none of a metal, or not the one a material states.
pub(super) fn poisson_ratio(constants: &Constants, material: &Material) -> Option<String> {
    if material.shear_modulus == 0.0 {
        return None;
    }
    let nu = ratio_of_waves(material);
    let given =
        format!("material `{}`: its pressure law and shear modulus give Poisson's ratio {nu:.2}", material.name);
    match constants.elastic.completed().and_then(|elastic| elastic.poisson) {
        Some(stated) => {
            let is_polymer = material.density < LIGHT && material.shear_modulus < POLYMER;
            let above = if is_polymer { STATED_OF_POLYMER } else { STATED_WITHIN };
            (!(-STATED_WITHIN..=above).contains(&(nu - stated))).then(|| {
                format!("{given}, its elastic constants give {stated:.2}: one of them may belong to another material")
            })
        }
        None => {
            let (least, most) = usual(material);
            let whose = if (least, most) == OF_METALS { "metals have" } else { "solids have" };
            (material.flow_law.yields() && !(least..=most).contains(&nu)).then(|| {
                format!(
                    "{given}; {whose} {least:.2} to {most:.2}: one of them may belong to another material; add `poisson-ratio` beside \
                     `shear-modulus` if the value is intended"
                )
            })
        }
    }
}

/// Poisson's ratio below which a stated one is none of a metal: that of uranium is 0.20.
const LEAST_STATED: f64 = 0.1;

/// A stated Poisson's ratio that is positive and below that of any metal. Zero leaves the coupling out, as in problems along a line.
pub(super) fn small_poisson_ratio(constants: &Constants, material: &Material) -> Option<String> {
    let nu = constants.elastic.poisson?;
    (nu > 0.0 && nu < LEAST_STATED && usual(material) == OF_METALS).then(|| {
        format!(
            "material `{}`: its Poisson's ratio of {} is below that of any metal: metals have {:.2} to {:.2}",
            material.name,
            super::shown(nu, ""),
            OF_METALS.0,
            OF_METALS.1
        )
    })
}

/// Poisson's ratio above which a material hardly changes its volume: metals have less than 0.45, and 0.49 is enough for rubber.
const NEARLY_INCOMPRESSIBLE: f64 = 0.49;

/// A stated Poisson's ratio near one half, which makes bulk modulus and speed of sound of any size.
pub(super) fn nearly_incompressible(constants: &Constants, material: &Material) -> Option<String> {
    let nu = constants.elastic.completed()?.poisson?;
    let ratio = material.density * material.equation_of_state.reference_sound_speed().powi(2) / material.shear_modulus;
    // Else the pressure law has a bulk modulus of its own.
    let is_of_it = material.shear_modulus > 0.0 && ratio_of_waves(material) > NEARLY_INCOMPRESSIBLE;
    let waves = ((ratio + 4.0 / 3.0) / (2.0 * 1.3 / (3.0 * 0.4) + 4.0 / 3.0)).sqrt();
    (nu > NEARLY_INCOMPRESSIBLE && is_of_it).then(|| {
        format!(
            "material `{}`: its Poisson's ratio of {} is that of something nearly incompressible: the bulk modulus is {ratio:.0} times the shear \
             modulus, time steps are {waves:.0} times as short as at 0.3, and particles lock; metals have {:.2} to {:.2}, and {NEARLY_INCOMPRESSIBLE} \
             is enough for rubber",
            material.name,
            super::shown(nu, ""),
            OF_METALS.0,
            OF_METALS.1
        )
    })
}

#[cfg(test)]
mod tests {
    use super::super::constants::LawConstants;
    use super::super::{advice, build, entry};
    use super::*;
    use sphorge_physics::flow::FLOW_LAWS;

    fn advice_of(constants: &Constants) -> Vec<String> {
        advice(constants, &build("metal", constants).unwrap())
    }

    #[test]
    fn moduli_of_different_metals_are_told() {
        // Armco iron of the papers: K = 7890 3630^2 = 103.97 GPa, G = 80 GPa: 151.90/783.8 = 0.194.
        let iron = entry("armco-iron").unwrap().clone();
        let told = advice_of(&iron);
        assert!(told.len() == 1 && told[0].contains("ratio 0.19; metals have 0.20 to 0.47"), "{told:?}");
        // G = 78 GPa: 155.9/779.8 = 0.1999, G = 77.9 GPa: 156.1/779.6 = 0.2002; G = 6.36 GPa: 0.4700, G = 6.3 GPa: 0.4703, G = 6.4 GPa: 0.4698.
        for (shear, is_told) in [(78.0e9, true), (77.9e9, false), (6.4e9, false), (6.3e9, true)] {
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

    /// Solids by published constants: density, sound speed and slope of shocks, shear modulus, yield stress, stated Poisson's ratio.
    #[test]
    fn published_constants_of_solids_hear_nothing() {
        for (name, density, sound, slope, shear, yields, stated) in [
            // Steinberg (1996): K = 1850 7998^2 = 118.3 GPa, G = 151 GPa: 52.9/1011.8 = 0.052.
            ("beryllium", 1850.0, 7998.0, 1.124, 151e9, 0.33e9, None),
            ("beryllium with its ratio", 1850.0, 7998.0, 1.124, 144e9, 0.33e9, Some(0.05)),
            // Marsh (1980): K = 915 2901^2 = 7.7 GPa; tests give G = 0.38 GPa and 0.42: 22.3/46.9 = 0.476.
            ("polyethylene", 915.0, 2901.0, 1.481, 0.38e9, 25e6, None),
            ("polyethylene with its ratio", 915.0, 2901.0, 1.481, 0.38e9, 25e6, Some(0.42)),
            ("soft polyethylene", 915.0, 2901.0, 1.481, 0.1e9, 10e6, None),
            ("PMMA", 1186.0, 2598.0, 1.516, 1.15e9, 70e6, Some(0.35)),
            ("polytetrafluoroethylene", 2150.0, 1841.0, 1.707, 0.2e9, 15e6, None),
            ("indium", 7279.0, 2419.0, 1.536, 4e9, 5e6, None),
            ("lead", 11340.0, 2051.0, 1.46, 8.6e9, 8e6, None),
            ("chromium", 7117.0, 5173.0, 1.473, 115e9, 0.3e9, None),
            ("boron carbide", 2510.0, 9600.0, 0.9, 197e9, 10e9, None),
            ("silicon carbide", 3215.0, 8000.0, 0.95, 193e9, 8e9, None),
            ("fused silica", 2204.0, 4100.0, 1.0, 31e9, 3e9, None),
        ] {
            let mut solid = entry("ofhc-copper").unwrap().clone();
            (solid.density, solid.elastic) = (Some(density), Default::default());
            (solid.elastic.shear, solid.elastic.poisson) = (Some(shear), stated);
            let law = FLOW_LAWS.iter().position(|entry| entry.key == "perfectly-plastic").unwrap();
            solid.strength = Some(LawConstants { law, values: vec![("yield-stress", yields)] });
            let law = solid.equation_of_state.as_mut().unwrap();
            law.values = vec![("sound-speed", sound), ("shock-slope", slope), ("gruneisen", 1.2)];
            assert_eq!(advice_of(&solid), Vec::<String>::new(), "{name}");
        }
    }

    #[test]
    fn a_ratio_below_that_of_any_metal_is_told_unless_it_is_of_another_matter() {
        let of = |poisson: f64, density: f64| {
            let mut solid = entry("copper-elastic").unwrap().clone();
            (solid.elastic.poisson, solid.density) = (Some(poisson), Some(density));
            advice_of(&solid)
        };
        let told = of(0.03, 8960.0);
        assert!(told.len() == 1 && told[0].contains("ratio of 0.03 is below that of any metal"), "{told:?}");
        for (poisson, density) in [(0.0, 8960.0), (0.1, 8960.0), (0.3, 8960.0), (0.03, 240.0)] {
            assert_eq!(of(poisson, density), Vec::<String>::new(), "{poisson} {density}");
        }
    }

    #[test]
    fn a_ratio_near_one_half_is_named_and_not_what_follows_from_it() {
        let of = |poisson: f64, strength: &str, change: &dyn Fn(&mut Constants)| {
            let mut solid = entry("copper-elastic").unwrap().clone();
            solid.elastic.poisson = Some(poisson);
            solid.strength = entry(strength).unwrap().strength.clone();
            change(&mut solid);
            advice_of(&solid)
        };
        for strength in ["copper-elastic", "steel-fraser"] {
            // K/G = 2 (1 + nu)/(3 (1 - 2 nu)) = 2.9998/6e-4; sqrt((4999.7 + 4/3)/(2.1667 + 4/3)) = 37.8.
            let told = of(0.4999, strength, &|_| {});
            assert!(told.len() == 1 && told[0].contains("Poisson's ratio of 0.4999 is that"), "{told:?}");
            assert!(
                told[0].contains("is 5000 times the shear") && told[0].contains("are 38 times as short"),
                "{told:?}"
            );
            for (poisson, is_told) in [(0.45, false), (0.4899, false), (0.4901, true), (0.495, true)] {
                assert_eq!(of(poisson, strength, &|_| {}).len(), usize::from(is_told), "{poisson}");
            }
        }
        // A pressure law with a bulk modulus of its own contradicts it: that is what is told.
        let told = of(0.4999, "copper-elastic", &|c| {
            c.equation_of_state = entry("copper-shock").unwrap().equation_of_state.clone()
        });
        assert!(told.len() == 1 && told[0].contains("its pressure law and shear modulus give"), "{told:?}");
    }
}
