//! What runs have written.

use crate::{errors, guard, values::Packed};
use pyo3::{exceptions::PyKeyError, prelude::*, types::PyByteArray};
use sphorge::{
    fragments::{FragmentError, FragmentOptions, fragments as of_run},
    output::{FrameFile, HistoryTable, OutputError, RunDirectory, Summary, read_series},
    plot::FrameChoice,
};
use std::path::PathBuf;

/// The summary of a run in JSON; none while it has not ended.
#[pyfunction]
pub(crate) fn summary(py: Python<'_>, folder: PathBuf) -> PyResult<Option<String>> {
    let read = guard::detached(py, || RunDirectory::open(&folder).and_then(|run| Summary::read(&run)))?;
    match read {
        Ok(summary) => {
            serde_json::to_string(&summary).map(Some).map_err(|error| errors::internal(py, &error.to_string()))
        }
        Err(OutputError::NotEnded { .. }) => Ok(None),
        Err(error) => Err(errors::output(py, &error)),
    }
}

/// What the command line tells of a run that has ended; none while it has not.
#[pyfunction]
pub(crate) fn report(py: Python<'_>, folder: PathBuf) -> PyResult<Option<String>> {
    let read = guard::detached(py, || RunDirectory::open(&folder).and_then(|run| Summary::read(&run)))?;
    match read {
        Ok(summary) => Ok(Some(sphorge_cli::report(&summary))),
        Err(OutputError::NotEnded { .. }) => Ok(None),
        Err(error) => Err(errors::output(py, &error)),
    }
}

type HistoryColumn<'py> = (String, String, String, Bound<'py, PyByteArray>, Option<Vec<String>>);

/// The history of a run: name, unit, meaning, values and words of each column.
#[pyfunction]
pub(crate) fn history(py: Python<'_>, folder: PathBuf) -> PyResult<Vec<HistoryColumn<'_>>> {
    let read = guard::detached(py, || RunDirectory::open(&folder).and_then(|run| HistoryTable::read(&run)))?;
    let table = read.map_err(|error| errors::output(py, &error))?;
    let values = table.values.iter().map(|values| values.iter().flat_map(|x| x.to_ne_bytes()).collect::<Vec<u8>>());
    let columns = table.columns.iter().zip(values);
    Ok(columns
        .map(|(of, bytes)| {
            let words = table.words.get(&of.name).cloned();
            (of.name.clone(), of.unit.clone(), of.meaning.clone(), PyByteArray::new(py, &bytes), words)
        })
        .collect())
}

/// The frames of a run: time and file of each.
#[pyfunction]
pub(crate) fn frames(py: Python<'_>, folder: PathBuf) -> PyResult<Vec<(f64, PathBuf)>> {
    let read = guard::detached(py, || RunDirectory::open(&folder).and_then(|run| read_series(&run)))?;
    read.map_err(|error| errors::output(py, &error))
}

/// The fragments in a frame of a run, in JSON.
#[pyfunction]
pub(crate) fn fragments(
    py: Python<'_>,
    folder: PathBuf,
    frame: usize,
    bodies: Vec<String>,
    link: f64,
    least: u64,
) -> PyResult<String> {
    let options = FragmentOptions { bodies, link, least };
    let find = || -> Result<_, FragmentError> {
        let tables = of_run(&RunDirectory::open(&folder)?, Some(FrameChoice::Index(frame)), &options)?;
        Ok(tables.into_iter().next())
    };
    let table = guard::detached(py, find)?.map_err(|error| errors::fragments(py, &error))?;
    serde_json::to_string(&table).map_err(|error| errors::internal(py, &error.to_string()))
}

/// A frame on the disk.
#[pyclass(module = "sphorge._sphorge")]
pub(crate) struct Frame {
    file: FrameFile,
}

#[pymethods]
impl Frame {
    #[new]
    fn open(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let file = guard::detached(py, || FrameFile::open(&path))?.map_err(|error| errors::output(py, &error))?;
        Ok(Self { file })
    }

    #[getter]
    fn time(&self) -> f64 {
        self.file.header.time
    }

    #[getter]
    fn step(&self) -> u64 {
        self.file.header.step
    }

    #[getter]
    fn dimensions(&self) -> usize {
        self.file.header.dimensions
    }

    #[getter]
    fn count(&self) -> usize {
        self.file.count
    }

    /// Name and material of each body.
    #[getter]
    fn bodies(&self) -> Vec<(String, String)> {
        self.file.bodies.iter().map(|body| (body.name.clone(), body.material.clone())).collect()
    }

    /// Particle spacing of each body, m.
    #[getter]
    fn spacings(&self) -> Vec<f64> {
        self.file.header.body_spacing.clone()
    }

    /// Name, unit and names of the components of each field.
    #[getter]
    fn fields(&self) -> Vec<(String, String, Vec<String>)> {
        self.file.arrays().iter().map(|of| (of.name.clone(), of.unit.clone(), of.components.clone())).collect()
    }

    fn positions<'py>(&mut self, py: Python<'py>) -> PyResult<(Bound<'py, PyByteArray>, &'static str, usize)> {
        let file = &mut self.file;
        let read = guard::detached(py, || file.positions())?.map_err(|error| errors::output(py, &error))?;
        let bytes = read.iter().flatten().flat_map(|x| x.to_ne_bytes()).collect();
        Ok(Packed { bytes, kind: "f8", width: 3 }.owned(py))
    }

    fn column<'py>(&mut self, py: Python<'py>, name: &str) -> PyResult<(Bound<'py, PyByteArray>, &'static str, usize)> {
        let file = &mut self.file;
        let read = guard::detached(py, || file.column(name))?.map_err(|error| errors::output(py, &error))?;
        let column = read.ok_or_else(|| PyKeyError::new_err(name.to_owned()))?;
        let is_whole = file.arrays().iter().any(|of| of.name == name && of.is_of_whole_numbers());
        let bytes = if is_whole {
            column.values.iter().flat_map(|x| (*x as u32).to_ne_bytes()).collect()
        } else {
            column.values.iter().flat_map(|x| x.to_ne_bytes()).collect()
        };
        Ok(Packed { bytes, kind: if is_whole { "u4" } else { "f4" }, width: column.width }.owned(py))
    }
}
