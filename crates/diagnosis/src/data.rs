//! Phase 1, data: recordings with one common filter, the rigid model along them, scales and noise.

use arm::Arm;
use effects::{Effect, Scales};
use rayon::prelude::*;

pub use recording::statistics;

use crate::data::motion::{Chunk, Motions};
use crate::error::DiagnosisError;
use crate::options::Options;
use crate::report::NotDiagnosed;
use crate::thresholds::{RESTING, RESTING_REACH, ROUNDING};

pub mod channels;
pub mod cutoff;
mod gravity;
pub mod input;
pub mod known;
pub mod measure;
pub mod motion;
pub mod noise;
mod payload_frame;
pub mod rigid;
pub mod signal;
mod states;
mod turning_base;
pub mod used;

/// What is known before any fit: the filtered recordings, and the model along them.
pub struct Data {
    /// The nominal model: the URDF's, with known effects.
    pub arm: Arm,
    /// The effects that the nominal model has beside the URDF.
    pub known: Vec<Effect>,
    /// The filtered recordings.
    pub motions: Motions,
    /// The model along them, one per chunk.
    pub rigid: Vec<rigid::Rigid>,
    /// Typical and largest values of each joint.
    pub scales: Scales,
    /// Measured torque on all rows (N m or N), one list per joint.
    pub measured: Vec<Vec<f64>>,
    /// Measured torque minus that of the nominal model, on all rows (N m or N).
    pub nominal: Vec<Vec<f64>>,
    /// The variance of the measured noise, one per joint.
    pub noise: Vec<f64>,
    /// The variance due to noise, filtering and small errors, one per joint.
    pub floor: Vec<f64>,
    /// The time between rows, one per recording (s).
    pub seconds: Vec<f64>,
    /// Whether a recording is fitted.
    pub fitted: Vec<bool>,
    /// The joints whose torque channels hold no usable torque; their torque in `scales` is 0.
    pub not_diagnosed: Vec<NotDiagnosed>,
    /// Known dry friction on all rows, one list per joint: what was subtracted from the torques beyond the torque that is the same in
    /// both directions, and the largest torque that it holds at rest (N m or N).
    known_dry: Option<[Vec<Vec<f64>>; 2]>,
}

/// How the columns of recordings are read.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Reading {
    /// As they will be diagnosed.
    Settled,
    /// With or without a correction, which is weighed.
    Weighed {
        /// Whether all of the model is evaluated, or only its torques and mass matrix.
        derivatives: bool,
    },
}

impl Data {
    /// Filters `inputs` and evaluates `arm`, with the known effects, along them.
    ///
    /// # Errors
    /// [`DiagnosisError`], if a known effect does not fit the arm.
    pub fn new(arm: &Arm, inputs: &[input::Input<'_>], options: &Options) -> Result<Self, DiagnosisError> {
        Self::judged(arm, inputs, options, Reading::Settled)
    }

    /// As [`Data::new`], but a torque channel that contradicts the model counts as a torque: the recordings may be read wrongly, and
    /// with and without a correction the same joints must be compared. Without `derivatives`, only the torques of
    /// the model and its mass matrix are evaluated; all else, such as what encoders' offsets and compliant joints need, is zero.
    ///
    /// # Errors
    /// As for [`Data::new`].
    pub fn before_a_correction(
        arm: &Arm,
        inputs: &[input::Input<'_>],
        options: &Options,
        derivatives: bool,
    ) -> Result<Self, DiagnosisError> {
        Self::judged(arm, inputs, options, Reading::Weighed { derivatives })
    }

    fn judged(
        arm: &Arm,
        inputs: &[input::Input<'_>],
        options: &Options,
        reading: Reading,
    ) -> Result<Self, DiagnosisError> {
        let known = known::Known::new(arm, &options.known)?;
        let arm = &known.arm;
        let mut motions = cutoff::filtered(inputs, options.cutoff, arm);
        let measured = on_rows(&motions, |_, chunk, joint| chunk.tau[joint].clone());
        let torque = measure::deviations(&motions);
        let known::Subtracted { mut recorded, dry } = known.subtract(&mut motions);
        let offset = vec![0.0; arm.dof()];
        let nominal = arm.inertial_parameters();
        let by_model = reading == Reading::Settled;
        let needed = match reading {
            Reading::Weighed { derivatives: false } => rigid::Needed::Dynamics,
            _ => rigid::Needed::All,
        };
        let chunks = motions.chunks.par_iter();
        let rigid: Vec<rigid::Rigid> =
            chunks.map(|chunk| rigid::Rigid::with(arm, &nominal, &offset, chunk, needed)).collect();
        let mut scales = measure::scales(&motions, torque);
        known.subtract_commanded(&mut motions, &recorded, &rigid, &scales);
        for (chunk, recorded) in motions.chunks.iter_mut().zip(&recorded) {
            let joints = recorded.iter().zip(&chunk.tau);
            let minus =
                |(recorded, left): (&Vec<f64>, &Vec<f64>)| recorded.iter().zip(left).map(|(a, b)| a - b).collect();
            chunk.known = joints.map(minus).collect();
        }
        // A channel is judged as it was recorded: what known effects leave of it may be noise.
        let mut exchange = |motions: &mut Motions| {
            for (chunk, tau) in motions.chunks.iter_mut().zip(&mut recorded) {
                std::mem::swap(&mut chunk.tau, tau);
            }
        };
        exchange(&mut motions);
        let without = channels::without_torque(inputs, &motions, &rigid, &scales, by_model);
        exchange(&mut motions);
        let names = |joints: &[usize]| -> Vec<String> {
            joints.iter().map(|&joint| arm.joints()[joint].name.clone()).collect()
        };
        let mut not_diagnosed: Vec<NotDiagnosed> = Vec::new();
        for (joint, why) in without {
            scales.torque[joint] = 0.0;
            let because = why.clause();
            match not_diagnosed.iter_mut().find(|group| group.because == because) {
                Some(group) => group.joints.extend(names(&[joint])),
                None => not_diagnosed.push(NotDiagnosed { joints: names(&[joint]), because }),
            }
        }
        let weightless = if by_model { gravity::without(&motions, &rigid, &scales, arm.gravity()) } else { Vec::new() };
        if !weightless.is_empty() {
            weightless.iter().for_each(|&joint| scales.torque[joint] = 0.0);
            not_diagnosed.push(NotDiagnosed { joints: names(&weightless), because: gravity::CLAUSE.to_owned() });
        }
        let fitted: Vec<bool> = motions.sources.iter().map(|source| !source.held_out).collect();
        let noise = measure::noise(&motions, &rigid, &fitted);
        // A channel without noise and torque must not have an infinite weight.
        let least = (ROUNDING * scales.torque.iter().copied().fold(0.0, f64::max)).powi(2);
        let floor =
            |(noise, torque): (&f64, &f64)| (noise + (options.thresholds.tolerance * torque).powi(2)).max(least);
        let known_dry = dry.map(|both| both.map(|list| on_rows(&motions, |k, _, joint| list[k][joint].clone())));
        let mut data = Self {
            seconds: measure::seconds(&motions),
            nominal: on_rows(&motions, |k, chunk, joint| {
                let pairs = chunk.tau[joint].iter().zip(&rigid[k].tau[joint]);
                pairs.map(|(measured, model)| measured - model).collect()
            }),
            floor: noise.iter().zip(&scales.torque).map(floor).collect(),
            noise,
            arm: known.arm,
            known: options.known.clone(),
            motions,
            rigid,
            scales,
            measured,
            fitted,
            not_diagnosed,
            known_dry,
        };
        data.hold_at_rest();
        Ok(data)
    }

    /// Takes from the nominal residual at rest what known dry friction holds.
    fn hold_at_rest(&mut self) {
        if self.known_dry.is_none() {
            return;
        }
        for joint in 0..self.motions.dof {
            for row in self.resting_rows(joint) {
                let [subtracted, holds] = self.known_dry_at(joint, row);
                let free = self.nominal[joint][row] + subtracted;
                self.nominal[joint][row] = free - free.clamp(-holds, holds);
            }
        }
    }

    /// Whether some dry friction of `joint` is known.
    pub fn has_known_dry_friction(&self, joint: usize) -> bool {
        let known = self.known_dry.as_ref();
        known.is_some_and(|[_, holds]| holds[joint].iter().any(|holds| *holds != 0.0))
    }

    /// The known dry friction of `joint` on a row: what the measured torque lacks of it, and the largest torque that it holds at rest
    /// (N m or N).
    pub fn known_dry_at(&self, joint: usize, row: usize) -> [f64; 2] {
        let known = self.known_dry.as_ref();
        known.map_or([0.0; 2], |[subtracted, holds]| [subtracted[joint][row], holds[joint][row].abs()])
    }

    /// A torque (N m or N) as a share of the typical torque of `joint`.
    pub fn share(&self, joint: usize, torque: f64) -> f64 {
        torque / self.scales.torque[joint].max(1e-300)
    }

    /// The recording of which contacts in these windows (s) cover the largest part, and that part.
    pub fn contact_share(&self, windows: &[[f64; 2]]) -> Option<(usize, f64)> {
        let shares = measure::spans(&self.motions).into_iter().map(|spans| {
            let covered = |&(from, to): &(f64, f64)| -> f64 {
                let inside = windows.iter().map(|&[start, end]| (end.min(to) - start.max(from)).max(0.0));
                inside.sum()
            };
            let length: f64 = spans.iter().map(|(from, to)| to - from).sum();
            spans.iter().map(covered).sum::<f64>() / length.max(f64::MIN_POSITIVE)
        });
        shares.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The rows of all recordings on which `joint` rests within the reach of the filter.
    pub fn resting_rows(&self, joint: usize) -> Vec<usize> {
        let mut rows = Vec::new();
        let mut first = 0;
        for chunk in &self.motions.chunks {
            let reach = (RESTING_REACH * chunk.kernel.width() / chunk.period).ceil() as usize;
            let qd = &chunk.qd[joint];
            for row in 0..chunk.rows() {
                let tick = chunk.tick_of(row);
                let window = &qd[tick.saturating_sub(reach)..(tick + reach + 1).min(qd.len())];
                if window.iter().all(|qd| qd.abs() < RESTING * self.scales.rest[joint]) {
                    rows.push(first + row);
                }
            }
            first += chunk.rows();
        }
        rows
    }

    /// The torque that the gear transmits to the links (N m or N) and the time (s) of given rows of `joint`, in ascending order.
    pub fn loads_and_times(&self, joint: usize, rows: &[usize]) -> (Vec<f64>, Vec<f64>) {
        let (mut loads, mut times) = (Vec::with_capacity(rows.len()), Vec::with_capacity(rows.len()));
        let mut rows = rows.iter().peekable();
        let mut first = 0;
        for (chunk, rigid) in self.motions.chunks.iter().zip(&self.rigid) {
            let end = first + chunk.rows();
            while let Some(&&row) = rows.peek()
                && row < end
            {
                let tick = chunk.tick_of(row - first);
                loads.push(rigid.load(joint, chunk, tick));
                times.push(chunk.time(tick));
                rows.next();
            }
            first = end;
        }
        (loads, times)
    }
}

/// A torque of all ticks of each chunk, which has a number, on all rows: one list per joint.
fn on_rows(motions: &Motions, torque: impl Fn(usize, &Chunk, usize) -> Vec<f64>) -> Vec<Vec<f64>> {
    let of = |joint: usize| {
        let chunks = motions.chunks.iter().enumerate();
        chunks.flat_map(|(k, chunk)| chunk.filter(&torque(k, chunk, joint))).collect()
    };
    (0..motions.dof).map(of).collect()
}
