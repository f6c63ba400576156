//! A run resumed from a checkpoint. A first byte of zero: the rest is the file. Else the rest are edits of the entries of a good one,
//! whose sums are right, so that what is loaded is not what was saved.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sha2::{Digest, Sha256};
use sphorge::engine::Cpu;
use sphorge::run::{CheckpointPlan, ResumeOptions, Silent, resume};
use sphorge_fuzz::{MOST_PARTICLES, folder, seed, show, tiny_run};
use std::{
    fs,
    io::{Cursor, Read, Write},
    path::PathBuf,
    sync::{Arc, LazyLock, atomic::AtomicBool},
};
use zip::{CompressionMethod, ZipArchive, ZipWriter, write::SimpleFileOptions};

type Entries = Vec<(String, Vec<u8>)>;

/// A folder with a run that can be resumed, and what its checkpoint holds.
static RUN: LazyLock<(PathBuf, String, Vec<u8>, Entries)> = LazyLock::new(|| {
    let run = tiny_run(&folder("checkpoint"));
    let is_checkpoint = |name: &String| name.starts_with("checkpoint-");
    let names = fs::read_dir(&run)
        .expect("the folder")
        .map(|entry| entry.expect("an entry").file_name().into_string().expect("a name"));
    let name = names.into_iter().find(is_checkpoint).expect("a checkpoint");
    let whole = fs::read(run.join(&name)).expect("the checkpoint");
    let mut archive = ZipArchive::new(Cursor::new(&whole)).expect("a ZIP file");
    let entry = |index: usize| {
        let mut file = archive.by_index(index).expect("an entry");
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).expect("its bytes");
        (file.name().expect("a name").into_owned(), bytes)
    };
    let entries = (0..ZipArchive::new(Cursor::new(&whole)).expect("a ZIP file").len()).map(entry).collect();
    (run, name, whole, entries)
});

/// Entries with edits: which entry, what to do, where, and with which value.
fn edited(edits: &[u8]) -> Vec<u8> {
    let mut entries = RUN.3.clone();
    for edit in edits.chunks_exact(12).take(8) {
        let index = usize::from(u16::from_le_bytes([edit[0], edit[1]])) % entries.len();
        let bytes = &mut entries[index].1;
        let at = usize::from(edit[3]) * 8;
        match edit[2] % 5 {
            0 => bytes.truncate(at),
            1 => bytes.extend_from_slice(&edit[4..12]),
            2 => bytes.clear(),
            _ => {
                let room = bytes.len();
                bytes.iter_mut().skip(at % room.max(1)).zip(&edit[4..12]).for_each(|(byte, new)| *byte = *new);
            }
        }
    }
    // The sum is that of the edited values: one that is wrong ends it before any of them is read.
    let mut sum = Sha256::new();
    for (name, bytes) in entries.iter().filter(|(name, _)| name != "sha256") {
        sum.update((name.len() as u64).to_le_bytes());
        sum.update(name);
        sum.update((bytes.len() as u64).to_le_bytes());
        sum.update(bytes);
    }
    let digits: String = sum.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
    if let Some((_, told)) = entries.iter_mut().find(|(name, _)| name == "sha256") {
        *told = digits.into_bytes();
    }
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    for (name, bytes) in &entries {
        writer.start_file(name.as_str(), options).expect("an entry");
        writer.write_all(bytes).expect("its bytes");
    }
    writer.finish().expect("a ZIP file").into_inner()
}

fuzz_target!(
    init: {
        seed("whole", &[&[0], RUN.2.as_slice()].concat()).expect("a seed");
        for k in 0..RUN.3.len() as u16 {
            let edit = [&[1], k.to_le_bytes().as_slice(), &[3, 0], &[0xff; 8]].concat();
            seed(&format!("edit-{k}"), &edit).expect("a seed");
        }
    },
    |data: &[u8]| {
        let Some((&choice, rest)) = data.split_first() else { return };
        let (run, name, ..) = &*RUN;
        for entry in fs::read_dir(run).expect("the folder").flatten() {
            if entry.file_name().to_string_lossy().starts_with("checkpoint-") {
                let _ = fs::remove_file(entry.path());
            }
        }
        fs::write(run.join("deck.toml"), RUN.3.iter().find(|(name, _)| name == "deck.toml").map_or(&[][..], |e| &e.1)).expect("a file");
        fs::write(run.join(name), if choice == 0 { rest.to_vec() } else { edited(rest) }).expect("a file");
        let options = ResumeOptions {
            by_force: false,
            overrides: vec![("time.max-steps".to_owned(), "3".to_owned())],
            most_particles: MOST_PARTICLES,
            threads: Some(1),
            checkpoints: CheckpointPlan::default(),
            engines: vec![Arc::new(Cpu)],
        };
        if let Err(error) = resume(run, &options, &AtomicBool::new(false), &mut Silent) {
            show(error);
        }
    }
);
