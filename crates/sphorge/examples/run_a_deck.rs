//! Runs a deck and draws what happened.
//!
//!     cargo run --release --example run_a_deck -- my.toml out/mine

use sphorge::{
    deck,
    engine::ENGINES,
    geometry::MAX_PARTICLES,
    output::RunDirectory,
    plot::{Paper, PictureFormat, plot_run},
    run::{Observer, Progress, RunOptions, execute},
};
use std::{env, path::PathBuf, sync::atomic::AtomicBool};

/// Tells how far the run is whenever a frame is written.
#[derive(Default)]
struct Frames {
    share: f64,
}

impl Observer for Frames {
    fn progressed(&mut self, progress: &Progress) {
        self.share = progress.fraction;
    }

    fn frame_written(&mut self, index: usize, time: f64) {
        println!("frame {index} at {time:.3e} s, {:.0} % done", 100.0 * self.share);
    }

    fn noted(&mut self, note: &str) {
        println!("note: {note}");
    }
}

fn main() -> miette::Result<()> {
    let mut arguments = env::args().skip(1).map(PathBuf::from);
    let (Some(file), Some(directory)) = (arguments.next(), arguments.next()) else {
        return Err(miette::miette!("give a deck and a folder to write to"));
    };
    // What is wrong with a deck, or goes wrong in a run, is told by `miette` as the command line does: with the line and the cure.
    let setup = deck::load(&file, &[], MAX_PARTICLES)?;
    setup.all_notes().iter().for_each(|note| println!("note: {note}"));

    // Raise the flag from another thread, or a handler of signals, and the run ends after the present step.
    let stop = AtomicBool::new(false);
    let options = RunOptions { directory, ..RunOptions::default() };
    let summary = execute(setup, ENGINES[0], &options, &stop, &mut Frames::default())?;

    println!("{}: {} steps in {:.1} s", summary.status.name(), summary.steps, summary.wall_seconds);
    for (name, value) in &summary.measures {
        println!("{name} = {value:?} {}", summary.measure_units[name]);
    }
    let run = RunDirectory::open(&options.directory)?;
    for picture in plot_run(&run, Paper::default(), PictureFormat::Png, &run.plots())? {
        println!("{}", picture.display());
    }
    Ok(())
}
