//! The check that ends a run before invalid values spread.

use crate::RunFailure;
use crate::particles::Particles;
use crate::ranks::StepFault;
use rayon::prelude::*;
use sphorge_physics::Vector;
use sphorge_physics::step_control::{Changed, StepChange};

/// Reports the particle with the lowest index that has a value that is not finite, a density that is not positive or,
/// if something `is_cooled`, a temperature below zero.
///
/// # Errors
/// There is one.
pub fn check(p: &Particles, is_cooled: bool) -> Result<(), RunFailure> {
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
            "`temperature` became {value} K: a flux out of the body removes more heat than it contains; convection stops at the ambient temperature"
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

/// Reports the particle that a step of size `dt` (s) has changed most, and its quantity, if that is more than allowed;
/// `speeds` are the sound speeds of the materials at rest, m/s.
pub fn largest_change(limits: &StepChange, p: &Particles, speeds: &[f64], dt: f64) -> Option<StepFault> {
    let change = |i: usize| {
        // Forces on a driven particle do not move it.
        let is_driven = p.motion.get(i).is_some_and(|&motion| motion > 0);
        let acceleration = if is_driven { &[0.0; 3] } else { &p.acceleration[i] };
        let (speed, h) = (speeds[p.material[i] as usize], p.smoothing_length[i]);
        StepChange::of(&p.velocity_gradient[i], (p.energy[i], p.energy_rate[i]), speed, acceleration, h, dt)
    };
    let particles = || (0..p.len()).into_par_iter().with_min_len(1024);
    if !particles().any(|i| change(i).is_beyond(limits)) {
        return None;
    }
    let excess = |i: usize| {
        let (_, number, limit) = change(i).worst(limits);
        let ratio = number / limit;
        (if ratio.is_nan() { f64::INFINITY } else { ratio }, i)
    };
    // Of equals the first, on any number of threads.
    let larger = |a: (f64, usize), b: (f64, usize)| if b.0 > a.0 || b.0 == a.0 && b.1 < a.1 { b } else { a };
    let (ratio, i) = particles().map(excess).reduce(|| (f64::NEG_INFINITY, usize::MAX), larger);
    let (changed, number, limit) = change(i).worst(limits);
    let number = if number < 1e-3 { format!("{number:.1e}") } else { format!("{number:.3}") };
    let (field, what) = match changed {
        Changed::Density => ("density", format!("the density changed by {number} of its value")),
        Changed::Stretch => ("velocity_gradient", format!("the material was stretched by {number}")),
        Changed::Energy => {
            ("energy", format!("the energy changed by {number} of its value plus the square of the sound speed"))
        }
        Changed::Jump => ("position", format!("the particle was pushed by {number} smoothing lengths")),
    };
    let message = format!("{what} in one step, more than the {limit:?} of `time.step-control`");
    let failure = RunFailure { field, step_may_be_smaller: true, ..of_particle(p, i, message) };
    Some(StepFault::changed(failure, ratio))
}

/// Last valid position of a particle. Everything that moves it is checked, so only the end of a predictor–corrector
/// step can lose its position within the step; the start of that step has a valid one.
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

    #[test]
    fn the_particle_that_changed_most_is_named_and_a_driven_one_is_not_pushed() {
        let mut p = particles(4);
        p.id.copy_from_slice(&[5, 6, 7, 8]);
        p.smoothing_length.fill(2.0);
        let check = |p: &Particles| {
            largest_change(&StepChange::DEFAULT, p, &[10.0], 0.5).map_or(Ok(()), |fault| Err(fault.failure))
        };
        // 0.08, 0.16 and 0.12 smoothing lengths.
        for (k, a) in [0.64, 1.28, 0.96].into_iter().enumerate() {
            p.acceleration[k] = [0.0, -a, 0.0];
        }
        let failure = check(&p).unwrap_err();
        assert_eq!((failure.particle, failure.field, failure.step_may_be_smaller), (Some(6), "position", true));
        assert!(failure.message.contains("0.160 smoothing lengths in one step, more than the 0.1 of"), "{failure}");
        p.motion[1] = 1;
        assert_eq!(check(&p).unwrap_err().particle, Some(7));
        p.acceleration[2] = [0.0; 3];
        assert_eq!(check(&p), Ok(()));
        // Two that are stretched equally: the first; a value that is not a number is worse.
        p.velocity_gradient[3][0][0] = 1.0;
        p.velocity_gradient[2][0][0] = 1.0;
        assert_eq!(check(&p).map_err(|f| (f.particle, f.field)), Err((Some(7), "density")));
        p.velocity_gradient[3][0][1] = f64::NAN;
        assert_eq!(check(&p).map_err(|f| (f.particle, f.field)), Err((Some(8), "velocity_gradient")));
    }
}
