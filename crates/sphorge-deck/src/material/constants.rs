//! Constants of a material in SI units, some or all of them given.

use sphorge_physics::damage::AfterFailure;
use sphorge_physics::return_mapping::ReturnRule;

/// A law and those of its constants that are given.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct LawConstants {
    /// Index into the table of laws.
    pub(crate) law: usize,
    /// Key and value, in the order given.
    pub(crate) values: Vec<(&'static str, f64)>,
}

impl LawConstants {
    pub(crate) fn get(&self, key: &str) -> Option<f64> {
        self.values.iter().find(|(k, _)| *k == key).map(|(_, v)| *v)
    }

    /// The constants of `over` replace ours; another law replaces the whole.
    fn overlaid(mut self, over: &Self) -> Self {
        if self.law != over.law {
            return over.clone();
        }
        self.values.retain(|(key, _)| over.get(key).is_none());
        self.values.extend(over.values.iter().copied());
        self
    }
}

/// The elastic constants; two of them give the others.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ElasticConstants {
    /// G, Pa.
    pub(crate) shear: Option<f64>,
    /// E, Pa.
    pub(crate) young: Option<f64>,
    /// nu.
    pub(crate) poisson: Option<f64>,
    /// K, Pa.
    pub(crate) bulk: Option<f64>,
}

impl ElasticConstants {
    /// How many are given.
    pub(crate) fn count(&self) -> usize {
        [self.shear, self.young, self.poisson, self.bulk].iter().flatten().count()
    }

    /// Keys of those that are given.
    pub(crate) fn keys(&self) -> Vec<&'static str> {
        let all = [
            ("young-modulus", self.young),
            ("shear-modulus", self.shear),
            ("bulk-modulus", self.bulk),
            ("poisson-ratio", self.poisson),
        ];
        all.into_iter().filter_map(|(key, value)| value.map(|_| key)).collect()
    }

    /// The constants of `over` replace ours; two of them define everything, so ours then go.
    fn overlaid(self, over: Self) -> Self {
        if over.count() >= 2 {
            return over;
        }
        Self {
            shear: over.shear.or(self.shear),
            young: over.young.or(self.young),
            poisson: over.poisson.or(self.poisson),
            bulk: over.bulk.or(self.bulk),
        }
    }

    /// All four from two; `None` if fewer are given.
    pub(crate) fn completed(self) -> Option<Self> {
        let (young, poisson) = match self {
            Self { young: Some(e), poisson: Some(nu), .. } => (e, nu),
            Self { young: Some(e), shear: Some(g), .. } => (e, e / (2.0 * g) - 1.0),
            Self { poisson: Some(nu), shear: Some(g), .. } => (2.0 * g * (1.0 + nu), nu),
            Self { shear: Some(g), bulk: Some(k), .. } => {
                (9.0 * k * g / (3.0 * k + g), (3.0 * k - 2.0 * g) / (2.0 * (3.0 * k + g)))
            }
            Self { young: Some(e), bulk: Some(k), .. } => (e, 0.5 - e / (6.0 * k)),
            Self { poisson: Some(nu), bulk: Some(k), .. } => (3.0 * k * (1.0 - 2.0 * nu), nu),
            _ => return None,
        };
        Some(Self {
            shear: self.shear.or(Some(young / (2.0 * (1.0 + poisson)))),
            young: Some(young),
            poisson: Some(poisson),
            bulk: self.bulk.or(Some(young / (3.0 * (1.0 - 2.0 * poisson)))),
        })
    }
}

/// Over what integrity is lost; one of them may be given.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Softening {
    /// Plastic work of a crack, J/m².
    pub(crate) energy: Option<f64>,
    /// Its plastic opening, m.
    pub(crate) displacement: Option<f64>,
    /// Share of the failure strain.
    pub(crate) share: Option<f64>,
}

impl Softening {
    /// How many are given.
    pub(crate) fn count(&self) -> usize {
        [self.energy, self.displacement, self.share].iter().flatten().count()
    }
}

/// Constants of a material; what is `None` is not given.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Constants {
    pub(crate) description: Option<String>,
    pub(crate) reference: Option<String>,
    pub(crate) note: Option<String>,
    /// kg/m³.
    pub(crate) density: Option<f64>,
    pub(crate) elastic: ElasticConstants,
    pub(crate) equation_of_state: Option<LawConstants>,
    pub(crate) strength: Option<LawConstants>,
    pub(crate) return_rule: Option<ReturnRule>,
    /// J/(kg K).
    pub(crate) specific_heat: Option<f64>,
    /// W/(m K).
    pub(crate) conductivity: Option<f64>,
    pub(crate) taylor_quinney: Option<f64>,
    /// Pa, positive.
    pub(crate) spall_pressure: Option<f64>,
    /// m.
    pub(crate) spall_opening: Option<f64>,
    /// Law of damage, which counts if the material breaks.
    pub(crate) damage: Option<LawConstants>,
    /// Whether the material breaks by it.
    pub(crate) breaks: bool,
    pub(crate) minimum_failure_strain: Option<f64>,
    pub(crate) softening: Softening,
    pub(crate) after_failure: Option<AfterFailure>,
    /// K.
    pub(crate) reference_temperature: Option<f64>,
    /// Inertia over that of the material.
    pub(crate) mass_scaling: Option<f64>,
}

impl Constants {
    /// These constants with those of `over` in their place where it gives any.
    pub(crate) fn overlaid(self, over: &Self) -> Self {
        let law = |base: Option<LawConstants>, over: &Option<LawConstants>| match (base, over) {
            (Some(base), Some(over)) => Some(base.overlaid(over)),
            (base, over) => over.clone().or(base),
        };
        Self {
            description: over.description.clone().or(self.description),
            reference: over.reference.clone().or(self.reference),
            note: over.note.clone().or(self.note),
            density: over.density.or(self.density),
            elastic: self.elastic.overlaid(over.elastic),
            equation_of_state: law(self.equation_of_state, &over.equation_of_state),
            strength: law(self.strength, &over.strength),
            return_rule: over.return_rule.or(self.return_rule),
            specific_heat: over.specific_heat.or(self.specific_heat),
            conductivity: over.conductivity.or(self.conductivity),
            taylor_quinney: over.taylor_quinney.or(self.taylor_quinney),
            spall_pressure: over.spall_pressure.or(self.spall_pressure),
            spall_opening: over.spall_opening.or(self.spall_opening),
            damage: law(self.damage, &over.damage),
            breaks: self.breaks || over.breaks,
            minimum_failure_strain: over.minimum_failure_strain.or(self.minimum_failure_strain),
            softening: if over.softening.count() > 0 { over.softening } else { self.softening },
            after_failure: over.after_failure.or(self.after_failure),
            reference_temperature: over.reference_temperature.or(self.reference_temperature),
            mass_scaling: over.mass_scaling.or(self.mass_scaling),
        }
    }

    /// The constants with more mass and the same moduli, strengths and heat capacity per volume: what of them is per mass, or has a mass in it.
    pub(crate) fn with_scaled_mass(mut self) -> Self {
        let factor = self.mass_scaling.unwrap_or(1.0);
        self.density = self.density.map(|density| density * factor);
        self.specific_heat = self.specific_heat.map(|heat| heat / factor);
        let of_pressure = self.equation_of_state.iter_mut().flat_map(|law| &mut law.values);
        for (key, value) in of_pressure {
            match *key {
                "density" => *value *= factor,
                "sound-speed" => *value /= factor.sqrt(),
                _ => {}
            }
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: Option<f64>, b: f64) -> bool {
        (a.unwrap() / b - 1.0).abs() < 1e-12
    }

    #[test]
    fn any_two_elastic_constants_give_the_same_four() {
        // Steel: E 210 GPa, nu 0.3.
        let (e, nu) = (210e9, 0.3);
        let (g, k) = (e / 2.6, e / 1.2);
        let none = ElasticConstants::default();
        for pair in [
            ElasticConstants { young: Some(e), poisson: Some(nu), ..none },
            ElasticConstants { young: Some(e), shear: Some(g), ..none },
            ElasticConstants { young: Some(e), bulk: Some(k), ..none },
            ElasticConstants { poisson: Some(nu), shear: Some(g), ..none },
            ElasticConstants { poisson: Some(nu), bulk: Some(k), ..none },
            ElasticConstants { shear: Some(g), bulk: Some(k), ..none },
        ] {
            let all = pair.completed().unwrap();
            assert!(
                close(all.young, e) && close(all.poisson, nu) && close(all.shear, g) && close(all.bulk, k),
                "{pair:?}"
            );
        }
        assert!(ElasticConstants { bulk: Some(k), ..none }.completed().is_none());
    }

    #[test]
    fn another_law_replaces_and_the_same_law_is_changed_in_part() {
        let base = LawConstants { law: 3, values: vec![("A", 1.0), ("B", 2.0)] };
        let part = base.clone().overlaid(&LawConstants { law: 3, values: vec![("B", 5.0)] });
        assert_eq!((part.get("A"), part.get("B")), (Some(1.0), Some(5.0)));
        let other = LawConstants { law: 1, values: vec![("B", 5.0)] };
        assert_eq!(base.overlaid(&other), other);
    }
}
