//! Bodies that are on their way to nothing, or do not get there before the end. Said by `sphorge check` and `sphorge run`.

use crate::bonds::reach;
use crate::falls;
use sphorge_engine::Particles;
use sphorge_engine::model::{Model, MotionAxis, TimeTable, WallSurface};

/// Spacings from which on bodies may feel each other, and walls.
pub(crate) const NEAR: f64 = 3.0;
/// Deviation of velocities, over the speed, up to which a body moves as a whole.
const UNIFORM: f64 = 1e-6;

/// A box that moves, m and m/s.
#[derive(Clone, Copy)]
pub(crate) struct Moving {
    pub(crate) low: [f64; 3],
    pub(crate) high: [f64; 3],
    pub(crate) velocity: [f64; 3],
}

/// When something is met, s: at the earliest by the boxes around it, and when these are as near as bodies feel each other.
#[derive(Clone, Copy)]
pub(crate) struct Meeting {
    pub(crate) touches: f64,
    pub(crate) feels: f64,
}

/// How the boxes around two bodies run into each other.
#[derive(Clone, Copy)]
pub(crate) struct Entry {
    /// From when and until when they overlap, s; not before the start.
    pub(crate) from: f64,
    pub(crate) until: f64,
    /// The axis along which they do so last, if they move relative to each other.
    pub(crate) axis: Option<usize>,
}

/// What the courses of bodies at the start say against the deck. Nothing where parts of a body bend them.
pub(crate) fn ways(model: &Model, particles: &Particles) -> Vec<String> {
    let bends =
        !model.thermal.mechanics || model.time.max_steps.is_some() || model.periodic.iter().any(Option::is_some);
    if bends {
        return Vec::new();
    }
    if model.gravity != [0.0; 3] {
        return falls::ways(model, particles);
    }
    let Some(bodies) = boxes(model, particles) else { return Vec::new() };
    let walls: Option<Vec<[f64; 3]>> = model.walls.iter().map(|wall| constant(&wall.velocity)).collect();
    let Some(walls) = walls else { return Vec::new() };
    let mut notes = Vec::new();
    let beside = beside_walls(model, &bodies, &walls);
    // Bodies that move together are one: the first to arrive counts.
    let mut told = vec![false; bodies.len()];
    for b in 0..bodies.len() {
        let own = bodies[b].velocity;
        let speed = dot(own, own).sqrt();
        if told[b] || speed == 0.0 {
            continue;
        }
        let group: Vec<usize> = (b..bodies.len()).filter(|&k| is_like(bodies[k].velocity, own)).collect();
        group.iter().for_each(|&k| told[k] = true);
        let mut first: Option<(Meeting, String, Option<usize>)> = None;
        let mut meet = |meeting: Option<Meeting>, what: String, body: Option<usize>| {
            let Some(meeting) = meeting else { return };
            if first.as_ref().is_none_or(|(other, ..)| meeting.feels < other.feels) {
                first = Some((meeting, what, body));
            }
        };
        for &k in &group {
            let near = NEAR * model.bodies[k].spacing;
            for (other, target) in bodies.iter().enumerate().filter(|(other, _)| !group.contains(other)) {
                meet(bodies[k].meets(target, near), format!("body `{}`", model.bodies[other].name), Some(other));
            }
            for (wall, &velocity) in model.walls.iter().zip(&walls) {
                let meeting = match wall.surface {
                    WallSurface::Plane { point, normal } => bodies[k].meets_plane(point, normal, velocity, near),
                    WallSurface::Segment { from, to } => {
                        let ends = |pick: fn(f64, f64) -> f64| std::array::from_fn(|a| pick(from[a], to[a]));
                        bodies[k].meets(&Moving { low: ends(f64::min), high: ends(f64::max), velocity }, near)
                    }
                };
                meet(meeting, format!("wall `{}`", wall.name), None);
            }
            for plane in &model.symmetry {
                // What lies at the plane and moves along it does as its image does.
                if own[plane.axis].abs() <= UNIFORM * speed {
                    continue;
                }
                let along = |value: f64| std::array::from_fn(|a| if a == plane.axis { value } else { 0.0 });
                // What is near enough to its image is bound to it, wherever it moves.
                let bond = bodies[k].meets_plane(
                    along(plane.position),
                    along(plane.side),
                    bodies[k].velocity,
                    reach(model, k),
                );
                let meeting = bodies[k].meets_plane(along(plane.position), along(plane.side), [0.0; 3], near).or(bond);
                meet(meeting, "a symmetry plane".to_owned(), None);
            }
        }
        let name = &model.bodies[b].name;
        match first {
            // What moves with a wall has been told.
            None if group.iter().any(|&k| beside.iter().any(|(body, _)| *body == k)) => {}
            None => notes.push(format!(
                "body `{name}` moves at {speed:.0} m/s and meets nothing: no body, wall or symmetry plane is in its way; check its velocity and where it starts"
            )),
            Some((meeting, what, target)) if meeting.feels > model.time.end => {
                // Of two that approach each other, one is told.
                target.into_iter().for_each(|target| told[target] = true);
                notes.push(format!(
                    "body `{name}` meets {what} after {} at the earliest, and the run ends at {}: end it later, or start it nearer",
                    seconds(meeting.touches),
                    seconds(model.time.end)
                ));
            }
            Some(_) => {}
        }
    }
    notes.into_iter().chain(beside.into_iter().map(|(_, note)| note)).collect()
}

/// Walls that move as a body before them does and are met by none, with that body and what there is to say: one for each wall.
fn beside_walls(model: &Model, bodies: &[Moving], velocities: &[[f64; 3]]) -> Vec<(usize, String)> {
    let mut told = Vec::new();
    for (wall, &velocity) in model.walls.iter().zip(velocities) {
        let WallSurface::Plane { point, normal } = wall.surface else { continue };
        // One that slides along itself is as one at rest.
        if dot(velocity, normal) == 0.0 {
            continue;
        }
        let near = |k: usize| NEAR * model.bodies[k].spacing;
        let is_met = |k: usize| bodies[k].meets_plane(point, normal, velocity, near(k)).is_some();
        let Some(k) = (0..bodies.len()).find(|&k| is_like(bodies[k].velocity, velocity)) else { continue };
        if !(0..bodies.len()).any(is_met) {
            let name = &model.bodies[k].name;
            let note = format!(
                "body `{name}` and wall `{}` both move at {:.0} m/s the same way, so that they never meet: leave one of the two velocities out, or \
                 give them opposite signs",
                wall.name,
                dot(velocity, velocity).sqrt()
            );
            told.push((k, note));
        }
    }
    told
}

/// The boxes around bodies, with half a spacing outside of their outermost particles; none where a body does not move as a whole or is driven.
pub(crate) fn boxes(model: &Model, particles: &Particles) -> Option<Vec<Moving>> {
    let mut boxes: Vec<Option<Moving>> = vec![None; model.bodies.len()];
    for ((&body, x), v) in particles.body.iter().zip(&particles.position).zip(&particles.velocity) {
        let half = 0.5 * model.bodies[body as usize].spacing;
        let own = boxes[body as usize].get_or_insert(Moving { low: *x, high: *x, velocity: *v });
        if !is_like(own.velocity, *v) {
            return None;
        }
        for a in 0..3 {
            own.low[a] = own.low[a].min(x[a] - half);
            own.high[a] = own.high[a].max(x[a] + half);
        }
    }
    let boxes: Vec<Moving> = boxes.into_iter().collect::<Option<_>>()?;
    // A clamp holds what is at rest, and a drive may keep a velocity: everything else bends a course.
    let keeps = |velocity: [f64; 3], axes: &[MotionAxis; 3]| {
        axes.iter().zip(velocity).all(|(axis, v)| match axis {
            MotionAxis::Free => true,
            MotionAxis::Velocity(table) => table.points.iter().all(|(_, value)| *value == v),
        })
    };
    let kept = model.motions.iter().all(|motion| {
        let of = model.regions.get(motion.region).and_then(|region| region.body);
        let mut bodies = boxes.iter().enumerate().filter(|(b, _)| of.is_none_or(|of| of == *b));
        bodies.all(|(_, body)| keeps(body.velocity, &motion.axes))
    });
    kept.then_some(boxes)
}

/// A velocity that does not change, m/s.
pub(crate) fn constant(velocity: &[TimeTable; 3]) -> Option<[f64; 3]> {
    let is_constant = |table: &TimeTable| table.points.iter().all(|(_, value)| *value == table.points[0].1);
    velocity.iter().all(is_constant).then(|| [0, 1, 2].map(|a| velocity[a].at(0.0)))
}

pub(crate) fn is_like(a: [f64; 3], b: [f64; 3]) -> bool {
    let off = minus(a, b);
    dot(off, off) <= UNIFORM * UNIFORM * dot(a, a).max(dot(b, b))
}

impl Moving {
    /// When the boxes of this and of another touch.
    fn meets(&self, other: &Self, near: f64) -> Option<Meeting> {
        let feels = self.enters(other, near)?.from;
        // Boxes that only come near do not touch: the time when they are nearest along the last axis says as much.
        Some(Meeting { feels, touches: self.enters(other, 0.0).map_or(feels, |entry| entry.from) })
    }

    /// How the box of this, wider by a margin on all sides, enters that of another.
    pub(crate) fn enters(&self, other: &Self, margin: f64) -> Option<Entry> {
        let relative = minus(self.velocity, other.velocity);
        let (mut from, mut until, mut axis) = (f64::NEG_INFINITY, f64::INFINITY, None);
        for a in 0..3 {
            let [ahead, behind] = [other.low[a] - self.high[a] - margin, other.high[a] - self.low[a] + margin];
            if relative[a] == 0.0 {
                if ahead > 0.0 || behind < 0.0 {
                    return None;
                }
                continue;
            }
            let times = [ahead / relative[a], behind / relative[a]];
            if axis.is_none() || times[0].min(times[1]) > from {
                (from, axis) = (times[0].min(times[1]), Some(a));
            }
            until = times[0].max(times[1]).min(until);
        }
        let from = from.max(0.0);
        (from <= until).then_some(Entry { from, until, axis })
    }

    /// When the box reaches a plane, from the side that its normal points to.
    pub(crate) fn meets_plane(
        &self,
        point: [f64; 3],
        normal: [f64; 3],
        velocity: [f64; 3],
        near: f64,
    ) -> Option<Meeting> {
        let lowest: [f64; 3] = std::array::from_fn(|a| if normal[a] > 0.0 { self.low[a] } else { self.high[a] });
        let gap = dot(minus(lowest, point), normal);
        let closing = dot(minus(velocity, self.velocity), normal);
        let after = |gap: f64| if gap <= 0.0 { 0.0 } else { gap / closing };
        // What slides along a plane that it touches has met it.
        let slides = closing >= -1e-9 * dot(self.velocity, self.velocity).sqrt() && gap <= near;
        (closing > 0.0 || slides).then(|| Meeting { feels: after(gap - near), touches: after(gap) })
    }
}

/// A time as it is said.
pub(crate) fn seconds(time: f64) -> String {
    let (factor, unit) = match time {
        t if t < 1e-6 => (1e9, "ns"),
        t if t < 1e-3 => (1e6, "us"),
        t if t < 1.0 => (1e3, "ms"),
        _ => (1.0, "s"),
    };
    format!("{} {unit}", (10.0 * factor * time).round() / 10.0)
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

pub(crate) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

#[cfg(test)]
mod tests {
    use crate::tests::notes::{notes_on, one_note_says};

    /// A bar above a plate, 10 mm apart, that moves down at 100 m/s: it arrives after 100 us.
    const DECK: &str = "dimensions = \"plane-strain\"\nparticles = { spacing = \"1 mm\" }\ntime = { end = \"120 us\" }\n\
                        [[body]]\nname = \"plate\"\nmaterial = \"armco-iron\"\nshape = { box = { min = [0, 0], max = [\"20 mm\", \"6 mm\"] } }\n\
                        [[body]]\nname = \"bar\"\nmaterial = \"armco-iron\"\nshape = { box = { min = [\"7 mm\", \"16 mm\"], max = [\"13 mm\", \"28 mm\"] } }\n\
                        velocity = [0, -100]\n";

    fn notes(replaced: &[(&str, &str)], more: &str) -> Vec<String> {
        notes_on(&(DECK.to_owned() + more), replaced)
    }

    #[track_caller]
    fn told(replaced: &[(&str, &str)], more: &str, words: &str) {
        one_note_says(&notes(replaced, more), words);
    }

    const WALL: &str = "[[wall]]\nname = \"floor\"\nplane = { point = [0, \"-50 mm\"], normal = [0, 1] }\n";
    const BESIDE: (&str, &str) =
        ("[\"7 mm\", \"16 mm\"], max = [\"13 mm\"", "[\"37 mm\", \"16 mm\"], max = [\"43 mm\"");

    #[test]
    fn a_body_that_arrives_is_not_told_and_one_that_arrives_after_the_end_is() {
        assert_eq!(notes(&[], ""), [""; 0]);
        told(
            &[("120 us", "60 us")],
            "",
            "`bar` meets body `plate` after 100 us at the earliest, and the run ends at 60 us",
        );
        // Not where the time is that of a measurement of speed.
        assert_eq!(notes(&[("120 us", "60 us"), ("time = { ", "time = { max-steps = 9, ")], ""), [""; 0]);
        // Gravity and planes of symmetry along which it moves change nothing.
        let gravity = ("[[body]]\nname = \"plate\"", "gravity = [0, -9.81]\n[[body]]\nname = \"plate\"");
        told(&[("120 us", "60 us"), gravity], "", "`bar` meets body `plate` after 100 us");
        assert_eq!(notes(&[gravity], ""), [""; 0]);
        let half = ("7 mm", "0 mm");
        told(&[("120 us", "60 us"), half], "[[symmetry]]\naxis = \"x\"\n", "`bar` meets body `plate` after 100 us");
        assert_eq!(notes(&[half], "[[symmetry]]\naxis = \"x\"\n"), [""; 0]);
        // Both move, and one is told.
        told(&[("120 us", "30 us"), ("\"6 mm\"] } }\n", "\"6 mm\"] } }\nvelocity = [0, 100]\n")], "", "after 50 us");
        assert_eq!(
            notes(&[("120 us", "60 us"), ("\"6 mm\"] } }\n", "\"6 mm\"] } }\nvelocity = [0, 100]\n")], ""),
            [""; 0]
        );
    }

    #[test]
    fn a_body_with_nothing_in_its_way_is_told() {
        told(&[("-100]", "100]")], "", "`bar` moves at 100 m/s and meets nothing");
        told(&[BESIDE], "", "meets nothing");
        // A wall below the plate, which the plate does not shield beside it.
        told(&[BESIDE], WALL, "meets wall `floor` after 660 us at the earliest");
        assert_eq!(notes(&[BESIDE, ("120 us", "700 us")], WALL), [""; 0]);
        told(&[BESIDE], "[[symmetry]]\naxis = \"y\"\n", "meets a symmetry plane after 160 us");
        // What turns, is driven or has a wall that follows a table is not judged.
        assert_eq!(notes(&[BESIDE], "spin = { rate = \"10 rpm\" }\n"), [""; 0]);
        let drive =
            "[[region]]\nname = \"r\"\nbody = \"plate\"\n[[motion]]\nregion = \"r\"\nvelocity = [0, \"50 m/s\"]\n";
        assert_eq!(notes(&[BESIDE], drive), [""; 0]);
        told(&[BESIDE], &drive.replace("50 m/s", "0 m/s"), "meets nothing");
    }

    #[test]
    fn a_wall_that_moves_as_the_body_before_it_is_told() {
        let moving = |velocity: &str| WALL.to_owned() + &format!("velocity = {velocity}\n");
        let both = "body `bar` and wall `floor` both move at 100 m/s the same way, so that they never meet";
        told(&[BESIDE, ("120 us", "700 us")], &moving("[0, -100]"), both);
        // So it is where another body is met, which the wall is not.
        told(&[("120 us", "700 us")], &moving("[0, -100]"), both);
        // A wall at rest, one that comes, and one that pushes what it touches.
        for velocity in ["[0, 0]", "[0, 100]", "[0, -99]"] {
            let notes = notes(&[BESIDE, ("120 us", "70 ms")], &moving(velocity));
            assert!(notes.iter().all(|note| !note.contains("never meet")), "{velocity}: {notes:?}");
        }
        let pushed = moving("[0, -100]").replace("-50 mm", "16 mm").replace("floor", "ram");
        let pushed =
            notes(&[("[0, 0], max = [\"20 mm\", \"6 mm\"]", "[0, \"40 mm\"], max = [\"20 mm\", \"46 mm\"]")], &pushed);
        assert!(pushed.iter().all(|note| !note.contains("never meet")), "{pushed:?}");
    }

    #[test]
    fn bodies_that_move_together_are_one() {
        let jacket = "[[body]]\nname = \"core\"\nmaterial = \"ofhc-copper\"\nshape = { box = { min = [\"7 mm\", \"28 mm\"], max = [\"13 mm\", \"60 mm\"] } }\n\
                      velocity = [0, -100]\n";
        assert_eq!(notes(&[], jacket), [""; 0]);
        told(&[("120 us", "60 us")], jacket, "`bar` meets body `plate` after 100 us");
    }
}
