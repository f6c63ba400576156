//! What a program does to bodies while they are computed: loads and velocities that no deck can state beforehand.

use crate::model::Model;
use crate::particles::Particles;
use crate::persist::{Archive, ArchiveError, Persist, require};
use sphorge_physics::Vector;

/// Loads and velocities over the next step. They hold until others are given.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive {
    /// Force on each body, N (N/m in plane strain, N/m² in one dimension), spread over its particles by their mass; none where the program gives
    /// no load.
    pub forces: Vec<Option<Vector<f64>>>,
    /// In place of what the deck prescribes, for each of the model's motions: the velocity along each axis, m/s, or none where its particles are free.
    pub velocities: Vec<Option<[Option<f64>; 3]>>,
}

impl Drive {
    /// No loads, and the motions of the deck.
    pub fn none(model: &Model) -> Self {
        Self { forces: vec![None; model.bodies.len()], velocities: vec![None; model.motions.len()] }
    }

    /// Whether all numbers are finite, there are as many as the model has bodies and motions, and none is along an axis that it has not.
    pub fn fits(&self, model: &Model) -> bool {
        let count = model.dimensions.count();
        let velocities = self.velocities.iter().flatten().map(|axes| axes.map(|v| v.unwrap_or(0.0)));
        let mut all = velocities.chain(self.forces.iter().flatten().copied());
        self.forces.len() == model.bodies.len()
            && self.velocities.len() == model.motions.len()
            && all.all(|v| v.iter().all(|x| x.is_finite()) && v[count..].iter().all(|x| *x == 0.0))
    }
}

/// A drive as an engine applies it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Driven {
    /// Acceleration of each body, m/s²; none without a load.
    pub(crate) accelerations: Vec<Option<Vector<f64>>>,
    pub(crate) velocities: Vec<Option<[Option<f64>; 3]>>,
    /// Velocities that motions had before, from which they go over to the present ones in one step, m/s.
    pub(crate) before: Vec<[Option<f64>; 3]>,
    /// Of the bodies, kg; unknown in a state that was loaded.
    pub(crate) masses: Vec<f64>,
}

impl Driven {
    /// `masses` are those of the bodies, kg; `before` the velocities that motions have now.
    pub(crate) fn new(drive: &Drive, masses: Vec<f64>, before: Vec<[Option<f64>; 3]>) -> Self {
        let by = |mass: &f64, force: Vector<f64>| force.map(|f| if f == 0.0 { 0.0 } else { f / mass });
        let accelerations = drive.forces.iter().zip(&masses).map(|(force, mass)| force.map(|f| by(mass, f))).collect();
        Self { accelerations, velocities: drive.velocities.clone(), before, masses }
    }

    /// Acceleration of a body, m/s².
    pub(crate) fn of_body(&self, body: usize) -> Vector<f64> {
        self.accelerations[body].unwrap_or([0.0; 3])
    }

    /// Which bodies have a load, and which motions a velocity of the program.
    pub(crate) fn parts(&self) -> (Vec<bool>, Vec<bool>) {
        let loads = self.accelerations.iter().map(Option::is_some).collect();
        (loads, self.velocities.iter().map(Option::is_some).collect())
    }

    /// Mean acceleration over a step of size `dt` (s) of a motion whose velocities are given, m/s²; nothing where they are the deck's.
    pub(crate) fn acceleration(&self, motion: usize, dt: f64) -> Option<[Option<f64>; 3]> {
        let now = self.velocities[motion]?;
        let before = self.before[motion];
        Some([0, 1, 2].map(|a| now[a].map(|v| if dt == 0.0 { 0.0 } else { (v - before[a].unwrap_or(v)) / dt })))
    }

    /// Saves it if there is one, so that the saved states of other runs stay as they are, or loads it.
    pub(crate) fn persist(
        driven: &mut Option<Self>,
        model: &Model,
        archive: &mut dyn Archive,
    ) -> Result<(), ArchiveError> {
        const NAME: &str = "driven.accelerations";
        let mut accelerations = driven.as_ref().map_or_else(Vec::new, |driven| driven.accelerations.clone());
        if archive.is_saving() {
            if driven.is_none() {
                return Ok(());
            }
            accelerations.persist(NAME, archive)?;
        } else {
            *driven = None;
            match accelerations.persist(NAME, archive) {
                Err(ArchiveError::Missing(_)) => return Ok(()),
                other => other?,
            }
        }
        let mut own = match driven.take() {
            Some(own) => Self { accelerations, ..own },
            None => Self { accelerations, velocities: Vec::new(), before: Vec::new(), masses: Vec::new() },
        };
        own.velocities.persist("driven.velocities", archive)?;
        own.before.persist("driven.before", archive)?;
        let fits = own.accelerations.len() == model.bodies.len()
            && own.velocities.len() == model.motions.len()
            && own.before.len() == model.motions.len()
            && own.accelerations.iter().flatten().flatten().all(|a| a.is_finite())
            && own.velocities.iter().flatten().chain(&own.before).flatten().flatten().all(|v| v.is_finite());
        require(fits, NAME)?;
        *driven = Some(own);
        Ok(())
    }
}

/// Masses of the bodies, kg, summed in the order of the particles' ids, which does not change.
pub(crate) fn masses_of_bodies(model: &Model, particles: &Particles) -> Vec<f64> {
    let mut order: Vec<usize> = (0..particles.len()).collect();
    order.sort_unstable_by_key(|&i| particles.id[i]);
    let mut masses = vec![0.0; model.bodies.len()];
    order.into_iter().for_each(|i| masses[particles.body[i] as usize] += particles.mass[i]);
    masses
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_are_spread_by_mass_and_velocities_change_within_a_step() {
        let drive = Drive {
            forces: vec![Some([6.0, 0.0, -3.0]), None],
            velocities: vec![None, Some([Some(5.0), None, Some(1.0)])],
        };
        let driven = Driven::new(&drive, vec![2.0, 0.0], vec![[Some(7.0); 3], [Some(3.0), Some(9.0), None]]);
        assert_eq!((driven.of_body(0), driven.of_body(1)), ([3.0, 0.0, -1.5], [0.0; 3]));
        assert_eq!(driven.parts(), (vec![true, false], vec![false, true]));
        assert_eq!(driven.acceleration(0, 0.5), None);
        // What was free begins at the velocity it is given.
        assert_eq!(driven.acceleration(1, 0.5), Some([Some(4.0), None, Some(0.0)]));
        assert_eq!(driven.acceleration(1, 0.0), Some([Some(0.0), None, Some(0.0)]));
    }
}
