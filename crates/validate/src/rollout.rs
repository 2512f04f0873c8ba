//! The motion of the simulated arm, with and without the named effects, driven by the recorded torques.
//!
//! The windows are so short that the arm stays near its path without a controller. A controller would hide the effects that
//! the model omits. Each window starts at the measured state, and the plant then runs on the recorded torques alone.

mod drive;
#[cfg(test)]
mod shared_tests;
mod start;
#[cfg(test)]
mod tests;
mod variant;

use arm::Arm;
use diagnosis::JointRollout;
use effects::Effect;
use effects::arm::PAYLOAD;
use recording::RegularRecording;
use recording::statistics::mean_square;

use self::start::Start;
use self::variant::Variant;
use crate::error::ValidateError;

/// Options of a rollout.
#[derive(Clone, Debug, PartialEq)]
pub struct RolloutOptions {
    /// The length of a window (s).
    pub window: f64,
    /// The total length of the windows (s), which are spread evenly over the recording.
    pub simulated: f64,
    /// The longest step of the plant (s); the step divides the recording's period, or is a whole number of them.
    pub step: f64,
    /// The plant's extrapolation order.
    pub order: usize,
    /// Joints that follow their recorded path instead of their recorded torque, base to tip; empty if there are none. For a
    /// joint that no training recording moves, friction is unknown: it would leave its path and disturb all others.
    pub guided: Vec<bool>,
}

impl Default for RolloutOptions {
    fn default() -> Self {
        Self { window: 0.25, simulated: 6.0, step: 2e-3, order: 2, guided: Vec::new() }
    }
}

/// How closely the simulated arm follows the recorded one. Joints are the arm's, base to tip.
#[derive(Clone, Debug, Default)]
pub struct Rollout {
    /// RMS distance of the simulated from the measured position over all windows, one per joint (rad or m). Of a window that
    /// a variant leaves, both are compared up to that time.
    pub joints: Vec<JointRollout>,
    /// The windows in order of time.
    pub windows: Vec<Window>,
    /// Windows that the nominal arm left (a joint more than a turn or a metre off, or without bounds).
    pub runaway_nominal: usize,
    /// Windows that the augmented arm left.
    pub runaway_augmented: usize,
    /// Effects that are only partly simulated, in words.
    pub remarks: Vec<String>,
}

/// One window, up to the time at which a variant leaves it; signals are `[joint][instant]`, positions as the encoders report
/// them (rad or m).
#[derive(Clone, Debug, Default)]
pub struct Window {
    /// Recorded positions.
    pub measured: Vec<Vec<f64>>,
    /// Simulated positions without the effects.
    pub nominal: Vec<Vec<f64>>,
    /// Simulated positions with the effects.
    pub augmented: Vec<Vec<f64>>,
}

/// The recording's grid, its columns in the arm's order, and the plant's step on it.
struct Course<'a> {
    recording: &'a RegularRecording,
    /// The columns of the arm's joints in the recording.
    columns: Vec<usize>,
    /// Ticks between two instants that are compared.
    stride: usize,
    /// Plant steps between two such instants.
    substeps: usize,
    /// The plant's step (s).
    step: f64,
    order: usize,
    guided: &'a [bool],
}

/// Drives the plant of `arm`, and that of `arm` with `effects`, by the torques of `recording` over windows.
///
/// Equal inputs give equal bits. A window that a variant leaves ends for both at that time, and is counted in [`Rollout`].
///
/// # Errors
/// [`ValidateError`], if a joint is not in the recording, an effect does not fit the arm, no window fits in the recording, an arm
/// leaves all of them at once, or the plant cannot simulate the arm.
pub fn rollout(
    arm: &Arm,
    nominal: &[Effect],
    augmented: &[Effect],
    recording: &RegularRecording,
    options: &RolloutOptions,
) -> Result<Rollout, ValidateError> {
    let columns = arm
        .joints()
        .iter()
        .map(|joint| {
            let found = recording.joints.iter().position(|name| *name == joint.name);
            found.ok_or_else(|| ValidateError::Joint { joint: joint.name.clone() })
        })
        .collect::<Result<Vec<usize>, _>>()?;
    let period = recording.period;
    if !(period > 0.0 && options.step > 0.0) {
        return Err(ValidateError::Period { period });
    }
    let stride = ((options.step / period + 1e-9).floor() as usize).max(1);
    let interval = stride as f64 * period;
    let substeps = (interval / options.step - 1e-9).ceil().max(1.0) as usize;
    let course = Course {
        recording,
        columns,
        stride,
        substeps,
        step: interval / substeps as f64,
        order: options.order,
        guided: &options.guided,
    };
    let instants = (options.window / interval).round().max(1.0) as usize;
    let starts = course.starts(instants, options)?;

    let run = |which: &'static str, effects: &[Effect]| -> Result<Run, ValidateError> {
        let mut variant = Variant::new(which, arm, effects, &course)?;
        let remarks = std::mem::take(&mut variant.remarks);
        let mut acting = effects.to_vec();
        let mut paths = Vec::with_capacity(starts.len());
        for start in &starts {
            // A payload that is picked up within a window is not simulated in that window.
            let time = recording.time(start.tick);
            let is_there = |effect: &&Effect| !effect.is(&PAYLOAD) || effect.onset().is_none_or(|onset| onset <= time);
            let now: Vec<Effect> = effects.iter().filter(is_there).cloned().collect();
            if now != acting {
                variant = Variant::new(which, arm, &now, &course)?;
                acting = now;
            }
            paths.push(variant.run(&course, start, instants));
        }
        Ok(Run { paths, remarks })
    };
    let (nominal, augmented) =
        rayon::join(|| run("the nominal arm", nominal), || run("the arm with the effects found", augmented));
    let (nominal, augmented) = (nominal?, augmented?);

    let mut result = Rollout {
        runaway_nominal: nominal.runaways(),
        runaway_augmented: augmented.runaways(),
        remarks: augmented.remarks,
        ..Rollout::default()
    };
    for ((start, mut nominal), mut augmented) in starts.iter().zip(nominal.paths).zip(augmented.paths) {
        let common = nominal.q[0].len().min(augmented.q[0].len());
        for path in nominal.q.iter_mut().chain(&mut augmented.q) {
            path.truncate(common);
        }
        let ticks = || (0..common).map(|k| start.tick + k * stride);
        result.windows.push(Window {
            measured: course.columns.iter().map(|&c| ticks().map(|tick| recording.q[c][tick]).collect()).collect(),
            nominal: nominal.q,
            augmented: augmented.q,
        });
    }
    if result.windows.iter().all(|window| window.measured[0].len() < 2) {
        return Err(ValidateError::Left);
    }
    result.joints = (0..arm.dof())
        .map(|joint| JointRollout {
            nominal_rms_rad: rms(&result.windows, joint, |window| &window.nominal),
            augmented_rms_rad: rms(&result.windows, joint, |window| &window.augmented),
        })
        .collect();
    Ok(result)
}

/// The positions of one variant.
struct Path {
    /// Positions up to the last instant before the plant failed, or the first one at which the arm was lost.
    q: Vec<Vec<f64>>,
    ran_away: bool,
}

struct Run {
    paths: Vec<Path>,
    remarks: Vec<String>,
}

impl Run {
    fn runaways(&self) -> usize {
        self.paths.iter().filter(|path| path.ran_away).count()
    }
}

/// RMS of simulated minus measured position over all windows (rad or m), without the instant at which a window starts.
fn rms(windows: &[Window], joint: usize, simulated: impl Fn(&Window) -> &Vec<Vec<f64>>) -> f64 {
    let distances = windows.iter().flat_map(|window| {
        let pairs = simulated(window)[joint].iter().zip(&window.measured[joint]);
        pairs.skip(1).map(|(q, measured)| q - measured)
    });
    mean_square(distances).sqrt()
}

impl Course<'_> {
    fn is_guided(&self, joint: usize) -> bool {
        self.guided.get(joint).is_some_and(|&guided| guided)
    }

    /// Evenly spread windows of `instants` intervals, with the measured state at the start of each.
    fn starts(&self, instants: usize, options: &RolloutOptions) -> Result<Vec<Start>, ValidateError> {
        let side = start::side(self.recording.period);
        let length = instants * self.stride;
        // A start needs measured samples on both sides.
        let possible: Vec<usize> = self
            .recording
            .segments
            .iter()
            .flat_map(|segment| {
                let first = segment.ticks.start + side;
                first..segment.ticks.end.saturating_sub(length.max(side)).max(first)
            })
            .collect();
        if possible.is_empty() {
            return Err(ValidateError::Window { window: options.window });
        }
        let affordable = (options.simulated / options.window).floor().max(1.0) as usize;
        let apart = possible.len().div_ceil(length).min(affordable).max(1);
        let starts = (0..apart).map(|k| possible[(2 * k + 1) * possible.len() / (2 * apart)]);
        Ok(starts.map(|tick| Start::measured(self, tick, side)).collect())
    }
}
