//! Numbers that no engineer means: a wrong unit, a wrong sign, a load that is not there. Said by `sphorge check` and `sphorge run`.

use super::coefficients::coefficients;
use super::drives;
use super::material::shown;
use super::reach::ways;
use sphorge_engine::Particles;
use sphorge_engine::geometry::pressed_at_start;
use sphorge_engine::model::{
    Body, CloudParticle, CloudShare, Material, Measure, MeasureKind, Model, MotionAxis, Solid, TimeTable, WallSurface,
};

/// Yield stress over the shear modulus below which none of a solid is: pure single crystals have 1e-6.
const LEAST_YIELD: f64 = 1e-6;
/// Steps beyond which nobody waits.
const MANY_STEPS: f64 = 1e8;
/// Speed of sound above which no matter has one, m/s.
const FASTEST_SOUND: f64 = 1e5;
/// Distance of a listed particle to the next one over the spacing, beyond which one of both is wrong; and the edge of a cell of its volume.
const DISTANCES: [f64; 2] = [0.6, 1.5];

/// What in a deck cannot be meant.
pub(crate) fn slips(model: &Model, particles: &Particles) -> Vec<String> {
    let mut used: Vec<usize> = model.bodies.iter().map(|body| body.material).collect();
    used.sort_unstable();
    used.dedup();
    let materials = used.into_iter().filter_map(|index| of_material(&model.materials[index]));
    let bodies = model.bodies.iter().enumerate();
    materials
        .chain(too_long(model))
        .chain(coefficients(model))
        .chain(bodies.filter_map(|(b, body)| of_list(model, particles, b, body)))
        .chain(empty_sections(model, particles))
        .collect()
}

/// What cannot be meant of how bodies move, unless a program moves them by loads or velocities.
pub(crate) fn slips_unless_driven(model: &Model, particles: &Particles) -> Vec<String> {
    let courses = courses(model, particles);
    let bodies = 0..model.bodies.len();
    let left: Vec<String> = bodies.filter_map(|b| leaves_its_wall(model, &courses, b)).collect();
    let falls = falls_away(model, &courses);
    // What leaves a wall has been told to meet nothing.
    let ways = if left.is_empty() && falls.is_none() { ways(model, particles) } else { Vec::new() };
    let rest = at_rest(model, particles).into_iter();
    let drives = drives::notes(model, particles);
    rest.chain(left).chain(ways).chain(falls).chain(drives).chain(blind_measures(model, particles)).collect()
}

/// How many times as far as the fastest of the start something may get: jets outrun what makes them.
const OUTRUN: f64 = 3.0;

/// Farthest that anything gets, m.
fn reach(model: &Model, particles: &Particles) -> f64 {
    if !model.thermal.mechanics {
        return 0.0;
    }
    let size = |v: &[f64; 3]| (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    let most = |table: &TimeTable| table.points.iter().fold(0.0f64, |most, (_, value)| most.max(value.abs()));
    let driven = model.motions.iter().flat_map(|motion| &motion.axes).filter_map(|axis| match axis {
        MotionAxis::Velocity(table) => Some(most(table)),
        MotionAxis::Free => None,
    });
    let walls = model.walls.iter().flat_map(|wall| &wall.velocity).map(most);
    let fastest = particles.velocity.iter().map(size).chain(driven).chain(walls).fold(0.0, f64::max);
    OUTRUN * model.time.end * (fastest + size(&model.gravity) * model.time.end)
}

/// Measures of places where no material is and none gets to.
fn blind_measures(model: &Model, particles: &Particles) -> Vec<String> {
    if model.periodic.iter().any(Option::is_some) || model.measures.is_empty() {
        return Vec::new();
    }
    let dimensions = model.dimensions.count();
    let support = model.numerics.kernel.support();
    let reach = reach(model, particles);
    let note = |measure: &Measure| {
        let (selection, point) = match &measure.kind {
            MeasureKind::Value { selection, point, .. } => (selection, Some(*point)),
            MeasureKind::Extent { selection, .. }
            | MeasureKind::Diameter { selection, .. }
            | MeasureKind::Extreme { selection, .. }
            | MeasureKind::Mean { selection, .. }
            | MeasureKind::FrontSpeed { selection, .. }
            | MeasureKind::Period { selection, .. }
            | MeasureKind::ReversalTime { selection, .. } => (selection, None),
            MeasureKind::CraterDiameter { .. } | MeasureKind::Cloud { .. } | MeasureKind::Fragments { .. } => {
                return None;
            }
        };
        let is_selected = |i: &usize| {
            selection.body.is_none_or(|body| particles.body[*i] as usize == body)
                && selection.region.is_none_or(|region| particles.regions[*i] >> region & 1 == 1)
        };
        let selected = || (0..particles.len()).filter(is_selected);
        let name = &measure.name;
        if selected().next().is_none() {
            return Some(format!("measure `{name}` has no value: no particle of its region belongs to its body"));
        }
        // How far a particle is from what the measure looks at, along each axis and in all.
        let size = |along: &dyn Fn(usize) -> f64| (0..dimensions).map(|a| along(a).powi(2)).sum::<f64>().sqrt();
        let from_window = |i: usize| {
            selection.window.map_or(0.0, |(min, max)| {
                let x = particles.position[i];
                size(&|a| (min[a] - x[a]).max(x[a] - max[a]).max(0.0))
            })
        };
        let from_point = |i: usize| {
            let beyond = support * particles.smoothing_length[i];
            point.map_or(0.0, |point| (size(&|a| point[a] - particles.position[i][a]) - beyond).max(0.0))
        };
        let least = |of: &dyn Fn(usize) -> f64| selected().map(of).fold(f64::INFINITY, f64::min);
        let (of_window, of_point) = (least(&from_window), least(&from_point));
        let (what, away) = if of_window > reach {
            ("`window`", of_window)
        } else if of_point > reach {
            ("`point`", least(&|i| point.map_or(0.0, |point| size(&|a| point[a] - particles.position[i][a]))))
        } else {
            return None;
        };
        Some(format!(
            "measure `{name}` has no value at the start, and nothing is fast enough to get there: its {what} is {:.4} mm from the nearest particle; \
             check its unit",
            1e3 * away
        ))
    };
    model.measures.iter().filter_map(note).collect()
}

/// A flow stress that no metal has.
fn of_material(material: &Material) -> Option<String> {
    let yields = material.yield_stress_at_rest(0.0, material.reference_temperature);
    (yields > 0.0 && yields < LEAST_YIELD * material.shear_modulus).then(|| {
        format!(
            "material `{}` yields at {}, {:.0e} of its shear modulus: no metal yields at so little; write the unit, as in `\"350 MPa\"`",
            material.name,
            shown(yields, "Pa"),
            yields / material.shear_modulus
        )
    })
}

/// An end that the steps of the model do not reach.
fn too_long(model: &Model) -> Option<String> {
    if !model.thermal.mechanics || model.time.max_steps.is_some() {
        return None;
    }
    let speed = |body: &Body| {
        let material = &model.materials[body.material];
        let bulk = material.equation_of_state.reference_sound_speed();
        (bulk * bulk + 4.0 / 3.0 * material.shear_modulus / material.density).sqrt()
    };
    // A material without its units has been told.
    if model.bodies.iter().any(|body| speed(body) > FASTEST_SOUND) {
        return None;
    }
    let step = |body: &Body| model.time.courant * body.smoothing_length / speed(body);
    let shortest = model.bodies.iter().map(step).fold(f64::INFINITY, f64::min);
    let steps = model.time.end / model.time.fixed_step.unwrap_or(shortest);
    (steps > MANY_STEPS).then(|| {
        format!(
            "to {} s the run takes some {steps:.0e} steps: impacts take micro- or milliseconds, as in `end = \"20 us\"`",
            model.time.end
        )
    })
}

/// Where a body is, m, and its velocity, m/s, means over its particles.
#[derive(Clone, Copy, Default)]
struct Course {
    centre: [f64; 3],
    velocity: [f64; 3],
}

/// Those of all bodies, in one pass: there may be many.
fn courses(model: &Model, particles: &Particles) -> Vec<Course> {
    let mut sums = vec![(0.0, Course::default()); model.bodies.len()];
    for ((&body, x), v) in particles.body.iter().zip(&particles.position).zip(&particles.velocity) {
        let (count, course) = &mut sums[body as usize];
        *count += 1.0;
        for k in 0..3 {
            course.centre[k] += x[k];
            course.velocity[k] += v[k];
        }
    }
    let mean = |(count, Course { centre, velocity }): (f64, Course)| {
        let of = |sum: [f64; 3]| sum.map(|c| if count > 0.0 { c / count } else { 0.0 });
        Course { centre: of(centre), velocity: of(velocity) }
    };
    sums.into_iter().map(mean).collect()
}

fn moves(table: &TimeTable) -> bool {
    table.points.iter().any(|(_, value)| *value != 0.0)
}

/// A deck in which nothing happens.
fn at_rest(model: &Model, particles: &Particles) -> Option<String> {
    let driven = |axis: &MotionAxis| matches!(axis, MotionAxis::Velocity(table) if moves(table));
    // So many steps of anything are a measurement of speed.
    let goes_on = !model.thermal.mechanics
        || model.time.max_steps.is_some()
        || model.thermal.conduction
        || model.gravity != [0.0; 3]
        || particles.velocity.iter().flatten().any(|v| *v != 0.0)
        || model.walls.iter().any(|wall| wall.velocity.iter().any(moves))
        || model.motions.iter().any(|motion| motion.axes.iter().any(driven))
        || model.bodies.iter().any(|body| body.temperature != model.materials[body.material].reference_temperature)
        // A press fit sets itself in motion.
        || !pressed_at_start(model, particles).is_empty();
    (!goes_on).then(|| {
        "nothing moves: no body has a velocity, and no wall, driven region, gravity or heat sets one in motion; give a body a `velocity`".to_owned()
    })
}

/// A body that meets nothing and leaves a wall.
fn leaves_its_wall(model: &Model, courses: &[Course], b: usize) -> Option<String> {
    let Course { centre: here, velocity: own } = courses[b];
    let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| a[k] * b[k]).sum::<f64>();
    let minus = |a: [f64; 3], b: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| a[k] - b[k]) };
    let speed = dot(own, own).sqrt();
    if speed == 0.0
        || model.gravity != [0.0; 3]
        || !model.motions.is_empty()
        || model.periodic.iter().any(Option::is_some)
    {
        return None;
    }
    // Nothing else is met: no body comes nearer, and no plane of symmetry.
    let others = courses.iter().enumerate().filter(|(other, _)| *other != b);
    let mut nearing = others.map(|(_, of)| dot(minus(of.centre, here), minus(of.velocity, own)));
    let meets_body = nearing.any(|rate| rate < 0.0);
    let meets_plane = model.symmetry.iter().any(|plane| plane.side * own[plane.axis] < -1e-9 * speed);
    if meets_body || meets_plane {
        return None;
    }
    let mut left = None;
    for wall in &model.walls {
        let WallSurface::Plane { normal, .. } = wall.surface else { return None };
        if wall.velocity.iter().any(|table| table.points.len() > 1) {
            return None;
        }
        let away = dot(minus(own, [0, 1, 2].map(|k| wall.velocity[k].at(0.0))), normal);
        if away <= 1e-9 * speed {
            return None;
        }
        left = left.or(Some((wall, away)));
    }
    left.map(|(wall, away)| {
        format!(
            "body `{}` flies away from wall `{}` at {away:.0} m/s and meets nothing else: check the signs of its velocity and of the normal, \
             which points to the side where bodies are",
            model.bodies[b].name, wall.name
        )
    })
}

/// Gravity that takes bodies away from the only walls there are.
fn falls_away(model: &Model, courses: &[Course]) -> Option<String> {
    let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| a[k] * b[k]).sum::<f64>();
    let size = dot(model.gravity, model.gravity).sqrt();
    let is_held = !model.motions.is_empty()
        || model.periodic.iter().any(Option::is_some)
        || model.symmetry.iter().any(|plane| plane.side * model.gravity[plane.axis] < 0.0);
    if size == 0.0 || is_held {
        return None;
    }
    let mut away = None;
    for wall in &model.walls {
        let WallSurface::Plane { normal, .. } = wall.surface else { return None };
        let along = dot(model.gravity, normal);
        let velocity = [0, 1, 2].map(|k| wall.velocity[k].at(0.0));
        // What is thrown at a ceiling meets it.
        let is_met = courses.iter().any(|course| dot(course.velocity, normal) < dot(velocity, normal));
        if along < -0.1 * size || is_met || wall.velocity.iter().any(|table| table.points.len() > 1) {
            return None;
        }
        away = away.or((along > 0.5 * size).then_some(wall));
    }
    away.map(|wall| {
        format!(
            "gravity points away from wall `{}`, to the side its normal points to: bodies fall off it and meet nothing; check the signs of `gravity` \
             and of the normal, which points to the side where bodies are",
            wall.name
        )
    })
}

/// A list of particles whose volumes or distances are not those of the spacing.
fn of_list(model: &Model, particles: &Particles, b: usize, body: &Body) -> Option<String> {
    let Solid::Cloud { particles: listed, .. } = &body.shape.solid else { return None };
    let (name, spacing) = (&body.name, body.spacing);
    let dimensions = model.dimensions.count();
    let cell = spacing.powi(dimensions as i32);
    let unit = ["m", "m^2", "m^3"][dimensions - 1];
    let mean = |of: &dyn Fn(&CloudShare) -> Option<f64>| {
        let volumes: Vec<f64> = listed.iter().filter_map(|particle| of(&particle.share)).collect();
        (!volumes.is_empty()).then(|| volumes.iter().sum::<f64>() / volumes.len() as f64)
    };
    let density = model.materials[body.material].density;
    let volume = mean(&|share| match *share {
        CloudShare::Spacing => None,
        CloudShare::Volume(volume) => Some(volume),
        CloudShare::Mass(mass) => Some(mass / density),
    });
    let edge = |volume: f64| (volume / cell).powf(1.0 / dimensions as f64);
    if let Some(volume) = volume.filter(|volume| !(DISTANCES[0]..=DISTANCES[1]).contains(&edge(*volume))) {
        return Some(format!(
            "the particles listed for body `{name}` stand for {volume:.3e} {unit} each, where the spacing makes {cell:.3e} {unit}: give the body a \
             `spacing` that fits, or the unit, as in `{}`",
            match has_masses(listed) {
                true => "mass-unit = \"g\"".to_owned(),
                false => format!("volume-unit = \"{}\"", ["mm", "mm^2", "mm^3"][dimensions - 1]),
            }
        ));
    }
    let places: Vec<[f64; 3]> = particles
        .body
        .iter()
        .zip(&particles.position)
        .filter(|(body, _)| **body as usize == b)
        .map(|(_, x)| *x)
        .collect();
    let apart = typical_distance(&places, spacing)?;
    (!(DISTANCES[0]..=DISTANCES[1]).contains(&(apart / spacing))).then(|| {
        format!(
            "the particles listed for body `{name}` are {:.3} mm apart, and the spacing is {:.3} mm: give the body a `spacing` that fits, or each \
             particle its volume; check `length-unit`",
            1e3 * apart,
            1e3 * spacing
        )
    })
}

fn has_masses(listed: &[CloudParticle]) -> bool {
    listed.iter().any(|particle| matches!(particle.share, CloudShare::Mass(_)))
}

/// The middle one of the distances of some particles to their nearest, m.
fn typical_distance(places: &[[f64; 3]], spacing: f64) -> Option<f64> {
    /// Particles that are asked.
    const SAMPLE: usize = 200;
    let stride = places.len().div_ceil(SAMPLE).max(1);
    let squared = |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>();
    let nearest = |x: &[f64; 3]| {
        let others = places.iter().map(|y| squared(x, y)).filter(|d| *d > 1e-12 * spacing * spacing);
        others.fold(f64::INFINITY, f64::min).sqrt()
    };
    let mut distances: Vec<f64> = places.iter().step_by(stride).map(nearest).filter(|d| d.is_finite()).collect();
    distances.sort_by(f64::total_cmp);
    distances.get(distances.len() / 2).copied()
}

/// Sections that cut nothing.
fn empty_sections(model: &Model, particles: &Particles) -> Vec<String> {
    let empty = model.sections.iter().filter(|section| {
        let of_body = |body: u32| section.body.is_none_or(|of| of == body as usize);
        let side =
            |i: usize| (0..3).map(|k| (particles.position[i][k] - section.point[k]) * section.normal[k]).sum::<f64>();
        let places = (0..particles.len()).filter(|&i| of_body(particles.body[i])).map(side);
        let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        !(low < 0.0 && high > 0.0)
    });
    empty
        .map(|section| {
            let of = section
                .body
                .map_or_else(|| "no body".to_owned(), |body| format!("body `{}` nowhere", model.bodies[body].name));
            format!(
                "section `{}` cuts {of} at the start: its force is zero until material comes there; check its `point`",
                section.name
            )
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use crate::{decks, load_text};

    /// A bar of steel on its way to a wall, with a section and a piece of it replaced.
    fn notes(replaced: &[(&str, &str)]) -> Vec<String> {
        let mut deck = "dimensions = \"plane-strain\"\nparticles = { spacing = \"1 mm\" }\ntime = { end = \"20 us\" }\n\
                        [material.m]\ndensity = \"7850 kg/m^3\"\nyoung-modulus = \"210 GPa\"\npoisson-ratio = 0.3\n\
                        strength = { perfectly-plastic = { yield-stress = \"350 MPa\" } }\n\
                        [[body]]\nname = \"bar\"\nmaterial = \"m\"\nshape = { box = { min = [0, 0], max = [\"6 mm\", \"12 mm\"] } }\n\
                        velocity = [\"0 m/s\", \"-10 m/s\"]\n\
                        [[wall]]\nname = \"anvil\"\nplane = { point = [0, 0], normal = [0, 1] }\n\
                        [[section]]\nname = \"middle\"\npoint = [0, \"6 mm\"]\nnormal = [0, 1]\n"
            .to_owned();
        for (old, new) in replaced {
            assert!(deck.contains(old), "{old}");
            deck = deck.replace(old, new);
        }
        load_text("bar", &deck, &[]).unwrap().all_notes()
    }

    #[track_caller]
    fn told(replaced: &[(&str, &str)], words: &[&str]) {
        let notes = notes(replaced);
        let note = notes.first().expect("a note");
        assert!(words.iter().all(|word| note.contains(word)), "{notes:?}");
        assert_eq!(notes.len(), 1, "{notes:?}");
    }

    #[test]
    fn a_deck_that_is_meant_hears_nothing() {
        assert_eq!(notes(&[]), [""; 0]);
        for deck in decks::DECKS {
            let setup = load_text(deck.name, deck.text, &[]).unwrap();
            for slips in [super::slips, super::slips_unless_driven] {
                assert_eq!(slips(&setup.model, &setup.particles), [""; 0], "{}", deck.name);
            }
        }
    }

    #[test]
    fn numbers_in_tonnes_and_millimetres_are_told() {
        told(
            &[("\"7850 kg/m^3\"", "7.85e-9"), ("\"210 GPa\"", "210000"), ("\"350 MPa\"", "350")],
            &["`m`", "density of 7.85e-9 kg/m^3", "in SI"],
        );
        // With the right density, the modulus alone.
        told(
            &[("\"210 GPa\"", "210000"), ("\"350 MPa\"", "350")],
            &["Young's modulus of 2.1e5 Pa", "\"210 GPa\" meant"],
        );
    }

    #[test]
    fn a_yield_stress_of_350_pascal_is_told() {
        told(&[("\"350 MPa\"", "350")], &["`m` yields at 350 Pa", "350 MPa"]);
        assert_eq!(notes(&[("\"350 MPa\"", "\"1 MPa\"")]), [""; 0]);
    }

    #[test]
    fn an_end_in_seconds_is_told_where_steps_would_not_reach_it() {
        told(&[("\"20 us\"", "20")], &["to 20 s", "steps", "20 us"]);
        assert_eq!(notes(&[("\"20 us\"", "\"20 ms\"")]), [""; 0]);
    }

    #[test]
    fn a_deck_in_which_nothing_moves_is_told() {
        told(&[("\"-10 m/s\"", "\"0 m/s\"")], &["nothing moves"]);
        assert_eq!(
            notes(&[("\"-10 m/s\"", "\"0 m/s\""), ("[material.m]", "gravity = [0, \"-9.81 m/s^2\"]\n[material.m]")]),
            [""; 0]
        );
        let driven = ("normal = [0, 1] }\n", "normal = [0, 1] }\nvelocity = [0, \"5 m/s\"]\n");
        assert_eq!(notes(&[("\"-10 m/s\"", "\"0 m/s\""), driven]), [""; 0]);
    }

    #[test]
    fn a_body_that_leaves_its_wall_is_told() {
        told(&[("\"-10 m/s\"", "\"10 m/s\"")], &["`bar` flies away from wall `anvil` at 10 m/s"]);
        // Past it, towards another, or after a wall that follows faster.
        assert_eq!(notes(&[("[\"0 m/s\", \"-10 m/s\"]", "[\"5 m/s\", \"0 m/s\"]")]), [""; 0]);
        let other = (
            "[[section]]",
            "[[wall]]\nname = \"lid\"\nplane = { point = [0, \"20 mm\"], normal = [0, -1] }\n[[section]]",
        );
        assert_eq!(notes(&[("\"-10 m/s\"", "\"10 m/s\""), ("\"20 us\"", "\"2 ms\""), other]), [""; 0]);
        let follows = ("normal = [0, 1] }\n", "normal = [0, 1] }\nvelocity = [0, \"50 m/s\"]\n");
        assert_eq!(notes(&[("\"-10 m/s\"", "\"10 m/s\""), follows]), [""; 0]);
    }

    #[test]
    fn gravity_away_from_the_only_floor_is_told() {
        let falls = |g: &str| format!("gravity = [0, \"{g} m/s^2\"]\n[material.m]");
        let rests = ("\"-10 m/s\"", "\"0 m/s\"");
        told(&[rests, ("[material.m]", &falls("9.81"))], &["gravity points away from wall `anvil`"]);
        assert_eq!(notes(&[rests, ("[material.m]", &falls("-9.81"))]), [""; 0]);
        // What is thrown at a ceiling, and what falls from one wall to another.
        assert_eq!(notes(&[("[material.m]", &falls("9.81"))]), [""; 0]);
        let lid = (
            "[[section]]",
            "[[wall]]\nname = \"lid\"\nplane = { point = [0, \"20 mm\"], normal = [0, -1] }\n[[section]]",
        );
        assert_eq!(notes(&[rests, lid, ("[material.m]", &falls("9.81"))]), [""; 0]);
    }

    #[test]
    fn a_section_that_cuts_nothing_is_told() {
        told(&[("\"6 mm\"]\nnormal", "\"60 mm\"]\nnormal")], &["`middle` cuts no body"]);
        let of = ("normal = [0, 1]\n", "normal = [0, 1]\nbody = \"bar\"\n");
        told(&[("\"6 mm\"]\nnormal", "\"60 mm\"]\nnormal"), of], &["`middle` cuts body `bar` nowhere"]);
    }

    #[test]
    fn a_measure_of_a_place_that_nothing_gets_to_is_told() {
        let measured =
            |kind: &str| notes(&[("[[section]]", &format!("[[measure]]\nname = \"p\"\n{kind}\n[[section]]"))]);
        // The bar is 12 mm high and gets 0.2 mm far, three times that at the most.
        let value = |y: &str| measured(&format!("value = {{ field = \"pressure\", point = [\"3 mm\", \"{y} mm\"] }}"));
        assert!(
            value("20")[0].contains("`p` has no value at the start") && value("20").len() == 1,
            "{:?}",
            value("20")
        );
        assert!(value("20")[0].contains("its `point` is 8.5147 mm from the nearest particle"), "{:?}", value("20"));
        // The last particle is at 11.5 mm, and its kernel reaches further than a spacing.
        for y in ["6", "12.5", "13"] {
            assert_eq!(value(y), [""; 0], "{y}");
        }
        assert_eq!(value("15").len(), 1);
        let mean = |low: &str, high: &str| {
            let window = format!("{{ min = [\"0 mm\", \"{low}\"], max = [\"6 mm\", \"{high}\"] }}");
            measured(&format!("mean = {{ field = \"pressure\", window = {window} }}"))
        };
        let told = mean("12.2 mm", "20 mm");
        assert!(told.len() == 1 && told[0].contains("its `window` is 0.7000 mm from the nearest"), "{told:?}");
        for (low, high) in [("12 mm", "20 mm"), ("11 mm", "20 mm"), ("-5 mm", "0.1 mm")] {
            assert_eq!(mean(low, high), [""; 0], "{low}");
        }
        let two = "[[measure]]\nname = \"p\"\nmean = { field = \"pressure\", body = \"bar\", region = \"other\" }\n[[region]]\nname = \"other\"\nbody = \
                   \"far\"\n[[body]]\nname = \"far\"\nmaterial = \"m\"\nshape = { box = { min = [\"20 mm\", \"5 mm\"], max = [\"26 mm\", \"17 mm\"] } \
                   }\nvelocity = [\"0 m/s\", \"-10 m/s\"]\n[[section]]";
        let told = notes(&[("\"20 us\"", "\"2 ms\""), ("[[section]]", two)]);
        assert!(told.iter().any(|note| note.contains("`p` has no value: no particle of its region")), "{told:?}");
    }

    #[test]
    fn lists_whose_volumes_or_distances_are_not_those_of_the_spacing_are_told() {
        let folder = tempfile::tempdir().unwrap();
        let notes = |name: &str, rows: &dyn Fn(u32) -> String, head: &str| {
            let text: String = (0..36).map(|k| rows(k) + "\n").collect();
            std::fs::write(folder.path().join(name), format!("{head}\n{text}")).unwrap();
            let deck = format!(
                "dimensions = \"plane-strain\"\nparticles = {{ spacing = \"1 mm\" }}\ntime = {{ end = \"1 us\", max-steps = 1 }}\n[[body]]\nname = \"b\"\n\
                 material = \"armco-iron\"\nshape = {{ table = {{ file = \"{name}\", length-unit = \"mm\" }} }}\nvelocity = [1, 0]\n"
            );
            let path = folder.path().join("deck.toml");
            std::fs::write(&path, deck).unwrap();
            crate::load(&path, &[], 1e6).unwrap().all_notes()
        };
        let at = |k: u32, pitch: u32| format!("{},{}", pitch * (k % 6), pitch * (k / 6));
        assert_eq!(notes("fits.csv", &|k| at(k, 1), "x,y"), [""; 0]);
        let wide = notes("wide.csv", &|k| at(k, 2), "x,y");
        assert!(
            wide.len() == 1 && wide[0].contains("2.000 mm apart") && wide[0].contains("spacing is 1.000 mm"),
            "{wide:?}"
        );
        let volume = notes("volume.csv", &|k| format!("{},1", at(k, 1)), "x,y,volume");
        assert!(
            volume.len() == 1 && volume[0].contains("1.000e0 m^2 each") && volume[0].contains("1.000e-6 m^2"),
            "{volume:?}"
        );
        // Those of another spacing: three times as long, and within what a list may differ by.
        let of = |volume: &str| notes("of.csv", &|k| format!("{},{volume}", at(k, 1)), "x,y,volume");
        for (volume, is_told) in [("9e-6", true), ("2e-6", false), ("5e-7", false), ("1e-7", true)] {
            assert_eq!(of(volume).len(), usize::from(is_told), "{volume}: {:?}", of(volume));
        }
    }
}
