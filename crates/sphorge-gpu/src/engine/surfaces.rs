//! The surfaces of bodies in contact: found once, in double precision, from the lists of the initial configuration.

use super::columns::{Group, Handles, Layout, groups};
use super::kernels::images::Planes;
use super::read_back::read;
use super::{GpuEngine, failure};
use rayon::prelude::*;
use sphorge_engine::RunFailure;
use sphorge_physics::Vector;
use sphorge_physics::surface::{NearFace, add_outward, exposed, outermost_arm};
use sphorge_physics::tensor::dot;

impl GpuEngine {
    /// Finds the surface particles and their normals, and copies them to the GPU; and facets, if bodies meet there.
    pub(super) fn find_surfaces(&mut self) -> Result<(), RunFailure> {
        if self.model.sorts_by_contact_positions() {
            self.find_normals()?;
        }
        if self.model.has_facets() { self.find_facets() } else { Ok(()) }
    }

    fn find_normals(&mut self) -> Result<(), RunFailure> {
        let whole = |group: Group| -> Result<Vec<u32>, RunFailure> {
            Ok(read(&self.card, &self.columns, group)?.into_iter().map(f32::to_bits).collect())
        };
        let (starts, list) = (whole(Group::ListStarts)?, whole(Group::List)?);
        let (model, p, stride) = (&*self.model, &self.initial, self.stride);
        let (kernel, dimension) = (model.numerics.kernel, model.dimensions.into());
        let planes = Planes::of(model);
        let mirrored = |bits: u32, axis: usize| planes.coordinate(bits, axis, 0.0).1;
        let image = |bits: u32, x: Vector<f64>| [0, 1, 2].map(|axis| planes.coordinate(bits, axis, x[axis]).0);
        let of_body = |i: usize| &model.bodies[p.body[i] as usize];
        let position = self.with_ghosts(&p.position)?;
        let all = || (0..p.len()).into_par_iter().with_min_len(1 << 7);
        let volume = self.with_ghosts(&all().map(|i| [p.mass[i] / p.density[i]]).collect::<Vec<_>>())?;
        // Every neighbour as seen from a particle: its index, which axes are mirrored, and its distance vector from the
        // particle, m.
        let neighbors = |i: usize| {
            let position = &position;
            list[starts[i] as usize..starts[i + 1] as usize].iter().map(move |entry| {
                let (j, bits) = Planes::split(*entry);
                let other = image(bits, position[j]);
                (j, bits, [0, 1, 2].map(|a| position[i][a] - other[a]))
            })
        };
        let outward = |i: usize| {
            let (h, spacing) = (of_body(i).smoothing_length, of_body(i).spacing);
            let mut outward = [0.0; 3];
            for (j, _, x) in neighbors(i) {
                add_outward(&mut outward, kernel, dimension, x, volume[j][0], h);
            }
            let is_exposed = dot(outward, outward).sqrt() > exposed(kernel, dimension, spacing, h);
            if is_exposed { outward } else { [0.0; 3] }
        };
        let outward = self.with_ghosts(&all().map(outward).collect::<Vec<Vector<f64>>>())?;
        // Behind the outermost layer, from the neighbours in that layer.
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
        let of = groups::Outward::layout();
        let mut numbers = vec![0.0f32; <groups::Outward<()> as Handles<()>>::LENGTH * stride];
        let arms: Vec<Vector<f64>> = surface.par_iter().with_min_len(1 << 7).map(|i| arm(*i as usize)).collect();
        for (i, arm) in surface.iter().map(|i| *i as usize).zip(arms) {
            for a in 0..3 {
                numbers[of.normal.axis(a).column() * stride + i] = outward[i][a] as f32;
                numbers[of.arm.axis(a).column() * stride + i] = arm[a] as f32;
            }
        }
        self.columns.insert(Group::Outward, self.card.numbers(&numbers).map_err(failure)?);
        self.wrote(Group::Outward);
        self.own_surface = surface;
        self.find_surface_ghosts()?;
        self.rebind()
    }

    /// Copies the surface particles to the GPU, ghosts behind the own particles.
    pub(super) fn find_surface_ghosts(&mut self) -> Result<(), RunFailure> {
        if !self.model.has_faces() {
            return Ok(());
        }
        self.write_facets()?;
        if !self.model.sorts_by_contact_positions() {
            return Ok(());
        }
        let own = self.initial.len();
        let mut flags = vec![[0.0]; own];
        self.own_surface.iter().for_each(|i| flags[*i as usize] = [1.0]);
        let mut surface = self.own_surface.clone();
        let ghosts = self.with_ghosts(&flags)?.split_off(own);
        surface.extend((0..ghosts.len()).filter(|k| ghosts[*k] == [1.0]).map(|k| (own + k) as u32));
        self.columns.insert(Group::Surface, self.card.indices(&surface).map_err(failure)?);
        Ok(())
    }

    /// Values of the particles of this GPU, followed by those of its ghosts.
    pub(super) fn with_ghosts<const N: usize>(&self, own: &[[f64; N]]) -> Result<Vec<[f64; N]>, RunFailure> {
        let mut all = own.to_vec();
        if let Some(domain) = &self.domain {
            all.extend(domain.of_ghosts(own)?);
        }
        Ok(all)
    }
}
