//! The common polygon of two convex polygons in a plane, in a fixed number of slots.

use crate::{Elementary, Numbers, Real};

/// A point or direction in the plane of projection.
pub(super) type Place<T> = [T; 2];

#[inline(always)]
pub(super) fn difference<T: Real>(a: Place<T>, b: Place<T>) -> Place<T> {
    [a[0] - b[0], a[1] - b[1]]
}

#[inline(always)]
pub(super) fn turn<T: Real>(a: Place<T>, b: Place<T>) -> T {
    a[0] * b[1] - a[1] * b[0]
}

#[inline(always)]
pub(super) fn along<T: Real>(a: Place<T>, b: Place<T>) -> T {
    a[0] * b[0] + a[1] * b[1]
}

/// The line that an edge is on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line<T> {
    /// Unit vector along it, with the inside to its left; zero for an edge without length.
    pub tangent: Place<T>,
    /// Which facet it moves with: 1 for the first, -1 for the second, 0 for the line along which both planes meet.
    pub owner: T,
}

impl<T: Real> Numbers<T> for Line<T> {
    #[inline(always)]
    fn each(&mut self, visit: &mut dyn FnMut(&mut T)) {
        self.tangent.each(visit);
        visit(&mut self.owner);
    }
}

/// A vertex and the edge from there to the next one. Edges between slots with the same vertex have no length.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex<T> {
    pub place: Place<T>,
    pub edge: Line<T>,
}

impl<T: Real> Numbers<T> for Vertex<T> {
    #[inline(always)]
    fn each(&mut self, visit: &mut dyn FnMut(&mut T)) {
        self.place.each(visit);
        self.edge.each(visit);
    }
}

/// Where the line that cuts crosses the edge from a vertex inside to one outside.
#[derive(Clone, Copy, Debug)]
struct Crossing<T> {
    /// What the linear function is at both.
    inside: T,
    outside: T,
    from: Place<T>,
    to: Place<T>,
}

impl<T: Real> Crossing<T> {
    #[inline(always)]
    fn place(&self) -> Place<T> {
        let share = (self.inside / (self.inside - self.outside)).min(T::one()).max(T::zero());
        [0, 1].map(|i: usize| self.from[i] + share * (self.to[i] - self.from[i]))
    }
}

#[inline(always)]
fn choose_place<T: Real>(a: T, b: T, then: Place<T>, otherwise: Place<T>) -> Place<T> {
    [T::select_lt(a, b, then[0], otherwise[0]), T::select_lt(a, b, then[1], otherwise[1])]
}

#[inline(always)]
fn choose_line<T: Real>(a: T, b: T, then: Line<T>, otherwise: Line<T>) -> Line<T> {
    Line {
        tangent: choose_place(a, b, then.tangent, otherwise.tangent),
        owner: T::select_lt(a, b, then.owner, otherwise.owner),
    }
}

#[inline(always)]
fn choose<T: Real>(a: T, b: T, then: Vertex<T>, otherwise: Vertex<T>) -> Vertex<T> {
    Vertex {
        place: choose_place(a, b, then.place, otherwise.place),
        edge: choose_line(a, b, then.edge, otherwise.edge),
    }
}

#[inline(always)]
fn choose_crossing<T: Real>(a: T, b: T, then: Crossing<T>, otherwise: Crossing<T>) -> Crossing<T> {
    let pick = |then: T, otherwise: T| T::select_lt(a, b, then, otherwise);
    Crossing {
        inside: pick(then.inside, otherwise.inside),
        outside: pick(then.outside, otherwise.outside),
        from: choose_place(a, b, then.from, otherwise.from),
        to: choose_place(a, b, then.to, otherwise.to),
    }
}

/// Unit vector and length from one place to another; the unit vector is zero where there is no length.
#[inline(always)]
pub(super) fn tangent<T: Real>(from: Place<T>, to: Place<T>) -> (Place<T>, T) {
    let way = difference(to, from);
    let length = along(way, way).sqrt();
    let unit = |c: T| T::select_lt(T::zero(), length, c / length, T::zero());
    ([unit(way[0]), unit(way[1])], length)
}

/// The polygon of these corners, anticlockwise, of one facet.
#[inline(always)]
pub(super) fn polygon<T: Real>(corners: [Place<T>; 4], owner: T) -> [Vertex<T>; 4] {
    [0, 1, 2, 3].map(|k: usize| Vertex {
        place: corners[k],
        edge: Line { tangent: tangent(corners[k], corners[(k + 1) % 4]).0, owner },
    })
}

/// The polygon in one slot more, with its last vertex twice.
#[inline(always)]
fn widened<T: Real, const N: usize, const M: usize>(polygon: &[Vertex<T>; N]) -> [Vertex<T>; M] {
    core::array::from_fn(|k| polygon[k.min(N - 1)])
}

/// What is left of a convex polygon where `outside`, a linear function given at its vertices, is not above `tolerance`; `M = N + 1`. Where
/// nothing is left, all vertices are in one place.
///
/// The tolerance decides on which side coincident lines are: those of the polygon are kept, whatever rounding says.
#[inline(always)]
pub(super) fn clip<T: Elementary, const N: usize, const M: usize>(
    polygon: [Vertex<T>; N],
    outside: [T; N],
    tolerance: T,
    cutter: Line<T>,
) -> [Vertex<T>; M] {
    let farthest = outside.iter().fold(-T::largest(), |most, s| most.max(*s));
    T::if_lt(tolerance, farthest, || cut(polygon, outside, tolerance, cutter), || widened(&polygon))
}

#[inline(always)]
fn cut<T: Elementary, const N: usize, const M: usize>(
    polygon: [Vertex<T>; N],
    outside: [T; N],
    tolerance: T,
    cutter: Line<T>,
) -> [Vertex<T>; M] {
    let (zero, one, half) = (T::zero(), T::one(), T::of(0.5));
    let out: [T; N] = core::array::from_fn(|k| T::select_lt(tolerance, outside[k], one, zero));
    let before = |k: usize| (k + N - 1) % N;
    let after = |k: usize| (k + 1) % N;
    // One run of vertices is outside. The polygon leaves on the edge to the first of them and comes back on the edge behind the last.
    let crossing = |k: usize, with: usize| Crossing {
        inside: outside[with],
        outside: outside[k],
        from: polygon[with].place,
        to: polygon[k].place,
    };
    let nowhere = Crossing { inside: zero, outside: one, from: polygon[0].place, to: polygon[0].place };
    let (mut leaving, mut returning, mut edge) = (nowhere, nowhere, cutter);
    // One where the run is this vertex alone.
    let mut alone = [zero; N];
    for k in 0..N {
        let (first, last) = (out[k] - out[before(k)], out[k] - out[after(k)]);
        leaving = choose_crossing(half, first, crossing(k, before(k)), leaving);
        returning = choose_crossing(half, last, crossing(k, after(k)), returning);
        edge = choose_line(half, last, polygon[k].edge, edge);
        alone[k] = T::select_lt(half, first, T::select_lt(half, last, one, zero), zero);
    }
    let leaves = Vertex { place: leaving.place(), edge: cutter };
    let returns = Vertex { place: returning.place(), edge };
    // The last vertex of a run is where the polygon returns, the others are where it leaves it. A run of one vertex takes a slot more.
    let replaced: [Vertex<T>; N] = core::array::from_fn(|k| {
        let last = T::select_lt(half, out[k] - out[after(k)], one - alone[k], zero);
        choose(half, out[k], choose(half, last, returns, leaves), polygon[k])
    });
    let mut shifted = zero;
    core::array::from_fn(|k| {
        let ahead = replaced[k.min(N - 1)];
        if k == 0 {
            return ahead;
        }
        let behind = choose(half, alone[k - 1], returns, replaced[k - 1]);
        shifted = shifted.max(alone[k - 1]);
        choose(half, shifted, behind, ahead)
    })
}
