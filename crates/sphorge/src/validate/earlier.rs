//! What a validation that was stopped left behind, for one that goes on with it.

use super::{ValidateError, runs::Finished};
use crate::{
    deck::Setup,
    output::{HistoryTable, RunDirectory, Status, Summary, most, read_regular_file},
};
use std::{
    env, fs,
    io::{self, Read},
    path::Path,
};

/// What the program that is running is, to the byte: numbers of two programs do not belong in one report. `None` where it cannot be read.
pub(super) fn program() -> Option<String> {
    read_program().ok()
}

fn read_program() -> io::Result<String> {
    let mut file = fs::File::open(env::current_exe()?)?;
    let mut sum = crc32fast::Hasher::new();
    let mut length = 0;
    let mut buffer = vec![0; 1 << 20];
    loop {
        match file.read(&mut buffer)? {
            0 => break,
            count => {
                sum.update(&buffer[..count]);
                length += count;
            }
        }
    }
    Ok(format!("version {}, {length} bytes, CRC-32 {:08x}", env!("CARGO_PKG_VERSION"), sum.finalize()))
}

/// What the run in a folder left, if it is the one asked for and reached its end. One that failed goes on from its checkpoint: the disk may have
/// been full, and what is wrong with the run itself shows again.
pub(super) fn finished(folder: &Path, setup: &Setup) -> Option<Finished> {
    let directory = RunDirectory::open(folder).ok().filter(|_| is_of(folder, setup))?;
    let summary = Summary::read(&directory).ok()?;
    if !matches!(summary.status, Status::Completed | Status::CompletedWithWarnings) {
        return None;
    }
    Some(Finished { summary, history: HistoryTable::read(&directory).ok()? })
}

/// Whether the folder holds a run of this deck.
pub(super) fn is_of(folder: &Path, setup: &Setup) -> bool {
    RunDirectory::open(folder).is_ok_and(|directory| {
        read_regular_file(&directory.deck(), most::DECK).is_ok_and(|text| text == setup.deck_text.as_bytes())
    })
}

/// Refuses to go on with what another program left, of which `mark` tells.
pub(super) fn check_program(mark: &Path) -> Result<(), ValidateError> {
    let left = read_regular_file(mark, most::TEXT).unwrap_or_default();
    match program() {
        Some(own) if String::from_utf8_lossy(&left).lines().any(|line| line == own) => Ok(()),
        _ => Err(ValidateError::AnotherProgram { path: mark.parent().unwrap_or(mark).to_owned() }),
    }
}
