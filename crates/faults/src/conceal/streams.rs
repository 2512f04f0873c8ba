//! Random streams of a case, one per purpose, so that changes in one do not affect the others.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// The purpose of a random stream.
#[derive(Clone, Copy)]
pub(super) enum Stream {
    Motion,
    Friction,
    Sensors,
    Noise,
    Effects,
    RealLife,
    Urdf,
}

/// The random stream of the noise in recordings that are made later.
pub(crate) const RECORD_AGAIN: u64 = 8;

/// The stream of a case with this `seed`.
pub(super) fn random(seed: u64, stream: Stream) -> ChaCha8Rng {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(stream as u64);
    random
}
