//! What the chosen method will do with a deck, said before the run.

use super::{material::shown, splashes};
use sphorge_engine::Particles;
use sphorge_engine::model::{
    Body, BodyContact, Dimensions, Formulation, Integrator, Model, Precision, Search, WallSurface,
};
use sphorge_physics::damage::AfterFailure;
use sphorge_physics::integrity::smeared_width;
use sphorge_physics::tensor::principal_values;

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
    let mut notes = match (model.formulation, model.search) {
        (Formulation::TotalLagrangian { renewal, .. }, _) => of_total_lagrangian(renewal, hardest.as_ref()),
        (Formulation::UpdatedLagrangian, Search::Initial) => vec![
            "initial neighbour lists and kernel values do not follow approaching bodies or large strains: use them only for the published comparison"
                .to_owned(),
        ],
        (Formulation::UpdatedLagrangian, Search::EveryStep | Search::Skin { .. } | Search::Adaptive(_)) => {
            of_updated_lagrangian(model, hardest.as_ref())
        }
    };
    notes.extend(unseen_faces(model));
    notes.extend(thin_bodies(model, particles));
    let is_total_lagrangian = matches!(model.formulation, Formulation::TotalLagrangian { .. });
    let step_shrinks = is_total_lagrangian && hardest.is_some_and(|impact| impact.damage_number >= PLASTIC);
    Advice { method: method(model), notes, step_shrinks }
}

/// What makes the results of a method wrong for a deck, said by `sphorge run`, too; given the names of materials whose speed of sound is told to be wrong.
pub(crate) fn doubts(model: &Model, particles: &Particles, with_odd_moduli: &[String]) -> Vec<String> {
    let rounded = rounded_positions(model, particles).into_iter();
    rounded
        .chain(beyond_metals(model, particles, with_odd_moduli))
        .chain(splashes::notes(model, particles))
        .chain(too_coarse_to_break(model))
        .chain(held_as_a_fluid(model))
        .chain(deleted_behind_facets(model))
        .chain(lone_particles(model, particles))
        .collect()
}

/// Bodies that break into a fluid that bears any tension, so that nothing lets go.
fn held_as_a_fluid(model: &Model) -> Vec<String> {
    let holds = |body: &&Body| {
        let material = &model.materials[body.material];
        !material.spalls() && material.damage.is_some_and(|damage| damage.after == AfterFailure::Fluid)
    };
    let told = |body: &Body| {
        format!(
            "body `{}` breaks into a fluid that bears any tension: `after-failure = \"fluid\"` lets go only above a `spall-pressure`, and its material \
             has none; give it one, or take \"no-tension\"",
            body.name
        )
    };
    model.bodies.iter().filter(holds).map(told).collect()
}

/// Materials of which what fails is deleted from bodies that meet others at their facets: the faces that appear have none.
fn deleted_behind_facets(model: &Model) -> Vec<String> {
    let meets_at_facets = matches!(model.contact, BodyContact::Facets { .. }) && model.bodies.len() > 1;
    let is_deleted = |index: &usize| {
        let damage = model.materials[*index].damage;
        damage.is_some_and(|damage| damage.after == AfterFailure::Delete)
    };
    let mut used: Vec<usize> = model.bodies.iter().map(|body| body.material).filter(is_deleted).collect();
    used.sort_unstable();
    used.dedup();
    let told = |index: usize| {
        format!(
            "material `{}` is deleted where it fails, and the faces that appear behind it have no facets: other bodies pass into it there; choose \
             `contact.penalty.surfaces = \"overlap\"`, or `after-failure = \"no-tension\"`",
            model.materials[index].name
        )
    };
    used.into_iter().filter(|_| meets_at_facets).map(told).collect()
}

/// Bodies in which a crack takes more than their material states, because integrity would fall faster than their particles unload.
fn too_coarse_to_break(model: &Model) -> Vec<String> {
    let support = model.numerics.kernel.support();
    let told = |body: &Body| {
        let material = &model.materials[body.material];
        let damage = material.damage?;
        let state = material.flow_state(0.0, body.temperature, material.density, 0.0);
        let history: Vec<f64> = material.flow_law.history().iter().map(|variable| variable.initial).collect();
        let stress = damage.law.strength().unwrap_or(material.flow_law.yield_stress(state, &history).value);
        let size = smeared_width(support, body.smoothing_length);
        let most = damage.softening.largest_size(stress, material.moduli(material.shear_modulus))?;
        (stress.is_finite() && size > most).then(|| {
            format!(
                "body `{}` is too coarse for the cracks of its material: at a spacing of {:.3} mm they take {:.1} times as much as stated; they would not \
                 below {:.3} mm",
                body.name,
                1e3 * body.spacing,
                size / most,
                1e3 * body.spacing * most / size
            )
        })
    };
    model.bodies.iter().filter_map(told).collect()
}

fn method(model: &Model) -> String {
    let numerics = &model.numerics;
    let mut parts = match (model.formulation, model.search) {
        (Formulation::TotalLagrangian { .. }, _) => vec!["total Lagrangian, sums over the initial neighbours"],
        (Formulation::UpdatedLagrangian, Search::EveryStep) => {
            vec!["updated Lagrangian, sums over the current neighbours, searched every step"]
        }
        (Formulation::UpdatedLagrangian, Search::Skin { .. }) => {
            vec!["updated Lagrangian, sums over the current neighbours, lists with a skin"]
        }
        (Formulation::UpdatedLagrangian, Search::Adaptive(_)) => {
            vec!["updated Lagrangian, sums over the current neighbours, adaptive search"]
        }
        (Formulation::UpdatedLagrangian, Search::Initial) => vec!["updated Lagrangian, initial neighbour lists"],
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

/// Reach of the kernel, in spacings, beyond which the outermost layer of a thin body is not told from the one behind that of a thick one.
const FARTHEST_REACH: f64 = 4.0;

/// Bodies whose faces are not found, where contact and walls meet bodies at them.
fn unseen_faces(model: &Model) -> Vec<String> {
    let support = model.numerics.kernel.support();
    let meets_at_faces =
        matches!(model.formulation, Formulation::TotalLagrangian { .. }) && model.dimensions != Dimensions::One;
    let reach = |body: &Body| support * body.smoothing_length / body.spacing;
    let too_wide = model.bodies.iter().filter(|body| meets_at_faces && reach(body) > FARTHEST_REACH * (1.0 + 1e-9));
    too_wide
        .map(|body| {
            format!(
                "the kernel of body `{}` extends over {:.1} spacings, so that the faces of a sheet of three particles or fewer may not be found, and it may \
                 pass through what it hits; use a `smoothing` of at most {:.4} there",
                body.name,
                reach(body),
                FARTHEST_REACH / support
            )
        })
        .collect()
}

/// Particles across from which on bending is that of theory, and how many times as long a body is at least that is said to bend.
const ENOUGH_ACROSS: f64 = 6.0;
const SLENDER: f64 = 3.0;

/// Bodies that bend with too few particles across.
fn thin_bodies(model: &Model, particles: &Particles) -> Vec<String> {
    if model.dimensions == Dimensions::One {
        return Vec::new();
    }
    let is_total_lagrangian = matches!(model.formulation, Formulation::TotalLagrangian { .. });
    let note = |(b, body): (usize, &Body)| {
        let [across, along] = particles_across(model, particles, b)?;
        if across > ENOUGH_ACROSS - 0.5 || along < SLENDER * across {
            return None;
        }
        let name = &body.name;
        Some(match is_total_lagrangian && across < 1.5 {
            true => format!(
                "body `{name}` is one particle across: it bears tension and shear along itself and turns as a membrane or a wire does, but hardly resists \
                 bending and has no pressure across itself; give it two particles across if it is pressed, {ENOUGH_ACROSS} if it bends"
            ),
            false => format!(
                "body `{name}` is about {across:.0} particles across: give it {ENOUGH_ACROSS} or more if it bends; with fewer, bending stiffness and plastic \
                 moments depend on their number"
            ),
        })
    };
    model.bodies.iter().enumerate().filter_map(note).collect()
}

/// Bodies of one particle on a line, beside others.
fn lone_particles(model: &Model, particles: &Particles) -> Vec<String> {
    let is_total_lagrangian = matches!(model.formulation, Formulation::TotalLagrangian { .. });
    if model.dimensions != Dimensions::One || !is_total_lagrangian || model.bodies.len() < 2 {
        return Vec::new();
    }
    let count = |body: usize| particles.body.iter().filter(|of| **of as usize == body).count();
    let alone = model.bodies.iter().enumerate().filter(|(index, _)| count(*index) == 1);
    let told = |(_, body): (usize, &Body)| {
        format!(
            "body `{}` is one particle long: without a neighbour it is not pressed, and passes on what pushes it without a pressure of its own; give it two or \
             more",
            body.name
        )
    };
    alone.map(told).collect()
}

/// Particles across a body where it is thinnest, and along it where it is longest, of those that a box of its second moments has; with its
/// images at planes of symmetry that it lies at. Nothing of a body without particles.
fn particles_across(model: &Model, particles: &Particles, b: usize) -> Option<[f64; 2]> {
    let body = &model.bodies[b];
    let members = || (0..particles.len()).filter(|&i| particles.body[i] as usize == b).map(|i| &particles.position[i]);
    let count = members().count() as f64;
    let mut centre = [0, 1, 2].map(|a| members().map(|x| x[a]).sum::<f64>() / count);
    let mut is_mirrored = [false; 3];
    for plane in &model.symmetry {
        let nearest = members().map(|x| (x[plane.axis] - plane.position).abs()).fold(f64::INFINITY, f64::min);
        if nearest < 0.75 * body.spacing {
            (centre[plane.axis], is_mirrored[plane.axis]) = (plane.position, true);
        }
    }
    let moment = |a: usize, b: usize| match a != b && (is_mirrored[a] || is_mirrored[b]) {
        true => 0.0,
        false => members().map(|x| (x[a] - centre[a]) * (x[b] - centre[b])).sum::<f64>() / count,
    };
    let moments = [0, 1, 2].map(|a| [0, 1, 2].map(|b| moment(a, b) / (body.spacing * body.spacing)));
    // A row of n has the second moment (n^2 - 1)/12.
    let of_moment = |moment: f64| (12.0 * moment.max(0.0) + 1.0).sqrt();
    let values = &principal_values(moments)[..];
    let values = if model.dimensions == Dimensions::Three { values } else { &values[1..] };
    Some([of_moment(*values.first()?), of_moment(*values.last()?)]).filter(|_| count > 0.0)
}

/// Share of a spacing to which positions are kept in mixed precision without a word: 31 bits of the distance between bodies.
const ROUNDING: f64 = 1e-4;

/// What single precision loses where bodies are many spacings apart.
fn rounded_positions(model: &Model, particles: &Particles) -> Option<String> {
    if model.numerics.precision != Precision::Mixed {
        return None;
    }
    let extent = (0..3).map(|axis| {
        let of = |fold: fn(f64, f64) -> f64, start| particles.position.iter().map(|x| x[axis]).fold(start, fold);
        of(f64::max, f64::NEG_INFINITY) - of(f64::min, f64::INFINITY)
    });
    let spacing = model.bodies.iter().map(|body| body.spacing).fold(f64::INFINITY, f64::min);
    let share = extent.fold(0.0, f64::max) / (1u64 << 31) as f64 / spacing;
    (share > ROUNDING).then(|| {
        format!(
            "the particles extend over {:.1e} spacings, so that mixed precision keeps their positions to {share:.0e} of a spacing; \
             `numerics.precision = \"double\"` keeps full precision",
            share * (1u64 << 31) as f64
        )
    })
}

/// Speeds over the sound speed, and temperatures (K), beyond which no law of metals holds and a unit may be wrong.
const FASTEST: f64 = 10.0;
const HOTTEST: f64 = 10_000.0;

/// Bodies whose initial state is beyond what any law here is made for.
fn beyond_metals(model: &Model, particles: &Particles, with_odd_moduli: &[String]) -> Vec<String> {
    let mut fastest = vec![0.0f64; model.bodies.len()];
    for (&body, v) in particles.body.iter().zip(&particles.velocity) {
        let squared: f64 = v.iter().map(|c| c * c).sum();
        fastest[body as usize] = fastest[body as usize].max(squared);
    }
    let mut notes = Vec::new();
    for (body, squared) in model.bodies.iter().zip(fastest) {
        let material = &model.materials[body.material];
        let (speed, sound) = (squared.sqrt(), material.equation_of_state.reference_sound_speed());
        if speed > FASTEST * sound && !with_odd_moduli.contains(&material.name) {
            notes.push(format!(
                "body `{}` starts with {}, {:.0} times its speed of sound, beyond the range of the material laws: check the unit",
                body.name,
                shown(speed, "m/s"),
                speed / sound
            ));
        }
        if body.temperature > HOTTEST {
            notes.push(format!(
                "body `{}` starts at {}, far above the boiling point of any metal: check the unit",
                body.name,
                shown(body.temperature, "K")
            ));
        } else if let Some(melting) =
            material.flow_law.melting_temperature().filter(|melting| body.temperature >= *melting)
        {
            notes.push(format!(
                "body `{}` starts at {:.1} K, at or above the melting temperature of material `{}`, {melting:.1} K: it has no strength; check the units",
                body.name, body.temperature, material.name
            ));
        }
    }
    notes
}

/// Plastic strain at which a metal has most of its strength, whatever it has before.
const HARDENED: f64 = 0.01;

/// The impact with the largest damage number.
pub(crate) struct Impact {
    pub(crate) body: String,
    /// Whether the body moves towards the other; else it is struck.
    pub(crate) is_striker: bool,
    /// m/s.
    pub(crate) speed: f64,
    pub(crate) damage_number: f64,
}

/// The hardest impact that the velocities at the start tell of: between bodies, on a wall or on a symmetry plane.
fn hardest_impact(model: &Model, particles: &Particles) -> Option<Impact> {
    let finite = impacts(model, particles).into_iter().filter(|impact| impact.damage_number.is_finite());
    finite.max_by(|a, b| a.damage_number.total_cmp(&b.damage_number))
}

/// For each body the hardest impact that the velocities at the start tell of.
pub(crate) fn impacts(model: &Model, particles: &Particles) -> Vec<Impact> {
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
        let yields_at = |plastic_strain: f64| material.yield_stress_at_rest(plastic_strain, body.temperature);
        // A metal may harden from nothing.
        let at_start = yields_at(0.0);
        let hardens = at_start == 0.0 && material.shear_modulus > 0.0;
        let yield_stress = if hardens { yields_at(HARDENED) } else { at_start };
        let is_striker = between(own, [0.0; 3]) >= 0.499 * speed;
        Impact {
            body: body.name.clone(),
            is_striker,
            speed,
            damage_number: material.density * speed * speed / yield_stress,
        }
    };
    model.bodies.iter().enumerate().map(impact).collect()
}

fn told(impact: &Impact) -> String {
    let Impact { body, is_striker, speed, damage_number } = impact;
    let damage_number = match *damage_number {
        large if large >= 1e5 => format!("{large:.1e}"),
        large if large >= 100.0 => format!("{large:.0}"),
        small => format!("{small:.2}"),
    };
    let verb = if *is_striker { "strikes" } else { "is struck" };
    format!("body `{body}` {verb} at {speed:.0} m/s, damage number rho v^2/Y = {damage_number}")
}

fn of_total_lagrangian(renewal: Option<f64>, hardest: Option<&Impact>) -> Vec<String> {
    let Some(impact) = hardest.filter(|impact| impact.damage_number >= PLASTIC) else { return Vec::new() };
    let told = told(impact);
    vec![match renewal {
        Some(bound) if impact.damage_number >= HYPERVELOCITY => format!(
            "{told}: it will break apart. In the total Lagrangian form a body does so at a stretch of {bound}, by a numerical criterion rather \
             than a fracture law; the crater follows from the flow, but temperatures of single fragments are not reliable"
        ),
        None if impact.damage_number >= HYPERVELOCITY => format!(
            "{told}: it will break apart, which the total Lagrangian form does not allow with `renewal = 0`; leave this key out"
        ),
        Some(_) | None => format!(
            "{told}: the time step follows the smallest stretch, so a flattened face can take several times as many steps as \
             the first step suggests"
        ),
    }]
}

fn of_updated_lagrangian(model: &Model, hardest: Option<&Impact>) -> Vec<String> {
    let numerics = &model.numerics;
    let mut notes = Vec::new();
    let comes_apart = hardest.is_some_and(|impact| impact.damage_number >= HYPERVELOCITY);
    if !comes_apart && model.dimensions != Dimensions::One && model.thermal.mechanics {
        let instead = "`method = \"total-lagrangian\"` avoids both";
        notes.push(if numerics.artificial_stress.is_some() && numerics.xsph != 0.0 {
            format!(
                "artificial stress with XSPH does negative work, so that the plastic work exceeds the energy supplied (by a third in \
                 `taylor-plate`), and in tension particles still clump in pairs; {instead}"
            )
        } else {
            format!(
                "with sums over the current neighbours, particles in tension clump in pairs from a few per cent of elongation on, and flattened \
                 feet flow apart; {instead}"
            )
        });
    }
    if model.bodies.len() > 1 && model.contact == BodyContact::Sph {
        notes.push(
            "bodies interact through kernel sums, which repel them before they touch and hold them together in tension; `contact = \"penalty\"` only repels"
                .to_owned(),
        );
    }
    if let Search::Adaptive(adaptive) = model.search
        && adaptive.guard.is_none()
    {
        notes.push(
            "without its guard the adaptive search misses approaching bodies and material that strains elastically; only `audit` reports what it \
             missed"
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

    /// What is told of a shipped deck before it is run, too.
    fn notes_of(name: &str, path: &str, value: &str) -> String {
        let deck = decks::find(name).unwrap();
        load_text(name, deck.text, &[(path.to_owned(), value.to_owned())]).unwrap().notes.join("\n")
    }

    #[test]
    fn deleted_metal_behind_facets_is_told_with_its_line() {
        let notes = |after: &str, contact: &str, second: &str| {
            let deck = format!(
                "dimensions = \"plane-strain\"\nparticles = {{ spacing = \"1 mm\" }}\ntime = {{ end = \"1 us\" }}\n{contact}\n[material.ofhc-copper]\n\
                 damage = \"johnson-cook\"\nafter-failure = \"{after}\"\n[[body]]\nname = \"a\"\nmaterial = \"ofhc-copper\"\nvelocity = [\"100 m/s\", 0]\n\
                 shape = {{ box = {{ min = [0, 0], max = [\"6 mm\", \"6 mm\"] }} }}\n{second}"
            );
            load_text("two", &deck, &[]).unwrap_or_else(|report| panic!("{report:?}")).notes.join("\n")
        };
        let second = "[[body]]\nname = \"b\"\nmaterial = \"ofhc-copper\"\nshape = { box = { min = [\"6 mm\", 0], max = [\"12 mm\", \"6 mm\"] } }\n";
        let told = notes("delete", "", second);
        assert!(told.contains("line 7: material `ofhc-copper` is deleted where it fails"), "{told}");
        let overlap = "contact = { penalty = { surfaces = \"overlap\" } }";
        for (after, contact, second) in [("no-tension", "", second), ("delete", overlap, second), ("delete", "", "")] {
            let told = notes(after, contact, second);
            assert!(!told.contains("is deleted"), "{told}");
        }
    }

    #[test]
    fn damage_numbers_are_written_to_be_read() {
        let of = |damage_number: f64| {
            told(&Impact { body: "bar".to_owned(), is_striker: true, speed: 200.0, damage_number })
        };
        for (number, words) in [(0.514, "= 0.51"), (25.0, "= 25.00"), (1234.5, "= 1234"), (9e5, "= 9.0e5")] {
            assert!(of(number).ends_with(words), "{}", of(number));
        }
    }

    #[test]
    fn a_particle_alone_between_others_is_told() {
        let notes = |end: &str| {
            let deck = format!(
                "dimensions = \"1d\"\nparticles = {{ spacing = \"0.1 mm\" }}\ntime = {{ end = \"1 us\" }}\n\
                 [[body]]\nname = \"a\"\nmaterial = \"ofhc-copper\"\nvelocity = [\"100 m/s\"]\nshape = {{ box = {{ min = [0], max = [\"2 mm\"] }} }}\n\
                 [[body]]\nname = \"sheet\"\nmaterial = \"ofhc-copper\"\nshape = {{ box = {{ min = [\"2 mm\"], max = [\"{end} mm\"] }} }}\n"
            );
            load_text("line", &deck, &[]).unwrap_or_else(|report| panic!("{report}")).notes.join("\n")
        };
        assert!(notes("2.1").contains("body `sheet` is one particle long"), "{}", notes("2.1"));
        assert!(!notes("2.2").contains("one particle long"), "{}", notes("2.2"));
    }

    #[test]
    fn a_metal_that_hardens_from_nothing_is_no_fluid() {
        let hardens = [("material.bar.base", "armco-iron"), ("body.bar.material", "bar")];
        let strength = (
            "material.bar.strength",
            "{ johnson-cook = { A = 0, B = \"275 MPa\", n = 0.3, C = 0.02, m = 1, melting-temperature = \"1800 K\" } }",
        );
        let deck = decks::find("iron-plate").unwrap();
        let of = |changes: &[(&str, &str)]| {
            let changes: Vec<_> = changes.iter().map(|&(path, value)| (path.to_owned(), value.to_owned())).collect();
            load_text("iron-plate", deck.text, &changes).unwrap().notes.join("\n")
        };
        assert!(!of(&[hardens[0], hardens[1], strength]).contains("splashes"));
        assert!(of(&[hardens[0], hardens[1], ("material.bar.strength", "none")]).contains("splashes"));
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
        assert!(fast.notes[0].contains("break apart") && fast.notes[0].contains("a stretch of 16,"), "{fast:?}");
        let kept = [("body.bar.velocity.1", "-3000 m/s"), ("search", "{ total-lagrangian = { renewal = 0 } }")];
        assert!(of("iron-plate", &kept).notes[0].contains("leave this key out"));
        // 2 h over twice the spacing.
        let slow = |smoothing: &str| {
            of("iron-plate", &[("body.bar.velocity.1", "-20 m/s"), ("particles.smoothing", smoothing)]).notes
        };
        assert_eq!(slow("2.0"), [""; 0]);
        assert!(slow("2.2").len() == 1 && slow("2.2")[0].contains("extends over 4.4 spacings"), "{:?}", slow("2.2"));
        // What flies away from the wall strikes nothing.
        assert_eq!(of("iron-plate", &[("body.bar.velocity.1", "3000 m/s")]).notes, [""; 0]);
    }

    #[test]
    fn a_fluid_that_never_lets_go_is_told() {
        let notes = |more: &[(&str, &str)]| {
            let deck = decks::find("crack-energy").unwrap();
            let material = "material.steel";
            let broken: Vec<_> =
                more.iter().map(|&(key, value)| (format!("{material}.{key}"), value.to_owned())).collect();
            load_text("crack-energy", deck.text, &broken).unwrap().notes.join("\n")
        };
        let fluid = ("after-failure", "fluid");
        assert!(notes(&[fluid]).contains("breaks into a fluid that bears any tension"), "{}", notes(&[fluid]));
        for quiet in [&[("after-failure", "delete")][..], &[fluid, ("spall-pressure", "2 GPa")]] {
            assert!(!notes(quiet).contains("any tension"), "{}", notes(quiet));
        }
    }

    #[test]
    fn what_no_law_or_precision_is_made_for_is_told() {
        let notes = |path: &str, value: &str| notes_of("iron-plate", path, value);
        assert!(notes("body.bar.velocity.1", "-300 km/s").contains("times its speed of sound"));
        assert!(!notes("body.bar.velocity.1", "-6 km/s").contains("times its speed of sound"));
        assert!(notes("body.bar.temperature", "20000 K").contains("boiling point of any metal"));
        // That of the deck melts at no temperature; copper at 1356 K.
        assert!(!notes("body.bar.temperature", "1400 K").contains("melting"));
        let copper = |temperature: &str| {
            let changes = [("body.bar.temperature", temperature), ("body.bar.material", "ofhc-copper")];
            let changes = changes.map(|(path, value)| (path.to_owned(), value.to_owned()));
            load_text("copper", decks::find("iron-plate").unwrap().text, &changes).unwrap().notes.join("")
        };
        let told = copper("1356 K");
        assert!(
            told.contains("`bar` starts at 1356.0 K, at or above the melting temperature of material `ofhc-copper`")
        );
        assert!(!copper("1355 K").contains("melting"));
        let far = |shift: &str, precision: &str| {
            let deck = format!(
                "dimensions = \"plane-strain\"\nparticles = {{ spacing = \"1 mm\" }}\ntime = {{ end = \"1 us\", max-steps = 1 }}\nnumerics = {{ precision = \
                 \"{precision}\" }}\n[[body]]\nname = \"a\"\nmaterial = \"armco-iron\"\nshape = {{ box = {{ min = [0, 0], max = [\"5 mm\", \"5 mm\"] }} }}\n\
                 [[body]]\nname = \"b\"\nmaterial = \"armco-iron\"\nshape = {{ box = {{ min = [0, 0], max = [\"5 mm\", \"5 mm\"] }}, shift = [\"{shift}\", 0] }}\nvelocity = [1, 0]\n"
            );
            let setup = load_text("far", &deck, &[]).unwrap();
            setup.notes
        };
        // 3e5 spacings over 2^31.
        assert!(far("300 m", "mixed").join("").contains("1e-4 of a spacing"), "{:?}", far("300 m", "mixed"));
        assert_eq!(far("300 m", "double"), [""; 0]);
        assert_eq!(far("100 m", "mixed"), [""; 0]);
    }

    #[test]
    fn bodies_that_bend_with_few_particles_across_are_named() {
        let deck = |shape: &str, more: &str| {
            format!(
                "dimensions = \"3d\"\nparticles = {{ spacing = \"1 mm\" }}\ntime = {{ end = \"1 us\" }}\n{more}\n[[body]]\nname = \"strip\"\n\
                 material = \"armco-iron\"\nshape = {{ {shape} }}\n"
            )
        };
        let notes = |shape: &str, more: &str| -> Vec<String> {
            let setup = crate::load_text("test", &deck(shape, more), &[]).unwrap();
            let notes = advice(&setup.model, &setup.particles).notes;
            notes.into_iter().filter(|note| note.contains("across")).collect()
        };
        let of_layers =
            |layers: u32| format!("box = {{ min = [0, 0, 0], max = [\"30 mm\", \"12 mm\", \"{layers} mm\"] }}");
        assert!(notes(&of_layers(1), "")[0].contains("`strip` is one particle across"));
        for layers in 2..6 {
            assert!(notes(&of_layers(layers), "")[0].contains(&format!("about {layers} particles across")));
        }
        assert_eq!(notes(&of_layers(6), ""), Vec::<String>::new());
        // With their images.
        let plane = "symmetry = [{ axis = \"z\" }]";
        assert!(notes(&of_layers(2), plane)[0].contains("about 4 particles") && notes(&of_layers(3), plane).is_empty());
        // What is as long as it is thick does not bend.
        assert!(notes("box = { min = [0, 0, 0], max = [\"3 mm\", \"3 mm\", \"3 mm\"] }", "").is_empty());
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
