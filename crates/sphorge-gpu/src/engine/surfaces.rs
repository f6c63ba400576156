//! The surface of a body that meets itself: found once, in double precision, of the lists of the initial configuration.

use super::columns::{Columns, Group};
use super::failure;
use super::kernels::images::Mirrors;
use crate::device::Card;
use sphorge_engine::{Model, Particles, RunFailure};
use sphorge_physics::Vector;
use sphorge_physics::surface::{add_outward, exposed, outermost_arm};
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
    let mirrored = |bits: u32, axis: usize| bits >> axis & 1 == 1;
    let image = |bits: u32, x: Vector<f64>| {
        [0, 1, 2].map(|axis| match model.symmetry.iter().find(|plane| plane.axis == axis && mirrored(bits, axis)) {
            Some(plane) => 2.0 * plane.position - x[axis],
            None => x[axis],
        })
    };
    let mut surface: Vec<u32> = Vec::new();
    let mut numbers = vec![0.0f32; 6 * stride];
    for i in 0..p.len() {
        let body = &model.bodies[p.body[i] as usize];
        let (h, spacing) = (body.smoothing_length, body.spacing);
        let mut outward = [0.0; 3];
        for entry in &list[starts[i] as usize..starts[i + 1] as usize] {
            let (j, bits) = Mirrors::split(*entry);
            let other = image(bits, p.position[j]);
            let x = [0, 1, 2].map(|a| p.position[i][a] - other[a]);
            add_outward(&mut outward, kernel, dimension, x, p.mass[j] / p.density[j], h);
        }
        if dot(outward, outward).sqrt() > exposed(kernel, dimension, spacing, h) {
            surface.push(i as u32);
            let arm = outermost_arm(outward, 0.5 * spacing);
            for a in 0..3 {
                numbers[a * stride + i] = outward[a] as f32;
                numbers[(3 + a) * stride + i] = arm[a] as f32;
            }
        }
    }
    columns.insert(Group::Surface, card.indices(&surface).map_err(failure)?);
    columns.insert(Group::Outward, card.numbers(&numbers).map_err(failure)?);
    Ok(())
}
