//! The history: one row of `history.csv` per history time.
//!
//! All values are SI; column names are plain, and `history-columns.json` gives name, unit and meaning of each. Sums over
//! particles are per metre of thickness in plane strain and per square metre of section in one dimension. Columns of
//! one body, pair of bodies, wall, driven region are named `body.NAME.momentum_x`, `contact.NAME.NAME.force_x`, `heat.NAME`,
//! `wall.NAME.force_x`, `motion.NAME.force_x`; a measure
//! has its own name (`measure.NAME` where that is taken by another column). An empty cell means that there is no value
//! (yet).
//!
//! The file is replaced as a whole (written aside, renamed), so a reader always sees complete lines, whatever the file
//! system. So that long histories do not cost the run, it is replaced when fifty times the duration of the last
//! replacement has passed: in practice at every row, and at every frame in any case. A killed process loses at most the
//! rows since then; after a power cut the file is that of some recent moment, complete.

use super::{
    RunDirectory,
    atomic::Durability,
    directory::{COLUMNS, HISTORY},
    error::{AtPath, OutputError},
    sync::Pacing,
};
use crate::{
    engine::{
        Audit, ContactLedger, Energies, HeatLedger, Ledger, LimitReason, WallLedger,
        persist::{Archive, ArchiveError, Persist, require},
    },
    model::{Dimensions, FragmentQuantity, MeasureKind, Model},
    particles::{FieldInfo, find_field},
};
use serde::{Deserialize, Serialize};

/// What a column of the history holds.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HistoryColumn {
    /// Name in the first line of `history.csv`.
    pub name: String,
    /// SI unit, empty for pure numbers and words.
    pub unit: String,
    /// One line for people.
    pub meaning: String,
}

/// State at a history time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HistorySample<'a> {
    pub(crate) time: f64,
    pub(crate) step: u64,
    /// Last step that was not shortened to land on an output time, and what limited it.
    pub(crate) dt: f64,
    pub(crate) reason: Option<LimitReason>,
    pub(crate) ledger: &'a Ledger,
    pub(crate) energy_drift: f64,
    pub(crate) momentum_drift: f64,
    /// Mean over the steps since the previous row.
    pub(crate) searched_fraction: Option<f64>,
    /// Ordered pairs in the last step.
    pub(crate) pairs: Option<u64>,
    /// Checks that have found the run broken so far.
    pub(crate) warnings: u64,
    /// The last audit of the neighbour lists.
    pub(crate) audit: Option<Audit>,
    pub(crate) measures: &'a [Option<f64>],
    /// What tracers and sections add.
    pub(crate) observed: (&'a [HistoryColumn], &'a [Option<f64>]),
}

enum Cell {
    Number(f64),
    Count(u64),
    Word(&'static str),
    Empty,
}

impl From<Option<f64>> for Cell {
    fn from(value: Option<f64>) -> Self {
        value.map_or(Self::Empty, Self::Number)
    }
}

impl Cell {
    fn text(&self) -> String {
        match self {
            // Shortest digits that read back to the same number.
            Self::Number(x) if *x == 0.0 => "0".into(),
            Self::Number(x) if x.is_finite() => format!("{x:e}"),
            Self::Count(n) => n.to_string(),
            Self::Word(word) => (*word).into(),
            Self::Number(_) | Self::Empty => String::new(),
        }
    }
}

/// Columns under construction, each with its value: names and cells cannot get out of step.
struct Row {
    cells: Vec<(HistoryColumn, Cell)>,
    /// What sums over particles are taken per: nothing, metre of thickness, square metre of section.
    per: &'static str,
}

impl Row {
    fn add(&mut self, name: impl Into<String>, unit: &str, meaning: &str, cell: impl Into<Cell>) {
        // Sums over particles; momentum is `kg m/s`.
        let per = if unit.starts_with(['J', 'N']) || unit.starts_with("kg") { self.per } else { "" };
        let column = HistoryColumn { name: name.into(), unit: format!("{unit}{per}"), meaning: meaning.into() };
        self.cells.push((column, cell.into()));
    }

    fn number(&mut self, name: &str, unit: &str, meaning: &str, value: f64) {
        self.add(name, unit, meaning, Some(value));
    }

    fn vector(&mut self, name: &str, unit: &str, meaning: &str, value: [f64; 3]) {
        for (axis, value) in ["x", "y", "z"].into_iter().zip(value) {
            self.add(format!("{name}_{axis}"), unit, meaning, Some(value));
        }
    }

    fn audit(&mut self, audit: Option<Audit>) {
        let count = |value: fn(&Audit) -> u64| audit.as_ref().map_or(Cell::Empty, |a| Cell::Count(value(a)));
        let missed = "ordered pairs within the kernel support that were missing from the lists at the last audit";
        self.add("audit_missed_pairs", "", missed, count(|a| a.missed_pairs));
        let foreign = "missed pairs between particles of different bodies";
        self.add("audit_missed_foreign_pairs", "", foreign, count(|a| a.missed_foreign_pairs));
        self.add("audit_stale_pairs", "", "listed pairs beyond the kernel support", count(|a| a.stale_pairs));
        let number = |value: fn(&Audit) -> f64| audit.as_ref().map(value);
        let rate = "relative error of the density rate due to the lists, root mean square";
        self.add("audit_density_rate_error", "", rate, number(|a| a.density_rate_error));
        let force = "relative error of the stress force due to the lists, root mean square";
        self.add("audit_force_error", "", force, number(|a| a.force_error));
        let residual = "sum of the stress forces between particles over the sum of their magnitudes";
        self.add("audit_momentum_residual", "", residual, number(|a| a.momentum_residual));
    }

    fn energies(&mut self, prefix: &str, energies: &Energies) {
        self.number(&format!("{prefix}kinetic_energy"), "J", "kinetic energy", energies.kinetic);
        self.number(&format!("{prefix}internal_energy"), "J", "internal energy", energies.internal);
        self.number(&format!("{prefix}elastic_energy"), "J", "elastic part of the internal energy", energies.elastic);
        self.number(&format!("{prefix}plastic_work"), "J", "plastic work done so far", energies.plastic_work);
    }
}

/// What sums over particles are per.
pub(super) fn per(dimensions: Dimensions) -> &'static str {
    match dimensions {
        Dimensions::One => "/m^2",
        Dimensions::PlaneStrain => "/m",
        Dimensions::Three => "",
    }
}

/// The column of words.
pub(super) const REASON: &str = "dt_reason";

/// How a column says that it is a measure.
pub(crate) const MEASURE_MEANING: &str = "measure declared in the deck";

/// Every column with its value.
fn row(model: &Model, sample: &HistorySample) -> Row {
    let ledger = sample.ledger;
    let total = &ledger.total;
    let mut row = Row { cells: Vec::new(), per: per(model.dimensions) };
    row.number("time", "s", "time", sample.time);
    row.add("step", "", "steps done", Cell::Count(sample.step));
    row.number("dt", "s", "last time step that was not shortened to land on an output time", sample.dt);
    let reason = sample.reason.map_or(Cell::Empty, |reason| Cell::Word(reason.name()));
    row.add(REASON, "", "what limited that time step", reason);
    row.energies("", &total.energies);
    let external = "work of walls, gravity, driven regions and loads of a program so far";
    row.number("external_work", "J", external, ledger.external_work);
    let loads = "part of the external work by loads of a program so far";
    row.number("load_work", "J", loads, ledger.load_work);
    let mls = "energy added to the pressure field by density re-initialisation so far, without work";
    row.number("mls_energy", "J", mls, ledger.mls_energy);
    let booked = "energy added to the internal energy by the integrator so far to close the energy balance; second order in the time step";
    row.number("integration_energy", "J", booked, ledger.integration_energy);
    let hourglass = "work against the hourglass springs so far, part of the internal energy: what they hold and what they turned into heat";
    row.number("hourglass_energy", "J", hourglass, ledger.hourglass_energy);
    let held = "energy that the hourglass springs hold, part of the work against them; it comes back";
    row.number("hourglass_stored_energy", "J", held, ledger.hourglass_stored_energy);
    let viscous = "internal energy produced by artificial viscosity so far";
    row.number("viscous_energy", "J", viscous, ledger.viscous_energy);
    let repulsion = "work against the artificial stress so far, part of the internal energy; negative where it has driven particles apart";
    row.number("artificial_stress_energy", "J", repulsion, ledger.artificial_stress_energy);
    if model.materials.iter().any(|material| material.damage.is_some()) {
        let broken = "what breaking has dissipated so far, part of the internal energy: plastic work since the damage is one, and elastic energy lost with the integrity";
        row.number("fracture_energy", "J", broken, ledger.fracture_energy);
    }
    if model.thermal.conduction {
        let meaning = "heat that entered through all boundaries so far";
        row.number("boundary_heat", "J", meaning, ledger.boundary_heat());
    }
    let contact_pairs = model.contact_pairs();
    if !contact_pairs.is_empty() {
        let sum = |of: fn(&ContactLedger) -> f64| ledger.contacts.iter().map(of).sum::<f64>();
        let stored = "energy stored in contacts between bodies: work against their elastic force so far";
        row.number("contact_stored_energy", "J", stored, sum(|c| c.stored_energy));
        row.number(
            "contact_friction_work",
            "J",
            "heat of friction in contacts between bodies so far",
            sum(|c| c.friction_work),
        );
        row.number("contact_damping_work", "J", "heat of contact damping so far", sum(|c| c.damping_work));
        let lost = "work against contacts so far that they neither hold nor turned to heat: the error of their integration in time, part of the total energy";
        row.number("contact_integration_energy", "J", lost, sum(|c| c.integration_energy));
    }
    let meaning = "kinetic energy, internal energy and energy stored in contacts between bodies";
    row.number("total_energy", "J", meaning, ledger.total_energy());
    let drift =
        "total energy minus external work, boundary heat and initial total energy, relative to the energy in play";
    row.number("energy_drift", "", drift, sample.energy_drift);
    row.vector("momentum", "kg m/s", "linear momentum", total.momentum);
    row.number("momentum_scale", "kg m/s", "sum of m |v|", total.momentum_scale);
    let impulse = "impulse of walls, gravity, driven regions and loads of a program so far";
    row.vector("external_impulse", "N s", impulse, ledger.external_impulse);
    let drift = "change of momentum minus external impulse, over the largest sum of m |v| so far";
    row.number("momentum_drift", "", drift, sample.momentum_drift);
    row.vector("angular_momentum", "kg m^2/s", "angular momentum about the origin", total.angular_momentum);
    let searched = "share of particles whose neighbours were searched, mean over the steps since the previous row";
    row.add("searched_fraction", "", searched, sample.searched_fraction);
    let pairs = "ordered pairs inside the kernel support in the last step";
    row.add("pairs", "", pairs, sample.pairs.map_or(Cell::Empty, Cell::Count));
    let warnings = "number of checks that have given a warning so far, see `warnings` in summary.json";
    row.add("warnings", "", warnings, Cell::Count(sample.warnings));
    if model.audit.is_some() {
        row.audit(sample.audit);
    }
    for (body, sums) in model.bodies.iter().zip(&ledger.bodies) {
        let name = &body.name;
        row.energies(&format!("body.{name}."), &sums.energies);
        row.vector(&format!("body.{name}.momentum"), "kg m/s", "linear momentum of the body", sums.momentum);
        let meaning = "angular momentum of the body about the origin";
        row.vector(&format!("body.{name}.angular_momentum"), "kg m^2/s", meaning, sums.angular_momentum);
        row.vector(&format!("body.{name}.centre"), "m", "centre of mass of the body", sums.centre);
        let meaning = "net force on the body: rate of change of its momentum";
        row.vector(&format!("body.{name}.force"), "N", meaning, sums.force);
    }
    for (boundary, heat) in model.thermal.boundaries.iter().zip(&ledger.heat.supplied) {
        row.number(&format!("heat.{}", boundary.name), "J", "heat that entered through the boundary so far", *heat);
    }
    for ((a, b), contact) in contact_pairs.into_iter().zip(&ledger.contacts) {
        let name = format!("contact.{}.{}", model.bodies[a].name, model.bodies[b].name);
        // The forces of a body on itself cancel.
        if a != b {
            row.vector(&format!("{name}.force"), "N", "force of the first body on the second", contact.force);
        }
        let stored = "work against the elastic force of the contact so far";
        row.number(&format!("{name}.stored_energy"), "J", stored, contact.stored_energy);
        row.number(&format!("{name}.friction_work"), "J", "heat of friction so far", contact.friction_work);
        row.number(&format!("{name}.damping_work"), "J", "heat of contact damping so far", contact.damping_work);
    }
    for (k, (wall, force)) in model.walls.iter().zip(&ledger.wall_forces).enumerate() {
        row.vector(&format!("wall.{}.force", wall.name), "N", "force of the wall on the particles", *force);
        let WallLedger { work, friction_work, damping_work } = ledger.walls.get(k).copied().unwrap_or_default();
        let name = format!("wall.{}", wall.name);
        row.number(&format!("{name}.work"), "J", "work of the wall on the particles so far, including heat", work);
        row.number(&format!("{name}.friction_work"), "J", "heat of friction so far", friction_work);
        row.number(&format!("{name}.damping_work"), "J", "heat of contact damping so far", damping_work);
    }
    for (motion, force) in model.motions.iter().zip(&ledger.motion_forces) {
        let region = model.regions.get(motion.region).map_or("", |region| region.name.as_str());
        row.vector(&format!("motion.{region}.force"), "N", "force that drives the region", *force);
    }
    let (columns, values) = sample.observed;
    row.cells.extend(columns.iter().cloned().zip(values.iter().map(|value| Cell::from(*value))));
    for (measure, value) in model.measures.iter().zip(sample.measures) {
        let taken = row.cells.iter().any(|(column, _)| column.name == measure.name);
        let name = if taken { format!("measure.{}", measure.name) } else { measure.name.clone() };
        // A measure is of a field or a length, or says of its own what it is a sum of.
        let unit = measure_unit(&measure.kind, model.dimensions).to_owned();
        row.cells.push((HistoryColumn { name, unit, meaning: MEASURE_MEANING.into() }, (*value).into()));
    }
    row
}

/// SI unit of a mass: in plane strain it is that of a metre of thickness, in one dimension that of a square metre.
pub(crate) fn mass_unit(dimensions: usize) -> &'static str {
    match dimensions {
        1 => "kg/m^2",
        2 => "kg/m",
        _ => "kg",
    }
}

/// SI unit of a field in so many dimensions.
pub(crate) fn field_unit(field: &FieldInfo, dimensions: usize) -> &'static str {
    if field.unit == "kg" { mass_unit(dimensions) } else { field.unit }
}

/// SI unit of a measure.
pub fn measure_unit(kind: &MeasureKind, dimensions: Dimensions) -> &'static str {
    match kind {
        MeasureKind::Extent { .. }
        | MeasureKind::Diameter { .. }
        | MeasureKind::CraterDiameter { .. }
        | MeasureKind::Cloud { .. } => "m",
        MeasureKind::Extreme { field, .. } | MeasureKind::Mean { field, .. } | MeasureKind::Value { field, .. } => {
            find_field(field).map_or("", |field| field_unit(field, dimensions.count()))
        }
        MeasureKind::FrontSpeed { .. } => "m/s",
        MeasureKind::Fragments { quantity: FragmentQuantity::Number, .. } => "",
        MeasureKind::Fragments { .. } => mass_unit(dimensions.count()),
        MeasureKind::Period { .. } | MeasureKind::ReversalTime { .. } => "s",
    }
}

/// Writer of `history.csv`.
#[derive(Debug)]
pub(crate) struct History {
    directory: RunDirectory,
    columns: Vec<HistoryColumn>,
    text: Vec<u8>,
    written: usize,
    pacing: Pacing,
}

impl History {
    /// Writes the line of names and `history-columns.json`; `observed` are the columns of tracers and sections.
    pub(crate) fn create(
        directory: &RunDirectory,
        model: &Model,
        observed: &[HistoryColumn],
    ) -> Result<Self, OutputError> {
        let mut history = Self::without_rows(directory, model, observed)?;
        history.write_columns()?;
        history.save()?;
        Ok(history)
    }

    /// The writer of a history whose rows are loaded before anything is written.
    pub(crate) fn resumed(
        directory: &RunDirectory,
        model: &Model,
        observed: &[HistoryColumn],
    ) -> Result<Self, OutputError> {
        Self::without_rows(directory, model, observed)
    }

    /// The line of names.
    fn without_rows(directory: &RunDirectory, model: &Model, observed: &[HistoryColumn]) -> Result<Self, OutputError> {
        let ledger = Ledger {
            bodies: vec![Default::default(); model.bodies.len()],
            heat: HeatLedger { supplied: vec![0.0; model.thermal.boundaries.len()], exchanged: 0.0 },
            contacts: vec![ContactLedger::default(); model.contact_pairs().len()],
            wall_forces: vec![[0.0; 3]; model.walls.len()],
            motion_forces: vec![[0.0; 3]; model.motions.len()],
            ..Ledger::default()
        };
        let sample = HistorySample {
            time: 0.0,
            step: 0,
            dt: 0.0,
            reason: None,
            ledger: &ledger,
            energy_drift: 0.0,
            momentum_drift: 0.0,
            searched_fraction: None,
            pairs: None,
            audit: None,
            warnings: 0,
            measures: &vec![None; model.measures.len()],
            observed: (observed, &vec![None; observed.len()]),
        };
        let columns: Vec<HistoryColumn> = row(model, &sample).cells.into_iter().map(|(column, _)| column).collect();
        let mut history =
            Self { directory: directory.clone(), columns, text: Vec::new(), written: 0, pacing: Pacing::new() };
        let names: Vec<String> = history.columns.iter().map(|column| column.name.clone()).collect();
        history.append(names.into_iter())?;
        Ok(history)
    }

    /// Writes what the columns are.
    fn write_columns(&self) -> Result<(), OutputError> {
        let text = self.columns_text()?;
        self.directory.write(COLUMNS, Durability::Disk, |out| out.write_all(text.as_bytes()))
    }

    fn columns_text(&self) -> Result<String, OutputError> {
        let text = serde_json::to_string_pretty(&self.columns).map_err(std::io::Error::other);
        text.map(|text| text + "\n").writing(&self.directory.history_columns())
    }

    /// Writes anew what was saved, and the columns where they are others. Returns the names of files that were not what was written up to then.
    pub(crate) fn rewrite(&mut self) -> Result<Vec<&'static str>, OutputError> {
        let mut differing = Vec::new();
        if !self.directory.is_exactly(COLUMNS, self.columns_text()?.as_bytes()) {
            differing.push(COLUMNS);
            self.write_columns()?;
        }
        if !self.directory.begins_with(HISTORY, &self.text) {
            differing.push(HISTORY);
        }
        self.save()?;
        Ok(differing)
    }

    /// Adds a row.
    pub(crate) fn add(&mut self, model: &Model, sample: &HistorySample) -> Result<(), OutputError> {
        self.append(row(model, sample).cells.iter().map(|(_, cell)| cell.text()))?;
        if self.pacing.is_due() { self.save() } else { Ok(()) }
    }

    /// Brings all rows into the file.
    pub(crate) fn flush(&mut self) -> Result<(), OutputError> {
        if self.written < self.text.len() { self.save() } else { Ok(()) }
    }

    fn append(&mut self, cells: impl Iterator<Item = String>) -> Result<(), OutputError> {
        let mut line = csv::Writer::from_writer(&mut self.text);
        let failed = |e: std::io::Error| OutputError::Write { path: self.directory.history(), source: e };
        line.write_record(cells.map(String::into_bytes)).map_err(|e| failed(std::io::Error::other(e)))?;
        line.flush().map_err(failed)
    }

    fn save(&mut self) -> Result<(), OutputError> {
        self.pacing.run(|| self.directory.write(HISTORY, Durability::Process, |out| out.write_all(&self.text)))?;
        self.written = self.text.len();
        Ok(())
    }
}

impl Persist for History {
    /// The rows so far. Those that a killed run wrote after it was saved are not among them, and leave the file with its next
    /// replacement.
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        let name = format!("{name}.text");
        let end = self.text.iter().position(|&byte| byte == b'\n').map_or(0, |at| at + 1);
        let columns = self.text[..end].to_vec();
        self.text.persist(&name, archive)?;
        if !archive.is_saving() {
            self.written = 0;
        }
        require(self.text.starts_with(&columns) && self.text.ends_with(b"\n"), &name)
    }
}
