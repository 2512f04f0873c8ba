//! The part of the recordings that is used: all of it, or of long recordings windows that are spread evenly over them.

use std::ops::Range;

use recording::RegularRecording;

use crate::data::motion::Input;

/// The total duration up to which all is used of training recordings, and of held-out recordings (s).
const MOST_SECONDS: f64 = 900.0;
/// The total duration that is used of longer ones (s). More would make the search slower and the intervals narrower than the
/// catalogue's formulae are true: their errors do not become fewer with more samples.
const LONG_SECONDS: f64 = 240.0;
/// The length of a window, if the recording allows (s).
const WINDOW: f64 = 20.0;
/// The length below which a window gives little after the filters (s).
const SHORTEST: f64 = 2.0;
/// The longest chunk where all is used (s); longer ones are cut, so that memory is bounded.
const LONGEST: f64 = 60.0;

/// Of one recording, no more than this needs to be held (s): windows that are spread evenly, and half of it at least.
pub const WORTH_HOLDING: f64 = 1000.0;

/// Of all recordings of a role, which are `recorded` (s) long together, no more than this needs to be held (s).
pub fn worth_holding(recorded: f64) -> f64 {
    if recorded > MOST_SECONDS {
        2.0 * LONG_SECONDS
    } else {
        WORTH_HOLDING
    }
}

/// Durations by role, of training and of held-out recordings.
#[derive(Debug)]
pub struct Used {
    /// That was recorded (s).
    recorded: [f64; 2],
    /// The part of what is held that is to be used.
    share: [f64; 2],
    /// The duration that is used (s).
    used: [f64; 2],
}

/// A section of a recording, and how many of its ticks are used.
#[derive(Debug)]
pub struct Section {
    /// Its ticks.
    pub ticks: Range<usize>,
    /// The number that is used.
    pub used: usize,
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
        let mut used = Self {
            recorded,
            share: [0, 1].map(|role| (most[role] / held[role]).min(1.0)),
            used: held,
        };
        for role in [0, 1].into_iter().filter(|&role| used.share[role] < 1.0) {
            let of_role = inputs.iter().filter(|input| usize::from(input.held_out) == role);
            let seconds = of_role.map(|input| {
                let sections = used.sections(input);
                sections.iter().map(|section| section.used).sum::<usize>() as f64 * input.recording.period
            });
            used.used[role] = seconds.sum();
        }
        used
    }

    /// The sections of a recording, with a window in each.
    pub fn sections(&self, input: &Input<'_>) -> Vec<Section> {
        let share = self.share[usize::from(input.held_out)];
        let longest = if share < 1.0 { WINDOW / share } else { LONGEST };
        let RegularRecording { segments, period, .. } = input.recording;
        let most = ((longest / period) as usize).max(1);
        let least = (SHORTEST / period) as usize;
        let mut sections = Vec::new();
        for segment in segments {
            let pieces = segment.ticks.len().div_ceil(most).max(1);
            let length = segment.ticks.len().div_ceil(pieces);
            sections.extend((0..pieces).map(|piece| {
                let from = segment.ticks.start + piece * length;
                let to = (from + length).min(segment.ticks.end);
                let used = (share * (to - from) as f64).ceil() as usize;
                Section {
                    ticks: from..to,
                    used: used.max(least.min(to - from)),
                }
            }));
        }
        sections
    }

    /// The duration that is used in all (s).
    pub fn seconds(&self) -> f64 {
        self.used.iter().sum()
    }

    /// What is omitted, in sentences.
    pub fn remarks(&self) -> Vec<String> {
        let long = ["training", "held-out"].into_iter().enumerate();
        long.filter(|&(role, _)| self.recorded[role] > MOST_SECONDS)
            .map(|(role, what)| {
                format!(
                    "of the {:.0} s of {what} recordings, about {:.0} s are used, in windows of at most {WINDOW:.0} s that are spread evenly",
                    self.recorded[role],
                    self.used[role]
                )
            })
            .collect()
    }
}
