//! Energy corrections of kicks, and the accounts of forces that are not pair forces.

use super::motion::{Motions, When};
use super::{contact, walls};
use crate::engine::columns::{Binder, Fields, Group, Reading, Writing, added};
use crate::record::{Index, Recorded};
use sphorge_engine::model::Model;
use sphorge_physics::Real;
use sphorge_physics::kick::{KickAccount, KickAxis};

/// Index of the work against the artificial stress, J, among the accounts of a particle.
pub(super) const ARTIFICIAL_WORK: usize = 12;

/// The columns of a kick.
#[derive(Clone, Copy)]
pub(super) struct Kicks {
    /// Acceleration and XSPH velocity of the last forces.
    pub(super) rates: Reading,
    pub(super) external: Reading,
    energy: Writing,
    accounts: Writing,
    walls: Option<(Writing, usize)>,
    meetings: Option<(Writing, usize)>,
    constants: Reading,
    pub(super) step: Reading,
    pub(super) motions: Option<Motions>,
}

impl Kicks {
    pub(super) fn of(bind: &mut Binder<'_>, model: &Model) -> Self {
        let count = model.walls.len();
        let step = bind.read(Group::Step);
        Self {
            motions: Motions::of(bind, model, step),
            step,
            rates: bind.read(Group::Rates),
            external: bind.read(Group::External),
            energy: bind.write(Group::Energy),
            accounts: bind.write(Group::Accounts),
            walls: (count > 0).then(|| (bind.write(Group::Walls), count)),
            meetings: model.has_contact().then(|| (bind.write(Group::Meetings), model.bodies.len())),
            constants: bind.read(Group::Constants),
        }
    }

    /// A velocity along axis `a` after a kick over a time, and the axis of the account; `ahead` is the velocity before
    /// minus that of the force evaluation. A prescribed component has its value at the end of the kick.
    pub(super) fn axis(
        self,
        a: usize,
        i: Index,
        before: [Recorded; 2],
        ahead: Recorded,
        (dt, when): (Recorded, When),
    ) -> ([Recorded; 2], KickAxis<Recorded>) {
        let (acceleration, pushed) = (self.rates.get(a, i), self.external.get(a, i));
        let pair = acceleration - pushed;
        let (mut gained, mut beyond) = (dt * acceleration, dt * pushed);
        let mut after = added(before, gained);
        if let Some(motions) = self.motions {
            let held = motions.of_particle(i);
            let velocity = held.velocity(a, when);
            let jump = (velocity - before[0]) - before[1];
            gained = held.choose(a, jump, gained);
            beyond = held.choose(a, jump - dt * pair, beyond);
            after = [held.choose(a, velocity, after[0]), held.choose(a, Recorded::zero(), after[1])];
        }
        let half_gained = Recorded::of(0.5) * gained;
        (after, KickAxis { pair, mean: before[0] + half_gained, ahead: ahead + half_gained, beyond })
    }

    /// Adds a kick over a time to the accounts.
    pub(super) fn book(self, i: Index, axes: &[KickAxis<Recorded>; 3], dt: Recorded) {
        let mass = self.constants.get(0, i);
        let mut account = KickAccount::zero();
        for (a, axis) in axes.iter().enumerate() {
            account.add(a, axis, mass, dt);
        }
        self.energy.add(0, 1, i, dt * self.energy.get(2, i) + account.energy);
        // For walls, the work beyond that of their force on the centre.
        self.accounts.add(0, 1, i, account.work + mass * self.external.get(3, i) * dt);
        for (a, impulse) in account.impulse.into_iter().enumerate() {
            self.accounts.add(2 + 2 * a, 3 + 2 * a, i, impulse);
        }
        self.accounts.add(8, 9, i, mass * account.energy);
        for (part, account) in [(3, 10), (4, ARTIFICIAL_WORK), (5, 14)] {
            self.accounts.add(account, account + 1, i, mass * dt * self.energy.get(part, i));
        }
        if let Some((meetings, bodies)) = self.meetings {
            contact::each_body(bodies, |body| {
                for (work, power) in contact::WORKS {
                    meetings.book_in_group((body, contact::MEETING), (work, power), i, dt);
                }
            });
        }
        if let Some((of_walls, count)) = self.walls {
            for wall in (0..count).map(|k| walls::FIELDS * k) {
                for sum in 0..walls::SUMS {
                    let done = dt * of_walls.get(wall + 2 * walls::SUMS + sum, i);
                    of_walls.add(wall + 2 * sum, wall + 2 * sum + 1, i, done);
                }
            }
        }
    }
}
