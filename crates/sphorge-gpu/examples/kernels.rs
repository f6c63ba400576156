//! Writes the kernels of the step of shipped decks to a folder, in WGSL and CUDA C++: `cargo run -p sphorge-gpu --features device --example kernels -- FOLDER`.

use sphorge_deck::{decks, load_text};
use std::{error::Error, fs, path::PathBuf};

/// Decks with all there is, and what to change in them.
const DECKS: [(&str, &[(&str, &str)]); 22] = [
    ("taylor-plate", &[("numerics.viscosity.balsara", "true")]),
    ("taylor-bar", &[("method", "\"patino\""), ("particles.spacing", "\"1.2 mm\"")]),
    ("iron-plate", &[("search.total-lagrangian.renewal", "1.5")]),
    ("iron-plate", &[("search.total-lagrangian.faces", "\"quadratic\""), ("search.total-lagrangian.renewal", "1.5")]),
    ("copper-bar", &[("search.total-lagrangian.faces", "\"quadratic\"")]),
    ("plate-impact", &[("method", "\"patino\""), ("numerics.gradient-correction", "\"none\"")]),
    ("oscillating-plate", &[]),
    ("high-shear", &[]),
    ("tensile", &[]),
    ("rubber-rings", &[]),
    ("bullet", &[("search", "\"every-step\""), ("contact", "\"penalty\""), ("particles.spacing", "\"15 mm\"")]),
    ("bullet", &[("search", "\"adaptive\""), ("particles.spacing", "\"15 mm\""), ("audit", "100")]),
    ("penetration", &[("particles.spacing", "\"0.8 mm\"")]),
    ("taylor-bar-42crmo4", &[("particles.spacing", "\"0.8 mm\"")]),
    ("convecting-block", &[]),
    ("pulled", &[]),
    ("elastic-bar", &[("numerics.precision", "\"mixed\""), ("search", "\"skin\"")]),
    ("bullet", &[("search", "{ adaptive = { guard = \"none\" } }"), ("particles.spacing", "\"15 mm\"")]),
    (
        "bullet",
        &[
            ("search", "\"adaptive\""),
            ("contact", "\"penalty\""),
            ("particles.spacing", "\"15 mm\""),
            ("periodic", "{ x = [\"-1 m\", \"1 m\"], y = [\"-1 m\", \"1 m\"], z = [\"-1 m\", \"1 m\"] }"),
        ],
    ),
    (
        "bullet",
        &[
            ("search", "\"skin\""),
            ("contact", "\"penalty\""),
            ("numerics.smoothing-length", "\"follow-density\""),
            ("particles.spacing", "\"15 mm\""),
        ],
    ),
    (
        "taylor-bar",
        &[
            ("method", "\"total-lagrangian\""),
            ("particles.spacing", "\"1.2 mm\""),
            ("audit", "100"),
            ("periodic", "{ x = [\"-9 mm\", \"9 mm\"], y = [\"-9 mm\", \"9 mm\"], z = [\"-9 mm\", \"90 mm\"] }"),
        ],
    ),
    (
        "taylor-bar-42crmo4",
        &[
            ("method", "\"patino\""),
            ("search", "{ adaptive = { guard = \"none\" } }"),
            ("numerics.mls-interval", "20"),
            ("particles.spacing", "\"0.8 mm\""),
        ],
    ),
];

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("name a folder")?);
    for (k, (name, overrides)) in DECKS.into_iter().enumerate() {
        let deck = decks::find(name).ok_or(name)?;
        let overrides: Vec<_> = overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        let setup = load_text(deck.name, deck.text, &overrides)?;
        let folder = folder.join(format!("{k}-{name}"));
        fs::create_dir_all(&folder)?;
        for kernel in sphorge_gpu::kernel_texts(&setup.model, &setup.particles)? {
            fs::write(folder.join(format!("{}.wgsl", kernel.name)), kernel.wgsl)?;
            fs::write(folder.join(format!("{}.cu", kernel.name)), kernel.cuda)?;
        }
    }
    Ok(())
}
