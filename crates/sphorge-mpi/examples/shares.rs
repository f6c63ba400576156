//! Counts the ghosts that ranks have by how particles are shared: in the common order, in cell order, along a Hilbert curve, and by recursive bisection.
//!
//!     cargo run --release -p sphorge-mpi --example shares -- 8 64 512
//!
//! Prints, of a cube of 262 144 particles and of the shipped deck `bullet`, ghosts for each particle: the mean of all ranks, and of the rank with most.

use sphorge_engine::neighbors::{CellGrid, hilbert_order};
use std::env;

type Point = [f64; 3];

/// Particles are shared in blocks of so many.
const BLOCK: usize = 128;

/// The part that has each point, where parts have as many whole blocks as each other, one behind the other in an order.
fn in_order(order: &[u32], parts: usize) -> Vec<usize> {
    let blocks = order.len().div_ceil(BLOCK);
    let mut owner = vec![0; order.len()];
    for (k, &i) in order.iter().enumerate() {
        owner[i as usize] = (k / BLOCK * parts) / blocks;
    }
    owner
}

/// Halves the points across the longest side of the box they fill, and the halves again, until there are so many parts, a power of two.
fn bisect(points: &[Point], indices: &mut [u32], first: usize, parts: usize, owner: &mut [usize]) {
    if parts == 1 {
        indices.iter().for_each(|&i| owner[i as usize] = first);
        return;
    }
    let side = |a: usize| {
        let of_axis = indices.iter().map(|&i| points[i as usize][a]);
        of_axis.clone().fold(f64::MIN, f64::max) - of_axis.fold(f64::MAX, f64::min)
    };
    let axis = (0..3).max_by(|&a, &b| side(a).total_cmp(&side(b))).unwrap_or(0);
    let half = indices.len() / 2;
    indices.select_nth_unstable_by(half, |&i, &j| points[i as usize][axis].total_cmp(&points[j as usize][axis]));
    let (low, high) = indices.split_at_mut(half);
    bisect(points, low, first, parts / 2, owner);
    bisect(points, high, first + parts / 2, parts / 2, owner);
}

/// Ghosts for each particle: in the mean, and of the part with most.
fn ghosts(points: &[Point], grid: &CellGrid, reach: f64, owner: &[usize], parts: usize) -> (f64, f64) {
    let (mut counts, mut own) = (vec![0usize; parts], vec![0usize; parts]);
    let mut readers = Vec::new();
    for (i, p) in points.iter().enumerate() {
        readers.clear();
        for (first, last) in grid.runs_around(p) {
            for &j in &grid.order()[first..last] {
                let q = &points[j as usize];
                let is_near = (0..3).map(|a| (p[a] - q[a]).powi(2)).sum::<f64>() < reach * reach;
                let reader = owner[j as usize];
                if is_near && reader != owner[i] && !readers.contains(&reader) {
                    readers.push(reader);
                }
            }
        }
        own[owner[i]] += 1;
        readers.iter().for_each(|&reader| counts[reader] += 1);
    }
    let mean = counts.iter().sum::<usize>() as f64 / points.len() as f64;
    let most = counts.iter().zip(&own).map(|(&count, &own)| count as f64 / own as f64).fold(0.0, f64::max);
    (mean, most)
}

fn compare(name: &str, points: &[Point], reach: f64, parts: &[usize]) {
    let mut grid = CellGrid::default();
    grid.sort(points, 1.1 * reach);
    println!(
        "{name}: {} particles\n\n| order | ranks | ghosts a particle, mean | most |\n| --- | --- | --- | --- |",
        points.len()
    );
    for &parts in parts {
        let mut bisected = vec![0; points.len()];
        bisect(points, &mut (0..points.len() as u32).collect::<Vec<_>>(), 0, parts, &mut bisected);
        let kinds = [
            ("cells", in_order(grid.order(), parts)),
            ("tiles", in_order(grid.tiled_order(), parts)),
            ("Hilbert", in_order(&hilbert_order(points, 1.1 * reach, 3), parts)),
            ("bisection", bisected),
        ];
        for (kind, owner) in kinds {
            let (mean, most) = ghosts(points, &grid, reach, &owner, parts);
            println!("| {kind} | {parts} | {mean:.2} | {most:.2} |");
        }
    }
    println!();
}

fn main() {
    let mut parts: Vec<usize> = env::args().skip(1).filter_map(|parts| parts.parse().ok()).collect();
    if parts.is_empty() {
        parts = vec![8, 64, 512];
    }
    assert!(
        parts.iter().all(|parts| parts.is_power_of_two() && *parts <= 1024),
        "numbers of ranks are powers of two up to 1024"
    );
    let cube: Vec<Point> = (0..1 << 18).map(|k: u32| [k >> 12, k >> 6 & 63, k & 63].map(f64::from)).collect();
    compare("cube", &cube, 2.4, &parts);
    let shipped = sphorge::decks::find("bullet").expect("a shipped deck");
    let setup = sphorge::deck::load_text("bullet", shipped.text, &[]).expect("a deck that is right");
    let largest = setup.particles.smoothing_length.iter().copied().fold(0.0, f64::max);
    compare("bullet", &setup.particles.position, setup.model.numerics.kernel.support() * largest, &parts);
}
