//! A model of what a step costs on many ranks: not measured, a sum of terms from counted messages and assumed machines.
//!
//!     cargo run --release -p sphorge-mpi --example scaling
//!
//! Prints tables of strong and weak scaling of the default method in three dimensions; docs/cluster.md says what is assumed.

/// Particle steps of a rank a second: 32 threads.
const RATE: f64 = 1e7;
/// An exchange, s, and bytes a second of a rank.
const LATENCY: f64 = 2e-6;
const BANDWIDTH: f64 = 1e10;
/// Exchanges of a step: so many, and so many for each doubling of the ranks.
const EXCHANGES: (f64, f64) = (4.6, 10.5);
/// Reach of a kernel in spacings, and bytes that a ghost takes over in a step.
const REACH: f64 = 2.4;
const GHOST_BYTES: f64 = 400.0;
/// Ghosts of a rank in the common order over those of a cube of as many particles.
const NOT_A_CUBE: f64 = 1.5;
/// Bytes of a block of 128 particles that all ranks are sent in a step.
const BLOCK_BYTES: f64 = 96.0;
/// Steps from one search for contact to the next, bytes of every particle that it sends to all ranks, and seconds that each rank takes for every particle
/// of all, to sort it into cells.
const SEARCH_INTERVAL: f64 = 100.0;
const SEARCH_BYTES: f64 = 53.0;
const SEARCH_SECONDS: f64 = 2e-8;
/// Bytes of every particle of all that each rank holds while it searches, of each of its own, and of its machine.
const BYTES_OF_ALL: f64 = 100.0;
const BYTES_OF_OWN: f64 = 2400.0;
const MEMORY: f64 = 256e9;

/// Seconds of a step.
struct Cost {
    compute: f64,
    exchanges: f64,
    ghosts: f64,
    block_sums: f64,
    search: f64,
}

impl Cost {
    fn of(particles: f64, ranks: f64) -> Self {
        let own = particles / ranks;
        let others = if ranks > 1.0 { 1.0 } else { 0.0 };
        let cube = (own.cbrt() + 2.0 * REACH).powi(3) - own;
        let ghosts = (NOT_A_CUBE * cube).min(particles - own);
        Self {
            compute: own / RATE,
            exchanges: others * (EXCHANGES.0 + EXCHANGES.1 * ranks.log2()) * LATENCY,
            ghosts: ghosts * GHOST_BYTES / BANDWIDTH,
            block_sums: others * particles / 128.0 * BLOCK_BYTES / BANDWIDTH,
            search: particles * (SEARCH_SECONDS + others * SEARCH_BYTES / BANDWIDTH) / SEARCH_INTERVAL,
        }
    }

    fn all(&self) -> f64 {
        self.compute + self.exchanges + self.ghosts + self.block_sums + self.search
    }
}

/// Ranks that are asked for.
const RANKS: [f64; 7] = [1.0, 4.0, 16.0, 64.0, 256.0, 1024.0, 4096.0];

fn row(particles: f64, ranks: f64, efficiency: f64) {
    let Cost { compute, exchanges, ghosts, block_sums, search } = Cost::of(particles, ranks);
    let all = Cost::of(particles, ranks).all();
    let ms = |seconds: f64| format!("{:.2}", 1000.0 * seconds);
    let memory = (particles * BYTES_OF_ALL + particles / ranks * BYTES_OF_OWN) / 1e9;
    let fits = if memory > MEMORY / 1e9 { ", too much" } else { "" };
    println!(
        "| {ranks} | {particles:.0} | {} | {} | {} | {} | {} | {} | {efficiency:.2} | {memory:.1}{fits} |",
        ms(compute),
        ms(exchanges),
        ms(ghosts),
        ms(block_sums),
        ms(search),
        ms(all)
    );
}

fn main() {
    let head = "| ranks | particles | compute, ms | exchanges, ms | ghosts, ms | block sums, ms | contact search, ms | step, ms | efficiency | GB of a rank |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |";
    println!(
        "Strong scaling: the same particles on more ranks; efficiency is that of one rank, were it large enough.\n\n{head}"
    );
    for particles in [1e6, 1e7, 1e8, 1e9] {
        // A rank has a thousand particles at least.
        for ranks in RANKS.into_iter().filter(|ranks| particles / ranks >= 1000.0) {
            row(particles, ranks, Cost::of(particles, 1.0).all() / ranks / Cost::of(particles, ranks).all());
        }
    }
    println!("\nWeak scaling: as many particles on each rank.\n\n{head}");
    for own in [25_000.0, 250_000.0] {
        for ranks in RANKS {
            row(own * ranks, ranks, Cost::of(own, 1.0).all() / Cost::of(own * ranks, ranks).all());
        }
    }
}
