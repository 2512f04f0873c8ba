//! Filtered recordings: positions, their derivatives and torques on a grid that is fine enough for nonlinear functions of them.

use std::ops::Range;

use rayon::prelude::*;

use crate::data::input::Input;
use crate::data::noise::{WhiteNoise, band_noise};
use crate::data::signal::{Kernel, outputs};
use crate::data::statistics::median;
use crate::data::used::{Section, Used};
use crate::thresholds::{LARGEST_CUTOFF, MOST_GROUPS, MOST_ROWS, ROWS_PER_PERIOD, SHAKES_FOR, STILL};

/// Samples of the fine grid per period of the second cut-off.
const FINE: f64 = 8.0;
/// The golden ratio; the fractional parts of its multiples are spread evenly.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// The pause between recordings without a common clock (s).
const PAUSE: f64 = 10.0;

/// A chunk of a recording on the fine grid, all signals after the first filter: `[joint][tick]`.
#[derive(Clone, Debug)]
pub struct Chunk {
    /// The index of its recording.
    pub recording: usize,
    /// The first recording of the group that it belongs to, as in [`Motions::groups`].
    pub group: usize,
    /// The time of the first tick (s).
    pub start: f64,
    /// The time between ticks (s).
    pub period: f64,
    /// Positions (rad or m).
    pub q: Vec<Vec<f64>>,
    /// Velocities (rad/s or m/s).
    pub qd: Vec<Vec<f64>>,
    /// Accelerations (rad/s² or m/s²).
    pub qdd: Vec<Vec<f64>>,
    /// Torques without those of known effects (N m or N).
    pub tau: Vec<Vec<f64>>,
    /// The torques of known effects; none where empty (N m or N).
    pub known: Vec<Vec<f64>>,
    /// The second filter, from ticks to rows.
    pub kernel: Kernel,
    /// The number of ticks between rows.
    pub stride: usize,
}

impl Chunk {
    /// The number of ticks.
    pub fn ticks(&self) -> usize {
        self.q[0].len()
    }

    /// The number of rows.
    pub fn rows(&self) -> usize {
        outputs(self.ticks(), self.kernel.reach(), self.stride)
    }

    /// The time of a tick (s).
    pub fn time(&self, tick: usize) -> f64 {
        self.start + tick as f64 * self.period
    }

    /// The tick at the centre of a row.
    pub fn tick_of(&self, row: usize) -> usize {
        row * self.stride + self.kernel.reach()
    }

    /// The share of each row, through the second filter, that is before a time (s).
    pub fn shares_before(&self, time: f64) -> Vec<f64> {
        let is_before = |tick: usize| f64::from(u8::from(self.time(tick) < time));
        let (first, last) = (is_before(0), is_before(self.ticks().saturating_sub(1)));
        if first.to_bits() == last.to_bits() {
            return vec![first; self.rows()];
        }
        self.filter(&(0..self.ticks()).map(is_before).collect::<Vec<f64>>())
    }

    /// A signal on the ticks, through the second filter.
    pub fn filter(&self, signal: &[f64]) -> Vec<f64> {
        self.kernel.smooth(signal, self.stride)
    }
}

/// Properties of one recording.
#[derive(Clone, Debug)]
pub struct SourceRecording {
    /// The name that the user gave.
    pub name: String,
    /// Whether it is held out: not to be fitted.
    pub held_out: bool,
    /// The duration that is used and the whole one (s), if it is not used whole.
    pub part: Option<[f64; 2]>,
    /// The time until which the tip has the load of some recordings (s): −∞ if it does not have it, ∞ if it has it to the end.
    pub own_load_until: f64,
    /// The time of the diagnosis' clock minus that of the recording's own (s).
    pub shift: f64,
    /// Noise of the filtered torque, one per joint (N m or N).
    pub torque_noise: Vec<f64>,
    /// Noise of the acceleration after both filters, one per joint (rad/s² or m/s²).
    pub acceleration_noise: Vec<f64>,
    /// Noise of the velocity after the first filter, one per joint (rad/s or m/s).
    pub velocity_noise: Vec<f64>,
}

/// All recordings.
#[derive(Clone, Debug)]
pub struct Motions {
    /// The number of joints.
    pub dof: usize,
    /// The chunks, in the order of recordings and time.
    pub chunks: Vec<Chunk>,
    /// Properties of the recordings, one each.
    pub sources: Vec<SourceRecording>,
    /// For each recording, the first one of the group in which it has its own friction and is left out together with others: itself, or one
    /// before it if there are many.
    pub groups: Vec<usize>,
    /// The half-power frequency of the second filter (Hz).
    pub cutoff: f64,
    /// The frequency of each joint's motion in the training recordings (Hz): that of a sinusoid with the same speed and
    /// acceleration; zero without motion.
    pub tempo: Vec<f64>,
    /// Whether all recordings share one clock. If not, each begins after the previous one.
    pub one_clock: bool,
    /// The first time of all recordings (s).
    pub begins: f64,
    /// The time at which the recordings from before end and the others begin, on the diagnosis' clock (s); `None` if there are
    /// none from before.
    pub changed_at: Option<f64>,
    /// Notes on omitted data, in sentences.
    pub remarks: Vec<String>,
}

/// The groups of recordings with these roles: at most [`MOST_GROUPS`] of those with the same role, in their order. For each recording, the
/// first one of its group.
fn groups<Role: PartialEq>(roles: &[Role]) -> Vec<usize> {
    let of = |recording: usize| {
        let like: Vec<usize> = (0..roles.len()).filter(|&other| roles[other] == roles[recording]).collect();
        let (all, parts) = (like.len(), like.len().min(MOST_GROUPS));
        let part = like.partition_point(|&other| other < recording) * parts / all;
        like[(part * all).div_ceil(parts)]
    };
    (0..roles.len()).map(of).collect()
}

impl Motions {
    /// Filters `inputs` with the second filter at `wanted` (Hz), or at the highest frequency that the slowest recording allows.
    /// `white` is the noise of each.
    pub fn at(inputs: &[Input<'_>], white: &[WhiteNoise], wanted: f64, wider: f64) -> Self {
        let slowest = inputs.iter().map(|input| 1.0 / input.recording.period).fold(f64::INFINITY, f64::min);
        let cutoff = wanted.min(LARGEST_CUTOFF * slowest);
        let used = Used::of(inputs);
        let thin = (used.seconds() * ROWS_PER_PERIOD * cutoff / MOST_ROWS).max(1.0);
        let has_before = inputs.iter().any(|input| input.before);
        // Recordings from before get a clock of their own: the change happened between them and the others.
        let overlap = if has_before { None } else { overlapping(inputs) };
        let mut motions = Self {
            dof: inputs.first().map_or(0, |input| input.recording.joints.len()),
            chunks: Vec::new(),
            sources: Vec::new(),
            groups: Vec::new(),
            cutoff,
            tempo: Vec::new(),
            one_clock: overlap.is_none() && !has_before,
            begins: f64::INFINITY,
            changed_at: None,
            remarks: used.remarks(),
        };
        if let Some([a, b]) = overlap {
            motions.remarks.push(format!(
                "{a} and {b} overlap in time, so that effects that depend on the order of the recordings (warming, onsets) are \
                 not tested; if one was recorded after the other, give it later time stamps"
            ));
        }
        let mut end = 0.0;
        for (index, input) in inputs.iter().enumerate() {
            let recording = input.recording;
            let shift = if motions.one_clock { 0.0 } else { end - recording.time(0) };
            if has_before && !input.before && motions.changed_at.is_none() {
                motions.changed_at = Some(end - 0.5 * PAUSE);
            }
            // Pauses and omitted parts between windows also count as time.
            end += recording.time(recording.len() - 1) - recording.time(0) + recording.period + PAUSE;
            motions.begins = motions.begins.min(shift + recording.time(0));
            motions.add(index, (input, &white[index]), &used.sections(index, input), [wider, thin], shift);
            motions.sources[index].part = used.part(index, input);
        }
        motions.tempo = motions.tempo();
        let role = |recording: usize| (motions.sources[recording].held_out, motions.is_before(recording));
        motions.groups = groups(&(0..motions.sources.len()).map(role).collect::<Vec<_>>());
        for chunk in &mut motions.chunks {
            chunk.group = motions.groups[chunk.recording];
        }
        motions
    }

    /// Whether a recording is from before the change.
    pub fn is_before(&self, recording: usize) -> bool {
        self.changed_at.is_some_and(|at| self.span(recording)[0] < at)
    }

    fn tempo(&self) -> Vec<f64> {
        let fitted = |chunk: &&Chunk| !self.sources[chunk.recording].held_out;
        // After the second filter: between the two filters, the acceleration's noise is many times the motion's.
        let power = |signal: &dyn Fn(&Chunk) -> &Vec<f64>| -> f64 {
            let rows = self.chunks.iter().filter(fitted).flat_map(|chunk| chunk.filter(signal(chunk)));
            rows.map(|v| v * v).sum()
        };
        (0..self.dof)
            .map(|joint| {
                let (speed, acceleration) = (power(&|chunk| &chunk.qd[joint]), power(&|chunk| &chunk.qdd[joint]));
                // On a joint that does not move, only noise would be measured.
                let noise = self.sources.iter().map(|source| source.velocity_noise[joint]).fold(0.0, f64::max);
                let rows: usize = self.chunks.iter().filter(fitted).map(Chunk::rows).sum();
                if speed > (STILL * noise).powi(2) * rows as f64 && speed > 0.0 {
                    (acceleration / speed).sqrt() / (2.0 * std::f64::consts::PI)
                } else {
                    0.0
                }
            })
            .collect()
    }

    /// Adds the windows in `sections` of a recording.
    fn add(
        &mut self,
        index: usize,
        (input, white): (&Input<'_>, &WhiteNoise),
        sections: &[Section],
        [wider, thin]: [f64; 2],
        shift: f64,
    ) {
        let recording = input.recording;
        let rate = 1.0 / recording.period;
        let first = Kernel::new((wider * self.cutoff).min(LARGEST_CUTOFF * rate), recording.period);
        let decimation = (rate / (FINE * self.cutoff)).floor().max(1.0) as usize;
        let period = recording.period * decimation as f64;
        let kernel = Kernel::new(self.cutoff, period);
        let stride = (thin / (period * ROWS_PER_PERIOD * self.cutoff)).round().max(1.0) as usize;
        let mut windows: Vec<Range<usize>> = Vec::new();
        for section in sections {
            // The position of the window in its section varies (by the golden ratio), because sections may repeat one
            // motion.
            let free = section.ticks.len() - section.used;
            let place = (GOLDEN * (self.chunks.len() + windows.len()) as f64).fract();
            let from = section.ticks.start + (place * free as f64) as usize;
            let window = from..from + section.used;
            if outputs(outputs(window.len(), first.reach(), decimation), kernel.reach(), stride) > 0 {
                windows.push(window);
            }
        }
        let chunk = |window: &Range<usize>| {
            let each = |signal: &[Vec<f64>], filter: fn(&Kernel, &[f64], usize) -> Vec<f64>| -> Vec<Vec<f64>> {
                let filtered = signal.iter().map(|values| filter(&first, &values[window.clone()], decimation));
                filtered.collect()
            };
            Chunk {
                recording: index,
                group: index,
                start: shift + recording.time(window.start) + first.reach() as f64 * recording.period,
                period,
                q: each(&recording.q, Kernel::smooth),
                qd: each(&recording.q, Kernel::first),
                qdd: each(&recording.q, Kernel::second),
                tau: each(&recording.tau, Kernel::smooth),
                known: Vec::new(),
                kernel: kernel.clone(),
                stride,
            }
        };
        self.chunks.par_extend(windows.par_iter().map(chunk));
        let both = Kernel::new(
            1.0 / (1.0 / self.cutoff.powi(2) + (first.width() / kernel.width() / self.cutoff).powi(2)).sqrt(),
            recording.period,
        );
        let (smooth, second) = both.noise_gains();
        let slope = first.first_noise_gain();
        let acceleration = recording.q.par_iter().zip(&white.q);
        self.sources.push(SourceRecording {
            own_load_until: f64::NEG_INFINITY,
            name: input.name.to_owned(),
            held_out: input.held_out,
            part: None,
            shift,
            torque_noise: white.tau.iter().map(|noise| smooth * noise).collect(),
            acceleration_noise: acceleration
                .map(|(q, noise)| second * noise.max(band_noise(q, recording, self.cutoff)))
                .collect(),
            velocity_noise: white.q.iter().map(|noise| slope * noise).collect(),
        });
    }

    /// The median of the tempo of the joints that move (Hz).
    pub fn usual_tempo(&self) -> f64 {
        median(self.tempo.iter().copied().filter(|&tempo| tempo > 0.0).collect())
    }

    /// Converts a time of the diagnosis' clock to the clock of a recording (s).
    pub fn own_time(&self, recording: usize, time: f64) -> f64 {
        time - self.sources[recording].shift
    }

    /// The first and the last time of a row in a recording, on the diagnosis' clock (s).
    pub fn span(&self, recording: usize) -> [f64; 2] {
        let chunks = self.chunks.iter().filter(|chunk| chunk.recording == recording);
        chunks.fold([f64::INFINITY, f64::NEG_INFINITY], |[first, last], chunk| {
            [first.min(chunk.start), last.max(chunk.time(chunk.ticks().saturating_sub(1)))]
        })
    }

    /// Whether a time is soon after the beginning of its recording, when the arm may still shake from being released or switched on.
    pub fn is_at_a_beginning(&self, recording: usize, time: f64) -> bool {
        time - self.span(recording)[0] < SHAKES_FOR
    }

    /// The training recording at a time of the diagnosis' clock.
    pub fn recording_at(&self, time: f64) -> Option<usize> {
        let inside = |chunk: &&Chunk| {
            !self.sources[chunk.recording].held_out && chunk.start <= time && time <= chunk.time(chunk.ticks())
        };
        self.chunks.iter().find(inside).map(|chunk| chunk.recording)
    }

    /// The time of every row (s).
    pub fn row_times(&self) -> Vec<f64> {
        let times =
            |chunk: &Chunk| -> Vec<f64> { (0..chunk.rows()).map(|row| chunk.time(chunk.tick_of(row))).collect() };
        self.chunks.iter().flat_map(times).collect()
    }
}

/// Two recordings that overlap in time and therefore do not share a clock, if there are any.
fn overlapping<'a>(inputs: &[Input<'a>]) -> Option<[&'a str; 2]> {
    let mut spans: Vec<(f64, f64, &str)> = inputs
        .iter()
        .filter(|input| !input.recording.is_empty())
        .map(|input| {
            let last = input.recording.len() - 1;
            (input.recording.time(0), input.recording.time(last), input.name)
        })
        .collect();
    spans.sort_by(|a, b| a.0.total_cmp(&b.0));
    let pair = spans.windows(2).find(|pair| pair[1].0 < pair[0].1)?;
    Some([pair[0].2, pair[1].2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_recordings_of_a_role_are_grouped_in_their_order() {
        let few = groups(&[false; MOST_GROUPS]);
        assert_eq!(few, (0..MOST_GROUPS).collect::<Vec<_>>());
        // Every third one is held out: 34 of 100.
        let is_held_out: Vec<bool> = (0..100).map(|recording| recording % 3 == 0).collect();
        let grouped = groups(&is_held_out);
        assert_eq!(grouped[..12], [0, 1, 1, 0, 1, 5, 6, 5, 5, 9, 10, 10]);
        let mut first = grouped.clone();
        first.sort_unstable();
        first.dedup();
        assert!(first.iter().all(|&one| grouped[one] == one));
        assert_eq!(first.len(), 2 * MOST_GROUPS);
    }
}
