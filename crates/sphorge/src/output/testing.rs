//! A small model for tests of output and analysis.

use super::{EndReason, EnergyRecord, MemoryOf, StageSecondsRecord, Status, Summary, WarningRecord};
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
        radial_velocity: None,
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
            viscosity_of_shocks: 0.0,
            viscosity_of_all_waves: false,
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
            step_control: None,
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
            is_compressed: true,
            in_pieces: true,
        },
        measures: Vec::new(),
        tracers: Vec::new(),
        sections: Vec::new(),
        warnings: Default::default(),
    }
}

/// Summary of a run of so many seconds.
pub(crate) fn summary(seconds: f64) -> Summary {
    Summary {
        format: Summary::FORMAT,
        status: Status::Completed,
        end_reason: EndReason::EndTime,
        stopped_by: None,
        driven: None,
        peak_memory_of: MemoryOf::Process,
        failure: None,
        title: "A test".into(),
        deck: "test".into(),
        version: "0.1.0".into(),
        particles: 1000,
        bodies: Vec::new(),
        steps: 50,
        repeated_steps: 0,
        simulated_time: 6e-5,
        wall_seconds: seconds,
        ranks: 1,
        rank_imbalance: 1.0,
        rank_waiting_seconds: StageSecondsRecord::default(),
        threads: 2,
        engine: "cpu".into(),
        device: None,
        precision: "mixed".into(),
        stage_seconds: StageSecondsRecord { search: 0.1 * seconds, ..Default::default() },
        mean_neighbors: 17.5,
        particle_steps_per_second: 5e4 / seconds,
        pairs_per_second: 1e6,
        searched_fraction: 0.25,
        peak_memory_bytes: 10 << 20,
        engine_memory_bytes: 900_000,
        energy: EnergyRecord { relative_drift: -1e-9, ..Default::default() },
        momentum_drift: 1e-12,
        largest_momentum_drift: 1e-12,
        audit: None,
        warnings: Vec::new(),
        measures: Default::default(),
        measure_units: Default::default(),
        units: Default::default(),
    }
}

/// A warning of a check of this name.
pub(crate) fn warning(name: &str) -> WarningRecord {
    WarningRecord {
        name: name.into(),
        meaning: "a number".into(),
        value: 2.0,
        value_time: 3e-6,
        limit: 1.0,
        unit: String::new(),
        step: 7,
        time: 2e-6,
        particle: Some(5),
        body: Some("bar".into()),
        position: Some([0.0; 3]),
        cure: "a cure".into(),
    }
}

/// [`model`] with one measure, called `m`.
pub(crate) fn measuring(kind: MeasureKind) -> Model {
    Model { measures: vec![Measure { name: "m".into(), kind }], ..model(&["bar", "plate"]) }
}
