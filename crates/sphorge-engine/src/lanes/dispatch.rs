//! Choice of instructions at run time.

use super::{Lanes, PairScalar};

/// Name of the variable of the environment that limits the instructions: `scalar`, or `avx2` on an x86 processor.
const LIMIT: &str = "SPHORGE_INSTRUCTIONS";

/// Instructions pair sweeps are compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Instructions {
    /// One number at a time; runs everywhere.
    Scalar,
    /// 256-bit registers with fused multiply–add.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// 512-bit registers.
    #[cfg(target_arch = "x86_64")]
    Avx512,
    /// 128-bit registers of 64-bit ARM processors.
    #[cfg(target_arch = "aarch64")]
    Neon,
}

impl Instructions {
    /// All this processor has, slowest first.
    pub(crate) fn available() -> impl Iterator<Item = Self> {
        let mut all = [Some(Self::Scalar), None, None];
        #[cfg(target_arch = "x86_64")]
        {
            let avx2 = is_x86_feature_detected!("avx2")
                && is_x86_feature_detected!("fma")
                && is_x86_feature_detected!("popcnt")
                && is_x86_feature_detected!("bmi1")
                && is_x86_feature_detected!("bmi2");
            all[1] = avx2.then_some(Self::Avx2);
            let avx512 = is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512bw");
            all[2] = (avx2 && avx512).then_some(Self::Avx512);
        }
        #[cfg(target_arch = "aarch64")]
        {
            all[1] = std::arch::is_aarch64_feature_detected!("neon").then_some(Self::Neon);
        }
        all.into_iter().flatten()
    }

    /// The fastest this processor has, or no faster than what the variable of the environment [`LIMIT`] names: results of every
    /// instruction set differ in their last bits, and the check of this takes them one after the other.
    pub(crate) fn best() -> Self {
        let most = std::env::var(LIMIT).unwrap_or_default();
        Self::available().take_while(|own| own.is_within(&most)).last().unwrap_or(Self::Scalar)
    }

    /// Whether it is no faster than the instruction set of a name; one that no set has limits nothing.
    fn is_within(self, most: &str) -> bool {
        match most {
            "scalar" => self == Self::Scalar,
            #[cfg(target_arch = "x86_64")]
            "avx2" => self != Self::Avx512,
            _ => true,
        }
    }
}

/// Work written over a SIMD vector type.
pub(crate) trait Job<T: PairScalar> {
    /// Does the work on SIMD vectors `L`. Implementations must be `#[inline(always)]`, and so must everything they call in their
    /// hot part (no closures handed to library functions): only what is inlined is compiled for the instructions chosen.
    fn run<L: Lanes<Element = T>>(self);
}

/// Runs a job on the SIMD vectors of an instruction set, which must come from [`Instructions::available`].
#[inline]
pub(crate) fn run<T: PairScalar, J: Job<T>>(instructions: Instructions, job: J) {
    match instructions {
        Instructions::Scalar => job.run::<T>(),
        // SAFETY: `available` lists an instruction set only after detecting it.
        #[cfg(target_arch = "x86_64")]
        Instructions::Avx2 => unsafe { run_avx2(job) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        Instructions::Avx512 => unsafe { run_avx512(job) },
        // Part of what the compiler assumes of the architecture: needs no function of its own.
        #[cfg(target_arch = "aarch64")]
        Instructions::Neon => job.run::<T::Neon>(),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,popcnt,bmi1,bmi2")]
fn run_avx2<T: PairScalar, J: Job<T>>(job: J) {
    job.run::<T::Avx2>();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,popcnt,bmi1,bmi2,avx512f,avx512vl,avx512dq,avx512bw")]
fn run_avx512<T: PairScalar, J: Job<T>>(job: J) {
    job.run::<T::Avx512>();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fastest_within_a_limit_is_not_beyond_it() {
        let fastest = |most: &str| Instructions::available().take_while(|own| own.is_within(most)).last();
        assert_eq!(fastest("scalar"), Some(Instructions::Scalar));
        for none in ["", "avx512", "none that is"] {
            assert_eq!(fastest(none), Instructions::available().last(), "{none}");
        }
        #[cfg(target_arch = "x86_64")]
        assert_eq!(fastest("avx2"), Instructions::available().take(2).last());
    }
}
