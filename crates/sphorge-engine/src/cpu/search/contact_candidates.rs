//! Contact candidates: particles near material that their own strain says nothing about.
//!
//! Space is divided into cells twice as wide as the reach of the kernel. Two particles within reach of each other now
//! were in adjacent cells when they were sorted, as long as none has moved by more than half of the reach since. Every
//! pair of contact candidates is therefore found from the cells: a particle is a contact candidate if the cells around
//! it contain another body, another fragment of its own body, material that was farther apart than such cells can hold,
//! or free surfaces that face each other, such as those of a slot before it closes. Images in symmetry planes and beyond
//! periodic ends count as particles do, since a body may meet its own image.

use super::super::domain::Domain;
use super::surroundings::Surroundings;
use crate::halo::Images;
use crate::neighbors::{BLOCK, CellGrid, DisplacementBound, NeighborList, bounds};
use crate::particles::Particles;
use crate::persist::{Archive, ArchiveError, Persist, persist_pieces_or_none};
use crate::{Model, RunFailure};
use rayon::prelude::*;
use sphorge_physics::{Vector, tensor::dot};
use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// Width of a cell in units of the reach.
const CELL_WIDTH: f64 = 2.0;

/// Largest initial distance of material in three adjacent cells, in cell widths: their diagonal `3 sqrt(3)`, in case it
/// has rotated, and a fifth for strain.
const FARTHEST: f64 = 6.2;

/// Particles that were farther apart at the start than this, in units of the support, do not connect fragments.
const PARTED: f64 = 1.5;

/// Length of the mean unit vector from its neighbours from which on a particle counts as one of a free surface; it is
/// 0.4 on a flat one.
const EXPOSED: f64 = 0.15;

/// Cosine of the angle between the normals of two surfaces below which they face each other; those of a corner of the
/// material do not.
const FACING: f64 = -0.3;

/// Input of the search for candidates, by particle.
#[derive(Clone, Copy, Debug)]
pub struct SearchedMaterial<'a> {
    /// Positions, m.
    pub position: &'a [Vector<f64>],
    /// Positions at the start, m.
    pub origin: &'a [Vector<f64>],
    /// Positions at the last full search, m.
    pub searched_at: &'a [Vector<f64>],
    /// Their bodies.
    pub body: &'a [u32],
    /// Their smoothing lengths, m.
    pub smoothing_length: &'a [f64],
}

/// Cells and their contents.
#[derive(Debug, Default)]
pub struct ContactCandidates {
    cells: CellGrid,
    /// Positions when particles were sorted into cells, m, and the displacement bound at that time, m.
    sorted_at: Vec<Vector<f64>>,
    displacement_at_sort: DisplacementBound,
    fragments: Fragments,
    contents: Vec<Content>,
    /// Outward unit normals of particles on free surfaces, zero for the others.
    normals: Vec<Vector<f64>>,
    /// These particles in the order of cells, and the index at which those of each cell begin.
    exposed: Vec<u32>,
    exposed_from: Vec<usize>,
    /// Whether free surfaces in the cells around each face each other.
    faces_near: Vec<AtomicBool>,
    candidates_near: Vec<bool>,
    is_candidate: Vec<bool>,
    /// Particles and images of one material within the kernel support of each other.
    held_across: Vec<[u32; 2]>,
}

/// Contents of a cell, or of the cells around one.
#[derive(Clone, Copy, Debug)]
struct Content {
    /// Smallest and largest index of a fragment.
    fragments: (u32, u32),
    /// Bounds of the material at the last full search, m.
    low: Vector<f64>,
    high: Vector<f64>,
}

impl Content {
    const NOTHING: Self = Self { fragments: (u32::MAX, 0), low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };

    fn add(&mut self, other: &Self) {
        self.fragments = (self.fragments.0.min(other.fragments.0), self.fragments.1.max(other.fragments.1));
        for a in 0..3 {
            self.low[a] = self.low[a].min(other.low[a]);
            self.high[a] = self.high[a].max(other.high[a]);
        }
    }

    fn holds_candidates(&self, farthest: f64) -> bool {
        self.fragments.0 != self.fragments.1 || (0..3).any(|a| self.high[a] - self.low[a] > farthest)
    }
}

impl ContactCandidates {
    /// Determines the contact candidates, if particles, of any rank, have moved far enough since the last time. `images`
    /// gives the planes and periodic cells in which images are made.
    pub(super) fn refresh(
        &mut self,
        images: impl FnOnce() -> Images,
        particles: &Particles,
        domain: Option<&Domain>,
        list: &NeighborList,
        displacement: DisplacementBound,
        reach: f64,
        support: f64,
    ) -> Result<(), RunFailure> {
        let allowed = Self::lasts(reach);
        if self.sorted_at.len() == particles.len() {
            if displacement.is_within(self.displacement_at_sort, allowed) {
                return Ok(());
            }
            let moved = super::moved_beyond(&particles.position, &self.sorted_at, allowed);
            if !domain.map_or(Ok(moved), |domain| domain.any(moved))? {
                return Ok(());
            }
        }
        self.displacement_at_sort = displacement;
        let seen = Surroundings::new(images(), particles, domain)?;
        self.sorted_at.clone_from(&particles.position);
        self.find_in(seen, list, reach, support)
    }

    /// How far a particle may move, m, before they have to be determined again.
    pub fn lasts(reach: f64) -> f64 {
        0.5 * (CELL_WIDTH - 1.0) * reach
    }

    /// Determines the contact candidates, from lists that contain all neighbours of one piece; `reach` is that of the
    /// lists, m. The lists need not contain images.
    ///
    /// # Errors
    /// None: there are no other ranks to lose.
    pub fn find(
        &mut self,
        model: &Model,
        material: &SearchedMaterial<'_>,
        list: &NeighborList,
        reach: f64,
    ) -> Result<(), RunFailure> {
        self.find_in(Surroundings::of_one(Images::new(model), material), list, reach, model.numerics.kernel.support())
    }

    fn find_in(
        &mut self,
        seen: Surroundings<'_>,
        list: &NeighborList,
        reach: f64,
        support: f64,
    ) -> Result<(), RunFailure> {
        let size = CELL_WIDTH * reach;
        // All that may be in a cell beside that of a particle.
        let seen = &seen.reflect(2.0 * size);
        self.cells.sort(&seen.position, size);
        self.find_held_across(seen, support);
        self.fragments.find(seen, list, support, &self.held_across)?;

        let (cells, fragments) = (&self.cells, &self.fragments.of);
        self.contents.resize(cells.cells(), Content::NOTHING);
        self.contents.par_iter_mut().enumerate().for_each(|(c, content)| {
            *content = Content::NOTHING;
            for &i in cells.members(c) {
                let (fragment, at) = (fragments[i as usize], seen.searched_at[i as usize]);
                content.add(&Content { fragments: (fragment, fragment), low: at, high: at });
            }
        });
        self.find_normals(seen, list, support)?;
        // The largest distance of particles that can come within reach before they are sorted again.
        self.find_faces(&seen.position, size);
        let (cells, contents, faces_near) = (&self.cells, &self.contents, &self.faces_near);
        self.candidates_near.resize(cells.cells(), false);
        self.candidates_near.par_iter_mut().enumerate().for_each(|(c, has_candidates)| {
            *has_candidates = !cells.members(c).is_empty() && {
                let mut around = Content::NOTHING;
                cells.cells_around(c).for_each(|other| around.add(&contents[other]));
                faces_near[c].load(Ordering::Relaxed) || around.holds_candidates(FARTHEST * size)
            };
        });
        self.is_candidate.clear();
        self.is_candidate.extend(seen.own().map(|i| self.candidates_near[cells.cell_of(i)]));
        Ok(())
    }

    /// Finds particles and images that hold a piece together, as neighbours in the lists do.
    fn find_held_across(&mut self, seen: &Surroundings<'_>, support: f64) {
        let (cells, count) = (&self.cells, seen.count());
        // Most images are farther from all particles than that.
        let reach = support * seen.smoothing_length.iter().copied().fold(0.0, f64::max);
        let (low, high) = bounds(&seen.position[..count]);
        let is_near = |x: &Vector<f64>| (0..3).all(|a| low[a] - reach <= x[a] && x[a] <= high[a] + reach);
        let of_image = |image: usize| {
            let near = cells.cells_around(cells.cell_of(image)).flat_map(|cell| cells.members(cell));
            let held = near.filter(move |&&i| (i as usize) < count && is_held(seen, i as usize, image, support));
            held.map(move |&i| [i, image as u32]).collect::<Vec<_>>()
        };
        let images = (count..seen.position.len()).into_par_iter().filter(|&image| is_near(&seen.position[image]));
        self.held_across = images.flat_map_iter(of_image).collect();
        self.held_across.sort_unstable();
    }

    /// Normals of free surfaces: away from the neighbours of the same body. Neighbours that were farther apart at the
    /// start do not count, so that a slot that has closed still has its surfaces.
    fn find_normals(&mut self, seen: &Surroundings<'_>, list: &NeighborList, support: f64) -> Result<(), RunFailure> {
        let (position, own, count) = (&seen.position, seen.own(), seen.count());
        let across = &self.held_across;
        self.normals.resize(own.len(), [0.0; 3]);
        self.normals.par_iter_mut().enumerate().for_each(|(k, normal)| {
            let (mut sum, mut neighbors) = ([0.0; 3], 0.0);
            let i = own.start + k;
            let in_list =
                list.row(k).iter().map(|&j| seen.point(j)).filter(|&j| j < count && is_held(seen, i, j, support));
            let first = across.partition_point(|&[of, _]| (of as usize) < i);
            let images = across[first..].iter().take_while(|&&[of, _]| of as usize == i);
            for j in in_list.chain(images.map(|&[_, image]| image as usize)) {
                let d: Vector<f64> = [0, 1, 2].map(|a| position[i][a] - position[j][a]);
                let r = dot(d, d).sqrt();
                if r > 0.0 {
                    neighbors += 1.0;
                    for a in 0..3 {
                        sum[a] += d[a] / r;
                    }
                }
            }
            let length = dot(sum, sum).sqrt();
            *normal = if length > EXPOSED * neighbors { sum.map(|c| c / length) } else { [0.0; 3] };
        });
        if let Some(domain) = seen.domain {
            self.normals = domain.gather(&self.normals)?;
        }
        for image in seen.images() {
            self.normals.push(image.vector(self.normals[image.source as usize]));
        }
        Ok(())
    }

    /// Determines for each cell whether free surfaces in the cells around it that are nearer than a distance, m, face
    /// each other.
    fn find_faces(&mut self, position: &[Vector<f64>], nearer: f64) {
        let Self { cells, normals, exposed, exposed_from, faces_near, .. } = self;
        exposed.clear();
        exposed_from.clear();
        for c in 0..cells.cells() {
            exposed_from.push(exposed.len());
            exposed.extend(cells.members(c).iter().filter(|&&i| normals[i as usize] != [0.0; 3]));
        }
        exposed_from.push(exposed.len());
        faces_near.clear();
        faces_near.resize_with(cells.cells(), || AtomicBool::new(false));

        let (normals, exposed, exposed_from, faces_near) = (&*normals, &*exposed, &*exposed_from, &*faces_near);
        let face = |i: usize, j: usize| {
            let d: Vector<f64> = [0, 1, 2].map(|a| position[j][a] - position[i][a]);
            dot(normals[i], normals[j]) < FACING
                && dot(d, d) < nearer * nearer
                && dot(d, normals[i]) > 0.0
                && dot(d, normals[j]) < 0.0
        };
        let of = |c: usize| &exposed[exposed_from[c]..exposed_from[c + 1]];
        let do_face =
            |c: usize, other: usize| of(c).iter().any(|&i| of(other).iter().any(|&j| face(i as usize, j as usize)));
        (0..cells.cells()).into_par_iter().filter(|&c| !of(c).is_empty()).for_each(|c| {
            // Every pair of cells once, and all cells that have both of them around them.
            for (place, other) in cells.cells_around(c).enumerate().filter(|(_, other)| *other >= c) {
                if do_face(c, other) {
                    cells.cells_around_both(c, place).for_each(|c| faces_near[c].store(true, Ordering::Relaxed));
                }
            }
        });
    }

    /// Whether the particle is a contact candidate.
    pub fn is_candidate(&self, i: usize) -> bool {
        self.is_candidate[i]
    }

    /// Makes the next [`Self::refresh`] search again.
    pub(super) fn forget(&mut self) {
        self.sorted_at.clear();
        // For other particles, and as many as this rank had then.
        self.is_candidate.clear();
    }

    /// Whether the loaded data are those of `count` particles.
    pub(super) fn fits(&self, count: usize) -> bool {
        let flags = self.is_candidate.len();
        match self.sorted_at.len() {
            // Nothing was sorted yet, or the data were discarded.
            0 => flags == 0 || flags == count,
            sorted => sorted == count && flags == count,
        }
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        self.cells.bytes()
            + 24 * self.sorted_at.capacity()
            + 4 * (self.fragments.of.capacity() + self.fragments.joined.capacity())
            + size_of::<Content>() * self.contents.capacity()
            + self.candidates_near.capacity()
            + 24 * self.normals.capacity()
            + 4 * self.exposed.capacity()
            + 8 * self.exposed_from.capacity()
            + self.faces_near.capacity()
            + self.is_candidate.capacity()
            + 8 * self.held_across.capacity()
    }
}

/// Whether two points are neighbours that hold a piece together: of one body, within the kernel support of each other, and not much farther apart at the
/// start.
fn is_held(seen: &Surroundings<'_>, i: usize, j: usize, support: f64) -> bool {
    if seen.body[i] != seen.body[j] {
        return false;
    }
    let reach = 0.5 * support * (seen.smoothing_length[i] + seen.smoothing_length[j]);
    let d: Vector<f64> = [0, 1, 2].map(|a| seen.position[i][a] - seen.position[j][a]);
    dot(d, d) < reach * reach && {
        let at_start = seen.at_start(i, j);
        dot(at_start, at_start) < (PARTED * reach).powi(2)
    }
}

/// Fragments: particles of a body that are connected through neighbours.
#[derive(Debug, Default)]
struct Fragments {
    /// Smallest index of a particle of the same fragment.
    of: Vec<u32>,
    /// While they are joined, an index of the same fragment that is no larger; that of the smallest is its own.
    joined: Vec<AtomicU32>,
}

impl Fragments {
    /// Joins particles that are in the list, and images in `across`, where they hold a piece together: fragments that meet stay fragments.
    fn find(
        &mut self,
        seen: &Surroundings<'_>,
        list: &NeighborList,
        support: f64,
        across: &[[u32; 2]],
    ) -> Result<(), RunFailure> {
        self.joined.clear();
        self.joined.extend((0..seen.position.len() as u32).map(AtomicU32::new));
        // Which of the threads joins what does not matter: the smallest index of a fragment is the same.
        let (this, first) = (&*self, seen.own().start);
        seen.own().into_par_iter().with_min_len(BLOCK).for_each(|i| {
            for &j in list.row(i - first) {
                let j = seen.point(j);
                // Those already joined, as most are, need not be examined again.
                if j < i && this.root(i as u32) != this.root(j as u32) && is_held(seen, i, j, support) {
                    this.join(i as u32, j as u32);
                }
            }
        });
        self.join_among_ranks(seen.domain)?;
        self.join_images(seen);
        across.iter().for_each(|&[i, image]| self.join(i, image));
        // Images of what images have joined.
        self.join_images(seen);
        let mut of = std::mem::take(&mut self.of);
        of.resize(self.joined.len(), 0);
        let this = &*self;
        of.par_iter_mut().with_min_len(BLOCK).enumerate().for_each(|(i, of)| *of = this.root(i as u32));
        self.of = of;
        Ok(())
    }

    /// Joins images in the same planes and cells whose particles are joined.
    fn join_images(&self, seen: &Surroundings<'_>) {
        let mut first_of = HashMap::new();
        for (k, image) in seen.images().iter().enumerate() {
            let (source, place) = image.identity();
            let number = (seen.count() + k) as u32;
            let first = *first_of.entry((self.root(source), place)).or_insert(number);
            self.join(number, first);
        }
    }

    /// Joins what the rows of other ranks hold together: fragments span ranks. The smallest index of each does not depend on who has joined what.
    fn join_among_ranks(&self, domain: Option<&Domain>) -> Result<(), RunFailure> {
        let Some(domain) = domain else { return Ok(()) };
        let mut own = Vec::new();
        for i in 0..self.joined.len() as u32 {
            let root = self.root(i);
            if root != i {
                own.push([i, root]);
            }
        }
        for [i, root] in domain.ranks.gather_all(&own)? {
            self.join(i, root);
        }
        Ok(())
    }

    fn root(&self, mut i: u32) -> u32 {
        loop {
            let above = self.joined[i as usize].load(Ordering::Relaxed);
            if above == i {
                return i;
            }
            let next = self.joined[above as usize].load(Ordering::Relaxed);
            if next != above {
                // Only shorter ways are written, so it does not matter who was faster.
                let _ = self.joined[i as usize].compare_exchange(above, next, Ordering::Relaxed, Ordering::Relaxed);
            }
            i = next;
        }
    }

    fn join(&self, i: u32, j: u32) {
        let (mut i, mut j) = (self.root(i), self.root(j));
        while i != j {
            let (low, high) = (i.min(j), i.max(j));
            // Unless another thread has just put that fragment below another one.
            if self.joined[high as usize].compare_exchange(high, low, Ordering::Relaxed, Ordering::Relaxed).is_ok() {
                return;
            }
            (i, j) = (self.root(low), self.root(high));
        }
    }
}

impl ContactCandidates {
    /// Saves or loads the data of `count` particles. Cells, their contents and fragments are determined again whenever
    /// particles are sorted; the contact candidates are valid until then.
    pub(super) fn persist(&mut self, count: usize, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        persist_pieces_or_none(&mut self.sorted_at, count, &format!("{name}.sorted_at"), archive)?;
        self.displacement_at_sort.persist(&format!("{name}.displacement_at_sort"), archive)?;
        persist_pieces_or_none(&mut self.is_candidate, count, &format!("{name}.is_candidate"), archive)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::SymmetryPlane;
    use crate::neighbors::{Reach, brute_force};

    /// A row of ten particles a spacing of one apart, broken between the fifth and the sixth, whose second half stands
    /// `height` above it.
    fn broken_row(height: f64, second_body: u32) -> Particles {
        let mut particles = Particles::new(10);
        for i in 0..10 {
            let second = i >= 5;
            particles.position[i] = [i as f64, if second { height } else { 0.0 }, 0.0];
            particles.body[i] = if second { second_body } else { 0 };
            particles.smoothing_length[i] = 0.6;
        }
        particles
    }

    fn flags(particles: &Particles, searched_at: &[Vector<f64>]) -> Vec<bool> {
        let reach = Reach::new(&particles.smoothing_length, 2.0);
        let list = brute_force(&particles.position, 10, &reach);
        let mut candidates = ContactCandidates::default();
        let mut particles = particles.clone();
        particles.searched_at = searched_at.to_vec();
        particles.origin = searched_at.to_vec();
        candidates.refresh(Images::default, &particles, None, &list, DisplacementBound::default(), 1.2, 2.0).unwrap();
        (0..10).map(|i| candidates.is_candidate(i)).collect()
    }

    #[test]
    fn whole_material_has_no_candidates_and_fragments_and_bodies_have() {
        let whole = broken_row(0.0, 0);
        assert_eq!(flags(&whole, &whole.position), [false; 10]);
        let fragments = broken_row(1.5, 0);
        let near = flags(&fragments, &fragments.position);
        assert!(near[4] && near[5] && !near[0], "{near:?}");
        let bodies = broken_row(0.0, 1);
        let near = flags(&bodies, &bodies.position);
        assert!(near[4] && near[5] && !near[0] && !near[9], "{near:?}");
    }

    #[test]
    fn material_that_came_from_afar_is_strange() {
        let now = broken_row(0.0, 0);
        let mut then = now.position.clone();
        then[4][1] += 100.0;
        let near = flags(&now, &then);
        assert!(near[4] && near[5] && !near[9], "{near:?}");
    }

    #[test]
    fn faces_of_a_slot_are_candidates_and_the_outside_is_not() {
        // A bar of 60 by 12 that is slit from its right end to its middle, 2 wide.
        let mut points = Vec::new();
        for x in 0..60 {
            for y in 0..12 {
                if x < 30 || !(5..7).contains(&y) {
                    points.push([f64::from(x), f64::from(y), 0.0]);
                }
            }
        }
        let mut particles = Particles::new(points.len());
        particles.position.clone_from(&points);
        (particles.searched_at, particles.origin) = (points.clone(), points.clone());
        particles.smoothing_length.fill(0.6);
        let list = brute_force(&points, points.len(), &Reach::new(&particles.smoothing_length, 2.0));
        let mut candidates = ContactCandidates::default();
        candidates.refresh(Images::default, &particles, None, &list, DisplacementBound::default(), 1.6, 2.0).unwrap();
        for (i, [x, y, _]) in points.into_iter().enumerate() {
            let in_slot = x > 35.0 && (y == 4.0 || y == 7.0);
            assert!(!in_slot || candidates.is_candidate(i), "{x} {y}");
            assert!(x > 20.0 || !candidates.is_candidate(i), "{x} {y}");
        }
    }

    /// A square of material and a lone particle a little more than the kernel reach beside it, which has no neighbour and so no normal that could face the
    /// square. Whether particles near the lone one, far in the square, and it itself are candidates.
    fn beside_a_square(body: u32) -> [bool; 3] {
        let mut points: Vec<Vector<f64>> = (0..400).map(|k| [f64::from(k % 20), f64::from(k / 20), 0.0]).collect();
        points.push([20.5, 10.0, 0.0]);
        let mut particles = Particles::new(points.len());
        particles.position.clone_from(&points);
        (particles.searched_at, particles.origin) = (points.clone(), points.clone());
        particles.smoothing_length.fill(0.6);
        particles.body[400] = body;
        let list = brute_force(&points, points.len(), &Reach::new(&particles.smoothing_length, 2.0));
        assert!(list.row(400).is_empty());
        let mut candidates = ContactCandidates::default();
        candidates.refresh(Images::default, &particles, None, &list, DisplacementBound::default(), 1.6, 2.0).unwrap();
        [10 * 20 + 19, 10 * 20 + 2, 400].map(|i| candidates.is_candidate(i))
    }

    /// Which columns, by `x`, of a square from `x = first` have candidates, beside these planes and in this periodic cell along `x`.
    fn columns_with_candidates(first: f64, symmetry: Vec<SymmetryPlane>, periodic: Option<(f64, f64)>) -> Vec<f64> {
        let points: Vec<Vector<f64>> = (0..400).map(|k| [first + f64::from(k % 20), f64::from(k / 20), 0.0]).collect();
        let mut particles = Particles::new(points.len());
        particles.position.clone_from(&points);
        (particles.searched_at, particles.origin) = (points.clone(), points.clone());
        particles.smoothing_length.fill(0.6);
        let list = brute_force(&points, points.len(), &Reach::new(&particles.smoothing_length, 2.0));
        let mut candidates = ContactCandidates::default();
        let images = Images::of(symmetry, [periodic, None, None]);
        let nowhere = DisplacementBound::default();
        candidates.refresh(|| images, &particles, None, &list, nowhere, 1.6, 2.0).unwrap();
        let in_middle = 10 * 20..11 * 20;
        in_middle.filter(|&i| candidates.is_candidate(i)).map(|i| points[i][0]).collect()
    }

    #[test]
    fn a_body_is_a_candidate_for_its_image_unless_they_are_one() {
        let plane = |position| vec![SymmetryPlane { axis: 0, position, side: 1.0 }];
        // Its face is a spacing and a half from its image, then half a spacing, as lattices are that a plane cuts; then far away.
        let near = columns_with_candidates(0.75, plane(0.0), None);
        assert!(near.first() == Some(&0.75) && near.iter().all(|x| *x < 8.0), "{near:?}");
        assert!(columns_with_candidates(0.5, plane(0.0), None).is_empty());
        assert!(columns_with_candidates(20.0, plane(0.0), None).is_empty());
        // The same beyond the ends of a cell, whose images of both faces count.
        let near = columns_with_candidates(1.0, Vec::new(), Some((0.0, 21.0)));
        assert!(near.first() == Some(&1.0) && near.last() == Some(&20.0) && near.len() < 16, "{near:?}");
        assert!(columns_with_candidates(0.5, Vec::new(), Some((0.0, 20.0))).is_empty());
        assert!(columns_with_candidates(10.0, Vec::new(), Some((0.0, 40.0))).is_empty());
    }

    #[test]
    fn another_body_is_a_candidate_without_a_surface() {
        assert_eq!(beside_a_square(1), [true, false, true]);
    }

    #[test]
    fn a_fragment_of_the_same_body_is_a_candidate_without_a_surface() {
        assert_eq!(beside_a_square(0), [true, false, true]);
    }

    #[test]
    fn a_slot_that_has_closed_still_has_its_surfaces() {
        // Millimetres; the halves were five spacings apart.
        let places: Vec<[usize; 2]> = (0..200).map(|k| [k / 10, k % 10]).collect();
        let at = |gap: f64| {
            let place =
                |&[x, y]: &[usize; 2]| [1e-3 * (x as f64 + if x < 10 { 0.0 } else { gap }), 1e-3 * y as f64, 0.0];
            places.iter().map(place).collect::<Vec<Vector<f64>>>()
        };
        let mut particles = Particles::new(places.len());
        (particles.position, particles.origin, particles.searched_at) = (at(0.0), at(5.0), at(0.0));
        particles.smoothing_length.fill(0.6e-3);
        let list = brute_force(&particles.position, places.len(), &Reach::new(&particles.smoothing_length, 2.0));
        let mut candidates = ContactCandidates::default();
        candidates
            .refresh(Images::default, &particles, None, &list, DisplacementBound::default(), 1.2e-3, 2.0)
            .unwrap();
        for (&[x, y], normal) in places.iter().zip(&candidates.normals).filter(|([_, y], _)| (1..9).contains(y)) {
            let expected = match x {
                9 | 19 => [1.0, 0.0, 0.0],
                0 | 10 => [-1.0, 0.0, 0.0],
                _ => [0.0; 3],
            };
            assert!((0..3).all(|a| (normal[a] - expected[a]).abs() < 1e-9), "{x} {y}: {normal:?}");
        }
    }

    #[test]
    fn faces_are_found_as_by_all_pairs_around_every_cell() {
        // A cloud whose particles, a third of which are exposed, look anywhere.
        let mut seed = 7u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) as f64 / f64::from(1u32 << 31)
        };
        for spread in [6.0, 14.0, 20.0] {
            let mut candidates = ContactCandidates::default();
            let points: Vec<Vector<f64>> = (0..300).map(|_| [0; 3].map(|_| spread * random())).collect();
            candidates.normals = (0..300)
                .map(|_| {
                    let v = [0; 3].map(|_| 2.0 * random() - 1.0);
                    let length = dot(v, v).sqrt();
                    if random() < 0.33 { v.map(|c| c / length) } else { [0.0; 3] }
                })
                .collect();
            let size = 2.0;
            candidates.cells.sort(&points, size);
            candidates.find_faces(&points, size);
            let (cells, normals) = (&candidates.cells, &candidates.normals);
            let (mut found, mut missing) = (0, 0);
            for c in (0..cells.cells()).filter(|&c| !cells.members(c).is_empty()) {
                let around: Vec<usize> =
                    cells.cells_around(c).flat_map(|c| cells.members(c)).map(|&i| i as usize).collect();
                let faces = around.iter().any(|&i| {
                    around.iter().any(|&j| {
                        let d: Vector<f64> = [0, 1, 2].map(|a| points[j][a] - points[i][a]);
                        let (out, back) = (dot(d, normals[i]), dot(d, normals[j]));
                        dot(normals[i], normals[j]) < FACING && dot(d, d) < size * size && out > 0.0 && back < 0.0
                    })
                });
                assert_eq!(candidates.faces_near[c].load(Ordering::Relaxed), faces, "{spread}, cell {c}");
                if faces { found += 1 } else { missing += 1 }
            }
            assert!(found > 0 && (missing > 0 || spread < 10.0), "{spread}: {found} and {missing}");
        }
    }
}
