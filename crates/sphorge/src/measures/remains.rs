//! What is left of a plate: the particles that still hang together with a large fragment of it.

use crate::{model::Model, particles::Particles};

/// A fragment of less than this share of the body's mass is debris.
const LARGE: f64 = 0.1;

/// Sets that grow together; the least member stands for a set.
struct Sets {
    parent: Vec<u32>,
}

impl Sets {
    fn root(&mut self, mut i: u32) -> u32 {
        while self.parent[i as usize] != i {
            let above = self.parent[self.parent[i as usize] as usize];
            self.parent[i as usize] = above;
            i = above;
        }
        i
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }
}

/// What of some particles hangs together over distances up to `link`, m: the particles, and of each who stands for what it hangs together with.
pub(super) fn hanging_together(
    model: &Model,
    particles: &Particles,
    link: f64,
    is_part: impl Fn(usize) -> bool,
) -> Vec<(usize, usize)> {
    let count = model.dimensions.count();
    let cell = |p: &[f64; 3]| -> [i64; 3] {
        std::array::from_fn(|a| if a < count { (p[a] / link).floor() as i64 } else { 0 })
    };
    let mut sorted: Vec<([i64; 3], u32)> =
        (0..particles.len()).filter(|&i| is_part(i)).map(|i| (cell(&particles.position[i]), i as u32)).collect();
    sorted.sort_unstable();
    let mut sets = Sets { parent: (0..particles.len() as u32).collect() };
    // Rows of cells along the last axis are runs of the list: of every row beside or after its own, those within reach.
    let last = count - 1;
    for (place, &(home, i)) in sorted.iter().enumerate() {
        for step in 0..3usize.pow(last as u32) {
            let mut row = home;
            for (a, cell) in row.iter_mut().enumerate().take(last) {
                *cell = cell.saturating_add((step / 3usize.pow(a as u32) % 3) as i64 - 1);
            }
            if row[..last] < home[..last] {
                continue;
            }
            let (mut low, mut high) = (row, row);
            low[last] = home[last].saturating_sub(1);
            high[last] = home[last].saturating_add(1);
            let start = if row == home { place + 1 } else { sorted.partition_point(|(c, _)| *c < low) };
            for &(_, j) in sorted[start..].iter().take_while(|(c, _)| *c <= high) {
                let (x, y) = (particles.position[i as usize], particles.position[j as usize]);
                let squared: f64 = (0..count).map(|a| (x[a] - y[a]).powi(2)).sum();
                if squared <= link * link {
                    sets.join(i, j);
                }
            }
        }
    }
    sorted.into_iter().map(|(_, i)| (i as usize, sets.root(i) as usize)).collect()
}

/// For every particle, whether it belongs to what is left of `body`: to a fragment, joined over distances up to `link` (m), of at
/// least a tenth of the body's mass, some of which is `in_place`. A plug that flies off whole is not.
pub(super) fn remains(
    model: &Model,
    particles: &Particles,
    body: usize,
    link: f64,
    in_place: impl Fn(&[f64; 3]) -> bool,
) -> Vec<bool> {
    let joined = hanging_together(model, particles, link, |i| particles.body[i] as usize == body);
    let mut mass = vec![0.0; particles.len()];
    let mut stands = vec![false; particles.len()];
    let mut whole = 0.0;
    for &(i, root) in &joined {
        mass[root] += particles.mass[i];
        stands[root] |= in_place(&particles.position[i]);
        whole += particles.mass[i];
    }
    let mut left = vec![false; particles.len()];
    for (i, root) in joined {
        left[i] = stands[root] && mass[root] >= LARGE * whole;
    }
    left
}
