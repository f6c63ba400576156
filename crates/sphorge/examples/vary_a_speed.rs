//! A model made in the program, run at several speeds: how much shorter a copper bar gets as it strikes a wall.
//!
//!     cargo run --release --example vary_a_speed -- out/speeds

use sphorge::{
    compare::Comparison,
    deck::load_text,
    engine::ENGINES,
    run::{RunOptions, Silent, execute},
};
use std::{env, error::Error, path::PathBuf, sync::atomic::AtomicBool};

/// A bar of 8 mm by 24 mm that moves towards a wall; decks are text, so a parameter is a word in it.
fn bar(speed: f64) -> String {
    format!(
        r#"
        title = "Copper bar at {speed} m/s"
        dimensions = "plane-strain"
        particles = {{ spacing = "1 mm" }}
        time = {{ end = "30 us" }}
        output = {{ frames = 1 }}

        [[body]]
        name = "bar"
        material = "ofhc-copper"
        shape = {{ box = {{ min = ["-4 mm", "0 mm"], max = ["4 mm", "24 mm"] }} }}
        velocity = ["0 m/s", "-{speed} m/s"]

        [[wall]]
        name = "anvil"
        plane = {{ point = ["0 mm", "0 mm"], normal = [0, 1] }}

        [[measure]]
        name = "height"
        extent = {{ body = "bar", axis = "y" }}
        "#
    )
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(env::args().nth(1).ok_or("give a folder to write to")?);
    let mut runs = Vec::new();
    for speed in [50.0, 100.0, 150.0] {
        let mut setup = load_text("bar", &bar(speed), &[])?;
        // What the deck says has become a model in SI units, which can be changed as well.
        setup.model.time.courant = 0.2;
        let options = RunOptions { directory: folder.join(format!("{speed}")), ..RunOptions::default() };
        let summary = execute(setup, ENGINES[0], &options, &AtomicBool::new(false), &mut Silent)?;
        let height = summary.measures["height"].ok_or("the bar has no height")?;
        println!("{speed} m/s: {:.2} mm", 1e3 * height);
        runs.push(options.directory);
    }
    println!("{}", Comparison::read(&runs)?);
    Ok(())
}
