//! Which rows read no ghost, and are summed before these have come, is found anew where the lists are others.

use super::{compare, led, setup};
use sphorge::engine::{EngineKind, Simulation};

/// Two bodies, each the share of one of two ranks, that are out of reach of each other at first: no row reads a ghost until they meet.
const MEETING: &str = r#"
dimensions = "plane-strain"
method = "updated-lagrangian"
search = "every-step"
particles = { spacing = "0.5 mm" }

[time]
end = "6 us"

[output]
frame-interval = "2 us"
history-interval = "0.2 us"

[[body]]
name = "block"
material = "armco-iron"
shape = { box = { min = ["0 mm", "0 mm"], max = ["16 mm", "16 mm"] } }

[[body]]
name = "striker"
material = "ofhc-copper"
shape = { box = { min = ["17.5 mm", "0 mm"], max = ["33.5 mm", "16 mm"] } }
velocity = ["-500 m/s", "0 m/s"]

[[measure]]
name = "width"
extent = { body = "block", axis = "x" }
"#;

/// Searches of all rows, now and then, and of some.
const SEARCHES: [&str; 3] = ["\"every-step\"", "\"skin\"", "\"adaptive\""];

#[test]
fn bodies_of_two_ranks_that_meet() {
    for search in SEARCHES {
        compare(MEETING, &[("search", search)], &[2, 3]);
    }
}

#[test]
fn rows_of_bodies_that_have_met_wait_for_ghosts() {
    for search in SEARCHES {
        let shares = led(2, 1, |leader| {
            let setup = setup(MEETING, &[("search", search)]);
            leader.take_deck("a-deck", &setup.deck_text);
            let mut simulation = Simulation::start(leader, setup.model, setup.particles).unwrap();
            [2, 100].map(|steps| {
                while simulation.steps() < steps {
                    simulation.step(None).unwrap();
                }
                simulation.inner_share()
            })
        });
        // A block of each of sixteen and more wait.
        assert!(shares[0] == 1.0 && (0.3..0.95).contains(&shares[1]), "{search}: {shares:?}");
    }
}
