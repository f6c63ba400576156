//! Facets beside each other rather than on each other: where bodies lap at their edges.

use super::clip::{Place, along, difference, tangent};
use super::press::facing;
use crate::{Elementary, Numbers, Real};

/// How far two bodies lap beside a pair of facets: the distance between a free edge of each that look opposite ways, across the common polygon.
///
/// At such a place the bodies have two pairs of faces that look at each other, with the closure of one as the lap of the other. What is
/// nearer to be apart presses; the other pair is closed by no more than it laps ([`Lapped`]). Without that the side of a beam that rests by half a spacing
/// on a ledge would be taken to be closed by as much with the side of the ledge.
#[derive(Clone, Copy)]
pub(super) struct Lap<T> {
    /// The distance, more where the edges do not quite look opposite ways, m; the largest number where no edges lap.
    pub(super) distance: T,
    /// Its derivative by the distance itself; zero where no edges lap.
    pub(super) share: T,
    /// Outward unit normals of both edges in the plane of projection, and the places on them next to the centre of the polygon.
    pub(super) outward: [Place<T>; 2],
    pub(super) feet: [Place<T>; 2],
}

impl<T: Elementary> Lap<T> {
    /// Of two outlines, anticlockwise, with one for each edge that is free, about a place in both.
    #[inline(always)]
    pub(super) fn of(outlines: [(&[Place<T>; 4], [T; 4]); 2], centre: Place<T>) -> Self {
        // Most facets are in the middle of a face.
        let any = |free: &[T; 4]| free[0].max(free[1]).max(free[2].max(free[3]));
        let both = any(&outlines[0].1) * any(&outlines[1].1);
        T::if_lt(T::zero(), both, || Self::of_free(outlines, centre), || Self::none(centre))
    }

    #[inline(always)]
    fn none(centre: Place<T>) -> Self {
        let zero = T::zero();
        Self { distance: T::largest(), share: zero, outward: [[zero; 2]; 2], feet: [centre; 2] }
    }

    #[inline(always)]
    fn of_free(outlines: [(&[Place<T>; 4], [T; 4]); 2], centre: Place<T>) -> Self {
        let zero = T::zero();
        let sides = outlines.map(|(outline, free)| {
            [0, 1, 2, 3].map(|k: usize| {
                let along_edge = tangent(outline[k], outline[(k + 1) % 4]).0;
                let outward = [along_edge[1], -along_edge[0]];
                (outward, along(outward, difference(outline[k], centre)), free[k])
            })
        });
        let mut lap = Self::none(centre);
        for (outward_a, distance_a, free_a) in sides[0] {
            for (outward_b, distance_b, free_b) in sides[1] {
                let opposite = free_a * free_b * facing(-along(outward_a, outward_b)).0;
                let share = T::select_lt(zero, opposite, T::one() / opposite, zero);
                let distance = share * (distance_a + distance_b).max(zero);
                let distance = T::select_lt(zero, opposite, distance, T::largest());
                let pick = |then: T, otherwise: T| T::select_lt(distance, lap.distance, then, otherwise);
                let pair =
                    |then: Place<T>, otherwise: Place<T>| [pick(then[0], otherwise[0]), pick(then[1], otherwise[1])];
                let foot = |outward: Place<T>, far: T| [centre[0] + far * outward[0], centre[1] + far * outward[1]];
                lap = Self {
                    distance: pick(distance, lap.distance),
                    share: pick(share, lap.share),
                    outward: [pair(outward_a, lap.outward[0]), pair(outward_b, lap.outward[1])],
                    feet: [
                        pair(foot(outward_a, distance_a), lap.feet[0]),
                        pair(foot(outward_b, distance_b), lap.feet[1]),
                    ],
                };
            }
        }
        lap
    }
}

impl<T: Real> Numbers<T> for Lap<T> {
    #[inline(always)]
    fn each(&mut self, visit: &mut dyn FnMut(&mut T)) {
        let Self { distance, share, outward, feet } = self;
        visit(distance);
        visit(share);
        outward.each(visit);
        feet.each(visit);
    }
}

/// Distance beyond the lap over which the closure falls to zero, in depths of both owners, at least.
const FALL: f64 = 0.25;

/// Closure of surfaces that are behind each other by `d`, where the bodies lap by `W` beside them: `d` up to `W`, and from there on `W (Z - d)/(Z - W)`, so that
/// nothing is left where the owners pass each other, at `d = D`. `Z = D`, or a little beyond a lap that is larger.
pub(super) struct Lapped<T> {
    pub(super) closure: T,
    /// Derivatives by `d`, by `W` and by `D`.
    pub(super) by_apart: T,
    pub(super) by_lap: T,
    pub(super) by_depth: T,
}

impl<T: Elementary> Lapped<T> {
    #[inline(always)]
    pub(super) fn of(apart: T, lap: T, depth: T) -> Self {
        let (zero, one, fall) = (T::zero(), T::one(), T::of(FALL));
        let least = fall * depth;
        let span = (depth - lap).max(least);
        // Derivatives of the end `Z`.
        let (end_by_lap, end_by_depth) =
            (T::select_lt(least, depth - lap, zero, one), T::select_lt(least, depth - lap, one, fall));
        let (left, beyond) = ((lap + span - apart).max(zero), apart - lap);
        let by_end = lap * beyond / (span * span);
        let beside = |lapped: T, otherwise: T| T::select_lt(lap, apart, lapped, otherwise);
        // Behind the end nothing is left that could change.
        let some = |value: T| T::select_lt(zero, left, value, zero);
        Self {
            closure: beside(lap * left / span, apart),
            by_apart: beside(some(-lap / span), one),
            by_lap: beside(some(left * (lap + span) / (span * span) + end_by_lap * by_end), zero),
            by_depth: beside(some(end_by_depth * by_end), zero),
        }
    }
}
