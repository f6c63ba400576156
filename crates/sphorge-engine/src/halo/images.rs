//! Mirror images behind symmetry planes and copies beyond periodic ends.

use super::{GhostColumn, Halo, Incoming, Outgoing, Packed};
use crate::model::{Model, SymmetryPlane};
use crate::persist::{Archive, ArchiveError, Persist, require};
use rayon::prelude::*;
use smallvec::SmallVec;
use sphorge_physics::{Real, SymmetricTensor, Tensor, Vector};
use std::collections::HashSet;

/// An image: its source with a sign and a shift per axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Image {
    /// Point it is an image of.
    pub(crate) source: u32,
    /// +1, or -1 along axes it is mirrored on.
    sign: Vector<f64>,
    /// m.
    shift: Vector<f64>,
}

impl Image {
    /// Key of an image: its particle, planes and cells.
    pub(crate) fn identity(&self) -> (u32, [Vector<u64>; 2]) {
        (self.source, [self.sign, self.shift].map(|of_axes| of_axes.map(f64::to_bits)))
    }

    /// +1, or -1 along axes it is mirrored on.
    #[inline(always)]
    pub(crate) fn sign(&self) -> Vector<f64> {
        self.sign
    }

    /// Position of the image when its source is at `p`, m.
    #[inline(always)]
    pub(crate) fn position(&self, p: &Vector<f64>) -> Vector<f64> {
        [0, 1, 2].map(|a| self.sign[a] * p[a] + self.shift[a])
    }

    /// A vector of the image whose source has `v`.
    #[inline(always)]
    pub(crate) fn vector(&self, v: Vector<f64>) -> Vector<f64> {
        [0, 1, 2].map(|a| v[a] * self.sign[a])
    }

    /// The axes it is mirrored on: bit 0 for x.
    #[inline(always)]
    fn mirrored(&self) -> usize {
        (0..3).map(|a| usize::from(self.sign[a] < 0.0) << a).sum()
    }

    fn symmetric(&self, tensor: SymmetricTensor<f64>) -> SymmetricTensor<f64> {
        let mut c = tensor.to_array();
        for (value, (a, b)) in c.iter_mut().zip(PAIRS) {
            *value = *value * self.sign[a] * self.sign[b];
        }
        SymmetricTensor::from_array(c)
    }

    fn tensor(&self, tensor: Tensor<f64>) -> Tensor<f64> {
        [0, 1, 2].map(|a| [0, 1, 2].map(|b| tensor[a][b] * self.sign[a] * self.sign[b]))
    }
}

/// Fills a column of images from those of particles and of the first `others` ghosts, which are not images and are
/// filled before. The images follow these, and their sources are indices of particles and ghosts, particles first.
pub(super) fn reflect(images: &[Image], others: usize, column: GhostColumn<'_>) {
    match column {
        GhostColumn::Scalar(own, ghosts) => each(images, others, own, ghosts, |_, v| v),
        GhostColumn::Integer(own, ghosts) => each(images, others, own, ghosts, |_, v| v),
        GhostColumn::Point(own, ghosts) => each(images, others, own, ghosts, |image, p| image.position(&p)),
        GhostColumn::Vector(own, ghosts) => each(images, others, own, ghosts, Image::vector),
        GhostColumn::Symmetric(own, ghosts) => each(images, others, own, ghosts, Image::symmetric),
        GhostColumn::Tensor(own, ghosts) => each(images, others, own, ghosts, Image::tensor),
        GhostColumn::Single(records) => packed(images, others, records),
        GhostColumn::Double(records) => packed(images, others, records),
    }
}

/// Entries of the widest records.
const WIDEST: usize = 16;

/// Images that a thread fills at a time: fewer are not worth a second thread.
const SHARE: usize = 256;

/// Each image behind the other ghosts, filled from its source by `of`.
fn each<V: Copy + Send + Sync>(
    images: &[Image],
    others: usize,
    own: &[V],
    ghosts: &mut [V],
    of: impl Fn(&Image, V) -> V + Sync,
) {
    let (others, ghosts) = ghosts.split_at_mut(others);
    let others = &*others;
    images.par_chunks(SHARE).zip(ghosts.par_chunks_mut(SHARE)).for_each(|(images, ghosts)| {
        for (image, ghost) in images.iter().zip(ghosts) {
            let source = image.source as usize;
            *ghost = of(image, source.checked_sub(own.len()).map_or_else(|| own[source], |k| others[k]));
        }
    });
}

fn packed<T: Real + Send + Sync>(images: &[Image], others: usize, records: Packed<'_, T>) {
    let Packed { own, ghosts, axes } = records;
    let width = axes.len();
    let (others, ghosts) = ghosts.split_at_mut(others * width);
    let others = &*others;
    // What the entries of a record are multiplied by, for each of the eight sets of axes that an image is mirrored on. A step does not allocate.
    let factors: SmallVec<[T; 8 * WIDEST]> = (0..8u8)
        .flat_map(|mirrored| axes.iter().map(move |(first, second)| (mirrored & first, mirrored & second)))
        .map(|(first, second)| if (first != 0) == (second != 0) { T::one() } else { -T::one() })
        .collect();
    images.par_chunks(SHARE).zip(ghosts.par_chunks_mut(SHARE * width)).for_each(|(images, ghosts)| {
        for (image, record) in images.iter().zip(ghosts.chunks_exact_mut(width)) {
            let start = image.source as usize * width;
            let source = start.checked_sub(own.len()).map_or_else(|| &own[start..], |start| &others[start..]);
            let of_image = &factors[width * image.mirrored()..][..width];
            for ((entry, source), factor) in record.iter_mut().zip(&source[..width]).zip(of_image) {
                *entry = *source * *factor;
            }
        }
    });
}

/// The planes and periodic axes of a model, and the images they make.
#[derive(Clone, Debug, Default)]
pub struct Images {
    symmetry: Vec<SymmetryPlane>,
    periodic: [Option<(f64, f64)>; 3],
    images: Vec<Image>,
    /// Images before the last rebuild.
    former: Vec<Image>,
    sources: Vec<u32>,
}

/// One kind of image along an axis: its sign and shift (m), and who needs it.
struct Kind {
    sign: f64,
    shift: f64,
    needed: Needed,
}

/// The source coordinates along an axis (m) whose images can be neighbours of a particle.
enum Needed {
    /// From the first to the second.
    Between(f64, f64),
    /// Behind a symmetry plane that particles have passed. `i` sees the image of `j` where `|x_i + x_j| < reach`, with
    /// coordinates from the plane on. `j` then has to see the image of `i`, on whichever side the two are: sums would
    /// otherwise not be adjoint, and neither energy nor momentum be conserved.
    Mirrored { plane: f64, skip: f64, reach: f64, occupied: HashSet<i64> },
}

impl Needed {
    /// Those of images behind a plane.
    fn behind(plane: &SymmetryPlane, positions: &[Vector<f64>], reach: f64) -> Self {
        let (axis, position) = (plane.axis, plane.position);
        // A particle on the plane is its own image.
        let skip = 1e-9 * reach;
        if positions.iter().all(|p| plane.side * (p[axis] - position) >= -skip) {
            return match plane.side > 0.0 {
                true => Self::Between(position + skip, position + reach),
                false => Self::Between(position - reach, position - skip),
            };
        }
        let mut occupied = HashSet::new();
        let mut last = None;
        for p in positions {
            // Particles that follow each other are often near each other.
            let layer = Some(Self::layer(p[axis] - position, reach));
            if layer != last {
                occupied.extend(layer);
                last = layer;
            }
        }
        Self::Mirrored { plane: position, skip, reach, occupied }
    }

    /// The layer, as thick as the reach, in which a particle at this distance from a plane is.
    fn layer(distance: f64, reach: f64) -> i64 {
        (distance / reach).floor() as i64
    }

    /// Whether the image of a source with this coordinate is needed.
    fn of(&self, x: f64) -> bool {
        match self {
            Self::Between(first, last) => x >= *first && x <= *last,
            Self::Mirrored { plane, skip, reach, occupied } => {
                let layer = Self::layer(plane - x, *reach);
                (x - plane).abs() >= *skip && (layer - 1..=layer + 1).any(|layer| occupied.contains(&layer))
            }
        }
    }
}

/// Axis pairs of the symmetric components xx, yy, zz, xy, yz, xz.
const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)];

impl Images {
    /// No images yet.
    pub fn new(model: &Model) -> Self {
        Self::of(model.symmetry.clone(), model.periodic)
    }

    /// Those of these planes and periodic cells, m; no images yet.
    pub(crate) fn of(symmetry: Vec<SymmetryPlane>, periodic: [Option<(f64, f64)>; 3]) -> Self {
        Self { symmetry, periodic, ..Self::default() }
    }

    /// With these images and the same planes and periodic axes.
    pub(crate) fn with(&self, images: &[Image]) -> Self {
        let sources = images.iter().map(|image| image.source).collect();
        Self { images: images.to_vec(), sources, ..self.planes() }
    }

    /// Adds the missing images within `reach` (m) of particles at these positions. The others keep their indices,
    /// wherever they are now.
    pub(crate) fn supplement(&mut self, positions: &[Vector<f64>], reach: f64) {
        let mut present = self.planes();
        present.rebuild(positions, reach + self.farthest_outside(positions));
        let known: HashSet<_> = self.images.iter().map(Image::identity).collect();
        self.images.extend(present.images.iter().filter(|image| !known.contains(&image.identity())));
        self.sources.clear();
        self.sources.extend(self.images.iter().map(|image| image.source));
    }

    /// How far a particle is beyond a periodic end, m. Particles that do not wrap are neighbours of copies of particles
    /// that are equally farther from it on this side.
    fn farthest_outside(&self, positions: &[Vector<f64>]) -> f64 {
        let beyond = |p: &Vector<f64>| {
            let ends =
                self.periodic.iter().zip(p).filter_map(|(cell, x)| cell.map(|(low, high)| (low - x).max(x - high)));
            ends.fold(0.0, f64::max)
        };
        positions.iter().map(beyond).fold(0.0, f64::max)
    }

    /// The shortest of the vectors that differ by whole periods, m.
    pub(crate) fn shortest(&self, mut vector: Vector<f64>) -> Vector<f64> {
        for (x, cell) in vector.iter_mut().zip(&self.periodic) {
            if let Some((low, high)) = cell {
                *x -= (high - low) * (*x / (high - low)).round();
            }
        }
        vector
    }

    /// The same planes and periodic axes, without images.
    pub(crate) fn planes(&self) -> Self {
        Self::of(self.symmetry.clone(), self.periodic)
    }
}

impl Halo for Images {
    fn another(&self) -> Box<dyn Halo> {
        Box::new(self.planes())
    }

    fn is_empty(&self) -> bool {
        self.symmetry.is_empty() && self.periodic.iter().all(Option::is_none)
    }

    fn has_images(&self) -> bool {
        !self.is_empty()
    }

    fn count(&self) -> usize {
        self.images.len()
    }

    fn longest_shift(&self) -> f64 {
        self.periodic.iter().flatten().fold(0.0, |longest: f64, (low, high)| longest.max(high - low))
    }

    fn wrap(&self, positions: &mut [Vector<f64>], started: &mut [Vector<f64>]) -> bool {
        let mut left = false;
        for (axis, cell) in self.periodic.iter().enumerate() {
            let Some((low, high)) = *cell else { continue };
            for (i, p) in positions.iter_mut().enumerate() {
                if p[axis] < low || p[axis] >= high {
                    let inside = low + (p[axis] - low).rem_euclid(high - low);
                    if let Some(start) = started.get_mut(i) {
                        start[axis] += inside - p[axis];
                    }
                    p[axis] = inside;
                    left = true;
                }
            }
        }
        left
    }

    /// Later axes also repeat earlier images, which fills edges and corners.
    fn rebuild(&mut self, positions: &[Vector<f64>], reach: f64) -> bool {
        std::mem::swap(&mut self.images, &mut self.former);
        self.images.clear();
        for axis in 0..3 {
            let before = self.images.len();
            let mut kinds: [Option<Kind>; 2] = [const { None }; 2];
            if let Some((low, high)) = self.periodic[axis] {
                let length = high - low;
                let kind = |shift, first, last| Some(Kind { sign: 1.0, shift, needed: Needed::Between(first, last) });
                kinds = [kind(length, f64::NEG_INFINITY, low + reach), kind(-length, high - reach, f64::INFINITY)];
            }
            let planes = self.symmetry.iter().filter(|s| s.axis == axis);
            for (kind, plane) in kinds.iter_mut().filter(|i| i.is_none()).zip(planes) {
                let needed = Needed::behind(plane, positions, reach);
                *kind = Some(Kind { sign: -1.0, shift: 2.0 * plane.position, needed });
            }
            for Kind { sign, shift, needed } in kinds.into_iter().flatten() {
                for (i, p) in positions.iter().enumerate() {
                    if needed.of(p[axis]) {
                        let mut image = Image { source: i as u32, sign: [1.0; 3], shift: [0.0; 3] };
                        image.sign[axis] = sign;
                        image.shift[axis] = shift;
                        self.images.push(image);
                    }
                }
                for k in 0..before {
                    let mut image = self.images[k];
                    if needed.of(image.position(&positions[image.source as usize])[axis]) {
                        image.sign[axis] *= sign;
                        image.shift[axis] = sign * image.shift[axis] + shift;
                        self.images.push(image);
                    }
                }
            }
        }
        self.sources.clear();
        self.sources.extend(self.images.iter().map(|image| image.source));
        self.images != self.former
    }

    fn pack(&self, _: &[GhostColumn<'_>], _: &mut Outgoing) {}

    fn unpack(&self, column: GhostColumn<'_>, _: &mut Incoming) {
        reflect(&self.images, 0, column);
    }

    fn sources(&self) -> &[u32] {
        &self.sources
    }

    /// In the order of creation.
    fn images(&self) -> &[Image] {
        &self.images
    }

    fn bytes(&self) -> usize {
        size_of::<Image>() * (self.images.capacity() + self.former.capacity()) + 4 * self.sources.capacity()
    }

    fn persist(&mut self, name: &str, archive: &mut dyn Archive) -> Result<(), ArchiveError> {
        let of = |part: &str| format!("{name}.{part}");
        let mut sources: Vec<u32> = self.images.iter().map(|image| image.source).collect();
        let mut signs: Vec<Vector<f64>> = self.images.iter().map(|image| image.sign).collect();
        let mut shifts: Vec<Vector<f64>> = self.images.iter().map(|image| image.shift).collect();
        sources.persist(&of("sources"), archive)?;
        signs.persist(&of("signs"), archive)?;
        shifts.persist(&of("shifts"), archive)?;
        require(signs.len() == sources.len(), &of("signs"))?;
        require(shifts.len() == sources.len(), &of("shifts"))?;
        let parts = sources.into_iter().zip(signs).zip(shifts);
        self.images = parts.map(|((source, sign), shift)| Image { source, sign, shift }).collect();
        self.sources = self.images.iter().map(|image| image.source).collect();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Exchanged, parcels};
    use super::*;
    use smallvec::smallvec;

    fn fill(halo: &Images, column: GhostColumn<'_>) {
        parcels::fill(smallvec![Exchanged { halo, columns: smallvec![column] }]);
    }

    #[test]
    fn two_planes_and_a_corner_make_three_images() {
        let plane = |axis| SymmetryPlane { axis, position: 0.0, side: 1.0 };
        let mut halo = Images { symmetry: vec![plane(0), plane(1)], ..Images::default() };
        let p = [[0.2, 0.3, 5.0]];
        assert!(halo.rebuild(&p, 1.0) && !halo.rebuild(&p, 1.0));
        let mut images = vec![[0.0; 3]; halo.count()];
        fill(&halo, GhostColumn::Point(&p, &mut images));
        images.sort_by(|a, b| a.partial_cmp(b).unwrap());
        assert_eq!(images, [[-0.2, -0.3, 5.0], [-0.2, 0.3, 5.0], [0.2, -0.3, 5.0]]);
    }

    #[test]
    fn images_that_came_near_stand_behind_those_that_were() {
        let plane = SymmetryPlane { axis: 0, position: 0.0, side: 1.0 };
        let mut halo = Images { symmetry: vec![plane], ..Images::default() };
        let at = |x: [f64; 3]| x.map(|x| [x, 0.0, 0.0]);
        halo.rebuild(&at([5.0, 0.5, 5.0]), 1.0);
        assert_eq!(halo.sources(), [1]);
        let mut later = halo.with(halo.images());
        later.supplement(&at([0.5, 3.0, 5.0]), 1.0);
        assert_eq!(later.sources(), [1, 0]);
        // If a particle is beyond the plane by this distance more.
        later.supplement(&at([0.5, -0.5, 1.4]), 1.0);
        assert_eq!(later.sources(), [1, 0, 2]);
        later.supplement(&at([0.5, -0.5, 1.4]), 1.0);
        assert_eq!(later.count(), 3);
    }

    /// Points on both sides of two planes; a fragment that flies behind one of them, alone and together with others.
    fn scattered() -> Vec<Vector<f64>> {
        let mut state = 7u64;
        let mut next = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let near = (0..150).map(|_| [3.5 * next() - 0.8, 3.5 * next() - 0.4, next()]).collect::<Vec<_>>();
        near.into_iter().chain([[-20.0, 0.3, 0.5], [-2.6, 2.5, 0.5], [1.9, 9.0, 0.2]]).collect()
    }

    #[test]
    fn every_pair_with_an_image_is_seen_by_both_sides_as_in_the_whole_model() {
        let planes = [(0, 1.0), (1, 1.0)].map(|(axis, side)| SymmetryPlane { axis, position: 0.0, side });
        for sides in [[1.0, 1.0], [-1.0, 1.0]] {
            let mut halo = Images { symmetry: planes.to_vec(), ..Images::default() };
            halo.symmetry.iter_mut().zip(sides).for_each(|(plane, side)| plane.side = side);
            let mut points = scattered();
            points.iter_mut().for_each(|p| p[0] *= sides[0]);
            let reach = 1.0;
            halo.rebuild(&points, reach);
            let near = |a: &Vector<f64>, b: &Vector<f64>| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>() < reach;
            let mut found: Vec<_> = (0..points.len())
                .flat_map(|i| halo.images.iter().map(move |image| (i, image)))
                .filter(|(i, image)| near(&points[*i], &image.position(&points[image.source as usize])))
                .map(|(i, image)| (i, image.source as usize, image.sign.map(|sign| sign as i64)))
                .collect();
            let mut expected = Vec::new();
            for sign in [[-1, 1, 1], [1, -1, 1], [-1, -1, 1]] {
                for (i, p) in points.iter().enumerate() {
                    for (j, q) in points.iter().enumerate() {
                        if near(p, &[0, 1, 2].map(|a| sign[a] as f64 * q[a])) {
                            expected.push((i, j, sign));
                        }
                    }
                }
            }
            found.sort_unstable();
            expected.sort_unstable();
            assert!(expected.len() > 500 && found == expected, "{} and {}", found.len(), expected.len());
            assert!(expected.iter().all(|&(i, j, sign)| expected.binary_search(&(j, i, sign)).is_ok()));
            // What flies alone behind a plane is reflected in the other one only.
            assert!(halo.images.iter().all(|image| image.source != 150 || image.sign[0] > 0.0));
        }
    }

    #[test]
    fn a_mirror_turns_what_crosses_it() {
        let plane = SymmetryPlane { axis: 1, position: 2.0, side: 1.0 };
        let mut halo = Images { symmetry: vec![plane], ..Images::default() };
        halo.rebuild(&[[1.0, 2.5, 3.0]], 1.0);
        assert_eq!(halo.sources(), [0]);
        let mut vector = [[0.0; 3]];
        fill(&halo, GhostColumn::Vector(&[[4.0, 5.0, 6.0]], &mut vector));
        assert_eq!(vector, [[4.0, -5.0, 6.0]]);
        let stress = SymmetricTensor { xx: 1.0, yy: 2.0, zz: 3.0, xy: 4.0, yz: 5.0, xz: 6.0 };
        let mut symmetric = [SymmetricTensor::zero()];
        fill(&halo, GhostColumn::Symmetric(&[stress], &mut symmetric));
        assert_eq!(symmetric[0], SymmetricTensor { xy: -4.0, yz: -5.0, ..stress });
        let mut tensor = [[[0.0; 3]; 3]];
        fill(&halo, GhostColumn::Tensor(&[[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]]], &mut tensor));
        assert_eq!(tensor[0], [[1.0, -2.0, 3.0], [-4.0, 5.0, -6.0], [7.0, -8.0, 9.0]]);
        // A scalar, a y component and an xy component.
        let mut ghosts = [0.0f32; 3];
        let axes = [(0, 0), (2, 0), (1, 2)];
        fill(&halo, GhostColumn::Single(Packed { own: &[1.0, 2.0, 3.0], ghosts: &mut ghosts, axes: &axes }));
        assert_eq!(ghosts, [1.0, -2.0, -3.0]);
    }

    #[test]
    fn periodic_copies_and_wrapping() {
        let mut halo = Images { periodic: [Some((1.0, 3.0)), None, None], ..Images::default() };
        let mut p = [[3.25, 0.0, 0.0], [0.5, 0.0, 0.0], [2.0, 0.0, 0.0]];
        let mut started = [[2.0, 0.0, 0.0]; 3];
        assert!(halo.wrap(&mut p, &mut started) && !halo.wrap(&mut p, &mut started));
        assert_eq!(p, [[1.25, 0.0, 0.0], [2.5, 0.0, 0.0], [2.0, 0.0, 0.0]]);
        // The way from the start stays what it was.
        assert_eq!(started, [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
        assert!(halo.rebuild(&p, 0.6));
        let mut images = vec![[0.0; 3]; halo.count()];
        fill(&halo, GhostColumn::Point(&p, &mut images));
        assert_eq!((halo.sources(), images[0][0], images[1][0]), ([0, 1].as_slice(), 3.25, 0.5));
        // The same number, of other particles.
        p.swap(1, 2);
        assert!(halo.rebuild(&p, 0.6));
        assert_eq!(halo.count(), 2);
    }
}
