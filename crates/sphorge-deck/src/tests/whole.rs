//! Properties of all decks: stated defaults are real, the schema accepts what is shipped, nothing panics.

use super::super::*;
use super::{FLAVOUR, changed};
use crate::fault::Problems;
use crate::keys::{DECK, toml_text};
use proptest::prelude::*;

/// A deck in which every table that has defaults stands.
const EVERYTHING: &str = include_str!("decks/everything.toml");

/// Shapes, measures and columns the others lack.
const SHAPES: &str = include_str!("decks/shapes.toml");

fn model(deck: &str, overrides: &[(String, String)]) -> String {
    let setup = load_text("deck", deck, overrides).unwrap_or_else(|report| panic!("{report}\n{:?}", report.problems()));
    format!("{:?}", setup.model)
}

/// Every default stated for the keys of a table, as overrides.
fn stated(path: &str) -> Vec<(String, String)> {
    let mut expected = DECK;
    for segment in path.split('.').filter(|s| !s.is_empty()) {
        let entry = segment.parse().ok().map(|index| expected.item(index).unwrap());
        expected = entry.unwrap_or_else(|| expected.key(segment).unwrap().0);
    }
    let named = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    let plain = |value: &serde_json::Value| !value.is_null() && !value.is_array() && !value.is_object();
    let defaults =
        expected.keys().iter().filter_map(|key| Some((named(key.name), toml_text(&key.default().filter(plain)?))));
    defaults.collect()
}

#[test]
fn stated_defaults_are_the_real_ones() {
    let tables = [
        "",
        "particles",
        "numerics",
        "numerics.viscosity",
        "time.step-control",
        "output",
        "wall.soft.contact.penalty",
        "symmetry.0",
        "material.mine",
        "measure.hottest.maximum",
        "measure.speed.front-speed",
    ];
    let plain = model(EVERYTHING, &[]);
    for table in tables {
        let defaults = stated(&table.replace("soft", "0").replace("hottest", "0").replace("speed.", "1."));
        assert!(!defaults.is_empty(), "{table} states no defaults");
        assert_eq!(model(EVERYTHING, &defaults), plain, "{table}: {defaults:?}");
    }
    let on = ("numerics.artificial-stress".to_owned(), "true".to_owned());
    let spelled = stated("numerics.artificial-stress");
    assert_eq!(spelled.len(), 2);
    assert_eq!(model(EVERYTHING, &spelled), model(EVERYTHING, &[on]));
    let on = ("search".to_owned(), "skin".to_owned());
    let spelled = stated("search.skin");
    assert_eq!(spelled.len(), 1);
    assert_eq!(model(EVERYTHING, &spelled), model(EVERYTHING, &[on]));
    for (strategy, count) in [("adaptive", 4), ("total-lagrangian", 5)] {
        let on = ("search".to_owned(), strategy.to_owned());
        let spelled = stated(&format!("search.{strategy}"));
        assert_eq!(spelled.len(), count);
        assert_eq!(model(EVERYTHING, &spelled), model(EVERYTHING, &[on]));
    }
    let on = ("thermal".to_owned(), "{}".to_owned());
    let spelled = stated("thermal");
    assert_eq!(spelled.len(), 2);
    assert_eq!(model(EVERYTHING, &spelled), model(EVERYTHING, &[on]));
    let on = ("contact".to_owned(), "penalty".to_owned());
    // Stiffness and damping are others at facets.
    let spelled = stated("contact.penalty");
    assert_eq!(spelled.len(), 1);
    assert_eq!(model(EVERYTHING, &spelled), model(EVERYTHING, &[on]));
}

#[test]
fn a_method_is_the_sum_of_its_choices() {
    let of = |overrides: &[(&str, &str)]| {
        let overrides: Vec<_> = overrides.iter().map(|&(path, value)| (path.to_owned(), value.to_owned())).collect();
        model(EVERYTHING, &overrides)
    };
    let walls = [("wall.soft.contact", "monaghan-kos"), ("wall.hard.contact", "monaghan-kos")];
    let (stress, xsph) = ("numerics.artificial-stress", ("numerics.xsph", "0.5"));
    let plain = of(&[&walls[..], &[("search", "skin"), ("contact", "kernel-sum")]].concat());
    // What a deck gets where it says nothing, and what it says with a search among the current neighbours.
    assert_eq!(of(&[]), of(&[("method", "total-lagrangian")]));
    assert_eq!(of(&[("search", "skin")]), of(&[("method", "updated-lagrangian")]));
    assert_eq!(of(&[("wall.soft.contact", "monaghan-kos"), ("search", "skin")]), plain);
    for (method, choices) in [
        (
            "patino",
            [
                ("search", "every-step"),
                ("numerics.integrator", "predictor-corrector"),
                (stress, "{ epsilon = 0.3, exponent = 4 }"),
                xsph,
            ],
        ),
        (
            "fraser",
            [
                ("search", "adaptive"),
                ("numerics.integrator", "leapfrog"),
                (stress, "{ epsilon = 0.3, exponent = 6 }"),
                xsph,
            ],
        ),
    ] {
        assert_eq!(of(&[("method", method)]), of(&choices), "{method}");
        // A key of the deck takes the place of the method's.
        assert_eq!(
            of(&[("method", method), ("numerics.xsph", "0.2")]),
            of(&[&choices[..3], &[("numerics.xsph", "0.2")]].concat())
        );
        let off = [("method", method), (stress, "false"), ("search", "skin")];
        assert_eq!(of(&off), of(&[("search", "skin"), choices[1], xsph]), "{method}");
        // What belongs to the form goes with the form.
        assert_eq!(of(&[("method", method), ("search", "total-lagrangian")]), of(&[]), "{method}");
    }
}

#[test]
fn overrides_are_part_of_the_deck_as_run() {
    let set = |path: &str, value: &str| (path.to_owned(), value.to_owned());
    let overrides = [
        set("particles.spacing", "0.6 mm"),
        set("body.bar.velocity.1", "-300 m/s"),
        set("material.armco-iron.density", "8 g/cm3"),
    ];
    let setup = load_text("deck", FLAVOUR, &overrides).unwrap();
    assert_eq!(setup.model.spacing, 0.6e-3);
    assert_eq!(setup.particles.velocity[0][1], -300.0);
    // A material changed in part keeps the rest of the catalogue's.
    assert_eq!((setup.model.materials[0].density, setup.model.materials[0].shear_modulus), (8000.0, 80e9));
    let again = load_text("deck", &setup.deck_text, &[]).unwrap();
    assert_eq!(format!("{:?}", again.model), format!("{:?}", setup.model));
}

#[test]
fn of_many_bad_overrides_as_many_are_told_as_of_a_deck() {
    let overrides: Vec<_> = (0..25).map(|k| (format!("particles.key{k}"), "1 mm".to_owned())).collect();
    let report = load_text("deck", FLAVOUR, &overrides).unwrap_err();
    assert_eq!(report.to_string(), "25 faults in deck, with --set, the first 20 are");
    assert_eq!(miette::Diagnostic::related(&report).unwrap().count(), 20);
    assert_eq!(report.problems()[24].to_string(), "unknown key `key24` in `particles`");
}

#[test]
fn overrides_of_a_deck_that_is_no_toml_are_not_lost() {
    // 2^63 fits no integer of TOML.
    let deck = changed("smoothing = 1.2", "smoothing = 9223372036854775808");
    for overrides in [vec![], vec![("particles.spacing".to_owned(), "0.6 mm".to_owned())]] {
        let report = load_text("deck", &deck, &overrides).err().unwrap();
        assert_eq!((report.problems()[0].code(), report.problems()[0].line()), ("toml", Some(8)));
    }
}

/// Reads a deck, and fills it if it is small.
fn survive(text: &str) {
    let mut problems = Problems::new("deck", text);
    if let Ok(interpret::Interpreted { model, .. }) = load::read_model("deck", &mut problems)
        && sphorge_engine::geometry::estimated_count(&model).iter().sum::<f64>() < 2e4
    {
        let _ = sphorge_engine::geometry::fill(&model, 2e4);
    }
}

fn cut(text: &str, at: usize) -> usize {
    (at % (text.len() + 1)..).find(|&i| text.is_char_boundary(i)).unwrap_or(text.len())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_deck_with_a_piece_replaced_is_read_or_refused(from in 0usize..2000, length in 0usize..30, piece in "[\\[\\]{}=.,\"# a-z0-9é%/-]{0,12}") {
        for deck in [FLAVOUR, EVERYTHING, SHAPES] {
            let start = cut(deck, from);
            let end = cut(deck, (start + length).min(deck.len())).max(start);
            survive(&format!("{}{piece}{}", &deck[..start], &deck[end..]));
        }
    }

    #[test]
    fn any_number_in_any_place_is_read_or_refused(place in 0usize..200, value in any::<f64>(), unit in prop::sample::select(vec!["", " mm", " s", " GPa", " m/s", " K"])) {
        for deck in [FLAVOUR, EVERYTHING, SHAPES] {
            let numbers: Vec<usize> = deck.char_indices().filter(|(_, c)| c.is_ascii_digit()).map(|(i, _)| i).collect();
            let start = numbers[place % numbers.len()];
            let end = start + deck[start..].find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(0);
            survive(&format!("{}{value:e}{unit}{}", &deck[..start], &deck[end..]));
            survive(&format!("{}{value:?}{}", &deck[..start], &deck[end..]));
        }
    }

    #[test]
    fn any_override_is_taken_or_refused(path in "[a-z0-9.\"-]{0,24}", known in prop::sample::select(vec!["", "body.bar.", "particles.", "search.", "measure.0.", "material.x.", "wall.anvil."]), value in "[\\[\\]{}=.,\" a-z0-9-]{0,10}") {
        let _ = overrides::apply(FLAVOUR, &[(format!("{known}{path}"), value)]);
    }
}
