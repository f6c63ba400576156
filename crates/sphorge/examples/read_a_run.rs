//! Reads what a run has written: its summary, a column of its history, and the hottest particle of each frame.
//!
//!     cargo run --release --example read_a_run -- out/iron-plate

use sphorge::output::{FrameFile, HistoryTable, RunDirectory, Summary, read_series};
use std::{env, error::Error, path::PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let path = PathBuf::from(env::args().nth(1).ok_or("give the folder of a run")?);
    let run = RunDirectory::open(&path)?;

    let summary = Summary::read(&run)?;
    println!("{}: {}, {} particles", summary.title, summary.status.name(), summary.particles);
    println!("kinetic energy at the end: {:.4e} {}", summary.energy.kinetic, summary.units["energy.kinetic"]);

    let history = HistoryTable::read(&run)?;
    let (_, times) = history.column("time").ok_or("the history has no times")?;
    let (column, energies) = history.column("kinetic_energy").ok_or("the history has no kinetic energy")?;
    if let Some(half) = energies.iter().position(|energy| *energy < 0.5 * energies[0]) {
        println!("half of the {} was spent at {:.3e} s", column.meaning, times[half]);
    }

    for (time, file) in read_series(&run)? {
        // Values are read when asked for; particle `i` is the same in every frame.
        let mut frame = FrameFile::open(&file)?;
        let positions = frame.positions()?;
        let (Some(temperature), Some(body)) = (frame.column("temperature")?, frame.column("body")?) else {
            return Err("the frames hold no temperature or body".into());
        };
        let hottest = (0..frame.count).max_by(|&i, &j| temperature.values[i].total_cmp(&temperature.values[j]));
        let Some(i) = hottest else { continue };
        let name = frame.bodies.get(body.values[i] as usize).map_or("", |body| body.name.as_str());
        println!("{time:.3e} s: {:.1} K in {name} at {:.3?} m", temperature.values[i], positions[i]);
    }
    Ok(())
}
