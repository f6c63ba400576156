//! Bodies that fall, or fly under gravity, and get to nothing before the end. Said by `sphorge check` and `sphorge run`.

use crate::reach::{Meeting, Moving, NEAR, boxes, constant, dot, is_like, minus, seconds};
use sphorge_engine::Particles;
use sphorge_engine::model::{Model, WallSurface};

/// What is met, and the body that it is.
type Met = (Meeting, String, Option<usize>);

/// Bodies of one velocity that are near each other, and what they meet first.
struct Group {
    members: Vec<usize>,
    first: Option<Met>,
}

/// What the courses of bodies under gravity say against the deck. How gravity bends them depends on what holds them up: the times are the earliest
/// of all that may be, with gravity wholly towards what is met or not at all.
pub(crate) fn ways(model: &Model, particles: &Particles) -> Vec<String> {
    let Some(bodies) = boxes(model, particles) else { return Vec::new() };
    let walls: Option<Vec<[f64; 3]>> = model.walls.iter().map(|wall| constant(&wall.velocity)).collect();
    let Some(walls) = walls else { return Vec::new() };
    let held = held(model, particles);
    let groups: Vec<Group> = groups(model, &bodies, &held)
        .into_iter()
        .map(|members| Group { first: first(model, &bodies, &walls, &members), members })
        .collect();
    let speed = |group: &Group| {
        let own = bodies[group.members[0]].velocity;
        dot(own, own).sqrt()
    };
    // What is under way to something in time may throw it at anything else.
    let arrives = |group: &Group| {
        group
            .first
            .as_ref()
            .is_some_and(|(met, ..)| met.feels <= model.time.end && (met.feels > 0.0 || speed(group) > 0.0))
    };
    if groups.iter().any(arrives) {
        return Vec::new();
    }
    let mut told = vec![false; bodies.len()];
    let mut notes = Vec::new();
    // Of two that approach each other the one that moves is told.
    let (moving, at_rest): (Vec<&Group>, Vec<&Group>) = groups.iter().partition(|group| speed(group) > 0.0);
    for group in moving.into_iter().chain(at_rest) {
        if group.members.iter().any(|&k| told[k]) {
            continue;
        }
        let name = &model.bodies[group.members[0]].name;
        match &group.first {
            None => {
                let how = match speed(group) {
                    0.0 => "falls".to_owned(),
                    speed => format!("moves at {speed:.0} m/s"),
                };
                notes.push(format!(
                    "body `{name}` {how} and meets nothing: no body, wall or symmetry plane is in its way; check the signs of its velocity and of \
                     `gravity`, and where it starts"
                ));
            }
            Some((met, what, target)) if met.feels > model.time.end => {
                target.iter().for_each(|&target| told[target] = true);
                notes.push(format!(
                    "body `{name}` meets {what} after {} at the earliest, and the run ends at {}: end it later, or start it nearer, with the velocity \
                     that it has there",
                    seconds(met.touches),
                    seconds(model.time.end)
                ));
            }
            Some(_) => {}
        }
    }
    notes
}

/// Which bodies a motion holds or drives some part of.
fn held(model: &Model, particles: &Particles) -> Vec<bool> {
    let regions = model.motions.iter().fold(0, |all, motion| all | 1 << motion.region);
    let mut held = vec![false; model.bodies.len()];
    for (&body, of) in particles.body.iter().zip(&particles.regions) {
        held[body as usize] |= of & regions != 0;
    }
    held
}

/// Bodies that nothing holds: those of one velocity that are as near as bodies feel each other, through others, are one.
fn groups(model: &Model, bodies: &[Moving], held: &[bool]) -> Vec<Vec<usize>> {
    let mut is_placed = held.to_vec();
    let mut groups = Vec::new();
    for b in 0..bodies.len() {
        if is_placed[b] {
            continue;
        }
        is_placed[b] = true;
        let mut members = vec![b];
        let mut at = 0;
        while at < members.len() {
            let k = members[at];
            for other in 0..bodies.len() {
                let near = NEAR * model.bodies[k].spacing.max(model.bodies[other].spacing);
                let touches = |a: usize| {
                    bodies[k].low[a] <= bodies[other].high[a] + near && bodies[other].low[a] <= bodies[k].high[a] + near
                };
                if !is_placed[other] && is_like(bodies[k].velocity, bodies[other].velocity) && (0..3).all(touches) {
                    is_placed[other] = true;
                    members.push(other);
                }
            }
            at += 1;
        }
        groups.push(members);
    }
    groups
}

/// What bodies that move together meet first.
fn first(model: &Model, bodies: &[Moving], walls: &[[f64; 3]], members: &[usize]) -> Option<Met> {
    let gravity = model.gravity;
    let mut first: Option<Met> = None;
    let mut meet = |after: &dyn Fn(f64) -> Option<f64>, near: f64, what: String, body: Option<usize>| {
        let Some(feels) = after(near) else { return };
        if first.as_ref().is_none_or(|(other, ..)| feels < other.feels) {
            first = Some((Meeting { feels, touches: after(0.0).unwrap_or(feels) }, what, body));
        }
    };
    for &k in members {
        let (body, near) = (&bodies[k], NEAR * model.bodies[k].spacing);
        for (other, target) in bodies.iter().enumerate().filter(|(other, _)| !members.contains(other)) {
            let what = format!("body `{}`", model.bodies[other].name);
            meet(&|near| meets(body, target, gravity, near), near, what, Some(other));
        }
        for (wall, &velocity) in model.walls.iter().zip(walls) {
            let after = |near: f64| match wall.surface {
                WallSurface::Plane { point, normal } => meets_plane(body, point, normal, velocity, gravity, near),
                WallSurface::Segment { from, to } => {
                    let ends = |pick: fn(f64, f64) -> f64| std::array::from_fn(|a| pick(from[a], to[a]));
                    let target = Moving { low: ends(f64::min), high: ends(f64::max), velocity };
                    meets(body, &target, gravity, near)
                }
            };
            meet(&after, near, format!("wall `{}`", wall.name), None);
        }
        for plane in &model.symmetry {
            // What lies at the plane and moves along it does as its image does.
            if body.velocity[plane.axis] != 0.0 || gravity[plane.axis] != 0.0 {
                let along = |value: f64| std::array::from_fn(|a| if a == plane.axis { value } else { 0.0 });
                let (point, normal) = (along(plane.position), along(plane.side));
                let after = |near: f64| meets_plane(body, point, normal, [0.0; 3], gravity, near);
                meet(&after, near, "a symmetry plane".to_owned(), None);
            }
        }
    }
    first
}

/// When a gap (m) that something closes with a speed (m/s, negative if it opens) and an acceleration towards it (m/s^2, not negative) is closed, s.
fn closed(gap: f64, speed: f64, acceleration: f64) -> Option<f64> {
    let root = (speed * speed + 2.0 * acceleration * gap.max(0.0)).sqrt();
    match (gap > 0.0, speed >= 0.0) {
        (false, true) => Some(0.0),
        (true, true) => (speed + root > 0.0).then(|| 2.0 * gap / (speed + root)),
        (_, false) => (acceleration > 0.0).then(|| (root - speed) / acceleration),
    }
}

/// When the boxes of two bodies are as near as `near` at the earliest, if either may fall.
fn meets(body: &Moving, other: &Moving, gravity: [f64; 3], near: f64) -> Option<f64> {
    let relative = minus(body.velocity, other.velocity);
    let (mut from, mut until) = (0.0f64, f64::INFINITY);
    for a in 0..3 {
        let (ahead, behind) = (other.low[a] - body.high[a] - near, body.low[a] - other.high[a] - near);
        let falls = gravity[a].abs();
        let enters = if ahead > 0.0 {
            closed(ahead, relative[a], falls)?
        } else if behind > 0.0 {
            closed(behind, -relative[a], falls)?
        } else {
            0.0
        };
        from = from.max(enters);
        // Along an axis without gravity they pass each other, too.
        if falls == 0.0 && relative[a] != 0.0 {
            until = until.min(if relative[a] > 0.0 { -behind } else { ahead } / relative[a]);
        }
    }
    (from <= until).then_some(from)
}

/// When a body is as near to a plane as `near` at the earliest, from the side that its normal points to, if it may fall.
fn meets_plane(
    body: &Moving,
    point: [f64; 3],
    normal: [f64; 3],
    velocity: [f64; 3],
    gravity: [f64; 3],
    near: f64,
) -> Option<f64> {
    let lowest: [f64; 3] = std::array::from_fn(|a| if normal[a] > 0.0 { body.low[a] } else { body.high[a] });
    let gap = dot(minus(lowest, point), normal) - near;
    let closing = dot(minus(velocity, body.velocity), normal);
    let falls = (-dot(gravity, normal)).max(0.0);
    // What slides along a plane, but for rounding, is at it.
    let slides = closing.abs() <= 1e-9 * dot(body.velocity, body.velocity).sqrt();
    closed(gap, if slides { 0.0 } else { closing }, falls)
}

#[cfg(test)]
mod tests {
    use super::closed;
    use crate::tests::notes::{notes_on, one_note_says};

    /// A box 1 m above a floor that moves down at 4.43 m/s: 0.187 s, of 1 m = 4.43 t + 4.905 t^2.
    const DECK: &str = "dimensions = \"plane-strain\"\ngravity = [0, -9.81]\nparticles = { spacing = \"1 mm\" }\ntime = { end = \"3 ms\" }\n\
                        [[body]]\nname = \"box\"\nmaterial = \"armco-iron\"\nshape = { box = { min = [0, \"1000 mm\"], max = [\"20 mm\", \"1010 mm\"] } }\n\
                        velocity = [0, -4.43]\n\
                        [[wall]]\nname = \"floor\"\nplane = { point = [0, 0], normal = [0, 1] }\n";

    fn notes(replaced: &[(&str, &str)], more: &str) -> Vec<String> {
        notes_on(&(DECK.to_owned() + more), replaced)
    }

    #[track_caller]
    fn told(replaced: &[(&str, &str)], more: &str, words: &str) {
        one_note_says(&notes(replaced, more), words);
    }

    const AT_REST: (&str, &str) = ("velocity = [0, -4.43]\n", "");
    const CLAMP: &str = "[[region]]\nname = \"r\"\nshape = { box = { min = [0, 0], max = [\"3 mm\", 2] } }\n[[motion]]\nregion = \"r\"\nvelocity = [0, 0]\n";

    #[test]
    fn a_gap_is_closed_after_the_time_of_free_fall() {
        // 10 = 3 t + 2 t^2 at t = 1.608495, 10 = -3 t + 2 t^2 at t = 3.108495.
        for (gap, speed, acceleration, time) in [
            (10.0, 3.0, 4.0, Some(1.608_495)),
            (10.0, -3.0, 4.0, Some(3.108_495)),
            (10.0, 4.0, 0.0, Some(2.5)),
            (10.0, 0.0, 0.0, None),
            (10.0, -1.0, 0.0, None),
            (-1.0, 2.0, 4.0, Some(0.0)),
            // Thrown up at 2 m/s it is back after 1 s.
            (-1.0, -2.0, 4.0, Some(1.0)),
        ] {
            let found = closed(gap, speed, acceleration);
            let is_near = found.zip(time).map_or(found == time, |(found, time)| (found - time).abs() < 1e-6);
            assert!(is_near, "{gap} {speed} {acceleration}: {found:?}");
        }
    }

    #[test]
    fn what_falls_and_does_not_arrive_is_told() {
        told(&[], "", "`box` meets wall `floor` after 187 ms at the earliest, and the run ends at 3 ms");
        told(&[AT_REST], "", "`box` meets wall `floor` after 451.5 ms");
        // At a plane of symmetry along its way, too.
        told(&[AT_REST], "[[symmetry]]\naxis = \"x\"\n", "`box` meets wall `floor` after 451.5 ms");
        for arrives in [&[("3 ms", "200 ms")][..], &[("3 ms", "500 ms"), AT_REST], &[("[0, 0], n", "[0, 1], n")]] {
            assert_eq!(notes(arrives, ""), [""; 0], "{arrives:?}");
        }
        // What is held does not fall, and what lies on the floor has arrived.
        assert_eq!(notes(&[AT_REST], CLAMP), [""; 0]);
        told(&[], &plate("10 mm", "0 mm"), "`box` meets body `plate` after 185.4 ms");
        assert_eq!(notes(&[("3 ms", "200 ms")], &plate("10 mm", "0 mm")), [""; 0]);
        // Two that fall from one height, one on the other.
        told(&[AT_REST], &plate("1030 mm", "1010 mm"), "`box` meets wall `floor` after 451.5 ms");
    }

    fn plate(top: &str, bottom: &str) -> String {
        format!(
            "[[body]]\nname = \"plate\"\nmaterial = \"armco-iron\"\nshape = {{ box = {{ min = [0, \"{bottom}\"], max = [\"20 mm\", \"{top}\"] }} }}\n"
        )
    }

    #[test]
    fn what_falls_onto_nothing_is_told() {
        let without_floor = ("[[wall]]\nname = \"floor\"\nplane = { point = [0, 0], normal = [0, 1] }\n", "");
        told(&[AT_REST, without_floor], "", "`box` falls and meets nothing");
        told(&[without_floor], "", "`box` moves at 4 m/s and meets nothing");
        assert_eq!(notes(&[AT_REST, without_floor], CLAMP), [""; 0]);
    }
}
