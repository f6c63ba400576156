//! What the chosen method will do with a deck, said before the run.

use sphorge_engine::Particles;
use sphorge_engine::model::{BodyContact, Dimensions, Formulation, Integrator, Model, Search, WallSurface};
use sphorge_physics::flow::FlowState;

/// Damage number `rho v^2 / Y` (Johnson 1972) from which on metal comes apart, and from which on it flows enough to shorten the time step.
const HYPERVELOCITY: f64 = 100.0;
const PLASTIC: f64 = 1.0;

/// What `sphorge check` says of the method.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Advice {
    /// The method in one line.
    pub method: String,
    /// What it will do with this deck that a user may not expect, and what does better.
    pub notes: Vec<String>,
    /// Whether the time step will shrink by far on the way.
    pub step_shrinks: bool,
}

/// What the method of a model will do with it.
pub fn advice(model: &Model, particles: &Particles) -> Advice {
    let hardest = hardest_impact(model, particles);
    let notes = match (model.formulation, model.search) {
        (Formulation::TotalLagrangian { renewal, .. }, _) => of_total_lagrangian(renewal, hardest.as_ref()),
        (Formulation::UpdatedLagrangian, Search::Initial) => vec![
            "lists and kernel values of the start see no body that arrives and no large strain: they are for the published comparison alone"
                .to_owned(),
        ],
        (Formulation::UpdatedLagrangian, Search::EveryStep | Search::Skin { .. } | Search::Adaptive(_)) => {
            of_updated_lagrangian(model, hardest.as_ref())
        }
    };
    let is_total_lagrangian = matches!(model.formulation, Formulation::TotalLagrangian { .. });
    let step_shrinks = is_total_lagrangian && hardest.is_some_and(|impact| impact.damage_number >= PLASTIC);
    Advice { method: method(model), notes, step_shrinks }
}

fn method(model: &Model) -> String {
    let numerics = &model.numerics;
    let mut parts = match (model.formulation, model.search) {
        (Formulation::TotalLagrangian { .. }, _) => vec!["total Lagrangian, sums over the initial neighbours"],
        (Formulation::UpdatedLagrangian, Search::EveryStep) => {
            vec!["updated Lagrangian, sums over the present neighbours, searched every step"]
        }
        (Formulation::UpdatedLagrangian, Search::Skin { .. }) => {
            vec!["updated Lagrangian, sums over the present neighbours, lists with a skin"]
        }
        (Formulation::UpdatedLagrangian, Search::Adaptive(_)) => {
            vec!["updated Lagrangian, sums over the present neighbours, adaptive search"]
        }
        (Formulation::UpdatedLagrangian, Search::Initial) => vec!["updated Lagrangian, lists of the start"],
    };
    if numerics.artificial_stress.is_some() {
        parts.push("artificial stress");
    }
    if numerics.xsph != 0.0 {
        parts.push("XSPH");
    }
    parts.push(match numerics.integrator {
        Integrator::Leapfrog => "leapfrog",
        Integrator::PredictorCorrector => "predictor-corrector",
    });
    parts.join(", ")
}

/// The impact with the largest damage number.
struct Impact {
    body: String,
    /// m/s.
    speed: f64,
    damage_number: f64,
}

/// The hardest impact that the velocities at the start tell of: between bodies, on a wall or on a symmetry plane.
fn hardest_impact(model: &Model, particles: &Particles) -> Option<Impact> {
    let mut momentum = vec![[0.0; 3]; model.bodies.len()];
    let mut mass = vec![0.0; model.bodies.len()];
    for ((body, m), v) in particles.body.iter().zip(&particles.mass).zip(&particles.velocity) {
        mass[*body as usize] += m;
        for (sum, v) in momentum[*body as usize].iter_mut().zip(v) {
            *sum += m * v;
        }
    }
    let mean: Vec<[f64; 3]> = momentum.iter().zip(&mass).map(|(p, m)| p.map(|c| c / m)).collect();
    let between = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
    let impact = |(index, body): (usize, &sphorge_engine::model::Body)| {
        let own = mean[index];
        let bodies = mean.iter().map(|&other| between(own, other));
        let walls = model.walls.iter().map(|wall| {
            let velocity = [0, 1, 2].map(|k| wall.velocity[k].at(0.0));
            match wall.surface {
                WallSurface::Plane { normal, .. } => (0..3).map(|k| (velocity[k] - own[k]) * normal[k]).sum(),
                WallSurface::Segment { .. } => between(own, velocity),
            }
        });
        let planes = model.symmetry.iter().map(|plane| -plane.side * own[plane.axis]);
        let speed = bodies.chain(walls).chain(planes).fold(0.0, f64::max);
        let material = &model.materials[body.material];
        let at_rest = FlowState::at_rest(body.temperature);
        let history: Vec<f64> = material.flow_law.history().iter().map(|variable| variable.initial).collect();
        let yield_stress = material.flow_law.yield_stress(at_rest, &history).value;
        Impact { body: body.name.clone(), speed, damage_number: material.density * speed * speed / yield_stress }
    };
    let impacts = model.bodies.iter().enumerate().map(impact);
    impacts.filter(|i| i.damage_number.is_finite()).max_by(|a, b| a.damage_number.total_cmp(&b.damage_number))
}

fn told(impact: &Impact) -> String {
    let Impact { body, speed, damage_number } = impact;
    format!("body `{body}` strikes at {speed:.0} m/s, damage number rho v^2/Y = {damage_number:.2}")
}

fn of_total_lagrangian(renewal: Option<f64>, hardest: Option<&Impact>) -> Vec<String> {
    let Some(impact) = hardest.filter(|impact| impact.damage_number >= PLASTIC) else { return Vec::new() };
    let told = told(impact);
    vec![match renewal {
        Some(bound) if impact.damage_number >= HYPERVELOCITY => format!(
            "{told}: it will come apart. In the total Lagrangian form a body does so where it is stretched {bound} times, numerically rather \
             than by a law of fracture; a crater is that of the flow, temperatures of single fragments are not to be trusted"
        ),
        None if impact.damage_number >= HYPERVELOCITY => format!(
            "{told}: it will come apart, which the total Lagrangian form does not let it with `renewal = 0`; leave that out"
        ),
        Some(_) | None => format!(
            "{told}: the time step follows the smallest stretch, so a face that is pressed flat takes up to several times the steps \
             expected from the first"
        ),
    }]
}

fn of_updated_lagrangian(model: &Model, hardest: Option<&Impact>) -> Vec<String> {
    let numerics = &model.numerics;
    let mut notes = Vec::new();
    let comes_apart = hardest.is_some_and(|impact| impact.damage_number >= HYPERVELOCITY);
    if !comes_apart && model.dimensions != Dimensions::One && model.thermal.mechanics {
        let instead = "`method = \"total-lagrangian\"` does neither";
        notes.push(if numerics.artificial_stress.is_some() && numerics.xsph != 0.0 {
            format!(
                "artificial stress with XSPH does negative work, so that metal that flows yields more than was supplied (a third more in \
                 `taylor-plate`), and what is pulled still falls into pairs of particles; {instead}"
            )
        } else {
            format!(
                "sums over the present neighbours fall into pairs of particles in tension, from 10 to 30 % of elongation on, and feet that \
                 are pressed flat flow apart; {instead}"
            )
        });
    }
    if model.bodies.len() > 1 && model.contact == BodyContact::Sph {
        notes.push(
            "bodies meet in kernel sums, which press before they touch and hold them together in tension; `contact = \"penalty\"` pushes alone"
                .to_owned(),
        );
    }
    if let Search::Adaptive(adaptive) = model.search
        && adaptive.guard.is_none()
    {
        notes.push(
            "without its guard the adaptive search finds neither bodies that arrive nor material that strains elastically, and no run says what it missed \
             but one with `audit`"
                .to_owned(),
        );
    }
    notes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{decks, load_text};

    fn of(name: &str, overrides: &[(&str, &str)]) -> Advice {
        let deck = decks::find(name).unwrap();
        let overrides: Vec<_> = overrides.iter().map(|&(path, value)| (path.to_owned(), value.to_owned())).collect();
        let setup = load_text(name, deck.text, &overrides).unwrap();
        advice(&setup.model, &setup.particles)
    }

    #[test]
    fn a_deck_that_suits_the_default_method_hears_of_its_steps_and_of_debris() {
        let plate = of("iron-plate", &[]);
        assert!(plate.method.starts_with("total Lagrangian"), "{plate:?}");
        // 7890 200^2/175e6.
        assert!(plate.notes.len() == 1 && plate.notes[0].contains("= 1.80"), "{plate:?}");
        assert!(plate.notes[0].contains("smallest stretch") && plate.step_shrinks);
        assert_eq!(of("iron-plate", &[("body.bar.velocity.1", "-20 m/s")]).notes, [""; 0]);
        let fast = of("iron-plate", &[("body.bar.velocity.1", "-3000 m/s")]);
        assert!(fast.notes[0].contains("come apart") && fast.notes[0].contains("16 times"), "{fast:?}");
        let kept = [("body.bar.velocity.1", "-3000 m/s"), ("search", "{ total-lagrangian = { renewal = 0 } }")];
        assert!(of("iron-plate", &kept).notes[0].contains("leave that out"));
        // What flies away from the wall strikes nothing.
        assert_eq!(of("iron-plate", &[("body.bar.velocity.1", "3000 m/s")]).notes, [""; 0]);
    }

    #[test]
    fn the_other_methods_are_told_from_what_they_do_to_metal() {
        let plate = of("taylor-plate", &[]);
        assert!(plate.notes.len() == 1 && plate.notes[0].contains("negative work"), "{plate:?}");
        assert!(plate.method.contains("XSPH") && plate.method.contains("predictor"), "{plate:?}");
        let plain = of("iron-plate", &[("method", "updated-lagrangian")]);
        assert!(plain.notes.len() == 1 && plain.notes[0].contains("in tension"), "{plain:?}");
        // Debris is what they are for; that bodies meet in kernel sums remains to be said.
        let debris = of("penetration", &[]);
        assert!(debris.notes.len() == 1 && debris.notes[0].contains("kernel sums"), "{debris:?}");
        assert!(of("penetration", &[("contact", "penalty")]).notes.is_empty());
        let unguarded = of("penetration", &[("search", "{ adaptive = { guard = \"none\" } }")]);
        assert!(unguarded.notes.iter().any(|note| note.contains("guard")), "{unguarded:?}");
        let frozen = of("penetration", &[("search", "{ total-lagrangian = { form = \"frozen\" } }")]);
        assert!(frozen.notes.len() == 1 && frozen.notes[0].contains("published comparison"), "{frozen:?}");
        // One dimension and heat alone have nothing of this.
        assert!(of("plate-impact", &[]).notes.iter().all(|note| !note.contains("pairs")));
        assert!(of("heat-slab", &[]).notes.is_empty());
    }
}
