//! Writes frames, rows and the summary of a run under way.

use super::{
    conservation::Conservation,
    driven::DrivenParts,
    error::Trouble,
    frame::{Frame, FrameUnderWay, frame_thread},
    state::Beginning,
    watch::{Clock, Watch},
};
use crate::{
    engine::{
        Audit, Drive, Energies, FieldSource, Ledger, LimitReason, ParticleSource, RunFailure, Simulation, StepReport,
        persist::{Archive, ArchiveError, MOST_COUNTED, Persist, persist_count, persist_option, require},
        reduction::{QueuedSums, Reduction},
    },
    geometry::FilledMass,
    measures::Measures,
    model::{Body, Model, Precision},
    observed::Observed,
    output::{
        AuditRecord, BodyRecord, DiskSync, EndReason, EnergyRecord, FailureRecord, FrameFile, FrameHeader, FrameWriter,
        HISTORY, History, HistorySample, MARK, MemoryOf, OutputError, RunDirectory, SERIES, SeriesEntry, SeriesWriter,
        Status, Sum, Summary, WarningRecord, measure_unit, most, series_text, write_pieces,
    },
};
use rayon::prelude::*;
use std::{array, collections::BTreeMap, time::Instant};

/// Everything that is written while a run goes on.
pub(super) struct Recorder {
    directory: RunDirectory,
    bodies: Vec<BodyRecord>,
    history: History,
    frame_writer: FrameWriter,
    disk: DiskSync,
    measures: Measures,
    observed: Observed,
    conservation: Conservation,
    watch: Watch,
    frames: Vec<SeriesEntry>,
    series: SeriesWriter,
    /// Sums of their files, by their numbers.
    sums: BTreeMap<usize, Sum>,
    last_frame_step: Option<u64>,
    /// The last frame, while it is being written.
    under_way: Option<FrameUnderWay>,
    frame_thread: Option<rayon::ThreadPool>,
    last_row_step: Option<u64>,
    /// The last row, while the engine sums what it says.
    row_under_way: Option<RowUnderWay>,
    /// Energies, external work, what the integrator booked and what springs, viscosity and artificial stress took, of the last row.
    energies: Energies,
    external_work: f64,
    load_work: f64,
    integration_energy: f64,
    hourglass_energy: f64,
    hourglass_stored_energy: f64,
    viscous_energy: f64,
    artificial_stress_energy: f64,
    steps: StepSums,
    steps_at_last_row: StepSums,
    /// Size and reason for the `dt` column.
    step_size: (f64, Option<LimitReason>),
    landing_since_row: bool,
    pairs: Option<u64>,
    audit: Option<Audit>,
    audits: AuditRecord,
    /// What the engine says of its memory, the largest so far.
    engine_bytes: u64,
    seconds: f64,
    /// What a program has given, and by what it ended the run.
    driven: DrivenParts,
    pub(super) stopped_by: Option<String>,
}

/// A row whose sums are still to come. Until it is written nothing else of the recorder changes.
struct RowUnderWay {
    clock: Clock,
    sums: Box<dyn QueuedSums>,
}

/// Sums over the steps.
#[derive(Clone, Copy, Debug, Default)]
struct StepSums {
    count: u64,
    searched: f64,
    pairs: f64,
    /// How often steps were repeated smaller.
    repeats: u64,
}

impl Recorder {
    /// `masses` of the bodies in deck order, as filled.
    pub(super) fn new(
        directory: RunDirectory,
        model: &Model,
        masses: &[FilledMass],
        beginning: Beginning,
    ) -> Result<Self, OutputError> {
        let observed = Observed::new(model);
        let mirrored = array::from_fn(|axis| model.symmetry.iter().any(|plane| plane.axis == axis));
        let scaling = |body: &Body| model.materials.get(body.material).map_or(1.0, |material| material.mass_scaling);
        let body = |(body, filled): (&Body, &FilledMass)| BodyRecord {
            name: body.name.clone(),
            particles: filled.particles as u64,
            mass: filled.mass,
            shape_mass: filled.shape_mass,
            added_mass: filled.mass * (1.0 - 1.0 / scaling(body)),
        };
        Ok(Self {
            bodies: model.bodies.iter().zip(masses).map(body).collect(),
            history: match beginning {
                Beginning::New => History::create(&directory, model, observed.columns())?,
                Beginning::Resumed => History::resumed(&directory, model, observed.columns())?,
            },
            observed,
            frame_writer: FrameWriter::new(model),
            disk: DiskSync::new(),
            measures: Measures::new(model),
            directory,
            conservation: Conservation::new(mirrored),
            watch: Watch::new(model),
            frames: Vec::new(),
            series: SeriesWriter::new(),
            sums: BTreeMap::new(),
            last_frame_step: None,
            under_way: None,
            frame_thread: None,
            last_row_step: None,
            row_under_way: None,
            energies: Energies::default(),
            external_work: 0.0,
            load_work: 0.0,
            integration_energy: 0.0,
            hourglass_energy: 0.0,
            hourglass_stored_energy: 0.0,
            viscous_energy: 0.0,
            artificial_stress_energy: 0.0,
            steps: StepSums::default(),
            steps_at_last_row: StepSums::default(),
            step_size: (0.0, None),
            landing_since_row: true,
            pairs: None,
            audit: None,
            audits: AuditRecord::default(),
            engine_bytes: 0,
            seconds: 0.0,
            driven: DrivenParts::new(model),
            stopped_by: None,
        })
    }

    /// The folder it writes to.
    pub(super) fn directory(&self) -> &RunDirectory {
        &self.directory
    }

    /// Files of frames that should be there and are not, or are not what was written.
    pub(super) fn spoiled_frames(&self) -> Vec<&str> {
        let (directory, sums) = (&self.directory, &self.sums);
        let particles: u64 = self.bodies.iter().map(|body| body.particles).sum();
        let most = most::frame(particles as usize);
        let is_whole = |(index, entry): (usize, &SeriesEntry)| match sums.get(&index) {
            Some(sum) if !directory.has(&entry.file, sum, most) => false,
            // Of frames in pieces the sum is that of the file that names them.
            known => FrameFile::is_whole(&directory.path().join(&entry.file), known.is_some()),
        };
        let spoiled = self.frames.par_iter().enumerate().filter(|frame| !is_whole(*frame));
        spoiled.map(|(_, entry)| entry.file.as_str()).collect()
    }

    /// A number that no run can have at this time, after so many steps.
    pub(super) fn impossible_number(&self, time: f64, steps: u64) -> Option<&'static str> {
        let times: Vec<f64> = self.frames.iter().map(|frame| frame.time).collect();
        let latest = time * (1.0 + 1e-9);
        let sums = |sums: &StepSums| {
            let most = sums.count as f64;
            sums.count <= steps && (0.0..=most).contains(&sums.searched) && (0.0..1e30).contains(&sums.pairs)
        };
        let energies = [
            self.energies.kinetic,
            self.energies.internal,
            self.energies.elastic,
            self.energies.plastic_work,
            self.external_work,
            self.load_work,
            self.integration_energy,
            self.hourglass_energy,
            self.viscous_energy,
            self.artificial_stress_energy,
        ];
        let is_past = |step: Option<u64>| step.is_none_or(|step| step <= steps);
        let numbers = [
            (times.is_sorted() && times.iter().all(|time| (0.0..=latest).contains(time)), "frame_times"),
            (is_past(self.last_frame_step), "last_frame_step"),
            (is_past(self.last_row_step), "last_row_step"),
            (energies.iter().all(|energy| energy.is_finite()) && self.energies.kinetic >= 0.0, "energies"),
            (sums(&self.steps) && sums(&self.steps_at_last_row), "steps"),
            (self.step_size.0.is_finite() && self.step_size.0 >= 0.0, "step_size"),
            (self.engine_bytes < 1 << 56, "engine_bytes"),
            (self.seconds.is_finite() && self.seconds >= 0.0, "seconds"),
        ];
        numbers.into_iter().find(|(fits, _)| !fits).map(|(_, name)| name)
    }

    /// Brings the files to what has been loaded: rows, list of frames, no frames beyond and nothing of the end there was. Returns the names of files
    /// that were not what had been written. No frame is under way then.
    pub(super) fn rewrite(&mut self) -> Result<Vec<&'static str>, OutputError> {
        self.directory.clear_end()?;
        self.directory.remove_frames(self.frames.len())?;
        self.disk.forget_missing();
        let mut differing = self.history.rewrite()?;
        if !self.frames.is_empty() {
            if !self.directory.begins_with(SERIES, series_text(&self.frames).as_bytes()) {
                differing.push(SERIES);
            }
            self.series.write(&self.directory, &self.frames)?;
        }
        Ok(differing)
    }

    /// Notes the size of the first step before it is taken.
    pub(super) fn prepared(&mut self, dt: f64, reason: LimitReason) {
        self.step_size = (dt, Some(reason));
    }

    /// Looks at the size of the next step; fails where the run would not end.
    pub(super) fn watch_step(&mut self, model: &Model, dt: f64, step: u64, time: f64) -> Result<(), Trouble> {
        Ok(self.watch.step(model, dt, step, time)?)
    }

    /// Looks at all of the present state for what is broken.
    pub(super) fn look(&mut self, engine: &Simulation) -> Result<(), Trouble> {
        let start = Instant::now();
        let ledger = engine.ledger()?;
        self.watch.look(engine, engine.model(), Clock::of(engine), (&ledger, &self.conservation), true)?;
        self.seconds += start.elapsed().as_secs_f64();
        Ok(())
    }

    /// Warnings that nobody has been told of.
    pub(super) fn warnings_to_tell(&mut self, model: &Model) -> Vec<WarningRecord> {
        let news = self.watch.news(model);
        self.with_the_driver(news)
    }

    /// Names the program that drives the run where there is one: what is broken may be what it gives.
    fn with_the_driver(&self, mut warnings: Vec<WarningRecord>) -> Vec<WarningRecord> {
        if self.driven.is_driven() {
            let more = "; a program gives loads or velocities to this run: look at these, too";
            warnings.iter_mut().for_each(|warning| warning.cure.push_str(more));
        }
        warnings
    }

    /// Takes what a program gives; whether it is the first.
    pub(super) fn driven(&mut self, drive: &Drive) -> bool {
        let is_first = !self.driven.is_driven();
        self.driven.take(drive);
        is_first && self.driven.is_driven()
    }

    /// Takes a step, which has failed some times before, into the sums.
    pub(super) fn stepped(&mut self, report: &StepReport, failures: u32) {
        self.steps.count += 1;
        self.steps.repeats += u64::from(failures);
        self.steps.searched += report.searched_fraction;
        self.steps.pairs += report.pairs as f64;
        self.pairs = Some(report.pairs);
        if let Some(audit) = &report.audit {
            self.audit = Some(*audit);
            self.audits.add(audit);
        }
        // A step cut for a frame says little of what limits the run.
        let landing = report.reason == LimitReason::Output;
        if !landing || self.landing_since_row {
            self.step_size = (report.dt, Some(report.reason));
            self.landing_since_row = landing;
        }
    }

    /// Takes a row of the present state, and says whether it is written. Where the engine sums while it goes on, [`Self::settle_row`] writes it.
    pub(super) fn row(&mut self, engine: &Simulation) -> Result<bool, Trouble> {
        let start = Instant::now();
        let (model, clock) = (engine.model(), Clock::of(engine));
        self.engine_bytes = self.engine_bytes.max(engine.memory_bytes());
        let queued = match self.asks(model, clock) {
            Some(asked) => engine.queue_sums(&asked)?,
            None => None,
        };
        let is_written = queued.is_none();
        match queued {
            Some(sums) => self.row_under_way = Some(RowUnderWay { clock, sums }),
            None => self.write_row(model, clock, &engine.ledger()?, engine)?,
        }
        self.seconds += start.elapsed().as_secs_f64();
        Ok(is_written)
    }

    /// Writes the row whose sums the engine has taken meanwhile; whether there was one.
    pub(super) fn settle_row(&mut self, model: &Model) -> Result<bool, Trouble> {
        let Some(RowUnderWay { clock, sums }) = self.row_under_way.take() else { return Ok(false) };
        let start = Instant::now();
        let answers = sums.wait().map_err(|lost| RunFailure { step: clock.step, time: clock.time, ..lost })?;
        self.write_row(model, clock, answers.ledger(), &answers)?;
        self.seconds += start.elapsed().as_secs_f64();
        Ok(true)
    }

    /// The sums that a row is made of beside the ledger, where they are known before it is written: not of the first row, and not where a measure is
    /// made of all positions.
    fn asks<'a>(&'a self, model: &'a Model, clock: Clock) -> Option<Vec<Reduction<'a>>> {
        let mut asked = self.watch.asks(model, clock)?;
        asked.extend(self.measures.asks()?);
        asked.extend(self.observed.asks(model)?);
        Some(asked)
    }

    fn write_row(
        &mut self,
        model: &Model,
        clock: Clock,
        ledger: &Ledger,
        source: &dyn ParticleSource,
    ) -> Result<(), Trouble> {
        if let Some(field) = not_finite(ledger) {
            let message = format!(
                "the {field} of the run is not finite; check the constants of the materials and the units of the deck"
            );
            let (step, time) = (clock.step, clock.time);
            return Err(Trouble::from(RunFailure {
                step,
                time,
                field,
                particle: None,
                body: None,
                position: None,
                message,
                step_may_be_smaller: false,
            }));
        }
        let drift = self.conservation.sample(ledger);
        self.watch.look(source, model, clock, (ledger, &self.conservation), false)?;
        let [energy, momentum] = self.watch.rounding();
        self.conservation.set_floor(energy, momentum);
        self.measures.sample(model, clock.time, source)?;
        self.observed.sample(model, source)?;
        let since = self.steps.count - self.steps_at_last_row.count;
        let searched = self.steps.searched - self.steps_at_last_row.searched;
        let sample = HistorySample {
            time: clock.time,
            step: clock.step,
            dt: self.step_size.0,
            reason: self.step_size.1,
            ledger,
            energy_drift: drift.energy,
            momentum_drift: drift.momentum,
            searched_fraction: (since > 0).then(|| searched / since as f64),
            pairs: self.pairs,
            audit: self.audit,
            warnings: self.watch.count() as u64,
            measures: self.measures.values(),
            observed: (self.observed.columns(), self.observed.values()),
        };
        self.history.add(model, &sample)?;
        self.energies = ledger.total.energies;
        self.external_work = ledger.external_work;
        self.load_work = ledger.load_work;
        self.integration_energy = ledger.integration_energy;
        self.hourglass_energy = ledger.hourglass_energy;
        self.hourglass_stored_energy = ledger.hourglass_stored_energy;
        self.viscous_energy = ledger.viscous_energy;
        self.artificial_stress_energy = ledger.artificial_stress_energy;
        self.steps_at_last_row = self.steps;
        self.landing_since_row = true;
        self.last_row_step = Some(clock.step);
        Ok(())
    }

    /// Kinetic energy of the last row, J.
    pub(super) fn kinetic_energy(&self) -> f64 {
        self.energies.kinetic
    }

    /// Writes a frame, then the list of frames, then the rows so far; where the engine lets fields be read while it goes on, the frame is under way then.
    pub(super) fn frame(&mut self, engine: &Simulation) -> Result<usize, Trouble> {
        let start = Instant::now();
        self.settle()?;
        let model = engine.model();
        let index = self.frames.len();
        let at = (engine.time(), engine.steps());
        let processes = engine.in_pieces().filter(|_| model.output.in_pieces);
        let file = RunDirectory::frame_name(index, processes.is_some());
        let written = match processes {
            Some(processes) => {
                let (written, sum) = write_pieces(&self.directory, index, model, at, processes)??;
                self.sums.insert(index, sum);
                Vec::from(written)
            }
            None => {
                let frame = Frame {
                    writer: self.frame_writer.clone(),
                    header: FrameHeader::new(model, at.0, at.1),
                    fields: model.output.fields.clone(),
                };
                let detached = engine.detach()?;
                if detached.is_some() && self.frame_thread.is_none() {
                    self.frame_thread = frame_thread();
                }
                if let Some((thread, source)) = self.frame_thread.as_ref().zip(detached) {
                    self.under_way = Some(FrameUnderWay::start(thread, frame, source, &self.directory, file.clone()));
                    self.frames.push(SeriesEntry { time: engine.time(), file });
                    self.last_frame_step = Some(engine.steps());
                    self.seconds += start.elapsed().as_secs_f64();
                    return Ok(index);
                }
                self.sums.insert(index, frame.write(engine, &self.directory, &file)?);
                vec![file.clone()]
            }
        };
        self.frames.push(SeriesEntry { time: engine.time(), file });
        self.frame_is_there(&written)?;
        self.last_frame_step = Some(engine.steps());
        self.seconds += start.elapsed().as_secs_f64();
        Ok(index)
    }

    /// Writes the list of frames, then the rows so far.
    fn frame_is_there(&mut self, written: &[String]) -> Result<(), OutputError> {
        self.series.grown(&self.directory, &self.frames)?;
        self.history.flush()?;
        written.iter().try_for_each(|name| self.is_written(name))?;
        [SERIES, HISTORY, MARK].iter().try_for_each(|name| self.is_written(name))
    }

    /// Has a file that has been written brought to the disk soon.
    fn is_written(&mut self, name: &str) -> Result<(), OutputError> {
        let written = self.disk.written(&self.directory.opened()?, name);
        self.directory.explain(written)
    }

    /// Waits for the frame that is being written while steps go on. One that could not be is none.
    pub(super) fn settle(&mut self) -> Result<(), OutputError> {
        let Some(under_way) = self.under_way.take() else { return Ok(()) };
        match under_way.wait() {
            Ok((name, sum)) => {
                self.sums.insert(self.frames.len().saturating_sub(1), sum);
                self.frame_is_there(&[name])
            }
            Err(error) => {
                self.frames.pop();
                self.last_frame_step = None;
                Err(error)
            }
        }
    }

    /// Whether the present state has no row or no frame yet.
    pub(super) fn owes(&self, step: u64) -> (bool, bool) {
        (self.last_row_step != Some(step), self.last_frame_step != Some(step))
    }

    pub(super) fn frames(&self) -> usize {
        self.frames.len()
    }

    /// Brings all rows and frames onto the disk. Where some of it is lost or cannot be written, the rest is.
    pub(super) fn flush(&mut self) -> Result<(), OutputError> {
        let start = Instant::now();
        let settled = self.settle();
        let rows = self.history.flush().and_then(|()| self.is_written(HISTORY));
        let list = match self.frames.is_empty() {
            true => Ok(()),
            false => self.series.flush(&self.directory, &self.frames).and_then(|()| self.is_written(SERIES)),
        };
        settled.and(rows).and(list)?;
        self.directory.explain(self.disk.sync())?;
        self.seconds += start.elapsed().as_secs_f64();
        Ok(())
    }

    /// Writes the summary.
    pub(super) fn summary(
        &self,
        engine: &Simulation,
        end_reason: EndReason,
        failure: Option<Box<FailureRecord>>,
        seconds: f64,
        peak_memory_bytes: Option<u64>,
    ) -> (Summary, Result<(), OutputError>) {
        let model = engine.model();
        let steps = self.steps.count;
        let per_second = |amount: f64| if seconds > 0.0 { amount / seconds } else { 0.0 };
        let mut stage_seconds = engine.stage_seconds();
        stage_seconds.output += self.seconds;
        let named = || model.measures.iter().map(|measure| measure.name.clone());
        let measure_units = named()
            .zip(model.measures.iter().map(|measure| measure_unit(&measure.kind, model.dimensions).to_owned()))
            .collect();
        let summary = Summary {
            format: Summary::FORMAT,
            status: match end_reason {
                EndReason::Failure => Status::Failed,
                EndReason::User | EndReason::Program => Status::Stopped,
                _ if self.watch.count() > 0 => Status::CompletedWithWarnings,
                EndReason::EndTime | EndReason::KineticEnergy | EndReason::MaxSteps => Status::Completed,
            },
            end_reason,
            failure,
            stopped_by: self.stopped_by.clone().filter(|_| end_reason == EndReason::Program),
            driven: self.driven.record(model),
            title: model.title.clone(),
            deck: model.name.clone(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            particles: engine.count() as u64,
            bodies: self.bodies.clone(),
            steps,
            repeated_steps: self.steps.repeats,
            simulated_time: engine.time(),
            wall_seconds: seconds,
            ranks: engine.ranks(),
            rank_imbalance: engine.imbalance(),
            rank_waiting_seconds: engine.waiting_seconds().into(),
            threads: rayon::current_num_threads(),
            engine: engine.engine_name().to_owned(),
            device: engine.device(),
            precision: match model.numerics.precision {
                Precision::Mixed => "mixed".to_owned(),
                Precision::Double => "double".to_owned(),
            },
            stage_seconds: stage_seconds.into(),
            mean_neighbors: engine.mean_neighbors(),
            particle_steps_per_second: per_second(engine.count() as f64 * steps as f64),
            pairs_per_second: per_second(self.steps.pairs),
            searched_fraction: if steps > 0 { self.steps.searched / steps as f64 } else { 0.0 },
            peak_memory_bytes: peak_memory_bytes.unwrap_or(self.engine_bytes),
            peak_memory_of: if peak_memory_bytes.is_some() { MemoryOf::Process } else { MemoryOf::Engine },
            engine_memory_bytes: self.engine_bytes,
            energy: EnergyRecord {
                kinetic: self.energies.kinetic,
                internal: self.energies.internal,
                elastic: self.energies.elastic,
                plastic_work: self.energies.plastic_work,
                external_work: self.external_work,
                load_work: self.load_work,
                integration: self.integration_energy,
                hourglass: self.hourglass_energy,
                hourglass_stored: self.hourglass_stored_energy,
                viscous: self.viscous_energy,
                artificial_stress: self.artificial_stress_energy,
                relative_drift: self.conservation.last.energy,
                largest_relative_drift: self.conservation.largest.energy,
            },
            momentum_drift: self.conservation.last.momentum,
            largest_momentum_drift: self.conservation.largest.momentum,
            audit: model.audit.map(|_| self.audits),
            warnings: self.with_the_driver(self.watch.records(model)),
            measures: named().zip(self.measures.values().iter().copied()).collect(),
            units: Summary::units_of(model.dimensions, &measure_units),
            measure_units,
        };
        let written = summary.write(&self.directory);
        (summary, written)
    }
}

/// The first sum over all particles that is no number.
fn not_finite(ledger: &Ledger) -> Option<&'static str> {
    let energies = &ledger.total.energies;
    let sums = [
        (energies.kinetic, "kinetic energy"),
        (energies.internal, "internal energy"),
        (energies.elastic, "elastic energy"),
        (energies.plastic_work, "plastic work"),
        (ledger.external_work, "external work"),
        (ledger.total.momentum.iter().sum(), "momentum"),
    ];
    sums.into_iter().find(|(sum, _)| !sum.is_finite()).map(|(_, name)| name)
}

impl Persist for StepSums {
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        persist_count(&mut self.count, &format!("{name}.count"), archive)?;
        self.searched.persist(&format!("{name}.searched"), archive)?;
        self.pairs.persist(&format!("{name}.pairs"), archive)?;
        persist_count(&mut self.repeats, &format!("{name}.repeats"), archive)
    }
}

impl Persist for Recorder {
    /// Everything but where it is written to. Frames are named by their numbers, so their times tell all of them.
    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        let of = |field: &str| format!("{name}.{field}");
        self.history.persist(&of("history"), archive)?;
        self.measures.persist(&of("measures"), archive)?;
        self.observed.persist(&of("observed"), archive)?;
        self.conservation.persist(&of("conservation"), archive)?;
        self.watch.persist(&of("watch"), archive)?;
        let mut times: Vec<f64> = self.frames.iter().map(|frame| frame.time).collect();
        times.persist(&of("frame_times"), archive)?;
        // Frames before a run went on, on another number of processes, may be of the other form.
        let in_pieces = |index: usize| match self.frames.get(index) {
            Some(known) => known.file == RunDirectory::frame_name(index, true),
            None => self.directory.has_pieces(index),
        };
        let entry = |(index, time)| SeriesEntry { time, file: RunDirectory::frame_name(index, in_pieces(index)) };
        self.frames = times.into_iter().enumerate().map(entry).collect();
        let mut sums: Vec<(usize, Sum)> = self.sums.iter().map(|(index, sum)| (*index, *sum)).collect();
        sums.persist(&of("frame_sums"), archive)?;
        // A frame that was under way when a state was kept in memory has its sum by now.
        self.sums.retain(|index, _| *index < self.frames.len());
        for (index, sum) in sums {
            self.sums.entry(index).or_insert(sum);
        }
        require(self.sums.keys().all(|index| *index < self.frames.len()), &of("frame_sums"))?;
        self.last_frame_step.persist(&of("last_frame_step"), archive)?;
        self.last_row_step.persist(&of("last_row_step"), archive)?;
        self.energies.persist(&of("energies"), archive)?;
        self.external_work.persist(&of("external_work"), archive)?;
        self.integration_energy.persist(&of("integration_energy"), archive)?;
        self.hourglass_energy.persist(&of("hourglass_energy"), archive)?;
        self.hourglass_stored_energy.persist(&of("hourglass_stored_energy"), archive)?;
        self.viscous_energy.persist(&of("viscous_energy"), archive)?;
        self.artificial_stress_energy.persist(&of("artificial_stress_energy"), archive)?;
        self.steps.persist(&of("steps"), archive)?;
        self.steps_at_last_row.persist(&of("steps_at_last_row"), archive)?;
        require(self.steps_at_last_row.count <= self.steps.count, &of("steps_at_last_row.count"))?;
        self.step_size.persist(&of("step_size"), archive)?;
        self.landing_since_row.persist(&of("landing_since_row"), archive)?;
        self.pairs.persist(&of("pairs"), archive)?;
        persist_option(&mut self.audit, &of("audit"), archive)?;
        self.audits.persist(&of("audits"), archive)?;
        require(self.audits.audits <= MOST_COUNTED, &of("audits.audits"))?;
        self.engine_bytes.persist(&of("engine_bytes"), archive)?;
        self.seconds.persist(&of("seconds"), archive)?;
        self.driven.persist(&of("driven"), archive)?;
        // Without loads there is none, and nothing of it in the saved state.
        if self.driven.is_driven() {
            return self.load_work.persist(&of("load_work"), archive);
        }
        self.load_work = 0.0;
        Ok(())
    }
}
