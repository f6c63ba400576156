//! The state that a run starts from, against which later ones are held.

use crate::{
    engine::{Ledger, ParticleSource, Quantity, Reduction, RunFailure, persist_fields},
    model::{Extremum, Model, MotionAxis, ParticleSelection, TimeTable},
};

/// Energy that counts as none, over that of the whole mass at the square of its sound speed.
const NO_ENERGY: f64 = 1e-12;
/// Speed of rounding over that of sound: less is no motion.
const ROUNDING: f64 = 1e-12;

/// The state that others are held against.
#[derive(Clone, Debug, Default)]
pub(super) struct Start {
    pub(super) kinetic: f64,
    /// Beyond that of bodies at rest at the temperatures they start with.
    pub(super) internal: f64,
    /// What contacts hold, such as that of a shaft in its hub, J.
    pub(super) pressed: f64,
    pub(super) external_work: f64,
    /// Energy (J) and momentum (kg m/s) that are next to nothing.
    pub(super) nothing: f64,
    pub(super) no_momentum: f64,
    /// Energy (J) and momentum (kg m/s) of rounding.
    pub(super) rounding: [f64; 2],
    /// Corners of the box around all particles, m, and the highest speed given, m/s.
    pub(super) low: [f64; 3],
    pub(super) high: [f64; 3],
    pub(super) speed: f64,
    /// Share of the particles of each body that had too few neighbours.
    pub(super) lonely: Vec<f64>,
    /// Share that was not part of its largest piece.
    pub(super) apart: Vec<f64>,
}

persist_fields!(Start {
    kinetic,
    internal,
    pressed,
    external_work,
    nothing,
    no_momentum,
    rounding,
    low,
    high,
    speed,
    lonely,
    apart
});

impl Start {
    pub(super) fn of(source: &dyn ParticleSource, model: &Model, ledger: &Ledger) -> Result<Self, RunFailure> {
        let all = ParticleSelection::default();
        let extremum = |field, component, extremum| -> Result<f64, RunFailure> {
            let quantity = Quantity { field, component };
            let found = source.reduce(&Reduction::Extremum { of: &all, quantity, extremum })?;
            Ok(found.first().copied().unwrap_or(0.0))
        };
        let (mut low, mut high) = ([0.0; 3], [0.0; 3]);
        for axis in 0..3 {
            low[axis] = extremum("position", Some(axis), Extremum::Minimum)?;
            high[axis] = extremum("position", Some(axis), Extremum::Maximum)?;
        }
        let sound_speed = |body: usize| {
            let material = model.materials.get(model.bodies[body].material);
            material.map_or(0.0, |material| material.equation_of_state.reference_sound_speed())
        };
        let energy = |body: usize| ledger.bodies[body].mass * sound_speed(body).powi(2);
        let momentum = |body: usize| ledger.bodies[body].mass * sound_speed(body);
        let bodies = model.bodies.len().min(ledger.bodies.len());
        let (energy, momentum): (f64, f64) = ((0..bodies).map(energy).sum(), (0..bodies).map(momentum).sum());
        Ok(Self {
            kinetic: ledger.total.energies.kinetic,
            pressed: ledger.contacts.iter().map(|contact| contact.stored_energy.max(0.0)).sum(),
            internal: ledger.total.energies.internal
                - (0..bodies).map(|body| ledger.bodies[body].mass * energy_at_start(model, body)).sum::<f64>(),
            // Regions that are driven from the start have been given their velocity: it is in the kinetic energy.
            external_work: ledger.external_work,
            nothing: NO_ENERGY * energy,
            // That of a mass with that energy.
            no_momentum: NO_ENERGY.sqrt() * momentum,
            rounding: [ROUNDING.powi(2) * energy, ROUNDING * momentum],
            low,
            high,
            speed: extremum("speed", None, Extremum::Maximum)?.max(driven_speed(model)),
            lonely: Vec::new(),
            apart: Vec::new(),
        })
    }
}

/// The highest speed that walls and driven regions have, m/s.
fn driven_speed(model: &Model) -> f64 {
    let largest = |table: &TimeTable| table.points.iter().map(|point| point.1.abs()).fold(0.0, f64::max);
    let norm = |axes: [f64; 3]| axes.iter().map(|v| v * v).sum::<f64>().sqrt();
    let of_wall = model.walls.iter().map(|wall| norm([0, 1, 2].map(|a| largest(&wall.velocity[a]))));
    let of_motion = model.motions.iter().map(|motion| {
        norm([0, 1, 2].map(|a| match &motion.axes[a] {
            MotionAxis::Free => 0.0,
            MotionAxis::Velocity(table) => largest(table),
        }))
    });
    of_wall.chain(of_motion).fold(0.0, f64::max)
}

/// Specific internal energy of a body at rest at the temperature it starts with, J/kg; that of the reference temperature is zero.
pub(super) fn energy_at_start(model: &Model, body: usize) -> f64 {
    let Some(body) = model.bodies.get(body) else { return 0.0 };
    let Some(material) = model.materials.get(body.material).filter(|material| material.heats()) else { return 0.0 };
    material.cold_energies().of_temperature(model.density_at_start(body), body.temperature)
}
