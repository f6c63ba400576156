//! Speed of a front; the definition is in [`super`].

use super::selection::{Quantity, SelectedParticles};

/// Position of a front over time.
#[derive(Clone, Debug)]
pub(super) struct FrontSpeed {
    level: f64,
    /// +1 or -1.
    direction: f64,
    window: (f64, f64),
    /// Whether the material ahead is above the level.
    ahead_is_above: Option<bool>,
    has_left: bool,
    samples: Vec<(f64, f64)>,
}

/// Mean position and field of the particles in a slab.
#[derive(Clone, Copy, Default)]
struct Slab {
    count: f64,
    x: f64,
    f: f64,
}

impl FrontSpeed {
    pub(super) fn new(level: f64, direction: f64, window: (f64, f64)) -> Self {
        Self {
            level,
            direction: direction.signum(),
            window,
            ahead_is_above: None,
            has_left: false,
            samples: Vec::new(),
        }
    }

    pub(super) fn sample(&mut self, time: f64, selection: &SelectedParticles, quantity: &Quantity, axis: usize) {
        let slabs = self.slabs(selection, quantity, axis);
        let Some(end) = slabs.last() else { return };
        let above = |slab: &Slab| slab.f >= self.level;
        let ahead = *self.ahead_is_above.get_or_insert(above(end));
        self.has_left |= above(end) != ahead;
        if self.has_left || !(self.window.0..=self.window.1).contains(&time) {
            return;
        }
        let crossing = slabs.windows(2).rev().find(|pair| above(&pair[0]) != ahead);
        if let Some([behind, before]) = crossing {
            let share = (self.level - behind.f) / (before.f - behind.f);
            self.samples.push((time, behind.x + share * (before.x - behind.x)));
        }
    }

    /// Slabs in the order of the front's path.
    fn slabs(&self, selection: &SelectedParticles, quantity: &Quantity, axis: usize) -> Vec<Slab> {
        let x = |i: usize| self.direction * selection.particles.position[i][axis];
        let Some((low, high)) = selection.indices().map(|i| (x(i), x(i))).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
        else {
            return Vec::new();
        };
        // Particles of a lattice fall in the middle of a slab. A flung-off particle must not ask for endless slabs.
        let width = selection.model.spacing.max((high - low) / 1e6);
        let mut slabs = vec![Slab::default(); ((high - low) / width + 0.5) as usize + 1];
        for i in selection.indices() {
            let slab = &mut slabs[((x(i) - low) / width + 0.5) as usize];
            slab.count += 1.0;
            slab.x += x(i);
            slab.f += quantity.of(i);
        }
        slabs.retain(|slab| slab.count > 0.0);
        for slab in &mut slabs {
            slab.x /= slab.count;
            slab.f /= slab.count;
        }
        slabs
    }

    /// Slope of the least-squares line.
    pub(super) fn speed(&self) -> Option<f64> {
        let n = self.samples.len() as f64;
        let mean = |pick: fn(&(f64, f64)) -> f64| self.samples.iter().map(pick).sum::<f64>() / n;
        let (t_mean, x_mean) = (mean(|s| s.0), mean(|s| s.1));
        let (tx, tt) = self
            .samples
            .iter()
            .fold((0.0, 0.0), |(tx, tt), (t, x)| (tx + (t - t_mean) * (x - x_mean), tt + (t - t_mean).powi(2)));
        (tt > 0.0).then(|| tx / tt)
    }
}
