use super::super::brute_force;
use super::*;

/// A deterministic random cloud.
fn cloud(n: usize, seed: u64, dimensions: usize) -> Vec<Vector<f64>> {
    let mut s = seed;
    let mut random = || {
        s ^= s << 13;
        s ^= s >> 7;
        s ^= s << 17;
        (s >> 11) as f64 / (1u64 << 53) as f64
    };
    (0..n).map(|_| [0, 1, 2].map(|a| if a < dimensions { random() } else { 0.0 })).collect()
}

fn agrees_with_brute_force(instructions: Instructions, uneven: bool) {
    for (dimensions, h) in [(1, 0.01), (2, 0.05), (3, 0.08)] {
        let points = cloud(700, 88172645463325252 + dimensions as u64, dimensions);
        // Only the first 600 points are particles, the rest act as ghosts.
        let smoothing: Vec<f64> = (0..700).map(|i| if uneven && i % 3 == 0 { 1.5 * h } else { h }).collect();
        let reach = Reach::new(&smoothing, 2.0);
        let mut list = NeighborList::default();
        Searcher::default().search(&points, 600, &reach, DisplacementBound::default(), instructions, &mut list);
        list.blocks_mut().iter_mut().for_each(Block::sort_rows);
        let oracle = brute_force(&points, 600, &reach);
        assert!(oracle.pairs() > 600);
        for i in 0..600 {
            assert_eq!(list.row(i), oracle.row(i), "{instructions:?}, dimensions {dimensions}, particle {i}");
        }
    }
}

#[test]
fn cell_search_finds_what_brute_force_finds_on_every_path() {
    for instructions in Instructions::available() {
        for uneven in [false, true] {
            agrees_with_brute_force(instructions, uneven);
        }
    }
}

/// A cloud whose list was built before every seventh point moved, and the marks of those.
fn moved_cloud() -> (Vec<Vector<f64>>, Vec<Vector<f64>>, Vec<AtomicU8>) {
    let before = cloud(600, 362436069, 3);
    let mut after = before.clone();
    let marks: Vec<AtomicU8> = (0..600).map(|_| AtomicU8::new(mark::KEEP)).collect();
    for i in (0..600).step_by(7) {
        after[i] = [0, 1, 2].map(|a| 0.8 * before[i][(a + 1) % 3] + 0.1);
        marks[i].store(mark::REBUILD, Ordering::Relaxed);
    }
    (before, after, marks)
}

fn lost() -> DisplacementBound {
    let mut displacement = DisplacementBound::default();
    displacement.lose_track();
    displacement
}

/// A partial search of all points, which may have moved anywhere.
fn partial<'a>(points: &'a [Vector<f64>], reach: Reach<'a>, marks: &'a [AtomicU8]) -> PartialSearch<'a> {
    PartialSearch { points, sources: &[], rows: 0..points.len(), reach, displacement: lost(), marks }
}

fn rebuilt(marks: &[AtomicU8]) -> Vec<u32> {
    (0..marks.len() as u32).filter(|&i| marks[i as usize].load(Ordering::Relaxed) == mark::REBUILD).collect()
}

#[test]
fn a_partial_search_of_all_that_moved_is_a_full_search() {
    for instructions in Instructions::available() {
        let (before, after, marks) = moved_cloud();
        let smoothing = vec![0.07; 600];
        let reach = Reach::new(&smoothing, 2.0);
        let (mut searcher, mut list) = (Searcher::default(), NeighborList::default());
        searcher.search(&before, 600, &reach, DisplacementBound::default(), instructions, &mut list);
        searcher.rebuild_rows(&partial(&after, reach, &marks), instructions, &mut list, &rebuilt(&marks), false);
        list.blocks_mut().iter_mut().for_each(Block::sort_rows);
        let oracle = brute_force(&after, 600, &reach);
        for i in 0..600 {
            assert_eq!(list.row(i), oracle.row(i), "{instructions:?}, particle {i}");
        }
    }
}

#[test]
fn a_partial_search_of_some_stays_symmetric_and_a_one_sided_one_does_not() {
    let (before, after, marks) = moved_cloud();
    // Half of those that moved are not rebuilt.
    (0..600).step_by(14).for_each(|i| marks[i].store(mark::KEEP, Ordering::Relaxed));
    let smoothing = vec![0.07; 600];
    let reach = Reach::new(&smoothing, 2.0);
    for one_sided in [false, true] {
        let (mut searcher, mut list) = (Searcher::default(), NeighborList::default());
        searcher.search(&before, 600, &reach, DisplacementBound::default(), Instructions::best(), &mut list);
        let all = rebuilt(&marks);
        searcher.rebuild_rows(&partial(&after, reach, &marks), Instructions::best(), &mut list, &all, one_sided);
        let lonely = (0..600)
            .flat_map(|i| list.row(i).iter().map(move |&j| (i, j as usize)))
            .filter(|&(i, j)| !list.row(j).contains(&(i as u32)))
            .count();
        assert_eq!(lonely > 0, one_sided, "{lonely}");
    }
}

#[test]
fn rows_differ_in_what_only_one_has() {
    let between = |old: &[u32], new: &[u32]| {
        let mut found = Vec::new();
        differences(old, new, |j| found.push(j));
        found
    };
    assert!(between(&[], &[]).is_empty() && between(&[4, 2, 9], &[4, 2, 9]).is_empty());
    // A different order does not count.
    assert!(between(&[4, 2, 9, 7], &[4, 9, 2, 7]).is_empty());
    assert_eq!(between(&[4, 2, 9, 7], &[4, 9, 5, 7]), [2, 5]);
    assert_eq!(between(&[4, 2], &[4, 2, 7]), [7]);
    assert_eq!(between(&[1, 4], &[]), [1, 4]);
}

#[test]
fn coincident_points_are_neighbours_and_a_crowd_has_long_rows() {
    let points = vec![[0.5; 3]; 1500];
    let smoothing = vec![0.1; 1500];
    let reach = Reach::new(&smoothing, 2.0);
    let mut list = NeighborList::default();
    Searcher::default().search(&points, 1500, &reach, DisplacementBound::default(), Instructions::best(), &mut list);
    assert_eq!(list.row(7).len(), 1499);
    assert!(!list.row(7).contains(&7));
}

#[test]
fn points_are_put_in_the_order_of_their_cells() {
    // Every second one backwards through a row of cells.
    let points: Vec<Vector<f64>> =
        (0..40).map(|k| [f64::from(if k % 2 == 0 { k } else { 39 - k }), 0.0, 0.0]).collect();
    let mut searcher = Searcher::default();
    let order = searcher.tiled_order(&points, 0.5);
    let sorted: Vec<f64> = order.iter().map(|&i| points[i as usize][0]).collect();
    assert!(sorted.len() == 40 && sorted.is_sorted(), "{sorted:?}");
}
