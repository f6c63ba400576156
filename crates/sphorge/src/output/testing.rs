//! A small model for tests of output and analysis.

use crate::model::{
    Body, Dimensions, Formulation, Lattice, Measure, MeasureKind, Model, Numerics, OutputControl, Search, Shape, Solid,
    TimeControl, Transform,
};

/// Plane-strain model of the given bodies, spacing 0.1 m, h 0.12 m, one second with ten frames and hundred rows.
pub(crate) fn model(bodies: &[&str]) -> Model {
    let body = |name: &&str| Body {
        name: (*name).to_owned(),
        material: 0,
        shape: Shape {
            solid: Solid::Ball { centre: [0.0; 3], radius: 1.0, inner_radius: 0.0 },
            transform: Transform::default(),
        },
        lattice: Lattice::default(),
        spacing: 0.1,
        smoothing_length: 0.12,
        velocity: [0.0; 3],
        spin: [0.0; 3],
        spin_centre: [0.0; 3],
        velocity_gradient: [[0.0; 3]; 3],
        gradient_centre: [0.0; 3],
        velocity_profile: None,
        temperature: 293.15,
    };
    Model {
        title: "A test".into(),
        name: "test".into(),
        dimensions: Dimensions::PlaneStrain,
        spacing: 0.1,
        numerics: Numerics {
            kernel: Default::default(),
            integrator: Default::default(),
            precision: Default::default(),
            pair_form: Default::default(),
            gradient_correction: Default::default(),
            viscosity_alpha: 1.0,
            viscosity_beta: 1.0,
            balsara: false,
            artificial_stress: None,
            xsph: 0.0,
            mls_interval: None,
            energy_split: Default::default(),
            smoothing_length: Default::default(),
            temperature: Default::default(),
        },
        audit: None,
        formulation: Formulation::UpdatedLagrangian,
        search: Search::EveryStep,
        time: TimeControl {
            end: 1.0,
            courant: 0.3,
            max_step: None,
            fixed_step: None,
            stop_kinetic_fraction: None,
            max_steps: None,
        },
        materials: Vec::new(),
        contact: crate::model::BodyContact::Sph,
        thermal: crate::model::Thermal::default(),
        bodies: bodies.iter().map(body).collect(),
        regions: Vec::new(),
        walls: Vec::new(),
        symmetry: Vec::new(),
        periodic: [None; 3],
        motions: Vec::new(),
        gravity: [0.0; 3],
        output: OutputControl {
            frame_interval: 0.1,
            history_interval: 0.01,
            fields: ["id", "body", "velocity", "stress"].map(str::to_owned).into(),
        },
        measures: Vec::new(),
        tracers: Vec::new(),
        sections: Vec::new(),
        warnings: Default::default(),
    }
}

/// [`model`] with one measure, called `m`.
pub(crate) fn measuring(kind: MeasureKind) -> Model {
    Model { measures: vec![Measure { name: "m".into(), kind }], ..model(&["bar", "plate"]) }
}
