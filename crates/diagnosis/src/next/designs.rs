//! The tried motions: sums of a few sines, within limits.

use std::f64::consts::TAU;

use torque::{Fade, Reference, Sine};

use super::limits::{Limits, rounded, taken};
use crate::thresholds::{SLOW_AND_FAST, TRIED_AMPLITUDES, TRIED_SPEEDS};

/// The duration of a motion (s).
pub const DURATION: f64 = 25.0;
/// The rate at which the proposed motion is checked against the limits (Hz).
pub const FINE: f64 = 500.0;
/// The duration of the fade-in from rest and of the fade-out to rest (s).
const FADE: f64 = 3.0;
/// The lowest and the highest frequency of a sine (Hz).
const FREQUENCIES: (f64, f64) = (0.08, 1.6);
/// The golden ratio. Frequencies and phases differ by the fractional parts of its multiples, so that no joints move alike.
const GOLDEN: f64 = 0.618_033_988_749_895;
/// The largest relative difference of frequencies.
const DETUNED: f64 = 0.17;
/// The part of the speed at which a slow sine moves.
const SLOW: f64 = 0.25;
/// The largest number of times that a motion beyond the limits is slowed down and scaled down.
const STEPS: usize = 12;
/// The rate at which limits are checked while designs are compared (Hz), and the factor by which a motion is slowed down then.
const COMPARED: (f64, f64) = (25.0, 0.85);
/// The rate at which limits are checked before a motion is proposed (Hz), and the factor by which it is slowed down then.
const PROPOSED: (f64, f64) = (FINE, 0.99);

/// The composition of a joint's motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mix {
    /// One sine: every cycle takes the whole range and all speeds up to the highest.
    Steady,
    /// Two sines of almost the same frequency: the amplitude rises and falls.
    Beats,
    /// Three sines of almost the same frequency, so that the motion is slow for longer.
    Swells,
    /// A large slow sine and a small fast one.
    SlowAndFast,
}

/// A design of a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    /// The composition of each joint's motion.
    pub mix: Mix,
    /// The part of a joint's allowed speed.
    pub speed: f64,
    /// The part of its allowed distance from the middle.
    pub amplitude: f64,
    /// The joints that move so; the others hold still or move slowly. All joints if empty.
    pub only: Vec<usize>,
    /// The parts of speed and room that the other joints use.
    pub others: f64,
}

/// The designs that move all joints.
pub fn all() -> Vec<Design> {
    let mut list = Vec::new();
    for mix in [Mix::Steady, Mix::Beats, Mix::Swells, Mix::SlowAndFast] {
        for speed in TRIED_SPEEDS {
            for amplitude in TRIED_AMPLITUDES {
                list.push(Design { mix, speed, amplitude, only: Vec::new(), others: 1.0 });
            }
        }
    }
    list
}

impl Design {
    /// The motion, slowed down and scaled down until it is within `limits` at a coarse rate, for comparison with others; and
    /// the parts of speed and room that it then uses. `None` if there is no such motion.
    pub fn within(&self, limits: &Limits) -> Option<(Reference, [f64; 2])> {
        self.shrunk(limits, [self.speed, self.amplitude], COMPARED)
    }

    /// The motion to be proposed, within `limits` at the finer rate, with at most the parts that [`Self::within`] returned.
    pub fn surely_within(&self, limits: &Limits, parts: [f64; 2]) -> Option<(Reference, [f64; 2])> {
        self.shrunk(limits, parts, PROPOSED)
    }

    fn shrunk(
        &self,
        limits: &Limits,
        [mut speed, mut amplitude]: [f64; 2],
        (hertz, step): (f64, f64),
    ) -> Option<(Reference, [f64; 2])> {
        for _ in 0..STEPS {
            let reference = self.reference(limits, speed, amplitude);
            let [far, fast, strong] = taken(&limits.needed(&reference, DURATION, hertz));
            if far <= 1.0 && fast <= 1.0 && strong <= 1.0 {
                return Some((reference, [speed, amplitude]));
            }
            speed *= step;
            if far > 1.0 || (strong > 1.0 && speed < 0.5 * self.speed) {
                // The torque for holding the arm does not decrease with the speed.
                amplitude *= step;
            }
        }
        None
    }

    fn reference(&self, limits: &Limits, speed: f64, amplitude: f64) -> Reference {
        let dof = limits.middle.len();
        let tones = match self.mix {
            Mix::Steady => 1,
            Mix::Beats | Mix::SlowAndFast => 2,
            Mix::Swells => 3,
        };
        let blank = || Sine { amplitude: vec![0.0; dof], frequency: vec![FREQUENCIES.0; dof], phase: vec![0.0; dof] };
        let mut sines: Vec<Sine> = (0..tones).map(|_| blank()).collect();
        for j in 0..dof {
            let part = if self.only.is_empty() || self.only.contains(&j) { 1.0 } else { self.others };
            let (room, fast) = (part * amplitude * limits.room[j], part * speed * limits.speed[j]);
            if room <= 0.0 || fast <= 0.0 {
                continue;
            }
            for (tone, sine) in sines.iter_mut().enumerate() {
                // The parts of the sines add up to the whole distance and the whole speed.
                let (room, fast) = match (self.mix, tone) {
                    (Mix::Steady, _) => (room, fast),
                    (Mix::Beats | Mix::Swells, 0) => (0.5 * room, 0.5 * fast),
                    (Mix::Beats, _) => (0.5 * room, 0.5 * (1.0 - DETUNED) * fast),
                    (Mix::Swells, 1) => (0.25 * room, 0.25 * (1.0 - DETUNED) * fast),
                    (Mix::Swells, _) => (0.25 * room, 0.25 * (1.0 - 2.0 * DETUNED) * fast),
                    (Mix::SlowAndFast, 0) => (SLOW_AND_FAST.0 * room, SLOW * fast),
                    (Mix::SlowAndFast, _) => (SLOW_AND_FAST.1 * room, (1.0 - SLOW) * fast),
                };
                let turn = (GOLDEN * (tones * j + tone + 1) as f64).fract();
                let wanted = fast / (TAU * room) * (1.0 - DETUNED * turn);
                let frequency = wanted.clamp(FREQUENCIES.0, FREQUENCIES.1);
                sine.frequency[j] = rounded(frequency);
                sine.amplitude[j] = rounded_down(room.min(fast / (TAU * sine.frequency[j])));
                sine.phase[j] = rounded(TAU * (GOLDEN * (dof * tone + j + 3) as f64).fract());
            }
        }
        Reference {
            centre: limits.middle.clone(),
            recorded: None,
            sines,
            fade: Some(Fade { seconds: FADE, end: DURATION }),
        }
    }
}

/// Rounds down to four decimals.
fn rounded_down(value: f64) -> f64 {
    (1e4 * value).floor() / 1e4
}
