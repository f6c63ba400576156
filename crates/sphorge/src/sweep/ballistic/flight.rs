//! What flies in a deck, runs of it at other speeds, and what became of it.

use super::search::{Outcome, Shot};
use crate::{
    deck::{DeckReport, Setup, did_you_mean, load_model, names_like, read_quantity},
    model::MeasureKind,
    output::{FrameFile, HistoryTable, OutputError, RunDirectory, Status, Summary, read_series},
    sweep::{Planned, Planning, Sweep, SweepError, SweepRow, SweepTable, Varied, plan::Load},
};
use std::{fs, path::Path};

/// Axes by their names.
const AXES: [&str; 3] = ["x", "y", "z"];
/// Share of the impact velocity that is not more than ringing, beside the target.
const NOISE: f64 = 0.02;
/// Share of the impact velocity that a projectile loses at least in an impact.
const TOUCH: f64 = 1e-3;
/// Most runs of a folder that are looked at.
const MOST_KNOWN: usize = 1000;
/// Part of a run that is its end.
const LAST: f64 = 0.1;
/// Share of its velocity beside the target that a projectile may still lose or gain in the last part of a run: it would take
/// twice as long again to stop.
const STEADY: f64 = 0.05;

/// Warnings of runs whose energy or momentum is not that of what flew, or in which it passed through what it struck: nothing tells what it would have done.
const DOUBTS: [&str; 8] = [
    "plastic-work",
    "negative-energy",
    "hourglass-work",
    "integration",
    "contact-energy",
    "energy-drift",
    "momentum-drift",
    "interpenetration",
];

/// What flies: bodies of a deck with one velocity along an axis, and the measure of what is left of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Flight {
    /// The bodies, in the order of the deck.
    pub bodies: Vec<String>,
    /// Axis 0, 1, 2.
    pub axis: usize,
    /// Towards larger (+1) or smaller (-1) coordinates.
    pub sign: f64,
    /// Speed in the deck, m/s.
    pub speed: f64,
    /// The measure.
    pub residual: String,
    /// Velocity beside that of the target above which something has got through, m/s; else a share of the impact velocity.
    pub through: Option<f64>,
}

/// A speed from what was given by an option, m/s: above zero.
///
/// # Errors
/// What to give.
pub fn read_speed(text: &str, option: &str) -> Result<f64, SweepError> {
    let fault = |reason: &str| SweepError::Varied {
        what: format!("`{option} {text}`: {reason}"),
        help: "give a speed above zero, such as `\"150 m/s\"`".to_owned(),
    };
    match read_quantity(text.trim(), "m/s") {
        Ok(speed) if speed > 0.0 && speed.is_finite() => Ok(speed),
        Ok(_) => Err(fault("it is not above zero")),
        Err(reason) => Err(fault(&reason)),
    }
}

impl Flight {
    /// Finds what flies: these bodies, or all that move, if they move alike; and the measure of this name, or the only one that can be meant.
    ///
    /// # Errors
    /// What is missing, and what there is.
    pub fn of(setup: &Setup, bodies: &[String], residual: Option<&str>) -> Result<Self, SweepError> {
        let model = &setup.model;
        let unknown = |what: String, help: String| Err(SweepError::Unknown { what, help });
        let names = || model.bodies.iter().map(|body| body.name.as_str());
        let moving: Vec<&str> =
            model.bodies.iter().filter(|body| body.velocity != [0.0; 3]).map(|body| body.name.as_str()).collect();
        let listed = |names: &[&str]| names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
        if let Some(name) = bodies.iter().find(|name| !names().any(|known| known == *name)) {
            let near = did_you_mean(names_like(name, names()));
            let all: Vec<&str> = names().collect();
            return unknown(format!("the deck has no body `{name}`"), format!("{near}it has: {}", listed(&all)));
        }
        if moving.is_empty() {
            return unknown("no body of the deck has a velocity".to_owned(), "give the projectile one".to_owned());
        }
        if let Some(name) = bodies.iter().find(|name| !moving.contains(&name.as_str())) {
            return unknown(format!("the body `{name}` has no velocity"), format!("what moves is {}", listed(&moving)));
        }
        let is_meant =
            |name: &str| if bodies.is_empty() { moving.contains(&name) } else { bodies.iter().any(|of| of == name) };
        let chosen: Vec<_> = model.bodies.iter().filter(|body| is_meant(&body.name)).collect();
        let velocity = chosen[0].velocity;
        if let Some(other) = chosen.iter().find(|body| body.velocity != velocity) {
            return unknown(
                format!("`{}` and `{}` do not have the same velocity", chosen[0].name, other.name),
                format!("choose by `--body` what is to fly faster and slower; what moves is {}", listed(&moving)),
            );
        }
        let along: Vec<usize> = (0..3).filter(|&k| velocity[k] != 0.0).collect();
        let [axis] = along[..] else {
            return unknown(
                format!("`{}` does not fly along an axis", chosen[0].name),
                "turn the target by `rotate` instead of the flight".to_owned(),
            );
        };
        Ok(Self {
            bodies: chosen.iter().map(|body| body.name.clone()).collect(),
            axis,
            sign: velocity[axis].signum(),
            speed: velocity[axis].abs(),
            residual: residual_of(setup, residual, axis)?,
            through: None,
        })
    }

    /// The key of a body that is varied.
    fn key(&self, body: &str) -> String {
        format!("body.{body}.velocity.{}", self.axis)
    }

    /// Keys that are varied.
    pub fn keys(&self) -> Vec<String> {
        self.bodies.iter().map(|body| self.key(body)).collect()
    }

    /// Plans runs at these speeds.
    ///
    /// # Errors
    /// As [`Sweep::plan`].
    pub fn sweep(
        &self,
        load: impl Fn(&[(String, String)]) -> Result<Setup, DeckReport>,
        speeds: &[f64],
        planning: &Planning<'_>,
    ) -> Result<Sweep, SweepError> {
        let value = |speed: &f64| format!("{} m/s", self.sign * speed);
        let varied = Varied { key: self.key(&self.bodies[0]), values: speeds.iter().map(value).collect() };
        let set = |speed: &f64| {
            (vec![value(speed)], self.keys().into_iter().map(|key| (key, value(speed))).collect::<Vec<_>>())
        };
        let load: &Load<'_> = &load;
        Sweep::of(load, vec![varied], speeds.iter().map(set).collect(), planning)
    }

    /// Speeds at which the folder has runs of this study that have reached their end, slow to fast: of the same deck but for the speed.
    ///
    /// # Errors
    /// [`SweepError::Stopped`].
    pub fn known(
        &self,
        load: impl Fn(&[(String, String)]) -> Result<Setup, DeckReport>,
        planning: &Planning<'_>,
    ) -> Result<Vec<f64>, SweepError> {
        let mut known: Vec<f64> = Vec::new();
        if planning.again {
            return Ok(known);
        }
        let Ok(entries) = fs::read_dir(planning.folder) else { return Ok(known) };
        for path in entries.flatten().map(|entry| entry.path()) {
            let is_complete = |run: &RunDirectory| {
                let ended = [Status::Completed, Status::CompletedWithWarnings];
                Summary::read(run).is_ok_and(|summary| ended.contains(&summary.status))
            };
            let Ok(run) = RunDirectory::open(&path) else { continue };
            if !is_complete(&run) {
                continue;
            }
            let Ok(model) = load_model(&run.deck()) else { continue };
            let Some(body) = model.bodies.iter().find(|body| body.name == self.bodies[0]) else { continue };
            let speed = self.sign * body.velocity[self.axis];
            if !(speed > 0.0 && speed.is_finite()) || known.contains(&speed) {
                continue;
            }
            match self.sweep(&load, &[speed], planning) {
                Err(SweepError::Stopped) => return Err(SweepError::Stopped),
                // A run of another deck, or one that would be of another name.
                Err(_) => {}
                Ok(sweep) => known.extend(sweep.runs.iter().filter(|of| of.planned == Planned::Nothing).map(|_| speed)),
            }
            if known.len() == MOST_KNOWN {
                break;
            }
        }
        known.sort_by(f64::total_cmp);
        Ok(known)
    }

    /// What became of the projectile in each run of a table, which has them in the order of these speeds.
    pub fn shots(&self, table: &SweepTable, folder: &Path, speeds: &[f64]) -> Vec<Shot> {
        table.rows.iter().zip(speeds).map(|(row, speed)| self.shot(row, &folder.join(&row.run), *speed)).collect()
    }

    fn shot(&self, row: &SweepRow, folder: &Path, speed: f64) -> Shot {
        let Some(summary) = row.summary.as_deref().filter(|_| row.is_complete()) else {
            return Shot { speed, residual: None, target: 0.0, outcome: Outcome::Failed };
        };
        let open = |residual, why: String| Shot { speed, residual, target: 0.0, outcome: Outcome::Open(why) };
        let Some(measured) = row.measure(&self.residual) else {
            return open(None, format!("`{}` has no value at its end", self.residual));
        };
        let residual = self.sign * measured;
        let doubts: Vec<&str> = row.warnings().into_iter().filter(|name| DOUBTS.contains(name)).collect();
        if !doubts.is_empty() {
            return open(Some(residual), format!("its energy is not to be trusted, it warns of {}", doubts.join(", ")));
        }
        let read = || {
            let run = RunDirectory::open(folder)?;
            let history = HistoryTable::read(&run)?;
            let target = match self.of_target(&run)? {
                Some(median) => median,
                None => self.mean_of_target(&history, summary),
            };
            Ok::<_, OutputError>((target, self.change(&history)))
        };
        match read() {
            Err(error) => open(Some(residual), format!("its files cannot be read: {error}")),
            Ok((target, change)) => {
                Shot { speed, residual: Some(residual), target, outcome: self.outcome(speed, residual, target, change) }
            }
        }
    }

    /// Median velocity along the flight of the particles of all bodies that do not fly, in the last frame: what is left of a target is slower than
    /// half of it. None where there is nothing else, or frames do not tell.
    fn of_target(&self, run: &RunDirectory) -> Result<Option<f64>, OutputError> {
        let series = read_series(run)?;
        let Some((_, path)) = series.last() else { return Ok(None) };
        let mut frame = FrameFile::open(path)?;
        let flies: Vec<bool> = frame.bodies.iter().map(|body| self.bodies.contains(&body.name)).collect();
        let (Some(body), Some(velocity)) = (frame.column("body")?, frame.column("velocity")?) else { return Ok(None) };
        let of = velocity.values.chunks_exact(velocity.width.max(1)).zip(&body.values);
        let of = of.filter(|(_, body)| flies.get(**body as usize) == Some(&false));
        let mut speeds: Vec<f64> =
            of.filter_map(|(velocity, _)| velocity.get(self.axis)).map(|x| self.sign * f64::from(*x)).collect();
        speeds.sort_by(f64::total_cmp);
        Ok(speeds.get(speeds.len() / 2).copied().filter(|speed| speed.is_finite()))
    }

    /// Mean velocity along the flight of all bodies that do not fly, at the end.
    fn mean_of_target(&self, history: &HistoryTable, summary: &Summary) -> f64 {
        let (mut momentum, mut mass) = (0.0, 0.0);
        for body in summary.bodies.iter().filter(|body| !self.bodies.contains(&body.name)) {
            let column = history.column(&format!("body.{}.momentum_{}", body.name, AXES[self.axis]));
            let Some(last) = column.and_then(|(_, values)| values.last()) else { continue };
            momentum += self.sign * last;
            mass += body.mass;
        }
        if mass > 0.0 { momentum / mass } else { 0.0 }
    }

    /// What the velocity along the flight changes by in the last part of a run, m/s; none where the history is too coarse.
    fn change(&self, history: &HistoryTable) -> Option<f64> {
        let of = |name: &str| history.column(name).map(|(_, values)| values);
        let rows =
            of("time")?.iter().zip(of(&self.residual)?).filter(|(time, value)| time.is_finite() && value.is_finite());
        let rows: Vec<(f64, f64)> = rows.map(|(time, value)| (*time, self.sign * value)).collect();
        let &(end, last) = rows.last()?;
        // The last row before the last part begins.
        let before = rows.iter().rev().find(|(time, _)| *time <= (1.0 - LAST) * end * (1.0 + 1e-9))?;
        Some(last - before.1)
    }

    /// Whether it got through.
    fn outcome(&self, speed: f64, residual: f64, target: f64, change: Option<f64>) -> Outcome {
        let open = |why: &str| Outcome::Open(why.to_owned());
        if residual > (1.0 + TOUCH) * speed {
            return open("it leaves faster than it came: look at the warnings of the run");
        }
        if residual > (1.0 - TOUCH) * speed {
            return open("it has lost nothing of its speed: the run ends before it strikes, or it meets nothing");
        }
        let ahead = residual - target;
        if ahead <= self.through.unwrap_or(NOISE * speed) {
            return Outcome::Stopped;
        }
        match change {
            Some(change) if change.abs() > STEADY * ahead => Outcome::Open(format!(
                "its velocity still changes, by {change:+.3} m/s in the last tenth of the run: lengthen `time.end`"
            )),
            Some(_) => Outcome::Through,
            None => open("its history has too few rows to tell whether its velocity still changes"),
        }
    }
}

/// The measure of the velocity along an axis that is meant.
fn residual_of(setup: &Setup, name: Option<&str>, axis: usize) -> Result<String, SweepError> {
    let measures = &setup.model.measures;
    let component = |kind: &MeasureKind| match kind {
        MeasureKind::Mean { field, component, .. }
        | MeasureKind::Value { field, component, .. }
        | MeasureKind::Extreme { field, component, over_time: false, .. }
            if field == "velocity" =>
        {
            *component
        }
        _ => None,
    };
    let along = AXES[axis];
    let how =
        format!("give the deck one: `mean = {{ body = \"...\", field = \"velocity\", component = \"{along}\" }}`");
    let able: Vec<&str> =
        measures.iter().filter(|of| component(&of.kind) == Some(axis)).map(|of| of.name.as_str()).collect();
    let listed = || able.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    let fault = |what: String, help: String| Err(SweepError::Unknown { what, help });
    let Some(name) = name else {
        return match able[..] {
            [only] => Ok(only.to_owned()),
            [] => fault(format!("the deck has no measure of the velocity along {along}, that of the flight"), how),
            _ => fault(
                "the deck has several measures of the velocity along the flight".to_owned(),
                format!("choose by `--residual`: {}", listed()),
            ),
        };
    };
    let Some(measure) = measures.iter().find(|of| of.name == name) else {
        let near = did_you_mean(names_like(name, measures.iter().map(|of| of.name.as_str())));
        let has = if able.is_empty() { how } else { format!("of the velocity along {along} it has: {}", listed()) };
        return fault(format!("the deck has no measure `{name}`"), format!("{near}{has}"));
    };
    match component(&measure.kind) {
        Some(found) if found == axis => Ok(name.to_owned()),
        Some(found) => fault(
            format!("`{name}` is the velocity along {}, and the flight is along {along}", AXES[found]),
            if able.is_empty() { how } else { format!("choose {}", listed()) },
        ),
        None => fault(
            format!(
                "`{name}` is no velocity along {along}: of a speed it could not be told whether something was thrown back"
            ),
            if able.is_empty() { how } else { format!("choose {}", listed()) },
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flight() -> Flight {
        Flight {
            bodies: vec!["projectile".to_owned()],
            axis: 2,
            sign: -1.0,
            speed: 300.0,
            residual: "residual".to_owned(),
            through: None,
        }
    }

    #[test]
    fn what_flies_ahead_of_the_target_and_keeps_its_velocity_is_through() {
        let outcome = |residual, target, change| flight().outcome(200.0, residual, target, change).name();
        assert_eq!(outcome(60.0, 1.0, Some(-2.0)), "through");
        // Two per cent of 200 m/s, beside a target at rest and one that has been carried away.
        assert_eq!([outcome(3.9, 0.0, Some(0.0)), outcome(4.1, 0.0, Some(0.0))], ["stopped", "through"]);
        assert_eq!([outcome(47.0, 46.0, Some(0.0)), outcome(52.0, 46.0, Some(0.0))], ["stopped", "through"]);
        assert_eq!(outcome(-20.0, 5.0, Some(-30.0)), "stopped");
        // A twentieth of what it flies ahead with.
        assert_eq!([outcome(60.0, 10.0, Some(-2.4)), outcome(60.0, 10.0, Some(-2.6))], ["through", "open"]);
        assert_eq!([outcome(60.0, 10.0, Some(2.6)), outcome(60.0, 10.0, None)], ["open", "open"]);
        assert_eq!([outcome(199.9, 0.0, Some(0.0)), outcome(210.0, 0.0, Some(0.0))], ["open", "open"]);
        let told = Flight { through: Some(50.0), ..flight() };
        assert_eq!(told.outcome(200.0, 55.0, 10.0, Some(0.0)), Outcome::Stopped);
    }

    #[test]
    fn a_change_is_that_of_the_last_tenth_along_the_flight() {
        let column = |name: &str| crate::output::HistoryColumn {
            name: name.to_owned(),
            unit: String::new(),
            meaning: String::new(),
        };
        let history = |rows: usize| HistoryTable {
            columns: vec![column("time"), column("residual")],
            values: vec![(0..rows).map(|k| k as f64 * 1e-6).collect(), (0..rows).map(|k| -100.0 + k as f64).collect()],
            words: Default::default(),
        };
        assert_eq!(flight().change(&history(101)), Some(-10.0));
        assert_eq!(flight().change(&history(2)), Some(-1.0));
        assert_eq!(flight().change(&history(0)), None);
        assert_eq!(Flight { residual: "other".to_owned(), ..flight() }.change(&history(101)), None);
    }

    #[test]
    fn speeds_are_above_zero_and_of_the_right_kind() {
        assert_eq!(read_speed(" 0.3 km/s", "--to").unwrap(), 300.0);
        assert_eq!(read_speed("150", "--to").unwrap(), 150.0);
        for (text, told) in
            [("0 m/s", "not above zero"), ("-3", "not above zero"), ("3 mm", "a length"), ("", "`--to `")]
        {
            let error = read_speed(text, "--to").unwrap_err().to_string();
            assert!(error.contains(told), "{text}: {error}");
        }
    }
}
