//! The part of the recordings that is used: all of short recordings, and evenly spread windows of long ones.

use std::ops::Range;

use recording::RegularRecording;

use crate::data::input::Input;
use crate::thresholds::{LONG_SECONDS, MOST_SECONDS, SHORT_BESIDE, SHORTEST_WINDOW, USED_WINDOW};
use crate::words::list;

/// The longest chunk where all is used (s); longer ones are cut, so that memory is bounded.
const LONGEST: f64 = 60.0;

/// The number of recordings that a sentence names.
const MOST_NAMED: usize = 4;

/// The time that is used of each recording of a role (s), which are `recorded` (s) long.
///
/// All recordings are used whole if they are not longer than 900 s together. Otherwise, short ones are still used whole if
/// they are not longer than 660 s together. Of the others, 240 s are used in equal parts, or all of a recording that is
/// shorter than its part. A recording that is used whole is also used whole if only the first few recordings are given.
pub fn worth_using(recorded: &[f64]) -> Vec<f64> {
    let mut worth = recorded.to_vec();
    if recorded.iter().sum::<f64>() <= MOST_SECONDS {
        return worth;
    }
    let mut order: Vec<usize> = (0..recorded.len()).collect();
    order.sort_by(|&a, &b| recorded[a].total_cmp(&recorded[b]));
    let (mut short, mut together) = (0, 0.0);
    for (count, pair) in (1..).zip(order.windows(2)) {
        let [last, next] = [pair[0], pair[1]].map(|at| recorded[at]);
        together += last;
        if together <= MOST_SECONDS - LONG_SECONDS && next >= SHORT_BESIDE * last {
            short = count;
        }
    }
    let mut left = LONG_SECONDS;
    for place in short..order.len() {
        let part = left / (order.len() - place) as f64;
        if recorded[order[place]] >= part {
            order[place..].iter().for_each(|&at| worth[at] = part);
            break;
        }
        left -= recorded[order[place]];
    }
    worth
}

/// The parts of the recordings that are used.
#[derive(Debug)]
pub struct Used {
    /// Durations by role, of training and of held-out recordings, that were recorded (s).
    recorded: [f64; 2],
    /// The duration that is used, by role (s).
    used: [f64; 2],
    /// The share to be used of the held part of each recording.
    shares: Vec<f64>,
    /// The duration that is used of each recording (s).
    seconds: Vec<f64>,
    /// The names of the recordings that are used whole beside ones that are not, by role.
    whole: [Vec<String>; 2],
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
        let roles = [false, true].map(|role| {
            let of_role = inputs.iter().enumerate().filter(|(_, input)| input.held_out == role);
            of_role.map(|(index, _)| index).collect::<Vec<usize>>()
        });
        let held: Vec<f64> = inputs.iter().map(|input| input.recording.held()).collect();
        let recorded: Vec<f64> = inputs.iter().map(|input| input.recording.recorded()).collect();
        // An empty sum is −0.
        let sums = |seconds: &[f64]| {
            let sum = |indices: &Vec<usize>| 0.0 + indices.iter().map(|&index| seconds[index]).sum::<f64>();
            [sum(&roles[0]), sum(&roles[1])]
        };
        let mut used = Self {
            recorded: sums(&recorded),
            used: [0.0; 2],
            shares: vec![1.0; inputs.len()],
            seconds: held.clone(),
            whole: [const { Vec::new() }; 2],
        };
        for (role, indices) in roles.iter().enumerate() {
            let of_role: Vec<f64> = indices.iter().map(|&index| recorded[index]).collect();
            for (&index, worth) in indices.iter().zip(worth_using(&of_role)) {
                used.shares[index] = (worth / held[index]).min(1.0);
                if used.shares[index] < 1.0 {
                    let sections = used.sections(index, &inputs[index]);
                    let ticks = sections.iter().map(|section| section.used).sum::<usize>();
                    used.seconds[index] = ticks as f64 * inputs[index].recording.period;
                } else if used.recorded[role] > MOST_SECONDS && inputs[index].recording.left_out == 0.0 {
                    used.whole[role].push(inputs[index].name.to_owned());
                }
            }
        }
        used.used = sums(&used.seconds);
        used
    }

    /// The sections of a recording, with a window in each. `index` is its place among the inputs.
    pub fn sections(&self, index: usize, input: &Input<'_>) -> Vec<Section> {
        let share = self.shares[index];
        let longest = if share < 1.0 { USED_WINDOW / share } else { LONGEST };
        let RegularRecording { segments, period, .. } = input.recording;
        let most = ((longest / period) as usize).max(1);
        let least = (SHORTEST_WINDOW / period) as usize;
        let mut sections = Vec::new();
        for segment in segments {
            let pieces = segment.ticks.len().div_ceil(most).max(1);
            let length = segment.ticks.len().div_ceil(pieces);
            sections.extend((0..pieces).map(|piece| {
                let from = segment.ticks.start + piece * length;
                let to = (from + length).min(segment.ticks.end);
                let used = (share * (to - from) as f64).ceil() as usize;
                Section { ticks: from..to, used: used.max(least.min(to - from)) }
            }));
        }
        sections
    }

    /// The duration that is used in all (s).
    pub fn seconds(&self) -> f64 {
        self.used.iter().sum()
    }

    /// The duration that is used of a recording (s), and its whole duration (s), if it is not used whole.
    pub fn part(&self, index: usize, input: &Input<'_>) -> Option<[f64; 2]> {
        let is_part = self.shares[index] < 1.0 || input.recording.left_out > 0.0;
        is_part.then(|| [self.seconds[index], input.recording.recorded()])
    }

    /// Sentences on the parts that are omitted.
    pub fn remarks(&self) -> Vec<String> {
        let long = ["training", "held-out"].into_iter().enumerate();
        long.filter(|&(role, _)| self.recorded[role] > MOST_SECONDS)
            .map(|(role, what)| {
                let whole = match &self.whole[role][..] {
                    [] => String::new(),
                    [name] => format!("; {name} is used whole"),
                    [first, .., last] if self.whole[role].len() > MOST_NAMED => {
                        format!("; {} of them are used whole, {first} to {last}", self.whole[role].len())
                    }
                    names => format!("; {} are used whole", list(names)),
                };
                format!(
                    "of the {:.0} s of {what} recordings, about {:.0} s are used, in windows of at most {USED_WINDOW:.0} s that are spread \
                     evenly{whole}",
                    self.recorded[role], self.used[role]
                )
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use recording::Segment;

    use super::*;

    fn recording(seconds: usize) -> RegularRecording {
        let ticks = 100 * seconds;
        RegularRecording {
            period: 0.01,
            segments: vec![Segment { ticks: 0..ticks, start: 0.0 }],
            present: vec![true; ticks],
            ..RegularRecording::default()
        }
    }

    #[test]
    fn up_to_900_s_are_used_whole() {
        assert_eq!(worth_using(&[600.0, 10.0, 290.0]), [600.0, 10.0, 290.0]);
        assert_eq!(worth_using(&[]), [0.0; 0]);
    }

    #[test]
    fn long_recordings_have_equal_parts() {
        assert_eq!(worth_using(&[3600.0]), [240.0]);
        assert_eq!(worth_using(&[1800.0, 1800.0]), [120.0, 120.0]);
        assert_eq!(worth_using(&[15.0; 100]), [2.4; 100]);
        // The unused part of a recording that is shorter than its part goes to the others.
        assert_eq!(worth_using(&[900.0, 500.0, 150.0, 48.0]), [64.0, 64.0, 64.0, 48.0]);
    }

    #[test]
    fn short_recordings_beside_long_ones_are_used_whole() {
        assert_eq!(worth_using(&[10.0, 86_400.0]), [10.0, 240.0]);
        assert_eq!(worth_using(&[3600.0, 30.0, 3600.0, 60.0]), [120.0, 30.0, 120.0, 60.0]);
        // Short recordings are used whole only if they are not too long together.
        assert!(worth_using(&[&[30.0; 22][..], &[3600.0]].concat()).starts_with(&[30.0; 22]));
        let many = worth_using(&[&[30.0; 23][..], &[3600.0]].concat());
        assert!(many.iter().all(|seconds| *seconds == 10.0), "{many:?}");
    }

    /// A recording that is thinned before all recordings are read can no longer be used whole.
    #[test]
    fn a_recording_used_whole_among_more_is_used_whole_among_fewer() {
        let mut state = 1_u64;
        for _ in 0..2000 {
            let mut random = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (state >> 33) as f64 / f64::from(1_u32 << 31)
            };
            let count = 2 + (8.0 * random()) as usize;
            let all: Vec<f64> = (0..count).map(|_| (10.0 * random()).exp()).collect();
            let worth = worth_using(&all);
            for fewer in 1..count {
                for (at, of_fewer) in worth_using(&all[..fewer]).into_iter().enumerate() {
                    assert!(worth[at] < all[at] || of_fewer == all[at], "{all:?} {fewer}");
                }
            }
        }
    }

    #[test]
    fn partial_use_is_reported() {
        let recordings = [recording(10), recording(2000), recording(50)];
        let input = |(name, recording), held_out| Input { name, recording, held_out, before: false };
        let inputs = [
            input(("short.csv", &recordings[0]), false),
            input(("long.csv", &recordings[1]), false),
            input(("held.csv", &recordings[2]), true),
        ];
        let used = Used::of(&inputs);
        assert_eq!(used.part(0, &inputs[0]), None);
        let [seconds, of] = used.part(1, &inputs[1]).expect("a part");
        assert!((seconds - 240.0).abs() < 2.0 && (of - 2000.0).abs() < 1e-6, "{seconds} {of}");
        assert_eq!(used.part(2, &inputs[2]), None);
        assert_eq!(
            used.remarks(),
            [
                "of the 2010 s of training recordings, about 250 s are used, in windows of at most 20 s that are spread evenly; \
              short.csv is used whole"
            ]
        );
    }
}
