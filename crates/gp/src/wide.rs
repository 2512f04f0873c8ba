//! Loops compiled for the processor's widest vectors, chosen when the program runs.

use std::sync::OnceLock;

use fearless_simd::{Level, Simd};

/// A computation whose loops run over a block of numbers at a time. Every number has the same operations in every width, so that
/// the results of processors with fused multiply-add are the same bits.
pub trait Wide {
    /// What it computes.
    type Output;

    /// With fused multiply-add, or without.
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

/// Leaves the processor's vector registers as code for short vectors expects them; to be called after faer's products and
/// factorisations.
///
/// Their kernels leave the upper halves of the registers in use (private-gemm-x86 0.1 has no `vzeroupper`). On Intel's processors,
/// everything that is compiled for SSE then takes several times as long: a sine 180 ns instead of 8. What runs here uses long
/// vectors, too, and the compiler ends it properly.
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
