//! Motions that nobody means: through a plane of symmetry, away from all there is, of a whole body, or of another time scale. Said by `sphorge check`
//! and `sphorge run`.

use crate::placement::millimetres;
use crate::suggest::listed;
use sphorge_engine::Particles;
use sphorge_engine::model::{
    Body, BodyContact, Measure, MeasureKind, Model, MotionAxis, PrescribedMotion, TimeTable, WallSurface,
};

/// Instants at which courses are looked at, beside the rows of their tables.
const INSTANTS: u32 = 64;
/// Gap that two bodies may have lost by rounding, in spacings.
const TOUCHES: f64 = 0.25;
/// How many times their distance driven parts of a body may move apart: no solid bears it.
const LONGEST: f64 = 20.0;
/// Share of the strain at yield below which nothing yields, even at notches and by waves.
const ELASTIC: f64 = 0.1;

const AXES: [&str; 3] = ["x", "y", "z"];

/// What motions of a model do that nobody means.
pub(crate) fn notes(model: &Model, particles: &Particles) -> Vec<String> {
    if !model.thermal.mechanics || model.time.max_steps.is_some() || model.motions.is_empty() {
        return Vec::new();
    }
    let mut notes = through_symmetry(model, particles);
    let idle = in_nothings_way(model, particles).or_else(|| all_alike(model, particles));
    match idle {
        Some(note) => notes.push(note),
        None => notes.extend(apart(model, particles)),
    }
    notes
}

fn name<'a>(model: &'a Model, motion: &PrescribedMotion) -> &'a str {
    &model.regions[motion.region].name
}

fn is_driven(particles: &Particles, i: usize, motion: &PrescribedMotion) -> bool {
    particles.regions[i] >> motion.region & 1 == 1
}

/// Where a motion has carried its particles until a time, m, along one axis; `None` where that is free.
fn travel(motion: &PrescribedMotion, axis: usize, time: f64) -> Option<f64> {
    match &motion.axes[axis] {
        MotionAxis::Free => None,
        MotionAxis::Velocity(table) => Some(table.integral(0.0, time)),
    }
}

/// Instants from the start to the end, with those at which tables turn.
fn instants(model: &Model) -> Vec<f64> {
    let end = model.time.end;
    let rows = model.motions.iter().flat_map(|motion| &motion.axes).filter_map(|axis| match axis {
        MotionAxis::Velocity(table) => Some(&table.points),
        MotionAxis::Free => None,
    });
    let rows = rows.flatten().map(|(time, _)| *time).filter(|time| (0.0..end).contains(time));
    (0..=INSTANTS).map(|k| end * f64::from(k) / f64::from(INSTANTS)).chain(rows).collect()
}

/// Motions along the normal of a symmetry plane of particles that stand at it, or get to it.
fn through_symmetry(model: &Model, particles: &Particles) -> Vec<String> {
    let instants = instants(model);
    let mut notes = Vec::new();
    for motion in &model.motions {
        for plane in &model.symmetry {
            let travels = instants.iter().filter_map(|&time| travel(motion, plane.axis, time)).map(|s| plane.side * s);
            let least = travels.fold(0.0f64, f64::min);
            let driven = (0..particles.len()).filter(|&i| is_driven(particles, i, motion));
            let depth = driven
                .map(|i| (particles.position[i][plane.axis] - plane.position) * plane.side)
                .fold(f64::INFINITY, f64::min);
            let (name, axis) = (name(model, motion), AXES[plane.axis]);
            // The centres of particles do not get to a plane.
            if -least > depth {
                notes.push(format!(
                    "motion `{name}` drives particles through symmetry plane {axis}: they start {} from it and are moved {} towards it; hold their velocity along \
                     {axis} at \"0 m/s\", or give it to another axis",
                    millimetres(depth),
                    millimetres(-least)
                ));
            }
        }
    }
    notes
}

/// Whether anything but motions sets bodies in motion, or strains them.
fn has_other_causes(model: &Model, particles: &Particles) -> bool {
    let moves = |table: &TimeTable| table.points.iter().any(|(_, value)| *value != 0.0);
    model.gravity != [0.0; 3]
        || model.thermal.conduction
        || model.periodic.iter().any(Option::is_some)
        || particles.velocity.iter().flatten().any(|v| *v != 0.0)
        || model.walls.iter().any(|wall| wall.velocity.iter().any(moves))
        || model.bodies.iter().any(|body| body.temperature != model.materials[body.material].reference_temperature)
}

fn drives(motion: &PrescribedMotion) -> bool {
    motion
        .axes
        .iter()
        .any(|axis| matches!(axis, MotionAxis::Velocity(table) if table.points.iter().any(|(_, v)| *v != 0.0)))
}

/// The box around the particles of a body or a motion, with their cells.
#[derive(Clone, Copy)]
struct Around {
    low: [f64; 3],
    high: [f64; 3],
}

fn around(model: &Model, particles: &Particles, is_one: impl Fn(usize) -> bool) -> Option<Around> {
    let mut found: Option<Around> = None;
    for i in (0..particles.len()).filter(|&i| is_one(i)) {
        let (x, half) = (particles.position[i], 0.5 * model.bodies[particles.body[i] as usize].spacing);
        let of = found.get_or_insert(Around { low: x, high: x });
        for a in 0..3 {
            of.low[a] = of.low[a].min(x[a] - half);
            of.high[a] = of.high[a].max(x[a] + half);
        }
    }
    found
}

/// Whole bodies that are driven, and touch nothing on their way: then nothing is strained.
fn in_nothings_way(model: &Model, particles: &Particles) -> Option<String> {
    // What sticks is pulled along.
    let sticks = model.bodies.len() > 1 && matches!(model.contact, BodyContact::Sph);
    if sticks || has_other_causes(model, particles) {
        return None;
    }
    let dimensions = model.dimensions.count();
    let mut whole: Vec<(usize, &PrescribedMotion)> = Vec::new();
    for motion in model.motions.iter().filter(|motion| drives(motion)) {
        let body = (0..particles.len()).find(|&i| is_driven(particles, i, motion)).map(|i| particles.body[i])?;
        let is_one = (0..particles.len()).all(|i| is_driven(particles, i, motion) == (particles.body[i] == body));
        let is_held = motion.axes.iter().take(dimensions).all(|axis| matches!(axis, MotionAxis::Velocity(_)));
        let is_first = whole.iter().all(|(other, _)| *other != body as usize);
        if !(is_one && is_held && is_first) {
            return None;
        }
        whole.push((body as usize, motion));
    }
    whole.first()?;
    let boxes: Vec<Around> = (0..model.bodies.len())
        .map(|body| around(model, particles, |i| particles.body[i] as usize == body))
        .collect::<Option<_>>()?;
    let instants = instants(model);
    let at = |body: usize, axis: usize, time: f64| {
        whole.iter().find(|(of, _)| *of == body).and_then(|(_, motion)| travel(motion, axis, time)).unwrap_or(0.0)
    };
    for &(body, _) in &whole {
        let spacing = model.bodies[body].spacing;
        for other in (0..boxes.len()).filter(|&other| other != body) {
            // One axis along which they never get nearer, or stay apart.
            let is_clear = (0..dimensions).any(|a| {
                let gap = |time: f64| {
                    let [s, t] = [at(body, a, time), at(other, a, time)];
                    (boxes[body].low[a] + s - boxes[other].high[a] - t)
                        .max(boxes[other].low[a] + t - boxes[body].high[a] - s)
                };
                let far = 3.0 * spacing.max(model.bodies[other].spacing);
                let start = gap(0.0);
                start > -TOUCHES * spacing && instants.iter().all(|&time| gap(time) >= far.min(start) - 1e-9 * spacing)
            });
            if !is_clear {
                return None;
            }
        }
        for wall in &model.walls {
            let WallSurface::Plane { point, normal } = wall.surface else { return None };
            let gap = |time: f64| -> f64 {
                (0..3)
                    .map(|a| {
                        let x = if normal[a] > 0.0 { boxes[body].low[a] } else { boxes[body].high[a] };
                        (x + at(body, a, time) - point[a]) * normal[a]
                    })
                    .sum()
            };
            let start = gap(0.0);
            if !instants.iter().all(|&time| gap(time) >= start.min(3.0 * spacing) - 1e-9 * spacing) {
                return None;
            }
        }
        // Images in planes that it moves to or from have been told where they are met.
        if model.symmetry.iter().any(|plane| instants.iter().any(|&time| at(body, plane.axis, time) != 0.0)) {
            return None;
        }
    }
    let names = listed(whole.iter().map(|(_, motion)| name(model, motion)), "and");
    let bodies = listed(whole.iter().map(|(body, _)| model.bodies[*body].name.as_str()), "and");
    let what = match whole.len() {
        1 => format!("motion {names} moves all of body {bodies}, and nothing is in its way"),
        _ => format!("motions {names} move all of bodies {bodies}, and nothing is in their way"),
    };
    Some(format!("{what}: nothing is strained; check the signs of the velocities, and where bodies start"))
}

/// Several motions of one body, all of one velocity, where nothing else is.
fn all_alike(model: &Model, particles: &Particles) -> Option<String> {
    let [first, rest @ ..] = &model.motions[..] else { return None };
    let is_alone = model.bodies.len() == 1 && model.walls.is_empty() && model.symmetry.is_empty();
    let are_alike = !rest.is_empty() && rest.iter().all(|motion| motion.axes == first.axes);
    if !(is_alone && are_alike && drives(first)) || has_other_causes(model, particles) {
        return None;
    }
    Some(format!(
        "motions {} have one velocity: they carry body `{}` along as a whole and do not strain it; give them different velocities, or hold one of them",
        listed(model.motions.iter().map(|motion| name(model, motion)), "and"),
        model.bodies[0].name
    ))
}

/// Motions of two parts of one body that part them, or bring them together, farther than any solid bears; or so little that what is measured stays zero.
fn apart(model: &Model, particles: &Particles) -> Vec<String> {
    let instants = instants(model);
    let dimensions = model.dimensions.count();
    let mut notes = Vec::new();
    let mut strains = Vec::new();
    // What has no strength is stirred.
    let solid = |body: &Body| model.materials[body.material].shear_modulus > 0.0;
    for (b, body) in model.bodies.iter().enumerate().filter(|(_, body)| solid(body)) {
        let parts: Vec<(&PrescribedMotion, Around)> = model
            .motions
            .iter()
            .filter_map(|motion| {
                let is_one = |i: usize| particles.body[i] as usize == b && is_driven(particles, i, motion);
                Some((motion, around(model, particles, is_one)?))
            })
            .collect();
        'pairs: for (k, (one, of_one)) in parts.iter().enumerate() {
            for (other, of_other) in &parts[k + 1..] {
                let gaps: [f64; 3] =
                    std::array::from_fn(|a| (of_one.low[a] - of_other.high[a]).max(of_other.low[a] - of_one.high[a]));
                let distance = gaps.iter().map(|gap| gap.max(0.0).powi(2)).sum::<f64>().sqrt();
                if distance < body.spacing {
                    continue;
                }
                let moved = |time: f64| -> f64 {
                    let along = |a: usize| Some(travel(one, a, time)? - travel(other, a, time)?);
                    (0..dimensions).filter_map(along).map(|s| s * s).sum::<f64>().sqrt()
                };
                let most = instants.iter().map(|&time| moved(time)).fold(0.0, f64::max);
                strains.push((b, most / distance));
                if most > LONGEST * distance && model.time.stop_kinetic_fraction.is_none() {
                    notes.push(format!(
                        "motions `{}` and `{}` move parts of body `{}` that are {} apart {:.3} m relative to each other, {:.0} times as far: check the unit of \
                         their velocities, and `time.end`",
                        name(model, one),
                        name(model, other),
                        body.name,
                        millimetres(distance),
                        most,
                        most / distance
                    ));
                    break 'pairs;
                }
            }
        }
    }
    notes.extend(never_yields(model, particles, &strains));
    notes
}

/// A measure of plastic strain of the only body, whose motions are too small to make any; given what they strain it.
fn never_yields(model: &Model, particles: &Particles, strains: &[(usize, f64)]) -> Option<String> {
    if model.bodies.len() != 1 || !model.walls.is_empty() || has_other_causes(model, particles) {
        return None;
    }
    let strain = strains.iter().map(|(_, strain)| *strain).fold(0.0, f64::max);
    let material = &model.materials[model.bodies[0].material];
    let stress = material.yield_stress_at_rest(0.0, material.reference_temperature);
    let modulus = material.shear_modulus;
    // Sudden velocities make waves of stress of at most `rho c v`, beside `E v t / L`.
    let sound = (3.0 * modulus / material.density).sqrt();
    let most = |axis: &MotionAxis| match axis {
        MotionAxis::Velocity(table) => table.points.iter().fold(0.0f64, |most, (_, v)| most.max(v.abs())),
        MotionAxis::Free => 0.0,
    };
    let fastest = model.motions.iter().flat_map(|motion| &motion.axes).map(most).fold(0.0, f64::max);
    let limit = ELASTIC * stress / (3.0 * modulus);
    let is_blind =
        |measure: &&Measure| matches!(&measure.kind, MeasureKind::Extreme { field, .. } if field == "plastic_strain");
    let measure = model.measures.iter().find(is_blind)?;
    let told = stress > 0.0 && strain > 0.0 && strain < limit && fastest / sound < limit;
    told.then(|| {
        format!(
            "measure `{}` stays zero: motions strain body `{}` by {:.2e} until the end, and it yields at some {:.0e}; check the unit of their velocities, and \
             `time.end`",
            measure.name,
            model.bodies[0].name,
            strain,
            stress / (3.0 * modulus)
        )
    })
}

#[cfg(test)]
mod tests {
    use crate::tests::notes::{notes_on, one_note_says};

    /// A strip below a punch that touches it, both at a symmetry plane across x.
    const BENT: &str = "dimensions = \"plane-strain\"\ncontact = \"penalty\"\nparticles = { spacing = \"1 mm\" }\ntime = { end = \"1 ms\" }\n\
                        [[symmetry]]\naxis = \"x\"\n\
                        [[body]]\nname = \"strip\"\nmaterial = \"armco-iron\"\nshape = { box = { min = [0, 0], max = [\"20 mm\", \"3 mm\"] } }\n\
                        [[body]]\nname = \"punch\"\nmaterial = \"armco-iron\"\nshape = { box = { min = [0, \"3 mm\"], max = [\"6 mm\", \"9 mm\"] } }\n\
                        [[region]]\nname = \"tool\"\nbody = \"punch\"\n[[motion]]\nregion = \"tool\"\nvelocity = [0, \"-4 m/s\"]\n";
    /// A bar with a grip at each end.
    const PULLED: &str = "dimensions = \"plane-strain\"\nparticles = { spacing = \"1 mm\" }\ntime = { end = \"1 ms\" }\n\
                          [[body]]\nname = \"bar\"\nmaterial = \"armco-iron\"\nshape = { box = { min = [0, 0], max = [\"40 mm\", \"6 mm\"] } }\n\
                          [[region]]\nname = \"left\"\nshape = { box = { min = [0, 0], max = [\"3 mm\", \"6 mm\"] } }\n\
                          [[region]]\nname = \"right\"\nshape = { box = { min = [\"37 mm\", 0], max = [\"40 mm\", \"6 mm\"] } }\n\
                          [[motion]]\nregion = \"left\"\nvelocity = [\"-3 m/s\", 0]\n\
                          [[motion]]\nregion = \"right\"\nvelocity = [\"3 m/s\", 0]\n\
                          [[measure]]\nname = \"strain\"\nmaximum = { body = \"bar\", field = \"plastic_strain\" }\n";

    #[track_caller]
    fn told(deck: &str, replaced: &[(&str, &str)], words: &str) {
        one_note_says(&notes_on(deck, replaced), words);
    }

    #[test]
    fn what_is_driven_through_its_image_is_told() {
        assert_eq!(notes_on(BENT, &[]), [""; 0]);
        let through = "motion `tool` drives particles through symmetry plane x: they start 0.5000 mm from it and are moved 4.0000 mm towards it";
        told(BENT, &[("[0, \"-4 m/s\"]", "[\"-4 m/s\", \"-4 m/s\"]")], through);
        // By a table, too, from the other side, and not of what stops before it.
        let table = "[[[\"0 s\", 0], [\"0.5 ms\", \"16 m/s\"], [\"1 ms\", \"-40 m/s\"]], \"-4 m/s\"]";
        told(BENT, &[("[0, \"-4 m/s\"]", table)], "through symmetry plane x");
        assert_eq!(notes_on(BENT, &[("[0, \"-4 m/s\"]", "[\"-0.3 m/s\", \"-4 m/s\"]")]), [""; 0]);
        assert_eq!(notes_on(BENT, &[("[0, \"-4 m/s\"]", "[\"free\", \"-4 m/s\"]")]), [""; 0]);
    }

    #[test]
    fn what_is_driven_away_from_all_there_is_is_told() {
        let idle = "motion `tool` moves all of body `punch`, and nothing is in its way";
        told(BENT, &[("\"-4 m/s\"", "\"4 m/s\"")], idle);
        // One that comes back, one that does not get to the strip, and one that sticks to it.
        let back = "[[\"0 s\", \"4 m/s\"], [\"1 ms\", \"-8 m/s\"]]";
        assert_eq!(notes_on(BENT, &[("\"-4 m/s\"", back)]), [""; 0]);
        told(BENT, &[("\"3 mm\"], max = [\"6 mm\", \"9 mm\"]", "\"20 mm\"], max = [\"6 mm\", \"26 mm\"]")], idle);
        assert_eq!(
            notes_on(
                BENT,
                &[
                    ("\"-4 m/s\"", "\"4 m/s\""),
                    ("contact = \"penalty\"\n", "method = \"updated-lagrangian\"\ncontact = \"kernel-sum\"\n")
                ]
            ),
            [""; 0]
        );
    }

    #[test]
    fn grips_that_do_not_strain_are_told() {
        assert_eq!(notes_on(PULLED, &[]), [""; 0]);
        told(
            PULLED,
            &[("\"-3 m/s\"", "\"3 m/s\"")],
            "motions `left` and `right` have one velocity: they carry body `bar` along as a whole",
        );
        assert_eq!(notes_on(PULLED, &[("\"-3 m/s\"", "\"2 m/s\"")]), [""; 0]);
        told(PULLED, &[("3 m/s", "1 mm/s")], "measure `strain` stays zero: motions strain body `bar` by 5.88e-5");
        // Elastic strains may be what is sought.
        assert_eq!(notes_on(PULLED, &[("3 m/s", "1 mm/s"), ("plastic_strain", "von_mises_stress")]), [""; 0]);
        assert_eq!(notes_on(PULLED, &[("3 m/s", "1 m/s")]), [""; 0]);
        told(
            PULLED,
            &[("3 m/s", "3000 m/s")],
            "that are 34.0000 mm apart 6.000 m relative to each other, 176 times as far",
        );
        assert_eq!(notes_on(PULLED, &[("3 m/s", "300 m/s")]), [""; 0]);
    }
}
