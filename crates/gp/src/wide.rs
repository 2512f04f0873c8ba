//! Loops compiled for the processor's widest vectors, chosen when the program runs.

use std::sync::OnceLock;

use fearless_simd::{Level, Simd};

/// A computation whose loops run over a block of numbers at a time. Every number has the same operations in every width, so that
/// the results of processors with fused multiply-add are the same bits.
pub(crate) trait Wide {
    type Output;

    /// With fused multiply-add, or without.
    fn run<const FUSED: bool>(self) -> Self::Output;
}

/// Runs `task` with the widest vectors that the processor has.
pub(crate) fn on_widest<W: Wide>(task: W) -> W::Output {
    static LEVEL: OnceLock<Level> = OnceLock::new();
    match *LEVEL.get_or_init(Level::new) {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Level::Avx512(simd) => simd.vectorize(
            #[inline(always)]
            || task.run::<true>(),
        ),
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Level::Avx2(simd) => simd.vectorize(
            #[inline(always)]
            || task.run::<true>(),
        ),
        #[cfg(target_arch = "aarch64")]
        Level::Neon(simd) => simd.vectorize(
            #[inline(always)]
            || task.run::<true>(),
        ),
        _ => task.run::<false>(),
    }
}
