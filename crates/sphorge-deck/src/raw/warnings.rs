//! When a run is said to be broken.

use super::super::declare::tables;
use super::super::{choice::*, value::*};

tables! {
    /// Checks for numerical failure during the run, each with its limit. `docs/warnings.md` explains them and their remedies.
    #[derive(Default)]
    RawWarnings {
        /// Checks to turn off.
        off: Option<Vec<Choice<WarningWord>>>, example ["wall-energy"], otherwise "none";
        /// Largest plastic work over the energy supplied: initial kinetic and internal energy, work done on the particles, heat.
        plastic_work: Option<Given<Number>>, example 1.05, default 1.01;
        /// Largest deficit of internal energy below the floor that heat can explain, over the energy supplied; for the whole model and for each body.
        negative_energy: Option<Given<Number>>, example 0.02, default 0.01;
        /// Largest work of the hourglass springs that they do not hold, of either sign, beyond what the integrator booked, over the energy supplied.
        hourglass_work: Option<Given<Number>>, example 0.2, default 0.1;
        /// Largest energy that the integration in time has lost or made, over the energy that has passed between motion and matter.
        integration: Option<Given<Number>>, example 0.2, default 0.1;
        /// Largest energy that contacts between bodies have given beyond what they took and held at the start, over the energy supplied.
        contact_energy: Option<Given<Number>>, example 0.05, default 0.01;
        /// Lowest temperature.
        cold: Option<Given<Temperature>>, example "200 K", default "0 K";
        /// Largest temperature over the highest that the internal energy of the particle allows.
        hot: Option<Given<Number>>, example 3, default 2.0;
        /// Largest temperature of the energy over that of plastic work, of particles of materials with a Grüneisen parameter and a specific heat, where
        /// more than a hundredth of the particles of a body are beyond. Not checked with `temperature = "energy"`.
        missing_heat: Option<Given<Number>>, example 3, default 1.5;
        /// Largest work of all walls at rest, of either sign, over the initial kinetic energy.
        wall_energy: Option<Given<Number>>, example 0.3, default 0.2;
        /// Largest drift of the total energy, over the energy in play. Not checked with `guard = "none"`.
        energy_drift: Option<Given<Number>>, example 1e-3, default 1e-4;
        /// Largest drift of the linear momentum, over the sum of the magnitudes of all momenta. Not checked with `guard = "none"`.
        momentum_drift: Option<Given<Number>>, example 1e-3, default 1e-4;
        /// Largest share of the particles of a body that have clumped in pairs.
        pairing: Option<Given<Number>>, example 0.2, default 0.1;
        /// Largest number of particles of a body that cannot break (no `spall-pressure`, no damage) in zones where more than 40 % are in pairs in
        /// tension, over the number in a ball of 2.5 spacings.
        tearing: Option<Given<Number>>, example 3, default 1.0;
        /// Largest share of the particles of a body that cannot break (no `spall-pressure`, no damage) that are not part of its largest piece,
        /// minus that at the start.
        pieces: Option<Given<Number>>, example 0.1, default 0.01;
        /// Largest share of the particles of a body that cannot break (no `spall-pressure`, no damage) with fewer neighbours than a
        /// gradient needs, minus that at the start.
        lost_neighbors: Option<Given<Number>>, example 0.01, default 0.001;
        /// Largest share of the particles of a body whose centres lie in cells of another body that is in one piece, beyond outermost layers that press each
        /// other. Checked in the total Lagrangian form.
        interpenetration: Option<Given<Number>>, example 0.1, default 0.03;
        /// Largest depth of a particle behind a symmetry plane, in spacings of its body.
        behind_symmetry: Option<Given<Number>>, example 0.2, default 0.5;
        /// Largest distance of a particle from the box around the initial bodies, over the largest possible travel: the length of that box
        /// plus the distance at the highest given speed.
        far_away: Option<Given<Number>>, example 10, default 3.0;
        /// Largest compression `1 - rho_0/rho` over `1/S`, the largest that a shock reaches.
        compression: Option<Given<Number>>, example 0.9, default 1.0;
        /// Lowest density over the reference density.
        expansion: Option<Given<Number>>, example 0.3, default 0.5;
        /// Smallest time step over the first one.
        time_step: Option<Given<Number>>, example 1e-4, default 1e-3;
        /// Largest number of steps to the end of the run at the present time step.
        steps_left: Option<Given<Number>>, example 1e9, default 1e8;
        /// Number of remaining steps above which the run is stopped because it would not end.
        stop_at_steps: Option<Given<Number>>, example 1e12, default 1e10;
    }
}
