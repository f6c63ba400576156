//! Follows over a run how unlike the works of ranks are, on threads that stand for them: counted work does not depend on the machine.
//!
//!     cargo run --release -p sphorge-mpi --example imbalance -- bullet 4 particles.spacing='"24 mm"' body.1.spacing='"12 mm"'
//!
//! Prints the most work of a rank over the mean of all, in counted pairs, at every twentieth of the run.

use sphorge::engine::{EngineKind, Simulation};
use sphorge::run::FilesOfRank;
use sphorge_mpi::{Leader, follow, threads};
use std::{env, thread};

fn main() {
    let mut arguments = env::args().skip(1);
    let name = arguments.next().unwrap_or_else(|| "bullet".to_owned());
    let ranks = arguments.next().and_then(|ranks| ranks.parse().ok()).unwrap_or(4);
    let changes: Vec<(String, String)> =
        arguments.filter_map(|change| change.split_once('=').map(|(k, v)| (k.to_owned(), v.to_owned()))).collect();
    let shipped = sphorge::decks::find(&name).expect("the name of a shipped deck");
    let setup = sphorge::deck::load_text(&name, shipped.text, &changes).expect("changes that the deck can have");
    let end = setup.model.time.end;
    println!("{name}, {} particles, {ranks} ranks", setup.particles.len());
    let mut communicators = threads(ranks);
    thread::scope(|scope| {
        for communicator in communicators.split_off(1) {
            scope.spawn(move || follow(communicator, Some(1), &FilesOfRank::new(1e9)));
        }
        let leader = Leader::new(communicators.remove(0));
        leader.take_deck(&name, &setup.deck_text);
        let mut simulation = Simulation::start(&leader, setup.model, setup.particles).expect("ranks share it");
        let (mut worst, mut sum, mut told) = (1.0f64, 0.0, 0);
        while simulation.time() < end {
            simulation.step(Some(end)).expect("a step");
            worst = worst.max(simulation.imbalance());
            sum += simulation.imbalance();
            let part = (20.0 * simulation.time() / end) as u32;
            if part > told {
                told = part;
                println!("{:3} %  step {:6}  {:.3}", 5 * part, simulation.steps(), simulation.imbalance());
            }
        }
        println!("mean {:.3}, most {worst:.3}", sum / simulation.steps() as f64);
    });
}
