//! Choices of the discretisation and of the neighbour search.

use super::super::declare::tables;
use super::super::{choice::*, value::*};

tables! {
    /// Numerical options.
    #[derive(Default)]
    RawNumerics {
        /// Smoothing kernel.
        kernel: Option<Choice<KernelWord>>, example "wendland-c2", default "cubic-spline";
        /// Time integrator.
        integrator: Option<Choice<IntegratorWord>>, example "predictor-corrector", otherwise "that of the method";
        /// Arithmetic of the pair sums; the state is always kept in double precision.
        precision: Option<Choice<PrecisionWord>>, example "double", default "mixed";
        /// Form of the pair sums of velocity gradient and momentum.
        pair_form: Option<Choice<PairFormWord>>, example "density-weighted", default "volume-weighted";
        /// Correction of the kernel gradient.
        gradient_correction: Option<Choice<GradientCorrectionWord>>, example "linear", default "none";
        /// Artificial viscosity (Monaghan & Gingold 1983), or `false` for none.
        viscosity: Option<ScalarOr<Flag, RawViscosity>>, default true;
        /// Artificial stress (Gray, Monaghan & Swift 2001); `true` for the constants of that paper.
        artificial_stress: Option<ScalarOr<Flag, RawArtificialStress>>, example { "epsilon": 0.3, "exponent": 4 }, otherwise "that of the method";
        /// XSPH strength, 0 to 1: share of the velocity averaged over the neighbours in the velocity that moves a particle.
        xsph: Option<Given<Number>>, example 0.5, otherwise "that of the method";
        /// Restore the density by moving least squares every so many steps.
        mls_interval: Option<Count>, example 20, otherwise "never";
        /// Division of pair work between the two particles.
        energy_split: Option<Choice<EnergySplitWord>>, example "symmetric", default "own-stress";
        /// Source of the temperature.
        temperature: Option<Choice<TemperatureWord>>, example "energy", default "plastic-work";
        /// Rule for the smoothing length.
        smoothing_length: Option<ScalarOr<Choice<SmoothingLengthWord>, RawSmoothingLength>>, example "follow-density", default "constant";
    }

    /// A rule for the smoothing length with its constants.
    RawSmoothingLength {
        /// Follow the density: `dh/dt = (h/d) div v` in `d` dimensions, that is `h = h0 (rho0/rho)^(1/d)`.
        follow_density: Option<RawFollowDensity>;
    }

    /// Bounds of a smoothing length that follows the density.
    RawFollowDensity {
        /// Largest ratio to the initial smoothing length, and the inverse of the smallest; above 1, at most 4.
        factor: Option<Given<Number>>, example 1.5, default 2.0;
    }

    /// Constants of the artificial viscosity.
    #[derive(Default)]
    RawViscosity {
        /// Linear coefficient. In the total Lagrangian form it acts on waves of few particles alone, except in materials that break and bodies that have come apart.
        alpha: Option<Given<Number>>, example 0.2, otherwise "0.1 in the total Lagrangian form, else 1.0";
        /// Quadratic coefficient.
        beta: Option<Given<Number>>, example 4.0, otherwise "10.0 in the total Lagrangian form, else 1.0";
        /// Linear coefficient of the viscosity of shocks along pairs, up to 10, in the total Lagrangian form. It acts in shocks alone.
        shocks: Option<Given<Number>>, example 0.5, otherwise "1.0 in the total Lagrangian form where bodies approach each other, walls or symmetry planes at an eighth of the sound speed and more, 0 below 0.115 of it; where plates meet that are twice as wide as thick (less down to 1.5 times), and do not break, 1.0 from 0.015 of it on, 0 below 0.01; 0 where `alpha` or `beta` are given";
        /// Whether `alpha` acts on all waves in the total Lagrangian form: what oscillates comes to rest.
        all_waves: Option<Flag>, example true, default false;
        /// Balsara's switch: less viscosity in shear.
        balsara: Option<Flag>, example true, default false;
    }

    /// Constants of the artificial stress.
    #[derive(Default)]
    RawArtificialStress {
        /// Strength.
        epsilon: Option<Given<Number>>, example 0.3, default 0.3;
        /// Exponent of the kernel ratio, 1 to 16.
        exponent: Option<Count>, example 4, default 4;
    }

    /// A search strategy with its constants; exactly one.
    RawSearch {
        /// Neighbour lists with a skin, rebuilt when two particles may have approached each other by its thickness.
        skin: Option<RawSkin>;
        /// The neighbours of particles whose plastic strain grows (Fraser), and of those added by the guard, are searched again.
        adaptive: Option<RawAdaptive>;
        /// No search after the start: sums over the initial neighbours.
        total_lagrangian: Option<RawTotalLagrangian>;
    }

    /// Constants of the adaptive search.
    RawAdaptive {
        /// Plastic strain increment above which a particle is searched.
        plastic_strain_threshold: Option<Given<Number>>, example 1e-5, default 1e-5;
        /// Compare the increment since the last search of the particle instead of that of the last step.
        accumulate: Option<Flag>, example true, default false;
        /// Guard for changes that plastic strain does not show: `full`, or `none` for the rule as published.
        guard: Option<Choice<GuardWord>>, example "none", default "full";
        /// Strain since its last search at which the guard searches a particle.
        strain_bound: Option<Given<Number>>, example 0.005, default 0.005;
    }

    /// Constants of the total Lagrangian form.
    RawTotalLagrangian {
        /// Form of the sums. The corrected form leaves out artificial stress, XSPH and density restoration, which belong to
        /// sums over current neighbours, and uses a bulk viscosity with the same constants instead of the pair viscosity.
        form: Option<Choice<FormulationWord>>, example "frozen", default "corrected";
        /// Strength `alpha` of the hourglass springs of the corrected form, at most 4, 0 for none. Bending is right with 1.25, and with 0.4
        /// where `faces = "quadratic"`, which is the default there. The springs soften and yield with the material.
        hourglass: Option<Given<Number>>, example 0.8, default 1.25;
        /// Fields for which gradients of the corrected form are exact at the faces of bodies: `linear` or `quadratic`. With quadratic ones metal that yields in
        /// bending is right with three layers and more, and its pressure does not alternate from layer to layer; a step takes some per cent longer.
        faces: Option<Choice<FaceGradientsWord>>, example "quadratic", default "linear";
        /// Principal stretch at which a body of the corrected form comes apart, 1.1 to 100, or 0 for never; at most 4 where it is liquid: without shear stress,
        /// at its melting temperature, or with the energy of melting. From then on its sums are taken in its current configuration, which is updated whenever it is stretched or compressed by a factor of two: parts without common neighbours are separate pieces.
        renewal: Option<Given<Number>>, example 4.0, default 16.0;
        /// Self-contact of bodies of the corrected form, by the law of the contact between bodies, where parts of the surface meet
        /// that are not neighbours in the reference configuration. Not in a periodic cell or in one dimension.
        self_contact: Option<Flag>, example false, default true;
    }

    /// Constants of the skin.
    RawSkin {
        /// Thickness of the skin over the kernel radius; above 0, at most 1.
        fraction: Option<Given<Number>>, example 0.1, default 0.1;
    }
}
