//! Shares that are chosen anew where the works of ranks come apart.

use super::{compare, led, setup};
use sphorge::engine::{EngineKind, Simulation};

/// A cloud that flies apart, so that its particles lose their neighbours, beside a block that stays as it is and is pushed by a wall: works of blocks
/// are summed, which change hands.
const CLOUD: &str = r#"
dimensions = "plane-strain"
method = "updated-lagrangian"
search = "every-step"
particles = { spacing = "0.5 mm" }
gravity = ["0 m/s^2", "-1000 m/s^2"]
contact = "penalty"

[thermal]

[time]
end = "1 ms"
max-steps = 280

[output]
frame-interval = "10 us"
history-interval = "2 us"

[[body]]
name = "block"
material = "armco-iron"
shape = { box = { min = ["0 mm", "0 mm"], max = ["16 mm", "16 mm"] } }
velocity = ["0 m/s", "-50 m/s"]

[[body]]
name = "cloud"
material = "weldox-460-e"
shape = { box = { min = ["40 mm", "0 mm"], max = ["56 mm", "16 mm"] } }
velocity-gradient = { rows = [["6e5 1/s", "0 1/s"], ["0 1/s", "6e5 1/s"]] }

[[wall]]
name = "table"
plane = { point = ["0 mm", "-0.2 mm"], normal = [0, 1] }
contact = { penalty = { friction = 0.2 } }

[[measure]]
name = "height"
extent = { body = "block", axis = "y" }
"#;

#[test]
fn a_cloud_that_flies_apart_beside_a_block() {
    compare(CLOUD, &[], &[2, 3, 5]);
}

/// No motion.
const STILL: &str = "[[\"0 1/s\", \"0 1/s\"], [\"0 1/s\", \"0 1/s\"]]";

/// Most work of a rank over the mean after as many steps of the cloud.
fn imbalance(changes: &[(&str, &str)], ranks: usize, steps: u64) -> f64 {
    led(ranks, 1, |leader| {
        let setup = setup(CLOUD, changes);
        leader.take_deck("a-deck", &setup.deck_text);
        let mut simulation = Simulation::start(leader, setup.model, setup.particles).unwrap();
        for _ in 0..steps {
            simulation.step(None).unwrap();
        }
        simulation.imbalance()
    })
}

#[test]
fn works_of_ranks_stay_alike() {
    let [start, before, after] = [2, 62, 280].map(|steps| imbalance(&[], 2, steps));
    assert!(start < 1.03 && before > 1.05 && after < 1.05, "{start} {before} {after}");
    assert_eq!(imbalance(&[], 1, 2), 1.0);
    // Two rows in place of the cloud have half the neighbours: with half of the particles each, the works would differ by 1.12 from their mean.
    let rows = [("body.1.shape.box.max", "[\"296 mm\", \"1 mm\"]"), ("body.1.velocity-gradient.rows", STILL)];
    let start = imbalance(&rows, 2, 2);
    assert!(start > 1.0 && start < 1.05, "{start}");
}
