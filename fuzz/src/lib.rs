//! What the fuzz targets share: a folder for their files, a run of nine particles, and where seeds go.

use sphorge::{
    deck::load_text_within,
    engine::ENGINES,
    run::{CheckpointPlan, RunOptions, Silent, execute},
};
use std::{
    fs, io,
    path::{Path, PathBuf},
    process,
    sync::atomic::AtomicBool,
};

/// Particles a deck may make here: what is asked is whether it is read, not whether it runs.
pub const MOST_PARTICLES: f64 = 2000.0;

/// A deck of nine particles with whatever writes a file: frames, rows, measures, a tracer.
pub const TINY: &str = r#"
dimensions = "plane-strain"
[particles]
spacing = "1 mm"
[time]
end = "1 us"
max-steps = 2
[output]
frames = 1
fields = ["velocity", "stress", "plastic_strain"]
[[body]]
name = "bar"
material = "armco-iron"
shape = { box = { min = [0, 0], max = ["3 mm", "3 mm"] } }
velocity = [0, "-10 m/s"]
[[wall]]
name = "anvil"
plane = { point = [0, 0], normal = [0, 1] }
[[measure]]
name = "height"
extent = { axis = "y" }
[[tracer]]
name = "tail"
point = ["1 mm", "2 mm"]
"#;

/// A folder of this process, in memory where the machine has such a place.
pub fn folder(target: &str) -> PathBuf {
    let memory = Path::new("/dev/shm");
    let root = if memory.is_dir() { memory.to_owned() } else { std::env::temp_dir() };
    let folder = root.join(format!("sphorge-fuzz-{target}-{}", process::id()));
    fs::create_dir_all(&folder).expect("a folder for files");
    folder
}

/// The files of the tiny run, in a folder of their own.
pub fn tiny_run(folder: &Path) -> PathBuf {
    let directory = folder.join("tiny");
    let setup = load_text_within("tiny", TINY, &[], MOST_PARTICLES).expect("a good deck");
    let options = RunOptions {
        directory: directory.clone(),
        overwrite: true,
        by_force: false,
        threads: Some(1),
        checkpoints: CheckpointPlan { at_end: true, ..CheckpointPlan::default() },
    };
    execute(setup, ENGINES[0], &options, &AtomicBool::new(false), &mut Silent).expect("a run");
    directory
}

/// Puts a seed where `scripts/fuzz.sh` says seeds of the target go, if it runs this.
pub fn seed(name: &str, bytes: &[u8]) -> io::Result<()> {
    match std::env::var_os("SPHORGE_FUZZ_SEEDS") {
        Some(folder) => fs::write(Path::new(&folder).join(name), bytes),
        None => Ok(()),
    }
}

/// A diagnostic as the terminal shows it: writing it is part of what must not fail.
pub fn show(report: impl miette::Diagnostic + Send + Sync + 'static) {
    let _ = format!("{:?}", miette::Report::new(report));
}

/// The same of a deck, of which nothing moves the cursor.
pub fn show_of_deck(report: impl miette::Diagnostic + Send + Sync + 'static) {
    let text = format!("{:?}", miette::Report::new(report));
    let is_plain = |c: char| !c.is_control() || matches!(c, '\n' | '\t' | '\u{1b}');
    assert!(text.chars().all(is_plain), "a control character reaches the terminal: {text:?}");
}
