//! A number that is computed when it is first needed.

use std::sync::atomic::{AtomicU64, Ordering};

/// Marks a number that is not formed yet: the bits of a NaN.
const NOT_FORMED: u64 = u64::MAX;

/// A number that threads share, and that has the same bits whichever of them forms it.
#[derive(Debug)]
pub struct Lazy(AtomicU64);

impl Default for Lazy {
    fn default() -> Self {
        Self(AtomicU64::new(NOT_FORMED))
    }
}

impl Lazy {
    /// The number, if it is formed.
    pub fn get(&self) -> Option<f64> {
        let bits = self.0.load(Ordering::Relaxed);
        (bits != NOT_FORMED).then(|| f64::from_bits(bits))
    }

    /// Stores the number.
    pub fn set(&self, value: f64) {
        self.0.store(value.to_bits(), Ordering::Relaxed);
    }

    /// The number, which `form` computes if it is not formed yet.
    pub fn get_or(&self, form: impl FnOnce() -> f64) -> f64 {
        self.get().unwrap_or_else(|| {
            let value = form();
            self.set(value);
            value
        })
    }
}
