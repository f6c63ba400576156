//! What a deck says that has no effect in its run: tables, outputs and motions whose times or kinds do not fit the rest.

use crate::fault::Problems;
use crate::raw::{RawBody, RawDeck, Rows};
use crate::reach::seconds;
use crate::suggest::listed;
use crate::value::{Given, Kind, ScalarOr, Time};
use sphorge_engine::model::{Body, Model, MotionAxis, TimeTable};
use std::ops::Range;

/// Tells of all of it.
pub(super) fn tell(raw: &RawDeck, model: &Model, problems: &mut Problems) {
    without_motion(raw, model, problems);
    for (given, motion) in raw.motion.iter().zip(&model.motions) {
        let at = given.region.span();
        let dimensions = model.dimensions.count();
        if motion.axes.iter().take(dimensions).all(|axis| matches!(axis, MotionAxis::Free)) {
            let region = &model.regions[motion.region].name;
            let note = format!(
                "all components of the motion of region `{region}` are free, so that it has no effect: give the components that are held or \
                 driven a velocity, `\"0 m/s\"` to hold them, or leave the motion out"
            );
            problems.doubt(&at, note);
        }
        let region = &model.regions[motion.region].name;
        for (axis, table) in given.velocity.iter().zip(&motion.axes) {
            if let (ScalarOr::Composed(rows, _), MotionAxis::Velocity(table)) = (axis, table) {
                beside_the_run(rows, table, &format!("the motion of region `{region}`"), model, problems);
            }
        }
    }
    for (given, wall) in raw.wall.iter().zip(&model.walls) {
        for (axis, table) in given.velocity.iter().flatten().zip(&wall.velocity) {
            if let ScalarOr::Composed(rows, _) = axis {
                beside_the_run(rows, table, &format!("wall `{}`", wall.name), model, problems);
            }
        }
    }
    let output = &raw.output;
    let intervals = [
        ("frame-interval", &output.frame_interval, model.output.frame_interval, "frames"),
        ("history-interval", &output.history_interval, model.output.history_interval, "rows of the history"),
    ];
    for (key, given, interval, what) in intervals {
        if let Some(given) = given
            && interval > model.time.end * (1.0 + 1e-9)
        {
            let note = format!(
                "`output.{key}` is {}, and the run ends at {}: the only {what} are those of the start and of the end{}",
                seconds(interval),
                seconds(model.time.end),
                meant(interval, &[1e-3, 1e-6, 1e-9], (model.time.end / MOST_PARTS, model.time.end))
            );
            problems.doubt(&given.span(), note);
        }
    }
}

/// Into how many parts an output interval divides a run that is asked for in the place of another one.
const MOST_PARTS: f64 = 1e4;
/// How many times as long as the run a table is, by its earliest row after the start, that is told, and what share of the run it is over in.
const FAR_BEYOND: f64 = 100.0;
const FAR_BEFORE: f64 = 1e-3;

/// A time in the unit that is probably meant, as a question.
fn meant(time: f64, factors: &[f64], (least, most): (f64, f64)) -> String {
    let fits = |time: &f64| (least..=most * (1.0 + 1e-9)).contains(time);
    let fitting = factors.iter().map(|factor| factor * time).find(fits);
    fitting.map_or_else(|| "; check its unit".to_owned(), |time| format!("; is \"{}\" meant?", seconds(time)))
}

/// A table of velocities whose times have nothing to do with those of the run.
fn beside_the_run<K: Kind>(rows: &Rows<K>, table: &TimeTable, whose: &str, model: &Model, problems: &mut Problems) {
    let (end, points) = (model.time.end, &table.points);
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return };
    if points.iter().all(|(_, value)| *value == first.1) {
        return;
    }
    let told = |row: usize, note: String, problems: &mut Problems| {
        let time: &Given<Time> = &rows[row].0;
        problems.doubt(&time.span(), note);
    };
    // Within this a table is one of the run.
    let of_run = (end / FAR_BEYOND, 3.0 * end);
    let next = points.iter().position(|(time, _)| *time > 0.0);
    if let Some(next) = next.filter(|next| first.0 > end || points[*next].0 > FAR_BEYOND * end) {
        let time = points[next].0;
        let effect = if first.0 > end { "has no effect" } else { "has hardly begun by the end" };
        let note = format!(
            "the table of {whose} {effect}: its first time{} is {}, and the run ends at {}{}",
            if next == 0 { "" } else { " after the start" },
            seconds(time),
            seconds(end),
            meant(time, &[1e-3, 1e-6, 1e-9], of_run)
        );
        told(next, note, problems);
    } else if last.0 > 0.0 && last.0 < FAR_BEFORE * end && model.time.stop_kinetic_fraction.is_none() {
        let note = format!(
            "the table of {whose} is over at {}, and the run ends at {}: its last value holds nearly all the time{}",
            seconds(last.0),
            seconds(end),
            meant(last.0, &[1e3, 1e6, 1e9], of_run)
        );
        told(points.len() - 1, note, problems);
    }
}

/// What moves bodies that are said not to move.
fn without_motion(raw: &RawDeck, model: &Model, problems: &mut Problems) {
    let Some(flag) = raw.thermal.as_ref().and_then(|thermal| thermal.mechanics.as_ref()) else { return };
    if model.thermal.mechanics {
        return;
    }
    let moves = |table: &TimeTable| table.points.iter().any(|(_, value)| *value != 0.0);
    let is_thrown = |(given, body): &(&RawBody, &Body)| {
        body.velocity != [0.0; 3]
            || body.spin != [0.0; 3]
            || given.velocity_gradient.is_some()
            || given.velocity_profile.is_some()
            || given.radial_velocity.is_some()
    };
    let thrown: Vec<&str> =
        raw.body.iter().zip(&model.bodies).filter(is_thrown).map(|(_, body)| body.name.as_str()).collect();
    let is_driven = |axis: &MotionAxis| matches!(axis, MotionAxis::Velocity(table) if moves(table));
    let driven = model.motions.iter().filter(|motion| motion.axes.iter().any(is_driven));
    let driven: Vec<&str> = driven.map(|motion| model.regions[motion.region].name.as_str()).collect();
    let walls = model.walls.iter().filter(|wall| wall.velocity.iter().any(moves));
    let walls: Vec<&str> = walls.map(|wall| wall.name.as_str()).collect();
    let of = |what: [&str; 2], names: Vec<&str>| {
        let what = if names.len() == 1 { what[0] } else { what[1] };
        (!names.is_empty()).then(|| format!("{what} {}", listed(names, "and")))
    };
    let idle: Vec<String> = [
        of(["the velocity of body", "the velocities of bodies"], thrown),
        of(["the motion of region", "the motions of regions"], driven),
        of(["the velocity of wall", "the velocities of walls"], walls),
        (model.gravity != [0.0; 3]).then(|| "`gravity`".to_owned()),
    ]
    .into_iter()
    .flatten()
    .collect();
    let at: Range<usize> = flag.span();
    if let [rest @ .., last] = &idle[..] {
        let what = if rest.is_empty() { last.clone() } else { format!("{} and {last}", rest.join(", ")) };
        let has =
            if idle.len() == 1 && !last.contains("velocities") && !last.contains("motions") { "has" } else { "have" };
        let note = format!(
            "with `thermal.mechanics = false` bodies stay where they are: {what} {has} no effect; leave that or `mechanics = false` out"
        );
        problems.doubt(&at, note);
    }
}
