//! Prefetching of memory.

/// Prefetches the memory behind these values, of the same length: the next block of a column. A pass that reads and
/// writes some twenty columns at a time is more than the hardware prefetcher can follow.
#[inline(always)]
pub(super) fn prefetch_behind<V>(values: &[V]) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T1, _mm_prefetch};
        const LINE: usize = 64;
        let behind = values.as_ptr_range().end.cast::<i8>();
        for line in (0..size_of_val(values)).step_by(LINE) {
            // SAFETY: a hint, which may name any address; part of every processor of this kind.
            unsafe { _mm_prefetch::<_MM_HINT_T1>(behind.wrapping_add(line)) };
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = values;
}
