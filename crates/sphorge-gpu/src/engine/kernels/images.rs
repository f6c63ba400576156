//! Images in planes of symmetry: a neighbour, or what of it stands behind the planes.

use crate::record::{Index, Recorded};
use sphorge_engine::model::{Model, SymmetryPlane};
use sphorge_physics::{Real, SymmetricTensor, Tensor, Vector};

/// First of the bits of an entry of a list, one for each axis, that say where its neighbour is mirrored; below is its number.
const FIRST_BIT: u32 = 24;

/// The planes of a model, at most one along each axis.
#[derive(Clone, Copy, Debug)]
pub(in crate::engine) struct Mirrors([Option<SymmetryPlane>; 3]);

/// The sign of a component that an image turns, or does not.
#[derive(Clone, Copy, Debug)]
enum Sign {
    Same,
    Turned,
    /// One or minus one, known on the card alone.
    Either(Recorded),
}

/// Which image a neighbour is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Image {
    mirrors: Mirrors,
    signs: [Sign; 3],
}

impl Mirrors {
    pub(super) fn of(model: &Model) -> Self {
        Self([0, 1, 2].map(|axis| model.symmetry.iter().copied().find(|plane| plane.axis == axis)))
    }

    /// Every image there is, the thing itself first; bit `a` of the number is set where axis `a` is mirrored.
    pub(super) fn images(self) -> impl Iterator<Item = (u32, Image)> {
        let planes = self.0;
        let exists = move |bits: &u32| (0..3).all(|axis| bits >> axis & 1 == 0 || planes[axis].is_some());
        (0..8).filter(exists).map(move |bits| (bits, self.image(bits)))
    }

    fn image(self, bits: u32) -> Image {
        let sign = |axis: usize| if bits >> axis & 1 == 1 { Sign::Turned } else { Sign::Same };
        Image { mirrors: self, signs: [0, 1, 2].map(sign) }
    }

    /// Neighbour and image of an entry of a list.
    pub(super) fn entry(self, entry: Index) -> (Index, Image) {
        if self.0.iter().all(Option::is_none) {
            return (entry, self.image(0));
        }
        let signs = [0, 1, 2].map(|axis| {
            if self.0[axis].is_none() {
                return Sign::Same;
            }
            let bit = 1u32 << (FIRST_BIT + axis as u32);
            let turned = entry.and(Index::of(bit)).number() * Recorded::of(2.0 / f64::from(bit));
            Sign::Either(Recorded::one() - turned)
        });
        (entry.and(Index::of((1 << FIRST_BIT) - 1)), Image { mirrors: self, signs })
    }

    /// The entry of an image, by its number, of a neighbour.
    pub(super) fn entry_of(bits: u32, j: Index) -> Index {
        if bits == 0 { j } else { j + Index::of(bits << FIRST_BIT) }
    }

    /// Neighbour and number of the image of an entry, known here.
    pub(in crate::engine) fn split(entry: u32) -> (usize, u32) {
        ((entry & ((1 << FIRST_BIT) - 1)) as usize, entry >> FIRST_BIT)
    }

    /// How far a place, with its rest, is from the plane of an axis, m.
    pub(super) fn depth(self, axis: usize, [high, low]: [Recorded; 2]) -> Option<Recorded> {
        self.0[axis].map(|plane| {
            let [p, rest] = split(plane.position);
            (high - p) + (low - rest)
        })
    }
}

/// A number and what single precision leaves of it.
pub(super) fn split(number: f64) -> [Recorded; 2] {
    let high = f64::from(number as f32);
    [Recorded::of(high), Recorded::of(number - high)]
}

impl Image {
    pub(super) fn is_mirrored(&self, axis: usize) -> bool {
        matches!(self.signs[axis], Sign::Turned)
    }

    /// `x_i - x_j` along an axis of places with their rests, of the image of the second, m.
    pub(super) fn apart(&self, axis: usize, own: [Recorded; 2], other: [Recorded; 2]) -> Recorded {
        let direct = || (own[0] - other[0]) + (own[1] - other[1]);
        let mirrored = || {
            // Near the plane both are small beside it, and exact.
            let depths = self.mirrors.depth(axis, own).zip(self.mirrors.depth(axis, other));
            depths.map_or_else(direct, |(own, other)| own + other)
        };
        match self.signs[axis] {
            Sign::Same => direct(),
            Sign::Turned => mirrored(),
            Sign::Either(sign) => Recorded::select_lt(sign, Recorded::zero(), mirrored(), direct()),
        }
    }

    /// How far a place with its rest, or an image of it, is from a coordinate along an axis, m.
    pub(super) fn offset(image: Option<&Self>, axis: usize, from: f64, [high, low]: [Recorded; 2]) -> Recorded {
        let direct = || {
            let [from, rest] = split(from);
            (high - from) + (low - rest)
        };
        let mirrored = |image: &Self| {
            let plane = image.mirrors.0[axis].map(|plane| Recorded::of(plane.position - from));
            let depth = image.mirrors.depth(axis, [high, low]);
            plane.zip(depth).map_or_else(direct, |(plane, depth)| plane - depth)
        };
        match image.map(|image| (image, image.signs[axis])) {
            None | Some((_, Sign::Same)) => direct(),
            Some((image, Sign::Turned)) => mirrored(image),
            Some((image, Sign::Either(sign))) => Recorded::select_lt(sign, Recorded::zero(), mirrored(image), direct()),
        }
    }

    /// Where the image of a place, which is known to a cell, is.
    pub(super) fn place(&self, axis: usize, x: Recorded) -> Recorded {
        match (self.signs[axis], self.mirrors.0[axis]) {
            (Sign::Turned, Some(plane)) => Recorded::of(2.0 * plane.position) - x,
            _ => x,
        }
    }

    fn turn(&self, axis: usize, x: Recorded) -> Recorded {
        match self.signs[axis] {
            Sign::Same => x,
            Sign::Turned => -x,
            Sign::Either(sign) => sign * x,
        }
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
    fn images_of_entries_are_as_far_as_double_precision_has_them_and_turn_what_they_should() {
        let plane = |axis| Some(SymmetryPlane { axis, position: 1.7, side: 1.0 });
        let mirrors = Mirrors([plane(0), None, plane(2)]);
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
        let entries = [0u32, 1, 4, 5].map(|bits| (bits << FIRST_BIT) + 11);
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
}
