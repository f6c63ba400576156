//! A frame read back.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sphorge::output::FrameFile;
use sphorge_fuzz::{folder, seed, show, tiny_run};
use std::{fs, path::PathBuf, sync::LazyLock};

static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| folder("frame"));

fuzz_target!(
    init: {
        let run = tiny_run(&FOLDER);
        seed("tiny", &fs::read(run.join("fields/000000.vtp")).expect("a frame")).expect("a seed");
    },
    |data: &[u8]| {
        let path = FOLDER.join("frame.vtp");
        fs::write(&path, data).expect("a file");
        match FrameFile::open(&path) {
            Err(error) => show(error),
            Ok(mut frame) => {
                let _ = frame.positions();
                let names: Vec<String> = frame.arrays().iter().map(|array| array.name.clone()).collect();
                for name in names.iter().take(20) {
                    let _ = frame.column(name);
                }
            }
        }
    }
);
