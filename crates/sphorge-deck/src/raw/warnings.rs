//! When a run is said to be broken.

use super::super::declare::tables;
use super::super::{choice::*, value::*};

tables! {
    /// When a run is said to be broken: checks made while it goes on, each with its limit. `docs/warnings.md` says what they are and
    /// what to do.
    #[derive(Default)]
    RawWarnings {
        /// Checks that are not made.
        off: Option<Vec<Choice<WarningWord>>>, example ["wall-energy"], otherwise "none";
        /// Largest plastic work over the energy supplied: initial kinetic and internal energy, work done on the particles, heat.
        plastic_work: Option<Given<Number>>, example 1.05, default 1.01;
        /// Largest internal energy that may be missing below what heat can leave, over the energy supplied; of the whole and of each body.
        negative_energy: Option<Given<Number>>, example 0.02, default 0.01;
        /// Lowest temperature.
        cold: Option<Given<Temperature>>, example "200 K", default "0 K";
        /// Largest temperature over the one that the internal energy of the particle allows.
        hot: Option<Given<Number>>, example 3, default 2.0;
        /// Largest work of all walls that do not move, given or taken, over the initial kinetic energy.
        wall_energy: Option<Given<Number>>, example 0.3, default 0.2;
        /// Largest share of the particles of a body that have fallen together in pairs.
        pairing: Option<Given<Number>>, example 0.2, default 0.1;
        /// Most particles of a body that cannot break (no `spall-pressure`, no damage) in zones where 40 % lie in pairs in tension, over those in a
        /// ball of 2.5 spacings.
        tearing: Option<Given<Number>>, example 3, default 1.0;
        /// Largest share of the particles of a body that cannot break (no `spall-pressure`, no damage) that are not part of its largest piece,
        /// beyond that at the start.
        pieces: Option<Given<Number>>, example 0.1, default 0.01;
        /// Largest share of the particles of a body that cannot break (no `spall-pressure`, no damage) with fewer neighbours than a
        /// gradient needs, beyond those at the start.
        lost_neighbors: Option<Given<Number>>, example 0.01, default 0.001;
        /// Largest depth of a particle behind a symmetry plane, in spacings of its body.
        behind_symmetry: Option<Given<Number>>, example 0.2, default 0.5;
        /// Largest distance of a particle from the box of the initial bodies, over the length of that box and the way at the highest
        /// speed given.
        far_away: Option<Given<Number>>, example 10, default 3.0;
        /// Largest compression `1 - rho_0/rho` over `1/S`, the largest that a shock reaches.
        compression: Option<Given<Number>>, example 0.9, default 1.0;
        /// Lowest density over the reference density.
        expansion: Option<Given<Number>>, example 0.3, default 0.5;
        /// Smallest time step over the first one.
        time_step: Option<Given<Number>>, example 1e-4, default 1e-3;
        /// Largest number of steps to the end of the run at the present time step.
        steps_left: Option<Given<Number>>, example 1e9, default 1e8;
        /// Number of steps to go at which the run is stopped: it would not end.
        stop_at_steps: Option<Given<Number>>, example 1e12, default 1e10;
    }
}
