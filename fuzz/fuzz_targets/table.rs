//! A CSV file of particles: the first byte chooses dimensions and units.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sphorge::deck::load;
use sphorge_fuzz::{MOST_PARTICLES, folder, show_of_deck};
use std::{fs, path::PathBuf, sync::LazyLock};

static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| folder("table"));

fuzz_target!(|data: &[u8]| {
    let Some((&choice, rows)) = data.split_first() else { return };
    let dimensions = ["1d", "plane-strain", "3d"][usize::from(choice % 3)];
    let units = ["", ", length-unit = \"mm\"", ", mass-unit = \"g\"", ", volume-unit = \"\u{b5}m\""]
        [usize::from(choice / 3 % 4)];
    let deck = format!(
        "dimensions = \"{dimensions}\"\nparticles = {{ spacing = \"1 mm\" }}\ntime = {{ end = \"1 us\" }}\n\
         [[body]]\nname = \"a\"\nmaterial = \"ofhc-copper\"\nshape = {{ table = {{ file = \"rows.csv\"{units} }} }}\n"
    );
    let path = FOLDER.join("deck.toml");
    fs::write(FOLDER.join("rows.csv"), rows).expect("a file");
    fs::write(&path, deck).expect("a file");
    if let Err(report) = load(&path, &[], MOST_PARTICLES) {
        show_of_deck(report);
    }
});
