//! The extension module `sphorge._sphorge`: what the Python files of the package `sphorge` are written with.
//!
//! Values cross as bytes of numbers, texts and JSON, so that this module needs neither numpy nor a version of it. Whatever takes long is done without
//! the lock of the interpreter, and whatever goes wrong here, a fault of ours too, becomes an exception of `sphorge._errors`.

mod command;
mod deck;
mod errors;
mod files;
mod guard;
mod simulation;
mod studies;
mod values;
mod words;

use pyo3::prelude::*;

/// The module.
#[pymodule]
fn _sphorge(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("has_mpi", cfg!(feature = "mpi"))?;
    module.add_class::<deck::Deck>()?;
    module.add_class::<files::Frame>()?;
    module.add_class::<simulation::Driver>()?;
    module.add_function(wrap_pyfunction!(command::main, module)?)?;
    module.add_function(wrap_pyfunction!(deck::decks, module)?)?;
    module.add_function(wrap_pyfunction!(deck::materials, module)?)?;
    module.add_function(wrap_pyfunction!(deck::quantity, module)?)?;
    module.add_function(wrap_pyfunction!(deck::quantity_of_key, module)?)?;
    module.add_function(wrap_pyfunction!(files::summary, module)?)?;
    module.add_function(wrap_pyfunction!(files::history, module)?)?;
    module.add_function(wrap_pyfunction!(files::frames, module)?)?;
    module.add_function(wrap_pyfunction!(files::fragments, module)?)?;
    module.add_function(wrap_pyfunction!(simulation::fields, module)?)?;
    module.add_function(wrap_pyfunction!(studies::sweep, module)?)?;
    module.add_function(wrap_pyfunction!(studies::ballistic_limit, module)?)?;
    module.add_function(wrap_pyfunction!(studies::convergence, module)?)?;
    module.add_function(wrap_pyfunction!(studies::points, module)?)?;
    module.add_function(wrap_pyfunction!(command::draw, module)?)?;
    module.add_function(wrap_pyfunction!(command::plot_options, module)?)?;
    module.add_function(wrap_pyfunction!(deck::difference, module)?)?;
    module.add_function(wrap_pyfunction!(files::report, module)?)?;
    module.add_function(wrap_pyfunction!(words::words, module)?)?;
    module.add_function(wrap_pyfunction!(words::did_you_mean, module)?)?;
    module.add_function(wrap_pyfunction!(guard::panic_for_tests, module)?)?;
    Ok(())
}
