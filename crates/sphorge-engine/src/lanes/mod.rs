//! SIMD vectors of neighbours worked on together, from one number to a SIMD register.
//!
//! Pair sums are written once over [`Lanes`]; which SIMD vector they run on is chosen when the program starts ([`Instructions`]).

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod dispatch;
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
mod elementary;
#[cfg(target_arch = "aarch64")]
mod neon;

pub(crate) use dispatch::{Instructions, Job, run};

use bytemuck::Pod;
use sphorge_physics::{Elementary, Real, Scalar};

/// Element type of pair arithmetic: `f64`, or `f32` with positions in fixed point.
pub(crate) trait PairScalar: Scalar + Pod + Lanes<Element = Self> {
    /// Largest magnitude an encoded coordinate may reach, in units.
    const RANGE: f64;

    /// SIMD vector of a 512-bit register.
    #[cfg(target_arch = "x86_64")]
    type Avx512: Lanes<Element = Self>;
    /// SIMD vector of a 256-bit register.
    #[cfg(target_arch = "x86_64")]
    type Avx2: Lanes<Element = Self>;
    /// SIMD vector of a 128-bit register.
    #[cfg(target_arch = "aarch64")]
    type Neon: Lanes<Element = Self>;

    /// Rounds the numbers of a 512-bit register into the first eight places.
    ///
    /// # Safety
    ///
    /// The processor must have AVX-512.
    #[cfg(target_arch = "x86_64")]
    unsafe fn store_avx512(values: std::arch::x86_64::__m512d, out: &mut [Self]);

    /// A coordinate, given as a number of units from the origin, in the form records carry it.
    ///
    /// Single precision keeps it as a 32-bit integer (stored as the bits of a float): differences of integers are exact, so
    /// the distance of two close particles does not suffer from their distance to the origin.
    fn encode(units: f64) -> Self;

    /// Velocity component (m/s) below which a particle stands still.
    ///
    /// Ahead of a wave velocities fall by orders of magnitude from one row of particles to the next, and products of them in single
    /// precision would be subnormal numbers, with which some processors compute slowly (docs/performance.md). The bound is far below what
    /// single precision rounds of a sound speed.
    const STANDSTILL: f64;

    /// Displacement (m) and displacement gradient below which a particle is where it was, for the same reason: a
    /// trillionth of the smallest spacings that metal is computed with, and less than double precision rounds of one.
    const UNMOVED: f64;
    /// See [`PairScalar::UNMOVED`].
    const UNSTRAINED: f64;

    /// A displacement component (m) as a number and what is rounded off it.
    #[inline(always)]
    fn of_displacement(displacement: f64) -> [Self; 2] {
        if displacement.abs() < Self::UNMOVED {
            return [Self::zero(); 2];
        }
        let number = Self::of(displacement);
        [number, Self::of(displacement - number.to_f64())]
    }

    /// A component of a displacement gradient in the precision of pair sums.
    #[inline(always)]
    fn of_displacement_gradient(component: f64) -> Self {
        if component.abs() < Self::UNSTRAINED { Self::zero() } else { Self::of(component) }
    }

    /// A velocity component (m/s) in the precision of pair sums.
    #[inline(always)]
    fn of_velocity(velocity: f64) -> Self {
        if velocity.abs() < Self::STANDSTILL { Self::zero() } else { Self::of(velocity) }
    }
}

/// A SIMD vector of numbers of one element type.
///
/// SIMD vectors wider than one use instructions the processor may lack: values of such types are only made inside functions that
/// [`multiversion`] enters after it has checked.
pub(crate) trait Lanes: Elementary {
    /// One lane.
    type Element: PairScalar;
    /// Number of lanes; divides [`crate::neighbors::PAD`].
    const WIDTH: usize;

    /// The same value in every lane.
    fn splat(value: Self::Element) -> Self;
    /// The first `WIDTH` values of a slice.
    fn load(values: &[Self::Element]) -> Self;
    /// Takes entries `first` to `first + N` of the records at the first `WIDTH` indices apart into one SIMD vector per entry; panics
    /// unless there are such records.
    fn gather_part<const F: usize, const N: usize>(
        records: &[[Self::Element; F]],
        indices: &[u32],
        first: usize,
    ) -> [Self; N];
    /// Takes the records at `WIDTH` indices apart into one SIMD vector per record entry.
    #[inline(always)]
    fn gather<const F: usize>(records: &[[Self::Element; F]], indices: &[u32]) -> [Self; F] {
        Self::gather_part::<F, F>(records, indices, 0)
    }
    /// Difference `a - b` of two encoded coordinates, m; `unit` is the size of a unit, m.
    #[inline(always)]
    fn difference(a: Self, b: Self, unit: Self) -> Self {
        Self::coordinate_difference(a, b) * unit
    }
    /// Difference `a - b` of two encoded coordinates, in units.
    fn coordinate_difference(a: Self, b: Self) -> Self;
    /// Sum over the lanes, always in the same order.
    fn sum(self) -> Self::Element;
    /// The sum of each SIMD vector over its lanes, always in the same order.
    #[inline(always)]
    fn sums<const N: usize>(vectors: [Self; N]) -> [Self::Element; N] {
        let mut sums = [<Self::Element as Real>::zero(); N];
        for k in 0..N {
            sums[k] = vectors[k].sum();
        }
        sums
    }
    /// Largest lane.
    fn largest(self) -> Self::Element;
    /// Bit k set where lane k of `a` is smaller than that of `b`.
    fn less(a: Self, b: Self) -> u32;
    /// Writes those of the first `WIDTH` indices whose bit in `mask` is set, `own` not among them, one behind the other; returns
    /// how many. `out` has room for `WIDTH`, all of which may be overwritten.
    fn compress_others(mask: u32, indices: &[u32], own: u32, out: &mut [u32]) -> usize;
    /// Writes the lanes whose bit in `mask` is set one behind the other. `out` has room for `WIDTH`, all of which may be
    /// overwritten.
    fn compress_values(self, mask: u32, out: &mut [Self::Element]);
    /// Writes all lanes to the front of `out`.
    #[inline(always)]
    fn store(self, out: &mut [Self::Element]) {
        self.compress_values(((1u64 << Self::WIDTH) - 1) as u32, out);
    }
    /// Writes lane k of eight SIMD vectors to the entries of record k from `first` on, rounded to the precision of the records, for as
    /// many records as there are, at most `WIDTH`: the other way of [`Lanes::gather_part`].
    #[inline(always)]
    fn store_part<T: PairScalar, const F: usize>(columns: [Self; 8], records: &mut [[T; F]], first: usize) {
        let mut values = [<Self::Element as Real>::zero(); crate::neighbors::PAD];
        for c in 0..8 {
            columns[c].store(&mut values);
            for (record, value) in records.iter_mut().zip(&values[..Self::WIDTH]) {
                record[first + c] = T::of(value.to_f64());
            }
        }
    }
}

/// A record, every entry in all lanes. Not `array::map`: a closure would not be compiled for the instructions in use.
#[inline(always)]
pub(crate) fn splat_record<L: Lanes, const F: usize>(record: &[L::Element; F]) -> [L; F] {
    let mut lanes = [L::zero(); F];
    for f in 0..F {
        lanes[f] = L::splat(record[f]);
    }
    lanes
}

/// Gathers records of any length value by value.
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
#[inline(always)]
fn gather_entries<L: Lanes, const F: usize, const N: usize, const W: usize>(
    records: &[[L::Element; F]],
    indices: &[u32],
    first: usize,
) -> [L; N] {
    let mut lanes = [L::zero(); N];
    for f in 0..N {
        let mut values = [<L::Element as Real>::zero(); W];
        for k in 0..W {
            values[k] = records[indices[k] as usize][first + f];
        }
        lanes[f] = L::load(&values);
    }
    lanes
}

/// [`Real::lane_by_lane`] of a SIMD vector.
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
#[inline(always)]
fn each_lane<L: Lanes>(a: L, b: L, f: impl Fn(f64, f64) -> [f64; 2]) -> [L; 2] {
    let mut values = [[<L::Element as Real>::zero(); crate::neighbors::PAD]; 2];
    a.store(&mut values[0]);
    b.store(&mut values[1]);
    for k in 0..L::WIDTH {
        let made = f(values[0][k].to_f64(), values[1][k].to_f64());
        values[0][k] = L::Element::of(made[0]);
        values[1][k] = L::Element::of(made[1]);
    }
    [L::load(&values[0]), L::load(&values[1])]
}

/// Compression one value at a time.
#[inline(always)]
fn compress_each<V: Copy + PartialEq>(mask: u32, values: &[V], own: Option<V>, out: &mut [V]) -> usize {
    let mut count = 0;
    let mut left = mask;
    while left != 0 {
        let value = values[left.trailing_zeros() as usize];
        if own != Some(value) {
            out[count] = value;
            count += 1;
        }
        left &= left - 1;
    }
    count
}

impl PairScalar for f64 {
    const RANGE: f64 = 1.0;
    const STANDSTILL: f64 = 0.0;
    const UNMOVED: f64 = 0.0;
    const UNSTRAINED: f64 = 0.0;
    #[cfg(target_arch = "x86_64")]
    type Avx512 = avx512::F64x8;
    #[cfg(target_arch = "x86_64")]
    type Avx2 = avx2::F64x4;
    #[cfg(target_arch = "aarch64")]
    type Neon = neon::F64x2;

    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn store_avx512(values: std::arch::x86_64::__m512d, out: &mut [Self]) {
        // SAFETY: whoever calls has AVX-512, which is all that is asked for.
        unsafe { avx512::store_f64(values, out) }
    }

    #[inline(always)]
    fn encode(units: f64) -> Self {
        units
    }
}

impl PairScalar for f32 {
    // Half the range of an `i32`: the difference of two coordinates still fits.
    const RANGE: f64 = (1u32 << 30) as f64;
    const STANDSTILL: f64 = 1e-12;
    const UNMOVED: f64 = 1e-18;
    const UNSTRAINED: f64 = 1e-16;
    #[cfg(target_arch = "x86_64")]
    type Avx512 = avx512::F32x16;
    #[cfg(target_arch = "x86_64")]
    type Avx2 = avx2::F32x8;
    #[cfg(target_arch = "aarch64")]
    type Neon = neon::F32x4;

    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    unsafe fn store_avx512(values: std::arch::x86_64::__m512d, out: &mut [Self]) {
        // SAFETY: as of the other precision.
        unsafe { avx512::store_f32(values, out) }
    }

    #[inline(always)]
    fn encode(units: f64) -> Self {
        // Adding 1.5 2^52 rounds to the nearest integer and leaves it in the low bits.
        f32::from_bits((units + 6_755_399_441_055_744.0).to_bits() as u32)
    }
}

macro_rules! single_lane {
    ($t:ident, |$a:ident, $b:ident| $difference:expr) => {
        impl Lanes for $t {
            type Element = Self;
            const WIDTH: usize = 1;

            #[inline(always)]
            fn splat(value: Self) -> Self {
                value
            }
            #[inline(always)]
            fn load(values: &[Self]) -> Self {
                values[0]
            }
            #[inline(always)]
            fn gather_part<const F: usize, const N: usize>(
                records: &[[Self; F]],
                indices: &[u32],
                first: usize,
            ) -> [Self; N] {
                let record = &records[indices[0] as usize];
                let mut part = [0.0; N];
                part.copy_from_slice(&record[first..first + N]);
                part
            }
            #[inline(always)]
            fn coordinate_difference($a: Self, $b: Self) -> Self {
                $difference
            }
            #[inline(always)]
            fn sum(self) -> Self {
                self
            }
            #[inline(always)]
            fn largest(self) -> Self {
                self
            }
            #[inline(always)]
            fn less(a: Self, b: Self) -> u32 {
                u32::from(a < b)
            }
            #[inline(always)]
            fn compress_others(mask: u32, indices: &[u32], own: u32, out: &mut [u32]) -> usize {
                compress_each(mask, indices, Some(own), out)
            }
            #[inline(always)]
            fn compress_values(self, mask: u32, out: &mut [Self]) {
                compress_each(mask, &[self], None, out);
            }
        }
    };
}

single_lane!(f64, |a, b| a - b);
single_lane!(f32, |a, b| (a.to_bits() as i32).wrapping_sub(b.to_bits() as i32) as f32);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn velocities_far_ahead_of_a_wave_are_none_in_single_precision() {
        assert_eq!((f32::of_velocity(-1e-13), f32::of_velocity(-1e-11)), (0.0, -1e-11));
        assert_eq!(f64::of_velocity(-1e-300), -1e-300);
        // Even the square of the smallest that counts is far from them.
        let least = f32::of_velocity(f32::STANDSTILL);
        assert!(least > 0.0 && (least * least * 1e-10).is_normal());
    }

    #[test]
    fn fixed_point_keeps_the_distance_of_close_particles_far_from_the_origin() {
        // Two particles 1.0003 mm apart, 1.4 m from the origin of a 3 m domain.
        let unit = 1.5 / f32::RANGE;
        let [a, b] = [1.4, 1.4010003].map(|x: f64| f32::encode(x / unit));
        let d = f32::difference(b, a, unit as f32);
        assert!((f64::from(d) - 1.0003e-3).abs() < 2.0 * unit, "{d}");
        // Plain single precision would be off by its spacing at 1.4, a hundred times more.
        assert!((f64::from(1.4010003f32 - 1.4f32) - 1.0003e-3).abs() > 10.0 * unit);
    }

    /// Every operation of a SIMD vector against the same operation lane by lane.
    #[inline(always)]
    fn compare<L: Lanes>() {
        let of = |x: f64| L::Element::of(x);
        let a: Vec<L::Element> = (0..L::WIDTH).map(|k| of(1.5 + k as f64)).collect();
        let b: Vec<L::Element> =
            (0..L::WIDTH).map(|k| of(if k % 3 == 0 { -2.25 } else { 6.5 } + 0.5 * k as f64)).collect();
        let (x, y) = (L::load(&a), L::load(&b));
        // The lanes of a SIMD vector, through a dot with unit vectors.
        let lanes = |v: L| -> Vec<f64> {
            (0..L::WIDTH)
                .map(|k| {
                    let unit: Vec<L::Element> = (0..L::WIDTH).map(|l| of(f64::from(u8::from(l == k)))).collect();
                    (v * L::load(&unit)).sum().to_f64()
                })
                .collect()
        };
        let each = |f: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
            a.iter().zip(&b).map(|(x, y)| f(x.to_f64(), y.to_f64())).collect()
        };
        let close = |got: Vec<f64>, want: Vec<f64>| {
            for (g, w) in got.iter().zip(&want) {
                assert!((g - w).abs() <= 1e-6 * w.abs(), "{got:?} {want:?}");
            }
        };
        close(lanes(x + y), each(&|x, y| x + y));
        close(lanes(x - y), each(&|x, y| x - y));
        close(lanes(x * y), each(&|x, y| x * y));
        close(lanes(x / y), each(&|x, y| x / y));
        close(lanes(-y), each(&|_, y| -y));
        close(lanes(x.mul_add(y, x)), each(&|x, y| x * y + x));
        close(lanes(x.sqrt()), each(&|x, _| x.sqrt()));
        close(lanes(x.inverse_sqrt()), each(&|x, _| 1.0 / x.sqrt()));
        close(lanes(x.min(y)), each(&f64::min));
        close(lanes(x.max(y)), each(&f64::max));
        close(lanes(y.abs()), each(&|_, y| y.abs()));
        close(lanes(L::select_lt(x, y, x, L::of(9.0))), each(&|x, y| if x < y { x } else { 9.0 }));
        let [difference, logarithm] = L::lane_by_lane(x, y, |x, y| [x - y, (x * x + y.abs()).ln()]);
        close(lanes(difference), each(&|x, y| x - y));
        close(lanes(logarithm), each(&|x, y| (x * x + y.abs()).ln()));
        close(vec![x.sum().to_f64()], vec![a.iter().map(|v| v.to_f64()).sum()]);
        let sum_of = |v: &[L::Element]| v.iter().map(|v| v.to_f64()).sum::<f64>();
        let (p, q) = (sum_of(&a), sum_of(&b));
        // As many as one part, one more, and a few of a part.
        close(L::sums([x, y, y, x, y, x, x, y, x]).map(|v| v.to_f64()).to_vec(), vec![p, q, q, p, q, p, p, q, p]);
        close(L::sums([x, y, y, x, y, x, x]).map(|v| v.to_f64()).to_vec(), vec![p, q, q, p, q, p, p]);
        close(vec![y.largest().to_f64()], vec![b.iter().map(|v| v.to_f64()).fold(f64::MIN, f64::max)]);

        let want: u32 = a.iter().zip(&b).enumerate().map(|(k, (x, y))| u32::from(x < y) << k).sum();
        let mask = L::less(x, y);
        assert_eq!(mask, want);
        let indices: Vec<u32> = (100..100 + L::WIDTH as u32).collect();
        let mut out = vec![0; 2 * L::WIDTH];
        let inside = |k: &usize| mask >> k & 1 == 1;
        for own in [u32::MAX, 100, 101] {
            let count = L::compress_others(mask, &indices, own, &mut out);
            let kept: Vec<u32> = (0..L::WIDTH).filter(inside).map(|k| indices[k]).filter(|&i| i != own).collect();
            assert_eq!(out[..count], kept);
        }
        let mut out = vec![of(0.0); 2 * L::WIDTH];
        x.store(&mut out);
        assert_eq!(out[..L::WIDTH], a);
        fn stores<L: Lanes, T: PairScalar>(x: L, y: L, a: &[L::Element], b: &[L::Element]) {
            for count in 1..=L::WIDTH + 1 {
                let mut records = vec![[T::one(); 11]; count];
                L::store_part([x, y, y, x, x, y, x, y], &mut records, 2);
                for (k, record) in records.into_iter().enumerate() {
                    let mut want = [T::one(); 11];
                    if k < L::WIDTH {
                        let (a, b) = (T::of(a[k].to_f64()), T::of(b[k].to_f64()));
                        want[2..10].copy_from_slice(&[a, b, b, a, a, b, a, b]);
                    }
                    assert_eq!(record, want);
                }
            }
        }
        stores::<L, f32>(x, y, &a, &b);
        stores::<L, f64>(x, y, &a, &b);
        y.compress_values(mask, &mut out);
        let kept: Vec<f64> = (0..L::WIDTH).filter(inside).map(|k| b[k].to_f64()).collect();
        assert_eq!(out.iter().map(|v| v.to_f64()).take(kept.len()).collect::<Vec<_>>(), kept);

        fn gathers<L: Lanes, const F: usize>(lanes: &dyn Fn(L) -> Vec<f64>) {
            let records: Vec<[L::Element; F]> =
                (0..40).map(|r| std::array::from_fn(|f| L::Element::of((100 * r + f) as f64))).collect();
            let indices: Vec<u32> = (0..L::WIDTH as u32).map(|k| (7 * k + 3) % 40).collect();
            for (f, vector) in L::gather(&records, &indices).into_iter().enumerate() {
                assert_eq!(
                    lanes(vector),
                    indices.iter().map(|&i| (100 * i as usize + f) as f64).collect::<Vec<_>>(),
                    "{F} {f}"
                );
            }
        }
        gathers::<L, 1>(&lanes);
        gathers::<L, 3>(&lanes);
        gathers::<L, 8>(&lanes);
        gathers::<L, 9>(&lanes);
        gathers::<L, 16>(&lanes);
        let records: Vec<[L::Element; 16]> =
            (0..20).map(|r| std::array::from_fn(|f| of((100 * r + f) as f64))).collect();
        let indices: Vec<u32> = (0..L::WIDTH as u32).map(|k| (7 * k + 3) % 20).collect();
        for (f, vector) in L::gather_part::<16, 8>(&records, &indices, 8).into_iter().enumerate() {
            assert_eq!(lanes(vector), indices.iter().map(|&i| f64::from(100 * i) + (8 + f) as f64).collect::<Vec<_>>());
        }

        let unit = 1e-3;
        let encoded: Vec<L::Element> = (0..L::WIDTH).map(|k| L::Element::encode(f64::from(k as u32) * 17.0)).collect();
        let first = L::splat(L::Element::encode(5.0));
        let d = L::difference(first, L::load(&encoded), L::of(unit));
        close(lanes(d), (0..L::WIDTH).map(|k| (5.0 - 17.0 * k as f64) * unit).collect());
    }

    struct Compare;
    impl<T: PairScalar> Job<T> for Compare {
        #[inline(always)]
        fn run<L: Lanes<Element = T>>(self) {
            compare::<L>();
        }
    }

    #[test]
    fn every_vector_of_this_machine_computes_what_single_numbers_do() {
        for instructions in Instructions::available() {
            run::<f32, _>(instructions, Compare);
            run::<f64, _>(instructions, Compare);
        }
    }
}
