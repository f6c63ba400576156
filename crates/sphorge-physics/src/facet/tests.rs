use super::*;
use crate::tensor::identity;

pub(super) const LAW: FacetPairLaw<f64> = FacetPairLaw {
    stiffness: 1.0,
    damping: 0.3,
    friction: 0.3,
    tangential_stiffness: 0.5,
    gives_way: 0.0,
    coincidence: 0.0,
};

/// A number between -1 and 1, another one each time.
pub(super) fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 33) as f64 / (1u64 << 30) as f64 - 1.0
}

/// The square face of a cube of this spacing around its owner, looking along y to `side`.
fn square(spacing: f64, side: f64) -> ReferenceFacet<f64> {
    let h = 0.5 * spacing;
    let y = side * h;
    let corners = if side > 0.0 {
        [[-h, y, -h], [-h, y, h], [h, y, h], [h, y, -h]]
    } else {
        [[-h, y, -h], [h, y, -h], [h, y, h], [-h, y, h]]
    };
    ReferenceFacet::flat(corners, [0.0, side, 0.0])
}

fn triangle(spacing: f64, side: f64) -> ReferenceFacet<f64> {
    let whole = square(spacing, side);
    let [a, b, c, _] = whole.corners;
    let mean = [0, 1, 2].map(|i| (a[i] + b[i] + c[i]) / 3.0);
    ReferenceFacet { corners: [a, b, c, c], middle: mean, ..whole }
}

fn strip(spacing: f64, side: f64) -> ReferenceFacet<f64> {
    let h = 0.5 * spacing;
    ReferenceFacet::strip([-side * -h, side * h, 0.0], [side * -h, side * h, 0.0])
}

/// An owner and how it is deformed.
#[derive(Clone, Copy)]
struct Owner {
    x: Vector<f64>,
    f: Tensor<f64>,
}

fn pressed(a: (&Owner, &ReferenceFacet<f64>), b: (&Owner, &ReferenceFacet<f64>)) -> FacetPress<f64> {
    pressed_by(&LAW, a, b)
}

fn pressed_by(
    law: &FacetPairLaw<f64>,
    a: (&Owner, &ReferenceFacet<f64>),
    b: (&Owner, &ReferenceFacet<f64>),
) -> FacetPress<f64> {
    let now = |(owner, facet): (&Owner, &ReferenceFacet<f64>)| Facet::now(owner.x, &owner.f, facet);
    press(&now(a), &now(b), Partner::Facet, law)
}

#[test]
fn strips_look_outwards() {
    let (down, up) = (strip(1.0, -1.0), strip(2.0, 1.0));
    assert_eq!((down.normal, up.normal), ([0.0, -1.0, 0.0], [0.0, 1.0, 0.0]));
    assert_eq!((down.depth, up.depth, down.area(), up.area()), (0.5, 1.0, 1.0, 2.0));
    for facet in [square(2.0, 1.0), square(2.0, -1.0)] {
        assert_eq!((facet.area(), facet.depth), (4.0, 1.0));
    }
}

/// A tilted, sheared, stretched pair that presses.
fn pair(state: &mut u64, planar: bool) -> (Owner, Owner) {
    let size = 0.25;
    let mut deformed = |f: f64| {
        let mut g: Tensor<f64> = identity();
        for row in &mut g {
            for c in row.iter_mut() {
                *c += f * random(state);
            }
        }
        if planar {
            (g[0][2], g[1][2], g[2][0], g[2][1], g[2][2]) = (0.0, 0.0, 0.0, 0.0, 1.0);
        }
        g
    };
    let (f_a, f_b) = (deformed(size), deformed(size));
    let z = if planar { 0.0 } else { 0.5 * random(state) };
    let a = Owner { x: [0.5 * random(state), 0.9 + 0.2 * random(state), z], f: f_a };
    (a, Owner { x: [0.0; 3], f: f_b })
}

/// Largest misfit of forces and moments to differences of the energy, over their size; of all pairs that press by more than a little.
fn gradient_misfit(planar: bool, curvatures: [f64; 2], make: [fn(f64, f64) -> ReferenceFacet<f64>; 2]) -> (f64, usize) {
    let mut state = 7;
    let (mut worst, mut count) = (0.0f64, 0);
    for _ in 0..400 {
        let scale = 1.0 + 0.4 * random(&mut state);
        let bend = |facet: ReferenceFacet<f64>, k: f64| {
            facet.curved(SymmetricTensor {
                xx: k,
                zz: if planar { 0.0 } else { 0.6 * k },
                xz: if planar { 0.0 } else { 0.3 * k },
                yy: 0.0,
                xy: 0.0,
                yz: 0.0,
            })
        };
        let (facet_a, facet_b) = (bend(make[0](1.0, -1.0), curvatures[0]), bend(make[1](scale, 1.0), curvatures[1]));
        let (a, b) = pair(&mut state, planar);
        let got = pressed((&a, &facet_a), (&b, &facet_b));
        if got.energy < 1e-4 {
            continue;
        }
        count += 1;
        let size = dot(got.force, got.force).sqrt();
        let step = 1e-6;
        let difference = |change: &dyn Fn(&mut Owner, &mut Owner, f64)| {
            let energy = |sign: f64| {
                let (mut a, mut b) = (a, b);
                change(&mut a, &mut b, sign * step);
                pressed((&a, &facet_a), (&b, &facet_b)).energy
            };
            (energy(1.0) - energy(-1.0)) / (2.0 * step)
        };
        let stress = [stress_of_moment(&got.moment_a, &a.f), stress_of_moment(&got.moment_b, &b.f)];
        for i in 0..if planar { 2 } else { 3 } {
            let misfits = [
                difference(&|a, _, by| a.x[i] += by) + got.force[i],
                difference(&|_, b, by| b.x[i] += by) - got.force[i],
            ];
            worst = misfits.iter().fold(worst, |most, m| most.max(m.abs() / size));
            for j in 0..if planar { 2 } else { 3 } {
                let misfits = [
                    difference(&|a, _, by| a.f[i][j] += by) + stress[0][i][j],
                    difference(&|_, b, by| b.f[i][j] += by) + stress[1][i][j],
                ];
                worst = misfits.iter().fold(worst, |most, m| most.max(m.abs() / size));
            }
        }
    }
    (worst, count)
}

#[test]
fn forces_and_moments_are_the_derivative_of_the_energy() {
    for curvatures in [[0.0, 0.0], [0.2, 0.0], [0.3, -0.2], [0.0, 0.4]] {
        for (planar, make) in [
            (true, [strip as fn(f64, f64) -> ReferenceFacet<f64>, strip]),
            (false, [square, square]),
            (false, [triangle, square]),
            (false, [square, triangle]),
        ] {
            let (worst, count) = gradient_misfit(planar, curvatures, make);
            assert!(worst < 1e-6 && count > 40, "{planar} {curvatures:?}: {worst:e} of {count}");
        }
    }
}

/// Sum over all pairs of two bodies: of a what each facet feels, the whole energy, the area and number of pairs that press.
struct Sum {
    of_a: Vec<Vector<f64>>,
    of_b: Vec<Vector<f64>>,
    energy: f64,
    area: f64,
    pairs: usize,
}

impl Sum {
    fn force(&self) -> Vector<f64> {
        self.of_a.iter().fold([0.0; 3], |sum, f| [0, 1, 2].map(|i| sum[i] + f[i]))
    }
}

fn all_pairs(a: &[Facet<f64>], b: &[Facet<f64>]) -> Sum {
    let mut sum =
        Sum { of_a: vec![[0.0; 3]; a.len()], of_b: vec![[0.0; 3]; b.len()], energy: 0.0, area: 0.0, pairs: 0 };
    for (i, own) in a.iter().enumerate() {
        for (j, other) in b.iter().enumerate() {
            let p = press(own, other, Partner::Facet, &LAW);
            for c in 0..3 {
                sum.of_a[i][c] += p.force[c];
                sum.of_b[j][c] -= p.force[c];
            }
            sum.energy += p.energy;
            sum.area += p.area;
            sum.pairs += usize::from(p.area > 0.0);
        }
    }
    sum
}

/// A face of so many facets along x (and z), from `start`, at the height `y`, turned about y.
fn face(
    make: fn(f64, f64) -> ReferenceFacet<f64>,
    side: f64,
    spacing: f64,
    [along, across]: [usize; 2],
    start: Vector<f64>,
    angle: f64,
) -> Vec<Facet<f64>> {
    let (sine, cosine) = (angle.sin(), angle.cos());
    let turn = [[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]];
    let reference = make(spacing, side);
    (0..along)
        .flat_map(|i| (0..across).map(move |k| (i, k)))
        .map(|(i, k)| {
            let z = if across == 1 { 0.0 } else { (k as f64 + 0.5) * spacing };
            let x = apply(&turn, [(i as f64 + 0.5) * spacing, 0.0, z]);
            let owner = [start[0] + x[0], start[1] - side * 0.5 * spacing, start[2] + x[2]];
            Facet::now(owner, &turn, &reference)
        })
        .collect()
}

/// Pressure of the law at a closure, of facets of these spacings.
fn pressure_at(closure: f64, depth: f64) -> f64 {
    let x = closure / depth;
    LAW.stiffness * depth * x * (1.0 - 0.5 * x) / ((1.0 - x) * (1.0 - x))
}

#[test]
fn flat_faces_are_flat_whatever_their_lattices() {
    // A punch of facets on a plate that is longer: nothing at touch, and the same uniform pressure at every place.
    let closure = 0.1;
    for spacing in [0.125, 0.25, 0.5, 2.0 / 3.0, 0.8, 1.0, 1.25, 4.0] {
        for shift in [0.0, 0.013, 0.25, 0.5, 0.7] {
            let count = (16.0 / spacing) as usize;
            let plate = face(strip, 1.0, spacing, [count, 1], [-8.0, 0.0, 0.0], 0.0);
            let punch = |y: f64| face(strip, -1.0, 1.0, [4, 1], [-2.0 + shift * spacing, y, 0.0], 0.0);
            let touching = all_pairs(&punch(0.0), &plate);
            assert!(
                touching.force()[1] < 1e-14 && touching.energy < 1e-28,
                "{spacing} {shift}: {:?}",
                touching.force()
            );
            let pressed = all_pairs(&punch(-closure), &plate);
            let pressure = pressure_at(closure, 0.5 + 0.5 * spacing);
            for force in &pressed.of_a {
                assert!((force[1] - pressure).abs() < 1e-12 * pressure, "{spacing} {shift}: {force:?} {pressure}");
            }
            let [x, y, z] = pressed.force();
            assert!(
                (y - 4.0 * pressure).abs() < 1e-12 * y && x.abs() < 1e-13 * y && z.abs() < 1e-13 * y,
                "{x} {y} {z}"
            );
            assert!((pressed.area - 4.0).abs() < 1e-12);
            // Inside, the plate feels the same pressure.
            for (facet, force) in plate.iter().zip(&pressed.of_b) {
                let (left, right) = (facet.owner[0] - 0.5 * spacing, facet.owner[0] + 0.5 * spacing);
                if left > -2.0 + shift * spacing && right < 2.0 + shift * spacing {
                    assert!((force[1] + pressure * spacing).abs() < 1e-12 * pressure, "{force:?}");
                }
            }
        }
    }
    for spacing in [0.5, 0.8, 1.0] {
        for angle in [0.0, 0.3, std::f64::consts::FRAC_PI_4] {
            let count = (7.0 / spacing) as usize;
            let plate = face(square, 1.0, spacing, [count, count], [-3.5, 0.0, -3.5], 0.0);
            for (shift, other) in [(0.0, 0.0), (0.5, 0.5), (0.3, 0.11)] {
                let start = |y: f64| [-1.0 + shift * spacing, y, -1.0 + other * spacing];
                let punch = |y: f64| face(square, -1.0, 1.0, [2, 2], start(y), angle);
                let touching = all_pairs(&punch(0.0), &plate);
                assert!(touching.force()[1] < 1e-14, "{:?}", touching.force());
                let pressed = all_pairs(&punch(-closure), &plate);
                let pressure = pressure_at(closure, 0.5 + 0.5 * spacing);
                for force in &pressed.of_a {
                    assert!((force[1] - pressure).abs() < 1e-12 * pressure, "{spacing} {angle} {shift}: {force:?}");
                    assert!(force[0].abs().max(force[2].abs()) < 1e-12 * pressure, "{force:?}");
                }
                assert!((pressed.area - 4.0).abs() < 1e-12, "{}", pressed.area);
            }
        }
    }
}

#[test]
fn coincident_edges_belong_to_one_facet_whatever_rounding_says() {
    // Faces of one lattice on each other, with corners that differ by rounding: each facet has one partner, and no force along the face.
    let mut state = 3;
    let mut shaken = |facets: Vec<Facet<f64>>| -> Vec<Facet<f64>> {
        let mut shake = |facet: Facet<f64>| Facet {
            corners: facet.corners.map(|arm| arm.map(|c| c + 1e-14 * random(&mut state))),
            ..facet
        };
        facets.into_iter().map(&mut shake).collect()
    };
    let plate = shaken(face(square, 1.0, 1.0, [4, 4], [0.0; 3], 0.0));
    let punch = shaken(face(square, -1.0, 1.0, [4, 4], [0.0, -0.2, 0.0], 0.0));
    let sum = all_pairs(&punch, &plate);
    assert_eq!(sum.pairs, 16);
    for force in &sum.of_a {
        assert!(force[0].abs().max(force[2].abs()) < 1e-12 * force[1], "{force:?}");
    }
}

#[test]
fn edges_of_curved_facets_that_are_all_but_parallel_push_no_more_than_others() {
    // A roller on a plate, cut into the same slices: edges of both coincide but for a small turn. What is left along them, of a quadrature that is
    // not exact, must not be divided by the angle between them.
    let round = SymmetricTensor { xx: 0.25, yy: 0.0, zz: 0.0, xy: 0.0, xz: 0.0, yz: 0.0 };
    let (upper, lower) = (square(1.0, -1.0).curved(round), square(1.0, 1.0));
    let at = |angle: f64| {
        let (s, c) = angle.sin_cos();
        let a = Owner { x: [0.3, 0.97, 0.0], f: [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]] };
        pressed((&a, &upper), (&Owner { x: [0.0; 3], f: identity() }, &lower))
    };
    let straight = at(0.0);
    for k in 0..60 {
        let angle = 10f64.powf(-0.2 * f64::from(k));
        for angle in [angle, -angle] {
            let got = at(angle);
            // The normal force does not push along; edges do by the energy over a length.
            let lateral = got.force[0].hypot(got.force[2]);
            assert!(lateral < 0.05 * got.force[1], "{angle:e}: {:?}", got.force);
            if angle.abs() < 1e-3 {
                assert!((got.energy / straight.energy - 1.0).abs() < 2.0 * angle.abs() + 1e-12, "{angle:e}");
                assert!((got.force[1] / straight.force[1] - 1.0).abs() < 2.0 * angle.abs() + 1e-9, "{angle:e}");
            }
        }
    }
}

#[test]
fn a_flat_corner_that_dips_in_stores_what_is_integrated_by_hand() {
    // The plane of the upper facet dips by `q` below the lower one at a corner, and rises to nothing along both edges there: the closure is
    // q (1 - x/l - z/l) over a triangle, whose square has the integral q^2 l^2/12.
    for (tilt, l) in [(1e-5, 0.3), (1e-5, 0.8), (-1e-5, 0.5)] {
        let q = f64::abs(tilt) * l;
        let f = [[1.0, 0.0, 0.0], [tilt, 1.0, tilt], [0.0, 0.0, 1.0]];
        let (lower, upper) = (square(3.0, 1.0), square(1.0, -1.0));
        let a = Owner { x: [0.0, 2.0 - q + f64::abs(tilt), 0.0], f };
        let got = pressed((&a, &upper), (&Owner { x: [0.0; 3], f: identity() }, &lower));
        let exact = 0.5 * LAW.stiffness * q * q * l * l / 12.0;
        assert!((got.energy / exact - 1.0).abs() < 1e-4, "{tilt:e} {l}: {:e} {exact:e}", got.energy);
    }
}

#[test]
fn sides_of_bodies_that_lap_at_their_edges_are_closed_by_no_more_than_they_lap() {
    // The left side of a beam and the right side of the ledge that it rests on by half a spacing, at rest and sunk in by a little: sides that have
    // been pressed together so far press as much as their height, and those that lap less than the faces that lie on each other.
    let side = |x: f64, free: f64| ReferenceFacet {
        free: [0.0, free, 0.0, free],
        ..ReferenceFacet::strip([x, -x, 0.0], [x, x, 0.0])
    };
    let pair = |sunk: f64, free: f64| {
        let beam = Owner { x: [0.0, 1.0 - sunk, 0.0], f: identity() };
        pressed((&beam, &side(-0.5, free)), (&Owner { x: [-0.5, 0.0, 0.0], f: identity() }, &side(0.5, free)))
    };
    assert_eq!(side(0.5, 0.0).normal, [1.0, 0.0, 0.0]);
    assert_eq!(side(-0.5, 0.0).normal, [-1.0, 0.0, 0.0]);
    for sunk in [1e-6, 1e-3, 0.1] {
        let (free, held) = (pair(sunk, 1.0), pair(sunk, 0.0));
        // Energy k c^2/2 over the height, with a closure that falls from the lap to nothing, half-way there, or of half a spacing.
        let closure = 0.5 * sunk / (1.0 - sunk);
        let of_lap = 0.5 * closure * closure / (1.0 - closure) * sunk;
        assert!((free.energy / of_lap - 1.0).abs() < 1e-9, "{sunk}: {:e} {of_lap:e}", free.energy);
        assert!((held.energy / (0.25 * sunk) - 1.0).abs() < 1e-9, "{:e}", held.energy);
        // It is pushed up, where it laps less, and on to the side, until the owners pass each other with no closure left.
        assert!(
            free.force[1] > 0.0 && free.force[0] < 0.0 && free.force[0].abs() < 1.5 * sunk * free.force[1],
            "{:?}",
            free.force
        );
        assert!(free.normal_force > 0.0 && free.centre_a.iter().all(|c| c.is_finite()));
    }
}

#[test]
fn lapping_pairs_have_the_derivative_of_the_energy() {
    let mut state = 11;
    let mut count = 0;
    for k in 0..600 {
        let planar = k % 2 == 0;
        let mut turned = |scale: f64| {
            let mut f: Tensor<f64> = identity();
            for row in f.iter_mut().take(if planar { 2 } else { 3 }) {
                row.iter_mut().take(if planar { 2 } else { 3 }).for_each(|c| *c += scale * random(&mut state));
            }
            f
        };
        let (f_a, f_b) = (turned(0.12), turned(0.12));
        let x = [0.9 + 0.06 * random(&mut state), 0.65 + 0.15 * random(&mut state), 0.2 * random(&mut state)];
        let a = Owner { x: if planar { [x[0], x[1], 0.0] } else { x }, f: f_a };
        let b = Owner { x: [0.0; 3], f: f_b };
        let make = |side: f64| {
            let facet = if planar { strip(1.0, side) } else { square(1.0, side) };
            ReferenceFacet { free: [1.0; 4], ..facet }
        };
        let (facet_a, facet_b) = (make(-1.0), make(1.0));
        let at = |a: &Owner, b: &Owner| pressed((a, &facet_a), (b, &facet_b));
        let got = at(&a, &b);
        let whole = pressed((&a, &ReferenceFacet { free: [0.0; 4], ..facet_a }), (&b, &facet_b));
        // A pair that laps by less than it is closed.
        if got.energy < 1e-6 || got.energy > 0.7 * whole.energy {
            continue;
        }
        count += 1;
        let size = dot(got.force, got.force).sqrt();
        let stress = [stress_of_moment(&got.moment_a, &a.f), stress_of_moment(&got.moment_b, &b.f)];
        let step = 1e-6;
        for i in 0..if planar { 2 } else { 3 } {
            let moved = |by: f64| {
                let mut a = a;
                a.x[i] += by;
                at(&a, &b).energy
            };
            let misfit = (moved(step) - moved(-step)) / (2.0 * step) + got.force[i];
            assert!(misfit.abs() < 1e-5 * size, "{k}: force {i}: {misfit:e} of {size:e}");
            for j in 0..if planar { 2 } else { 3 } {
                for (side, stress) in stress.iter().enumerate() {
                    let deformed = |by: f64| {
                        let mut both = [a, b];
                        both[side].f[i][j] += by;
                        at(&both[0], &both[1]).energy
                    };
                    let misfit = (deformed(step) - deformed(-step)) / (2.0 * step) + stress[i][j];
                    assert!(misfit.abs() < 1e-5 * size, "{k}: moment {side} {i}{j}: {misfit:e} of {size:e}");
                }
            }
        }
    }
    assert!(count > 100, "{count}");
}

#[test]
fn pairs_balance_forces_and_torques() {
    let mut state = 11;
    for _ in 0..200 {
        let (a, b) = pair(&mut state, false);
        let bend =
            |facet: ReferenceFacet<f64>, k: f64| facet.curved(SymmetricTensor { xx: k, ..SymmetricTensor::zero() });
        let (facet_a, facet_b) = (bend(square(1.0, -1.0), 0.3), bend(square(1.2, 1.0), -0.1));
        let p = pressed((&a, &facet_a), (&b, &facet_b));
        let torque = |m: &Tensor<f64>| [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]];
        let (of_a, of_b) = (torque(&p.moment_a), torque(&p.moment_b));
        let of_force = cross([0, 1, 2].map(|i| a.x[i] - b.x[i]), p.force);
        for i in 0..3 {
            assert!((of_a[i] + of_b[i] + of_force[i]).abs() < 1e-13, "{of_a:?} {of_b:?} {of_force:?}");
        }
        if p.area == 0.0 {
            continue;
        }
        // What acts at the centre of pressure balances as well.
        let mut more = p;
        more.add_at_centre([0.3, -0.7, 0.4]);
        let (of_a, of_b) = (torque(&more.moment_a), torque(&more.moment_b));
        let of_force = cross([0, 1, 2].map(|i| a.x[i] - b.x[i]), more.force);
        for i in 0..3 {
            assert!((of_a[i] + of_b[i] + of_force[i]).abs() < 1e-13);
            assert!((more.force[i] - p.force[i] - [0.3, -0.7, 0.4][i]).abs() < 1e-15);
        }
    }
}

/// Facets of rings or balls: of a circle of that radius around the origin, looking outwards (`side` 1) or inwards.
fn ring(radius: f64, count: usize, side: f64, depth: f64, start: f64) -> Vec<Facet<f64>> {
    (0..count)
        .map(|k| {
            let angle = start + std::f64::consts::TAU * (k as f64 + 0.5) / count as f64;
            let (sine, cosine) = angle.sin_cos();
            let half = radius * std::f64::consts::PI / count as f64;
            let out = [cosine, sine, 0.0];
            let along = [-sine * side, cosine * side, 0.0];
            let owner = out.map(|c| (radius - side * depth) * c);
            let end = |to: f64| [0, 1, 2].map(|i| radius * out[i] + to * half * along[i] - owner[i]);
            let curvature = SymmetricTensor {
                xx: sine * sine * side / radius,
                yy: cosine * cosine * side / radius,
                xy: -sine * cosine * side / radius,
                ..SymmetricTensor::zero()
            };
            Facet::now(owner, &identity(), &ReferenceFacet::strip(end(-1.0), end(1.0)).curved(curvature))
        })
        .collect()
}

#[test]
fn a_disc_in_a_sleeve_rests_and_is_pressed_evenly() {
    let radius = 10.0;
    for count in [64, 80, 126, 256] {
        for start in [0.0, 0.01, 0.03] {
            let disc = ring(radius, 64, 1.0, 0.5, start);
            let sum = |radius: f64| all_pairs(&disc, &ring(radius, count, -1.0, 0.5, 0.0));
            let outwards = |sum: &Sum| {
                let radial = |(facet, f): (&Facet<f64>, &Vector<f64>)| -dot(*f, facet.normal);
                disc.iter().zip(&sum.of_a).map(radial).collect::<Vec<f64>>()
            };
            let touching = outwards(&sum(radius)).iter().fold(0.0f64, |most, p| most.max(p.abs()));
            let pressed = outwards(&sum(radius - 0.05));
            let mean = pressed.iter().sum::<f64>() / (std::f64::consts::TAU * radius);
            let expected = pressure_at(0.05, 1.0);
            assert!(touching < 5e-6, "{touching:e}");
            assert!((mean / expected - 1.0).abs() < 0.015, "{mean} {expected}");
        }
    }
}

#[test]
fn a_disc_is_pressed_on_a_plane_like_its_true_surface() {
    let radius = 10.0;
    let plate = face(strip, 1.0, 1.0, [16, 1], [-8.0, 0.0, 0.0], 0.0);
    for (closure, within) in [(0.0f64, 0.0), (0.05, 0.06), (0.1, 0.02), (0.2, 0.015), (0.5, 0.02)] {
        let half = (2.0 * radius * closure - closure * closure).sqrt();
        let count = 2000;
        let at = |k: usize| {
            let s = half * ((2 * k + 1) as f64 / count as f64 - 1.0);
            pressure_at((radius * radius - s * s).sqrt() - radius + closure, 1.0)
        };
        let expected = 2.0 * half / count as f64 * (0..count).map(at).sum::<f64>();
        for shift in [0.0, 0.2, 0.5, 0.83] {
            for turned in [0.0, 0.013, 0.037] {
                let disc: Vec<_> = ring(radius, 64, 1.0, 0.5, turned)
                    .into_iter()
                    .map(|facet| Facet {
                        owner: [facet.owner[0] + shift, facet.owner[1] + radius - closure, 0.0],
                        ..facet
                    })
                    .collect();
                let sum = all_pairs(&disc, &plate);
                let [x, y, _] = sum.force();
                assert!(x.abs() < 1e-3 * y.max(1e-9), "{x} {y}");
                if closure == 0.0 {
                    assert!(y < 1e-8, "{y}");
                } else {
                    assert!((y / expected - 1.0).abs() < within, "{closure}: {}", y / expected);
                }
            }
        }
    }
}

/// Facets of a cubed ball: of a sphere around the origin, looking outwards (`side` 1) or inwards, `count` along an edge of the cube, turned.
fn ball(radius: f64, count: usize, side: f64, depth: f64, turn: &Tensor<f64>) -> Vec<Facet<f64>> {
    let mut facets = Vec::new();
    let on = |p: Vector<f64>| p.map(|c| radius * c / dot(p, p).sqrt());
    let at = |k: usize| (std::f64::consts::FRAC_PI_4 * (2.0 * k as f64 / count as f64 - 1.0)).tan();
    for (axis, sign) in (0..3).flat_map(|axis| [(axis, 1.0), (axis, -1.0)]) {
        for (i, j) in (0..count).flat_map(|i| (0..count).map(move |j| (i, j))) {
            let place = |i: f64, j: f64| {
                let mut p = [0.0; 3];
                (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (sign, i, sign * side * j);
                apply(turn, on(p))
            };
            let corners =
                [place(at(i), at(j)), place(at(i + 1), at(j)), place(at(i + 1), at(j + 1)), place(at(i), at(j + 1))];
            let mean = [0, 1, 2].map(|c| corners.iter().map(|p| p[c]).sum::<f64>());
            let length = dot(mean, mean).sqrt();
            let normal = mean.map(|c| side * c / length);
            let middle = mean.map(|c| radius * c / length);
            let owner = [0, 1, 2].map(|c| middle[c] - depth * normal[c]);
            let flat = |p: Vector<f64>| {
                let off = [0, 1, 2].map(|c| p[c] - middle[c]);
                let above = dot(off, normal);
                [0, 1, 2].map(|c| p[c] - above * normal[c] - owner[c])
            };
            let k = side / radius;
            let n = normal;
            let curvature = SymmetricTensor {
                xx: k * (1.0 - n[0] * n[0]),
                yy: k * (1.0 - n[1] * n[1]),
                zz: k * (1.0 - n[2] * n[2]),
                xy: -k * n[0] * n[1],
                yz: -k * n[1] * n[2],
                xz: -k * n[0] * n[2],
            };
            let arm = [0, 1, 2].map(|c| middle[c] - owner[c]);
            let reference = ReferenceFacet {
                corners: corners.map(flat),
                middle: arm,
                normal,
                curvature,
                depth,
                free: [0.0; 4],
                across: [[0.0; 3]; 3],
            };
            facets.push(Facet::now(owner, &identity(), &reference));
        }
    }
    facets
}

fn turned(by: f64) -> Tensor<f64> {
    let (s, c) = by.sin_cos();
    crate::tensor::multiply(
        &[[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]],
        &[[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]],
    )
}

#[test]
fn a_ball_in_a_hollow_rests_and_is_pressed_evenly() {
    let radius = 10.0;
    for angle in [0.0, 0.4] {
        let own = ball(radius, 14, 1.0, 0.5, &turned(angle));
        let area = own.iter().map(|facet| facet.area).sum::<f64>();
        assert!((area / (4.0 * std::f64::consts::PI * radius * radius) - 1.0).abs() < 0.01);
        let outwards = |radius: f64| {
            let sum = all_pairs(&own, &ball(radius, 17, -1.0, 0.5, &identity()));
            own.iter().zip(&sum.of_a).map(|(facet, f)| -dot(*f, facet.normal) / facet.area).collect::<Vec<f64>>()
        };
        let touching = outwards(radius).into_iter().fold(0.0f64, f64::max);
        assert!(touching < 5e-6, "{touching:e}");
        let pressed = outwards(radius - 0.05);
        let mean = pressed.iter().sum::<f64>() / pressed.len() as f64 / pressure_at(0.05, 1.0);
        assert!((mean - 1.0).abs() < 0.02, "{mean}");
    }
}

#[test]
fn a_ball_is_pressed_on_a_plane_like_its_true_surface() {
    let radius = 10.0;
    let plate = face(square, 1.0, 1.0, [10, 10], [-5.0, 0.0, -5.0], 0.0);
    for (closure, within) in [(0.0f64, 0.0), (0.1, 0.04), (0.2, 0.02)] {
        let edge = (2.0 * radius * closure - closure * closure).sqrt();
        let count = 4000;
        let at = |k: usize| {
            let s = edge * (k as f64 + 0.5) / count as f64;
            std::f64::consts::TAU * s * pressure_at((radius * radius - s * s).sqrt() - radius + closure, 1.0)
        };
        let expected = edge / count as f64 * (0..count).map(at).sum::<f64>();
        for (angle, shift) in [(0.0, 0.0), (0.4, 0.3), (0.7, 0.5), (1.2, 0.1)] {
            let own: Vec<_> = ball(radius, 16, 1.0, 0.5, &turned(angle))
                .into_iter()
                .map(|facet| Facet {
                    owner: [facet.owner[0] + shift, facet.owner[1] + radius - closure, facet.owner[2] - 0.7 * shift],
                    ..facet
                })
                .filter(|facet| facet.owner[1] < 2.0)
                .collect();
            let [x, y, z] = all_pairs(&own, &plate).force();
            if closure == 0.0 {
                assert!(y < 1e-8, "{y}");
            } else {
                assert!((y / expected - 1.0).abs() < within, "{closure}: {}", y / expected);
                assert!(x.abs().max(z.abs()) < 0.02 * y, "{x} {y} {z}");
            }
        }
    }
}

#[test]
fn only_neighbours_in_a_stack_of_sheets_press_each_other() {
    // Sheets of one layer, each with two faces: the outer ones of three do not see each other through the middle one.
    let sheet = |y: f64| {
        let mut facets = face(strip, 1.0, 1.0, [3, 1], [0.0, y + 0.5, 0.0], 0.0);
        facets.extend(face(strip, -1.0, 1.0, [3, 1], [0.0, y - 0.5, 0.0], 0.0));
        facets
    };
    let [low, middle, high] = [sheet(0.0), sheet(1.0), sheet(2.0)];
    for (a, b) in [(&middle, &low), (&high, &middle), (&high, &low)] {
        assert!(all_pairs(a, b).energy < 1e-28);
    }
    // Pressed together to seven tenths, only the faces between neighbours push.
    let [low, middle, high] = [sheet(0.0), sheet(0.7), sheet(1.4)];
    let pressure = pressure_at(0.3, 1.0);
    for (a, b) in [(&middle, &low), (&high, &middle)] {
        let sum = all_pairs(a, b);
        assert!((sum.force()[1] - 3.0 * pressure).abs() < 1e-12 && sum.pairs == 3, "{:?}", sum.force());
    }
    assert_eq!(all_pairs(&high, &low).pairs, 0);
    // A lower side is not pressed by an upper side whose owner is above its own.
    let faces = |side: f64, y: f64| face(strip, side, 1.0, [1, 1], [0.0, y, 0.0], 0.0);
    assert!(all_pairs(&faces(-1.0, -0.99), &faces(1.0, 0.0)).force()[1] > 1.0);
    assert_eq!(all_pairs(&faces(-1.0, -1.01), &faces(1.0, 0.0)).energy, 0.0);
}

#[test]
fn owners_never_pass_each_other() {
    // The pressure grows without bound before the closure reaches the distance of the owners at touch, and the energy is its integral.
    let at = |closure: f64| {
        let facets = |side: f64, y: f64| face(strip, side, 1.0, [1, 1], [0.0, y, 0.0], 0.0);
        let (a, b) = (facets(-1.0, -closure), facets(1.0, 0.0));
        press(&a[0], &b[0], Partner::Facet, &LAW)
    };
    assert!((at(0.01).force[1] / 0.01 - 1.0).abs() < 0.016);
    // x = 0.5: x (1 - x/2)/(1 - x)^2 = 1.5; x^2/(2 (1 - x)) = 0.25; 1/(1 - x)^3 = 8.
    let half = at(0.5);
    assert!((half.force[1] - 1.5).abs() < 1e-14 && (half.energy - 0.25).abs() < 1e-14);
    assert!((half.stiffness - 8.0).abs() < 1e-12 && (half.area - 1.0).abs() < 1e-14);
    assert!((half.normal_force - 1.5).abs() < 1e-14);
    // From 0.8 on the stiffness stays 125: 12 + 125 0.1, 1.6 + 12 0.1 + 125 0.1^2/2.
    let deep = at(0.9);
    assert!((deep.force[1] - 24.5).abs() < 1e-11 && (deep.energy - 3.425).abs() < 1e-11, "{deep:?}");
    for closure in [0.3, 0.6, 0.79, 0.85, 0.95] {
        let by = 1e-6;
        let slope = (at(closure + by).energy - at(closure - by).energy) / (2.0 * by);
        assert!((slope / at(closure).force[1] - 1.0).abs() < 1e-8);
    }
}

#[test]
fn cells_in_line_do_not_pull_each_other_aside_by_rounding() {
    // Two facets beside each other on either side, moved along the face by a rounding and more: the sum of what the four pairs pull along it stays nothing on each.
    let facet = |side: f64, x: f64, y: f64| face(strip, side, 1.0, [1, 1], [x, y, 0.0], 0.0)[0];
    for shift in [0.0, 1e-14, 1e-12, 3e-11, 1e-9, 1e-7, 3e-6, 1e-4, 0.1] {
        for sign in [1.0, -1.0] {
            let [left, right] = [0.0, 1.0].map(|x| facet(-1.0, x, -0.2));
            let others = [-1.0, 0.0, 1.0, 2.0].map(|x| facet(1.0, x + sign * shift, 0.0));
            for own in [left, right] {
                for law in [LAW, FacetPairLaw { coincidence: 1e-5, ..LAW }] {
                    let along = |other: &Facet<f64>| press(&own, other, Partner::Facet, &law).force[0];
                    let pulled: f64 = others.iter().map(along).sum();
                    assert!(pulled.abs() < 1e-9, "{shift} {sign}: {pulled}");
                }
            }
        }
    }
}

#[test]
fn pairs_give_way_later_where_they_are_struck_fast() {
    let way = |pressure: f64, energy: f64| LAW.giving_way(FacetImpact { pressure, energy }, 2.0).gives_way;
    assert_eq!(way(0.0, 0.0), 0.5);
    assert_eq!(way(0.3, 0.1), 0.5);
    // u = 1/3: (1 - u^2)/(2 u^2) = 4, of which twice is borne.
    assert!((way(8.0, 0.0) - 2.0 / 3.0).abs() < 1e-12);
    // x^2/(2 u) = (4/9)/(2/3) = 2/3, of which twice is stopped.
    assert!((way(0.0, 4.0 / 3.0) - 2.0 / 3.0).abs() < 1e-12);
    // u = 0.2 is where the stiffness grows no more.
    assert_eq!(way(25.0, 0.0), 0.0);
    assert!(way(23.0, 0.0) > 0.79);
}

#[test]
fn pairs_that_give_way_press_like_others_up_to_half_of_their_depth_and_let_go_where_owners_pass() {
    let law = LAW.giving_way(FacetImpact::default(), 1.0);
    let at = |law: &FacetPairLaw<f64>, closure: f64| {
        let facets = |side: f64, y: f64| face(strip, side, 1.0, [1, 1], [0.0, y, 0.0], 0.0);
        press(&facets(-1.0, -closure)[0], &facets(1.0, 0.0)[0], Partner::Facet, law)
    };
    // To the bit.
    for closure in [1e-6, 0.01, 0.3, 0.499] {
        assert_eq!(at(&law, closure), at(&LAW, closure));
    }
    // 0.6: closed by 0.4, x^2/(2 (1 - x)) = 0.16/1.2, its slope there 0.8 0.4/0.36 falls with the closure.
    let beyond = at(&law, 0.6);
    assert!((beyond.energy - 0.16 / 1.2).abs() < 1e-14 && (beyond.force[1] + 0.32 / 0.36).abs() < 1e-13, "{beyond:?}");
    // Owners 0.15 D apart, half of the way over which pairs begin: closed by 0.15, half of 0.0225/1.7.
    let beginning = at(&law, 0.85);
    assert!((beginning.energy - 0.5 * 0.0225 / 1.7).abs() < 1e-14, "{beginning:?}");
    // Owners that come into order, as those of cells beside each other do, find nothing pressed there: before, more than all.
    for closure in [0.999, 1.001] {
        assert!(at(&law, closure).energy < 1e-10, "{closure}");
    }
    assert!(at(&LAW, 0.999).energy > 5.0);
}

#[test]
fn pairs_that_give_way_keep_the_derivative() {
    // Cells beside and behind each other, tilted and sheared.
    let law = LAW.giving_way(FacetImpact::default(), 1.0);
    let mut state = 13;
    let (mut count, mut beginning) = (0, 0);
    for _ in 0..600 {
        let tilt = 0.4 * random(&mut state);
        let (s, c) = tilt.sin_cos();
        let spread = |state: &mut u64| 0.1 * random(state);
        let f_a = [[c, -s, spread(&mut state)], [s, c, 0.0], [0.0, spread(&mut state), 1.0]];
        let f_b = [[c, s * 0.9, 0.1], [-s * 0.9, 0.8 * c, 0.0], [spread(&mut state), 0.0, 1.1]];
        let a = Owner { x: [0.3 * random(&mut state), 0.3 + 0.3 * random(&mut state), 0.1], f: f_a };
        let b = Owner { x: [0.0; 3], f: f_b };
        let (facet_a, facet_b) = (square(1.0, -1.0), square(1.1, 1.0));
        let pressed = |a: &Owner, b: &Owner| pressed_by(&law, (a, &facet_a), (b, &facet_b));
        let p = pressed(&a, &b);
        if p.energy < 1e-4 {
            continue;
        }
        let depth = Facet::now(a.x, &a.f, &facet_a).depth + Facet::now(b.x, &b.f, &facet_b).depth;
        beginning += usize::from(dot(a.x, p.normal) < 0.3 * depth);
        count += 1;
        let size = dot(p.force, p.force).sqrt().max(p.energy);
        let by = 1e-6;
        let stress = [stress_of_moment(&p.moment_a, &f_a), stress_of_moment(&p.moment_b, &f_b)];
        for i in 0..3 {
            let moved = |step: f64| {
                let mut a = a;
                a.x[i] += step;
                pressed(&a, &b).energy
            };
            let slope = (moved(by) - moved(-by)) / (2.0 * by);
            assert!((slope + p.force[i]).abs() < 1e-6 * size, "{slope} {} {size}", p.force[i]);
            for j in 0..3 {
                for (side, stress) in stress.iter().enumerate() {
                    let deformed = |step: f64| {
                        let mut both = [a, b];
                        both[side].f[i][j] += step;
                        pressed(&both[0], &both[1]).energy
                    };
                    let slope = (deformed(by) - deformed(-by)) / (2.0 * by);
                    assert!((slope + stress[i][j]).abs() < 1e-6 * size, "{side} {slope} {} {size}", stress[i][j]);
                }
            }
        }
    }
    assert!(count > 150 && beginning > 30, "{count} {beginning}");
}

#[test]
fn deep_and_turned_pairs_keep_the_derivative() {
    // Compressed cells, whose depth shrinks with F, deep in each other; and normals far from opposite, where chi falls.
    let mut state = 5;
    let mut count = [0; 2];
    for _ in 0..400 {
        let tilt = 0.55 * random(&mut state);
        let (s, c) = tilt.sin_cos();
        let spread = |state: &mut u64| 0.1 * random(state);
        let f_a = [[c, -s, spread(&mut state)], [s, c, 0.0], [0.0, spread(&mut state), 1.0]];
        let f_b = [[c, s * 0.9, 0.1], [-s * 0.9, 0.6 * c, 0.0], [spread(&mut state), 0.0, 1.1]];
        let a = Owner { x: [0.2 * random(&mut state), 0.45 + 0.3 * random(&mut state), 0.1], f: f_a };
        let b = Owner { x: [0.0; 3], f: f_b };
        let (facet_a, facet_b) = (square(1.0, -1.0), square(1.1, 1.0));
        let p = pressed((&a, &facet_a), (&b, &facet_b));
        if p.energy < 1e-4 {
            continue;
        }
        let cosine = -dot(Facet::now(a.x, &a.f, &facet_a).normal, Facet::now(b.x, &b.f, &facet_b).normal);
        count[usize::from(cosine < 0.7)] += 1;
        let size = dot(p.force, p.force).sqrt().max(p.energy);
        let by = 1e-6;
        let stress = [stress_of_moment(&p.moment_a, &f_a), stress_of_moment(&p.moment_b, &f_b)];
        for i in 0..3 {
            for j in 0..3 {
                let energy = |step: f64, first: bool| {
                    let (mut a, mut b) = (a, b);
                    let own = if first { &mut a } else { &mut b };
                    own.f[i][j] += step;
                    pressed((&a, &facet_a), (&b, &facet_b)).energy
                };
                for (first, stress) in [(true, &stress[0]), (false, &stress[1])] {
                    let slope = (energy(by, first) - energy(-by, first)) / (2.0 * by);
                    assert!((slope + stress[i][j]).abs() < 1e-6 * size, "{slope} {} {size}", stress[i][j]);
                }
            }
        }
    }
    assert!(count[0] > 50 && count[1] > 20, "{count:?}");
}

#[test]
fn a_plane_without_end_is_a_facet_that_is_larger() {
    let mut state = 13;
    let (mut pressing, mut worst) = (0, 0.0f64);
    for _ in 0..100 {
        let (a, _) = pair(&mut state, false);
        let curved = square(1.0, -1.0).curved(SymmetricTensor { xx: 0.1, ..SymmetricTensor::zero() });
        for reference in [square(1.0, -1.0), curved] {
            let against = |a: &Owner| {
                let own = Facet::now(a.x, &a.f, &reference);
                press(&own, &own.foot_on_plane([3.0, 0.4, -2.0], [0.0, 1.0, 0.0]), Partner::Plane, &LAW)
            };
            let p = against(&a);
            let large = [[-9.0, 0.4, -9.0], [-9.0, 0.4, 9.0], [9.0, 0.4, 9.0], [9.0, 0.4, -9.0]];
            let plate = Facet::rigid(large, [0.0, 1.0, 0.0], 0.0);
            // The owner of the plate is elsewhere, but also in the plane: so is its depth.
            let own = Facet::now(a.x, &a.f, &reference);
            let q = press(&own, &plate, Partner::Facet, &LAW);
            if p.energy < 1e-6 {
                continue;
            }
            pressing += 1;
            assert!((p.energy - q.energy).abs() < 1e-12 && (0..3).all(|i| (p.force[i] - q.force[i]).abs() < 1e-12));
            let by = 1e-6;
            let stress = stress_of_moment(&p.moment_a, &a.f);
            let size = p.force[1].abs();
            for i in 0..3 {
                let energy = |step: f64| {
                    let mut a = a;
                    a.x[i] += step;
                    against(&a).energy
                };
                worst = worst.max(((energy(by) - energy(-by)) / (2.0 * by) + p.force[i]).abs() / size);
                for j in 0..3 {
                    let energy = |step: f64| {
                        let mut a = a;
                        a.f[i][j] += step;
                        against(&a).energy
                    };
                    worst = worst.max(((energy(by) - energy(-by)) / (2.0 * by) + stress[i][j]).abs() / size);
                }
            }
            // Across a plane a force along it would be friction.
            assert!(p.force[0].abs().max(p.force[2].abs()) < 1e-12 * size);
        }
    }
    assert!(pressing > 40 && worst < 1e-6, "{pressing} {worst:e}");
}

#[test]
fn the_edge_of_a_rigid_blade_pushes() {
    // Two sides of a wedge of 60 degrees, its edge down, cut into the upper side of a block: pushed up by what is in both, at any place.
    let (s, c) = (0.5, 0.75f64.sqrt());
    let block = face(strip, 1.0, 0.5, [8, 1], [-2.0, 0.0, 0.0], 0.0);
    let at = |x: f64, tip: f64| {
        let side = |start: Vector<f64>, end: Vector<f64>| {
            let strip = ReferenceFacet::strip(start, end);
            Facet::rigid(strip.corners, strip.normal, 0.0)
        };
        let left = side([x - 2.0 * s, tip + 2.0 * c, 0.0], [x, tip, 0.0]);
        let right = side([x, tip, 0.0], [x + 2.0 * s, tip + 2.0 * c, 0.0]);
        all_pairs(&block, &[left, right])
    };
    for x in [0.0, 0.1, 0.25] {
        assert_eq!(at(x, 0.001).energy, 0.0);
        let [_, y, _] = at(x, -0.1).force();
        assert!(y < -1e-4, "{x} {y}");
        let by = 1e-6;
        let slope = (at(x, -0.1 + by).energy - at(x, -0.1 - by).energy) / (2.0 * by);
        assert!((slope - y).abs() < 1e-6 * y.abs(), "{slope} {y}");
    }
}

/// What a facet of an owner meets of a segment: on the side it looks at, at its first and at its second end.
fn on_segment(owner: &Owner, facet: &ReferenceFacet<f64>, ends: [Vector<f64>; 2], part: usize) -> FacetPress<f64> {
    let (own, segment) = (Facet::now(owner.x, &owner.f, facet), RigidSegment { ends, thickness: 1.0 });
    match part.checked_sub(1) {
        None => segment.press_side(&own, &LAW),
        Some(end) => segment.press_end(&own, end, 0.5, &LAW),
    }
}

#[test]
fn segments_push_facets_by_the_derivative_of_the_energy() {
    let mut state = 11;
    for part in 0..3 {
        let (mut worst, mut count) = (0.0f64, 0);
        for _ in 0..600 {
            let (owner, _) = pair(&mut state, true);
            let tip = [0.6 * random(&mut state), 0.45 + 0.3 * random(&mut state), 0.0];
            // Up to the facet end on, or below it along it.
            let far = match part {
                0 => [tip[0] + 3.0, tip[1] + random(&mut state), 0.0],
                _ => [tip[0] + 2.0 * random(&mut state), tip[1] - 2.0, 0.0],
            };
            let ends = if part == 1 { [tip, far] } else { [far, tip] };
            let facet = strip(1.0, -1.0);
            let got = on_segment(&owner, &facet, ends, part);
            if got.energy < 1e-4 {
                continue;
            }
            count += 1;
            let (size, step) = (dot(got.force, got.force).sqrt(), 1e-6);
            let difference = |change: &dyn Fn(&mut Owner, f64)| {
                let energy = |by: f64| {
                    let mut moved = owner;
                    change(&mut moved, by);
                    on_segment(&moved, &facet, ends, part).energy
                };
                (energy(step) - energy(-step)) / (2.0 * step)
            };
            let stress = stress_of_moment(&got.moment_a, &owner.f);
            for i in 0..2 {
                worst = worst.max((difference(&|o, by| o.x[i] += by) + got.force[i]).abs() / size);
                for j in 0..2 {
                    worst = worst.max((difference(&|o, by| o.f[i][j] += by) + stress[i][j]).abs() / size);
                }
            }
        }
        assert!(worst < 1e-6 && count > 60, "part {part}: {worst:e} of {count}");
    }
}

#[test]
fn an_end_pushes_a_face_alike_wherever_it_is() {
    // Ten facets of a spacing in a row, a strip of half a spacing at a depth of 0.1: k d w, as of one facet.
    let depth = 0.1;
    let row: Vec<Facet<f64>> = face(strip, -1.0, 1.0, [10, 1], [-4.5, 0.0, 0.0], 0.0);
    let pushed = |x: f64, y: f64, below: Vector<f64>| {
        let ends = [below, [x, y, 0.0]];
        let segment = RigidSegment { ends, thickness: 1.0 };
        let press = row.iter().map(|own| segment.press_end(own, 1, 0.5, &LAW));
        press.fold([0.0; 3], |sum, of| [0, 1, 2].map(|k| sum[k] + of.force[k]))
    };
    let expected = 0.5 * pressure_at(depth, 0.5);
    for x in [0.0, 0.1, 0.26, 0.37, 0.5, 0.8] {
        let [along, up, _] = pushed(x, depth, [x, -9.0, 0.0]);
        assert!((up - expected).abs() < 1e-12 && along.abs() < 1e-12, "{x}: {along} {up} of {expected}");
        // From the side, by 30 degrees: the same.
        let [along, up, _] = pushed(x, depth, [x - 5.0, depth - 75.0f64.sqrt(), 0.0]);
        assert!((up - expected).abs() < 1e-12 && along.abs() < 1e-12, "{x}: {along} {up} of {expected}");
        // Not yet there.
        assert_eq!(pushed(x, -1e-9, [x, -9.0, 0.0]), [0.0; 3]);
        // Along the face, and from above: that is no end that meets it.
        assert_eq!(pushed(x, depth, [x - 9.0, depth, 0.0]), [0.0; 3]);
        assert_eq!(pushed(x, depth, [x, 9.0, 0.0]), [0.0; 3]);
    }
}

#[test]
fn a_side_pushes_what_is_on_it_and_faces_it() {
    let own = Facet::now([0.2, 0.4, 0.0], &identity(), &strip(1.0, -1.0));
    let ends = [[-0.1, 0.0, 0.0], [7.0, 0.0, 0.0]];
    for ends in [ends, [ends[1], ends[0]]] {
        let press = RigidSegment { ends, thickness: 1.0 }.press_side(&own, &LAW);
        // From -0.1 to 0.7, closed by 0.1.
        assert!((press.area - 0.8).abs() < 1e-12 && (press.force[1] - 0.8 * pressure_at(0.1, 0.5)).abs() < 1e-12);
        // Moved to the right, it would be on it by more.
        assert!((press.force[0] + press.energy / 0.8).abs() < 1e-12);
        // The same face of an owner below the segment is not on it.
        let below = Facet::now([0.2, -0.1, 0.0], &identity(), &strip(1.0, -1.0));
        assert_eq!(RigidSegment { ends, thickness: 1.0 }.press_side(&below, &LAW).energy, 0.0);
    }
}

#[test]
fn laws_of_two_bodies_by_hand() {
    let steel = FacetMaterial { half_depth: 0.5e-3, density: 7800.0, bulk_modulus: 160e9 };
    let lead = FacetMaterial { half_depth: 1e-3, density: 11340.0, bulk_modulus: 40e9 };
    let strength = FacetStrength { stiffness: 2.0, damping: 0.1, friction: 0.3 };
    let law = FacetPairLaw::new(&steel, &lead, strength);
    // 2/(0.5e-3/160e9 + 1e-3/40e9) = 2/(2.8125e-14); Z = 2 35 327 043 21 297 887/(...).
    assert!((law.stiffness / (2.0 / 2.8125e-14) - 1.0).abs() < 1e-14);
    let (z_s, z_l) = ((7800.0 * 160e9f64).sqrt(), (11340.0 * 40e9f64).sqrt());
    assert!((law.damping / (0.1 * 2f64.sqrt() * 2.0 * z_s * z_l / (z_s + z_l)) - 1.0).abs() < 1e-14);
    assert_eq!((law.friction, law.tangential_stiffness), (0.3, 0.5 * law.stiffness));
    assert_eq!(law, FacetPairLaw::new(&lead, &steel, strength));
    let frictionless = FacetPairLaw::new(&steel, &lead, FacetStrength { friction: 0.0, ..strength });
    assert_eq!(frictionless.tangential_stiffness, 0.0);
    // Against something rigid as against something that hardly yields.
    let rigid = FacetMaterial { half_depth: 1e-3, density: 1e25, bulk_modulus: 1e30 };
    let (wall, almost) = (FacetPairLaw::against_rigid(&steel, strength), FacetPairLaw::new(&steel, &rigid, strength));
    assert!((wall.stiffness / almost.stiffness - 1.0).abs() < 1e-12);
    assert!((wall.damping / almost.damping - 1.0).abs() < 1e-12);
    let cast = law.cast::<f32>();
    assert!((f64::from(cast.stiffness) / law.stiffness - 1.0).abs() < 1e-7 && cast.friction == 0.3);
}

#[test]
fn damping_opposes_approach_and_never_pulls() {
    let (a, b) =
        (face(strip, -1.0, 1.0, [1, 1], [0.25, -0.2, 0.0], 0.0)[0], face(strip, 1.0, 1.0, [1, 1], [0.0; 3], 0.0)[0]);
    let p = press(&a, &b, Partner::Facet, &LAW);
    // Common part 0.75 long, its centre 0.125 before that of a, half-way into the overlap: 0.4 below the owner of a.
    assert!((p.area - 0.75).abs() < 1e-14 && (p.normal[1] - 1.0).abs() < 1e-15);
    for (got, want) in p.centre_a.iter().zip([-0.125, -0.4, 0.0]).chain(p.centre_b.iter().zip([0.125, 0.4, 0.0])) {
        assert!((got - want).abs() < 1e-14, "{:?} {:?}", p.centre_a, p.centre_b);
    }
    // 3 down, and turning: L y = (-2 (-0.4), 2 (-0.125)); b at 1 up.
    let l = [[0.0, -2.0, 0.0], [2.0, 0.0, 0.0], [0.0; 3]];
    let v = p.velocity([0.0, -3.0, 0.0], &l, [0.0, 1.0, 0.0], &[[0.0; 3]; 3]);
    assert!((v[0] - 0.8).abs() < 1e-14 && (v[1] + 4.25).abs() < 1e-14, "{v:?}");
    let (force, heat) = p.damping(&LAW, v);
    // 0.3 0.75 4.25 at 4.25.
    assert!((force[1] - 0.95625).abs() < 1e-14 && (heat - 0.95625 * 4.25).abs() < 1e-13 && force[0] == 0.0);
    // Its area does not jump: a half at half a thousandth of the distance of the owners.
    let faint = Facet { owner: [0.25, 0.5 - 5e-4, 0.0], ..a };
    let faint = press(&faint, &b, Partner::Facet, &LAW);
    assert!((faint.area - 0.75).abs() < 1e-12 && (faint.damped_area - 0.375).abs() < 1e-9, "{faint:?}");
    assert!((p.damped_area - p.area).abs() < 1e-15);
    let (force, heat) = p.damping(&LAW, [0.0, 1e6, 0.0]);
    assert!((force[1] + p.normal_force).abs() < 1e-15 && (heat - p.normal_force * 1e6).abs() < 1e-6);
}

#[test]
fn step_limit_by_hand() {
    let p = FacetPress { stiffness: 2.0, ..FacetPress::none() };
    let law = FacetPairLaw { damping: 0.0, ..LAW };
    // omega^2 = 2 2.5 (0.3 + 0.5) = 4.
    assert!((p.step_limit(&law, 0.3, 0.5) - 1.0).abs() < 1e-14);
    assert!(p.step_limit(&LAW, 0.3, 0.5) < 0.9);
}

#[test]
fn single_precision_gives_the_same() {
    let mut state = 17;
    let mut count = 0;
    for _ in 0..200 {
        let (a, b) = pair(&mut state, false);
        let facets = [Facet::now(a.x, &a.f, &square(1.0, -1.0)), Facet::now(b.x, &b.f, &square(1.2, 1.0))];
        let wide = press(&facets[0], &facets[1], Partner::Facet, &LAW);
        let single = |f: &Facet<f64>| {
            let v = |p: Vector<f64>| p.map(|c| c as f32);
            Facet {
                owner: v(f.owner),
                corners: f.corners.map(v),
                middle: v(f.middle),
                normal: v(f.normal),
                curvature: SymmetricTensor::from_array(f.curvature.to_array().map(|c| c as f32)),
                depth: f.depth as f32,
                area: f.area as f32,
                free: f.free.map(|c| c as f32),
                shift: v(f.shift),
                shear: f.shear.map(v),
                misfit: f.misfit as f32,
                rest_depth: f.rest_depth as f32,
            }
        };
        let narrow = press(&single(&facets[0]), &single(&facets[1]), Partner::Facet, &LAW.cast::<f32>());
        if wide.energy < 1e-3 {
            continue;
        }
        count += 1;
        let size = dot(wide.force, wide.force).sqrt();
        for i in 0..3 {
            assert!((f64::from(narrow.force[i]) - wide.force[i]).abs() < 2e-4 * size, "{wide:?} {narrow:?}");
            for j in 0..3 {
                assert!((f64::from(narrow.moment_a[i][j]) - wide.moment_a[i][j]).abs() < 2e-4 * size);
            }
        }
    }
    assert!(count > 50);
}

/// Faces that slide on each other with springs of friction.
struct Sliding {
    a: Vec<Facet<f64>>,
    b: Vec<Facet<f64>>,
    slips: [Vec<FacetSlip<f64>>; 2],
    heat: f64,
}

impl Sliding {
    fn stored(&self) -> f64 {
        self.slips.iter().flatten().map(FacetSlip::energy).sum()
    }

    /// Moves a by a velocity in a step; the friction force on a after it, and the normal force.
    fn step(&mut self, v: Vector<f64>, dt: f64) -> (Vector<f64>, f64) {
        for facet in &mut self.a {
            (0..3).for_each(|i| facet.owner[i] += dt * v[i]);
        }
        let still = [[0.0; 3]; 3];
        let pairs: Vec<(usize, usize, FacetPress<f64>)> = (0..self.a.len())
            .flat_map(|i| (0..self.b.len()).map(move |j| (i, j)))
            .map(|(i, j)| (i, j, press(&self.a[i], &self.b[j], Partner::Facet, &LAW)))
            .filter(|(_, _, p)| p.area > 0.0)
            .collect();
        let mut drives = [vec![SlipDrive::none(); self.a.len()], vec![SlipDrive::none(); self.b.len()]];
        for (i, j, p) in &pairs {
            let share = FrictionShare::of(p, &LAW, p.velocity(v, &still, [0.0; 3], &still), false);
            drives[0][*i].add(&share);
            drives[1][*j].add(&share.turned());
        }
        for (side, facets) in [&self.a, &self.b].into_iter().enumerate() {
            for (k, facet) in facets.iter().enumerate() {
                let (slip, heat) = slip_after(&self.slips[side][k], facet, &drives[side][k], dt);
                self.slips[side][k] = slip;
                self.heat += heat;
            }
        }
        let mut sum = ([0.0; 3], 0.0);
        for (i, j, p) in &pairs {
            let slips = (self.slips[0][*i].vector(&self.a[*i]), self.slips[1][*j].vector(&self.b[*j]));
            let force = friction_force(p, &LAW, slips.0, slips.1, false);
            (0..3).for_each(|c| sum.0[c] += force[c]);
            sum.1 += p.normal_force;
        }
        sum
    }
}

fn sliding(spacing: f64) -> Sliding {
    let a = face(square, -1.0, 1.0, [2, 2], [0.3, -0.1, 0.2], 0.0);
    let b = face(square, 1.0, spacing, [(6.0 / spacing) as usize, (6.0 / spacing) as usize], [-2.0, 0.0, -2.0], 0.0);
    let slips = [vec![FacetSlip::none(); a.len()], vec![FacetSlip::none(); b.len()]];
    Sliding { a, b, slips, heat: 0.0 }
}

#[test]
fn friction_sticks_then_slips_and_its_heat_is_its_work() {
    for spacing in [1.0, 0.8, 0.5] {
        let mut faces = sliding(spacing);
        let normal = 4.0 * pressure_at(0.1, 0.5 + 0.5 * spacing);
        // Sticking: T k_t xi for a way so short that the areas stay, of which nothing is heat.
        let way = 1e-6;
        let (force, pressing) = faces.step([way, 0.0, 0.0], 1.0);
        assert!((pressing - normal).abs() < 1e-12);
        let want = 4.0 * 0.5 * way;
        assert!((force[0] + want).abs() < 1e-5 * want && force[1].abs() + force[2].abs() < 1e-5 * want, "{force:?}");
        let stored = 0.5 * want * way;
        assert!((faces.stored() - stored).abs() < 1e-5 * stored && faces.heat.abs() < 1e-5 * stored);
        // Back: nothing is left.
        let (force, _) = faces.step([-way, 0.0, 0.0], 1.0);
        assert!(force[0].abs() < 1e-5 * want && faces.stored() < 1e-5 * stored && faces.heat.abs() < 1e-5 * stored);
        // A closed path with changes of direction and of pressure: what it took is heat and what is stored.
        let (mut work, mut last) = (0.0, [0.0; 3]);
        let dt = 0.01;
        let steps = 2000;
        let mut slipping = 0;
        for k in 0..steps {
            let angle = std::f64::consts::TAU * k as f64 / steps as f64;
            let v = [0.5 * angle.cos(), 0.02 * (3.0 * angle).cos(), 0.4 * (2.0 * angle).sin()];
            let (heat, before) = (faces.heat, last);
            let (force, pressing) = faces.step(v, dt);
            // The springs take the sliding part.
            work -= 0.5 * dt * (0..3).map(|i| (before[i] + force[i]) * v[i]).sum::<f64>();
            last = force;
            let size = dot(force, force).sqrt();
            assert!(size <= 0.3 * pressing * (1.0 + 1e-9), "{size} {pressing}");
            slipping += usize::from(size > 0.299 * pressing);
            assert!(faces.heat > heat - 1e-6 * work, "{} {heat}", faces.heat);
        }
        assert!(slipping > steps / 4, "{slipping}");
        let balance = faces.heat + faces.stored() - work;
        assert!(balance.abs() < 1e-5 * work && work > 0.05, "{spacing}: {balance} {work}");
        // Away from each other: what was stored is heat.
        let whole = faces.heat + faces.stored();
        faces.step([0.0, 1.0, 0.0], 1.0);
        assert!(faces.stored() == 0.0 && (faces.heat - whole).abs() < 1e-15);
    }
}

#[test]
fn sliding_is_damped_within_the_limit_of_friction() {
    let press = FacetPress { normal: [0.0, 1.0, 0.0], normal_force: 10.0, damped_area: 2.0, ..FacetPress::none() };
    // Limit 3. Damping 0.25 2 (3, 0, 4) along the plane: 2.5 whole.
    let v = [3.0, 7.0, 4.0];
    let (force, heat) = damp_sliding(&press, &LAW, 0.25, [0.0; 3], v);
    assert_eq!((force, heat), ([-1.5, 0.0, -2.0], 12.5));
    // The spring holds back with 1 along the same line: 2 are left. At its limit: none. Along the velocity: whole.
    let (force, heat) = damp_sliding(&press, &LAW, 0.25, [-0.6, 0.0, -0.8], v);
    assert!((force[0] + 1.2).abs() < 1e-12 && (force[2] + 1.6).abs() < 1e-12 && (heat - 10.0).abs() < 1e-12);
    let (force, heat) = damp_sliding(&press, &LAW, 0.25, [-1.8, 0.0, -2.4], v);
    assert!(dot(force, force).sqrt() < 1e-12 && heat.abs() < 1e-12);
    let (force, heat) = damp_sliding(&press, &LAW, 0.25, [1.8, 0.0, 2.4], v);
    assert!((force[0] + 1.5).abs() < 1e-12 && (heat - 12.5).abs() < 1e-12);
    assert_eq!(damp_sliding(&press, &LAW, 0.25, [1.0, 0.0, 0.0], [0.0, 7.0, 0.0]), ([0.0; 3], 0.0));
    // sqrt(k_t rho 2 D/beta) = sqrt(0.5 8 2/2.5).
    let material = FacetMaterial { half_depth: 1.0, density: 8.0, bulk_modulus: 1.0 };
    assert!((LAW.sliding_damping(&material) - 3.2f64.sqrt()).abs() < 1e-15);
}

#[test]
fn a_spring_against_something_rigid_carries_all_friction() {
    let own = face(square, -1.0, 1.0, [1, 1], [0.0, -0.1, 0.0], 0.0)[0];
    let p = press(&own, &own.foot_on_plane([0.0; 3], [0.0, 1.0, 0.0]), Partner::Plane, &LAW);
    let force = |v: f64| {
        let share = FrictionShare::of(&p, &LAW, [v, 7.0, 0.0], true);
        let mut drive = SlipDrive::none();
        drive.add(&share);
        let (slip, heat) = slip_after(&FacetSlip::none(), &own, &drive, 0.1);
        (friction_force(&p, &LAW, slip.vector(&own), [0.0; 3], true)[0], heat, slip.energy())
    };
    // k_t 0.5 over 1, 0.02 far; the normal force 0.1 (1 - 0.1)/0.8^2.
    let (pull, heat, stored) = force(0.2);
    assert!((pull + 0.01).abs() < 1e-15 && heat.abs() < 1e-17 && (stored - 0.5 * 0.5 * 0.0004).abs() < 1e-17);
    let (pull, heat, stored) = force(-50.0);
    let normal = 0.1 * 0.9 / 0.64;
    assert!((p.normal_force - normal).abs() < 1e-14);
    assert!((pull - 0.3 * normal).abs() < 1e-14, "{pull}");
    // Work of half of the force at the end, 5 far.
    assert!((heat + stored - 0.5 * 0.3 * normal * 5.0).abs() < 1e-13);
}

#[test]
fn the_slip_turns_with_its_facet() {
    let facet = face(square, 1.0, 1.0, [1, 1], [0.0; 3], 0.0)[0];
    let state = FacetSlip { slip: [0.3, -0.4], stiffness: 8.0 };
    let turned_facet = face(square, 1.0, 1.0, [1, 1], [0.0; 3], 0.5)[0];
    let (before, after) = (state.vector(&facet), state.vector(&turned_facet));
    let (s, c) = 0.5f64.sin_cos();
    let want = [c * before[0] + s * before[2], before[1], -s * before[0] + c * before[2]];
    assert!((0..3).all(|i| (after[i] - want[i]).abs() < 1e-15), "{after:?} {want:?}");
    assert!((dot(before, before) - 0.25).abs() < 1e-15 && before[1].abs() < 1e-16);
    assert_eq!(state.energy(), 0.5);
}

#[test]
fn inset_facets_are_nearer_to_their_owner() {
    let facet = square(1.0, 1.0).inset(0.2);
    assert!((facet.depth - 0.3).abs() < 1e-15 && (facet.middle[1] - 0.3).abs() < 1e-15);
    assert!(facet.corners.iter().all(|c| (c[1] - 0.3).abs() < 1e-15) && (facet.area() - 1.0).abs() < 1e-15);
}

#[test]
fn facets_of_torn_cells_are_held_near_their_owners() {
    let reference = square(1.0, -1.0);
    let (thin, long) = (0.7, 3.0);
    let f = |n: f64| [[1.2, 0.3, 0.1], [0.0, n, 0.2], [-0.1, 0.0, 0.9]];
    // Compression moves none.
    let pressed_in = Facet::now([0.0; 3], &f(thin), &reference);
    assert_eq!(pressed_in.held(0.5), (pressed_in, 1.0));
    // At a stretch of lambda it is 2 - 1/lambda of the depth at rest away, never twice it.
    let torn = Facet::now([0.0; 3], &f(long), &reference);
    let (held, stretch) = torn.held(0.5);
    assert!((stretch - torn.depth / 0.5).abs() < 1e-15 && stretch > 2.0 && held.depth == torn.depth);
    let away = dot(held.middle, held.normal);
    assert!((away - 0.5 * (2.0 - 1.0 / stretch)).abs() < 1e-15 && away < 1.0);
    for arm in held.corners {
        assert!((dot(arm, held.normal) - away).abs() < 1e-15);
    }
    // And the moment is the derivative of the energy.
    let mut state = 23;
    let (mut worst, mut count) = (0.0f64, 0);
    for _ in 0..200 {
        let (mut a, mut b) = pair(&mut state, false);
        a.f[1][1] += 0.9;
        b.f[1][1] += 0.3;
        a.x[1] += 0.5;
        let facets = (square(1.0, -1.0), square(1.1, 1.0));
        let pressed = |a: &Owner, b: &Owner| {
            let (own, stretch) = Facet::now(a.x, &a.f, &facets.0).held(facets.0.depth);
            let (other, other_stretch) = Facet::now(b.x, &b.f, &facets.1).held(facets.1.depth);
            (press(&own, &other, Partner::Facet, &LAW), (own, stretch), (other, other_stretch))
        };
        let (p, own, other) = pressed(&a, &b);
        if p.energy < 1e-4 || own.1 == 1.0 {
            continue;
        }
        count += 1;
        let more = [moment_of_torn(&own.0, own.1, p.force), moment_of_torn(&other.0, other.1, p.force.map(|c| -c))];
        let whole = |moment: &Tensor<f64>, more: &Tensor<f64>, f: &Tensor<f64>| {
            stress_of_moment(&[0, 1, 2].map(|i| [0, 1, 2].map(|j| moment[i][j] + more[i][j])), f)
        };
        let stress = [whole(&p.moment_a, &more[0], &a.f), whole(&p.moment_b, &more[1], &b.f)];
        let size = dot(p.force, p.force).sqrt();
        let by = 1e-6;
        for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
            for (first, stress) in [(true, &stress[0]), (false, &stress[1])] {
                let energy = |step: f64| {
                    let (mut a, mut b) = (a, b);
                    if first { &mut a } else { &mut b }.f[i][j] += step;
                    pressed(&a, &b).0.energy
                };
                worst = worst.max(((energy(by) - energy(-by)) / (2.0 * by) + stress[i][j]).abs() / size);
            }
        }
    }
    assert!(worst < 1e-6 && count > 40, "{worst:e} {count}");
}

#[test]
fn a_hollow_rises_to_what_is_above_the_plane_of_its_facet() {
    // A hundredth above the plane that touches the hollow at its middle; at the edges the hollow is 0.4 0.5^2/2 = 0.05 higher.
    let hollow = |facet: ReferenceFacet<f64>| facet.curved(SymmetricTensor { xx: -0.4, ..SymmetricTensor::zero() });
    let at = |y: f64, facet: &ReferenceFacet<f64>| Facet::now([0.0, y, 0.0], &identity(), facet);
    let (low, high) = (square(1.0, 1.0), square(1.0, -1.0));
    for (a, b) in [(at(1.01, &high), at(0.0, &hollow(low))), (at(1.01, &hollow(high)), at(0.0, &low))] {
        let p = press(&a, &b, Partner::Facet, &LAW);
        assert!(p.force[1] > 1e-3 && p.area < 1.0, "{p:?}");
    }
    assert_eq!(press(&at(1.01, &high), &at(0.0, &low), Partner::Facet, &LAW), FacetPress::none());
    assert_eq!(press(&at(1.06, &high), &at(0.0, &hollow(low)), Partner::Facet, &LAW).energy, 0.0);
}

#[test]
fn nothing_moves_along_axes_that_are_not_there() {
    let (a, b) = (strip(1.0, -1.0), strip(0.7, 1.0));
    let at = |x: f64, y: f64, facet: &ReferenceFacet<f64>| {
        Facet::now([x, y, 0.0], &[[1.0, 0.1, 0.0], [0.07, 0.9, 0.0], [0.0, 0.0, 1.0]], facet)
    };
    let all = press(&at(0.13, 0.65, &a), &at(0.0, 0.0, &b), Partner::Facet, &LAW);
    let p = all.within(crate::Dimension::Two);
    assert!(p.energy > 1e-3 && p.energy == all.energy && p.force[..2] == all.force[..2]);
    assert_eq!([p.force[2], p.normal[2], p.centre_a[2], p.centre_b[2]], [0.0; 4]);
    for (moment, whole) in [(p.moment_a, all.moment_a), (p.moment_b, all.moment_b)] {
        assert!(moment[2] == [0.0; 3] && moment[0][2] == 0.0 && moment[1][2] == 0.0);
        assert!(moment[0][..2] == whole[0][..2] && moment[1][..2] == whole[1][..2]);
    }
    assert!(all.moment_a[2][2] != 0.0);
    assert_eq!(all.within(crate::Dimension::Three), all);
    assert_eq!(all.within(crate::Dimension::One).force, [all.force[0], 0.0, 0.0]);
}
