//! Pairs across a section: the force of particles ahead of its plane on those behind it.

use super::images::Image;
use crate::engine::columns::{Binder, CompensatedVector, Group, Read, VectorColumns, Write, WriteColumns, groups};
use crate::record::{Index, Indices, Recorded};
use sphorge_engine::model::{Model, Section};
use sphorge_physics::section::{counted_by_row, share_through};
use sphorge_physics::{Elementary, Numbers, Real, Vector};

/// A section with its index in the model, if a sum is only over the pairs that cross it.
#[derive(Clone, Copy, Debug)]
pub(in crate::engine) struct Through<'a> {
    pub(in crate::engine) number: usize,
    pub(in crate::engine) section: &'a Section,
}

impl Through<'_> {
    /// A kernel of that sum.
    pub(super) fn name(of: Option<Self>, name: &str) -> String {
        of.map_or_else(|| name.to_owned(), |through| format!("{name}_through_section_{}", through.number))
    }
}

/// Sides of the plane on which particles are.
#[derive(Clone, Copy)]
pub(super) struct Crossing<'a> {
    section: &'a Section,
    place: CompensatedVector<Read>,
    bodies: Option<Indices>,
    /// m.
    spacing: f64,
    /// Distance of the particle ahead of the plane, m.
    ahead: Recorded,
    i: Index,
    sums: VectorColumns<Write>,
}

impl<'a> Crossing<'a> {
    /// For a particle, whose position is bound.
    pub(super) fn of(
        bind: &mut Binder<'_>,
        model: &Model,
        through: Through<'a>,
        i: Index,
        place: CompensatedVector<Read>,
    ) -> Self {
        let section = through.section;
        let bodies = section.body.map(|_| bind.indices(Group::Body));
        let sums = groups::Section::write_of(bind, Group::Section(through.number)).force;
        let spacing = model.spacing;
        let mut crossing = Self { section, place, bodies, spacing, ahead: Recorded::zero(), i, sums };
        crossing.ahead = crossing.ahead_of(None, i);
        crossing
    }

    /// Distance of a particle, or of an image of it, ahead of the plane, m.
    fn ahead_of(&self, image: Option<&Image>, of: Index) -> Recorded {
        let at = self.place.get(of);
        let mut ahead = Recorded::zero();
        for axis in (0..3).filter(|axis| self.section.normal[*axis] != 0.0) {
            let offset = Image::offset(image, axis, self.section.point[axis], at[axis]);
            ahead += Recorded::of(self.section.normal[axis]) * offset;
        }
        ahead
    }

    /// Share of the force of `j` through the plane, seen from behind.
    fn share(&self, image: &Image, j: Index) -> Recorded {
        let other = self.ahead_of(Some(image), j);
        let counted = counted_by_row(other - self.ahead_of(None, j), Recorded::of(self.spacing));
        let share = share_through(self.ahead, other, counted);
        let Some((bodies, body)) = self.bodies.zip(self.section.body) else { return share };
        let strange = |of: Index| (bodies.at(of).number() - Recorded::of(body as f64)).abs();
        Recorded::select_lt(strange(self.i).max(strange(j)), Recorded::of(0.5), share, Recorded::zero())
    }

    /// Adds the contribution of a pair to a sum whose first three numbers are a force, times its share, if it crosses
    /// the plane.
    pub(super) fn add<S: Numbers<Recorded>>(
        &self,
        state: Vector<Recorded>,
        image: &Image,
        j: Index,
        pair: impl FnOnce() -> S,
        force: impl FnOnce(&S) -> Vector<Recorded>,
    ) -> Vector<Recorded> {
        let share = self.share(image, j);
        let add = || {
            let force = force(&pair());
            [0, 1, 2].map(|a| state[a] + share * force[a])
        };
        Recorded::if_lt(Recorded::zero(), share.abs(), add, || state)
    }

    /// Sets the sum of the particle to this value, N, or adds it.
    pub(super) fn set(&self, force: Vector<Recorded>, adds: bool) {
        for (a, force) in force.into_iter().enumerate() {
            let before = if adds { self.sums.axis(a).get(self.i) } else { Recorded::zero() };
            self.sums.axis(a).set(self.i, before + force);
        }
    }
}
