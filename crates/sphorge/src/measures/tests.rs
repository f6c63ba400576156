//! Every kind of measure on particles placed by hand.

use super::*;
use crate::{
    model::{
        CloudExtent, CraterEdge, Dimensions, ParticleSelection, Perforation, Shape, Solid, SymmetryPlane, Transform,
    },
    output::testing::measuring,
};

/// A plane-strain lattice of spacing 0.1, `nx` by `ny`, all of body 0.
fn lattice(nx: usize, ny: usize) -> Particles {
    let mut particles = Particles::new(nx * ny);
    for i in 0..nx * ny {
        particles.position[i] = [0.1 * (i % nx) as f64, 0.1 * (i / nx) as f64, 0.0];
        particles.mass[i] = 2.0;
        particles.density[i] = 200.0;
        particles.smoothing_length[i] = 0.12;
    }
    particles
}

fn once(kind: MeasureKind, particles: &Particles) -> Option<f64> {
    let model = measuring(kind);
    let mut measures = Measures::new(&model);
    measures.sample(&model, 0.0, &(&model, particles)).unwrap();
    measures.values()[0]
}

fn close(value: Option<f64>, expected: f64) {
    let value = value.expect("a value");
    assert!((value - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{value} is not {expected}");
}

#[test]
fn the_extent_goes_half_a_spacing_beyond_the_centres() {
    let mut particles = lattice(4, 7);
    let extent = |selection: ParticleSelection| MeasureKind::Extent { selection, axis: 1 };
    close(once(extent(ParticleSelection::default()), &particles), 0.7);
    // The top row belongs to the other body, the row below to a region.
    particles.body[24..].fill(1);
    particles.regions[20..24].fill(0b100);
    close(once(extent(ParticleSelection { body: Some(0), ..ParticleSelection::default() }), &particles), 0.6);
    close(once(extent(ParticleSelection { region: Some(2), ..ParticleSelection::default() }), &particles), 0.1);
    let window = Some(([-1.0, 0.15, -1.0], [1.0, 0.45, 1.0]));
    close(once(extent(ParticleSelection { window, ..ParticleSelection::default() }), &particles), 0.3);
    assert_eq!(once(extent(ParticleSelection { region: Some(3), ..ParticleSelection::default() }), &particles), None);
}

#[test]
fn extent_takes_half_the_spacing_of_each_end() {
    let mut particles = lattice(1, 5);
    particles.body[4] = 1;
    let mut model = measuring(MeasureKind::Extent { selection: ParticleSelection::default(), axis: 1 });
    model.bodies[1].spacing = 0.3;
    let mut measures = Measures::new(&model);
    measures.sample(&model, 0.0, &(&model, &particles)).unwrap();
    close(measures.values()[0], 0.4 + 0.05 + 0.15);
}

#[test]
fn diameter_is_about_the_mean_or_the_symmetry_plane() {
    let kind = MeasureKind::Diameter { selection: ParticleSelection::default(), axis: 1 };
    let particles = lattice(6, 3);
    close(once(kind.clone(), &particles), 0.6);
    // Of a section of the plane: from corner to corner of the centres, sqrt(0.5^2 + 0.2^2), and a spacing.
    let section = MeasureKind::Diameter { selection: ParticleSelection::default(), axis: 2 };
    close(once(section, &particles), 0.29f64.sqrt() + 0.1);
    let mut model = measuring(kind);
    model.symmetry = vec![SymmetryPlane { axis: 0, position: -0.05, side: 1.0 }];
    let mut measures = Measures::new(&model);
    measures.sample(&model, 0.0, &(&model, &particles)).unwrap();
    close(measures.values()[0], 1.2);
}

#[test]
fn extremes_now_and_over_time() {
    let mut particles = lattice(2, 2);
    let kind = |extremum, over_time, component| MeasureKind::Extreme {
        selection: ParticleSelection::default(),
        field: "velocity".into(),
        component,
        extremum,
        over_time,
    };
    particles.velocity = vec![[3.0, -4.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0], [0.5, 0.5, 0.5]];
    close(once(kind(Extremum::Maximum, false, None), &particles), 5.0);
    close(once(kind(Extremum::Minimum, false, Some(1)), &particles), -4.0);
    assert_eq!(once(kind(Extremum::Maximum, false, Some(3)), &particles), None);

    for (over_time, expected) in [(true, 3.0), (false, 2.0)] {
        let model = measuring(kind(Extremum::Maximum, over_time, Some(0)));
        let mut measures = Measures::new(&model);
        measures.sample(&model, 0.0, &(&model, &particles)).unwrap();
        let mut later = particles.clone();
        later.velocity[0] = [-9.0; 3];
        measures.sample(&model, 1.0, &(&model, &later)).unwrap();
        close(measures.values()[0], expected);
    }
}

#[test]
fn mean_is_weighted_by_mass() {
    let mut particles = lattice(2, 1);
    particles.mass = vec![1.0, 3.0];
    particles.temperature = vec![300.0, 400.0];
    let kind =
        MeasureKind::Mean { selection: ParticleSelection::default(), field: "temperature".into(), component: None };
    close(once(kind, &particles), 375.0);
}

#[test]
fn value_at_a_point_is_exact_for_a_constant_and_symmetric_for_a_line() {
    let mut particles = lattice(9, 9);
    let kind = |field: &str, point| MeasureKind::Value {
        selection: ParticleSelection::default(),
        field: field.into(),
        component: None,
        point,
    };
    particles.pressure.fill(7.0);
    for i in 0..81 {
        particles.temperature[i] = 300.0 + particles.position[i][0];
    }
    // Particles of different size still reproduce a constant.
    particles.smoothing_length[40] = 0.2;
    particles.mass[40] = 5.0;
    close(once(kind("pressure", [0.433, 0.21, 0.0]), &particles), 7.0);
    close(once(kind("temperature", [0.4, 0.4, 0.0]), &particles), 300.4);
    assert_eq!(once(kind("pressure", [3.0, 0.0, 0.0]), &particles), None);
}

#[test]
fn value_at_a_point_against_two_particles_by_hand() {
    let mut particles = lattice(2, 1);
    particles.pressure = vec![10.0, 40.0];
    // q = 0.25 and 0.75 of h = 0.1: cubic spline 1 - 1.5 q² + 0.75 q³.
    particles.smoothing_length.fill(0.1);
    particles.density = vec![200.0, 100.0];
    let (w0, w1) = (1.0 - 1.5 * 0.0625 + 0.75 * 0.015625, 1.0 - 1.5 * 0.5625 + 0.75 * 0.421875);
    let expected = (10.0 * w0 + 40.0 * 2.0 * w1) / (w0 + 2.0 * w1);
    let kind = MeasureKind::Value {
        selection: ParticleSelection::default(),
        field: "pressure".into(),
        component: None,
        point: [0.025, 0.0, 0.0],
    };
    close(once(kind, &particles), expected);
}

/// Speed measured of a pressure front that runs at 2 m/s from `x = 5` in either direction through a bar of 10 m.
fn front_speed(direction: f64, window: (f64, f64), level: f64, until: f64) -> Option<f64> {
    let mut particles = lattice(100, 3);
    let kind = MeasureKind::FrontSpeed {
        selection: ParticleSelection::default(),
        field: "pressure".into(),
        component: None,
        axis: 0,
        level,
        direction,
        window,
    };
    let model = measuring(kind);
    let mut measures = Measures::new(&model);
    let mut t = 0.0;
    while t <= until {
        for i in 0..particles.len() {
            // A ramp two spacings wide; a release from the far end follows the front.
            let behind = 2.0 * t - (particles.position[i][0] - 5.0).abs();
            let plateau = (behind / 0.2).clamp(0.0, 1.0);
            particles.pressure[i] = if behind > 1.5 { 0.0 } else { 100.0 * plateau };
        }
        measures.sample(&model, t, &(&model, &particles)).unwrap();
        t += 0.05;
    }
    measures.values()[0]
}

#[test]
fn front_speed_of_a_running_front() {
    for (direction, level) in [(1.0, 50.0), (-1.0, 50.0), (1.0, 10.0)] {
        let speed = front_speed(direction, (0.3, 2.0), level, 2.0).unwrap();
        assert!((speed - 2.0).abs() < 0.01, "{speed}");
    }
    // After the front has left at t = 2.5 the release behind it must not be taken for it.
    let speed = front_speed(1.0, (0.3, 9.0), 50.0, 4.0).unwrap();
    assert!((speed - 2.0).abs() < 0.01, "{speed}");
    assert_eq!(front_speed(1.0, (0.3, 2.0), 500.0, 2.0), None);
}

#[test]
fn period_and_reversal_of_a_swinging_body() {
    let selection = ParticleSelection { body: Some(0), ..ParticleSelection::default() };
    let kinds = [
        MeasureKind::Period { selection: selection.clone(), field: "position".into(), component: Some(0) },
        MeasureKind::ReversalTime { selection, axis: 0 },
    ];
    for (kind, expected) in kinds.into_iter().zip([0.8, 0.2]) {
        let model = measuring(kind);
        let mut measures = Measures::new(&model);
        let mut particles = lattice(3, 1);
        for k in 0..=300 {
            let t = 0.01 * f64::from(k);
            let phase = std::f64::consts::TAU * t / 0.8;
            for i in 0..3 {
                particles.position[i][0] = 0.1 * i as f64 + 0.02 * phase.sin();
                particles.velocity[i][0] = phase.cos();
            }
            measures.sample(&model, t, &(&model, &particles)).unwrap();
        }
        let value = measures.values()[0].unwrap();
        assert!((value - expected).abs() < 2e-3, "{value} {expected}");
    }
}

/// A plate of two rows from x = -2 to 2, y = -0.1 to 0.1, with a hole between -0.6 and 0.5, a lip of three particles upwards at
/// either edge of it, and debris of both bodies below; flight along -y.
fn perforated() -> (Model, Particles, Perforation) {
    let mut places = Vec::new();
    for i in 0..40 {
        let x = -1.95 + 0.1 * f64::from(i);
        if !(-0.6..=0.5).contains(&x) {
            places.extend([[x, -0.05], [x, 0.05]]);
        }
    }
    for k in 1..=3 {
        let k = f64::from(k);
        places.extend([[-0.65 - 0.02 * k, 0.05 + 0.1 * k], [0.55 + 0.04 * k, 0.05 + 0.1 * k]]);
    }
    let plate = places.len();
    // Plate debris in the hole and behind it, debris of the other body, one far away.
    places.extend([[0.0, 0.0], [0.3, -0.5], [-0.4, -0.7], [0.1, -1.0], [0.0, -3.0]]);
    let mut particles = Particles::new(places.len());
    for (i, place) in places.iter().enumerate() {
        particles.position[i] = [place[0], place[1], 0.0];
        particles.mass[i] = 1.0;
        particles.body[i] = u32::from(i >= plate + 3);
    }
    let perforation = Perforation { plate: 0, axis: 1, direction: -1.0, point: [0.0; 3], link: 1.5 };
    let mut model = measuring(MeasureKind::ReversalTime { selection: ParticleSelection::default(), axis: 0 });
    let solid = Solid::Box { min: [-2.0, -0.1, 0.0], max: [2.0, 0.1, 0.0] };
    model.bodies[0].shape = Shape { solid, transform: Transform::default() };
    (model, particles, perforation)
}

fn of_perforated(kind: impl Fn(Perforation) -> MeasureKind) -> Option<f64> {
    let (mut model, particles, perforation) = perforated();
    model.measures[0].kind = kind(perforation);
    let mut measures = Measures::new(&model);
    measures.sample(&model, 0.0, &(&model, &particles)).unwrap();
    measures.values()[0]
}

#[test]
fn a_crater_is_clear_between_its_edges_or_goes_from_lip_to_lip() {
    let crater = |edge| of_perforated(|perforation| MeasureKind::CraterDiameter { perforation, edge });
    // Outermost particles at -0.65 and 0.55, half a spacing of 0.1 clear of each; debris in the hole does not count.
    close(crater(CraterEdge::Clear), 0.6 + 0.5);
    close(crater(CraterEdge::EntryLips), 0.71 + 0.67);
    assert_eq!(crater(CraterEdge::ExitLips), None);
}

/// The clear opening about lines of flight along z through a plate of particles at these places, z = 0.
fn clear_opening(dimensions: Dimensions, places: &[[f64; 2]], point: [f64; 2]) -> Option<f64> {
    let mut particles = Particles::new(places.len());
    let axis = if dimensions == Dimensions::Three { 2 } else { 1 };
    for (i, place) in places.iter().enumerate() {
        particles.position[i][..axis].copy_from_slice(&place[..axis]);
        particles.mass[i] = 1.0;
    }
    let perforation = Perforation { plate: 0, axis, direction: -1.0, point: [point[0], point[1], 0.0], link: 2.0 };
    let mut model = measuring(MeasureKind::CraterDiameter { perforation, edge: CraterEdge::Clear });
    model.dimensions = dimensions;
    let solid = Solid::Box { min: [-2.0, -2.0, -0.05], max: [2.0, 2.0, 0.05] };
    model.bodies[0].shape = Shape { solid, transform: Transform::default() };
    let mut measures = Measures::new(&model);
    measures.sample(&model, 0.0, &(&model, &particles)).unwrap();
    measures.values()[0]
}

#[test]
fn a_plate_without_a_hole_has_a_crater_of_zero() {
    let at = |k: i32| 0.1 * f64::from(k) + 0.05;
    let plate: Vec<[f64; 2]> = (-20..20).flat_map(|i| (-20..20).map(move |j| [at(i), at(j)])).collect();
    // In the corner of four particles, on one, on an edge, anywhere.
    for point in [[0.0, 0.0], [0.05, 0.05], [0.1, 0.05], [0.013, -0.021]] {
        assert_eq!(clear_opening(Dimensions::Three, &plate, point), Some(0.0), "{point:?}");
        close(clear_opening(Dimensions::PlaneStrain, &plate, point), 0.0);
    }
}

#[test]
fn a_hole_in_space_is_as_wide_as_rays_are_free() {
    let ring = |count: u32| {
        let angle = move |k: u32| (f64::from(k) + 0.5) / f64::from(count) * std::f64::consts::TAU;
        (0..count).map(|k| [angle(k).cos(), angle(k).sin()]).collect::<Vec<_>>()
    };
    // A particle in the middle of every sector ends its ray half a diagonal of its cell before its centre; six of them all.
    let corner = 0.05 * 2f64.sqrt();
    for places in [ring(36), ring(36 * 3), ring(36 * 3 * 5)] {
        let found = clear_opening(Dimensions::Three, &places, [0.0, 0.0]).unwrap();
        assert!((found - 2.0 * (1.0 - corner)).abs() < 1e-6, "{found}");
    }
    // A quarter knows the rest.
    let quarter: Vec<_> = ring(36 * 3).into_iter().filter(|p| p[0] > 0.0 && p[1] > 0.0).collect();
    let found = clear_opening(Dimensions::Three, &quarter, [0.0, 0.0]).unwrap();
    assert!((found - 2.0 * (1.0 - corner)).abs() < 1e-6, "{found}");
}

#[test]
fn a_cloud_is_what_flies_behind_the_plate() {
    let cloud = |extent, leave_out| of_perforated(|perforation| MeasureKind::Cloud { perforation, extent, leave_out });
    close(cloud(CloudExtent::Length, 0.0), 3.0 + 0.05 - 0.1);
    // A quarter of four particles is one.
    close(cloud(CloudExtent::Length, 0.25), 1.0 + 0.05 - 0.1);
    close(cloud(CloudExtent::Width, 0.0), 0.35 + 0.45);
}

#[test]
fn pieces_of_a_plate_hang_together_in_space_too() {
    // A row of 20 along z, 0.1 apart, a gap of 0.2, a fragment of two, which is a tenth of 22 less a bit: debris.
    let mut particles = Particles::new(22);
    for i in 0..22 {
        let z = 0.1 * i as f64 + if i >= 20 { 0.1 } else { 0.0 };
        particles.position[i] = [0.3, -0.2, z - 1.0];
        particles.mass[i] = 1.0;
    }
    let mut model = measuring(MeasureKind::ReversalTime { selection: ParticleSelection::default(), axis: 0 });
    model.dimensions = crate::model::Dimensions::Three;
    let left = remains(&model, &particles, 0, 0.15, |_| true);
    assert_eq!(left.iter().filter(|l| **l).count(), 20);
    assert!(remains(&model, &particles, 0, 0.21, |_| true).iter().all(|l| *l));
    assert!(remains(&model, &particles, 1, 0.21, |_| true).iter().all(|l| !l));
    // The row ends at 0.9: it flies off where the plate stands beyond.
    assert_eq!(remains(&model, &particles, 0, 0.15, |x| x[2] > 0.85).iter().filter(|l| **l).count(), 20);
    assert!(remains(&model, &particles, 0, 0.15, |x| x[2] > 0.95).iter().all(|l| !l));
}

/// Two bars of a metal that breaks.
const BARS: &str = r#"
dimensions = "plane-strain"
particles = { spacing = "100 mm" }
time = { end = "1 us" }

[material.iron]
base = "armco-iron"
spall-pressure = "1 GPa"

[[body]]
name = "bar"
material = "iron"
shape = { box = { min = [0, 0], max = ["2 m", "0.4 m"] } }

[[body]]
name = "other"
material = "iron"
shape = { box = { min = ["5 m", 0], max = ["6 m", "1 m"] } }

[[measure]]
name = "pieces"
fragments = { body = "bar" }
"#;

#[test]
fn fragments_hang_together_over_particles_with_integrity() {
    // A bar of 20 by 4 without the last four: columns 7 and 8 are severed, and at the other end what cuts off five particles.
    let mut particles = lattice(20, 4);
    particles.body[76..].fill(1);
    let severed = |i: usize| [7, 8].contains(&(i % 20)) || [37, 38, 17, 16].contains(&i) && i % 20 > 15 || i == 57;
    let integrity: Vec<f64> = (0..80).map(|i| if severed(i) { 0.0 } else { 0.01 }).collect();
    particles.set_column("integrity", &crate::particles::Column::Scalar(integrity.into()));
    let of = |quantity: &str, link: f64, least: u64| {
        let changes = [("of", quantity.to_owned()), ("link", link.to_string()), ("least", least.to_string())];
        let changes: Vec<_> =
            changes.into_iter().map(|(key, value)| (format!("measure.0.fragments.{key}"), value)).collect();
        let setup = crate::deck::load_text("bars", BARS, &changes).unwrap_or_else(|report| panic!("{report:?}"));
        let mut measures = Measures::new(&setup.model);
        measures.sample(&setup.model, 0.0, &(&setup.model, &particles)).unwrap();
        measures.values()[0]
    };
    let pieces = |link: f64, least: u64| of("number", link, least).unwrap();
    // By straight neighbours alone: 28 on the left, 30 on the right, the five, and 13 that are severed.
    let sizes = ["largest", "second", "loose"].map(|quantity| of(quantity, 1.05, 6).unwrap() / 2.0);
    assert_eq!(sizes, [30.0, 28.0, 18.0]);
    assert_eq!([1, 5, 6].map(|least| pieces(1.05, least)), [3.0, 3.0, 2.0]);
    // Far enough all hang together, and few are no fragment.
    assert_eq!((pieces(3.2, 1), pieces(1.05, 1000)), (1.0, 0.0));
    close(of("loose", 1.05, 1000), 152.0);
}

#[test]
fn a_bar_that_is_drawn_out_is_one_fragment() {
    // Three times as long: as distances go, each column is a fragment.
    let mut particles = lattice(20, 4);
    particles.body[76..].fill(1);
    particles.position.iter_mut().for_each(|x| x[0] *= 3.0);
    let pieces = |particles: &Particles| {
        let setup = crate::deck::load_text("bars", BARS, &[("measure.0.fragments.least".into(), "4".into())]).unwrap();
        let mut measures = Measures::new(&setup.model);
        measures.sample(&setup.model, 0.0, &(&setup.model, particles)).unwrap();
        measures.values()[0].unwrap()
    };
    assert_eq!(pieces(&particles), 16.0);
    let drawn_out = [[3.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    particles.deformation = vec![drawn_out; particles.len()];
    assert_eq!(pieces(&particles), 1.0);
}
