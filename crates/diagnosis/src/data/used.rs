//! The part of the recordings that is used: all of it, or of long recordings windows that are spread evenly over them.

use crate::data::motion::Input;

/// The total duration up to which all is used of training recordings, and of held-out recordings (s).
const MOST_SECONDS: f64 = 900.0;
/// The total duration that is used of longer ones (s). More would make the search slower and the intervals narrower than the
/// catalogue's formulae are true: their errors do not become fewer with more samples.
const LONG_SECONDS: f64 = 300.0;
/// The length of a window, if the recording allows (s).
pub const WINDOW: f64 = 20.0;

/// Of a long recording, and of all together, no more than about this needs to be held (s): windows that are spread evenly.
pub const WORTH_HOLDING: f64 = 1000.0;

/// Durations by role, of training and of held-out recordings.
#[derive(Debug)]
pub struct Used {
    /// That was recorded (s).
    recorded: [f64; 2],
    /// That is held (s).
    held: [f64; 2],
    /// The part of what is held that is used.
    share: [f64; 2],
}

impl Used {
    /// The part that is used of `inputs`.
    pub fn of(inputs: &[Input<'_>]) -> Self {
        let sum = |duration: fn(&Input<'_>) -> f64| {
            // An empty sum is −0, and a division by it gives −∞.
            [false, true].map(|role| {
                let of_role = inputs.iter().filter(|input| input.held_out == role);
                0.0 + of_role.map(duration).sum::<f64>()
            })
        };
        let recorded = sum(|input| input.recording.recorded());
        let held = sum(|input| input.recording.held());
        let most = recorded.map(|seconds| {
            if seconds > MOST_SECONDS {
                LONG_SECONDS
            } else {
                MOST_SECONDS
            }
        });
        Self {
            recorded,
            held,
            share: [0, 1].map(|role| (most[role] / held[role]).min(1.0)),
        }
    }

    /// The part of what is held of a role that is used.
    pub fn share(&self, held_out: bool) -> f64 {
        self.share[usize::from(held_out)]
    }

    /// The duration that is used of a role (s).
    fn seconds_of(&self, role: usize) -> f64 {
        self.share[role] * self.held[role]
    }

    /// The duration that is used in all (s).
    pub fn seconds(&self) -> f64 {
        [0, 1].map(|role| self.seconds_of(role)).iter().sum()
    }

    /// What is omitted, in sentences.
    pub fn remarks(&self) -> Vec<String> {
        let long = ["training", "held-out"].into_iter().enumerate();
        long.filter(|&(role, _)| self.recorded[role] > MOST_SECONDS)
            .map(|(role, what)| {
                format!(
                    "of the {:.0} s of {what} recordings, {:.0} s are used, in windows of at most {WINDOW:.0} s that are spread evenly",
                    self.recorded[role],
                    self.seconds_of(role)
                )
            })
            .collect()
    }
}
