//! Studies of several runs.

use crate::{deck::Deck, errors, guard, words::of_python};
use pyo3::{
    prelude::*,
    types::{PyBytes, PyDict},
};
use sphorge::{
    engine::EngineKind,
    output::Summary,
    plot::{Paper, PictureFormat},
    sweep::{
        Convergence, Planning, Process, Sweep, SweepError, SweepTable, Varied,
        ballistic::{Asked, BallisticLimit, Flight, read_speed},
        execute, spaced,
    },
};
use sphorge_cli::engine_of;
use std::{
    ffi::OsString,
    path::PathBuf,
    sync::{Arc, atomic::AtomicBool},
};

/// How the runs are made.
struct Making {
    kind: Arc<dyn EngineKind>,
    process: Process,
}

impl Making {
    fn new(
        py: Python<'_>,
        program: Vec<OsString>,
        jobs: usize,
        threads: Option<usize>,
        engine: &str,
        device: Option<String>,
    ) -> PyResult<Self> {
        let kind = engine_of(engine, device.as_deref()).map_err(|report| errors::report(py, &report))?;
        let processors = std::thread::available_parallelism().map_or(1, |n| n.get());
        let at_once = jobs.max(1);
        let threads = threads.unwrap_or((processors / at_once).max(1));
        let engine = (engine != "cpu").then(|| engine.to_owned());
        Ok(Self { kind, process: Process { program, at_once, threads, engine, device } })
    }

    /// Makes the runs; Ctrl-C lets those under way save their states.
    fn make(&self, py: Python<'_>, sweep: Sweep) -> PyResult<SweepTable> {
        let stop = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&stop);
        let process = self.process.clone();
        let made = guard::interruptible(py, &stop, move || execute(&sweep, &process, &flag, &|_| ()))?;
        made.map_err(|error| errors::sweep(py, &error))
    }
}

/// Plans runs, which reads and fills many decks; Ctrl-C comes between two of them.
fn planned<T: Send + 'static>(
    py: Python<'_>,
    folder: PathBuf,
    kind: Arc<dyn EngineKind>,
    again: bool,
    plan: impl FnOnce(&Planning<'_>) -> Result<T, SweepError> + Send + 'static,
) -> PyResult<T> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    let made = guard::interruptible_in_pool(py, &stop, move || {
        plan(&Planning { folder: &folder, engine: &*kind, again, stop: &flag })
    });
    made?.map_err(|error| errors::sweep(py, &error))
}

/// What there is to note of each run.
fn notes_of(sweep: &Sweep) -> Vec<Vec<String>> {
    sweep.runs.iter().map(|run| run.notes.iter().map(|note| of_python(note)).collect()).collect()
}

/// A table as columns, each with its name and unit: those of its file, under the same names.
fn told<'py>(py: Python<'py>, table: &SweepTable, notes: Vec<Vec<String>>) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    let units = PyDict::new(py);
    // A measure may be called like another column.
    let free = |name: &str| -> PyResult<String> {
        let mut name = name.to_owned();
        while columns.contains(&name)? {
            name.insert_str(0, "measure.");
        }
        Ok(name)
    };
    columns.set_item("run", table.rows.iter().map(|row| row.run.as_str()).collect::<Vec<_>>())?;
    for (k, key) in table.keys.iter().enumerate() {
        let numbers: Option<Vec<f64>> = table.rows.iter().map(|row| row.numbers[k]).collect();
        let name = free(&key.name)?;
        match numbers {
            Some(numbers) => columns.set_item(&name, numbers)?,
            None => columns.set_item(&name, table.rows.iter().map(|row| row.values[k].as_str()).collect::<Vec<_>>())?,
        }
        units.set_item(name, &key.unit)?;
    }
    columns.set_item(free("status")?, table.rows.iter().map(|row| row.status()).collect::<Vec<_>>())?;
    columns.set_item(free("warnings")?, table.rows.iter().map(|row| row.warnings().join(" ")).collect::<Vec<_>>())?;
    let measure_columns = PyDict::new(py);
    for measure in &table.measures {
        let values = table.rows.iter().map(|row| row.measure(&measure.name).unwrap_or(f64::NAN));
        let name = free(&measure.name)?;
        columns.set_item(&name, values.collect::<Vec<_>>())?;
        units.set_item(&name, &measure.unit)?;
        measure_columns.set_item(&measure.name, name)?;
    }
    let number = |name: &str, unit: &str, pick: fn(&Summary) -> f64| -> PyResult<()> {
        let values = table.rows.iter().map(|row| row.summary.as_ref().map_or(f64::NAN, |of| pick(of)));
        let name = free(name)?;
        columns.set_item(&name, values.collect::<Vec<_>>())?;
        if unit.is_empty() { Ok(()) } else { units.set_item(name, unit) }
    };
    let count = |name: &str, pick: fn(&Summary) -> u64| -> PyResult<()> {
        let counts: Option<Vec<u64>> = table.rows.iter().map(|row| row.summary.as_ref().map(|of| pick(of))).collect();
        match counts {
            Some(counts) => columns.set_item(free(name)?, counts),
            // There is no whole number for what is missing.
            None => {
                let values = table.rows.iter().map(|row| row.summary.as_ref().map_or(f64::NAN, |of| pick(of) as f64));
                columns.set_item(free(name)?, values.collect::<Vec<_>>())
            }
        }
    };
    number("simulated_time", "s", |summary| summary.simulated_time)?;
    number("wall_seconds", "s", |summary| summary.wall_seconds)?;
    count("steps", |summary| summary.steps)?;
    count("particles", |summary| summary.particles)?;
    number("energy_drift", "", |summary| summary.energy.relative_drift)?;
    let dict = PyDict::new(py);
    dict.set_item("columns", columns)?;
    dict.set_item("units", units)?;
    dict.set_item("keys", table.keys.iter().map(|key| key.name.as_str()).collect::<Vec<_>>())?;
    dict.set_item("measure_columns", measure_columns)?;
    dict.set_item("measures", table.measures.iter().map(|of| of.name.as_str()).collect::<Vec<_>>())?;
    dict.set_item("told", table.rows.iter().map(|row| row.told.clone()).collect::<Vec<_>>())?;
    dict.set_item("text", table.to_string())?;
    dict.set_item("notes", notes)?;
    let parquet = table.parquet().map_err(|error| errors::internal(py, &error))?;
    dict.set_item("parquet", PyBytes::new(py, &parquet))?;
    Ok(dict)
}

/// Makes every combination of values that is not there yet, and returns the table.
#[pyfunction]
#[pyo3(signature = (deck, varied, folder, program, *, jobs, threads, engine, device, overwrite))]
pub(crate) fn sweep<'py>(
    py: Python<'py>,
    deck: PyRef<'py, Deck>,
    varied: Vec<(String, Vec<String>)>,
    folder: PathBuf,
    program: Vec<OsString>,
    jobs: usize,
    threads: Option<usize>,
    engine: &str,
    device: Option<String>,
    overwrite: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let making = Making::new(py, program, jobs, threads, engine, device)?;
    let varied: Vec<Varied> = varied.into_iter().map(|(key, values)| Varied { key, values }).collect();
    let (deck, kind) = (without(&deck, varied.iter().map(|of| of.key.as_str()), py)?, Arc::clone(&making.kind));
    let sweep =
        planned(py, folder, kind, overwrite, move |planning| Sweep::plan(|set| deck.load_with(set), varied, planning))?;
    let notes = notes_of(&sweep);
    told(py, &making.make(py, sweep)?, notes)
}

/// Makes the runs at these points, a value for each key, that are not there yet, and returns the table.
#[pyfunction]
#[pyo3(signature = (deck, keys, points, folder, program, *, jobs, threads, engine, device, overwrite))]
pub(crate) fn points<'py>(
    py: Python<'py>,
    deck: PyRef<'py, Deck>,
    keys: Vec<String>,
    points: Vec<Vec<String>>,
    folder: PathBuf,
    program: Vec<OsString>,
    jobs: usize,
    threads: Option<usize>,
    engine: &str,
    device: Option<String>,
    overwrite: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let making = Making::new(py, program, jobs, threads, engine, device)?;
    let (deck, kind) = (without(&deck, keys.iter().map(String::as_str), py)?, Arc::clone(&making.kind));
    let sweep = planned(py, folder, kind, overwrite, move |planning| {
        Sweep::points(|set| deck.load_with(set), &keys, &points, planning)
    })?;
    let notes = notes_of(&sweep);
    told(py, &making.make(py, sweep)?, notes)
}

/// A copy of a deck that sets none of these keys, which would be set twice, nor is any of them set by another one.
fn without<'a>(deck: &Deck, keys: impl Iterator<Item = &'a str>, py: Python<'_>) -> PyResult<Deck> {
    deck.refuse_overlapping(py, keys.map(str::to_owned).collect())?;
    Ok(deck.clone())
}

/// Makes the runs at several spacings that are not there yet; returns the table, and order and limit of each measure.
#[pyfunction]
#[pyo3(signature = (deck, spacings, folder, program, *, jobs, threads, engine, device, overwrite))]
pub(crate) fn convergence<'py>(
    py: Python<'py>,
    deck: PyRef<'py, Deck>,
    spacings: Vec<String>,
    folder: PathBuf,
    program: Vec<OsString>,
    jobs: usize,
    threads: Option<usize>,
    engine: &str,
    device: Option<String>,
    overwrite: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let making = Making::new(py, program, jobs, threads, engine, device)?;
    let (deck, kind) = (without(&deck, ["particles.spacing"].into_iter(), py)?, Arc::clone(&making.kind));
    let to = folder.clone();
    let spaced =
        planned(py, to, kind, overwrite, move |planning| spaced(|set| deck.load_with(set), &spacings, planning))?;
    let notes = notes_of(&spaced.sweep);
    let table = making.make(py, spaced.sweep)?;
    let convergence = Convergence::of(&table);
    convergence.write(&folder).map_err(|error| errors::output(py, &error))?;
    let dict = told(py, &table, notes)?;
    let measures = PyDict::new(py);
    for measure in &convergence.measures {
        let of = PyDict::new(py);
        of.set_item("unit", &measure.unit)?;
        of.set_item("values", measure.values.iter().map(|x| x.unwrap_or(f64::NAN)).collect::<Vec<_>>())?;
        of.set_item("order", measure.limit.ok().map(|of| of.0))?;
        of.set_item("limit", measure.limit.ok().map(|of| of.1))?;
        of.set_item("why_not", measure.limit.err())?;
        measures.set_item(&measure.name, of)?;
    }
    dict.set_item("convergence", measures)?;
    dict.set_item("text", format!("{table}\n{convergence}"))?;
    Ok(dict)
}

/// Runs at several impact speeds until the ballistic limit is bracketed; returns the table, slow to fast, bracket and curve.
#[pyfunction]
#[pyo3(signature = (deck, body, residual, bounds, within, at, runs, exponent, through, folder, program, *, jobs, threads, engine, device, overwrite))]
pub(crate) fn ballistic_limit<'py>(
    py: Python<'py>,
    deck: PyRef<'py, Deck>,
    body: Vec<String>,
    residual: Option<String>,
    bounds: (Option<String>, Option<String>),
    within: Option<String>,
    at: Vec<String>,
    runs: usize,
    exponent: Option<f64>,
    through: Option<String>,
    folder: PathBuf,
    program: Vec<OsString>,
    jobs: usize,
    threads: Option<usize>,
    engine: &str,
    device: Option<String>,
    overwrite: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let speed = |text: &Option<String>, what: &str| {
        text.as_deref().map(|text| read_speed(text, what)).transpose().map_err(|error| errors::sweep(py, &error))
    };
    let making = Making::new(py, program, jobs, threads, engine, device)?;
    let (from, to) = (speed(&bounds.0, "--from")?, speed(&bounds.1, "--to")?);
    let (within, through) = (speed(&within, "--within")?, speed(&through, "--through")?);
    let at = at.into_iter().map(|text| speed(&Some(text), "--at")).collect::<PyResult<Vec<_>>>()?;
    let at = at.into_iter().flatten().collect();
    let asked = Asked { from, to, at, within, runs, at_once: jobs.max(1), exponent }.checked();
    let asked = asked.map_err(|error| errors::sweep(py, &error))?;
    let own = deck.clone();
    let flight = guard::in_pool(py, move || {
        let setup = own.load_with(&[])?;
        Ok(Flight::of(&setup, &body, residual.as_deref()))
    })?;
    let flight = flight.map_err(|report| errors::deck(py, &report))?.map_err(|error| errors::sweep(py, &error))?;
    let flight = Flight { through, ..flight };
    let deck = without(&deck, flight.keys().iter().map(String::as_str), py)?;
    let search = asked.search(&flight);
    let (loaded, of) = (deck.clone(), flight.clone());
    let known = planned(py, folder.clone(), Arc::clone(&making.kind), overwrite, move |planning| {
        of.known(|set| loaded.load_with(set), planning)
    })?;
    let mut made = 0;
    let mut notes: Vec<Vec<String>> = Vec::new();
    let searched = search.execute(&known, |speeds| {
        let (deck, flight_of, wanted) = (deck.clone(), flight.clone(), speeds.to_vec());
        let mut sweep = planned(py, folder.clone(), Arc::clone(&making.kind), overwrite, move |planning| {
            flight_of.sweep(|set| deck.load_with(set), &wanted, planning)
        })?;
        sweep.keep_first(made);
        made = speeds.len();
        notes = notes_of(&sweep);
        let table = making.make(py, sweep)?;
        let shots = flight.shots(&table, &folder, speeds);
        PyResult::Ok((table, shots))
    })?;
    let Some(searched) = searched else { return Err(errors::internal(py, "a search without a run")) };
    let limit = BallisticLimit::of(&search, &flight, &searched);
    limit.write(&folder).map_err(|error| errors::output(py, &error))?;
    let notes = searched.in_order().into_iter().map(|k| notes.get(k).cloned().unwrap_or_default()).collect();
    let mut table = searched.table.clone();
    table.rows = limit.shots.iter().map(|(_, row)| row.clone()).collect();
    let dict = told(py, &table, notes)?;
    let of = PyDict::new(py);
    let number = |x: Option<f64>| x.unwrap_or(f64::NAN);
    of.set_item("impact_velocity", limit.shots.iter().map(|(shot, _)| shot.speed).collect::<Vec<_>>())?;
    of.set_item("residual_velocity", limit.shots.iter().map(|(shot, _)| number(shot.residual)).collect::<Vec<_>>())?;
    of.set_item("outcome", limit.shots.iter().map(|(shot, _)| shot.outcome.name()).collect::<Vec<_>>())?;
    of.set_item("bracket", limit.bracket.map(|bracket| (bracket.stopped, bracket.through)))?;
    let curve = limit.curve.as_ref().ok().map(|curve| (curve.a, curve.p, curve.limit, curve.off_by, curve.runs));
    of.set_item("curve", curve)?;
    of.set_item("why_no_curve", limit.curve.as_ref().err())?;
    of.set_item("is_found", limit.is_found())?;
    of.set_item("remarks", limit.notes().iter().map(|note| of_python(note)).collect::<Vec<_>>())?;
    for (name, format) in [("png", PictureFormat::Png), ("svg", PictureFormat::Svg)] {
        let to = folder.join("plots").join(format!("ballistic-limit.{}", format.extension()));
        let title = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let is_drawn =
            limit.draw(&title, Paper::default(), &to).map_err(|error| errors::internal(py, &error.to_string()))?;
        let data = is_drawn.then(|| std::fs::read(&to)).transpose()?;
        of.set_item(name, data.as_deref().map(|data| PyBytes::new(py, data)))?;
    }
    dict.set_item("ballistic", of)?;
    dict.set_item("text", of_python(&limit.to_string()))?;
    Ok(dict)
}
