//! A sinusoid in time.

use crate::laws::{is_same_wave, sine_and_cosine, wave};
use crate::{Law, Regressor, Spec, Term};

/// A sinusoid in time.
pub static PERIODIC: Spec = Spec {
    name: "periodic",
    may_be_in_one_recording: true,
    is_suggested: true,
    depends_on: Some(Regressor::Time),
    // None: the residuals suggest the frequency.
    forms: |_| Vec::new(),
    // Two sinusoids of nearly the same frequency are not distinguished.
    is_same: |a, b| is_same_wave(a, b, SAME_FREQUENCY),
    ..Spec::UNMODELLED
};

/// sin (form 0) or cos (form 1) of ω t; the size is ω (rad/s).
static WAVE: Law = Law {
    name: "wave",
    column: |term, _, motion| motion.map(|k| wave(term.sizes[0] * motion.time(k), term.form == 1)),
    nudges: &[|term, step| term.sized([term.sizes[0] * (1.0 + 0.01 * step)])],
    ..Law::PLAIN
};

/// The columns of a sinusoid of ω (rad/s) on a joint.
pub fn columns(joint: usize, omega: f64) -> Vec<Term> {
    sine_and_cosine(&WAVE, joint, omega)
}

/// The relative difference of frequencies below which two sinusoids are the same. Source: first diagnosis.
const SAME_FREQUENCY: f64 = 0.1;
