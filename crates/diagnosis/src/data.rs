//! Phase 1, data: recordings with one common filter, the rigid model along them, scales and noise.

use arm::Arm;
use effects::Scales;
use rayon::prelude::*;

use crate::error::DiagnosisError;
use crate::options::Options;

pub mod channels;
pub mod cutoff;
pub mod input;
pub mod known;
pub mod measure;
pub mod motion;
pub mod noise;
pub mod rigid;
pub mod signal;
pub mod statistics;
pub mod used;

/// What is known before any fit: the filtered recordings, and the model along them.
pub struct Data {
    /// The nominal model: the URDF's, with known effects.
    pub arm: Arm,
    /// The filtered recordings.
    pub motions: motion::Motions,
    /// The model along them, one per chunk.
    pub rigid: Vec<rigid::Rigid>,
    /// Typical and largest values of each joint.
    pub scales: Scales,
    /// Measured torque on all rows (N m or N), one list per joint.
    pub measured: Vec<Vec<f64>>,
    /// The variance of the measured noise, one per joint.
    pub noise: Vec<f64>,
    /// The time between rows, one per recording (s).
    pub seconds: Vec<f64>,
    /// Whether a recording is fitted.
    pub fitted: Vec<bool>,
}

impl Data {
    /// Filters `inputs` and evaluates `arm`, with the known effects, along them.
    ///
    /// # Errors
    /// [`DiagnosisError`], if a known effect does not fit the arm.
    pub fn new(arm: &Arm, inputs: &[input::Input<'_>], options: &Options) -> Result<Self, DiagnosisError> {
        let known = known::Known::new(arm, &options.known)?;
        let arm = &known.arm;
        let mut motions = cutoff::filtered(inputs, options.cutoff, arm);
        let measured: Vec<Vec<f64>> = (0..motions.dof)
            .map(|joint| {
                let chunks = motions.chunks.iter();
                chunks.flat_map(|chunk| chunk.filter(&chunk.tau[joint])).collect()
            })
            .collect();
        let torque = measure::deviations(&motions);
        let mut recorded = known.take_off(&mut motions);
        let offset = vec![0.0; arm.dof()];
        let nominal = arm.inertial_parameters();
        let chunks = motions.chunks.par_iter();
        let rigid: Vec<rigid::Rigid> = chunks
            .map(|chunk| rigid::Rigid::new(arm, &nominal, &offset, chunk))
            .collect();
        let mut scales = measure::scales(&motions, torque);
        known.take_off_commanded(&mut motions, &recorded, &rigid, &scales);
        // A channel is judged as it was recorded: what known effects leave of it may be noise.
        let mut exchange = |motions: &mut motion::Motions| {
            for (chunk, tau) in motions.chunks.iter_mut().zip(&mut recorded) {
                std::mem::swap(&mut chunk.tau, tau);
            }
        };
        exchange(&mut motions);
        let without = channels::without_torque(inputs, &motions, &rigid, &scales);
        exchange(&mut motions);
        for (joint, why) in without {
            scales.torque[joint] = 0.0;
            motions.remarks.push(why.remark(&arm.joints()[joint].name));
        }
        let fitted: Vec<bool> = motions.sources.iter().map(|source| !source.held_out).collect();
        Ok(Self {
            seconds: measure::seconds(&motions),
            noise: measure::noise(&motions, &rigid, &fitted),
            arm: known.arm,
            motions,
            rigid,
            scales,
            measured,
            fitted,
        })
    }
}
