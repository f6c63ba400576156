//! What is missing or of another size in an archive is an error that names it.

use super::super::setup::run_steps;
use super::{
    Changes, GRAVITY, GUARDED, HEAT, LAGRANGIAN, Loading, PENALTY, PUBLISHED, STRIKE, SYMMETRY, WALLS, values_of,
};
use sphorge::{
    deck,
    engine::{Simulation, persist::ArchiveError},
};

/// What is saved of rows of neighbours.
#[derive(Clone, Copy, PartialEq)]
enum Rows {
    /// The rows.
    Themselves,
    /// Where the points were of which a full search makes them again.
    Places,
}

/// Loads a state of which one value is missing, longer, shorter, of particles that there are not.
fn refuses_what_is_spoiled(text: &str, changes: Changes<'_>, saved_rows: Rows) {
    let changes: Vec<_> = changes.iter().map(|&(path, value)| (path.to_owned(), value.to_owned())).collect();
    let setup = deck::load_text("test", text, &changes).unwrap_or_else(|report| panic!("{report:?}"));
    let start = || Simulation::new(setup.model.clone(), setup.particles.clone());
    let mut simulation = start();
    run_steps(&mut simulation, 12);
    let values = values_of(&mut simulation);
    let load = |spoiled: &str, value: Option<Vec<u8>>| {
        let of = |name: &str| if name == spoiled { value.clone() } else { values.get(name).cloned() };
        start().persist(&mut Loading(of))
    };
    assert_eq!(load("", None), Ok(()));
    for (name, value) in &values {
        assert_eq!(load(name, None), Err(ArchiveError::Missing(name.clone())));
        let longer = [value, &[0][..]].concat();
        let shorter = value.split_last().map(|(_, rest)| rest.to_vec());
        for other in [Some(longer), shorter].into_iter().flatten() {
            assert_eq!(load(name, Some(other)), Err(ArchiveError::Mismatch(name.clone())));
        }
        if !value.is_empty() {
            assert!(load(name, Some(value.repeat(2))).is_err(), "`{name}` twice as long is taken");
        }
    }
    let rows: &[_] = match saved_rows {
        Rows::Themselves => &[
            ("lists.list.indices", "lists.list.0"),
            ("lists.list.rooms", "lists.list.indices"),
            ("lists.list.lengths", "lists.list.0"),
        ],
        Rows::Places => &[
            ("lists.points", "lists.points"),
            ("lists.smoothing_length", "lists.smoothing_length"),
            ("lists.smoothing_lengths_at_search", "lists.smoothing_lengths_at_search"),
        ],
    };
    let others = [
        ("particles.id", "particles.id"),
        ("particles.body", "particles.body"),
        ("particles.material", "particles.material"),
        ("particles.motion", "particles.motion"),
        ("lists.searcher.sorted_at", "lists.searcher.sorted_at"),
        ("lists.searcher.sorted_for", "lists.searcher.sorted_for"),
        ("clock.limit", "clock.limit"),
    ];
    for &(name, refused) in others.iter().chain(rows) {
        let other = vec![0xff; values[name].len()];
        assert_eq!(load(name, Some(other)), Err(ArchiveError::Mismatch(refused.to_owned())));
    }
    let all_the_same = load("particles.id", Some(vec![0; values["particles.id"].len()]));
    assert_eq!(all_the_same, Err(ArchiveError::Mismatch("particles.id".to_owned())));
    if saved_rows == Rows::Places {
        assert!(values.keys().all(|name| !name.starts_with("lists.list.")), "rows are saved that a search makes");
    }
}

#[test]
fn a_state_with_contact_and_heat() {
    refuses_what_is_spoiled(&format!("{PENALTY}\n{STRIKE}{HEAT}"), &[("search", GUARDED)], Rows::Themselves);
}

#[test]
fn a_state_with_ghosts_and_kept_distances() {
    let text = format!("{SYMMETRY}\n{STRIKE}");
    refuses_what_is_spoiled(&text, &[("search", PUBLISHED)], Rows::Themselves);
}

#[test]
fn a_state_with_walls_and_a_reference_configuration() {
    let text = format!("{GRAVITY}\n{STRIKE}{WALLS}");
    refuses_what_is_spoiled(&text, &[("search", LAGRANGIAN)], Rows::Places);
    refuses_what_is_spoiled(&text, &[("numerics.integrator", "predictor-corrector")], Rows::Places);
}
