//! SIMD vectors in the 128-bit registers every 64-bit ARM processor has.
#![expect(clippy::undocumented_unsafe_blocks, reason = "one comment says why all of them are sound")]

use super::elementary::{Doubles, elementary_of_doubles, elementary_of_singles, halves};
use super::{Lanes, each_lane, gather_entries};
use sphorge_physics::Real;
use std::arch::aarch64::*;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// Four single-precision numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct F32x4(float32x4_t);

/// Two double-precision numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct F64x2(float64x2_t);

// SAFETY of every `unsafe` below: NEON belongs to what the compiler assumes of this architecture; loads and stores stay within
// slices and tables whose length is checked by indexing or known.

/// The estimate of the processor, 8 bits, and two Newton steps: within 2⁻²² of the inverse root of any normal number. The step
/// takes the product of zero and infinity for zero, so that zero gives infinity and infinity zero.
#[inline(always)]
fn newton_inverse_sqrt(x: F32x4) -> F32x4 {
    let step = |e: F32x4| e * F32x4(unsafe { vrsqrtsq_f32(x.0, (e * e).0) });
    step(step(F32x4(unsafe { vrsqrteq_f32(x.0) })))
}

macro_rules! arithmetic {
    ($vector:ident, $element:ty, $dup:ident, $add:ident, $sub:ident, $mul:ident, $div:ident, $neg:ident, $fma:ident,
     $sqrt:ident, $min:ident, $max:ident, $abs:ident, $less:ident, $select:ident, $inverse_sqrt:expr) => {
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
                Self(unsafe { $neg(self.0) })
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
                Self(unsafe { $dup(value as $element) })
            }
            #[inline(always)]
            fn mul_add(self, a: Self, b: Self) -> Self {
                Self(unsafe { $fma(b.0, self.0, a.0) })
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
                Self(unsafe { $select($less(a.0, b.0), then.0, otherwise.0) })
            }
            #[inline(always)]
            fn lane_by_lane(a: Self, b: Self, f: impl Fn(f64, f64) -> [f64; 2]) -> [Self; 2] {
                each_lane(a, b, f)
            }
        }
    };
}

// Minimum and maximum of two are those of IEEE 754-2008, as for single numbers: of a number and a NaN, the number.
arithmetic!(
    F32x4,
    f32,
    vdupq_n_f32,
    vaddq_f32,
    vsubq_f32,
    vmulq_f32,
    vdivq_f32,
    vnegq_f32,
    vfmaq_f32,
    vsqrtq_f32,
    vminnmq_f32,
    vmaxnmq_f32,
    vabsq_f32,
    vcltq_f32,
    vbslq_f32,
    newton_inverse_sqrt
);
arithmetic!(
    F64x2,
    f64,
    vdupq_n_f64,
    vaddq_f64,
    vsubq_f64,
    vmulq_f64,
    vdivq_f64,
    vnegq_f64,
    vfmaq_f64,
    vsqrtq_f64,
    vminnmq_f64,
    vmaxnmq_f64,
    vabsq_f64,
    vcltq_f64,
    vbslq_f64,
    |x: Self| Self::one() / x.sqrt()
);

/// Bit k set where lane k is.
#[inline(always)]
fn bits(lanes: uint32x4_t) -> u32 {
    const BIT: [u32; 4] = [1, 2, 4, 8];
    unsafe { vaddvq_u32(vandq_u32(lanes, vld1q_u32(BIT.as_ptr()))) }
}

/// For every mask of four lanes, the bytes of those lanes one behind the other; zeros behind them.
static PACKED: [[u8; 16]; 16] = {
    // An index past the register reads as zero.
    let mut table = [[u8::MAX; 16]; 16];
    let mut mask = 0;
    while mask < 16 {
        let (mut byte, mut to) = (0, 0);
        while byte < 16 {
            if mask >> (byte / 4) & 1 == 1 {
                table[mask][to] = byte as u8;
                to += 1;
            }
            byte += 1;
        }
        mask += 1;
    }
    table
};

/// The lanes whose bit in `mask` is set one behind the other.
#[inline(always)]
fn pack(mask: u32, lanes: uint32x4_t) -> uint32x4_t {
    let order = &PACKED[(mask & 15) as usize];
    unsafe { vreinterpretq_u32_u8(vqtbl1q_u8(vreinterpretq_u8_u32(lanes), vld1q_u8(order.as_ptr()))) }
}

elementary_of_singles!(F32x4);
elementary_of_doubles!(F64x2);

/// The bits of `2^52`: with a small whole number in their last places they are those of the sum.
const TWO_TO_52: u64 = 0x4330_0000_0000_0000;

impl Doubles for F64x2 {
    #[inline(always)]
    fn mantissa_and_exponent(self) -> [Self; 2] {
        unsafe {
            let bits = vreinterpretq_u64_f64(self.0);
            let biased = vorrq_u64(vshrq_n_u64::<52>(bits), vdupq_n_u64(TWO_TO_52));
            let exponent = Self(vreinterpretq_f64_u64(biased)) - Self::of(4_503_599_627_370_496.0 + 1023.0);
            let digits = vandq_u64(bits, vdupq_n_u64(0x000f_ffff_ffff_ffff));
            let mantissa = vorrq_u64(digits, vdupq_n_u64(0x3ff0_0000_0000_0000));
            [Self(vreinterpretq_f64_u64(mantissa)), exponent]
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
fn power_of_two(exponent: F64x2) -> F64x2 {
    let biased = exponent + F64x2::of(4_503_599_627_370_496.0 + 1023.0);
    F64x2(unsafe { vreinterpretq_f64_u64(vshlq_n_u64::<52>(vreinterpretq_u64_f64(biased.0))) })
}

impl Lanes for F32x4 {
    type Element = f32;
    const WIDTH: usize = 4;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self(unsafe { vdupq_n_f32(value) })
    }
    #[inline(always)]
    fn load(values: &[f32]) -> Self {
        let values = &values[..4];
        Self(unsafe { vld1q_f32(values.as_ptr()) })
    }
    #[inline(always)]
    fn gather_part<const F: usize, const N: usize>(records: &[[f32; F]], indices: &[u32], first: usize) -> [Self; N] {
        if N < 4 {
            return gather_entries::<Self, F, N, 4>(records, indices, first);
        }
        let indices = &indices[..4];
        let rows = [0, 1, 2, 3].map(|k| &records[indices[k] as usize]);
        let mut lanes = [Self::zero(); N];
        for part in (0..N).step_by(4) {
            // The last part overlaps the one before it where `N` is no multiple of the width.
            let part = part.min(N - 4);
            let [r0, r1, r2, r3] = rows.map(|row| Self::load(&row[first + part..first + part + 4]).0);
            unsafe {
                let (even_low, even_high) = (vzip1q_f32(r0, r2), vzip2q_f32(r0, r2));
                let (odd_low, odd_high) = (vzip1q_f32(r1, r3), vzip2q_f32(r1, r3));
                lanes[part] = Self(vzip1q_f32(even_low, odd_low));
                lanes[part + 1] = Self(vzip2q_f32(even_low, odd_low));
                lanes[part + 2] = Self(vzip1q_f32(even_high, odd_high));
                lanes[part + 3] = Self(vzip2q_f32(even_high, odd_high));
            }
        }
        lanes
    }
    #[inline(always)]
    fn coordinate_difference(a: Self, b: Self) -> Self {
        Self(unsafe { vcvtq_f32_s32(vsubq_s32(vreinterpretq_s32_f32(a.0), vreinterpretq_s32_f32(b.0))) })
    }
    #[inline(always)]
    fn sum(self) -> f32 {
        // Pair by pair, not by the sum over a register: that one leaves the order open.
        unsafe {
            let pairs = vpaddq_f32(self.0, self.0);
            vgetq_lane_f32::<0>(vpaddq_f32(pairs, pairs))
        }
    }
    #[inline(always)]
    fn largest(self) -> f32 {
        unsafe { vmaxnmvq_f32(self.0) }
    }
    #[inline(always)]
    fn less(a: Self, b: Self) -> u32 {
        bits(unsafe { vcltq_f32(a.0, b.0) })
    }
    #[inline(always)]
    fn compress_others(mask: u32, indices: &[u32], own: u32, out: &mut [u32]) -> usize {
        let (indices, out) = (&indices[..4], &mut out[..4]);
        unsafe {
            let indices = vld1q_u32(indices.as_ptr());
            let mask = mask & !bits(vceqq_u32(indices, vdupq_n_u32(own)));
            vst1q_u32(out.as_mut_ptr(), pack(mask, indices));
            mask.count_ones() as usize
        }
    }
    #[inline(always)]
    fn compress_values(self, mask: u32, out: &mut [f32]) {
        let out = &mut out[..4];
        unsafe { vst1q_f32(out.as_mut_ptr(), vreinterpretq_f32_u32(pack(mask, vreinterpretq_u32_f32(self.0)))) };
    }
}

impl Lanes for F64x2 {
    type Element = f64;
    const WIDTH: usize = 2;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self(unsafe { vdupq_n_f64(value) })
    }
    #[inline(always)]
    fn load(values: &[f64]) -> Self {
        let values = &values[..2];
        Self(unsafe { vld1q_f64(values.as_ptr()) })
    }
    #[inline(always)]
    fn gather_part<const F: usize, const N: usize>(records: &[[f64; F]], indices: &[u32], first: usize) -> [Self; N] {
        if N < 2 {
            return gather_entries::<Self, F, N, 2>(records, indices, first);
        }
        let (a, b) = (&records[indices[0] as usize], &records[indices[1] as usize]);
        let mut lanes = [Self::zero(); N];
        for part in (0..N).step_by(2) {
            // The last part overlaps the one before it where `N` is odd.
            let part = part.min(N - 2);
            let [a, b] = [a, b].map(|row| Self::load(&row[first + part..first + part + 2]).0);
            lanes[part] = Self(unsafe { vzip1q_f64(a, b) });
            lanes[part + 1] = Self(unsafe { vzip2q_f64(a, b) });
        }
        lanes
    }
    #[inline(always)]
    fn coordinate_difference(a: Self, b: Self) -> Self {
        a - b
    }
    #[inline(always)]
    fn sum(self) -> f64 {
        unsafe { vpaddd_f64(self.0) }
    }
    #[inline(always)]
    fn largest(self) -> f64 {
        unsafe { vmaxnmvq_f64(self.0) }
    }
    #[inline(always)]
    fn less(a: Self, b: Self) -> u32 {
        unsafe {
            let less = vcltq_f64(a.0, b.0);
            (vgetq_lane_u64::<0>(less) & 1 | vgetq_lane_u64::<1>(less) & 2) as u32
        }
    }
    #[inline(always)]
    fn compress_others(mask: u32, indices: &[u32], own: u32, out: &mut [u32]) -> usize {
        let [a, b] = [indices[0], indices[1]];
        let (first, second) = (mask & 1 != 0 && a != own, mask & 2 != 0 && b != own);
        let out = &mut out[..2];
        out[0] = a;
        out[usize::from(first)] = b;
        usize::from(first) + usize::from(second)
    }
    #[inline(always)]
    fn compress_values(self, mask: u32, out: &mut [f64]) {
        let out = &mut out[..2];
        out[0] = unsafe { vgetq_lane_f64::<0>(self.0) };
        out[(mask & 1) as usize] = unsafe { vgetq_lane_f64::<1>(self.0) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_root_is_good_to_a_few_units_of_round_off() {
        // Two binades hold every mantissa and parity of the exponent.
        let check = |bits: u32| {
            let x = f32::from_bits(bits);
            let got = F32x4::splat(x).inverse_sqrt().largest();
            let want = 1.0 / f64::from(x).sqrt();
            let error = (f64::from(got) / want - 1.0).abs();
            assert!(error < (-22f64).exp2(), "{x:e}: {got:e}, relative error {error:e}");
        };
        (1f32.to_bits()..4f32.to_bits()).step_by(97).for_each(check);
        [f32::MIN_POSITIVE, 1e-30, 1e-12, 1e12, 1e30, 8e37, f32::MAX].into_iter().map(f32::to_bits).for_each(check);
        assert_eq!(F32x4::splat(0.0).inverse_sqrt().sum(), f32::INFINITY);
        assert_eq!(F32x4::splat(f32::INFINITY).inverse_sqrt().sum(), 0.0);
    }
}
