//! The force through a section: that of the particles ahead of the plane on those behind it.
//!
//! Every pair with particles on either side counts with the whole force between them: stress, viscosity, artificial
//! stress, hourglass springs, contact. The sums are those of the step, over the pairs that cross the plane only, so the
//! material behind the plane receives exactly this force and the external ones.

use super::CpuEngine;
use super::ghosts::Ghosts;
use super::records::force;
use crate::RunFailure;
use crate::halo::{self, Exchanged, GhostColumn};
use crate::lanes::PairScalar;
use crate::model::Section;
use crate::neighbors::{BLOCK, Block};
use crate::particles::Particles;
use rayon::prelude::*;
use smallvec::smallvec;
use sphorge_physics::Vector;
use sphorge_physics::section::{counted_by_row, share_through};

/// Positions of particles and ghosts at the last force evaluation, m.
struct Standing<'a> {
    own: &'a [Vector<f64>],
    ghosts: Vec<Vector<f64>>,
}

impl<'a> Standing<'a> {
    /// Images are at their exchanged positions, particles of other ranks at the positions on those ranks.
    fn new(own: &'a [Vector<f64>], ghosts: &Ghosts) -> Self {
        let mut places = vec![[0.0; 3]; ghosts.count()];
        let columns = smallvec![GhostColumn::Point(own, &mut places)];
        halo::fill(smallvec![Exchanged { halo: ghosts.halo.as_ref(), columns }]);
        for (k, (place, &source)) in places.iter_mut().zip(ghosts.halo.sources()).enumerate() {
            let is_image = source as usize != own.len() + k;
            if is_image {
                *place = ghosts.columns.position[k];
            }
        }
        Self { own, ghosts: places }
    }
}

/// On which side of the plane particles and ghosts are.
struct Sides {
    /// Distance ahead of the plane, m.
    ahead: Vec<f64>,
    /// Whether the particle, or the one a ghost stands for, counts.
    counts: Vec<bool>,
    /// How much of a pair with it the row of the other particle counts: a pair with a ghost may cross the plane a
    /// second time, as the pair of its particle with a ghost of the other.
    counted: Vec<f64>,
}

impl Sides {
    /// For particles at `places` (m) and their images.
    fn new(section: &Section, particles: &Particles, places: &Standing<'_>, ghosts: &Ghosts, spacing: f64) -> Self {
        let ahead = |x: &Vector<f64>| (0..3).map(|a| (x[a] - section.point[a]) * section.normal[a]).sum();
        let of_body = |&body: &u32| section.body.is_none_or(|wanted| wanted == body as usize);
        let count = places.own.len();
        let ahead: Vec<f64> = places.own.iter().chain(&places.ghosts).map(ahead).collect();
        let bodies = particles.body.iter().chain(&ghosts.columns.body[..ghosts.count()]);
        let of_ghost = |(ghost, &source): (usize, &u32)| {
            let shift = ahead[count + ghost] - ahead[source as usize];
            counted_by_row(shift, spacing)
        };
        let of_particles = std::iter::repeat_n(counted_by_row(0.0, spacing), count);
        let counted = of_particles.chain(ghosts.halo.sources().iter().enumerate().map(of_ghost));
        Self { counted: counted.collect(), counts: bodies.map(of_body).collect(), ahead }
    }

    /// Share of the force of `j` on `i` through the plane, seen from behind.
    fn share(&self, i: usize, j: usize) -> f64 {
        if !self.counts[i] || !self.counts[j] {
            return 0.0;
        }
        share_through(self.ahead[i], self.ahead[j], self.counted[j])
    }
}

/// Pairs of a block whose shares differ only in sign.
#[derive(Default)]
struct Crossing {
    block: Block,
    /// Their indices among the padded entries of the block they are in.
    entries: Vec<usize>,
}

impl Crossing {
    fn of(block: &Block, first: usize, sides: &Sides, share: f64) -> Option<Self> {
        let mut crossing = Self::default();
        crossing.block.clear();
        for k in 0..block.len() {
            let i = first + k;
            for (n, &j) in block.row(k).iter().enumerate() {
                if sides.share(i, j as usize).abs() == share {
                    crossing.block.push(j);
                    crossing.entries.push(block.start(k) + n);
                }
            }
            crossing.block.end_row(i as u32);
        }
        (!crossing.entries.is_empty()).then_some(crossing)
    }
}

impl<T: PairScalar> CpuEngine<T> {
    /// Force of the material ahead of a plane on that behind it at the last force evaluation, N; none before the first
    /// one.
    ///
    /// # Errors
    /// A rank is lost.
    pub(super) fn section_force(&self, section: &Section) -> Result<Option<Vector<f64>>, RunFailure> {
        if self.records.force.len() < self.particles.len() || self.lists.list.blocks().is_empty() {
            return Ok(None);
        }
        let (p, spacing) = (&self.particles, self.model.spacing);
        let places: Vec<Vector<f64>> = if self.formulation.is_initial() {
            p.position.clone()
        } else {
            let of = |record: &[T; force::LEN]| self.records.frame.decode(&[0, 1, 2].map(|a| record[force::X + a]));
            self.records.force[..p.len()].iter().map(of).collect()
        };
        let sides = Sides::new(section, p, &Standing::new(&places, &self.ghosts), &self.ghosts, spacing);
        let blocks: Vec<Vector<f64>> = self
            .lists
            .list
            .blocks()
            .par_iter()
            .enumerate()
            .map(|(b, block)| {
                let mut sum = [0.0; 3];
                for share in [0.5, 1.0] {
                    let Some(crossing) = Crossing::of(block, b * BLOCK, &sides, share) else { continue };
                    let stored =
                        self.lists.stored.as_ref().map(|s| s.block(b).part(&crossing.block, &crossing.entries));
                    let mut forces = self.forces_of_rows(b, &crossing.block, stored.as_ref());
                    self.add_hourglass_forces(b, &crossing.block, &mut forces);
                    self.add_shock_forces(b, &crossing.block, &mut forces);
                    for (k, force) in forces.iter().enumerate() {
                        let sign = if sides.ahead[b * BLOCK + k] >= 0.0 { -share } else { share };
                        add(&mut sum, sign, force);
                    }
                }
                sum
            })
            .collect();
        let blocks = self.domain.as_ref().map(|domain| domain.gather_blocks(&blocks, 1)).transpose()?.unwrap_or(blocks);
        let mut force = [[0.0; 3]];
        blocks.iter().for_each(|part| add(&mut force[0], 1.0, part));
        if let Some(contacts) = &self.contacts {
            let ghosts = contacts.ghosts(&self.ghosts);
            let standing = Standing::new(&places, ghosts);
            let sides = Sides::new(section, p, &standing, ghosts, spacing);
            let of_list = Sides::new(section, p, &Standing::new(&places, &self.ghosts), &self.ghosts, spacing);
            let add_contacts = |force: &mut [Vector<f64>]| {
                if let Some(pulls) = contacts.pulls(p, &self.ghosts, &self.lists.list) {
                    for i in 0..p.len() {
                        pulls.each(i, |j, pull| add(&mut force[0], of_list.share(i, j), &pull));
                    }
                }
                for (i, row) in contacts.foreign().blocks().iter().flat_map(|block| block.rows()) {
                    for &j in row {
                        let share = sides.share(i, j as usize);
                        if share != 0.0 {
                            let standing = (standing.own, &*standing.ghosts);
                            let push = contacts.force_of_pair(i, j, standing, p, &ghosts.columns, self.step.dt);
                            add(&mut force[0], share, &push);
                        }
                    }
                }
            };
            match &self.domain {
                None => add_contacts(&mut force),
                Some(domain) => domain.ranks.sum_in_turn(&mut force, add_contacts)?,
            }
        }
        if let Some(domain) = &self.domain {
            domain.ranks.check_lost()?;
        }
        Ok(Some(force[0]))
    }
}

fn add(sum: &mut Vector<f64>, s: f64, part: &Vector<f64>) {
    for a in 0..3 {
        sum[a] += s * part[a];
    }
}
