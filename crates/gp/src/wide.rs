//! Loops compiled for the processor's widest vectors, chosen when the program runs.

use std::sync::OnceLock;

use fearless_simd::{Level, Simd};

/// A computation whose loops process a block of numbers at a time. Every number has the same operations in every
/// vector width, so that the results of all processors with fused multiply-add have the same bits.
pub trait Wide {
    /// The result.
    type Output;

    /// Runs the computation with or without fused multiply-add.
    fn run<const FUSED: bool>(self) -> Self::Output;
}

/// Runs `task` with the widest vectors that the processor has.
pub fn on_widest<W: Wide>(task: W) -> W::Output {
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

/// Resets the processor's vector registers to the state that code for short vectors expects; to be called after
/// products and factorisations of faer.
///
/// Their kernels leave the upper halves of the registers in use (private-gemm-x86 0.1 lacks `vzeroupper`). On Intel's
/// processors, all code compiled for SSE is then several times slower: a sine takes 180 ns instead of 8 ns. This
/// function uses long vectors as well, and the compiler ends it with the missing instruction.
pub fn release_vectors() {
    on_widest(Release);
}

struct Release;

impl Wide for Release {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let values = std::hint::black_box([1.0_f64; 8]);
        std::hint::black_box(values.map(|value| value + 1.0));
    }
}
