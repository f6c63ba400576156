//! A history, the list of frames or the summary of a run read back: the first byte chooses.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sphorge::output::{HistoryTable, RunDirectory, Summary, read_series};
use sphorge_fuzz::{folder, seed, show, tiny_run};
use std::{fs, path::PathBuf, sync::LazyLock};

static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| folder("history"));
const FILES: [&str; 4] = ["history.csv", "history-columns.json", "fields.pvd", "summary.json"];

fuzz_target!(
    init: {
        let run = tiny_run(&FOLDER);
        for (k, file) in FILES.iter().enumerate() {
            let bytes = fs::read(run.join(file)).expect("a file of the run");
            seed(file, &[&[k as u8], bytes.as_slice()].concat()).expect("a seed");
        }
    },
    |data: &[u8]| {
        let Some((&choice, bytes)) = data.split_first() else { return };
        let run = RunDirectory::open(&FOLDER.join("tiny")).expect("the folder");
        let choice = usize::from(choice) % FILES.len();
        fs::write(run.path().join(FILES[choice]), bytes).expect("a file");
        match choice {
            0 | 1 => drop(HistoryTable::read(&run).map_err(show)),
            2 => drop(read_series(&run).map_err(show)),
            _ => drop(Summary::read(&run).map_err(show)),
        }
    }
);
