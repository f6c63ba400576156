//! Images behind symmetry planes and beyond periodic ends: a neighbour is a particle or an image of it.

use crate::engine::columns::added;
use crate::record::{Index, Recorded};
use sphorge_engine::model::Model;
use sphorge_physics::{Elementary, Real, SymmetricTensor, Tensor, Vector};

/// First of the bits of an entry of a list, two for each axis, that encode the image of its neighbour; the bits below
/// are the index of the neighbour.
const FIRST_BIT: u32 = 24;

/// The bits of an axis in the code of an image: none, or the first or the second kind of image along it.
const BITS: u32 = 2;

/// Kind of image along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// Mirrored at a coordinate, m.
    Mirror(f64),
    /// Shifted from the second of the ends to the first, m.
    Copy([f64; 2]),
}

/// The images of a model: up to two kinds along each axis.
#[derive(Clone, Copy, Debug)]
pub(in crate::engine) struct Planes([[Option<Kind>; 2]; 3]);

/// Which kind an image is along an axis.
#[derive(Clone, Copy, Debug)]
enum Choice {
    None,
    Of(Kind),
    /// Zero for none, one or two for the first or second kind, as a value on the GPU.
    Either(Recorded, [Option<Kind>; 2]),
}

/// The image that a neighbour is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Image([Choice; 3]);

/// A number and its low part in single precision.
pub(super) fn split(number: f64) -> [Recorded; 2] {
    let high = f64::from(number as f32);
    [Recorded::of(high), Recorded::of(number - high)]
}

/// Distance of a position, with its low part, from a coordinate, m.
fn beyond([high, low]: [Recorded; 2], from: f64) -> Recorded {
    let [from, rest] = split(from);
    (high - from) + (low - rest)
}

impl Kind {
    /// `x_i - x_j` of positions with their low parts, for the image of the second, m. Near a plane both parts are small,
    /// and exact; a body whose lists are those of the reference configuration may have left its periodic cell far
    /// behind.
    fn apart(self, own: [Recorded; 2], other: [Recorded; 2]) -> Recorded {
        match self {
            Self::Mirror(plane) => beyond(own, plane) + beyond(other, plane),
            Self::Copy([to, from]) => {
                let [shift, rest] = split(to - from);
                let [high, low] = added([own[0], Recorded::zero()], -other[0]);
                (high - shift) + ((own[1] - other[1]) + (low - rest))
            }
        }
    }

    /// Distance of the image of a position, with its low part, from a coordinate, m.
    fn offset(self, place: [Recorded; 2], coordinate: f64) -> Recorded {
        match self {
            Self::Mirror(plane) => Recorded::of(plane - coordinate) - beyond(place, plane),
            Self::Copy([to, from]) => beyond(place, from) + Recorded::of(to - coordinate),
        }
    }

    /// The position at which a particle has those neighbours whose images are near it.
    fn back(self, x: Recorded) -> Recorded {
        match self {
            Self::Mirror(plane) => Recorded::of(2.0 * plane) - x,
            Self::Copy([to, from]) => x - Recorded::of(to - from),
        }
    }

    /// Distance of a position, with its low part, from the region of images of this kind, m; negative inside.
    fn distance(self, place: [Recorded; 2]) -> Recorded {
        match self {
            Self::Mirror(plane) => beyond(place, plane).abs(),
            Self::Copy([to, from]) if to > from => -beyond(place, to),
            Self::Copy([to, _]) => beyond(place, to),
        }
    }

    fn turns(self) -> bool {
        matches!(self, Self::Mirror(_))
    }
}

impl Planes {
    /// A periodic axis has no planes.
    pub(in crate::engine) fn of(model: &Model) -> Self {
        Self([0, 1, 2].map(|axis| {
            if let Some((low, high)) = model.periodic[axis] {
                return [Some(Kind::Copy([high, low])), Some(Kind::Copy([low, high]))];
            }
            let mut planes = model.symmetry.iter().filter(|plane| plane.axis == axis);
            [(); 2].map(|()| planes.next().map(|plane| Kind::Mirror(plane.position)))
        }))
    }

    /// Every kind of image, the particle itself first, with its code.
    pub(super) fn images(self) -> impl Iterator<Item = (u32, Image)> {
        let kind = move |bits: u32, axis: usize| Self::bits(bits, axis).checked_sub(1).map(|k| (k as usize, axis));
        let of = move |(k, axis): (usize, usize)| self.0[axis].get(k).copied().flatten();
        let all = 0..1 << (3 * BITS);
        all.filter_map(move |bits| {
            let mut choices = [Choice::None; 3];
            for axis in 0..3 {
                if let Some(which) = kind(bits, axis) {
                    choices[axis] = Choice::Of(of(which)?);
                }
            }
            Some((bits, Image(choices)))
        })
    }

    fn bits(image: u32, axis: usize) -> u32 {
        image >> (BITS * axis as u32) & ((1 << BITS) - 1)
    }

    /// The image with a code that is a value on the GPU.
    pub(super) fn coded(self, code: Recorded) -> Image {
        let code = Index::floor(code);
        Image([0, 1, 2].map(|axis| {
            if self.0[axis].iter().all(Option::is_none) {
                return Choice::None;
            }
            let unit = 1u32 << (BITS * axis as u32);
            let of_axis = code.and(Index::of(((1 << BITS) - 1) * unit)).number() * Recorded::of(1.0 / f64::from(unit));
            Choice::Either(of_axis, self.0[axis])
        }))
    }

    /// Neighbour and image of an entry of a list.
    pub(super) fn entry(self, entry: Index) -> (Index, Image) {
        if self.0.as_flattened().iter().all(Option::is_none) {
            return (entry, Image([Choice::None; 3]));
        }
        let choices = [0, 1, 2].map(|axis| {
            if self.0[axis].iter().all(Option::is_none) {
                return Choice::None;
            }
            let unit = 1u32 << (FIRST_BIT + BITS * axis as u32);
            let code = entry.and(Index::of(((1 << BITS) - 1) * unit)).number() * Recorded::of(1.0 / f64::from(unit));
            Choice::Either(code, self.0[axis])
        });
        (entry.and(Index::of((1 << FIRST_BIT) - 1)), Image(choices))
    }

    /// The entry of an image of a neighbour, by its code.
    pub(super) fn entry_of(bits: u32, j: Index) -> Index {
        if bits == 0 { j } else { j + Index::of(bits << FIRST_BIT) }
    }

    /// Index of the neighbour of an entry.
    pub(super) fn number_of(entry: Index) -> Recorded {
        entry.and(Index::of((1 << FIRST_BIT) - 1)).number()
    }

    /// A code that is zero for the neighbour itself and different for each image.
    pub(super) fn image_of(entry: Index) -> Recorded {
        // Multiples of a power of two, which single precision represents exactly.
        entry.and(Index::of(u32::MAX << FIRST_BIT)).number()
    }

    /// Neighbour and code of the image of an entry, on the processor.
    pub(in crate::engine) fn split(entry: u32) -> (usize, u32) {
        ((entry & ((1 << FIRST_BIT) - 1)) as usize, entry >> FIRST_BIT)
    }

    /// The entry of a neighbour and the code of its image.
    pub(in crate::engine) fn join(neighbor: u32, image: u32) -> u32 {
        neighbor + (image << FIRST_BIT)
    }

    /// The code of an image that is mirrored along these axes.
    pub(in crate::engine) fn code_of(mirrored: [bool; 3]) -> u32 {
        (0..3).filter(|axis| mirrored[*axis]).map(|axis| 1 << (BITS * axis as u32)).sum()
    }

    /// Coordinate of an image, by its code, along an axis, and whether it is mirrored there.
    pub(in crate::engine) fn coordinate(self, image: u32, axis: usize, x: f64) -> (f64, bool) {
        let kind = Self::bits(image, axis).checked_sub(1).and_then(|k| self.0[axis].get(k as usize).copied().flatten());
        match kind {
            None => (x, false),
            Some(Kind::Mirror(plane)) => (2.0 * plane - x, true),
            Some(Kind::Copy([to, from])) => (x + (to - from), false),
        }
    }
}

impl Choice {
    /// The value without an image, and that for a kind of image.
    fn choose(self, direct: impl Fn() -> Recorded, of: impl Fn(Kind) -> Recorded) -> Recorded {
        match self {
            Self::None => direct(),
            Self::Of(kind) => of(kind),
            Self::Either(code, [first, second]) => {
                let mut chosen = direct();
                for (kind, from) in [(first, 0.5), (second, 1.5)] {
                    if let Some(kind) = kind {
                        chosen = Recorded::select_lt(Recorded::of(from), code, of(kind), chosen);
                    }
                }
                chosen
            }
        }
    }

    fn turn(self, x: Recorded) -> Recorded {
        match self {
            Self::None => x,
            Self::Of(kind) => {
                if kind.turns() {
                    -x
                } else {
                    x
                }
            }
            // An axis has planes or ends.
            Self::Either(code, kinds) => match kinds.into_iter().flatten().any(Kind::turns) {
                true => Recorded::select_lt(Recorded::of(0.5), code, -x, x),
                false => x,
            },
        }
    }
}

impl Image {
    /// Distance of a position, with its low part, from each plane this image is behind, on either side of it, m.
    pub(super) fn distances<const D: usize>(&self, place: &Vector<[Recorded; 2]>) -> impl Iterator<Item = Recorded> {
        let kinds = self.kinds::<D>(place);
        kinds.filter(|(kind, _)| kind.turns()).map(|(kind, place)| kind.distance(place))
    }

    /// Distance of a position, with its low part, from the region that has neighbours of this image, m; zero for the
    /// particle itself.
    pub(super) fn farthest<const D: usize>(&self, place: &Vector<[Recorded; 2]>) -> Option<Recorded> {
        self.kinds::<D>(place).map(|(kind, place)| kind.distance(place)).reduce(Real::max)
    }

    /// Distance along an axis of a position, with its low part, from the region of such images, m; negative inside, and far
    /// below zero where this is none.
    pub(super) fn distance(&self, axis: usize, place: [Recorded; 2]) -> Recorded {
        self.0[axis].choose(|| -Recorded::largest(), |kind| kind.distance(place))
    }

    /// The first if the image is mirrored along an axis, else the second.
    pub(super) fn if_mirrored(&self, axis: usize, then: Recorded, otherwise: Recorded) -> Recorded {
        self.0[axis].choose(|| otherwise, |kind| if kind.turns() { then } else { otherwise })
    }

    /// Kinds of a constant image, along the axes computed in.
    fn kinds<const D: usize>(&self, place: &Vector<[Recorded; 2]>) -> impl Iterator<Item = (Kind, [Recorded; 2])> {
        let (choices, place) = (self.0, *place);
        (0..D).filter_map(move |axis| match choices[axis] {
            Choice::Of(kind) => Some((kind, place[axis])),
            Choice::None | Choice::Either(..) => None,
        })
    }

    /// `x_i - x_j` along an axis of positions with their low parts, for the image of the second, m.
    pub(super) fn apart(&self, axis: usize, own: [Recorded; 2], other: [Recorded; 2]) -> Recorded {
        let direct = || (own[0] - other[0]) + (own[1] - other[1]);
        self.0[axis].choose(direct, |kind| kind.apart(own, other))
    }

    /// Distance of a position with its low part, or of an image of it, from a coordinate along an axis, m.
    pub(super) fn offset(image: Option<&Self>, axis: usize, from: f64, place: [Recorded; 2]) -> Recorded {
        let choice = image.map_or(Choice::None, |image| image.0[axis]);
        choice.choose(|| beyond(place, from), |kind| kind.offset(place, from))
    }

    /// The position, known to a cell, at which a particle has those neighbours whose images are near it.
    pub(super) fn back(&self, axis: usize, x: Recorded) -> Recorded {
        self.0[axis].choose(|| x, |kind| kind.back(x))
    }

    fn turn(&self, axis: usize, x: Recorded) -> Recorded {
        self.0[axis].turn(x)
    }

    fn turn_twice(&self, a: usize, b: usize, x: Recorded) -> Recorded {
        if a == b { x } else { self.turn(a, self.turn(b, x)) }
    }

    pub(super) fn vector(&self, v: Vector<Recorded>) -> Vector<Recorded> {
        [0, 1, 2].map(|a| self.turn(a, v[a]))
    }

    pub(super) fn symmetric(&self, t: SymmetricTensor<Recorded>) -> SymmetricTensor<Recorded> {
        SymmetricTensor {
            xy: self.turn_twice(0, 1, t.xy),
            yz: self.turn_twice(1, 2, t.yz),
            xz: self.turn_twice(0, 2, t.xz),
            ..t
        }
    }

    pub(super) fn tensor(&self, t: &Tensor<Recorded>) -> Tensor<Recorded> {
        [0, 1, 2].map(|a| [0, 1, 2].map(|b| self.turn_twice(a, b, t[a][b])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::{Evaluation, whole};
    use crate::record::Kernel;

    #[test]
    fn images_in_lists_have_exact_distances_and_mirrored_components() {
        let mirrors = Planes([[Some(Kind::Mirror(1.7)), None], [None; 2], [Some(Kind::Mirror(1.7)), None]]);
        // Particles a tenth of a micrometre from a plane that is far from the origin.
        let (own, other): (f64, f64) = (1.7 + 1.3e-7, 1.7 + 0.9e-7);
        let kernel = Kernel::record("images", |scope| {
            let (x, entries, y) = (scope.input("x"), scope.indices("entries"), scope.output("y"));
            let i = scope.thread();
            let at = |k: u32| x.at(Index::of(k));
            let (j, image) = mirrors.entry(entries.at(i));
            let place = |k: u32| i * Index::of(8) + Index::of(k);
            y.set(place(0), image.apart(0, [at(0), at(1)], [at(2), at(3)]));
            y.set(place(1), j.number());
            let one = Recorded::one();
            for (k, c) in image.vector([one; 3]).into_iter().enumerate() {
                y.set(place(2 + k as u32), c);
            }
            let t = image.tensor(&[[one; 3]; 3]);
            for (k, c) in [t[0][1], t[2][0], t[2][2]].into_iter().enumerate() {
                y.set(place(5 + k as u32), c);
            }
        })
        .unwrap();
        let parts = |x: f64| [x as f32, (x - f64::from(x as f32)) as f32];
        // As it is, behind the first plane, behind the second, behind both.
        let entries = [0u32, 1, 16, 17].map(|bits| (bits << FIRST_BIT) + 11);
        let mut buffers = [[parts(own), parts(other)].concat(), whole(&entries), vec![0.0; 32]];
        Evaluation::default().run(&kernel, &mut buffers, 4);
        for (thread, (apart, signs)) in [
            (own - other, [1.0, 1.0, 1.0, 1.0, 1.0, 1.0]),
            (own + other - 3.4, [-1.0, 1.0, 1.0, -1.0, -1.0, 1.0]),
            (own - other, [1.0, 1.0, -1.0, 1.0, -1.0, 1.0]),
            (own + other - 3.4, [-1.0, 1.0, -1.0, -1.0, 1.0, 1.0]),
        ]
        .into_iter()
        .enumerate()
        {
            let found = &buffers[2][8 * thread..8 * thread + 8];
            assert!((f64::from(found[0]) - apart).abs() < 1e-6 * apart.abs(), "{thread}: {} {apart}", found[0]);
            assert_eq!((found[1], &found[2..]), (11.0, &signs[..]), "{thread}");
        }
    }

    #[test]
    fn second_planes_and_periodic_ends_have_exact_distances() {
        // Planes at 0.3 and 1.7, and a period of 1.4 between the same.
        let planes = [Some(Kind::Mirror(0.3)), Some(Kind::Mirror(1.7))];
        let ends = [Some(Kind::Copy([1.7, 0.3])), Some(Kind::Copy([0.3, 1.7]))];
        let (near_low, near_high): (f64, f64) = (0.3 + 0.9e-7, 1.7 - 1.3e-7);
        for (kinds, bits, own, other, expected, sign) in [
            (planes, 1u32, 0.3 + 2e-7, near_low, 0.3 + 2e-7 - (0.6 - near_low), -1.0),
            (planes, 2, near_high, 1.7 - 2e-7, near_high - (3.4 - (1.7 - 2e-7)), -1.0),
            (ends, 1, near_high, near_low, near_high - (near_low + 1.4), 1.0),
            (ends, 2, near_low, near_high, near_low - (near_high - 1.4), 1.0),
            (ends, 0, near_low, near_high, near_low - near_high, 1.0),
            // Nine cells away.
            (ends, 1, near_high + 12.6, near_low + 12.6, near_high - (near_low + 1.4), 1.0),
        ] {
            let planes = Planes([[None; 2], kinds, [None; 2]]);
            let kernel = Kernel::record("images", |scope| {
                let (x, entries, y) = (scope.input("x"), scope.indices("entries"), scope.output("y"));
                let at = |k: u32| x.at(Index::of(k));
                let (_, image) = planes.entry(entries.at(Index::of(0)));
                y.set(Index::of(0), image.apart(1, [at(0), at(1)], [at(2), at(3)]));
                y.set(Index::of(1), image.vector([Recorded::one(); 3])[1]);
                y.set(Index::of(2), Image::offset(Some(&image), 1, own, [at(2), at(3)]));
            });
            let parts = |x: f64| [x as f32, (x - f64::from(x as f32)) as f32];
            let entries = whole(&[(bits << (FIRST_BIT + BITS)) + 11]);
            let mut buffers = [[parts(own), parts(other)].concat(), entries, vec![0.0; 3]];
            Evaluation::default().run(&kernel.unwrap(), &mut buffers, 1);
            let found = f64::from(buffers[2][0]);
            assert!((found - expected).abs() < 1e-6 * expected.abs(), "{bits}: {found} {expected}");
            assert_eq!(buffers[2][1], sign);
            // In single precision of how far it is from the cell.
            let scale = own.max(1.0);
            assert!((f64::from(buffers[2][2]) + expected).abs() < 2e-7 * scale, "{bits}: {} {expected}", buffers[2][2]);
            let (coordinate, turned) = planes.coordinate(bits << BITS, 1, other);
            assert!((own - coordinate - expected).abs() < 1e-15 * scale && turned == (sign < 0.0));
        }
    }
}
