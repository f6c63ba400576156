//! The check that ends a run before nonsense spreads.

use crate::RunFailure;
use crate::model::{HeatBoundaryKind, Model};
use crate::particles::Particles;
use rayon::prelude::*;
use sphorge_physics::Vector;
use sphorge_physics::step_control::StepChange;

/// Whether heat is taken out whatever the temperature, so that particles could be cooled below absolute zero.
pub(super) fn is_cooled(model: &Model) -> bool {
    let cools = |kind| matches!(kind, HeatBoundaryKind::Flux(flux) if flux < 0.0);
    model.thermal.conduction && model.thermal.boundaries.iter().any(|b| cools(b.kind))
}

/// Names the first particle (in id order of failure, lowest index) with a value that is not finite, a density that is not
/// positive or, where something `is_cooled`, a temperature below zero.
pub(super) fn check(p: &Particles, is_cooled: bool) -> Result<(), RunFailure> {
    let wrong = |i: usize| {
        let too_cold = || (is_cooled && p.temperature[i] < 0.0).then_some("temperature");
        p.first_fault(i).or_else(too_cold)
    };
    let Some(i) = (0..p.len()).into_par_iter().with_min_len(1024).find_first(|&i| wrong(i).is_some()) else {
        return Ok(());
    };
    let field = wrong(i).unwrap_or("position");
    let value = p.column(field).map_or(f64::NAN, |c| c.magnitude(i));
    let message = if field == "temperature" && p.temperature[i] < 0.0 {
        format!(
            "`temperature` became {value} K: a flux out of the body takes more heat than there is; convection ends by itself"
        )
    } else {
        format!("`{field}` became {value}")
    };
    let step_may_be_smaller = !(field == "temperature" && is_cooled);
    Err(RunFailure { field, step_may_be_smaller, ..of_particle(p, i, message) })
}

fn of_particle(p: &Particles, i: usize, message: String) -> RunFailure {
    let (particle, body) = (Some(p.id[i]), Some(p.body[i]));
    RunFailure { particle, body, position: last_place(p, i), ..RunFailure::of_engine(message) }
}

/// Names the first particle that a step of size `dt` (s) has changed by more than the deck allows; `speeds` are the sound speeds of the materials at
/// rest, m/s.
pub(super) fn check_change(model: &Model, p: &Particles, speeds: &[f64], dt: f64) -> Result<(), RunFailure> {
    let Some(control) = model.time.step_control.filter(|_| dt > 0.0 && model.thermal.mechanics) else {
        return Ok(());
    };
    let beyond = |i: usize| {
        let speed = speeds[p.material[i] as usize];
        // What a driven particle is pushed with does not move it.
        let is_driven = p.motion.get(i).is_some_and(|&motion| motion > 0);
        let acceleration = if is_driven { &[0.0; 3] } else { &p.acceleration[i] };
        let h = p.smoothing_length[i];
        let change =
            StepChange::of(&p.velocity_gradient[i], (p.energy[i], p.energy_rate[i]), speed, acceleration, h, dt);
        change.beyond(&control.largest)
    };
    let Some(i) = (0..p.len()).into_par_iter().with_min_len(1024).find_first(|&i| beyond(i).is_some()) else {
        return Ok(());
    };
    let Some((k, number, limit)) = beyond(i) else { return Ok(()) };
    let (field, what) = [
        ("density", "the density changed by {} of itself"),
        ("velocity_gradient", "the material was stretched by {}"),
        ("energy", "the energy changed by {} of itself and the square of the sound speed"),
        ("position", "the particle was pushed by {} smoothing lengths"),
    ][k];
    let number = if number < 1e-3 { format!("{number:.1e}") } else { format!("{number:.3}") };
    let what = what.replace("{}", &number);
    let message = format!("{what} in one step, more than the {limit:?} of `time.step-control`");
    Err(RunFailure { field, step_may_be_smaller: true, ..of_particle(p, i, message) })
}

/// Where a particle was last. What moves it is guarded, so that only the end of a predictor–corrector step can lose its place within the step;
/// that step began somewhere.
fn last_place(p: &Particles, i: usize) -> Option<Vector<f64>> {
    let columns = [&p.position, &p.base_position, &p.reference_position, &p.origin];
    columns.into_iter().filter_map(|column| column.get(i)).find(|x| x.iter().all(|c| c.is_finite())).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particles::Owner;

    fn particles(count: usize) -> Particles {
        let mut p = Particles::new(count);
        p.allocate(Owner::Step);
        p.density.fill(1.0);
        p
    }

    #[test]
    fn a_particle_that_lost_its_place_is_where_it_was_before() {
        let mut p = particles(2);
        p.position[1] = [1.0, f64::NAN, 3.0];
        assert_eq!(check(&p, false).unwrap_err().position, None);
        p.allocate(Owner::AdaptiveSearch);
        p.origin[1] = [1.0, 2.0, 3.0];
        assert_eq!(check(&p, false).unwrap_err().position, Some([1.0, 2.0, 3.0]));
        p.allocate(Owner::PredictorCorrector);
        p.base_position[1] = [1.0, 2.5, 3.0];
        assert_eq!(check(&p, false).unwrap_err().position, Some([1.0, 2.5, 3.0]));
    }

    #[test]
    fn an_xsph_velocity_is_found_before_it_moves_a_particle() {
        let mut p = particles(2);
        p.position[1] = [1.0, 2.0, 3.0];
        p.xsph[1][2] = f64::INFINITY;
        let failure = check(&p, false).unwrap_err();
        assert_eq!((failure.field, failure.position), ("xsph", Some([1.0, 2.0, 3.0])));
    }

    #[test]
    fn the_first_bad_particle_is_named_with_its_field() {
        let mut p = particles(3);
        p.id.copy_from_slice(&[7, 8, 9]);
        assert_eq!(check(&p, true), Ok(()));
        p.temperature[2] = f64::NAN;
        p.density[1] = -2.0;
        let failure = check(&p, false).unwrap_err();
        assert_eq!((failure.particle, failure.field), (Some(8), "density"));
        assert!(failure.to_string().contains("-2"), "{failure}");
    }

    #[test]
    fn a_temperature_below_zero_counts_where_something_is_cooled() {
        let mut p = particles(2);
        p.temperature[1] = -2.0;
        assert_eq!(check(&p, false), Ok(()));
        let failure = check(&p, true).unwrap_err();
        assert_eq!(failure.field, "temperature");
        assert!(failure.to_string().contains("-2 K: a flux"), "{failure}");
    }
}
