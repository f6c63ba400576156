//! Where the faces of deformed bodies begin to press each other: tests of the law and of the shape of faces together.

use super::{ContactBody, ContactKernel, ContactLaw, ContactStrength, Overlap};
use crate::face::{Face, FaceMetric};
use crate::kernel::Kernel;
use crate::{Dimension, Tensor};

const LAYERS: i32 = 9;
/// Layers behind this one are beyond the kernel's reach of the surface, and know of no face.
const DEEPEST: i32 = 2;
const H: f64 = 1.2;

/// Overlap seen on the mean over the places along the face by the outermost particles of a body that is pressed to a part of its thickness and
/// stretched along its face, before another one like it, whose outermost `layers` count; faces are a gap apart, in spacings.
fn overlap(dimension: Dimension, pressed: f64, stretched: f64, layers: i32, gap: f64) -> f64 {
    let body = ContactBody { spacing: 1.0, smoothing_length: H, density: 1.0, bulk_modulus: 1.0 };
    let strength = ContactStrength { stiffness: 1.0, damping: 0.0, friction: 0.0 };
    let law = ContactLaw::new(Kernel::CubicSpline, dimension, &body, &body, strength);
    let wide = if dimension == Dimension::Three { stretched } else { 1.0 };
    let f: Tensor<f64> = [[stretched, 0.0, 0.0], [0.0, pressed, 0.0], [0.0, 0.0, wide]];
    // Where a particle of a layer stands, and how others see it; the body is below y = 0 or, turned over, above the gap.
    let stand = |layer: i32, up: f64| {
        let depth = f64::from(layer) + 0.5;
        let face = Face::new(dimension, &f, [0.0, up * depth, 0.0]).filter(|_| layer <= DEEPEST);
        let place = -up * pressed * depth + face.map_or(0.0, |face| face.shift()[1]);
        (place, face.map_or(FaceMetric::round(), |face| face.metric()))
    };
    let (own, seen) = stand(0, 1.0);
    const SHIFTS: i32 = 8;
    let shifts_z = if dimension == Dimension::Three { SHIFTS } else { 1 };
    let rows_z = if dimension == Dimension::Three { 5 } else { 0 };
    let mut sum = 0.0;
    for (a, b) in (0..SHIFTS).flat_map(|a| (0..shifts_z).map(move |b| (a, b))) {
        let mut overlap = Overlap::before_the_first();
        for layer in 0..layers {
            let (place, face) = stand(layer, -1.0);
            for (row_x, row_z) in (-5..=5).flat_map(|x| (-rows_z..=rows_z).map(move |z| (x, z))) {
                let along =
                    |row: i32, shift: i32, by: f64| by * (f64::from(row) + f64::from(shift) / f64::from(SHIFTS));
                let x = [along(row_x, a, stretched), own - gap - place, along(row_z, b, wide)];
                let kernels = ContactKernel::of_pair(Kernel::CubicSpline, dimension, x, H, (&seen, &face));
                overlap.add(&law, &kernels, 1.0, 1.0);
            }
        }
        sum += overlap.overlap;
    }
    sum / f64::from(SHIFTS * shifts_z)
}

/// How far faces overlap when they begin to press, in spacings; negative where they press across a gap.
fn onset(dimension: Dimension, pressed: f64, stretched: f64, layers: i32) -> f64 {
    let (mut apart, mut closed) = (1.5, -0.9);
    assert!(overlap(dimension, pressed, stretched, layers, apart) < 0.0);
    for _ in 0..40 {
        let gap = 0.5 * (apart + closed);
        if overlap(dimension, pressed, stretched, layers, gap) < 0.0 { apart = gap } else { closed = gap }
    }
    -closed
}

#[test]
fn pressed_and_stretched_faces_begin_to_press_where_they_touch() {
    for dimension in [Dimension::Two, Dimension::Three] {
        // At rest; pressed at constant volume; pressed alone; stretched along the face alone, and thinned by that; drawn in along the face.
        let pressed = if dimension == Dimension::Two { 2.0 } else { 2.0f64.sqrt() };
        for (thickness, width) in [(1.0, 1.0), (0.5, pressed), (0.5, 1.0), (1.0, 1.7), (0.6, 1.7), (1.0, 0.7)] {
            let overlap = onset(dimension, thickness, width, LAYERS);
            println!("{dimension:?}, {thickness} thick, {width:.2} wide: {overlap:+.4} spacings");
            assert!(overlap.abs() < 1e-3, "{dimension:?}, {thickness}, {width}: {overlap}");
        }
    }
}

#[test]
fn layers_too_deep_to_know_of_a_face_hardly_press() {
    // They overtake those that know of it where it is pressed to less than 0.7, on the way there by no more than this.
    for (pressed, stretched, most) in
        [(0.7, 1.0 / 0.7, 1e-3), (0.5, 2.0, 1e-3), (0.5, 1.0, 1e-3), (0.3, 1.0 / 0.3, 0.04)]
    {
        let with = onset(Dimension::Two, pressed, stretched, LAYERS);
        let without = onset(Dimension::Two, pressed, stretched, DEEPEST + 1);
        println!("{pressed} thick, {stretched:.2} wide: {with:+.4} with all, {without:+.4} with those that know of it");
        assert!((with - without).abs() < most, "{pressed}: {with} {without}");
    }
}
