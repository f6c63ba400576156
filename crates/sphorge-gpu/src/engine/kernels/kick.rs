//! Energy corrections of kicks, and the accounts of forces that are not pair forces.

use super::motion::{Motions, When};
use super::{contact, walls};
use crate::engine::columns::{
    Binder, Member, Read, ReadColumns, ReadShared, Shared, ValuedMember, Write, WriteColumns, added, groups,
};
use crate::record::{Index, Recorded};
use sphorge_engine::model::Model;
use sphorge_physics::Real;
use sphorge_physics::kick::{KickAccount, KickAxis};

/// The columns of a kick.
#[derive(Clone, Copy)]
pub(super) struct Kicks {
    /// Acceleration and XSPH velocity of the last forces.
    pub(super) rates: groups::Rates<Read>,
    pub(super) external: groups::External<Read>,
    energy: groups::Energy<Write>,
    accounts: groups::Accounts<Write>,
    walls: Option<(groups::Walls<Write>, usize)>,
    meetings: Option<(groups::Meetings<Write>, usize)>,
    constants: groups::Constants<Read>,
    pub(super) step: groups::Step<Shared>,
    pub(super) motions: Option<Motions>,
}

impl Kicks {
    pub(super) fn of(bind: &mut Binder<'_>, model: &Model) -> Self {
        let count = model.walls.len();
        let step = groups::Step::shared(bind);
        Self {
            motions: Motions::of(bind, model, step),
            step,
            rates: groups::Rates::read(bind),
            external: groups::External::read(bind),
            energy: groups::Energy::write(bind),
            accounts: groups::Accounts::write(bind),
            walls: (count > 0).then(|| (groups::Walls::write(bind), count)),
            meetings: model.has_contact().then(|| (groups::Meetings::write(bind), model.bodies.len())),
            constants: groups::Constants::read(bind),
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
        let (acceleration, pushed) =
            (self.rates.acceleration.axis(a).get(i), self.external.acceleration.axis(a).get(i));
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
        let mass = self.constants.mass.get(i);
        let mut account = KickAccount::zero();
        for (a, axis) in axes.iter().enumerate() {
            account.add(a, axis, mass, dt);
        }
        self.energy.energy.add(i, dt * self.energy.rate.get(i) + account.energy);
        // For walls, the work beyond that of their force on the centre.
        self.accounts.external_work.add(i, account.work + mass * self.external.power.get(i) * dt);
        for (a, impulse) in account.impulse.into_iter().enumerate() {
            self.accounts.impulse.number(a).add(i, impulse);
        }
        self.accounts.integration.add(i, mass * account.energy);
        for (rate, account) in [
            (self.energy.viscous_rate, self.accounts.viscous),
            (self.energy.artificial_stress_rate, self.accounts.artificial_stress),
            (self.energy.hourglass_rate, self.accounts.hourglass),
        ] {
            account.add(i, mass * dt * rate.get(i));
        }
        if let Some((meetings, bodies)) = self.meetings {
            contact::each_body(bodies, |body| {
                let meeting = meetings.of_value(body);
                meeting.works.book(meeting.powers, i, dt);
            });
        }
        if let Some((of_walls, count)) = self.walls {
            for wall in (0..count).map(|k| of_walls.of(k)) {
                for sum in 0..walls::SUMS {
                    wall.works.number(sum).add(i, dt * wall.powers.number(sum).get(i));
                }
            }
        }
    }
}
