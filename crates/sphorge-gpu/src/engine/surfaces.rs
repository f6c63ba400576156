//! The surfaces of bodies that meet: found once, in double precision, of the lists of the initial configuration.

use super::columns::{Columns, Group};
use super::failure;
use super::kernels::images::Planes;
use crate::device::Card;
use sphorge_engine::{Model, Particles, RunFailure};
use sphorge_physics::Vector;
use sphorge_physics::surface::{NearFace, add_outward, exposed, outermost_arm};
use sphorge_physics::tensor::dot;

/// Brings to the card who is of the surface, with normals, where a model asks for it. `list` are neighbours, from `starts` on.
pub(super) fn find(
    card: &Card,
    columns: &mut Columns,
    (model, p): (&Model, &Particles),
    stride: usize,
    (starts, list): (&[u32], &[u32]),
) -> Result<(), RunFailure> {
    let (kernel, dimension) = (model.numerics.kernel, model.dimensions.into());
    let planes = Planes::of(model);
    let mirrored = |bits: u32, axis: usize| planes.coordinate(bits, axis, 0.0).1;
    let image = |bits: u32, x: Vector<f64>| [0, 1, 2].map(|axis| planes.coordinate(bits, axis, x[axis]).0);
    let of_body = |i: usize| &model.bodies[p.body[i] as usize];
    // Every neighbour as it is seen from a particle: its number, which axes are mirrored, and how far the particle is from it, m.
    let neighbors = |i: usize| {
        list[starts[i] as usize..starts[i + 1] as usize].iter().map(move |entry| {
            let (j, bits) = Planes::split(*entry);
            let other = image(bits, p.position[j]);
            (j, bits, [0, 1, 2].map(|a| p.position[i][a] - other[a]))
        })
    };
    let outward = |i: usize| {
        let (h, spacing) = (of_body(i).smoothing_length, of_body(i).spacing);
        let mut outward = [0.0; 3];
        for (j, _, x) in neighbors(i) {
            add_outward(&mut outward, kernel, dimension, x, p.mass[j] / p.density[j], h);
        }
        let is_exposed = dot(outward, outward).sqrt() > exposed(kernel, dimension, spacing, h);
        if is_exposed { outward } else { [0.0; 3] }
    };
    let outward: Vec<Vector<f64>> = (0..p.len()).map(outward).collect();
    // Behind the outermost layer by the neighbours in that layer.
    let arm = |i: usize| {
        let half = 0.5 * of_body(i).spacing;
        if outward[i] != [0.0; 3] {
            return outermost_arm(outward[i], half);
        }
        let mut face = NearFace::default();
        for (j, bits, x) in neighbors(i).filter(|(j, ..)| outward[*j] != [0.0; 3]) {
            let normal = [0, 1, 2].map(|a| if mirrored(bits, a) { -outward[j][a] } else { outward[j][a] });
            let weight = kernel.value(dimension, dot(x, x).sqrt(), of_body(i).smoothing_length);
            face.add(x.map(|c| -c), normal, weight);
        }
        face.arm(half)
    };
    let is_met = |i: usize| model.bodies.len() > 1 || outward[i] != [0.0; 3];
    let surface: Vec<u32> = (0..p.len()).filter(|i| is_met(*i)).map(|i| i as u32).collect();
    let mut numbers = vec![0.0f32; 6 * stride];
    for i in surface.iter().map(|i| *i as usize) {
        let arm = arm(i);
        for a in 0..3 {
            numbers[a * stride + i] = outward[i][a] as f32;
            numbers[(3 + a) * stride + i] = arm[a] as f32;
        }
    }
    columns.insert(Group::Surface, card.indices(&surface).map_err(failure)?);
    columns.insert(Group::Outward, card.numbers(&numbers).map_err(failure)?);
    Ok(())
}
