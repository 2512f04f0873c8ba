//! A recording on the regular clock of the drive, which can be filtered and differentiated.

use std::ops::Range;

use crate::clock::{self, Clock};
use crate::held::without_held;
use crate::interpolate::between;
use crate::{PartialSignal, Quantity, Recording, RecordingError, Signal, Warning, jumps, spikes};

/// The largest number of consecutive missing ticks that are interpolated; a longer gap divides the recording.
const FILLED: i64 = 5;
/// No drive records with a shorter period (s).
const SHORTEST_PERIOD: f64 = 5e-6;
/// Deviations of the stamps from the clock up to this share of the period are not reported.
const QUIET: f64 = 0.01;

/// A stretch of evenly spaced ticks without a long gap.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// Its ticks, as indices into every signal of the [`RegularRecording`].
    pub ticks: Range<usize>,
    /// The time of its first tick (s).
    pub start: f64,
}

/// A recording whose samples lie on a regular clock, in segments parted by long gaps.
///
/// Filter and differentiate each segment separately: the time between the last tick of one and the first of the next
/// is longer than one period.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RegularRecording {
    /// The names of the joints, in the order of every [`Signal`].
    pub joints: Vec<String>,
    /// The time of the first tick (s).
    pub start: f64,
    /// The time between ticks (s).
    pub period: f64,
    /// The segments between long gaps, in order; together they contain every tick.
    pub segments: Vec<Segment>,
    /// Whether a tick was recorded; if not, its values are interpolated.
    pub present: Vec<bool>,
    /// Positions (rad or m).
    pub q: Signal,
    /// Velocities as recorded (rad/s or m/s), which are usually filtered and delayed.
    pub qd: Option<Signal>,
    /// Accelerations as recorded (rad/s² or m/s²).
    pub qdd: Option<Signal>,
    /// Torques (N m) or forces (N) at the joint.
    pub tau: Signal,
    /// Positions from a second encoder (rad or m).
    pub q_secondary: PartialSignal,
    /// Torques computed from motor currents, at the joint (N m or N).
    pub tau_current: PartialSignal,
    /// Motor currents (A).
    pub current: PartialSignal,
    /// Temperatures (°C).
    pub temperature: PartialSignal,
    /// Other columns, by their header.
    pub others: Vec<(String, Vec<f64>)>,
    /// Whether the stamps have a regular clock; if not, the rows were resampled by interpolation.
    pub has_clock: bool,
    /// Distance of the stamps from the clock, root mean square (s).
    pub jitter_rms: f64,
    /// Distance of the stamps from the clock, largest (s).
    pub jitter_max: f64,
    /// The time that was recorded and is not held (s).
    pub left_out: f64,
}

impl RegularRecording {
    /// The number of ticks.
    pub fn len(&self) -> usize {
        self.present.len()
    }

    /// Whether there are no ticks.
    pub fn is_empty(&self) -> bool {
        self.present.is_empty()
    }

    /// The time of a tick (s).
    pub fn time(&self, tick: usize) -> f64 {
        let at = self.segments.partition_point(|segment| segment.ticks.end <= tick);
        self.segments
            .get(at)
            .map_or(f64::NAN, |segment| segment.start + (tick - segment.ticks.start) as f64 * self.period)
    }

    /// Shifts the time so that it starts `seconds` earlier.
    pub fn delay(&mut self, seconds: f64) {
        self.start += seconds;
        for segment in &mut self.segments {
            segment.start += seconds;
        }
    }

    /// The times of all ticks (s).
    pub fn times(&self) -> impl Iterator<Item = f64> + '_ {
        self.segments.iter().flat_map(move |segment| {
            (0..segment.ticks.len()).map(move |tick| segment.start + tick as f64 * self.period)
        })
    }
}

/// The rows between two long gaps, and their ticks.
struct Stretch {
    rows: Range<usize>,
    /// The position of each row, in periods after the first tick.
    places: Vec<f64>,
    /// The number of ticks.
    ticks: usize,
    start: f64,
}

impl Recording {
    /// The recording on the regular clock on which its drive sampled, and the warnings.
    ///
    /// Of a sample that is written several times, the first row is used (see [`Warning::Held`] and [`Warning::HeldPositions`]). Each row is assigned
    /// to its tick, whatever the deviation of its stamp. Up to five missing ticks are interpolated (and marked in
    /// [`RegularRecording::present`]), longer gaps divide the recording into segments, and single-sample spikes are
    /// interpolated. If the stamps have no regular clock, the rows are resampled at the times of the stamps.
    ///
    /// # Errors
    /// [`RecordingError::TooShort`] below two samples, [`RecordingError::Time`] if stamps do not increase,
    /// [`RecordingError::Period`] if they are less than 5 µs apart.
    pub fn regular(&self) -> Result<(RegularRecording, Vec<Warning>), RecordingError> {
        if let Some((thinned, warning)) = without_held(self) {
            let (regular, mut warnings) = thinned.on_its_clock()?;
            warnings.insert(0, warning);
            return Ok((regular, warnings));
        }
        self.on_its_clock()
    }

    /// The regular recording of rows that are all samples.
    fn on_its_clock(&self) -> Result<(RegularRecording, Vec<Warning>), RecordingError> {
        let rows = self.len();
        if rows < 2 {
            return Err(RecordingError::TooShort { rows, needed: 2 });
        }
        let increases = |row: usize| self.time[row] > self.time[row - 1];
        if let Some(row) = (1..rows).find(|&row| !increases(row)) {
            let (before, after) = (self.time[row - 1], self.time[row]);
            return Err(RecordingError::Time { row, before, after });
        }
        let mut warnings = Vec::new();
        let breaks = jumps::breaks(self, &mut warnings);
        let clock = clock::find(&self.time, &breaks);
        if clock.period < SHORTEST_PERIOD {
            let period = clock.period;
            return Err(RecordingError::Period { period });
        }
        let clock = self.unless_sampled_at_stamps(clock, &mut warnings);
        let stretches = self.stretches(&clock, &breaks, &mut warnings);
        let mut segments = Vec::new();
        let mut ticks = 0;
        for stretch in &stretches {
            segments.push(Segment { ticks: ticks..ticks + stretch.ticks, start: stretch.start });
            ticks += stretch.ticks;
        }
        let mut present = vec![false; ticks];
        for (stretch, segment) in stretches.iter().zip(&segments) {
            for place in &stretch.places {
                let tick = segment.ticks.start + place.round() as usize;
                present[tick.min(ticks - 1)] = true;
            }
        }
        self.warn(&clock, &segments, &present, &mut warnings);
        let mut resample = Resampler {
            recording: self,
            stretches: &stretches,
            period: clock.period,
            even: clock.regular,
            warnings: &mut warnings,
        };
        let mut regular = RegularRecording {
            joints: self.joints.clone(),
            start: segments.first().map_or(0.0, |segment| segment.start),
            period: clock.period,
            q: self.q.clone(),
            qd: self.qd.clone(),
            qdd: self.qdd.clone(),
            tau: self.tau.clone(),
            q_secondary: self.q_secondary.clone(),
            tau_current: self.tau_current.clone(),
            current: self.current.clone(),
            temperature: self.temperature.clone(),
            others: self.others.clone(),
            segments,
            present,
            has_clock: clock.regular,
            jitter_rms: clock.jitter.0,
            jitter_max: clock.jitter.1,
            left_out: self.left_out,
        };
        for (meaning, values) in regular.channels_mut() {
            *values = resample.channel(meaning, values);
        }
        Ok((regular, warnings))
    }

    /// The clock, which is not regular if the rows were clearly sampled at the times of stamps that deviate from it.
    fn unless_sampled_at_stamps(&self, mut clock: Clock, warnings: &mut Vec<Warning>) -> Clock {
        let (rms, period) = (clock.jitter.0, clock.period);
        let share = rms / period;
        if !clock.regular {
            warnings.push(Warning::NoRegularClock { share, period });
        } else if share > QUIET && clock::is_at_stamps(&self.time, &self.q, &clock) {
            clock.regular = false;
            warnings.push(Warning::UnevenSampling { share, period });
        }
        clock
    }

    /// The rows between long gaps.
    fn stretches(&self, clock: &Clock, breaks: &[usize], warnings: &mut Vec<Warning>) -> Vec<Stretch> {
        let mut stretches: Vec<Stretch> = Vec::new();
        for piece in &clock.pieces {
            let mut begun = piece.rows.start;
            let mut shift = piece.shift;
            for row in piece.rows.clone() {
                let last = row + 1 == piece.rows.end;
                if !last && (!clock.regular || clock.ticks[row + 1] - clock.ticks[row] <= FILLED + 1) {
                    continue;
                }
                let first = clock.ticks[begun];
                let (places, start): (Vec<f64>, f64) = if clock.regular {
                    let places = clock.ticks[begun..=row].iter().map(|tick| (tick - first) as f64);
                    (places.collect(), piece.start + first as f64 * clock.period)
                } else {
                    let origin = self.time[begun];
                    let places = self.time[begun..=row].iter().map(|stamp| (stamp - origin) / clock.period);
                    (places.collect(), origin)
                };
                // A restart of the clock was reported while reading, and between windows nothing is missing.
                if begun > 0 && !breaks.contains(&begun) && self.left_out == 0.0 {
                    warnings.push(Warning::Gap {
                        from: self.time[begun - 1],
                        to: self.time[begun],
                        shift: std::mem::take(&mut shift),
                    });
                }
                let ticks = 1 + places.last().map_or(0, |place| (place + 1e-6).floor() as usize);
                stretches.push(Stretch { rows: begun..row + 1, places, ticks, start });
                begun = row + 1;
            }
        }
        stretches
    }

    fn warn(&self, clock: &Clock, segments: &[Segment], present: &[bool], warnings: &mut Vec<Warning>) {
        let (rms, max, row) = clock.jitter;
        if !clock.regular {
            return;
        }
        if rms > QUIET * clock.period {
            let (time, period) = (self.time[row], clock.period);
            warnings.push(Warning::Jitter { rms, max, time, period });
        }
        let mut lost = (0..present.len()).filter(|&tick| !present[tick]);
        if let Some(first) = lost.next() {
            let at = segments.partition_point(|segment| segment.ticks.end <= first);
            let into = (first - segments[at].ticks.start) as f64;
            warnings.push(Warning::LostRows {
                rows: 1 + lost.count(),
                of: present.len(),
                time: segments[at].start + into * clock.period,
            });
        }
    }
}

/// Interpolates channels at the ticks.
struct Resampler<'a> {
    recording: &'a Recording,
    stretches: &'a [Stretch],
    period: f64,
    /// Whether the rows coincide with ticks.
    even: bool,
    warnings: &'a mut Vec<Warning>,
}

impl Resampler<'_> {
    fn channel(&mut self, what: Option<(Quantity, usize)>, values: &[f64]) -> Vec<f64> {
        let count = self.stretches.last().map_or(0, |_| self.stretches.iter().map(|s| s.ticks).sum());
        let mut resampled = Vec::with_capacity(count);
        let mut times = Vec::new();
        let mut largest = 0.0_f64;
        for stretch in self.stretches {
            let mut values = values[stretch.rows.clone()].to_vec();
            // Temperatures and unknown columns are not checked for spikes.
            if matches!(what, Some((quantity, _)) if quantity != Quantity::Temperature) {
                for spike in spikes::remove(&stretch.places, &mut values) {
                    times.push(stretch.start + stretch.places[spike.row] * self.period);
                    largest = if spike.height.abs() > largest.abs() { spike.height } else { largest };
                }
            }
            self.put(stretch, values, what.is_some(), &mut resampled);
        }
        if let (Some((quantity, joint)), false) = (what, times.is_empty()) {
            self.warnings.push(Warning::Spikes {
                joint: self.recording.joints[joint].clone(),
                quantity,
                times,
                largest,
            });
        }
        resampled
    }

    /// The values of a segment at its ticks, by smooth interpolation or, if `smooth` is false, from the previous row.
    fn put(&self, stretch: &Stretch, values: Vec<f64>, smooth: bool, into: &mut Vec<f64>) {
        if self.even && stretch.ticks == values.len() {
            into.extend(values);
            return;
        }
        let mut next = 0;
        for tick in 0..stretch.ticks {
            let at = tick as f64;
            while next < values.len() && stretch.places[next] < at - 1e-9 {
                next += 1;
            }
            let here = stretch.places.get(next).is_some_and(|place| (place - at).abs() <= 1e-9);
            into.push(if here {
                values[next]
            } else if next == 0 || next >= values.len() {
                values[next.min(values.len() - 1)]
            } else if smooth {
                // A single missing sample is interpolated from six neighbours; several from four, which amplify noise
                // less.
                let one = stretch.places[next] - stretch.places[next - 1] < 2.5;
                between(&stretch.places, &values, next, if one && self.even { 3 } else { 2 }, at)
            } else {
                values[next - 1]
            });
        }
    }
}

#[cfg(test)]
#[path = "regular_tests.rs"]
mod tests;
