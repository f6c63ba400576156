//! Conduction of heat between particles, and through surfaces.
//!
//! Cleary & Monaghan (1999): the heat a pair exchanges is
//!
//! `Q_ij = V_i V_j 4 k_i k_j/(k_i + k_j) (T_j - T_i) |dW/dr|/r`, W, from `j` to `i`,
//!
//! antisymmetric, so that heat is conserved, and with a flux that is continuous where the conductivity jumps. On a lattice the sum
//! is the Laplacian times its second moment `sum_j V_j r |dW/dr| / d`, which is not quite one for a finite number of neighbours and
//! does not become one with smaller spacing; pairs are divided by it ([`Lattice::moment`]).
//!
//! Surfaces are found as they form (as in Fraser's adaptive thermal boundaries) by the divergence of position,
//! `div x = - sum_j V_j x_ij . grad W_ij`, the same moment times `d`: a particle is on a surface where it lacks at least half of
//! what the outermost layer of a flat body lacks, and its share of the surface is in proportion to what it lacks.

use crate::kernel::Kernel;
use crate::{Dimension, Real, Scalar};

/// Sums over a square or cubic lattice.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lattice {
    /// `sum_j V_j r |dW/dr| / d`; one in the limit of many neighbours.
    pub moment: f64,
    /// The same in the outermost layer of a half space.
    pub surface_moment: f64,
}

/// Sums over a lattice of this spacing and smoothing length, m.
pub fn lattice(kernel: Kernel, dimension: Dimension, spacing: f64, h: f64) -> Lattice {
    let rows = (kernel.support() * h / spacing) as i32 + 1;
    let d = dimension.count() as i32;
    let scale = kernel.normalisation(dimension) * Real::powu(spacing / h, d as u32) / (h * h);
    let (rows_y, rows_z) = (if d >= 2 { rows } else { 0 }, if d >= 3 { rows } else { 0 });
    let mut sums = Lattice::default();
    for x in -rows..=rows {
        for y in -rows_y..=rows_y {
            for z in -rows_z..=rows_z {
                let r2 = spacing * spacing * f64::from(x * x + y * y + z * z);
                let slope = -scale * kernel.dw_over_q(Real::sqrt(r2) / h);
                sums.moment += slope * r2 / f64::from(d);
                if x >= 0 {
                    sums.surface_moment += slope * r2 / f64::from(d);
                }
            }
        }
    }
    sums
}

/// Conductivity of a pair times two, `4 k_i k_j/(k_i + k_j)`, W/(m K); zero where one of them insulates.
#[inline(always)]
pub fn pair_conductivity<T: Scalar>(k_i: T, k_j: T) -> T {
    let sum = k_i + k_j;
    if sum > T::zero() { T::of(4.0) * (k_i * k_j) / sum } else { T::zero() }
}

/// Conductance per area between a particle and what is outside of its surface, W/(m² K): half a spacing of material and the
/// film of heat transfer coefficient `film` (W/(m² K)) one behind the other; `None` is a surface that itself has the outer
/// temperature.
#[inline(always)]
pub fn surface_conductance<T: Scalar>(film: Option<T>, conductivity: T, spacing: T) -> T {
    let inner = T::of(2.0) * conductivity / spacing;
    match film {
        None => inner,
        Some(film) if film + inner > T::zero() => film * inner / (film + inner),
        Some(_) => T::zero(),
    }
}

/// Area of the surface that a particle stands for, m^(d-1), from its moment and that of the outermost layer of a flat body, both
/// over the moment of a full lattice. Nothing where less than half as much is lacking as there. An edge has 1.75 cell faces with
/// next neighbours alone, somewhat less with more; a particle alone about two in a plane, three in space.
#[inline(always)]
pub fn surface_area(dimension: Dimension, volume: f64, filled: f64, flat: f64) -> f64 {
    let lacking = (1.0 - filled) / (1.0 - flat);
    if lacking < 0.5 {
        return 0.0;
    }
    Real::powu(cell_size(dimension, volume), dimension.count() as u32 - 1) * lacking
}

/// Edge of a cell of this volume (m^d), m.
#[inline(always)]
pub fn cell_size(dimension: Dimension, volume: f64) -> f64 {
    match dimension {
        Dimension::One => volume,
        Dimension::Two => Real::sqrt(volume),
        Dimension::Three => Scalar::powf(volume, 1.0 / 3.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lattice_sums_by_hand() {
        // One dimension, h = spacing: the two next neighbours, |dw/dq| = 1/2 at q = 1: moment 2 (1/2) = 1, half of it at an end.
        let sums = lattice(Kernel::CubicSpline, Dimension::One, 2.0, 2.0);
        assert!((sums.moment - 1.0).abs() < 1e-14, "{sums:?}");
        assert!((sums.surface_moment - 0.5).abs() < 1e-14);
        // h = 1.2: q |dw/dq| of neighbours at q = 1/1.2 and 2/1.2, over 1.2, twice.
        let sums = lattice(Kernel::CubicSpline, Dimension::One, 1.0, 1.2);
        // |dw/dq| is 2 q - 1.5 q^2 at 1/1.2 and (2 - q)^2/2 at 2/1.2.
        let (near, far) = ((2.0 - 1.5 / 1.2) / 1.44, (1.0 / 9.0) / 1.2);
        assert!((sums.moment - 2.0 * (near + far) / 1.2).abs() < 1e-14, "{sums:?}");
        // Many neighbours: one.
        for dimension in [Dimension::One, Dimension::Two, Dimension::Three] {
            let many = lattice(Kernel::WendlandC2, dimension, 1.0, 4.0);
            assert!((many.moment - 1.0).abs() < 1e-3, "{dimension:?} {many:?}");
        }
    }

    #[test]
    fn a_pair_conducts_like_its_halves_one_behind_the_other() {
        // Iron and copper: 4 80 400/480.
        assert!((pair_conductivity(80.0f64, 400.0) - 266.666_666_666_666_7).abs() < 1e-12);
        assert_eq!(pair_conductivity(50.0f64, 50.0), 100.0);
        assert_eq!((pair_conductivity(0.0f64, 50.0), pair_conductivity(0.0f64, 0.0)), (0.0, 0.0));
    }

    #[test]
    fn surfaces_by_hand() {
        // 2 40/0.01 = 8000; with a film of 2000: 1600.
        assert_eq!(surface_conductance(None, 40.0f64, 0.01), 8000.0);
        assert_eq!(surface_conductance(Some(2000.0f64), 40.0, 0.01), 1600.0);
        assert_eq!(surface_conductance(Some(0.0f64), 0.0, 0.01), 0.0);
        assert!((surface_area(Dimension::Three, 8e-9, 0.25, 0.5) - 6e-6).abs() < 1e-18);
        assert_eq!(surface_area(Dimension::Two, 4e-6, 0.5, 0.5), 2e-3);
        assert_eq!(surface_area(Dimension::One, 1e-3, 0.5, 0.5), 1.0);
        assert_eq!(surface_area(Dimension::Two, 4e-6, 0.76, 0.5), 0.0);
    }
}
