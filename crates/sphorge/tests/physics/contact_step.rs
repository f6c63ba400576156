//! The time step of the contact between bodies at faces, whose forces move neighbours too.

use super::setup::simulation;
use sphorge::engine::LimitReason;

/// Two elastic blocks that are pressed together at a contact so stiff that it alone limits the step.
const STIFF: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "1 mm" }
numerics = { precision = "double" }
contact = { penalty = { stiffness = 40.0, damping = 0.0 } }
search = { total-lagrangian = { hourglass = 0 } }
time = { end = "100 us", courant = 0.9, max-step = "60 ns" }

[material.metal]
density = "7850 kg/m^3"
young-modulus = "210 GPa"
poisson-ratio = 0.3
equation-of-state = "linear"
strength = "elastic"

[[body]]
name = "hammer"
material = "metal"
shape = { box = { min = ["-4 mm", "0 mm"], max = ["4 mm", "8 mm"] } }
velocity = ["0 m/s", "-5 m/s"]

[[body]]
name = "anvil"
material = "metal"
shape = { box = { min = ["-4 mm", "-8 mm"], max = ["4 mm", "0 mm"] } }

[[region]]
name = "top"
body = "hammer"
shape = { box = { min = ["-5 mm", "7 mm"], max = ["5 mm", "9 mm"] } }

[[region]]
name = "bottom"
body = "anvil"
shape = { box = { min = ["-5 mm", "-9 mm"], max = ["5 mm", "-7 mm"] } }

[[motion]]
region = "top"
velocity = ["0 m/s", "-5 m/s"]

[[motion]]
region = "bottom"
velocity = [0, 0]
"#;

#[test]
fn a_stiff_contact_is_stable_at_its_limit() {
    let mut simulation = simulation(STIFF, &[]);
    let end = 8e-6;
    let (mut limited, mut steps) = (0, 0);
    while simulation.time() < end {
        limited += usize::from(simulation.step(Some(end)).unwrap().reason == LimitReason::Contact);
        steps += 1;
    }
    // What the balance does not show: energy that steps too long put in. At a limit that does not know that forces on faces move neighbours
    // it is ten times the work done.
    let now = simulation.ledger().unwrap();
    let booked = now.integration_energy + now.contacts.iter().map(|c| c.integration_energy).sum::<f64>();
    println!("{limited} of {steps} steps limited by the contact, {booked:.2e} J/m booked of {:.2e}", now.external_work);
    assert!(10 * limited > 9 * steps && booked.abs() < 0.05 * now.external_work, "{limited} of {steps}, {booked}");
}
