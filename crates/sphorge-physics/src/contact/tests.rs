//! The contact between bodies by hand, by differences and by its limits.

use super::*;

const STEEL: ContactBody =
    ContactBody { spacing: 1e-3, smoothing_length: 1.2e-3, density: 8000.0, bulk_modulus: 160e9 };
const STRENGTH: ContactStrength = ContactStrength { stiffness: 1.0, damping: 0.5, friction: 0.1 };

#[test]
fn heat_of_a_particle_by_hand() {
    let force = ContactForce { damped: 6.0, rubbed: 8.0, ..ContactForce::<f64>::none() };
    assert_eq!((force.own_heat(0.25), force.own_heat(0.5)), ((5.0, 2.0), (7.0, 4.0)));
}

#[test]
fn a_flat_body_by_hand() {
    // In one dimension, h = 1.2 spacings: w(1/1.2) + w(2/1.2) over 1.2, with the cubic spline.
    let flat = flat_body(Kernel::CubicSpline, Dimension::One, 1.0, 1.2, 1.0);
    let (w1, w2) = (2.0 / 3.0 - 25.0 / 36.0 + 0.5 * 125.0 / 216.0, (1.0f64 / 3.0).powi(3) / 6.0);
    assert!((flat.sum - (w1 + w2) / 1.2).abs() < 1e-14, "{flat:?}");
    // dw/dq = -2 q + 1.5 q^2 at 1/1.2 and -(2 - q)^2/2 at 2/1.2, over h^2.
    let slope = (2.0 / 1.2 - 1.5 / 1.44 + (1.0 / 9.0) / 2.0) / 1.44;
    assert!((flat.slope - slope).abs() < 1e-14, "{} {slope}", flat.slope);
    // Midway between two layers of a body, each half of it gives half of the sum.
    for dimension in [Dimension::One, Dimension::Two, Dimension::Three] {
        let half = flat_body(Kernel::CubicSpline, dimension, 2.0, 2.4, 1.0);
        assert!((half.sum - 0.5).abs() < 5e-3, "{dimension:?} {half:?}");
    }
}

#[test]
fn the_slope_of_a_flat_body_is_that_of_its_sum() {
    for dimension in [Dimension::One, Dimension::Two, Dimension::Three] {
        let at = |gap: f64| flat_body(Kernel::QuinticSpline, dimension, 0.5, 0.6, gap);
        let difference = (at(0.4 - 1e-5).sum - at(0.4 + 1e-5).sum) / 2e-5;
        assert!((at(0.4).slope / difference - 1.0).abs() < 1e-7, "{dimension:?} {difference} {:?}", at(0.4));
    }
}

#[test]
fn two_bodies_press_and_damp_by_the_harmonic_means_of_theirs() {
    // Stacks of layers in one dimension that see each other through several of them, differing in all they can.
    let (kernel, h) = (Kernel::QuinticSpline, 2.0e-3);
    let steel = ContactBody { smoothing_length: 1.8e-3, ..STEEL };
    let copper = ContactBody { spacing: 0.7e-3, smoothing_length: 2.2e-3, density: 8960.0, bulk_modulus: 137e9 };
    let strength = ContactStrength { stiffness: 0.7, damping: 0.3, friction: 0.1 };
    let law = ContactLaw::new(kernel, Dimension::One, &steel, &copper, strength);
    let touching = 0.85e-3;
    let scale = kernel.normalisation(Dimension::One) / Real::powu(h, 3);
    let slope = |r: f64| -scale * kernel.dw_over_q(r / h) * r;
    let pairs = |gap: f64| {
        (0..20).flat_map(move |i| (0..20).map(move |j| (i, j, gap + f64::from(i) * 1e-3 + f64::from(j) * 0.7e-3)))
    };
    let area = 1e-3 * 0.7e-3;
    let shown: f64 = pairs(touching).map(|(_, _, r)| area * slope(r)).sum();
    let impedance = |b: &ContactBody| Real::sqrt(b.density * b.bulk_modulus);
    let (z_a, z_b) = (impedance(&steel), impedance(&copper));
    let critical = Real::sqrt(2.0) * 2.0 / (1.0 / z_a + 1.0 / z_b);
    assert!((law.damping * shown / (0.3 * critical) - 1.0).abs() < 1e-12, "{law:?}");
    // Closed by a ten-thousandth of the mean spacing.
    let gap = touching * (1.0 - 1e-4);
    let closed = |own: i32, spacing: f64, other: f64, inverse: f64| {
        let y = gap + f64::from(own) * spacing;
        flat_body(kernel, Dimension::One, other, h, y).sum * inverse - 1.0
    };
    let of_pair = |(i, j, r): (i32, i32, f64)| {
        let overlaps = (closed(i, 1e-3, 0.7e-3, law.inverse_sums.0), closed(j, 0.7e-3, 1e-3, law.inverse_sums.1));
        area * slope(r) * law.modulus * pair_pressure(&law, overlaps)
    };
    let pressure: f64 = pairs(gap).map(of_pair).sum();
    let expected = 0.7 * 2.0 / (1.0 / 160e9 + 1.0 / 137e9) * 1e-4;
    assert!((pressure / expected - 1.0).abs() < 1e-3, "{pressure:.6e} {expected:.6e}");
}

/// Pressure between two flat stacks of layers in one dimension, and the energy per area.
fn stacks(law: &ContactLaw<f64>, gap: f64) -> (f64, f64) {
    let (kernel, spacing, h) = (Kernel::CubicSpline, STEEL.spacing, STEEL.smoothing_length);
    let layers = |own: usize| gap + own as f64 * spacing;
    let overlap = |own| flat_body(kernel, Dimension::One, spacing, h, layers(own)).sum * law.inverse_sums.0 - 1.0;
    let (mut force, mut energy) = (0.0, 0.0);
    for i in 0..4 {
        let s: f64 = overlap(i);
        energy += 2.0 * spacing * law.modulus * if s > 0.0 { s * s / 2.0 + s.powi(4) / 12.0 } else { 0.0 };
        for j in 0..4 {
            let r = gap + (i + j) as f64 * spacing;
            let weight = -spacing * spacing * kernel.dw_over_q(r / h) * r / h.powi(3);
            let pair = ContactPair {
                x: [r, 0.0, 0.0],
                v: [0.0; 3],
                weight,
                overlaps: (s, overlap(j)),
                direction: [2.0, 0.0, 0.0],
                stopping: 0.0,
            };
            force += contact_force(law, &pair).force[0];
        }
    }
    (force, energy)
}

#[test]
fn surfaces_of_one_body_begin_to_press_a_spacing_apart_with_the_bulk_modulus() {
    let (kernel, spacing, h) = (Kernel::CubicSpline, STEEL.spacing, STEEL.smoothing_length);
    let law = ContactLaw::with_itself(kernel, Dimension::One, &STEEL, STRENGTH);
    let pressure = |gap: f64| {
        let pair = ContactKernel::new(kernel, Dimension::One, gap, h);
        let mut seen = Overlap::before_the_first();
        seen.add(&law, &pair, [gap, 0.0, 0.0], spacing, spacing);
        let (weight, overlaps) = (pair.weight(spacing, spacing), (seen.overlap, seen.overlap));
        let (x, direction) = ([gap, 0.0, 0.0], [2.0, 0.0, 0.0]);
        contact_force(&law, &ContactPair { x, v: [0.0; 3], weight, overlaps, direction, stopping: 0.0 }).force[0]
    };
    assert_eq!(pressure(1.001e-3), 0.0);
    let closed = pressure(1.0e-3 * (1.0 - 1e-4));
    assert!((closed / (160e9 * 1e-4) - 1.0).abs() < 1e-3, "{closed:.6e}");
}

#[test]
fn faces_that_close_press_with_the_bulk_modulus_and_give_back_what_they_store() {
    let law = ContactLaw::new(Kernel::CubicSpline, Dimension::One, &STEEL, &STEEL, STRENGTH);
    assert_eq!(stacks(&law, 1.0e-3).0, 0.0);
    assert_eq!(stacks(&law, 1.1e-3).0, 0.0);
    let pressure = stacks(&law, 1.0e-3 * (1.0 - 1e-4)).0;
    assert!((pressure / (160e9 * 1e-4) - 1.0).abs() < 1e-3, "{pressure:.6e}");
    // Force is minus the slope of the energy, at small and at large overlap; stiffer the deeper.
    let mut last = 0.0;
    for gap in [0.9e-3, 0.6e-3, 0.3e-3, 0.01e-3] {
        let step = 1e-9;
        let slope = (stacks(&law, gap + step).1 - stacks(&law, gap - step).1) / (2.0 * step);
        let pressure = stacks(&law, gap).0;
        assert!((pressure / -slope - 1.0).abs() < 1e-5, "{gap}: {pressure:.6e} {slope:.6e}");
        assert!(pressure > last);
        last = pressure;
    }
    // Closed by a whole spacing it bears the shock of two steel plates at 6 km/s: some 200 GPa.
    assert!(last > 200e9, "{last:.3e}");
}

fn pair() -> ContactPair<f64> {
    ContactPair {
        x: [3.0, 4.0, 0.0],
        v: [2.0, -1.0, 0.0],
        weight: 0.5,
        overlaps: (0.3, -0.2),
        direction: [0.0, 7.0, 0.0],
        stopping: 100.0,
    }
}

const LAW: ContactLaw<f64> = ContactLaw { inverse_sums: (2.0, 5.0), modulus: 10.0, damping: 4.0, friction: 0.25 };

#[test]
fn a_pair_by_hand() {
    let f = contact_force(&LAW, &pair());
    // Elastic 0.5 10 2 0.3 (1 + 0.03) = 3.09 along (0.6, 0.8); damping 0.5 4 1 = 2 along y (fully on at s = 0.2);
    // friction 0.25 (3.09 0.8 + 2) = 1.118 against x.
    assert!((f.force[0] - (3.09 * 0.6 - 1.118)).abs() < 1e-12, "{f:?}");
    assert!((f.force[1] - (3.09 * 0.8 + 2.0)).abs() < 1e-12, "{f:?}");
    assert!((f.stored + 3.09 * (0.6 * 2.0 - 0.8)).abs() < 1e-12);
    assert!((f.damped - 2.0).abs() < 1e-12 && (f.rubbed - 1.118 * 2.0).abs() < 1e-12);
    assert_eq!(f.approach, 1.0);
    // At half the speed half the damping, and a quarter of its power.
    let slower = contact_force(&LAW, &ContactPair { v: [2.0, -0.5, 0.0], ..pair() });
    assert!((slower.force[1] - (3.09 * 0.8 + 1.0)).abs() < 1e-12 && (slower.damped - 0.5).abs() < 1e-12);
    // The powers are those of the force.
    let power = f.force[0] * 2.0 - f.force[1];
    assert!((power + f.stored + f.damped + f.rubbed).abs() < 1e-12);
    // Friction stops, it does not turn round.
    let gentle = contact_force(&LAW, &ContactPair { stopping: 0.1, ..pair() });
    assert!((gentle.force[0] - (3.09 * 0.6 - 0.1 * 2.0)).abs() < 1e-12);
}

#[test]
fn an_overlap_by_hand() {
    // Cubic spline in one dimension, q = 1, h = 2: W = 1/12, -(1/r) dW/dr = 1/16.
    let near = ContactKernel::new(Kernel::CubicSpline, Dimension::One, 2.0, 2.0f64);
    assert!((near.w - 1.0 / 12.0).abs() < 1e-15 && (near.slope - 0.0625).abs() < 1e-15);
    assert!((near.weight(3.0, 4.0) - 1.5).abs() < 1e-14);
    // V_j/S_ab = 0.4 2; then 0.1 2 at a distance of 3: W 0.25, slope 0.5.
    let mut seen = Overlap::before_the_first();
    seen.add(&LAW, &near, [2.0, 0.0, 0.0], 3.0, 0.4);
    let far = ContactKernel { w: 0.25, slope: 0.5, r: 3.0, h: 2.0 };
    seen.add(&LAW, &far, [0.0, -3.0, 0.0], 3.0, 0.1);
    assert!((seen.overlap - (0.8 / 12.0 + 0.05 - 1.0)).abs() < 1e-15);
    assert!((seen.away[0] - 0.1).abs() < 1e-15 && (seen.away[1] + 0.3).abs() < 1e-15);
    assert!((seen.weight - (0.15 + 0.45)).abs() < 1e-15);
}

#[test]
fn what_friction_may_take_by_hand() {
    // 2 6/8 = 1.5 kg, share 0.5/2, in 0.1 s; the larger sum of weights counts.
    assert_eq!(stopping(2.0f64, 6.0, 0.5, (1.0, 2.0), 0.125), 3.0);
    assert_eq!(stopping(6.0f64, 2.0, 0.5, (4.0, 2.0), 0.125), 1.5);
    assert_eq!((stopping(6.0f64, 2.0, 0.0, (0.0, 0.0), 0.1), stopping(6.0f64, 2.0, 0.5, (4.0, 2.0), 0.0)), (0.0, 0.0));
}

#[test]
fn the_stable_step_of_a_contact_by_hand() {
    let kernel = ContactKernel { w: 1.0, slope: 0.5, r: 2.0, h: 4.0 };
    let own = Overlap { overlap: 2.0, away: [0.0, 3.0, 4.0], weight: 0.0 };
    let mut contact = ContactStiffness::default();
    // weight 2 3 0.5 2 = 6; phi' (1) 2 = 8/3, phi'(-1) = 0, so 6 (8/3)/4 = 4; nothing of the neighbour's. Own: 2 5 25 = 250.
    contact.add(&LAW, &kernel, (1.0, -1.0), 2.0, 3.0);
    // One that is apart adds nothing, no damping either.
    contact.add(&LAW, &kernel, (-0.1, -1.0), 2.0, 3.0);
    // K (4 + 250) = 2540, damping 4 6 = 24: 2 2540/520 and 2 24/520.
    let want = oscillator_limit(2.0 * 2540.0 / 520.0, 48.0 / 520.0);
    assert!((contact.limit(&own, 2.0, 520.0) - want).abs() < 1e-14);
    // The neighbour's overlap: 3 phi''(1) (2 0.5 2 5)^2 = 600 and 6 (8/3 + 4/3 5)/4 = 14 on top.
    let mut contact = ContactStiffness::default();
    contact.add(&LAW, &kernel, (1.0, 1.0), 2.0, 3.0);
    let want = oscillator_limit(2.0 * 10.0 * (600.0 + 14.0 + 250.0) / 520.0, 48.0 / 520.0);
    assert!((contact.limit(&own, 2.0, 520.0) - want).abs() < 1e-14);
    // Apart, there is neither.
    let mut apart = ContactStiffness::default();
    apart.add(&LAW, &kernel, (-0.1, -1.0), 2.0, 3.0);
    assert!(apart.limit(&Overlap { overlap: -0.1, ..own }, 2.0, 520.0).is_infinite());
}

#[test]
fn the_other_particle_feels_the_opposite_to_the_bit() {
    let p = pair();
    let mirrored = ContactPair {
        x: p.x.map(|c| -c),
        v: p.v.map(|c| -c),
        overlaps: (p.overlaps.1, p.overlaps.0),
        direction: p.direction.map(|c| -c),
        ..p
    };
    let (f, g) = (contact_force(&LAW, &p), contact_force(&LAW.turned(), &mirrored));
    assert_eq!(f.force, g.force.map(|c| -c));
    assert_eq!((f.stored, f.damped, f.rubbed), (g.stored, g.damped, g.rubbed));
}

#[test]
fn the_order_of_bodies_makes_no_difference_to_the_bit() {
    let copper = ContactBody { spacing: 0.7e-3, smoothing_length: 1.0e-3, density: 8960.0, bulk_modulus: 137e9 };
    for dimension in [Dimension::One, Dimension::Two, Dimension::Three] {
        for kernel in [Kernel::CubicSpline, Kernel::WendlandC2] {
            let law = |a, b| ContactLaw::new(kernel, dimension, a, b, STRENGTH);
            assert_eq!(law(&STEEL, &copper), law(&copper, &STEEL).turned(), "{dimension:?} {kernel:?}");
        }
    }
}

#[test]
fn nothing_pulls() {
    let none = ContactPair { overlaps: (-0.1, 0.0), ..pair() };
    assert_eq!(contact_force(&LAW, &none).force, [0.0; 3]);
    // Bodies that part fast: damping takes the push away, no more.
    let parting = ContactPair { x: [0.0, 5.0, 0.0], v: [0.0, 1e6, 0.0], ..pair() };
    assert_eq!(contact_force(&LAW, &parting).force, [0.0; 3]);
    // Coincident particles, or a direction that is none, push nowhere.
    assert_eq!(contact_force(&LAW, &ContactPair { x: [0.0; 3], ..pair() }).force, [0.0; 3]);
    assert_eq!(contact_force(&LAW, &ContactPair { direction: [0.0; 3], ..pair() }).force, [0.0; 3]);
}
