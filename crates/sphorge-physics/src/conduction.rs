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
//! A particle at a face lacks pairs, of which those along the face carry heat along it: a row at a face conducts 0.81 of what a row
//! inside does, one at an edge 0.66. Its other pairs replace them. With the directions `n` of the pairs, and the weights
//! `w_ij = V_j r |dW/dr|` over the moment of the lattice, so that `M_i = sum_j w_ij n ⊗ n` is the unit tensor inside,
//!
//! `Q_ij -> Q_ij (1 + n . (R_i + R_j) n/2)`,  `R_i = alpha Q + beta I`,
//!
//! where `Q` is the projection on the directions in which `M_i` is largest, those along the face or the edge, and `alpha` and `beta`
//! follow from what the moment is to be: the unit tensor there, and as it is across, where a pair less is no conduction less,
//!
//! `sum_j w_ij n.Qn (1 + n . R_i n) = tr Q`,  `sum_j w_ij (1 - n.Qn) n . R_i n = 0`
//!
//! ([`Surroundings::replacement`]). The mean of both particles keeps pairs antisymmetric, and what each of them asks for is what all
//! of them together get: in the sum over a body a pair counts for both. So heat along a bar of any cross section is exact on a lattice.
//!
//! Surfaces are found as they form (as in Fraser's adaptive thermal boundaries) by the divergence of position,
//! `div x = - sum_j V_j x_ij . grad W_ij`, the same moment times `d`: a particle is on a surface where it lacks at least half of
//! what the outermost layer of a flat body lacks. Its share of the surface is that of its faces at the start as long as these are free, else
//! in proportion to what it lacks ([`outline_area`]).
//!
//! In the total Lagrangian form sums go over the initial neighbours at the initial positions `X`. Per initial volume heat flows with
//! `k J C^-1 grad_0 T`, `C = F^T F`, and `rho_0 c dT/dt` is the divergence of that. The part of undeformed material, `k grad_0 T`, is
//! the sum above; the rest, `q = k (J C^-1 - I) grad_0 T`, goes by the two sums of the form itself,
//!
//! `grad_0 T_i = sum_j V_j (T_j - T_i) b_i grad_0 W_ij`,  `Q_i = sum_j V_i V_j (q_i b_i + q_j b_j) . grad_0 W_ij`,
//!
//! which are adjoint and antisymmetric: heat is conserved. `b_i` is the smallest principal value of the gradient correction `B_i`, that along the
//! directions in which a particle has most neighbours: gradients along faces are exact, and those across them smaller than they are, because pairs there
//! conduct less, too. So the gradient sees less of a temperature than pairs do, and even where `q` flows upwards, which is never more than `k grad_0 T`, heat
//! does not on the whole. With `B_i` it did at faces: what was pulled to more than twice its length there grew hot and cold without end.
//!
//! Across an open crack no heat flows: each term of a pair, in all of these sums, has the smaller of the shares with which its particles
//! conduct ([`conducting_share`]), so that the sums stay antisymmetric and adjoint. Metal whose particles are severed or on the way to it conducts as
//! whole metal where it is pressed shut.

use crate::kernel::Kernel;
use crate::tensor::{determinant, dot, identity, inverse, multiply, transpose};
use crate::thin::is_thin;
use crate::{Dimension, Elementary, Numbers, Real, SymmetricTensor, Tensor, Vector};

/// Sums over a square or cubic lattice.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lattice {
    /// `sum_j V_j r |dW/dr| / d`; one in the limit of many neighbours.
    pub moment: f64,
    /// The same in the outermost layer of a half space.
    pub surface_moment: f64,
    /// The same along a row alone, which no body is more slender than, `sum_j V_j r |dW/dr|`.
    pub row_moment: f64,
}

impl Lattice {
    /// What a particle of a row alone lacks of the conduction of the row in a full lattice, over what it has: the most that is
    /// [replaced](Surroundings::replacement).
    pub fn most_replaced(&self) -> f64 {
        self.moment / self.row_moment - 1.0
    }
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
                if y == 0 && z == 0 {
                    sums.row_moment += slope * r2;
                }
            }
        }
    }
    sums
}

/// Conductivity of a pair times two, `4 k_i k_j/(k_i + k_j)`, W/(m K); zero where one of them insulates.
#[inline(always)]
pub fn pair_conductivity<T: Real>(k_i: T, k_j: T) -> T {
    let sum = k_i + k_j;
    T::select_lt(T::zero(), sum, T::of(4.0) * (k_i * k_j) / sum, T::zero())
}

/// Share of its conductivity with which metal of an integrity conducts at a pressure, Pa: all of it where it is pressed shut, else its integrity.
#[inline(always)]
pub fn conducting_share<T: Real>(pressure: T, integrity: T) -> T {
    T::select_lt(T::zero(), pressure, T::one(), integrity)
}

/// Effusivity `sqrt(k rho c)`, W s^(1/2)/(m^2 K), of conductivity (W/(m K)), density (kg/m^3) and specific heat (J/(kg K)).
#[inline(always)]
pub fn effusivity<T: Real>(conductivity: T, density: T, specific_heat: T) -> T {
    (conductivity * density * specific_heat).sqrt()
}

/// Share of the heat of friction between two bodies that the first takes up, `b_1/(b_1 + b_2)` with the effusivities `b`: two half spaces that
/// rub on each other are then as warm as each other at their faces (Carslaw & Jaeger 1959, section 2.9). Half where one of the
/// effusivities is not known, which is zero or infinite.
#[inline(always)]
pub fn friction_share(b_1: f64, b_2: f64) -> f64 {
    let is_known = |b: f64| b > 0.0 && b < f64::INFINITY;
    if is_known(b_1) && is_known(b_2) { b_1 / (b_1 + b_2) } else { 0.5 }
}

/// Distance, in the mean cells of two particles of different bodies, from which on their faces do not touch.
const TOUCHING: f64 = 1.5;

/// Whether particles of different bodies at a distance whose square is given (m^2), with these edges of their cells (m), have faces that
/// touch: less than half a spacing apart. On faces that touch, particles lie one spacing apart, in staggered rows up to 1.22.
#[inline(always)]
pub fn touch(r2: f64, cell_i: f64, cell_j: f64) -> bool {
    r2 < touching_below(cell_i, cell_j)
}

/// The square of the distance below which they [`touch`], m^2.
#[inline(always)]
pub fn touching_below<T: Real>(cell_i: T, cell_j: T) -> T {
    let reach = T::of(TOUCHING * 0.5) * (cell_i + cell_j);
    reach * reach
}

/// What flows to a particle, and what it sees of surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inflow<T> {
    /// W.
    pub power: T,
    /// Sum of conductances, W/K.
    pub conductance: T,
    /// `- sum_j V_j x_ij . grad_i W_ij / d` over that of a full lattice.
    pub filled: T,
}

/// A pair that exchanges heat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeatPair<T> {
    /// `V_i`, `V_j`, m^d.
    pub volumes: (T, T),
    /// Of the pair ([`pair_conductivity`]), W/(m K).
    pub conductivity: T,
    /// One over the moment of the lattice ([`Lattice::moment`]), mean of both bodies.
    pub correction: T,
    /// What it conducts for pairs that are missing, too, over what it conducts by itself ([`replaced`]).
    pub replaced: T,
    /// `-(1/r) dW/dr`, m^-(d+2).
    pub slope: T,
    /// `r^2`, m^2.
    pub r2: T,
    /// `T_j - T_i`, K.
    pub difference: T,
}

impl<T: Real> Inflow<T> {
    /// Nothing flows yet.
    pub fn zero() -> Self {
        Self { power: T::zero(), conductance: T::zero(), filled: T::zero() }
    }

    /// Adds a neighbour.
    #[inline(always)]
    pub fn add(&mut self, pair: &HeatPair<T>, dimension: Dimension) {
        let conductance = self.add_conductance(pair, T::one(), dimension);
        self.power += conductance * pair.difference;
    }

    /// Adds an initial neighbour of the total Lagrangian form: `flow = q_i B_i + q_j B_j` (W/m^2) of both particles, initial distance
    /// `x_ij` (m). Heat flows at most `better` times as well as at rest.
    #[inline(always)]
    pub fn add_reference(
        &mut self,
        pair: &HeatPair<T>,
        x_ij: Vector<T>,
        flow: Vector<T>,
        better: T,
        dimension: Dimension,
    ) {
        let conductance = self.add_conductance(pair, better, dimension);
        let (volume_i, volume_j) = pair.volumes;
        self.power += conductance * pair.difference - volume_i * volume_j * pair.slope * dot(flow, x_ij);
    }

    #[inline(always)]
    fn add_conductance(&mut self, pair: &HeatPair<T>, better: T, dimension: Dimension) -> T {
        let (volume_i, volume_j) = pair.volumes;
        let conductance = (volume_i * volume_j) * pair.conductivity * (pair.correction * pair.slope) * pair.replaced;
        self.conductance += better * conductance;
        self.filled += pair.correction * volume_j * pair.slope * pair.r2 / T::of(dimension.count() as f64);
        conductance
    }
}

/// Products of four components of a direction: their axes, and how many orders of these there are.
const PRODUCTS: [([usize; 4], f64); 15] = [
    ([0, 0, 0, 0], 1.0),
    ([1, 1, 1, 1], 1.0),
    ([2, 2, 2, 2], 1.0),
    ([0, 0, 1, 1], 6.0),
    ([1, 1, 2, 2], 6.0),
    ([0, 0, 2, 2], 6.0),
    ([0, 0, 0, 1], 4.0),
    ([0, 0, 0, 2], 4.0),
    ([0, 1, 1, 1], 4.0),
    ([1, 1, 1, 2], 4.0),
    ([0, 2, 2, 2], 4.0),
    ([1, 2, 2, 2], 4.0),
    ([0, 0, 1, 2], 12.0),
    ([0, 1, 1, 2], 12.0),
    ([0, 1, 2, 2], 12.0),
];

/// How the pairs of a particle lie about it: `sum_j w_ij n_a n_b n_c n_d` over its pairs, with their directions `n` and the weights
/// `w_ij = V_j r |dW/dr|` over the moment of the lattice; the fifteen components that differ.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surroundings<T> {
    moments: [T; 15],
}

impl<T: Real> Numbers<T> for Surroundings<T> {
    #[inline(always)]
    fn each(&mut self, visit: &mut dyn FnMut(&mut T)) {
        self.moments.iter_mut().for_each(visit);
    }
}

/// Squares by which the largest principal value of a moment prevails: one that is 2 % less keeps 1 % of its weight.
const SQUARES: u32 = 8;

/// By how much pairs across the directions in which others replace missing ones conduct less at most, as a share.
const MOST_WITHDRAWN: f64 = 0.5;

impl<T: Real> Surroundings<T> {
    /// No pairs yet.
    pub fn none() -> Self {
        Self { moments: [T::zero(); 15] }
    }

    /// Adds a pair of the weight `w_ij/r^2` (1/m^2), with the square of its distance (m^2), in the direction of `x_ij`.
    #[inline(always)]
    pub fn add(&mut self, weight: T, r2: T, x_ij: Vector<T>) {
        let scale = T::one() / dot(x_ij, x_ij).max(T::of(LEAST));
        let square = |a: usize, b: usize| scale * x_ij[a] * x_ij[b];
        let (xx, yy, zz) = (square(0, 0), square(1, 1), square(2, 2));
        let (xy, yz, xz) = (square(0, 1), square(1, 2), square(0, 2));
        let products = [
            xx * xx,
            yy * yy,
            zz * zz,
            xx * yy,
            yy * zz,
            xx * zz,
            xx * xy,
            xx * xz,
            xy * yy,
            yy * yz,
            xz * zz,
            yz * zz,
            xx * yz,
            xy * yz,
            xy * zz,
        ];
        let weight = weight * r2;
        for (moment, product) in self.moments.iter_mut().zip(products) {
            *moment += weight * product;
        }
    }

    /// `M = sum_j w_ij n ⊗ n`.
    fn moment(&self) -> Tensor<T> {
        let [xxxx, yyyy, zzzz, xxyy, yyzz, xxzz, xxxy, xxxz, xyyy, yyyz, xzzz, yzzz, xxyz, xyyz, xyzz] = self.moments;
        let (xy, yz, xz) = (xxxy + xyyy + xyzz, xxyz + yyyz + yzzz, xxxz + xyyz + xzzz);
        [[xxxx + xxyy + xxzz, xy, xz], [xy, yyyy + xxyy + yyzz, yz], [xz, yz, zzzz + xxzz + yyzz]]
    }

    /// `sum_j w_ij (n . q n)^2` with a symmetric `q`.
    fn squared(&self, q: &Tensor<T>) -> T {
        let mut sum = T::zero();
        for (moment, ([a, b, c, d], orders)) in self.moments.iter().zip(PRODUCTS) {
            // The mean of the three ways to make two pairs of four axes.
            let ways = q[a][b] * q[c][d] + q[a][c] * q[b][d] + q[a][d] * q[b][c];
            sum += T::of(orders / 3.0) * ways * *moment;
        }
        sum
    }

    /// `R`, by how much more its pairs conduct for those that are missing, by direction: `n . R n`. `most` is what is replaced at most
    /// ([`Lattice::most_replaced`]). Nothing where nothing is missing in the direction in which there is most.
    pub fn replacement(&self, most: T) -> SymmetricTensor<T> {
        let (zero, one, least) = (T::zero(), T::one(), T::of(LEAST));
        let m = self.moment();
        let all = trace(&m);
        // The projection on the directions of the largest principal value, over their number.
        let mut p = scaled(&m, one / all.max(least));
        for _ in 0..SQUARES {
            p = multiply(&p, &p);
            p = scaled(&p, one / trace(&p).max(least));
        }
        let count = one / double_dot(&p, &p).max(least);
        let q = scaled(&p, count);
        let (along, twice) = (double_dot(&q, &m), self.squared(&q));
        let lacking = (count - along).max(zero);
        let (across, oblique) = (all - along, along - twice);
        let little = T::of(1e-3) * all.max(least);
        let ratio = T::select_lt(little, across, oblique / across.max(little), zero);
        let beta = -(lacking * ratio / (twice - along * ratio).max(little)).min(T::of(MOST_WITHDRAWN));
        let alpha = ((lacking - beta * along) / twice.max(little)).min(most - beta);
        let of = |a: usize, b: usize| {
            let unit = if a == b { beta } else { zero };
            T::select_lt(T::of(1e-6), all, alpha * q[a][b] + unit, zero)
        };
        SymmetricTensor { xx: of(0, 0), yy: of(1, 1), zz: of(2, 2), xy: of(0, 1), yz: of(1, 2), xz: of(0, 2) }
    }
}

/// What a divisor is at least, so that nothing over nothing is nothing.
const LEAST: f64 = 1e-30;

/// How many times as much as by itself a pair conducts at the distance `x_ij` (m, its square `r2`), with the
/// [replacements](Surroundings::replacement) of its particles.
#[inline(always)]
pub fn replaced<T: Real>(r_i: SymmetricTensor<T>, r_j: SymmetricTensor<T>, x_ij: Vector<T>, r2: T) -> T {
    let r = r_i + r_j;
    let [x, y, z] = x_ij;
    let squares = r.xx * x * x + r.yy * y * y + r.zz * z * z;
    let along = squares + T::of(2.0) * (r.xy * x * y + r.yz * y * z + r.xz * x * z);
    (T::one() + T::of(0.5) * along / r2.max(T::of(LEAST))).max(T::zero())
}

/// A replacement of the initial configuration in the current one, turned with the deformation gradient.
pub fn turned<T: Real>(r: SymmetricTensor<T>, f: &Tensor<T>) -> SymmetricTensor<T> {
    let turned = multiply(&multiply(f, &r.to_tensor()), &transpose(f));
    let stretch = T::of(3.0) / double_dot(f, f);
    SymmetricTensor::symmetric_part(&turned) * stretch
}

/// The direction in the initial configuration of one in the current configuration.
pub fn turned_back<T: Real>(x: Vector<T>, f: &Tensor<T>) -> Vector<T> {
    apply(&inverse(f), x)
}

fn trace<T: Real>(a: &Tensor<T>) -> T {
    a[0][0] + a[1][1] + a[2][2]
}

fn scaled<T: Real>(a: &Tensor<T>, s: T) -> Tensor<T> {
    a.map(|row| row.map(|c| s * c))
}

/// `a : b`.
fn double_dot<T: Real>(a: &Tensor<T>, b: &Tensor<T>) -> T {
    dot(a[0], b[0]) + dot(a[1], b[1]) + dot(a[2], b[2])
}

/// Adds an initial neighbour to the gradient of the temperature (K/m) of the total Lagrangian form, before the correction `B`.
/// `difference = T_j - T_i` (K), `slope` as in [`HeatPair`].
#[inline(always)]
pub fn add_temperature_gradient<T: Real>(
    gradient: &mut Vector<T>,
    volume_j: T,
    slope: T,
    difference: T,
    x_ij: Vector<T>,
) {
    let weight = volume_j * slope;
    for a in 0..3 {
        gradient[a] -= weight * difference * x_ij[a];
    }
}

/// `J C^-1`: how much better than at rest heat flows, by direction of the initial configuration.
fn stretched<T: Real>(f: &Tensor<T>) -> Tensor<T> {
    let (inverse, j) = (inverse(f), determinant(f));
    multiply(&inverse, &transpose(&inverse)).map(|row| row.map(|c| j * c))
}

/// Heat that deformation adds to the flow, `q b = k (J C^-1 - I) grad_0 T b`, W/m^2, with the conductivity `k` (W/(m K)), the
/// gradient of the temperature before its correction (K/m), the deformation gradient, and the gradient correction `B`, whose smallest principal
/// value is `b`. In bodies of one layer, which have no neighbours across, all of `B` stands for it.
pub fn added_flow<T: Elementary>(
    conductivity: T,
    gradient: Vector<T>,
    f: &Tensor<T>,
    correction: &Tensor<T>,
    dimension: Dimension,
) -> Vector<T> {
    let alike = || scaled(&identity(), smallest_correction(correction, dimension));
    let correction = &T::if_lt(T::zero(), is_thin(correction), || *correction, alike);
    let gradient = apply(correction, gradient);
    let along = apply(&stretched(f), gradient);
    let q = [0, 1, 2].map(|c| conductivity * (along[c] - gradient[c]));
    apply(&transpose(correction), q)
}

/// Smallest principal value of a gradient correction, along the axes computed in: that along the directions in which a particle has most neighbours.
fn smallest_correction<T: Real>(correction: &Tensor<T>, dimension: Dimension) -> T {
    let m = inverse(correction);
    let within = |a: usize| a < dimension.count();
    let block =
        |t: &Tensor<T>| [0, 1, 2].map(|a| [0, 1, 2].map(|b| if within(a) && within(b) { t[a][b] } else { T::zero() }));
    let mut p = block(&m);
    for _ in 0..SQUARES {
        p = scaled(&p, T::one() / trace(&p).max(T::of(LEAST)));
        p = multiply(&p, &p);
    }
    double_dot(&p, &block(correction)) / trace(&p).max(T::of(LEAST))
}

/// At most how many times better than at rest heat flows in any direction, not less than one: the largest sum of magnitudes in a row
/// of `J C^-1`, which no eigenvalue exceeds.
pub fn best_flow<T: Real>(f: &Tensor<T>) -> T {
    let mut bound = T::one();
    for row in stretched(f) {
        bound = bound.max(row[0].abs() + row[1].abs() + row[2].abs());
    }
    bound
}

fn apply<T: Real>(a: &Tensor<T>, v: Vector<T>) -> Vector<T> {
    a.map(|row| dot(row, v))
}

/// Conductance per area between a particle and what is outside of its surface, W/(m² K): half a spacing of material and the
/// film of heat transfer coefficient `film` (W/(m² K)) one behind the other; `None` is a surface that itself has the outer
/// temperature.
#[inline(always)]
pub fn surface_conductance<T: Real>(film: Option<T>, conductivity: T, spacing: T) -> T {
    let inner = T::of(2.0) * conductivity / spacing;
    match film {
        None => inner,
        Some(film) => T::select_lt(T::zero(), film + inner, film * inner / (film + inner), T::zero()),
    }
}

/// Area of the surface that a particle stands for, m^(d-1), from its moment and that of the outermost layer of a flat body, both
/// over the moment of a full lattice. Nothing where less than half as much is lacking as there. An edge has 1.75 cell faces with
/// next neighbours alone, somewhat less with more; a particle alone about two in a plane, three in space.
#[inline(always)]
pub fn surface_area<T: Elementary>(dimension: Dimension, volume: T, filled: T, flat: T) -> T {
    let lacking = (T::one() - filled) / (T::one() - flat);
    let faces = cell_size(dimension, volume).powu(dimension.count() as u32 - 1) * lacking;
    T::select_lt(lacking, T::of(0.5), T::zero(), faces)
}

/// Area of the surface that a particle stands for, m^(d-1), where its faces at the start have this area at unit density
/// ([`face_at_unit_density`]): that of these faces as long as they are free, which what it lacks says ([`surface_area`]). Where less is
/// lacking, because something touches it, or more than another face, because something has come off, or where it had no face, it is what
/// is lacking. An edge of two faces lacks 1.75 times as much as a flat face and, where one of them is touched, as much; a corner of three
/// 2.35 times, or 1.75; on round bodies that may be half a face less than the faces are.
#[inline(always)]
pub fn outline_area<T: Elementary>(
    dimension: Dimension,
    (volume, density): (T, T),
    filled: T,
    flat: T,
    at_unit_density: T,
) -> T {
    let (one, zero) = (T::one(), T::zero());
    let outline = face_area(dimension, at_unit_density, density);
    let faces = outline / cell_size(dimension, volume).powu(dimension.count() as u32 - 1);
    let beyond = |count: f64| (faces - T::of(count)).max(zero).min(one);
    let least = T::of(0.8) * faces.min(one) - T::of(0.2) + T::of(0.75) * beyond(1.0) + T::of(0.7) * beyond(2.0);
    let lacking = (one - filled) / (one - flat);
    let found = surface_area(dimension, volume, filled, flat);
    let free = T::select_lt(lacking, least.max(T::of(0.05)), found, outline);
    let whole = T::select_lt(faces + one, lacking, found, free);
    T::select_lt(zero, outline, whole, found)
}

/// Area at unit density of a face that boundaries name, m^(d-1) (kg/m^d)^((d-1)/d), from its area (m^(d-1)) and density (kg/m^d) at the start.
#[inline(always)]
pub fn face_at_unit_density<T: Elementary>(dimension: Dimension, area: T, density: T) -> T {
    area / cell_size(dimension, T::one() / density).powu(dimension.count() as u32 - 1)
}

/// Area of such a face at a density, m^(d-1): it grows as the faces of cells do that expand in all directions alike.
#[inline(always)]
pub fn face_area<T: Elementary>(dimension: Dimension, at_unit_density: T, density: T) -> T {
    at_unit_density * cell_size(dimension, T::one() / density).powu(dimension.count() as u32 - 1)
}

/// Edge of a cell of this volume (m^d), m.
#[inline(always)]
pub fn cell_size<T: Elementary>(dimension: Dimension, volume: T) -> T {
    match dimension {
        Dimension::One => volume,
        Dimension::Two => volume.sqrt(),
        Dimension::Three => volume.powf(T::of(1.0 / 3.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_heats_by_effusivity_by_hand() {
        // Steel: sqrt(50 7800 460) = 13 394; aluminium: sqrt(200 2700 900) = 22 045.
        let (steel, aluminium) = (effusivity(50.0, 7800.0, 460.0), effusivity(200.0, 2700.0, 900.0f64));
        assert!((steel - 13_394.028_5).abs() < 1e-3 && (aluminium - 22_045.407_7).abs() < 1e-3, "{steel} {aluminium}");
        assert!((friction_share(steel, aluminium) - 0.377_941_35).abs() < 1e-7, "{}", friction_share(steel, aluminium));
        assert_eq!((friction_share(3.0, 1.0), friction_share(1.0, 3.0)), (0.75, 0.25));
        assert_eq!((friction_share(0.0, 3.0), friction_share(f64::INFINITY, f64::INFINITY)), (0.5, 0.5));
    }

    #[test]
    fn faces_grow_with_the_cells_behind_them() {
        // At an eighth of the density edges are twice as long in space, faces four times as large.
        for (dimension, times) in [(Dimension::One, 1.0), (Dimension::Two, 8f64.sqrt()), (Dimension::Three, 4.0)] {
            let face = face_at_unit_density(dimension, 3e-6, 8000.0);
            assert!((face_area(dimension, face, 8000.0) / 3e-6 - 1.0).abs() < 1e-14);
            assert!((face_area(dimension, face, 1000.0) / (times * 3e-6) - 1.0).abs() < 1e-14, "{dimension:?}");
        }
    }

    #[test]
    fn faces_touch_up_to_half_a_spacing() {
        assert!(touch(1.49 * 1.49, 1.0, 1.0) && !touch(1.51 * 1.51, 1.0, 1.0));
        // Cells of 1 and 2 mm: up to 2.25 mm.
        assert!(touch(2.24e-3 * 2.24e-3, 1e-3, 2e-3) && !touch(2.26e-3 * 2.26e-3, 2e-3, 1e-3));
    }

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
        // In a plane, h = spacing: of the next neighbours 1 |dw/dq| = 1/2, of those across sqrt(2) (2 - sqrt(2))^2/2. The outermost layer
        // has three and two of the four and four, its own row in full.
        let sums = lattice(Kernel::CubicSpline, Dimension::Two, 0.5, 0.5);
        let scale = 15.0 / (7.0 * core::f64::consts::PI) / 2.0;
        let root = Real::sqrt(2.0);
        let (near, far) = (0.5, 0.5 * root * (2.0 - root) * (2.0 - root));
        assert!((sums.moment - scale * (4.0 * near + 4.0 * far)).abs() < 1e-14, "{sums:?}");
        assert!((sums.surface_moment - scale * (3.0 * near + 2.0 * far)).abs() < 1e-14, "{sums:?}");
        // Only spacings to a smoothing length matter, and none within the support is left out.
        let fine = lattice(Kernel::WendlandC2, Dimension::One, 0.25, 3.0);
        let kernel = Kernel::WendlandC2;
        let term = |k: i32| -f64::from(k * k) * kernel.dw_over_q(f64::from(k) / 12.0) / 1728.0;
        let by_hand = kernel.normalisation(Dimension::One) * 2.0 * (1..=24).map(term).sum::<f64>();
        assert!((fine.moment - by_hand).abs() < 1e-14, "{fine:?} {by_hand}");
        // Many neighbours: one.
        for dimension in [Dimension::One, Dimension::Two, Dimension::Three] {
            let many = lattice(Kernel::WendlandC2, dimension, 1.0, 4.0);
            assert!((many.moment - 1.0).abs() < 1e-3, "{dimension:?} {many:?}");
        }
    }

    #[test]
    fn a_row_alone_has_its_pairs_along_it() {
        // In a plane, h = spacing: two next neighbours of four, none across.
        let sums = lattice(Kernel::CubicSpline, Dimension::Two, 0.5, 0.5);
        let root = Real::sqrt(2.0);
        let (near, far) = (0.5, 0.5 * root * (2.0 - root) * (2.0 - root));
        let scale = 15.0 / (7.0 * core::f64::consts::PI);
        assert!((sums.row_moment - scale * 2.0 * near).abs() < 1e-14, "{sums:?}");
        assert!((sums.most_replaced() - far / near).abs() < 1e-14, "{sums:?}");
        // In one dimension all of them: nothing is ever replaced.
        assert_eq!(lattice(Kernel::CubicSpline, Dimension::One, 1.0, 1.3).most_replaced(), 0.0);
    }

    /// What a particle with these pairs, of weight and direction, sees; the distance does not matter.
    fn seen(pairs: &[(f64, Vector<f64>)]) -> Surroundings<f64> {
        let mut surroundings = Surroundings::none();
        for (weight, x) in pairs {
            surroundings.add(weight / 4.0, 4.0, *x);
        }
        surroundings
    }

    #[test]
    fn missing_pairs_along_a_face_are_replaced_by_hand() {
        let (along, up) = ([[2.0, 0.0, 0.0], [-3.0, 0.0, 0.0]], [0.0, 0.5, 0.0]);
        // M = diag(0.8, 0.4): a quarter more along x, at most what is said; nothing where nothing is missing.
        let face = seen(&[(0.4, along[0]), (0.4, along[1]), (0.4, up)]);
        let r = face.replacement(1.0);
        assert!((r.xx - 0.25).abs() < 1e-14 && r.yy.abs() < 1e-14 && r.xy == 0.0 && r.zz == 0.0, "{r:?}");
        assert!((face.replacement(0.1).xx - 0.1).abs() < 1e-14);
        let inside = seen(&[(0.5, along[0]), (0.5, along[1]), (0.5, up), (0.5, [0.0, -1.0, 0.0])]);
        for c in inside.replacement(1.0).to_tensor().as_flattened() {
            assert!(c.abs() < 1e-14);
        }
        assert_eq!(Surroundings::<f64>::none().replacement(1.0), SymmetricTensor::zero());
        // With oblique pairs M = diag(0.8, 0.6). Along x 0.6 (1 + alpha + beta) + 2 0.2 0.5 (1 + alpha/2 + beta) = 1, across
        // 0.4 beta + 2 0.2 0.5 (alpha/2 + beta) = 0: alpha = 6/17, beta = -1/17.
        let oblique = [(0.2, [1.0, 1.0, 0.0]), (0.2, [-1.0, 1.0, 0.0])];
        let face = seen(&[(0.3, along[0]), (0.3, along[1]), (0.4, up), oblique[0], oblique[1]]);
        let r = face.replacement(1.0);
        assert!((r.xx - 5.0 / 17.0).abs() < 1e-12 && (r.yy + 1.0 / 17.0).abs() < 1e-12, "{r:?}");
        assert!(r.xy.abs() < 1e-12 && (r.zz + 1.0 / 17.0).abs() < 1e-12, "{r:?}");
        // Denser than a lattice: nothing is taken away.
        let dense = seen(&[(0.7, along[0]), (0.7, along[1]), (0.4, up)]);
        assert_eq!(dense.replacement(1.0), SymmetricTensor::zero());
    }

    #[test]
    fn products_of_directions_are_all_there() {
        let pairs = [
            (0.3, [1.0, 0.2, -0.4]),
            (0.2, [-0.3, 0.9, 0.5]),
            (0.7, [0.1, -0.6, 2.0]),
            (0.4, [-1.2, -0.5, -0.7]),
            (0.1, [0.6, 0.8, 0.1]),
        ];
        let surroundings = seen(&pairs);
        let q = [[1.1, -0.3, 0.4], [-0.3, 0.7, 0.25], [0.4, 0.25, -0.2]];
        let (mut moment, mut squared) = ([[0.0; 3]; 3], 0.0);
        for (weight, x) in pairs {
            let length = Real::sqrt(dot(x, x));
            let n = x.map(|c| c / length);
            let along = dot(n, apply(&q, n));
            squared += weight * along * along;
            for a in 0..3 {
                for b in 0..3 {
                    moment[a][b] += weight * n[a] * n[b];
                }
            }
        }
        assert!((surroundings.squared(&q) - squared).abs() < 1e-14, "{} {squared}", surroundings.squared(&q));
        for (ours, by_hand) in surroundings.moment().as_flattened().iter().zip(moment.as_flattened()) {
            assert!((ours - by_hand).abs() < 1e-14);
        }
    }

    /// Conduction along bars of so many particles across and down over that of as many rows in a lattice without end; with and without
    /// replacements.
    fn conduction_of_bar(across: [i32; 2], dimension: Dimension, smoothing: f64) -> [f64; 2] {
        let kernel = Kernel::CubicSpline;
        let lattice = lattice(kernel, dimension, 1.0, smoothing);
        let rows_z = if dimension == Dimension::Three { across[1] } else { 1 };
        let section: Vec<[i32; 2]> = (0..across[0]).flat_map(|y| (0..rows_z).map(move |z| [y, z])).collect();
        let pairs = |i: [i32; 2]| {
            let others = section.iter().flat_map(move |j| (-4..=4).map(move |x| [x, i[0] - j[0], i[1] - j[1]]));
            others.filter(|x| *x != [0, 0, 0]).map(|x| {
                let x = x.map(f64::from);
                let r2 = dot(x, x);
                (x, r2, kernel.slope(dimension, Real::sqrt(r2), smoothing) / lattice.moment)
            })
        };
        let replacement = |i: [i32; 2]| {
            let mut surroundings = Surroundings::none();
            for (x, r2, slope) in pairs(i) {
                surroundings.add(slope, r2, x);
            }
            surroundings.replacement(lattice.most_replaced())
        };
        let replacements: Vec<_> = section.iter().map(|i| replacement(*i)).collect();
        let mut sums = [0.0; 2];
        for (i, own) in section.iter().zip(&replacements) {
            for (x, r2, slope) in pairs(*i) {
                let other = (i[0] - x[1] as i32) * rows_z + i[1] - x[2] as i32;
                sums[0] += slope * x[0] * x[0] * replaced(*own, replacements[other as usize], x, r2);
                sums[1] += slope * x[0] * x[0];
            }
        }
        sums.map(|sum| sum / section.len() as f64)
    }

    #[test]
    fn bars_of_few_particles_conduct_in_full() {
        for (dimension, across, without) in [
            (Dimension::Two, [1, 1], 0.63),
            (Dimension::Two, [2, 1], 0.81),
            (Dimension::Two, [4, 1], 0.91),
            (Dimension::Three, [1, 1], 0.40),
            (Dimension::Three, [2, 1], 0.51),
            (Dimension::Three, [2, 2], 0.66),
            (Dimension::Three, [3, 5], 0.81),
            (Dimension::Three, [4, 4], 0.82),
            (Dimension::Three, [8, 8], 0.91),
        ] {
            let [with, plain] = conduction_of_bar(across, dimension, 1.1);
            assert!((plain - without).abs() < 0.012, "{dimension:?} {across:?}: {plain}");
            assert!((with - 1.0).abs() < 0.004, "{dimension:?} {across:?}: {with}");
            // More neighbours, of which more are missing.
            assert!((conduction_of_bar(across, dimension, 1.4)[0] - 1.0).abs() < 0.01, "{dimension:?} {across:?}");
        }
    }

    #[test]
    fn plates_conduct_in_full_along_and_as_before_through() {
        for smoothing in [1.1, 1.2, 1.4] {
            let kernel = Kernel::CubicSpline;
            let lattice = lattice(kernel, Dimension::Three, 1.0, smoothing);
            for layers in [2, 3, 6] {
                let pairs = |i: i32| {
                    let others = (0..layers).flat_map(move |j| (-4..=4).map(move |y| (j, y)));
                    let others = others.flat_map(move |(j, y)| (-4..=4).map(move |z| (j, [i - j, y, z])));
                    others.filter(|(_, x)| *x != [0, 0, 0]).map(|(j, x)| {
                        let x = x.map(f64::from);
                        let r2 = dot(x, x);
                        (j, x, r2, kernel.slope(Dimension::Three, Real::sqrt(r2), smoothing) / lattice.moment)
                    })
                };
                let replacement = |i: i32| {
                    let mut surroundings = Surroundings::none();
                    pairs(i).for_each(|(_, x, r2, slope)| surroundings.add(slope, r2, x));
                    surroundings.replacement(lattice.most_replaced())
                };
                let replacements: Vec<_> = (0..layers).map(replacement).collect();
                let (mut through, mut plain, mut along) = (0.0, 0.0, [0.0; 2]);
                for i in 0..layers {
                    for (j, x, r2, slope) in pairs(i) {
                        let replaced = replaced(replacements[i as usize], replacements[j as usize], x, r2);
                        along = [0, 1].map(|a| along[a] + slope * x[a + 1] * x[a + 1] * replaced);
                        through += slope * x[0] * x[0] * replaced;
                        plain += slope * x[0] * x[0];
                    }
                }
                assert!((through / plain - 1.0).abs() < 2e-3, "{smoothing} {layers}: {through} {plain}");
                for sum in along {
                    assert!((sum / f64::from(layers) - 1.0).abs() < 2e-3, "{smoothing} {layers}: {along:?}");
                }
            }
        }
    }

    #[test]
    fn replacements_conduct_along_their_direction_and_turn_with_the_body() {
        let r = |xx, yy, xy| SymmetricTensor { xx, yy, xy, ..SymmetricTensor::zero() };
        // 1 + (0.5 9 + 2 0.1 12 + 0.3 16)/(2 25).
        assert!((replaced(r(0.5, 0.0, 0.1), r(0.0, 0.3, 0.0), [3.0, 4.0, 0.0], 25.0) - 1.234).abs() < 1e-14);
        assert_eq!(replaced(r(-3.0, 0.0, 0.0), r(-2.0, 0.0, 0.0), [1.0, 0.0, 0.0], 1.0), 0.0);
        assert_eq!(replaced(r(0.5, 0.0, 0.1), r(0.0, 0.3, 0.0), [0.0; 3], 0.0), 1.0);
        // By a quarter turn x becomes y; size does not matter.
        let f = [[0.0, -2.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0]];
        let now = turned(r(0.5, 0.1, 0.2), &f);
        let expected = r(0.1, 0.5, -0.2);
        assert!((now - expected).double_dot(now - expected) < 1e-28, "{now:?}");
        assert_eq!(turned_back([0.0, 3.0, 0.0], &f), [1.5, 0.0, 0.0]);
    }

    #[test]
    fn a_pair_conducts_like_its_halves_one_behind_the_other() {
        // Iron and copper: 4 80 400/480.
        assert!((pair_conductivity(80.0f64, 400.0) - 266.666_666_666_666_7).abs() < 1e-12);
        assert_eq!(pair_conductivity(50.0f64, 50.0), 100.0);
        assert_eq!((pair_conductivity(0.0f64, 50.0), pair_conductivity(0.0f64, 0.0)), (0.0, 0.0));
    }

    #[test]
    fn an_open_crack_conducts_by_its_integrity_and_a_closed_one_like_whole_metal() {
        assert_eq!(
            (conducting_share(-1e6, 0.25), conducting_share(0.0, 0.0), conducting_share(-0.0, 0.0)),
            (0.25, 0.0, 0.0)
        );
        assert_eq!(
            (conducting_share(1.0, 0.25), conducting_share(1e9, 0.0), conducting_share(-1e9, 1.0)),
            (1.0, 1.0, 1.0)
        );
    }

    #[test]
    fn what_flows_in_by_hand() {
        // (2 3) 10 (0.5 0.25) = 7.5 W/K and 4 K; filled 0.5 3 0.25 4/2.
        let pair = HeatPair {
            volumes: (2.0, 3.0),
            conductivity: 10.0,
            correction: 0.5,
            replaced: 1.0,
            slope: 0.25,
            r2: 4.0,
            difference: 4.0f64,
        };
        let mut sum = Inflow { power: 1.0, ..Inflow::default() };
        sum.add(&pair, Dimension::Two);
        assert_eq!(sum, Inflow { power: 31.0, conductance: 7.5, filled: 0.75 });
        // Half as much again for pairs that are missing, which fill nothing.
        let mut more = Inflow::default();
        more.add(&HeatPair { replaced: 1.5, ..pair }, Dimension::Two);
        assert_eq!(more, Inflow { power: 45.0, conductance: 11.25, filled: 0.75 });
        // To a colder one, at initial positions: -15 W, and 6 0.25 (1 4 - 2 1) = 3 W flow on; 1.5 times better than at rest.
        let colder = HeatPair { difference: -2.0, ..pair };
        sum.add_reference(&colder, [4.0, -1.0, 0.0], [1.0, 2.0, 5.0], 1.5, Dimension::Three);
        assert_eq!((sum.power, sum.conductance), (31.0 - 15.0 - 3.0, 7.5 + 11.25));
        let mut gradient = [1.0, 0.0, 0.0];
        add_temperature_gradient(&mut gradient, 2.0, 0.25, 4.0, [3.0, -1.0, 0.0]);
        assert_eq!(gradient, [-5.0, 2.0, 0.0]);
    }

    #[test]
    fn heat_flows_better_along_what_is_pressed() {
        // A cube of side 1 pressed to half its height and spread to 1.5 x 1.2: through the height the area is 1.8 times as large and
        // the way half as long, 3.6; along x the area is 0.6, the way 1.5, 0.4; along y 0.75/1.2 = 0.625.
        let f = [[1.5, 0.0, 0.0], [0.0, 1.2, 0.0], [0.0, 0.0, 0.5]];
        let a = stretched(&f);
        for (k, expected) in [0.4, 0.625, 3.6].into_iter().enumerate() {
            assert!((a[k][k] - expected).abs() < 1e-12, "{a:?}");
        }
        // A rotation changes nothing.
        let turned = multiply(&[[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], &f);
        let b = stretched(&turned);
        assert!((0..9).all(|c| (a[c / 3][c % 3] - b[c / 3][c % 3]).abs() < 1e-12), "{b:?}");
        assert!((best_flow(&f) - 3.6).abs() < 1e-12);
        // Sheared by 2: J C^-1 = [[5, -2, 0], [-2, 1, 0], [0, 0, 1]].
        assert_eq!(best_flow(&[[1.0, 2.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), 7.0f64);
        assert_eq!(best_flow(&[[0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.5]]), 1.0f64);
        // 50 (0.4 - 1) (-3) along x, 50 2.6 1 along z: B = 1 along the face, not 2 across it, twice.
        let correction = [[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let q = added_flow(50.0, [-3.0, 0.0, 1.0], &f, &correction, Dimension::Three);
        assert!((q[0] - 90.0).abs() < 1e-10 && q[1] == 0.0 && (q[2] - 130.0).abs() < 1e-10, "{q:?}");
    }

    #[test]
    fn the_smallest_correction_is_that_along_a_face() {
        // Turned by 30 degrees about z: 1.25 along, 2 across, 1.5 along z.
        let (c, s) = (0.75f64.sqrt(), 0.5);
        let turn = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]];
        let along = [[1.25, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.5]];
        let b = multiply(&multiply(&turn, &along), &transpose(&turn));
        assert!((smallest_correction(&b, Dimension::Three) - 1.25).abs() < 1e-12);
        // In a plane the third axis is none, at a corner both are alike.
        let plane = [[2.0, 0.0, 0.0], [0.0, 1.75, 0.0], [0.0, 0.0, 1.0]];
        assert!((smallest_correction(&plane, Dimension::Two) - 1.75).abs() < 1e-12);
        assert_eq!(smallest_correction(&[[1.5, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], Dimension::One), 1.5f64);
        let corner = scaled(&identity(), 1.75f64);
        assert!((smallest_correction(&corner, Dimension::Three) - 1.75).abs() < 1e-12);
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
        // Cells of 2 mm at 1000 kg/m^3 with faces of 4 mm^2 at the start, of which some are free: one, two, three.
        let area = |faces: f64, lacking: f64| {
            let start = face_at_unit_density(Dimension::Three, faces * 4e-6, 1000.0);
            outline_area(Dimension::Three, (8e-9, 1000.0), 1.0 - 0.5 * lacking, 0.5, start) / 4e-6
        };
        for (faces, lacking, expected) in [
            (1.0, 1.1, 1.0),
            (1.0, 0.59, 0.59),
            (1.0, 2.01, 2.01),
            (1.2, 0.76, 1.2),
            (1.2, 0.74, 0.74),
            (2.0, 1.75, 2.0),
            (2.0, 1.34, 1.34),
            (3.0, 2.3, 3.0),
            (3.0, 2.04, 2.04),
            (0.0, 1.0, 1.0),
            (0.3, 0.06, 0.3),
            (0.3, 0.04, 0.0),
            (1.0, 0.1, 0.0),
        ] {
            assert!((area(faces, lacking) - expected).abs() < 1e-12, "{faces} {lacking}: {}", area(faces, lacking));
        }
    }
}
