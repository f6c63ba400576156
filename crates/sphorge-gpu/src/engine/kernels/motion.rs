//! Prescribed motion of particles along single axes.

use crate::engine::columns::{Binder, Group, Handles, Shared, SharedFrom, groups};
use crate::engine::step_numbers::motions;
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
    step: groups::Step<Shared>,
    first: usize,
}

/// The prescribed motion of a particle.
#[derive(Clone, Copy)]
pub(super) struct Prescribed {
    numbers: groups::MotionOfStep<SharedFrom>,
    motion: Index,
}

impl Motions {
    pub(super) fn of(bind: &mut Binder<'_>, model: &Model, step: groups::Step<Shared>) -> Option<Self> {
        let is_any = !model.motions.is_empty();
        is_any.then(|| Self { of_particles: bind.indices(Group::Motion), step, first: motions(model) })
    }

    pub(super) fn of_particle(self, i: Index) -> Prescribed {
        let motion = self.of_particles.at(i);
        let length = <groups::MotionOfStep<SharedFrom> as Handles<SharedFrom>>::LENGTH;
        let first = Index::of(self.first as u32) + motion * Index::of(length as u32);
        Prescribed { numbers: groups::MotionOfStep::at(self.step.source().from(first), 0), motion }
    }
}

impl Prescribed {
    /// The first value if axis `a` is prescribed, the other if it is free.
    pub(super) fn choose(self, a: usize, prescribed: Recorded, free: Recorded) -> Recorded {
        Recorded::select_lt(Recorded::zero(), self.numbers.is_prescribed.axis(a).value(), prescribed, free)
    }

    /// Velocity prescribed along axis `a`, m/s.
    pub(super) fn velocity(self, a: usize, when: When) -> Recorded {
        match when {
            When::Middle => self.numbers.middle.axis(a).value(),
            When::End => self.numbers.end.axis(a).value(),
        }
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
