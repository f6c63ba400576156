//! What a step tells the outside.

use crate::persist::Fixed;
use sphorge_physics::wall::FacePush;

/// Which rule limited the time step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitReason {
    /// Longitudinal sound speed plus |mu| over the smoothing length.
    SoundSpeed,
    /// Square root of smoothing length over acceleration.
    Acceleration,
    /// Stiffness of the contact with a wall or between bodies.
    Contact,
    /// Heat capacity over the conductances of a particle.
    Conduction,
    /// The deck's `max-step` or `fixed-step`.
    Deck,
    /// Landing exactly on an output or end time.
    Output,
    /// A step nearby was taken back because it changed too much.
    Repeat,
}

impl LimitReason {
    /// Every reason, in the order of their numbers.
    const ALL: [Self; 7] =
        [Self::SoundSpeed, Self::Acceleration, Self::Contact, Self::Conduction, Self::Deck, Self::Output, Self::Repeat];

    /// The reason of this number.
    pub(crate) fn from_u8(number: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|reason| *reason as u8 == number)
    }

    /// Word written to `history.csv`.
    pub fn name(self) -> &'static str {
        match self {
            Self::SoundSpeed => "sound-speed",
            Self::Acceleration => "acceleration",
            Self::Contact => "contact",
            Self::Conduction => "conduction",
            Self::Deck => "deck",
            Self::Output => "output",
            Self::Repeat => "repeat",
        }
    }
}

/// Wall-clock seconds by stage since the start of the run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StageSeconds {
    /// Neighbour search.
    pub search: f64,
    /// Velocity gradient and density rate.
    pub kinematics: f64,
    /// Constitutive update.
    pub stress: f64,
    /// Forces.
    pub forces: f64,
    /// Integration, guard, time step.
    pub integrate: f64,
    /// Output (filled by whoever writes).
    pub output: f64,
}

/// Energies, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energies {
    /// Kinetic.
    pub kinetic: f64,
    /// Internal, `sum m e`.
    pub internal: f64,
    /// Elastic part of the internal energy: shear and volume.
    pub elastic: f64,
    /// Plastic work done so far.
    pub plastic_work: f64,
}

crate::persist_fields!(StageSeconds { search, kinematics, stress, forces, integrate, output });
crate::persist_fields!(Energies { kinetic, internal, elastic, plastic_work });

/// Sums over one body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyLedger {
    /// Mass, kg.
    pub mass: f64,
    /// Energies.
    pub energies: Energies,
    /// Linear momentum, kg m/s.
    pub momentum: [f64; 3],
    /// Angular momentum about the origin, kg m²/s.
    pub angular_momentum: [f64; 3],
    /// Sum of m |v|, kg m/s: the scale momentum drift is measured against.
    pub momentum_scale: f64,
    /// Centre of mass, m.
    pub centre: [f64; 3],
    /// Net force, N: sum of mass times acceleration, of driven particles as they are driven.
    pub force: [f64; 3],
}

impl BodyLedger {
    /// Adds a particle of mass `m` (kg) at `x` (m) with velocity `v` (m/s), under a force of that acceleration (m/s²). The specific energies
    /// (J/kg) are those of the particle; its kinetic one follows from the velocity. [`Self::centre`] is the sum of mass times place until
    /// [`Self::close`].
    pub fn add(&mut self, m: f64, x: [f64; 3], v: [f64; 3], acceleration: [f64; 3], specific: Energies) {
        let speed2 = v.iter().map(|c| c * c).sum::<f64>();
        self.mass += m;
        self.energies.kinetic += 0.5 * m * speed2;
        self.energies.internal += m * specific.internal;
        self.energies.elastic += m * specific.elastic;
        self.energies.plastic_work += m * specific.plastic_work;
        self.momentum_scale += m * speed2.sqrt();
        for a in 0..3 {
            let (b, c) = ((a + 1) % 3, (a + 2) % 3);
            self.momentum[a] += m * v[a];
            self.angular_momentum[a] += m * (x[b] * v[c] - x[c] * v[b]);
            self.centre[a] += m * x[a];
            self.force[a] += m * acceleration[a];
        }
    }

    /// The sums over all bodies, in order, before any of them is closed.
    #[must_use]
    pub fn total(bodies: &[Self]) -> Self {
        let mut total = Self::default();
        for body in bodies {
            total.mass += body.mass;
            total.energies.kinetic += body.energies.kinetic;
            total.energies.internal += body.energies.internal;
            total.energies.elastic += body.energies.elastic;
            total.energies.plastic_work += body.energies.plastic_work;
            total.momentum_scale += body.momentum_scale;
            for a in 0..3 {
                total.momentum[a] += body.momentum[a];
                total.angular_momentum[a] += body.angular_momentum[a];
                total.centre[a] += body.centre[a];
                total.force[a] += body.force[a];
            }
        }
        total
    }

    /// Makes the centre one, once every particle was added.
    pub fn close(&mut self) {
        for c in &mut self.centre {
            *c /= self.mass;
        }
    }
}

impl Fixed for BodyLedger {
    const SIZE: usize = <[f64; 18]>::SIZE;
    fn write(&self, out: &mut Vec<u8>) {
        let Energies { kinetic, internal, elastic, plastic_work } = self.energies;
        [self.mass, kinetic, internal, elastic, plastic_work, self.momentum_scale].write(out);
        [self.momentum, self.angular_momentum, self.centre, self.force].write(out);
    }
    fn read(bytes: &[u8]) -> Option<Self> {
        let [mass, kinetic, internal, elastic, plastic_work, momentum_scale] = Fixed::read(bytes.get(..48)?)?;
        let [momentum, angular_momentum, centre, force] = Fixed::read(bytes.get(48..)?)?;
        let energies = Energies { kinetic, internal, elastic, plastic_work };
        Some(Self { mass, energies, momentum, angular_momentum, momentum_scale, centre, force })
    }
}

/// Contact of two bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactLedger {
    /// Force of the first body on the second, N.
    pub force: [f64; 3],
    /// Work against the elastic part of the contact since the start, J: what the contact holds. It comes back when the bodies part, to
    /// second order of the time step.
    pub stored_energy: f64,
    /// Work friction turned to heat since the start, J.
    pub friction_work: f64,
    /// Work damping turned to heat since the start, J.
    pub damping_work: f64,
    /// Work against the contact since the start that it neither holds more of than at the start nor turned to heat, J: the error of the
    /// integration in time.
    pub integration_energy: f64,
}

/// What a wall has done since the start. Its force and its heat stay with the particles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WallLedger {
    /// Work on the particles, J: its force times the velocity of the particles where forces are summed, and the heat of friction and
    /// damping.
    pub work: f64,
    /// Heat of friction, J.
    pub friction_work: f64,
    /// Heat of damping, J.
    pub damping_work: f64,
}

impl WallLedger {
    /// Of a push of so much power in all (W/kg) on a particle of that mass (kg), W.
    pub(crate) fn powers(push: &FacePush<f64>, power: f64, mass: f64) -> Self {
        let [work, friction_work, damping_work] = [power, push.rubbed, push.heat - push.rubbed].map(|of| mass * of);
        Self { work, friction_work, damping_work }
    }

    /// Adds so many times another.
    pub(crate) fn add(&mut self, other: &Self, times: f64) {
        self.work += times * other.work;
        self.friction_work += times * other.friction_work;
        self.damping_work += times * other.damping_work;
    }
}

impl Fixed for WallLedger {
    const SIZE: usize = <[f64; 3]>::SIZE;
    fn write(&self, out: &mut Vec<u8>) {
        [self.work, self.friction_work, self.damping_work].write(out);
    }
    fn read(bytes: &[u8]) -> Option<Self> {
        let [work, friction_work, damping_work] = Fixed::read(bytes)?;
        Some(Self { work, friction_work, damping_work })
    }
}

/// Heat that flowed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HeatLedger {
    /// Heat every boundary supplied since the start, J, in deck order; empty where no heat flows.
    pub supplied: Vec<f64>,
    /// Heat that particles took or gave since the start, J, each exchange counted on both sides.
    pub exchanged: f64,
}

/// Conservation ledger of the whole model at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ledger {
    /// Sums by body, in deck order.
    pub bodies: Vec<BodyLedger>,
    /// Sums over everything.
    pub total: BodyLedger,
    /// Work done on the particles by walls, gravity, prescribed motion and loads of a program since the start, J; of walls with the heat of
    /// friction and damping, which goes to the particles.
    pub external_work: f64,
    /// Impulse of walls, gravity, prescribed motion and loads of a program since the start, N s.
    pub external_impulse: [f64; 3],
    /// Part of the external work by loads of a program, J: summed from the loads alone, while the external work is what the momenta of particles
    /// change beyond their pair forces.
    pub load_work: f64,
    /// What each wall has done, in deck order. The sum of their works differs from their share of `external_work` by what is of first
    /// order in the step.
    pub walls: Vec<WallLedger>,
    /// Energy the integrator booked into the internal energy since the start, J: the work of pair forces at the velocity they were
    /// evaluated with less that at the velocity the kick went through. Without it the total would not close; that it is small shows that
    /// steps are small enough.
    pub integration_energy: f64,
    /// Energy a density re-initialisation added to the pressure field without work, since the start, J.
    pub mls_energy: f64,
    /// Work against the hourglass springs since the start, J, part of the internal energy: what they hold, and what they have turned
    /// into heat. Zero but in the total Lagrangian form. Here and below it is positive where forces have taken from
    /// the motion.
    pub hourglass_energy: f64,
    /// Energy that the hourglass springs hold, J, part of that work: it comes back. The rest is heat.
    pub hourglass_stored_energy: f64,
    /// What the artificial viscosity has turned into internal energy since the start, J: that of pairs, or the bulk viscosity of the
    /// total Lagrangian form.
    pub viscous_energy: f64,
    /// Work against the artificial stress since the start, J, part of the internal energy: negative where it has driven particles apart.
    pub artificial_stress_energy: f64,
    /// What breaking has dissipated since the start, J, part of the internal energy: plastic work of material whose damage is one, and elastic
    /// energy that was lost with its integrity.
    pub fracture_energy: f64,
    /// Heat.
    pub heat: HeatLedger,
    /// Contact of every pair of bodies, `(0, 1), (0, 2), .. (1, 2), ..`; empty where bodies meet in the kernel sum.
    pub contacts: Vec<ContactLedger>,
    /// Force of each wall on the particles, N, in deck order.
    pub wall_forces: Vec<[f64; 3]>,
    /// What the spring of each wall holds now, J, in deck order: it gives that back. Empty where an engine does not sum it.
    pub wall_stored_energies: Vec<f64>,
    /// Reaction of each prescribed motion on its particles, N, in deck order.
    pub motion_forces: Vec<[f64; 3]>,
}

impl Ledger {
    /// Heat that came in through boundaries since the start, J.
    pub fn boundary_heat(&self) -> f64 {
        self.heat.supplied.iter().sum()
    }

    /// Kinetic, internal and stored contact energy, J: what external work and heat alone change.
    pub fn total_energy(&self) -> f64 {
        let Energies { kinetic, internal, .. } = self.total.energies;
        kinetic + internal + self.contacts.iter().map(|c| c.stored_energy + c.integration_energy).sum::<f64>()
    }
}

/// What the neighbour lists miss, found by an exact search.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Audit {
    /// Ordered pairs within the kernel support.
    pub pairs: u64,
    /// Of these, missing in the lists; of pairs of bodies that meet at facets only those whose facets are near enough to touch.
    pub missed_pairs: u64,
    /// Of the missing, pairs of particles of different bodies.
    pub missed_foreign_pairs: u64,
    /// Pairs of the lists beyond the kernel support.
    pub stale_pairs: u64,
    /// Root mean square error of the density rate, relative to its root mean square.
    pub density_rate_error: f64,
    /// Root mean square error of the force by stress, relative to its root mean square.
    pub force_error: f64,
    /// Sum of the forces between particles over the sum of their magnitudes.
    pub momentum_residual: f64,
}

crate::persist_fields!(Audit {
    pairs,
    missed_pairs,
    missed_foreign_pairs,
    stale_pairs,
    density_rate_error,
    force_error,
    momentum_residual,
});

/// State of the run after a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepReport {
    /// Steps done.
    pub step: u64,
    /// Time reached, s.
    pub time: f64,
    /// Size of the step just taken, s.
    pub dt: f64,
    /// Why it was no larger.
    pub reason: LimitReason,
    /// Share of the particles whose neighbours were searched in this step.
    pub searched_fraction: f64,
    /// Ordered neighbour pairs i != j inside the kernel support, summed over particles, in this step.
    pub pairs: u64,
    /// Comparison of the lists with an exact search, in steps that are audited.
    pub audit: Option<Audit>,
}
