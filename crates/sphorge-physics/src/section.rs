//! Share of the force of a pair that acts through the plane of a section.

use crate::Real;

/// An image that is shifted by less than this across the plane, in spacings, is shifted along it.
const ALONG: f64 = 1e-3;

/// Share with which the row of one particle counts a pair across the plane: half, because the other half comes from the
/// row of the other particle. It is the whole pair if the other particle is not where its image is. `shift` (m) is the
/// displacement of the image of the neighbour across the plane.
#[inline(always)]
pub fn counted_by_row<T: Real>(shift: T, spacing: T) -> T {
    T::select_lt(T::of(ALONG) * spacing, shift.abs(), T::one(), T::of(0.5))
}

/// Share of the force of a neighbour on a particle that acts through the plane, seen from behind, for these distances
/// ahead of it (m), if their row has this [share](counted_by_row).
#[inline(always)]
pub fn share_through<T: Real>(own: T, other: T, counted: T) -> T {
    // One ahead of the plane, or in it.
    let side = |ahead: T| T::select_lt(ahead, T::zero(), T::zero(), T::one());
    (side(other) - side(own)) * counted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_on_either_side_count_by_halves_but_with_images_across() {
        assert_eq!([0.0, 4e-4, -4e-4, 6e-4, -3.0].map(|shift| counted_by_row(shift, 0.5)), [0.5, 0.5, 0.5, 1.0, 1.0]);
        // A particle in the plane is ahead of it.
        assert_eq!(
            [(-1.0, 2.0), (-1.0, 0.0), (0.0, -1.0), (2.0, 1.0), (-2.0, -1.0)].map(|(a, b)| share_through(a, b, 0.5)),
            [0.5, 0.5, -0.5, 0.0, 0.0]
        );
    }
}
