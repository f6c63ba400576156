//! Prescribed motion of particles along single axes.

use crate::engine::columns::{Binder, Fields, Group, Reading};
use crate::engine::step_numbers::{MOTION_LENGTH, motions};
use crate::record::{Index, Indices, Recorded};
use sphorge_engine::model::Model;
use sphorge_physics::{Real, Vector};

/// A time within the step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum When {
    Middle,
    End,
}

/// The motions of a model, if it has any.
#[derive(Clone, Copy)]
pub(super) struct Motions {
    of_particles: Indices,
    step: Reading,
    first: u32,
}

/// The prescribed motion of a particle.
#[derive(Clone, Copy)]
pub(super) struct Prescribed {
    step: Reading,
    row: Index,
    motion: Index,
}

impl Motions {
    pub(super) fn of(bind: &mut Binder<'_>, model: &Model, step: Reading) -> Option<Self> {
        let is_any = !model.motions.is_empty();
        is_any.then(|| Self { of_particles: bind.indices(Group::Motion), step, first: motions(model) })
    }

    pub(super) fn of_particle(self, i: Index) -> Prescribed {
        let motion = self.of_particles.at(i);
        Prescribed { step: self.step, row: Index::of(self.first) + motion * Index::of(MOTION_LENGTH), motion }
    }
}

impl Prescribed {
    fn number(self, k: usize) -> Recorded {
        self.step.get(0, self.row + Index::of(k as u32))
    }

    /// The first value if axis `a` is prescribed, the other if it is free.
    pub(super) fn choose(self, a: usize, prescribed: Recorded, free: Recorded) -> Recorded {
        Recorded::select_lt(Recorded::zero(), self.number(a), prescribed, free)
    }

    /// Velocity prescribed along axis `a`, m/s.
    pub(super) fn velocity(self, a: usize, when: When) -> Recorded {
        self.number(a + if when == When::Middle { 3 } else { 6 })
    }

    /// Zero along prescribed axes.
    pub(super) fn free(self, vector: Vector<Recorded>) -> Vector<Recorded> {
        [0, 1, 2].map(|a| self.choose(a, Recorded::zero(), vector[a]))
    }

    /// Zero if the particle has a prescribed motion.
    pub(super) fn undriven(self, vector: Vector<Recorded>) -> Vector<Recorded> {
        vector.map(|c| Recorded::select_lt(Recorded::zero(), self.motion.number(), Recorded::zero(), c))
    }
}
