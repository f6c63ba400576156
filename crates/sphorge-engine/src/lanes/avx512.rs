//! SIMD vectors in 512-bit registers.
#![expect(clippy::undocumented_unsafe_blocks, reason = "one comment says why all of them are sound")]

use super::avx2::{F32x8, F64x4};
use super::elementary::{Doubles, elementary_of_doubles, elementary_of_singles};
use super::{Lanes, PairScalar, compress_each, each_lane, gather_entries};
use sphorge_physics::Real;
use std::arch::x86_64::*;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// Sixteen single-precision numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct F32x16(__m512);

/// Eight double-precision numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct F64x8(__m512d);

// SAFETY of every `unsafe` below: SIMD vectors exist only inside jobs started after the processor has been found to have AVX-512
// (see `Lanes`); loads and stores stay within slices whose length is asserted or checked by indexing.

/// The estimate of the processor, 14 bits, and a Newton step: a third of the time of root and division.
#[inline(always)]
fn newton_inverse_sqrt(x: F32x16) -> F32x16 {
    let estimate = F32x16(unsafe { _mm512_rsqrt14_ps(x.0) });
    let half = F32x16::of(0.5) * x * estimate;
    estimate * F32x16(unsafe { _mm512_fnmadd_ps(half.0, estimate.0, F32x16::of(1.5).0) })
}

macro_rules! arithmetic {
    ($vector:ident, $element:ty, $set1:ident, $add:ident, $sub:ident, $mul:ident, $div:ident, $fmadd:ident, $sqrt:ident,
     $min:ident, $max:ident, $abs:ident, $cmp:ident, $blend:ident, $inverse_sqrt:expr) => {
        impl Add for $vector {
            type Output = Self;
            #[inline(always)]
            fn add(self, b: Self) -> Self {
                Self(unsafe { $add(self.0, b.0) })
            }
        }
        impl Sub for $vector {
            type Output = Self;
            #[inline(always)]
            fn sub(self, b: Self) -> Self {
                Self(unsafe { $sub(self.0, b.0) })
            }
        }
        impl Mul for $vector {
            type Output = Self;
            #[inline(always)]
            fn mul(self, b: Self) -> Self {
                Self(unsafe { $mul(self.0, b.0) })
            }
        }
        impl Div for $vector {
            type Output = Self;
            #[inline(always)]
            fn div(self, b: Self) -> Self {
                Self(unsafe { $div(self.0, b.0) })
            }
        }
        impl Neg for $vector {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self::zero() - self
            }
        }
        impl AddAssign for $vector {
            #[inline(always)]
            fn add_assign(&mut self, b: Self) {
                *self = *self + b;
            }
        }
        impl SubAssign for $vector {
            #[inline(always)]
            fn sub_assign(&mut self, b: Self) {
                *self = *self - b;
            }
        }
        impl Real for $vector {
            #[inline(always)]
            fn of(value: f64) -> Self {
                Self(unsafe { $set1(value as $element) })
            }
            #[inline(always)]
            fn mul_add(self, a: Self, b: Self) -> Self {
                Self(unsafe { $fmadd(self.0, a.0, b.0) })
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                Self(unsafe { $sqrt(self.0) })
            }
            #[inline(always)]
            fn inverse_sqrt(self) -> Self {
                $inverse_sqrt(self)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                Self(unsafe { $min(self.0, other.0) })
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                Self(unsafe { $max(self.0, other.0) })
            }
            #[inline(always)]
            fn abs(self) -> Self {
                Self(unsafe { $abs(self.0) })
            }
            #[inline(always)]
            fn select_lt(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
                Self(unsafe { $blend($cmp::<_CMP_LT_OQ>(a.0, b.0), otherwise.0, then.0) })
            }
            #[inline(always)]
            fn lane_by_lane(a: Self, b: Self, f: impl Fn(f64, f64) -> [f64; 2]) -> [Self; 2] {
                each_lane(a, b, f)
            }
        }
    };
}

arithmetic!(
    F32x16,
    f32,
    _mm512_set1_ps,
    _mm512_add_ps,
    _mm512_sub_ps,
    _mm512_mul_ps,
    _mm512_div_ps,
    _mm512_fmadd_ps,
    _mm512_sqrt_ps,
    _mm512_min_ps,
    _mm512_max_ps,
    _mm512_abs_ps,
    _mm512_cmp_ps_mask,
    _mm512_mask_blend_ps,
    newton_inverse_sqrt
);
arithmetic!(
    F64x8,
    f64,
    _mm512_set1_pd,
    _mm512_add_pd,
    _mm512_sub_pd,
    _mm512_mul_pd,
    _mm512_div_pd,
    _mm512_fmadd_pd,
    _mm512_sqrt_pd,
    _mm512_min_pd,
    _mm512_max_pd,
    _mm512_abs_pd,
    _mm512_cmp_pd_mask,
    _mm512_mask_blend_pd,
    |x: F64x8| F64x8::one() / x.sqrt()
);

elementary_of_singles!(F32x16);
elementary_of_doubles!(F64x8);

impl Doubles for F64x8 {
    #[inline(always)]
    fn mantissa_and_exponent(self) -> [Self; 2] {
        let mantissa = unsafe { _mm512_getmant_pd::<_MM_MANT_NORM_1_2, _MM_MANT_SIGN_ZERO>(self.0) };
        [Self(mantissa), Self(unsafe { _mm512_getexp_pd(self.0) })]
    }
    #[inline(always)]
    fn times_power_of_two(self, exponent: Self) -> Self {
        Self(unsafe { _mm512_scalef_pd(self.0, exponent.0) })
    }
}

/// Transposes eight rows of eight singles, two such blocks side by side (low and high 256 bits).
#[inline(always)]
unsafe fn transpose_two_8x8(r: [__m512; 8]) -> [__m512; 8] {
    unsafe {
        let t0 = _mm512_unpacklo_ps(r[0], r[1]);
        let t1 = _mm512_unpackhi_ps(r[0], r[1]);
        let t2 = _mm512_unpacklo_ps(r[2], r[3]);
        let t3 = _mm512_unpackhi_ps(r[2], r[3]);
        let t4 = _mm512_unpacklo_ps(r[4], r[5]);
        let t5 = _mm512_unpackhi_ps(r[4], r[5]);
        let t6 = _mm512_unpacklo_ps(r[6], r[7]);
        let t7 = _mm512_unpackhi_ps(r[6], r[7]);
        let u0 = _mm512_shuffle_ps::<0x44>(t0, t2);
        let u1 = _mm512_shuffle_ps::<0xEE>(t0, t2);
        let u2 = _mm512_shuffle_ps::<0x44>(t1, t3);
        let u3 = _mm512_shuffle_ps::<0xEE>(t1, t3);
        let u4 = _mm512_shuffle_ps::<0x44>(t4, t6);
        let u5 = _mm512_shuffle_ps::<0xEE>(t4, t6);
        let u6 = _mm512_shuffle_ps::<0x44>(t5, t7);
        let u7 = _mm512_shuffle_ps::<0xEE>(t5, t7);
        // u_k holds column k (low 128 of each half) and column k + 4 (high 128), rows 0-3 or 4-7.
        let low = _mm512_setr_epi32(0, 1, 2, 3, 16, 17, 18, 19, 8, 9, 10, 11, 24, 25, 26, 27);
        let high = _mm512_setr_epi32(4, 5, 6, 7, 20, 21, 22, 23, 12, 13, 14, 15, 28, 29, 30, 31);
        [
            _mm512_permutex2var_ps(u0, low, u4),
            _mm512_permutex2var_ps(u1, low, u5),
            _mm512_permutex2var_ps(u2, low, u6),
            _mm512_permutex2var_ps(u3, low, u7),
            _mm512_permutex2var_ps(u0, high, u4),
            _mm512_permutex2var_ps(u1, high, u5),
            _mm512_permutex2var_ps(u2, high, u6),
            _mm512_permutex2var_ps(u3, high, u7),
        ]
    }
}

/// Fails unless all indices are those of records: one test for all of them.
#[inline(always)]
fn assert_below_16(indices: &[u32; 16], count: usize) {
    let count = u32::try_from(count).unwrap_or(u32::MAX) as i32;
    let outside =
        unsafe { _mm512_cmpge_epu32_mask(_mm512_loadu_si512(indices.as_ptr().cast()), _mm512_set1_epi32(count)) };
    assert!(outside == 0, "index of a neighbour out of bounds");
}

/// As [`assert_below_16`], for eight indices.
#[inline(always)]
fn assert_below_8(indices: &[u32; 8], count: usize) {
    let count = u32::try_from(count).unwrap_or(u32::MAX) as i32;
    let outside =
        unsafe { _mm256_cmpge_epu32_mask(_mm256_loadu_si256(indices.as_ptr().cast()), _mm256_set1_epi32(count)) };
    assert!(outside == 0, "index of a neighbour out of bounds");
}

/// Index `k`, read from memory: the compiler would load them all at once and take the register apart, which costs more than
/// the loads.
#[inline(always)]
fn index<const W: usize>(indices: &[u32; W], k: usize) -> usize {
    // SAFETY: a reference is valid to read.
    (unsafe { std::ptr::from_ref(&indices[k]).read_volatile() }) as usize
}

/// Eight columns of sixteen records of `F` entries, the first of which lies at `start`.
///
/// # Safety
///
/// Every index must be that of a record with eight entries at and behind its place of `start`.
#[inline(always)]
unsafe fn columns_f32<const F: usize>(start: *const f32, indices: &[u32; 16]) -> [__m512; 8] {
    unsafe {
        let mut rows = [_mm512_setzero_ps(); 8];
        for k in 0..8 {
            let low = _mm256_loadu_ps(start.add(F * index(indices, k)));
            let high = _mm256_loadu_ps(start.add(F * index(indices, k + 8)));
            rows[k] = _mm512_insertf32x8::<1>(_mm512_castps256_ps512(low), high);
        }
        transpose_two_8x8(rows)
    }
}

/// The first `W` indices.
#[inline(always)]
fn first_indices<const W: usize>(indices: &[u32]) -> &[u32; W] {
    match indices.first_chunk::<W>() {
        Some(indices) => indices,
        None => panic!("fewer indices than lanes"),
    }
}

impl Lanes for F32x16 {
    type Element = f32;
    const WIDTH: usize = 16;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self(unsafe { _mm512_set1_ps(value) })
    }
    #[inline(always)]
    fn load(values: &[f32]) -> Self {
        let values = &values[..16];
        Self(unsafe { _mm512_loadu_ps(values.as_ptr()) })
    }
    #[inline(always)]
    fn gather_part<const F: usize, const N: usize>(records: &[[f32; F]], indices: &[u32], first: usize) -> [Self; N] {
        if !N.is_multiple_of(8) {
            return gather_entries::<Self, F, N, 16>(records, indices, first);
        }
        let indices = first_indices::<16>(indices);
        assert!(first + N <= F);
        assert_below_16(indices, records.len());
        let mut lanes = [Self::zero(); N];
        for part in (0..N).step_by(8) {
            // SAFETY: indices are those of records; `N` entries from `first` on lie within one.
            let columns = unsafe { columns_f32::<F>(records.as_ptr().cast::<f32>().add(first + part), indices) };
            for c in 0..8 {
                lanes[part + c] = Self(columns[c]);
            }
        }
        lanes
    }
    #[inline(always)]
    fn coordinate_difference(a: Self, b: Self) -> Self {
        let d = unsafe { _mm512_sub_epi32(_mm512_castps_si512(a.0), _mm512_castps_si512(b.0)) };
        Self(unsafe { _mm512_cvtepi32_ps(d) })
    }
    #[inline(always)]
    fn sum(self) -> f32 {
        unsafe { _mm512_reduce_add_ps(self.0) }
    }
    #[inline(always)]
    fn sums<const N: usize>(vectors: [Self; N]) -> [f32; N] {
        let mut halved = [F32x8::zero(); N];
        for k in 0..N {
            let b = vectors[k].0;
            halved[k] = unsafe { F32x8(_mm512_castps512_ps256(b)) + F32x8(_mm512_extractf32x8_ps::<1>(b)) };
        }
        F32x8::sums(halved)
    }
    #[inline(always)]
    fn largest(self) -> f32 {
        unsafe { _mm512_reduce_max_ps(self.0) }
    }
    #[inline(always)]
    fn less(a: Self, b: Self) -> u32 {
        u32::from(unsafe { _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a.0, b.0) })
    }
    #[inline(always)]
    fn compress_others(mask: u32, indices: &[u32], own: u32, out: &mut [u32]) -> usize {
        let (indices, out) = (&indices[..16], &mut out[..16]);
        // A compressed register and a full store: the compressing store is slow on some processors.
        unsafe {
            let indices = _mm512_loadu_si512(indices.as_ptr().cast());
            let mask = _mm512_mask_cmpneq_epu32_mask(mask as u16, indices, _mm512_set1_epi32(own as i32));
            _mm512_storeu_si512(out.as_mut_ptr().cast(), _mm512_maskz_compress_epi32(mask, indices));
            mask.count_ones() as usize
        }
    }
    #[inline(always)]
    fn compress_values(self, mask: u32, out: &mut [f32]) {
        let out = &mut out[..16];
        unsafe { _mm512_storeu_ps(out.as_mut_ptr(), _mm512_maskz_compress_ps(mask as u16, self.0)) }
    }
}

/// Stores eight doubles.
///
/// # Safety
///
/// The processor must have AVX-512.
#[inline(always)]
pub(super) unsafe fn store_f64(values: __m512d, out: &mut [f64]) {
    let out = &mut out[..8];
    unsafe { _mm512_storeu_pd(out.as_mut_ptr(), values) }
}

/// Stores eight doubles as singles.
///
/// # Safety
///
/// The processor must have AVX-512.
#[inline(always)]
pub(super) unsafe fn store_f32(values: __m512d, out: &mut [f32]) {
    let out = &mut out[..8];
    unsafe { _mm256_storeu_ps(out.as_mut_ptr(), _mm512_cvtpd_ps(values)) }
}

/// From four registers with one 128-bit part per even (or odd) column, the four columns.
#[inline(always)]
unsafe fn gather_parts(a: __m512d, b: __m512d, c: __m512d, d: __m512d) -> [__m512d; 4] {
    unsafe {
        let x = _mm512_shuffle_f64x2::<0x88>(a, b);
        let y = _mm512_shuffle_f64x2::<0x88>(c, d);
        let z = _mm512_shuffle_f64x2::<0xDD>(a, b);
        let w = _mm512_shuffle_f64x2::<0xDD>(c, d);
        [
            _mm512_shuffle_f64x2::<0x88>(x, y),
            _mm512_shuffle_f64x2::<0x88>(z, w),
            _mm512_shuffle_f64x2::<0xDD>(x, y),
            _mm512_shuffle_f64x2::<0xDD>(z, w),
        ]
    }
}

/// Transposes eight rows of eight doubles.
#[inline(always)]
unsafe fn transpose_8x8(r: [__m512d; 8]) -> [__m512d; 8] {
    unsafe {
        let t0 = _mm512_unpacklo_pd(r[0], r[1]);
        let t1 = _mm512_unpackhi_pd(r[0], r[1]);
        let t2 = _mm512_unpacklo_pd(r[2], r[3]);
        let t3 = _mm512_unpackhi_pd(r[2], r[3]);
        let t4 = _mm512_unpacklo_pd(r[4], r[5]);
        let t5 = _mm512_unpackhi_pd(r[4], r[5]);
        let t6 = _mm512_unpacklo_pd(r[6], r[7]);
        let t7 = _mm512_unpackhi_pd(r[6], r[7]);
        // t0: columns 0, 2, 4, 6 of rows 0 and 1 in its four 128-bit parts; t1: columns 1, 3, 5, 7.
        let [c0, c2, c4, c6] = gather_parts(t0, t2, t4, t6);
        let [c1, c3, c5, c7] = gather_parts(t1, t3, t5, t7);
        [c0, c1, c2, c3, c4, c5, c6, c7]
    }
}

impl Lanes for F64x8 {
    type Element = f64;
    const WIDTH: usize = 8;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self(unsafe { _mm512_set1_pd(value) })
    }
    #[inline(always)]
    fn load(values: &[f64]) -> Self {
        let values = &values[..8];
        Self(unsafe { _mm512_loadu_pd(values.as_ptr()) })
    }
    #[inline(always)]
    fn gather_part<const F: usize, const N: usize>(records: &[[f64; F]], indices: &[u32], first: usize) -> [Self; N] {
        if !N.is_multiple_of(8) {
            return gather_entries::<Self, F, N, 8>(records, indices, first);
        }
        let indices = first_indices::<8>(indices);
        assert!(first + N <= F);
        assert_below_8(indices, records.len());
        let mut lanes = [Self::zero(); N];
        for part in (0..N).step_by(8) {
            // SAFETY: indices are those of records; `N` entries from `first` on lie within one.
            let columns = unsafe {
                let start = records.as_ptr().cast::<f64>().add(first + part);
                let mut rows = [_mm512_setzero_pd(); 8];
                for k in 0..8 {
                    rows[k] = _mm512_loadu_pd(start.add(F * index(indices, k)));
                }
                transpose_8x8(rows)
            };
            for c in 0..8 {
                lanes[part + c] = Self(columns[c]);
            }
        }
        lanes
    }
    #[inline(always)]
    fn coordinate_difference(a: Self, b: Self) -> Self {
        a - b
    }
    #[inline(always)]
    fn sum(self) -> f64 {
        unsafe { _mm512_reduce_add_pd(self.0) }
    }
    #[inline(always)]
    fn sums<const N: usize>(vectors: [Self; N]) -> [f64; N] {
        let mut halved = [F64x4::zero(); N];
        for k in 0..N {
            let b = vectors[k].0;
            halved[k] = unsafe { F64x4(_mm512_castpd512_pd256(b)) + F64x4(_mm512_extractf64x4_pd::<1>(b)) };
        }
        F64x4::sums(halved)
    }
    #[inline(always)]
    fn largest(self) -> f64 {
        unsafe { _mm512_reduce_max_pd(self.0) }
    }
    #[inline(always)]
    fn less(a: Self, b: Self) -> u32 {
        u32::from(unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(a.0, b.0) })
    }
    #[inline(always)]
    fn compress_others(mask: u32, indices: &[u32], own: u32, out: &mut [u32]) -> usize {
        compress_each(mask, &indices[..8], Some(own), out)
    }
    #[inline(always)]
    fn store(self, out: &mut [f64]) {
        let out = &mut out[..8];
        unsafe { _mm512_storeu_pd(out.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    fn store_part<T: PairScalar, const F: usize>(columns: [Self; 8], records: &mut [[T; F]], first: usize) {
        let [a, b, c, d, e, f, g, h] = columns;
        let rows = unsafe { transpose_8x8([a.0, b.0, c.0, d.0, e.0, f.0, g.0, h.0]) };
        for k in 0..8 {
            if let Some(record) = records.get_mut(k) {
                unsafe { T::store_avx512(rows[k], &mut record[first..first + 8]) };
            }
        }
    }
    #[inline(always)]
    fn compress_values(self, mask: u32, out: &mut [f64]) {
        let out = &mut out[..8];
        unsafe { _mm512_storeu_pd(out.as_mut_ptr(), _mm512_maskz_compress_pd(mask as u8, self.0)) }
    }
}
