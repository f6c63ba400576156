//! The constants of a material as written, in SI units.

use super::constants::{Constants, ElasticConstants, LawConstants, Softening};
use crate::fault::{Fault, Problems};
use crate::raw::{LawTable, RawLaw, RawMaterial};
use crate::suggest::listed;
use crate::value::{Choice, Given, Kind, ScalarOr, Word};
use sphorge_physics::parameter::Bound;
use std::{collections::BTreeMap, ops::Range};

/// Poisson's ratios that can be computed with.
const POISSON: Bound = Bound::Between(-0.999, 0.4999);
const POISSON_HELP: &str = "metals have 0.20 to 0.47; 0.5 does not change its volume at all, and its bulk modulus is infinite: 0.49 is enough for rubber";

/// Constants in SI units; faults leave their key out.
pub(crate) fn constants(raw: &RawMaterial, problems: &mut Problems) -> Constants {
    fn read<K: Kind>(given: &Option<Given<K>>, bound: Bound, problems: &mut Problems) -> Option<f64> {
        given.as_ref().and_then(|g| g.within(bound, problems))
    }
    fn text(given: &Option<Word>, problems: &mut Problems) -> Option<String> {
        given.as_ref().and_then(|w| w.text(problems)).map(str::to_owned)
    }
    Constants {
        description: text(&raw.description, problems),
        reference: text(&raw.reference, problems),
        note: text(&raw.note, problems),
        density: read(&raw.density, Bound::Positive, problems),
        elastic: ElasticConstants {
            shear: read(&raw.shear_modulus, Bound::Positive, problems),
            young: read(&raw.young_modulus, Bound::Positive, problems),
            poisson: raw.poisson_ratio.as_ref().and_then(|ratio| ratio.within_saying(POISSON, POISSON_HELP, problems)),
            bulk: read(&raw.bulk_modulus, Bound::Positive, problems),
        },
        equation_of_state: raw.equation_of_state.as_ref().and_then(|l| law(l, problems)),
        strength: raw.strength.as_ref().and_then(|l| law(l, problems)),
        return_rule: raw.return_rule.as_ref().and_then(|r| r.get(problems)),
        specific_heat: read(&raw.specific_heat, Bound::Positive, problems),
        conductivity: read(&raw.conductivity, Bound::NonNegative, problems),
        taylor_quinney: read(&raw.taylor_quinney, Bound::Between(0.0, 1.0), problems),
        spall_pressure: read(&raw.spall_pressure, Bound::Positive, problems),
        spall_opening: read(&raw.spall_opening, Bound::Positive, problems),
        damage: raw.damage.as_ref().and_then(|l| law(l, problems)),
        breaks: raw.damage.is_some(),
        minimum_failure_strain: read(&raw.minimum_failure_strain, Bound::Positive, problems),
        softening: Softening {
            energy: read(&raw.fracture_energy, Bound::Positive, problems),
            displacement: read(&raw.softening_displacement, Bound::Positive, problems),
            share: read(&raw.softening, Bound::Positive, problems),
        },
        after_failure: raw.after_failure.as_ref().and_then(|r| r.get(problems)),
        reference_temperature: read(&raw.reference_temperature, Bound::NonNegative, problems),
        mass_scaling: read(&raw.mass_scaling, Bound::Between(1.0, 1e8), problems),
    }
}

fn law<C: LawTable>(raw: &RawLaw<C>, problems: &mut Problems) -> Option<LawConstants> {
    let (table, at) = match raw {
        ScalarOr::Scalar(word) => {
            return Choice::get(word, problems).map(|law| LawConstants { law, values: Vec::new() });
        }
        ScalarOr::Composed(table, at) => (&table.0, at.clone()),
    };
    let names = || C::table().into_iter().map(|entry| entry.0);
    let mut laws = table.0.iter();
    let (Some((key, given)), None) = (laws.next(), laws.next()) else {
        let message = format!("expected one {}", C::WHAT);
        let found = if table.0.is_empty() { "none here".to_owned() } else { format!("{} here", table.0.len()) };
        let fault = Fault::new("exactly-one", message, at, found).help(format!("choose {}", listed(names(), "or")));
        problems.push(fault.if_its_entry_is_whole());
        return None;
    };
    // Other laws, and constants of others, are no keys of the deck: that has been told.
    let law = C::ENTRIES.iter().position(|entry| entry.key == key.get_ref())?;
    let parameters = C::ENTRIES[law].parameters;
    let mut values = Vec::with_capacity(given.0.len());
    for (key, value) in &given.0 {
        if let Some(p) = parameters.iter().find(|p| p.key == key.get_ref())
            && let Some(number) = value.bounded(p.quantity.into(), p.bound, problems)
        {
            values.push((p.key, number));
        }
    }
    Some(LawConstants { law, values })
}

/// Where the keys of a material stand that faults and notes speak of: `young-modulus`, and `strength.B` for a constant of its law.
pub(crate) fn places(raw: &RawMaterial) -> BTreeMap<String, Range<usize>> {
    fn of<K: Kind>(given: &Option<Given<K>>) -> Option<Range<usize>> {
        given.as_ref().map(Given::span)
    }
    let keys = [
        ("density", of(&raw.density)),
        ("young-modulus", of(&raw.young_modulus)),
        ("shear-modulus", of(&raw.shear_modulus)),
        ("bulk-modulus", of(&raw.bulk_modulus)),
        ("poisson-ratio", of(&raw.poisson_ratio)),
        ("reference-temperature", of(&raw.reference_temperature)),
        ("minimum-failure-strain", of(&raw.minimum_failure_strain)),
        ("fracture-energy", of(&raw.fracture_energy)),
        ("softening-displacement", of(&raw.softening_displacement)),
        ("softening", of(&raw.softening)),
        ("specific-heat", of(&raw.specific_heat)),
        ("conductivity", of(&raw.conductivity)),
        ("taylor-quinney", of(&raw.taylor_quinney)),
        ("mass-scaling", of(&raw.mass_scaling)),
        ("spall-pressure", of(&raw.spall_pressure)),
        ("spall-opening", of(&raw.spall_opening)),
        ("after-failure", raw.after_failure.as_ref().map(Choice::span)),
    ];
    let mut places: BTreeMap<_, _> =
        keys.into_iter().filter_map(|(key, place)| Some((key.to_owned(), place?))).collect();
    law_places("equation-of-state", &raw.equation_of_state, &mut places);
    law_places("strength", &raw.strength, &mut places);
    law_places("damage", &raw.damage, &mut places);
    places
}

fn law_places<C: LawTable>(key: &str, raw: &Option<RawLaw<C>>, places: &mut BTreeMap<String, Range<usize>>) {
    let Some(raw) = raw else { return };
    let place = match raw {
        ScalarOr::Scalar(word) => word.span(),
        ScalarOr::Composed(table, _) => {
            let Some((law, given)) = table.0.0.first() else { return };
            let constants = given.0.iter().map(|(constant, value)| (constant, value.span.clone()));
            places.extend(constants.map(|(constant, at)| (format!("{key}.{}", constant.get_ref()), at)));
            law.span()
        }
    };
    places.insert(key.to_owned(), place);
}
