//! `summary.json`: how a run ended and what it took.

use super::{
    RunDirectory,
    atomic::Durability,
    directory::SUMMARY,
    error::{AtPath, OutputError},
    history::per,
    regular_file::{self, most},
};
use crate::{
    engine::{Audit, StageSeconds, persist_fields},
    model::Dimensions,
    number::plain_quantity,
};
use serde::{Deserialize, Serialize};
use std::{collections::BTreeMap, fmt};

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// It reached its end.
    Completed,
    /// It reached its end, and checks found it broken on the way: [`Summary::warnings`].
    #[serde(rename = "completed with warnings")]
    CompletedWithWarnings,
    /// The user stopped it; what is there is complete up to that time.
    Stopped,
    /// It could not go on; what is there is complete up to the last frame.
    Failed,
}

impl Status {
    /// The word in `summary.json`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Completed => "completed",
            Self::CompletedWithWarnings => "completed with warnings",
            Self::Stopped => "stopped",
            Self::Failed => "failed",
        }
    }
}

/// What ended a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EndReason {
    /// The end time of the deck.
    EndTime,
    /// Kinetic energy fell below the deck's share of its initial value.
    KineticEnergy,
    /// The deck's number of steps.
    MaxSteps,
    /// The user.
    User,
    /// The program that drives the run: [`Summary::stopped_by`] says how.
    Program,
    /// A failure.
    Failure,
}

/// Why a run could not go on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FailureRecord {
    /// For people, with what to do.
    pub message: String,
    /// Step that failed.
    pub step: u64,
    /// Time before it, s.
    pub time: f64,
    /// Field that went wrong, if it was one.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub field: Option<String>,
    /// Id of the particle it was seen at.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub particle: Option<u32>,
    /// Name of its body.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub body: Option<String>,
    /// Its last finite position, m.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub position: Option<[f64; 3]>,
}

impl fmt::Display for FailureRecord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "step {} at {:.6e} s: {}", self.step, self.time, self.message)?;
        let Some(particle) = self.particle else { return Ok(()) };
        write!(f, " (particle {particle}")?;
        if let Some(body) = &self.body {
            write!(f, " of `{body}`")?;
        }
        if let Some(field) = &self.field {
            write!(f, ", field `{field}`")?;
        }
        if let Some([x, y, z]) = self.position {
            write!(f, ", at ({x:.6e}, {y:.6e}, {z:.6e}) m")?;
        }
        f.write_str(")")
    }
}

/// What a program gave to a run.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DrivenRecord {
    /// Bodies that had a load.
    pub loads: Vec<String>,
    /// Regions whose velocity it prescribed.
    pub motions: Vec<String>,
}

impl fmt::Display for DrivenRecord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = |what: &str, names: &[String]| {
            let names: Vec<_> = names.iter().map(|name| format!("`{name}`")).collect();
            (!names.is_empty()).then(|| format!("{what} {}", names.join(", ")))
        };
        let parts = [named("load on", &self.loads), named("velocity of", &self.motions)];
        write!(f, "by a program: {}", parts.into_iter().flatten().collect::<Vec<_>>().join("; "))
    }
}

/// Whose memory a number is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MemoryOf {
    /// That of the whole process, as the system tells it.
    #[default]
    Process,
    /// That of the engine, as it counts it.
    Engine,
}

/// What a check found broken.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WarningRecord {
    /// Name of the check, as in the table `[warnings]` of a deck.
    pub name: String,
    /// What its number is.
    pub meaning: String,
    /// The worst number of the run.
    pub value: f64,
    /// When that was, s.
    pub value_time: f64,
    /// The limit.
    pub limit: f64,
    /// Unit of number and limit, SI, empty for pure numbers.
    pub unit: String,
    /// Step it was first seen at.
    pub step: u64,
    /// Time it was first seen at, s.
    pub time: f64,
    /// Id of the worst particle then, if it is of particles.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub particle: Option<u32>,
    /// Name of the body.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub body: Option<String>,
    /// Where the particle was, m.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub position: Option<[f64; 3]>,
    /// What to do.
    pub cure: String,
}

impl fmt::Display for WarningRecord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, meaning, step, cure, .. } = self;
        let [value, limit] = [self.value, self.limit].map(|number| plain_quantity(number, &self.unit));
        let time = plain_quantity(self.time, "s");
        write!(f, "{name}: {meaning} is {value}, limit {limit}, first at {time} (step {step})")?;
        match (&self.body, self.particle) {
            (Some(body), Some(particle)) => write!(f, ", particle {particle} of `{body}`")?,
            (Some(body), None) => write!(f, ", in `{body}`")?,
            (None, _) => {}
        }
        if let Some(position) = self.position {
            let [x, y, z] = position.map(|x| 1e3 * x);
            write!(f, " at ({x:.4}, {y:.4}, {z:.4}) mm")?;
        }
        write!(f, "; {cure}")
    }
}

/// What the particles of a body weigh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BodyRecord {
    /// Name in the deck.
    pub name: String,
    /// Number of particles.
    pub particles: u64,
    /// Mass of the particles, kg (per metre of thickness in plane strain, per square metre in one dimension).
    pub mass: f64,
    /// Reference density times the volume of the shape, in the same unit; of composed shapes counted, to about a thousandth.
    pub shape_mass: f64,
    /// Part of both that mass scaling has added, in the same unit.
    #[serde(default)]
    pub added_mass: f64,
}

/// Wall-clock seconds by stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StageSecondsRecord {
    /// Neighbour search.
    pub search: f64,
    /// Velocity gradient and density rate.
    pub kinematics: f64,
    /// Constitutive update.
    pub stress: f64,
    /// Forces.
    pub forces: f64,
    /// Integration, guard, time step.
    pub integrate: f64,
    /// Frames, history, measures.
    pub output: f64,
}

impl From<StageSeconds> for StageSecondsRecord {
    fn from(s: StageSeconds) -> Self {
        let StageSeconds { search, kinematics, stress, forces, integrate, output } = s;
        Self { search, kinematics, stress, forces, integrate, output }
    }
}

/// Energies at the last row of the history, J (per metre of thickness in plane strain, per square metre in one dimension).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EnergyRecord {
    /// Kinetic.
    pub kinetic: f64,
    /// Internal.
    pub internal: f64,
    /// Elastic part of the internal energy.
    pub elastic: f64,
    /// Plastic work done.
    pub plastic_work: f64,
    /// Work of walls, gravity, driven regions and loads of a program.
    pub external_work: f64,
    /// What of it is by loads of a program.
    #[serde(default)]
    pub load_work: f64,
    /// What the integrator booked into the internal energy so that the total closes.
    #[serde(default)]
    pub integration: f64,
    /// Work against the hourglass springs, part of the internal energy.
    #[serde(default)]
    pub hourglass: f64,
    /// What they hold of it at the end; the rest is heat.
    #[serde(default)]
    pub hourglass_stored: f64,
    /// What artificial viscosity turned into internal energy.
    #[serde(default)]
    pub viscous: f64,
    /// Work against the artificial stress, part of the internal energy; negative where it has driven particles apart.
    #[serde(default)]
    pub artificial_stress: f64,
    /// Drift of the total at the end; see [`crate::run`] for its definition.
    pub relative_drift: f64,
    /// Largest size of the drift in any row.
    pub largest_relative_drift: f64,
}

/// The largest of each number over all audits of the neighbour lists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AuditRecord {
    /// Audits made.
    pub audits: u64,
    /// Ordered pairs within the kernel support that the lists lacked.
    pub missed_pairs: u64,
    /// The same as a share of all pairs within the support.
    pub missed_share: f64,
    /// Of the missed pairs, those of particles of different bodies.
    pub missed_foreign_pairs: u64,
    /// Listed pairs beyond the kernel support.
    pub stale_pairs: u64,
    /// Relative error of the density rate, root mean square.
    pub density_rate_error: f64,
    /// Relative error of the force of stress, root mean square.
    pub force_error: f64,
    /// Sum of the forces of stress between particles over the sum of their magnitudes.
    pub momentum_residual: f64,
}

impl AuditRecord {
    /// Takes an audit into the record.
    pub(crate) fn add(&mut self, audit: &Audit) {
        self.audits += 1;
        self.missed_pairs = self.missed_pairs.max(audit.missed_pairs);
        self.missed_share = self.missed_share.max(audit.missed_pairs as f64 / audit.pairs.max(1) as f64);
        self.missed_foreign_pairs = self.missed_foreign_pairs.max(audit.missed_foreign_pairs);
        self.stale_pairs = self.stale_pairs.max(audit.stale_pairs);
        self.density_rate_error = self.density_rate_error.max(audit.density_rate_error);
        self.force_error = self.force_error.max(audit.force_error);
        self.momentum_residual = self.momentum_residual.max(audit.momentum_residual);
    }
}

persist_fields!(AuditRecord {
    audits,
    missed_pairs,
    missed_share,
    missed_foreign_pairs,
    stale_pairs,
    density_rate_error,
    force_error,
    momentum_residual,
});

/// All of `summary.json`. Units are SI throughout; [`Summary::units`] has them all.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Version of this form, see [`Summary::FORMAT`]; 0 for files from before there was one.
    #[serde(default)]
    pub format: u32,
    /// How it ended.
    pub status: Status,
    /// What ended it.
    pub end_reason: EndReason,
    /// Why it failed, if it did.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub failure: Option<Box<FailureRecord>>,
    /// What of the program that drives the run ended it, if something did: a callback that raised, with the text of the exception.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub stopped_by: Option<String>,
    /// What a program gave to the run, if it did: the deck alone is then another run.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub driven: Option<DrivenRecord>,
    /// Title of the deck.
    pub title: String,
    /// Name of the deck.
    pub deck: String,
    /// Version of the program.
    pub version: String,
    /// Number of particles.
    pub particles: u64,
    /// The bodies in deck order.
    #[serde(default)]
    pub bodies: Vec<BodyRecord>,
    /// Steps done.
    pub steps: u64,
    /// How often a step was taken back and repeated at half its size.
    #[serde(default)]
    pub repeated_steps: u64,
    /// Time reached, s.
    pub simulated_time: f64,
    /// Wall-clock seconds from the first preparation to the end, writing included.
    pub wall_seconds: f64,
    /// Processes that share the run.
    #[serde(default = "one_rank")]
    pub ranks: usize,
    /// Most work of a process over the mean of all, counted in pairs of particles, in the last step; one for a process alone.
    #[serde(default = "no_imbalance")]
    pub rank_imbalance: f64,
    /// Wall-clock seconds by stage that the first process has waited for messages of others or sent its own; zero for a process alone.
    #[serde(default)]
    pub rank_waiting_seconds: StageSecondsRecord,
    /// Threads of each.
    pub threads: usize,
    /// `cpu` or `gpu`.
    pub engine: String,
    /// Name of the graphics card, if one computed.
    #[serde(default)]
    pub device: Option<String>,
    /// `mixed` or `double`.
    pub precision: String,
    /// Wall-clock seconds by stage.
    pub stage_seconds: StageSecondsRecord,
    /// Neighbours a particle has on average at the end.
    pub mean_neighbors: f64,
    /// Particles times steps over `wall_seconds`.
    pub particle_steps_per_second: f64,
    /// Ordered pairs summed over the steps, over `wall_seconds`.
    pub pairs_per_second: f64,
    /// Share of the particles whose neighbour lists were rebuilt, mean over the steps.
    pub searched_fraction: f64,
    /// Largest resident memory of the process during the run; where nobody tells, that of the engine.
    pub peak_memory_bytes: u64,
    /// Which of both it is.
    #[serde(default)]
    pub peak_memory_of: MemoryOf,
    /// Memory of the engine as it counts it: columns, lists and records, the most at any row of the history.
    #[serde(default)]
    pub engine_memory_bytes: u64,
    /// Energies.
    pub energy: EnergyRecord,
    /// Drift of the linear momentum at the end; see [`crate::run`] for its definition.
    pub momentum_drift: f64,
    /// Largest drift of the linear momentum in any row.
    pub largest_momentum_drift: f64,
    /// What audits of the neighbour lists found, if the deck asked for them.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub audit: Option<AuditRecord>,
    /// What checks found broken, in the order it was first seen; see `docs/warnings.md`.
    #[serde(default)]
    pub warnings: Vec<WarningRecord>,
    /// Declared measures at the end; null for one that has no value.
    pub measures: BTreeMap<String, Option<f64>>,
    /// Units of the measures.
    #[serde(default)]
    pub measure_units: BTreeMap<String, String>,
    /// Unit of every number above by its path, such as `energy.kinetic` or, of each of a list, `bodies.mass`; empty for pure numbers. Value and
    /// limit of a warning have theirs beside them.
    #[serde(default)]
    pub units: BTreeMap<String, String>,
}

/// Runs of before there were ranks.
fn one_rank() -> usize {
    1
}

fn no_imbalance() -> f64 {
    1.0
}

/// Units of the numbers of a summary by their paths; `{per}` stands for what sums over particles are per.
const UNITS: [(&str, &str); 63] = [
    ("format", ""),
    ("failure.step", ""),
    ("failure.time", "s"),
    ("failure.particle", ""),
    ("failure.position", "m"),
    ("particles", ""),
    ("bodies.particles", ""),
    ("bodies.mass", "kg{per}"),
    ("bodies.shape_mass", "kg{per}"),
    ("bodies.added_mass", "kg{per}"),
    ("steps", ""),
    ("repeated_steps", ""),
    ("simulated_time", "s"),
    ("wall_seconds", "s"),
    ("ranks", ""),
    ("rank_imbalance", ""),
    ("rank_waiting_seconds.search", "s"),
    ("rank_waiting_seconds.kinematics", "s"),
    ("rank_waiting_seconds.stress", "s"),
    ("rank_waiting_seconds.forces", "s"),
    ("rank_waiting_seconds.integrate", "s"),
    ("rank_waiting_seconds.output", "s"),
    ("threads", ""),
    ("stage_seconds.search", "s"),
    ("stage_seconds.kinematics", "s"),
    ("stage_seconds.stress", "s"),
    ("stage_seconds.forces", "s"),
    ("stage_seconds.integrate", "s"),
    ("stage_seconds.output", "s"),
    ("mean_neighbors", ""),
    ("particle_steps_per_second", "1/s"),
    ("pairs_per_second", "1/s"),
    ("searched_fraction", ""),
    ("peak_memory_bytes", "B"),
    ("engine_memory_bytes", "B"),
    ("energy.kinetic", "J{per}"),
    ("energy.internal", "J{per}"),
    ("energy.elastic", "J{per}"),
    ("energy.plastic_work", "J{per}"),
    ("energy.external_work", "J{per}"),
    ("energy.load_work", "J{per}"),
    ("energy.integration", "J{per}"),
    ("energy.hourglass", "J{per}"),
    ("energy.hourglass_stored", "J{per}"),
    ("energy.viscous", "J{per}"),
    ("energy.artificial_stress", "J{per}"),
    ("energy.relative_drift", ""),
    ("energy.largest_relative_drift", ""),
    ("momentum_drift", ""),
    ("largest_momentum_drift", ""),
    ("audit.audits", ""),
    ("audit.missed_pairs", ""),
    ("audit.missed_share", ""),
    ("audit.missed_foreign_pairs", ""),
    ("audit.stale_pairs", ""),
    ("audit.density_rate_error", ""),
    ("audit.force_error", ""),
    ("audit.momentum_residual", ""),
    ("warnings.value_time", "s"),
    ("warnings.step", ""),
    ("warnings.time", "s"),
    ("warnings.particle", ""),
    ("warnings.position", "m"),
];

impl Summary {
    /// Version of the form of `summary.json`: it grows when a key goes or changes its meaning or unit, not when one is added.
    pub const FORMAT: u32 = 1;

    /// Units of all numbers, for measures of these units.
    pub(crate) fn units_of(dimensions: Dimensions, measures: &BTreeMap<String, String>) -> BTreeMap<String, String> {
        let per = per(dimensions);
        let own = UNITS.iter().map(|(path, unit)| ((*path).to_owned(), unit.replace("{per}", per)));
        own.chain(measures.iter().map(|(name, unit)| (format!("measures.{name}"), unit.clone()))).collect()
    }

    /// Reads the summary of a run.
    ///
    /// # Errors
    /// [`OutputError::NotEnded`] if the run has none yet, [`OutputError::Read`] if it cannot be read, [`OutputError::Damaged`] if it is
    /// not a summary or one of a later form.
    pub fn read(run: &RunDirectory) -> Result<Self, OutputError> {
        let path = run.summary();
        if !path.exists() && run.deck().exists() {
            return Err(OutputError::NotEnded { path: run.path().to_owned() });
        }
        let text = regular_file::read(&path, most::TEXT).reading(&path)?;
        let summary: Self = serde_json::from_slice(&text).map_err(|e| OutputError::damaged(&path, e.to_string()))?;
        if summary.format > Self::FORMAT {
            let (format, own) = (summary.format, Self::FORMAT);
            return Err(OutputError::damaged(&path, format!("its format is {format}; this program reads up to {own}")));
        }
        Ok(summary)
    }

    pub(crate) fn write(&self, run: &RunDirectory) -> Result<(), OutputError> {
        run.write(SUMMARY, Durability::Disk, |out| {
            serde_json::to_writer_pretty(&mut *out, self)?;
            out.write_all(b"\n")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::testing;
    use serde_json::Value;
    use std::collections::BTreeSet;

    /// Paths of all numbers.
    fn numbers(value: &Value, path: &str, found: &mut BTreeSet<String>) {
        match value {
            Value::Number(_) => drop(found.insert(path.to_owned())),
            Value::Array(values) => values.iter().for_each(|value| numbers(value, path, found)),
            Value::Object(entries) => entries.iter().for_each(|(name, value)| {
                let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
                numbers(value, &path, found);
            }),
            Value::Null | Value::Bool(_) | Value::String(_) => {}
        }
    }

    /// One that has all there can be.
    fn full() -> Summary {
        let measure_units = BTreeMap::from([("height".to_owned(), "m".to_owned())]);
        Summary {
            failure: Some(Box::new(FailureRecord {
                message: "lost".into(),
                step: 7,
                time: 1e-6,
                field: None,
                particle: Some(3),
                body: None,
                position: Some([0.0; 3]),
            })),
            bodies: vec![BodyRecord {
                name: "bar".into(),
                particles: 1000,
                mass: 2.0,
                shape_mass: 2.0,
                added_mass: 0.0,
            }],
            audit: Some(AuditRecord::default()),
            warnings: vec![testing::warning("hot")],
            measures: BTreeMap::from([("height".to_owned(), Some(0.02))]),
            units: Summary::units_of(Dimensions::PlaneStrain, &measure_units),
            measure_units,
            ..testing::summary(1.0)
        }
    }

    #[test]
    fn every_number_has_its_unit() {
        let summary = full();
        let mut found = BTreeSet::new();
        numbers(&serde_json::to_value(&summary).unwrap(), "", &mut found);
        // These have their unit beside them.
        assert!(found.remove("warnings.value") && found.remove("warnings.limit"));
        assert_eq!(found, summary.units.keys().cloned().collect());
        let of = |path: &str| summary.units[path].as_str();
        assert_eq!([of("energy.kinetic"), of("bodies.mass"), of("measures.height")], ["J/m", "kg/m", "m"]);
        assert_eq!(Summary::units_of(Dimensions::Three, &BTreeMap::new())["energy.plastic_work"], "J");
    }

    #[test]
    fn summaries_of_a_later_form_are_refused_and_those_without_one_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let run = RunDirectory::at(folder.path());
        Summary { format: Summary::FORMAT + 1, ..full() }.write(&run).unwrap();
        let Err(OutputError::Damaged { reason, .. }) = Summary::read(&run) else { panic!("it is read") };
        assert_eq!(reason, "its format is 2; this program reads up to 1");
        let mut former = serde_json::to_value(full()).unwrap();
        former.as_object_mut().unwrap().retain(|name, _| name != "format" && name != "units");
        std::fs::write(run.summary(), former.to_string()).unwrap();
        assert_eq!(Summary::read(&run).unwrap().format, 0);
    }
}
