//! What the tests of the program share: a small deck, and ways to run it.
#![allow(unused, unreachable_pub)] // Every test file is a crate of its own and uses a part.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Child, Command, Output, Stdio},
    thread,
    time::{Duration, Instant},
};
use tempfile::TempDir;

/// A variable of the environment that names another program to be tested, which was built without features.
const OTHER_PROGRAM: &str = "SPHORGE_PROGRAM";

/// Whether the program has the engine for GPUs.
pub fn has_gpu() -> bool {
    cfg!(feature = "gpu") && std::env::var_os(OTHER_PROGRAM).is_none()
}

/// Whether the program can run on processes of MPI.
pub fn has_mpi() -> bool {
    cfg!(feature = "mpi") && std::env::var_os(OTHER_PROGRAM).is_none()
}

/// A plate on a wall: 190 particles, some thirty steps.
pub const DECK: &str = r#"title = "Small plate on a wall"
dimensions = "plane-strain"
method = "updated-lagrangian"

[particles]
spacing = "1 mm"

[time]
end = "2 us"

[output]
frames = 4

[[body]]
name = "plate"
material = "armco-iron"
shape = { box = { min = ["-4 mm", "0 mm"], max = ["4 mm", "24 mm"] } }
velocity = ["0 m/s", "-100 m/s"]

[[wall]]
name = "anvil"
plane = { point = ["0 mm", "0 mm"], normal = [0, 1] }

[[measure]]
name = "height"
extent = { body = "plate", axis = "y" }
"#;

/// A folder with the deck in it, `plate.toml`, to run the program in.
pub struct Place {
    folder: TempDir,
}

impl Place {
    pub fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        fs::write(folder.path().join("plate.toml"), DECK).expect("the deck");
        Self { folder }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn command(&self, arguments: &[&str]) -> Command {
        let own = env!("CARGO_BIN_EXE_sphorge").into();
        let mut command = Command::new(std::env::var_os(OTHER_PROGRAM).unwrap_or(own));
        // Plain diagnostics of a known width, whatever the terminal of whoever runs the tests.
        command.current_dir(self.folder.path()).args(arguments).env("NO_COLOR", "1").env("LC_ALL", "C.UTF-8");
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    pub fn run(&self, arguments: &[&str]) -> Ended {
        Ended::from(self.command(arguments).output().expect("the program starts"))
    }

    pub fn summary(&self, run: &str) -> serde_json::Value {
        let text = fs::read(self.path(run).join("summary.json")).expect("a summary");
        serde_json::from_slice(&text).expect("a summary in JSON")
    }
}

/// How the program ended.
#[derive(Debug)]
pub struct Ended {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

impl From<Output> for Ended {
    fn from(output: Output) -> Self {
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text in UTF-8");
        Self { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
    }
}

impl Ended {
    /// Ended with this code and without a panic.
    pub fn expect_code(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "{self:#?}");
        assert!(!self.err.contains("panicked"), "{self:#?}");
        self
    }

    /// Every text is somewhere in the diagnostics, which may break lines anywhere.
    pub fn expect_told(&self, texts: &[&str]) {
        let told = self.err.replace(['│', '|'], " ").split_whitespace().collect::<Vec<_>>().join(" ");
        for text in texts {
            assert!(told.contains(text), "`{text}` is not in:\n{}", self.err);
        }
    }
}

/// Waits until something is the case, half a minute at most.
pub fn wait_for(what: &str, mut is_so: impl FnMut() -> bool) {
    let start = Instant::now();
    while !is_so() {
        assert!(start.elapsed() < Duration::from_secs(30), "waited for {what} in vain");
        thread::sleep(Duration::from_millis(10));
    }
}

/// Every file in a folder and its folders.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() { found.extend(files(&path)) } else { found.push(path) }
    }
    found
}
