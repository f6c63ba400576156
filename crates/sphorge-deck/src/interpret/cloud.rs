//! Particles from a CSV file.

use super::described;
use crate::fault::{Fault, Problems};
use crate::quantity::{QuantityKind, parse_quantity};
use crate::raw::RawTable;
use crate::suggest::listed;
use crate::unit::Dimension;
use crate::value::Word;
use sphorge_engine::model::{CloudParticle, CloudShare, Dimensions, Solid};
use std::{collections::HashMap, ops::Range, path::Path};

/// Faults of a file that are told one by one.
const TOLD: usize = 5;

/// SI value of one of a unit.
fn unit(word: Option<&Word>, kind: QuantityKind, problems: &mut Problems) -> Option<f64> {
    let Some(word) = word else { return Some(1.0) };
    let text = word.text(problems)?;
    match parse_quantity(&format!("1 {text}"), kind) {
        Ok(factor) if !text.trim().is_empty() => Some(factor),
        Ok(_) => {
            problems.push(Fault::new("wrong-unit", "expected a unit", word.span(), "no unit"));
            None
        }
        Err(error) => {
            let help = format!("a unit of {}, such as {}", kind.name, kind.si_unit);
            problems.push(Fault::new("wrong-unit", error.message, word.span(), "this unit").help(help));
            None
        }
    }
}

/// Factors from the units of a file to SI.
struct Units {
    length: f64,
    velocity: f64,
    mass: f64,
    volume: f64,
}

impl Units {
    fn read(raw: &RawTable, dimensions: Dimensions, problems: &mut Problems) -> Option<Self> {
        let d = dimensions.count() as i8;
        let (mass, volume) = match dimensions {
            Dimensions::One => ("kg/m^2", "m"),
            Dimensions::PlaneStrain => ("kg/m", "m^2"),
            Dimensions::Three => ("kg", "m^3"),
        };
        let mass = QuantityKind { si_unit: mass, dimension: Dimension::new(d - 3, 1, 0, 0), ..QuantityKind::MASS };
        let volume = QuantityKind {
            name: ["length", "area", "volume"][dimensions.count() - 1],
            si_unit: volume,
            dimension: Dimension::new(d, 0, 0, 0),
            ..QuantityKind::LENGTH
        };
        let length = unit(raw.length_unit.as_ref(), QuantityKind::LENGTH, problems);
        let velocity = unit(raw.velocity_unit.as_ref(), QuantityKind::VELOCITY, problems);
        let mass = unit(raw.mass_unit.as_ref(), mass, problems);
        let volume = unit(raw.volume_unit.as_ref(), volume, problems);
        Some(Self { length: length?, velocity: velocity?, mass: mass?, volume: volume? })
    }
}

/// Largest magnitude of a cell, and least of what is above zero: beyond them cells cannot be counted, nor powers taken.
const LARGEST: f64 = 1e15;
const LEAST: f64 = 1e-60;

/// Where the columns are.
struct Columns {
    position: Vec<usize>,
    velocity: Vec<Option<usize>>,
    mass: Option<usize>,
    volume: Option<usize>,
    /// Positions and velocities along axes that the deck does not have.
    beyond: Vec<usize>,
}

impl Columns {
    fn find(names: &csv::StringRecord, dimensions: Dimensions) -> Result<Self, String> {
        let place = |name: &str| names.iter().position(|other| other.eq_ignore_ascii_case(name));
        let count = dimensions.count();
        let missing: Vec<&str> =
            ["x", "y", "z"][..count].iter().copied().filter(|name| place(name).is_none()).collect();
        if !missing.is_empty() {
            if names.iter().all(str::is_empty) {
                return Err("is empty; its first line names the columns".to_owned());
            }
            if let Some(other) = names.iter().find_map(|name| name.find([';', '\t', ' ']).map(|at| &name[at..=at])) {
                return Err(format!("line 1: columns are separated by commas, not by {other:?}"));
            }
            let plural = if missing.len() == 1 { "" } else { "s" };
            let found = listed(names.iter(), "and");
            return Err(format!("line 1: no column{plural} {}; it names {found}", listed(missing, "and")));
        }
        let columns = Self {
            position: ["x", "y", "z"][..count].iter().filter_map(|name| place(name)).collect(),
            velocity: ["vx", "vy", "vz"][..count].iter().map(|name| place(name)).collect(),
            mass: place("mass"),
            volume: place("volume"),
            beyond: ["x", "y", "z"][count..]
                .iter()
                .chain(&["vx", "vy", "vz"][count..])
                .filter_map(|name| place(name))
                .collect(),
        };
        if columns.mass.is_some() && columns.volume.is_some() {
            return Err("line 1: both `mass` and `volume`; one determines the other".to_owned());
        }
        Ok(columns)
    }
}

/// Reads the cells of a file and notes what is wrong with them.
struct Reader<'a> {
    names: &'a csv::StringRecord,
    faults: Vec<String>,
}

impl Reader<'_> {
    fn number(&mut self, row: &csv::StringRecord, column: usize, must_be_positive: bool) -> f64 {
        let text = row.get(column).unwrap_or_default();
        let fault = match text.parse::<f64>() {
            Ok(value) if !value.is_finite() => "is not a finite number",
            Ok(value) if must_be_positive && value <= 0.0 => "must be above zero",
            Ok(value) if value.abs() > LARGEST => "is too large to compute with",
            Ok(value) if must_be_positive && value < LEAST => "is too small to compute with",
            Ok(value) => return value,
            Err(_) => "is not a number",
        };
        let line = row.position().map_or(0, csv::Position::line);
        self.faults.push(format!("line {line}, column `{}`: `{text}` {fault}", &self.names[column]));
        f64::NAN
    }

    /// Notes a number of an axis that the deck does not have, unless it is zero.
    fn zero(&mut self, row: &csv::StringRecord, column: usize, dimensions: Dimensions) {
        if self.number(row, column, false).abs() > 0.0 {
            let line = row.position().map_or(0, csv::Position::line);
            let (name, text) = (&self.names[column], row.get(column).unwrap_or_default());
            let fault = format!("line {line}, column `{name}`: {}, so `{text}` must be zero", described(dimensions));
            self.faults.push(fault);
        }
    }
}

/// The particles of a file, or what is wrong with it, fault by fault.
fn read(path: &Path, dimensions: Dimensions, units: &Units) -> Result<Vec<CloudParticle>, Vec<String>> {
    let one = |message: String| vec![message];
    // Devices and pipes may never end.
    if std::fs::metadata(path).is_ok_and(|file| !file.is_file()) {
        return Err(one("is not a regular file".to_owned()));
    }
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_path(path)
        .map_err(|error| one(format!("cannot be read: {error}; its path is relative to the folder of the deck")))?;
    let names = reader.headers().map_err(|error| one(format!("is no CSV: {error}")))?.clone();
    let columns = Columns::find(&names, dimensions).map_err(one)?;
    let mut cells = Reader { names: &names, faults: Vec::new() };
    let mut particles = Vec::new();
    let mut lines: HashMap<[u64; 3], u64> = HashMap::new();
    for row in reader.records() {
        let row = match row {
            Ok(row) => row,
            Err(error) => {
                let message = match error.kind() {
                    csv::ErrorKind::UnequalLengths { pos: Some(pos), expected_len, len } => {
                        let plural = if *len == 1 { "" } else { "s" };
                        format!("line {}: {len} cell{plural}, where line 1 names {expected_len}", pos.line())
                    }
                    csv::ErrorKind::Utf8 { pos: Some(pos), .. } => {
                        format!("line {}: the bytes are not UTF-8 text", pos.line())
                    }
                    _ => format!("is no CSV: {error}"),
                };
                cells.faults.push(message);
                continue;
            }
        };
        let (mut position, mut velocity) = ([0.0; 3], [0.0; 3]);
        for (k, &column) in columns.position.iter().enumerate() {
            position[k] = cells.number(&row, column, false) * units.length;
        }
        for (k, column) in columns.velocity.iter().enumerate() {
            velocity[k] = column.map_or(0.0, |column| cells.number(&row, column, false) * units.velocity);
        }
        for &column in &columns.beyond {
            cells.zero(&row, column, dimensions);
        }
        let share = match (columns.mass, columns.volume) {
            (Some(column), _) => CloudShare::Mass(cells.number(&row, column, true) * units.mass),
            (_, Some(column)) => CloudShare::Volume(cells.number(&row, column, true) * units.volume),
            _ => CloudShare::Spacing,
        };
        let line = row.position().map_or(0, csv::Position::line);
        // Zero has two signs.
        if let Some(first) = lines.insert(position.map(|c| (c + 0.0).to_bits()), line)
            && position.iter().all(|c| c.is_finite())
        {
            cells.faults.push(format!("lines {first} and {line} put two particles in the same place"));
        }
        particles.push(CloudParticle { position, velocity, share });
    }
    if particles.is_empty() && cells.faults.is_empty() {
        cells.faults.push("contains no particles".to_owned());
    }
    if cells.faults.is_empty() { Ok(particles) } else { Err(cells.faults) }
}

/// The particles a deck takes from a file.
pub(crate) fn cloud(raw: &RawTable, dimensions: Dimensions, problems: &mut Problems) -> Option<Solid> {
    let units = Units::read(raw, dimensions, problems);
    let name = raw.file.text(problems)?.to_owned();
    let file = problems.file(&name);
    match read(&file, dimensions, &units?) {
        Ok(particles) => Some(Solid::Cloud { file, particles: particles.into() }),
        Err(faults) => {
            tell(&name, faults, raw.file.span(), problems);
            None
        }
    }
}

fn tell(name: &str, faults: Vec<String>, at: Range<usize>, problems: &mut Problems) {
    let more = faults.len().saturating_sub(TOLD);
    for (k, fault) in faults.into_iter().take(TOLD).enumerate() {
        let joint = if fault.starts_with("line") { ", " } else { " " };
        let fault = Fault::new("bad-table", format!("`{name}`{joint}{fault}"), at.clone(), "this file");
        let last = more > 0 && k == TOLD - 1;
        problems.push(if last { fault.help(format!("and {more} more in this file")) } else { fault });
    }
}
