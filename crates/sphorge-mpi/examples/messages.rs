//! Counts what ranks send in a step, on threads that stand for them: messages and bytes do not depend on the machine, times would.
//!
//!     cargo run --release -p sphorge-mpi --example messages -- copper-bar particles.spacing='"0.25 mm"'
//!
//! Prints, for each number of ranks, per step: exchanges a rank takes part in, messages and bytes that the rank that sends most of them sends, and
//! of the last step, the imbalance and the share of the rows that read no ghost.

use sphorge::engine::{EngineKind, Simulation};
use sphorge::run::FilesOfRank;
use sphorge_engine::ranks::{Communicator, Messages};
use sphorge_mpi::{Leader, follow, threads};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::{env, thread};

/// Ranks that are tried.
const RANKS: [usize; 6] = [2, 4, 8, 16, 32, 64];
/// Steps that are counted.
const STEPS: u64 = 100;

/// What a rank has sent.
#[derive(Debug, Default)]
struct Sent {
    exchanges: AtomicU64,
    messages: AtomicU64,
    bytes: AtomicU64,
}

impl Sent {
    fn read(&self) -> [u64; 3] {
        [&self.exchanges, &self.messages, &self.bytes].map(|count| count.load(Ordering::Relaxed))
    }
}

/// A communicator that counts.
#[derive(Debug)]
struct Counting {
    inner: Arc<dyn Communicator>,
    sent: Arc<Vec<Sent>>,
}

impl Communicator for Counting {
    fn rank(&self) -> usize {
        self.inner.rank()
    }

    fn size(&self) -> usize {
        self.inner.size()
    }

    fn begin(&self, to: Vec<Vec<u8>>, lengths: &[usize]) -> Result<Box<dyn Messages>, String> {
        let sent = &self.sent[self.rank()];
        let messages = to.iter().enumerate().filter(|(rank, bytes)| *rank != self.rank() && !bytes.is_empty());
        let (count, bytes) = messages.fold((0, 0), |sums, (_, bytes)| (sums.0 + 1, sums.1 + bytes.len() as u64));
        sent.exchanges.fetch_add(1, Ordering::Relaxed);
        sent.messages.fetch_add(count, Ordering::Relaxed);
        sent.bytes.fetch_add(bytes, Ordering::Relaxed);
        self.inner.begin(to, lengths)
    }
}

/// What each of so many ranks sends in the steps that are counted, after the first two, how unlike the shares are and which share of the rows is inner.
fn count(name: &str, deck: &str, ranks: usize) -> (Vec<[u64; 3]>, [f64; 2]) {
    let sent: Arc<Vec<Sent>> = Arc::new((0..ranks).map(|_| Sent::default()).collect());
    let counting = |inner| Arc::new(Counting { inner, sent: sent.clone() }) as Arc<dyn Communicator>;
    let mut communicators: Vec<_> = threads(ranks).into_iter().map(counting).collect();
    thread::scope(|scope| {
        for communicator in communicators.split_off(1) {
            scope.spawn(move || follow(communicator, Some(1), &FilesOfRank::new(1e9)));
        }
        let leader = Leader::new(communicators.remove(0));
        let setup = sphorge::deck::load_text(name, deck, &[]).expect("it was loaded before");
        leader.take_deck(name, deck);
        let mut simulation = Simulation::start(&leader, setup.model, setup.particles).expect("ranks share it");
        let mut steps = |count| {
            for _ in 0..count {
                simulation.step(None).expect("a step");
            }
        };
        steps(2);
        let before: Vec<_> = sent.iter().map(Sent::read).collect();
        steps(STEPS);
        let after = sent.iter().map(Sent::read).zip(before);
        let of_steps = after.map(|(after, before)| [0, 1, 2].map(|k| after[k] - before[k])).collect();
        (of_steps, [simulation.imbalance(), simulation.inner_share()])
    })
}

fn main() {
    let mut arguments = env::args().skip(1);
    let name = arguments.next().unwrap_or_else(|| "copper-bar".to_owned());
    let changes: Vec<(String, String)> =
        arguments.filter_map(|change| change.split_once('=').map(|(k, v)| (k.to_owned(), v.to_owned()))).collect();
    let shipped = sphorge::decks::find(&name).expect("the name of a shipped deck");
    let setup = sphorge::deck::load_text(&name, shipped.text, &changes).expect("changes that the deck can have");
    println!("{name}, {} particles, {STEPS} steps", setup.particles.len());
    println!("ranks  exchanges  messages     bytes  bytes, mean  imbalance  inner rows");
    for ranks in RANKS {
        let (sent, [imbalance, inner]) = count(&name, &setup.deck_text, ranks);
        let most = |k: usize| sent.iter().map(|sent| sent[k]).max().unwrap_or(0) as f64 / STEPS as f64;
        let mean = sent.iter().map(|sent| sent[2]).sum::<u64>() as f64 / (STEPS * ranks as u64) as f64;
        println!(
            "{ranks:5}  {:9.1}  {:8.1}  {:8.0}  {mean:11.0}  {imbalance:9.3}  {inner:10.3}",
            most(0),
            most(1),
            most(2)
        );
    }
}
