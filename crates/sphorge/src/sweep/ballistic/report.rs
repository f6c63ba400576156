//! Limit, bracket and curve, as people and programs are told.

use super::{Bracket, End, Flight, Outcome, RechtIpson, Search, Searched, Shot, search::through};
use crate::{
    number::{four_digits, plain, plain_quantity},
    output::{Durability, OutputError, write_file},
    plot::{CurvesPicture, Paper, PlotError},
    sweep::{SweepColumn, SweepRow},
};
use comfy_table::{CellAlignment, ContentArrangement, Table, presets::UTF8_FULL_CONDENSED};
use std::{fmt, path::Path};

/// Points of the curve in a picture.
const POINTS: usize = 200;

/// The limit as far as it was found.
#[derive(Clone, Debug)]
pub struct BallisticLimit {
    /// The runs, slow to fast, each with its row of the table.
    pub shots: Vec<(Shot, SweepRow)>,
    /// The fastest that was stopped and the slowest that got through.
    pub bracket: Option<Bracket>,
    /// The curve, or why there is none.
    pub curve: Result<RechtIpson, String>,
    /// How the search ended.
    pub end: End,
    /// Other measures of the deck.
    pub measures: Vec<SweepColumn>,
    /// The measure that is the residual velocity.
    pub residual: String,
    within: f64,
    is_free: bool,
}

impl BallisticLimit {
    /// Of a search.
    pub fn of(search: &Search, flight: &Flight, searched: &Searched) -> Self {
        let shots =
            searched.in_order().into_iter().map(|k| (searched.shots[k].clone(), searched.table.rows[k].clone()));
        let shots = shots.collect();
        let bracket = Bracket::of(&searched.shots);
        let points = through(&searched.shots);
        let slowest = points.iter().map(|point| point.0).fold(f64::INFINITY, f64::min);
        let bounds = match bracket {
            Some(bracket) if !bracket.is_mixed() => (bracket.stopped, bracket.through),
            _ => (0.0, slowest),
        };
        Self {
            shots,
            bracket,
            curve: RechtIpson::fit(&points, bounds, search.exponent),
            end: searched.end,
            measures: searched.table.measures.iter().filter(|of| of.name != flight.residual).cloned().collect(),
            residual: flight.residual.clone(),
            within: search.within,
            is_free: match searched.end {
                End::AllThrough => search.from.is_none(),
                _ => search.to.is_none(),
            },
        }
    }

    /// Middle of the bracket, m/s.
    pub fn limit(&self) -> Option<f64> {
        self.bracket.map(|bracket| bracket.middle())
    }

    /// Whether the bracket is as narrow as it was asked for, and every run has reached its end.
    pub fn is_found(&self) -> bool {
        self.end == End::Found
    }

    /// What there is to say of how the search ended, and of single runs: lines.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        let speeds = || self.shots.iter().map(|(shot, _)| shot.speed);
        let lowest = speeds().fold(f64::INFINITY, f64::min);
        let highest = speeds().fold(0.0, f64::max);
        let within = metres_per_second(self.within);
        match self.end {
            End::Found => {}
            End::AllThrough if self.is_free => notes.push(format!(
                "everything got through, down to {}: does anything stand in the way?",
                metres_per_second(lowest)
            )),
            End::AllThrough => notes.push(format!(
                "everything got through: the limit is below {}; give a smaller `--from`",
                metres_per_second(lowest)
            )),
            End::AllStopped if self.is_free => notes.push(format!(
                "everything was stopped, up to {}: does the deck let the target break?",
                metres_per_second(highest)
            )),
            End::AllStopped => notes.push(format!(
                "everything was stopped: the limit is above {}; give a larger `--to`",
                metres_per_second(highest)
            )),
            End::Mixed => notes.push(
                "something was stopped that was faster than what got through: runs between them do not tell more"
                    .to_owned(),
            ),
            End::Open if self.bracket.is_none() => {
                notes.push("the limit is not bracketed: runs do not tell".to_owned())
            }
            End::Open => notes.push(format!("the bracket is wider than {within}: runs within it do not tell")),
            End::Outside => notes.push(
                "runs that were there bracket the limit beyond the bounds, and nothing is run there: move `--from` or `--to`".to_owned(),
            ),
            End::NothingTells => notes.push("no run tells whether it got through".to_owned()),
            End::RunsUsed => notes.push(format!(
                "{} runs were made, and the bracket is not narrower than {within}: allow more by `--runs`",
                self.shots.len()
            )),
        }
        for (shot, row) in &self.shots {
            match &shot.outcome {
                Outcome::Open(why) => notes.push(format!("{}: {why}", metres_per_second(shot.speed))),
                Outcome::Failed => notes.push(format!(
                    "{}: the run is {}, and its speed is not used; one that failed is made again when its folder is removed",
                    metres_per_second(shot.speed),
                    row.status()
                )),
                Outcome::Through | Outcome::Stopped => {}
            }
        }
        if let Ok(curve) = &self.curve {
            if curve.runs == curve.constants {
                notes.push(format!(
                    "the curve has as many constants as runs got through ({}), and goes through all of them: give more speeds by `--at`{}",
                    curve.runs,
                    if curve.constants == 3 { ", or hold p by `--exponent 2`" } else { "" }
                ));
            }
            if curve.constants == 3 && !(1.001..9.999).contains(&curve.p) {
                notes.push("the exponent is at the end of what is looked for: hold p by `--exponent 2`, or give more speeds by `--at`".to_owned());
            }
        }
        notes
    }

    /// Comma-separated values, SI: a line for each run, slow to fast.
    pub fn csv(&self) -> String {
        let mut text = csv::Writer::from_writer(Vec::new());
        let head = |column: &SweepColumn| match column.unit.as_str() {
            "" => column.name.clone(),
            unit => format!("{} ({unit})", column.name),
        };
        let own = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        let first = own(&[
            "impact_velocity (m/s)",
            "residual_velocity (m/s)",
            "outcome",
            "curve (m/s)",
            "target_velocity (m/s)",
        ]);
        let mut lines =
            vec![[first, self.measures.iter().map(head).collect(), own(&["run", "wall_seconds (s)"])].concat()];
        let number = |x: Option<f64>| x.filter(|x| x.is_finite()).map_or_else(String::new, |x| x.to_string());
        for (shot, row) in &self.shots {
            let curve = self.curve.as_ref().ok().map(|curve| curve.residual(shot.speed));
            let known = shot.residual.map(|_| shot.target);
            let first = vec![
                shot.speed.to_string(),
                number(shot.residual),
                shot.outcome.name().to_owned(),
                number(curve),
                number(known),
            ];
            let measures = self.measures.iter().map(|of| number(row.measure(&of.name))).collect();
            let last = vec![row.run.clone(), number(row.summary.as_ref().map(|summary| summary.wall_seconds))];
            lines.push([first, measures, last].concat());
        }
        // Memory takes all that is written to it, and all lines have the same length.
        let written = lines.iter().all(|line| text.write_record(line).is_ok());
        debug_assert!(written);
        String::from_utf8_lossy(&text.into_inner().unwrap_or_default()).into_owned()
    }

    /// Writes `ballistic-limit.csv` to a folder.
    ///
    /// # Errors
    /// [`OutputError::Write`].
    pub fn write(&self, folder: &Path) -> Result<(), OutputError> {
        let text = self.csv();
        write_file(&folder.join("ballistic-limit.csv"), Durability::Process, |out| out.write_all(text.as_bytes()))
    }

    /// Residual over impact velocity with the curve and the bracket; none where no run has a residual velocity.
    pub fn picture(&self, title: &str, paper: Paper) -> Option<CurvesPicture> {
        let of = |outcome: fn(&Outcome) -> bool| {
            let shots = self.shots.iter().filter(move |(shot, _)| outcome(&shot.outcome));
            shots.filter_map(|(shot, _)| Some((shot.speed, shot.residual?))).collect::<Vec<_>>()
        };
        let (known, open) = (of(Outcome::is_known), of(|outcome| !outcome.is_known()));
        let all = || known.iter().chain(&open);
        let fastest = all().map(|point| point.0).fold(0.0, f64::max);
        let top = all().map(|point| point.1).fold(0.0, f64::max);
        if fastest == 0.0 {
            return None;
        }
        let mut curves = Vec::new();
        if let Ok(curve) = &self.curve {
            // Denser where it is steep.
            let at = |k: usize| curve.limit + (fastest - curve.limit) * (k as f64 / POINTS as f64).powi(3);
            let points = (0..=POINTS).map(at).map(|speed| (speed, curve.residual(speed))).collect();
            curves.push((format!("a = {}, p = {}", short(curve.a), short(curve.p)), points));
        }
        if let Some(bracket) = self.bracket {
            let (low, high) = (bracket.stopped.min(bracket.through), bracket.stopped.max(bracket.through));
            let name = format!("limit {} to {} m/s", short(low), short(high));
            curves.push((name, vec![(low, 0.0), (low, top), (high, top), (high, 0.0)]));
        }
        let mut points = vec![("runs".to_owned(), known)];
        if !open.is_empty() {
            points.push(("runs that do not tell".to_owned(), open));
        }
        Some(CurvesPicture {
            title: title.to_owned(),
            along: ("impact velocity".to_owned(), "m/s".to_owned()),
            quantity: ("residual velocity".to_owned(), "m/s".to_owned()),
            curves,
            points,
            paper,
        })
    }

    /// Draws it, if there is anything to draw.
    ///
    /// # Errors
    /// As [`CurvesPicture::save`].
    pub fn draw(&self, title: &str, paper: Paper, to: &Path) -> Result<bool, PlotError> {
        let picture = self.picture(title, paper);
        picture.as_ref().map(|picture| picture.save(to)).transpose().map(|drawn| drawn.is_some())
    }
}

/// A number for people.
fn short(value: f64) -> String {
    plain(four_digits(value))
}

/// A speed for people, not as kilometres: it is compared with what was given.
fn metres_per_second(speed: f64) -> String {
    format!("{} m/s", short(speed))
}

impl fmt::Display for BallisticLimit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut table = Table::new();
        table.load_style(UTF8_FULL_CONDENSED).set_content_arrangement(ContentArrangement::Disabled);
        let own = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        let names = self.measures.iter().map(|of| of.name.clone()).collect();
        table.set_header([own(&["impact", "residual", "outcome"]), names, own(&["status", "time"])].concat());
        let missing = || "\u{2013}".to_owned();
        for (shot, row) in &self.shots {
            let measure = |of: &SweepColumn| {
                row.measure(&of.name).map_or_else(missing, |value| plain(plain_quantity(value, &of.unit)))
            };
            let first = vec![
                metres_per_second(shot.speed),
                shot.residual.map_or_else(missing, metres_per_second),
                shot.outcome.name().to_owned(),
            ];
            let status = match row.warnings()[..] {
                [] => row.status().to_owned(),
                ref warnings => format!("warnings: {}", warnings.join(", ")),
            };
            let seconds = row.summary.as_ref().map_or_else(missing, |s| format!("{:.1} s", s.wall_seconds));
            table.add_row([first, self.measures.iter().map(measure).collect(), vec![status, seconds]].concat());
        }
        let texts = [2, 3 + self.measures.len()];
        for (_, column) in table.column_iter_mut().enumerate().filter(|(k, _)| !texts.contains(k)) {
            column.set_cell_alignment(CellAlignment::Right);
        }
        writeln!(f, "{table}")?;
        match self.bracket {
            Some(bracket) => writeln!(
                f,
                "limit   {}, {} stopped and {} through",
                metres_per_second(bracket.middle()),
                metres_per_second(bracket.stopped),
                metres_per_second(bracket.through)
            )?,
            None => writeln!(f, "limit   not bracketed")?,
        }
        match &self.curve {
            Ok(curve) => {
                let held = if curve.constants == 2 { " (held)" } else { "" };
                writeln!(
                    f,
                    "curve   v_r = a (v_i^p - v_bl^p)^(1/p): a {}, p {}{held}, v_bl {}; {} runs off by {} in the mean square",
                    short(curve.a),
                    short(curve.p),
                    metres_per_second(curve.limit),
                    curve.runs,
                    metres_per_second(if curve.off_by < 5e-4 { 0.0 } else { curve.off_by })
                )?;
            }
            Err(why) => writeln!(f, "curve   none: {why}")?,
        }
        for note in self.notes() {
            writeln!(f, "note: {note}")?;
        }
        Ok(())
    }
}
