use super::*;
use crate::model::{
    Arrangement, Body, BodyContact, Dimensions, Formulation, HeatBoundary, HeatBoundaryKind, Lattice, LatticePlacement,
    NO_HEATING, Numerics, OutputControl, Search, Shape, Solid, SymmetryPlane, Thermal, TimeControl, Transform,
};
use crate::reduction::{FieldSource, Reduction, evaluate as reduce};
use sphorge_physics::{
    eos::EQUATIONS_OF_STATE, flow::FLOW_LAWS, integrity::INTEGRITY, return_mapping::ReturnRule, tensor::identity,
};

/// Density 8000, sound speed 4000, and for `mie-gruneisen` S = 2, Gamma = 1; specific heat 400; reference temperature 300 K.
pub(in crate::reduction) fn material(law: &str) -> Material {
    let law = EQUATIONS_OF_STATE.iter().find(|entry| entry.key == law).unwrap();
    let elastic = FLOW_LAWS.iter().find(|entry| entry.key == "elastic").unwrap();
    Material {
        name: String::new(),
        reference: String::new(),
        density: 8000.0,
        shear_modulus: 80e9,
        equation_of_state: (law.build)(&[8000.0, 4000.0, 2.0, 1.0][..law.parameters.len()]),
        flow_law: (elastic.build)(&[]),
        return_rule: ReturnRule::RadialReturn,
        specific_heat: 400.0,
        conductivity: 0.0,
        taylor_quinney: 0.9,
        spall_pressure: f64::INFINITY,
        spall_opening: 5e-5,
        damage: None,
        reference_temperature: 300.0,
        mass_scaling: 1.0,
    }
}

/// Bodies of one material each, in two dimensions, spacing 1 m.
pub(in crate::reduction) fn model(materials: Vec<Material>) -> Model {
    let body = |material| Body {
        name: String::new(),
        material,
        shape: Shape {
            solid: Solid::Ball { centre: [0.0; 3], radius: 1.0, inner_radius: 0.0 },
            transform: Transform::default(),
        },
        lattice: Lattice { arrangement: Arrangement::Square, placement: LatticePlacement::CellCentres },
        spacing: 1.0,
        smoothing_length: 1.2,
        velocity: [0.0; 3],
        spin: [0.0; 3],
        spin_centre: [0.0; 3],
        velocity_gradient: [[0.0; 3]; 3],
        gradient_centre: [0.0; 3],
        velocity_profile: None,
        radial_velocity: None,
        temperature: 300.0,
    };
    Model {
        title: String::new(),
        name: String::new(),
        dimensions: Dimensions::PlaneStrain,
        spacing: 1.0,
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
        formulation: Formulation::UpdatedLagrangian,
        search: Search::EveryStep,
        audit: None,
        time: TimeControl {
            end: 1.0,
            courant: 0.3,
            max_step: None,
            fixed_step: None,
            step_control: None,
            stop_kinetic_fraction: None,
            max_steps: None,
        },
        bodies: (0..materials.len()).map(body).collect(),
        materials,
        contact: BodyContact::Sph,
        thermal: Thermal::default(),
        regions: Vec::new(),
        walls: Vec::new(),
        symmetry: Vec::new(),
        periodic: [None; 3],
        motions: Vec::new(),
        gravity: [0.0; 3],
        output: OutputControl {
            frame_interval: 1.0,
            history_interval: 1.0,
            fields: Vec::new(),
            is_compressed: true,
            in_pieces: true,
        },
        measures: Vec::new(),
        tracers: Vec::new(),
        sections: Vec::new(),
        warnings: Default::default(),
    }
}

/// Particles at these places, at rest, of mass 8000 and as dense as the material: local spacing 1 m.
fn particles(places: &[[f64; 2]]) -> Particles {
    let mut p = Particles::new(places.len());
    for (i, place) in places.iter().enumerate() {
        // Ids do not follow the order of the columns.
        p.id[i] = (places.len() - 1 - i) as u32;
        p.position[i] = [place[0], place[1], 0.0];
        (p.mass[i], p.density[i], p.temperature[i]) = (8000.0, 8000.0, 300.0);
        p.neighbors[i] = 8;
    }
    p
}

fn find(suspicion: Suspicion, model: &Model, p: &Particles) -> Vec<Suspects> {
    let reduction = Reduction::Suspects(suspicion);
    let found = reduce(&reduction, model, p);
    // An engine that has the particles elsewhere brings those fields alone.
    assert_eq!(found, reduce(&reduction, model, &p.with_fields(&reduction.fields()).unwrap()));
    Suspects::of(&found)
}

/// A row of particles a metre apart.
fn row(count: usize) -> Particles {
    particles(&(0..count).map(|k| [k as f64, 0.0]).collect::<Vec<_>>())
}

#[test]
fn the_coldest_is_named_and_each_body_counts_for_itself() {
    let model = model(vec![material("linear"), material("linear")]);
    let mut p = row(4);
    p.body = vec![0, 1, 1, 1];
    p.temperature = vec![-1.0, -2.0, -5.0, 0.0];
    let found = find(Suspicion::Cold(0.0), &model, &p);
    assert_eq!(found[0], Suspects { particles: 1, suspects: 1, worst: Some((-1.0, 3, [0.0; 3])) });
    assert_eq!(found[1], Suspects { particles: 3, suspects: 2, worst: Some((-5.0, 1, [2.0, 0.0, 0.0])) });
    // Of equals the one with the least id.
    p.temperature[3] = -5.0;
    assert_eq!(find(Suspicion::Cold(0.0), &model, &p)[1].worst.unwrap().1, 0);
    assert_eq!(find(Suspicion::Cold(-9.0), &model, &p)[1], Suspects { particles: 3, suspects: 0, worst: None });
}

#[test]
fn heat_is_held_against_the_energy() {
    let mut model = model(vec![material("linear")]);
    let mut p = row(3);
    // 40 kJ/kg over 400 J/(kg K) is 100 K over the 300 K of the start.
    p.energy = vec![40e3, -1e9, 0.0];
    p.temperature = vec![800.0, 330.0, 299.0];
    let found = find(Suspicion::Hot(1.5), &model, &p);
    assert_eq!((found[0].suspects, found[0].worst.unwrap().0), (1, 2.0));
    let found = find(Suspicion::Hot(1.05), &model, &p);
    assert_eq!(found[0].suspects, 2);
    // What a boundary keeps at 900 K may be as warm, where heat flows.
    let kind = HeatBoundaryKind::HeldTemperature(900.0);
    model.thermal.boundaries = vec![HeatBoundary { name: String::new(), body: None, region: None, normal: None, kind }];
    assert_eq!(find(Suspicion::Hot(1.05), &model, &p)[0].suspects, 2);
    model.thermal.conduction = true;
    assert_eq!(find(Suspicion::Hot(1.05), &model, &p)[0].suspects, 0);
    model.thermal.conduction = false;
    model.materials[0].specific_heat = NO_HEATING;
    assert_eq!(find(Suspicion::Hot(1.05), &model, &p)[0].suspects, 0);
}

#[test]
fn temperature_is_held_against_that_of_the_energy() {
    // S = 2 and Gamma = 1 with c_0 = 4 km/s; 400 J/(kg K), 300 K. A tenth of 50 kJ/kg of plastic work is no heat.
    let mut model = model(vec![material("mie-gruneisen"), material("linear")]);
    let cold = model.materials[0].cold_energies::<f64>();
    for (density, of_energy) in
        [(8000.0, 900.0), (8400.0, 450.0), (9200.0, 700.0), (10400.0, 2000.0), (12000.0, 6000.0)]
    {
        let mut p = row(3);
        p.density = vec![density; 3];
        p.plastic_work = vec![50e3; 3];
        p.energy = vec![cold.of_temperature(density, of_energy) + 5e3; 3];
        p.temperature = vec![400.0, of_energy, 1e4];
        p.material = vec![0, 0, 0];
        let found = find(Suspicion::MissingHeat(1.02), &model, &p)[0];
        assert_eq!((found.suspects, found.worst.unwrap().1), (1, p.id[0]), "{density}");
        let ratio = found.worst.unwrap().0;
        assert!((ratio / (of_energy / 400.0) - 1.0).abs() < 0.02, "{density} {of_energy}: {ratio}");
        // Where heat does not move the pressure, or there is no specific heat, nothing is missing.
        p.material = vec![1, 1, 1];
        assert_eq!(find(Suspicion::MissingHeat(0.0), &model, &p)[0].suspects, 0);
    }
    // In expansion the energy counts in full: (80 - 5)/0.4 K.
    let mut p = row(1);
    (p.density, p.energy, p.plastic_work, p.temperature) = (vec![7000.0], vec![80e3], vec![50e3], vec![300.0]);
    assert_eq!(find(Suspicion::MissingHeat(1.5), &model, &p)[0].worst.unwrap().0, (300.0 + 75.0 / 0.4) / 300.0);
    model.materials[0].specific_heat = NO_HEATING;
    assert_eq!(find(Suspicion::MissingHeat(0.0), &model, &p)[0].suspects, 0);
}

#[test]
fn compression_is_held_against_what_a_shock_reaches() {
    // S = 2: chi = 0.5, twice the density.
    let model = model(vec![material("mie-gruneisen"), material("linear")]);
    let mut p = row(4);
    p.material = vec![0, 0, 1, 1];
    p.body = p.material.clone();
    p.density = vec![8000.0 / 0.45, 8000.0 / 0.55, 8000.0 / 0.45, 8000.0];
    let found = find(Suspicion::Compressed(1.0), &model, &p);
    let worst = found[0].worst.unwrap();
    assert_eq!((found[0].suspects, worst.1, found[1].suspects), (1, 3, 0));
    assert!((worst.0 - 1.1).abs() < 1e-12);
    assert_eq!(find(Suspicion::Compressed(0.5), &model, &p)[1].suspects, 1);
}

#[test]
fn expansion_is_held_against_the_density_at_rest() {
    let model = model(vec![material("linear")]);
    let mut p = row(3);
    p.density = vec![4100.0, 2000.0, 3900.0];
    let found = find(Suspicion::Expanded(0.5), &model, &p);
    assert_eq!((found[0].suspects, found[0].worst.unwrap().0), (2, 0.25));
    // What spalls has cracks in its volume.
    let spalls = Material { spall_pressure: 1e9, ..material("linear") };
    assert_eq!(
        find(Suspicion::Expanded(0.5), &crate::reduction::suspicion::tests::model(vec![spalls]), &p)[0].suspects,
        0
    );
}

#[test]
fn behind_a_symmetry_plane_only_images_can_be() {
    let mut model = model(vec![material("linear")]);
    model.symmetry = vec![
        SymmetryPlane { axis: 1, position: 2.0, side: 1.0 },
        SymmetryPlane { axis: 0, position: 10.0, side: -1.0 },
    ];
    let spacing = model.bodies[0].spacing;
    let p =
        particles(&[[0.0, 2.1], [0.0, 2.0 - 0.4 * spacing], [0.0, 2.0 - 0.6 * spacing], [10.0 + 3.0 * spacing, 5.0]]);
    let found = find(Suspicion::Behind { limit: 0.5, breaks: false }, &model, &p);
    let number = found[0].worst.unwrap().0;
    assert_eq!(found[0].suspects, 2);
    assert!((number - 3.0).abs() < 1e-9, "{number}");
    assert_eq!(
        find(Suspicion::Behind { limit: 0.5, breaks: false }, &Model { symmetry: Vec::new(), ..model.clone() }, &p)[0]
            .suspects,
        0
    );
    // What is severed is there in the place of its image.
    let mut severed = p;
    severed.history.add(&INTEGRITY, &[1.0, 1.0, 1.0, 0.0]);
    let found = find(Suspicion::Behind { limit: 0.5, breaks: true }, &model, &severed);
    assert_eq!((found[0].suspects, found[0].worst.map(|worst| (worst.0 * 10.0).round())), (1, Some(6.0)));
}

#[test]
fn who_is_far_is_so_from_the_box() {
    let model = model(vec![material("linear")]);
    let p = particles(&[[0.5, 0.5], [4.0, 5.0], [-1.5, 0.0], [0.0, 100.0]]);
    let square = |high: [f64; 3]| Suspicion::Away { low: [0.0; 3], high, limit: 2.0 };
    let found = find(square([1.0, 1.0, 0.0]), &model, &p);
    assert_eq!((found[0].suspects, found[0].worst.unwrap().0), (2, 99.0));
    let found = find(square([1.0, f64::INFINITY, 0.0]), &model, &p);
    assert_eq!((found[0].suspects, found[0].worst.unwrap().0), (1, 3.0));
}

#[test]
fn the_lonely_count_where_nothing_can_break() {
    let mut model = model(vec![material("linear"), material("linear")]);
    model.materials[1].spall_pressure = 1e9;
    let mut p = row(4);
    p.neighbors = vec![2, 3, 0, 0];
    (p.body, p.material) = (vec![0, 0, 0, 1], vec![0, 0, 0, 1]);
    let found = find(Suspicion::Lonely, &model, &p);
    assert_eq!((found[0].particles, found[0].suspects, found[0].worst.unwrap().0), (3, 2, 0.0));
    assert_eq!((found[1].particles, found[1].suspects), (0, 0));
    model.dimensions = Dimensions::One;
    p.neighbors[2] = 2;
    assert_eq!(find(Suspicion::Lonely, &model, &p)[0].suspects, 0);
}

#[test]
fn what_is_in_pieces_is_told_from_the_largest() {
    let mut model = model(vec![material("linear"), material("linear")]);
    // Support of two smoothing lengths of 1.2: gaps of 2 hold, of 2.5 do not.
    let mut p = particles(&[[0.0, 0.0], [1.0, 0.0], [9.0, 0.0], [3.0, 0.0], [5.5, 0.0], [6.5, 0.0], [20.0, 0.0]]);
    p.smoothing_length.fill(1.2);
    (p.body, p.material) = (vec![0, 0, 0, 0, 0, 0, 1], vec![0, 0, 0, 0, 0, 0, 1]);
    let found = find(Suspicion::Apart, &model, &p);
    // Three, two and one; of those apart, the two are worse. Of these the one with the lower id.
    assert_eq!((found[0].particles, found[0].suspects), (6, 3));
    assert_eq!(found[0].worst, Some((2.0, 1, [6.5, 0.0, 0.0])));
    assert_eq!((found[1].particles, found[1].suspects), (1, 0));
    // A wider kernel of one of the two holds them.
    p.smoothing_length[4] = 1.3;
    assert_eq!(find(Suspicion::Apart, &model, &p)[0].suspects, 1);
    // Another body between does not.
    p.smoothing_length[4] = 1.2;
    p.position[6][0] = 4.2;
    assert_eq!(find(Suspicion::Apart, &model, &p)[0].suspects, 3);
    model.materials[0].spall_pressure = 1e9;
    assert_eq!(find(Suspicion::Apart, &model, &p)[0].particles, 0);
}

/// Eight by eight particles with these distances along the axes; every second row is moved towards the one below.
fn block(dx: f64, dy: f64, towards: f64) -> Particles {
    let place = |k: usize| [(k % 8) as f64 * dx, (k / 8) as f64 * dy - if k / 8 % 2 == 1 { towards } else { 0.0 }];
    particles(&(0..64).map(place).collect::<Vec<_>>())
}

#[test]
fn rows_that_have_fallen_together_are_pairs() {
    let model = model(vec![material("linear")]);
    let found = find(Suspicion::Paired, &model, &block(1.0, 1.0, 0.55));
    assert_eq!(found[0].suspects, 64);
    assert!((found[0].worst.unwrap().0 - 0.45).abs() < 1e-12);
    // Not yet.
    assert_eq!(find(Suspicion::Paired, &model, &block(1.0, 1.0, 0.15))[0].suspects, 0);
}

#[test]
fn a_lattice_that_has_flowed_is_no_pair() {
    let model = model(vec![material("linear")]);
    // Flattened to 0.4 of its height at constant volume: near neighbours on both sides.
    assert_eq!(find(Suspicion::Paired, &model, &block(2.5, 0.4, 0.0))[0].suspects, 0);
    // Compressed fourfold in area: the spacing is what the density says.
    let mut p = block(0.5, 0.5, 0.0);
    p.density.fill(4.0 * 8000.0);
    assert_eq!(find(Suspicion::Paired, &model, &p)[0].suspects, 0);
    // Rows that are nearer by twos, but at 0.82 of the spacing that the density says.
    let mut p = block(0.6, 0.505, 0.095);
    p.density.fill(4.0 * 8000.0);
    assert_eq!(find(Suspicion::Paired, &model, &p)[0].suspects, 0);
    // Rows that fall together in it are still seen.
    let mut p = block(0.5, 0.5, 0.275);
    p.density.fill(4.0 * 8000.0);
    assert_eq!(find(Suspicion::Paired, &model, &p)[0].suspects, 64);
}

#[test]
fn a_zone_of_pairs_in_tension_tears_and_nothing_else_does() {
    let broken = model(vec![material("linear")]);
    let torn = |model: &Model, p: &Particles| find(Suspicion::Torn, model, p)[0].suspects;
    let mut p = block(1.0, 1.0, 0.55);
    p.pressure.fill(-1e6);
    assert_eq!(torn(&broken, &p), 64);
    // A pair is in tension by the mean of its two.
    for (i, pressure) in p.pressure.iter_mut().enumerate() {
        *pressure = if p.position[i][1] == 0.0 { 0.9e6 } else { -1e6 };
    }
    assert_eq!(torn(&broken, &p), 64);
    // Laid on each other by compression.
    p.pressure.fill(1e6);
    assert_eq!(torn(&broken, &p), 0);
    // Pairs here and there: those below y = 2.5 alone are in tension, and only the lowest have more than 40 % of their like around.
    for (i, pressure) in p.pressure.iter_mut().enumerate() {
        *pressure = if p.position[i][1] < 1.0 && p.position[i][0] < 2.5 { -1e6 } else { 1e6 };
    }
    let few = find(Suspicion::Torn, &broken, &p)[0];
    assert!(few.suspects < 6 && few.particles == 64, "{few:?}");
    // What may break is not looked at.
    let spalls = Material { spall_pressure: 1e9, ..material("linear") };
    p.pressure.fill(-1e6);
    assert_eq!(find(Suspicion::Torn, &model(vec![spalls]), &p)[0], Suspects { particles: 0, suspects: 0, worst: None });
}

#[test]
fn pieces_are_those_of_all_pairs() {
    let model = model(vec![material("linear"), material("linear")]);
    let mut random = 1u64;
    let mut next = |below: u64| {
        random = random.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (random >> 33) % below
    };
    // From sparse dust, in which nearly all are alone, to one piece.
    for width in [6, 12, 18, 24, 40, 90] {
        let places: Vec<_> =
            (0..150).map(|_| [next(10 * width) as f64 / 10.0, next(10 * width) as f64 / 10.0]).collect();
        let mut p = particles(&places);
        p.smoothing_length.fill(1.2);
        p.body = (0..150).map(|_| next(2) as u32).collect();
        p.material.clone_from(&p.body);
        let mut piece: Vec<usize> = (0..150).collect();
        for _ in 0..150 {
            for (i, j) in (0..150).flat_map(|i| (0..150).map(move |j| (i, j))) {
                let [x, y] = [0, 1].map(|a| p.position[i][a] - p.position[j][a]);
                if p.body[i] == p.body[j] && x.hypot(y) < 2.4 {
                    piece[i] = piece[i].min(piece[j]);
                }
            }
        }
        let of_body = |body: u32| {
            let size = |of: usize| piece.iter().filter(|piece| **piece == of).count() as u64;
            let sizes = (0..150).filter(|&i| p.body[i] == body && piece[i] == i).map(size);
            let particles = p.body.iter().filter(|of| **of == body).count() as u64;
            (particles, particles - sizes.max().unwrap())
        };
        let found = find(Suspicion::Apart, &model, &p);
        let found = [0, 1].map(|body| (found[body].particles, found[body].suspects));
        assert_eq!(found, [of_body(0), of_body(1)], "{width}");
    }
}

#[test]
fn only_particles_of_one_body_that_choose_each_other_pair() {
    let model = model(vec![material("linear"), material("linear")]);
    let mut p = particles(&[[0.0, 0.0], [0.4, 0.0], [9.0, 0.0], [9.4, 0.0]]);
    p.body = vec![0, 1, 0, 0];
    let found = find(Suspicion::Paired, &model, &p);
    assert_eq!((found[0].suspects, found[1].suspects), (2, 0));
    // Three in a row: the middle one has one on either side.
    let p = particles(&[[0.0, 0.0], [0.4, 0.0], [0.85, 0.0]]);
    assert_eq!(find(Suspicion::Paired, &model, &p)[0].suspects, 0);
}

#[test]
fn any_number_of_threads_finds_the_same() {
    let model = model(vec![material("linear")]);
    let mut p = row(3 * CHUNK + 5);
    for i in 0..p.len() {
        p.temperature[i] = -((i * 7919 % 97) as f64);
    }
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| reduce(&Reduction::Suspects(Suspicion::Cold(-3.0)), &model, &p))
    };
    assert_eq!(with(1), with(4));
    assert_eq!(with(1)[2], -96.0);
}

/// Two blocks side by side, four by four particles each with a spacing of one; the second is moved along x by this.
fn two_blocks(apart: f64) -> Particles {
    let place = |k: usize| [(k % 4) as f64, (k / 4 % 4) as f64];
    let second = |k: usize| [4.0 + apart + place(k)[0], place(k)[1]];
    let mut p = particles(&(0..16).map(place).chain((0..16).map(second)).collect::<Vec<_>>());
    p.body = (0..32).map(|k| k / 16).collect();
    p.deformation = vec![identity(); 32];
    p
}

#[test]
fn what_lies_in_cells_of_another_body_is_inside() {
    let model = model(vec![material("linear"), material("linear")]);
    let inside = |p: &Particles| {
        let found = find(Suspicion::Inside { faces: true, breaks: false }, &model, p);
        [0, 1].map(|body| (found[body].suspects, found[body].worst.map(|worst| worst.0)))
    };
    // Faces that press each other as deep as 0.45 spacings.
    assert_eq!(inside(&two_blocks(0.0)), [(0, None); 2]);
    assert_eq!(inside(&two_blocks(-0.45)), [(0, None); 2]);
    // The first layer of each is inside, 0.4 spacings from the centre of the other's: a fifth of the way from the face to the centre.
    let [first, second] = inside(&two_blocks(-0.6));
    assert_eq!((first.0, second.0), (4, 4));
    assert!((first.1.unwrap() - 0.2).abs() < 1e-12 && (second.1.unwrap() - 0.2).abs() < 1e-12);
    assert_eq!(inside(&two_blocks(-3.0)).map(|found| found.0), [12, 12]);
    assert_eq!(inside(&two_blocks(-4.0)).map(|found| found.0), [16, 16]);
    // Where outermost layers are known they alone may be in each other.
    let outermost = |mut p: Particles| {
        let is_at_face = |i: &usize| i % 4 == if *i < 16 { 3 } else { 0 };
        p.reference_normal = (0..32).map(|i| if is_at_face(&i) { [1.0, 0.0, 0.0] } else { [0.0; 3] }).collect();
        p
    };
    assert_eq!(inside(&outermost(two_blocks(-0.6))), [(0, None); 2]);
    assert_eq!(inside(&outermost(two_blocks(-1.6))).map(|found| found.0), [8, 8]);
    // Cells are as their deformation has made them: flat ones of the second block do not reach so far, long ones reach farther.
    let mut p = two_blocks(-0.6);
    p.deformation[16..].fill([[0.5, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]]);
    assert_eq!(inside(&p).map(|found| found.0), [0, 4]);
    let mut p = two_blocks(-0.45);
    p.deformation[16..].fill([[2.0, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 1.0]]);
    assert_eq!(inside(&p).map(|found| found.0), [4, 0]);
    // What has come apart has no cells any more, but still can be in those of others.
    let mut p = two_blocks(-0.6);
    p.earlier_deformation = vec![identity(); 32];
    assert_eq!(inside(&p).map(|found| found.0), [4, 4]);
    p.earlier_deformation[20][0][1] = 0.1;
    assert_eq!(inside(&p).map(|found| found.0), [0, 4]);
    // A body of one column, whose box has no width.
    let mut p = two_blocks(-2.4);
    p.body[16..].iter_mut().enumerate().for_each(|(k, body)| *body = u32::from(k % 4 == 0));
    assert_eq!(inside(&p)[1].0, 4);
    // Without cells nothing is known.
    p.deformation.clear();
    assert_eq!(inside(&p), [(0, None); 2]);
}
