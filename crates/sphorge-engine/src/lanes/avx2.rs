//! SIMD vectors in 256-bit registers with fused multiply–add.
#![expect(clippy::undocumented_unsafe_blocks, reason = "one comment says why all of them are sound")]

use super::elementary::{Doubles, elementary_of_doubles, elementary_of_singles, halves};
use super::{Lanes, compress_each, each_lane, gather_entries};
use sphorge_physics::Real;
use std::arch::x86_64::*;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// Eight single-precision numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct F32x8(pub(super) __m256);

/// Four double-precision numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct F64x4(pub(super) __m256d);

// SAFETY of every `unsafe` below: SIMD vectors exist only inside jobs started after the processor has been found to have AVX2 and
// FMA (see `Lanes`); loads and stores stay within slices whose length is asserted or checked by indexing.

macro_rules! arithmetic {
    ($vector:ident, $element:ty, $set1:ident, $add:ident, $sub:ident, $mul:ident, $div:ident, $fmadd:ident, $sqrt:ident,
     $min:ident, $max:ident, $andnot:ident, $cmp:ident, $blend:ident, $movemask:ident) => {
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
            fn min(self, other: Self) -> Self {
                Self(unsafe { $min(self.0, other.0) })
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                Self(unsafe { $max(self.0, other.0) })
            }
            #[inline(always)]
            fn abs(self) -> Self {
                Self(unsafe { $andnot($set1(-0.0), self.0) })
            }
            #[inline(always)]
            fn select_lt(a: Self, b: Self, then: Self, otherwise: Self) -> Self {
                Self(unsafe { $blend(otherwise.0, then.0, $cmp::<_CMP_LT_OQ>(a.0, b.0)) })
            }
            #[inline(always)]
            fn lane_by_lane(a: Self, b: Self, f: impl Fn(f64, f64) -> [f64; 2]) -> [Self; 2] {
                each_lane(a, b, f)
            }
        }
        impl $vector {
            #[inline(always)]
            fn less_mask(a: Self, b: Self) -> u32 {
                (unsafe { $movemask($cmp::<_CMP_LT_OQ>(a.0, b.0)) }) as u32
            }
        }
    };
}

arithmetic!(
    F32x8,
    f32,
    _mm256_set1_ps,
    _mm256_add_ps,
    _mm256_sub_ps,
    _mm256_mul_ps,
    _mm256_div_ps,
    _mm256_fmadd_ps,
    _mm256_sqrt_ps,
    _mm256_min_ps,
    _mm256_max_ps,
    _mm256_andnot_ps,
    _mm256_cmp_ps,
    _mm256_blendv_ps,
    _mm256_movemask_ps
);
arithmetic!(
    F64x4,
    f64,
    _mm256_set1_pd,
    _mm256_add_pd,
    _mm256_sub_pd,
    _mm256_mul_pd,
    _mm256_div_pd,
    _mm256_fmadd_pd,
    _mm256_sqrt_pd,
    _mm256_min_pd,
    _mm256_max_pd,
    _mm256_andnot_pd,
    _mm256_cmp_pd,
    _mm256_blendv_pd,
    _mm256_movemask_pd
);

elementary_of_singles!(F32x8);
elementary_of_doubles!(F64x4);

/// The bits of `2^52`: with a small whole number in their last places they are those of the sum.
const TWO_TO_52: i64 = 0x4330_0000_0000_0000;

impl Doubles for F64x4 {
    #[inline(always)]
    fn mantissa_and_exponent(self) -> [Self; 2] {
        unsafe {
            let bits = _mm256_castpd_si256(self.0);
            let biased = _mm256_or_si256(_mm256_srli_epi64::<52>(bits), _mm256_set1_epi64x(TWO_TO_52));
            let exponent = Self(_mm256_castsi256_pd(biased)) - Self::of(4_503_599_627_370_496.0 + 1023.0);
            let digits = _mm256_and_si256(bits, _mm256_set1_epi64x(0x000f_ffff_ffff_ffff));
            let mantissa = _mm256_or_si256(digits, _mm256_set1_epi64x(0x3ff0_0000_0000_0000));
            [Self(_mm256_castsi256_pd(mantissa)), exponent]
        }
    }
    #[inline(always)]
    fn times_power_of_two(self, exponent: Self) -> Self {
        let [first, second] = halves(exponent);
        self * power_of_two(first) * power_of_two(second)
    }
}

/// `2^exponent` for whole exponents from -1022 to 1023.
#[inline(always)]
fn power_of_two(exponent: F64x4) -> F64x4 {
    let biased = exponent + F64x4::of(4_503_599_627_370_496.0 + 1023.0);
    F64x4(unsafe { _mm256_castsi256_pd(_mm256_slli_epi64::<52>(_mm256_castpd_si256(biased.0))) })
}

/// Transposes eight rows of eight singles.
#[inline(always)]
unsafe fn transpose_8x8(r: [__m256; 8]) -> [__m256; 8] {
    unsafe {
        let t0 = _mm256_unpacklo_ps(r[0], r[1]);
        let t1 = _mm256_unpackhi_ps(r[0], r[1]);
        let t2 = _mm256_unpacklo_ps(r[2], r[3]);
        let t3 = _mm256_unpackhi_ps(r[2], r[3]);
        let t4 = _mm256_unpacklo_ps(r[4], r[5]);
        let t5 = _mm256_unpackhi_ps(r[4], r[5]);
        let t6 = _mm256_unpacklo_ps(r[6], r[7]);
        let t7 = _mm256_unpackhi_ps(r[6], r[7]);
        let u0 = _mm256_shuffle_ps::<0x44>(t0, t2);
        let u1 = _mm256_shuffle_ps::<0xEE>(t0, t2);
        let u2 = _mm256_shuffle_ps::<0x44>(t1, t3);
        let u3 = _mm256_shuffle_ps::<0xEE>(t1, t3);
        let u4 = _mm256_shuffle_ps::<0x44>(t4, t6);
        let u5 = _mm256_shuffle_ps::<0xEE>(t4, t6);
        let u6 = _mm256_shuffle_ps::<0x44>(t5, t7);
        let u7 = _mm256_shuffle_ps::<0xEE>(t5, t7);
        [
            _mm256_permute2f128_ps::<0x20>(u0, u4),
            _mm256_permute2f128_ps::<0x20>(u1, u5),
            _mm256_permute2f128_ps::<0x20>(u2, u6),
            _mm256_permute2f128_ps::<0x20>(u3, u7),
            _mm256_permute2f128_ps::<0x31>(u0, u4),
            _mm256_permute2f128_ps::<0x31>(u1, u5),
            _mm256_permute2f128_ps::<0x31>(u2, u6),
            _mm256_permute2f128_ps::<0x31>(u3, u7),
        ]
    }
}

/// The sums of SIMD vectors, some at a time; a single one left over alone. No function that takes another: closures are not compiled
/// for the instructions in use.
macro_rules! sums_in_parts {
    ($vectors:ident, $n:ident, $at_a_time:literal, $sums_of:ident) => {{
        let mut sums = [0.0; $n];
        let mut part = 0;
        while part < $n {
            let count = $at_a_time.min($n - part);
            if count == 1 {
                sums[part] = $vectors[part].sum();
                break;
            }
            let mut some = [Self::zero(); $at_a_time];
            some[..count].copy_from_slice(&$vectors[part..part + count]);
            // SAFETY: a SIMD vector exists, so that the processor has the instructions.
            let of_some = unsafe { $sums_of(&some) };
            sums[part..part + count].copy_from_slice(&of_some[..count]);
            part += $at_a_time;
        }
        sums
    }};
}

/// The sums over the lanes of eight SIMD vectors.
#[inline(always)]
unsafe fn sums_of_8(r: &[F32x8; 8]) -> [f32; 8] {
    unsafe {
        let mut pairs = [_mm256_setzero_ps(); 4];
        for k in 0..4 {
            let (a, b) = (r[2 * k].0, r[2 * k + 1].0);
            // a0+a2, b0+b2, a1+a3, b1+b3, in both halves.
            pairs[k] = _mm256_add_ps(_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b));
        }
        let mut quads = [_mm256_setzero_ps(); 2];
        for k in 0..2 {
            let (a, b) = (pairs[2 * k], pairs[2 * k + 1]);
            quads[k] = _mm256_add_ps(_mm256_shuffle_ps::<0x44>(a, b), _mm256_shuffle_ps::<0xEE>(a, b));
        }
        let [a, b] = quads;
        let all = _mm256_add_ps(_mm256_permute2f128_ps::<0x20>(a, b), _mm256_permute2f128_ps::<0x31>(a, b));
        let mut sums = [0.0; 8];
        _mm256_storeu_ps(sums.as_mut_ptr(), all);
        sums
    }
}

impl Lanes for F32x8 {
    type Element = f32;
    const WIDTH: usize = 8;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self(unsafe { _mm256_set1_ps(value) })
    }
    #[inline(always)]
    fn load(values: &[f32]) -> Self {
        let values = &values[..8];
        Self(unsafe { _mm256_loadu_ps(values.as_ptr()) })
    }
    #[inline(always)]
    fn gather_part<const F: usize, const N: usize>(records: &[[f32; F]], indices: &[u32], first: usize) -> [Self; N] {
        if !N.is_multiple_of(8) {
            return gather_entries::<Self, F, N, 8>(records, indices, first);
        }
        let indices = &indices[..8];
        let mut lanes = [Self::zero(); N];
        for part in (0..N).step_by(8) {
            let mut rows = unsafe { [_mm256_setzero_ps(); 8] };
            for k in 0..8 {
                let row = &records[indices[k] as usize][first + part..first + part + 8];
                rows[k] = unsafe { _mm256_loadu_ps(row.as_ptr()) };
            }
            let columns = unsafe { transpose_8x8(rows) };
            for c in 0..8 {
                lanes[part + c] = Self(columns[c]);
            }
        }
        lanes
    }
    #[inline(always)]
    fn coordinate_difference(a: Self, b: Self) -> Self {
        let d = unsafe { _mm256_sub_epi32(_mm256_castps_si256(a.0), _mm256_castps_si256(b.0)) };
        Self(unsafe { _mm256_cvtepi32_ps(d) })
    }
    #[inline(always)]
    fn sum(self) -> f32 {
        unsafe {
            let s = _mm_add_ps(_mm256_castps256_ps128(self.0), _mm256_extractf128_ps::<1>(self.0));
            let s = _mm_add_ps(s, _mm_movehl_ps(s, s));
            _mm_cvtss_f32(_mm_add_ss(s, _mm_movehdup_ps(s)))
        }
    }
    #[inline(always)]
    fn sums<const N: usize>(vectors: [Self; N]) -> [f32; N] {
        sums_in_parts!(vectors, N, 8usize, sums_of_8)
    }
    #[inline(always)]
    fn largest(self) -> f32 {
        unsafe {
            let s = _mm_max_ps(_mm256_castps256_ps128(self.0), _mm256_extractf128_ps::<1>(self.0));
            let s = _mm_max_ps(s, _mm_movehl_ps(s, s));
            _mm_cvtss_f32(_mm_max_ss(s, _mm_movehdup_ps(s)))
        }
    }
    #[inline(always)]
    fn less(a: Self, b: Self) -> u32 {
        Self::less_mask(a, b)
    }
    #[inline(always)]
    fn compress_others(mask: u32, indices: &[u32], own: u32, out: &mut [u32]) -> usize {
        compress_each(mask, &indices[..8], Some(own), out)
    }
    #[inline(always)]
    fn compress_values(self, mask: u32, out: &mut [f32]) {
        let mut values = [0.0; 8];
        unsafe { _mm256_storeu_ps(values.as_mut_ptr(), self.0) };
        compress_each(mask, &values, None, out);
    }
}

/// The sums over the lanes of four SIMD vectors.
#[inline(always)]
unsafe fn sums_of_4(r: &[F64x4; 4]) -> [f64; 4] {
    unsafe {
        let [a, b, c, d] = [r[0].0, r[1].0, r[2].0, r[3].0];
        // a0+a1, b0+b1, a2+a3, b2+b3.
        let ab = _mm256_add_pd(_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
        let cd = _mm256_add_pd(_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
        let all = _mm256_add_pd(_mm256_permute2f128_pd::<0x20>(ab, cd), _mm256_permute2f128_pd::<0x31>(ab, cd));
        let mut sums = [0.0; 4];
        _mm256_storeu_pd(sums.as_mut_ptr(), all);
        sums
    }
}

impl Lanes for F64x4 {
    type Element = f64;
    const WIDTH: usize = 4;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self(unsafe { _mm256_set1_pd(value) })
    }
    #[inline(always)]
    fn load(values: &[f64]) -> Self {
        let values = &values[..4];
        Self(unsafe { _mm256_loadu_pd(values.as_ptr()) })
    }
    #[inline(always)]
    fn gather_part<const F: usize, const N: usize>(records: &[[f64; F]], indices: &[u32], first: usize) -> [Self; N] {
        if !N.is_multiple_of(4) {
            return gather_entries::<Self, F, N, 4>(records, indices, first);
        }
        let indices = &indices[..4];
        let mut lanes = [Self::zero(); N];
        for part in (0..N).step_by(4) {
            let mut rows = unsafe { [_mm256_setzero_pd(); 4] };
            for k in 0..4 {
                let row = &records[indices[k] as usize][first + part..first + part + 4];
                rows[k] = unsafe { _mm256_loadu_pd(row.as_ptr()) };
            }
            unsafe {
                let t0 = _mm256_unpacklo_pd(rows[0], rows[1]);
                let t1 = _mm256_unpackhi_pd(rows[0], rows[1]);
                let t2 = _mm256_unpacklo_pd(rows[2], rows[3]);
                let t3 = _mm256_unpackhi_pd(rows[2], rows[3]);
                lanes[part] = Self(_mm256_permute2f128_pd::<0x20>(t0, t2));
                lanes[part + 1] = Self(_mm256_permute2f128_pd::<0x20>(t1, t3));
                lanes[part + 2] = Self(_mm256_permute2f128_pd::<0x31>(t0, t2));
                lanes[part + 3] = Self(_mm256_permute2f128_pd::<0x31>(t1, t3));
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
        unsafe {
            let s = _mm_add_pd(_mm256_castpd256_pd128(self.0), _mm256_extractf128_pd::<1>(self.0));
            _mm_cvtsd_f64(_mm_add_sd(s, _mm_unpackhi_pd(s, s)))
        }
    }
    #[inline(always)]
    fn sums<const N: usize>(vectors: [Self; N]) -> [f64; N] {
        sums_in_parts!(vectors, N, 4usize, sums_of_4)
    }
    #[inline(always)]
    fn largest(self) -> f64 {
        unsafe {
            let s = _mm_max_pd(_mm256_castpd256_pd128(self.0), _mm256_extractf128_pd::<1>(self.0));
            _mm_cvtsd_f64(_mm_max_sd(s, _mm_unpackhi_pd(s, s)))
        }
    }
    #[inline(always)]
    fn less(a: Self, b: Self) -> u32 {
        Self::less_mask(a, b)
    }
    #[inline(always)]
    fn compress_others(mask: u32, indices: &[u32], own: u32, out: &mut [u32]) -> usize {
        compress_each(mask, &indices[..4], Some(own), out)
    }
    #[inline(always)]
    fn store(self, out: &mut [f64]) {
        let out = &mut out[..4];
        unsafe { _mm256_storeu_pd(out.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    fn compress_values(self, mask: u32, out: &mut [f64]) {
        let mut values = [0.0; 4];
        unsafe { _mm256_storeu_pd(values.as_mut_ptr(), self.0) };
        compress_each(mask, &values, None, out);
    }
}
