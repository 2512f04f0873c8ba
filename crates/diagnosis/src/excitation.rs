//! The motion of the first recording: the one from which inertial parameters and friction can be estimated best, within limits.
//!
//! A finite Fourier series per joint (Swevers, Ganseman, Tükel, De Schutter and Van Brussel 1997, Optimal Robot Excitation and
//! Identification) whose coefficients maximise the determinant of the information matrix of the base parameters (D-optimality) and
//! keep the condition number of the base regressor small.

use arm::{Arm, Workspace};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use thiserror::Error;
use torque::Reference;

mod base;
mod bounds;
mod criterion;
mod fourier;
mod naive;
mod search;

pub use base::Determined;
pub use bounds::{JointUse, MotionLimits};

use base::Base;
use bounds::Allowed;
use criterion::Criterion;
use fourier::Series;

use crate::data::cutoff::filtered;
use crate::data::input::Input;
use crate::next::designs::DURATION;

/// The rate at which a motion is checked against the limits (Hz).
const FINE: f64 = 500.0;
/// The rate at which the starts of the search are checked against the limits (Hz).
const COARSE: f64 = 25.0;
/// The random starts of the search.
const STARTS: usize = 3;
/// The longest period (s); a longer motion repeats its period.
const LONGEST_PERIOD: f64 = 37.5;
/// The highest frequency of a motion (Hz), within the numbers of harmonics.
const HIGHEST: f64 = 0.8;
/// The fewest and the most harmonics of a period.
const HARMONICS: (usize, usize) = (5, 20);
/// The number of times that a motion is scaled down to bring it within the limits before the search fails.
const SHRUNK: usize = 400;

/// The request for a motion.
#[derive(Clone, Copy, Debug)]
pub struct ExcitationOptions {
    /// The duration of the motion (s).
    pub duration: f64,
    /// The seed of the search's starts.
    pub seed: u64,
}

/// A motion, the parameters that it determines, and its demands on the joints.
#[derive(Clone, Debug)]
pub struct Excitation {
    /// The motion: periodic, at rest at its start and at its end.
    pub reference: Reference,
    /// Its duration (s).
    pub duration: f64,
    /// The period of the series (s).
    pub period: f64,
    /// The harmonics of the series.
    pub harmonics: usize,
    /// The number of parameters that can be determined at all, by kind.
    pub determined: Determined,
    /// How well this motion determines them.
    pub quality: Quality,
    /// How well a motion with one sine per joint determines them, within the same limits; `None` if there is no such motion.
    pub naive: Option<Quality>,
    /// The position, velocity and torque that the motion needs of every joint, and the allowed values.
    pub needed: Vec<JointUse>,
}

/// How well a motion determines the base parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// The condition number of the base regressor, with the columns of friction and drive inertia: the rows of all joints as they
    /// are (N m or N per SI unit of the parameters).
    pub condition: f64,
    /// The condition number with all columns scaled to the same norm, so that it does not depend on the parameters' units.
    pub scaled_condition: f64,
    /// The geometric mean of the parameters' standard deviations relative to those of the proposed motion (1 for it), for equal
    /// durations and torque errors in proportion to the joints' torque limits.
    pub deviation: f64,
}

/// Why there is no motion.
#[derive(Debug, Error)]
pub enum ExcitationError {
    /// A joint without a limit that is needed.
    #[error("joint \"{joint}\" has no {what} limit")]
    Unlimited {
        /// The joint.
        joint: String,
        /// `position` or `velocity`.
        what: &'static str,
    },
    /// Limits that leave no room between them.
    #[error("joint \"{joint}\": its {what} limit {value} leaves no room for a motion")]
    NoRoom {
        /// The joint.
        joint: String,
        /// The quantity, such as `position` or `velocity`.
        what: &'static str,
        /// The limits as given.
        value: String,
    },
    /// The arm cannot hold its own weight.
    #[error("joint \"{joint}\": holding the arm needs {torque:.3} of the {allowed:.3} N m or N that are allowed")]
    TooWeak {
        /// The joint.
        joint: String,
        /// The torque that it needs at the middle of the motion (N m or N).
        torque: f64,
        /// The allowed torque (N m or N).
        allowed: f64,
    },
    /// The search failed.
    #[error("the search for a motion failed: {0}")]
    Search(String),
}

/// The motion of `arm` from which its base parameters, friction and drive inertias can be estimated best, within `limits` (one
/// per joint). `progress` receives the completed part, from 0 to 1.
///
/// The result depends on the arguments only, not on the number of threads.
///
/// # Errors
/// [`ExcitationError`], if a limit is missing or leaves no room.
pub fn excite(
    arm: &Arm,
    limits: &[MotionLimits],
    options: &ExcitationOptions,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Excitation, ExcitationError> {
    let allowed = Allowed::new(arm, limits)?;
    let repeats = (options.duration / LONGEST_PERIOD).ceil().max(1.0);
    let period = options.duration / repeats;
    let harmonics = ((HIGHEST * period) as usize).clamp(HARMONICS.0, HARMONICS.1);
    let series = Series::new(&allowed, harmonics, period);
    let base = Base::new(arm, &allowed);
    let criterion = Criterion::new(arm, &base, &allowed, &series);
    let mut random = ChaCha8Rng::seed_from_u64(options.seed);
    let starts: Vec<Vec<f64>> = (0..STARTS)
        .map(|_| {
            let centre = allowed.holdable(arm, &mut random)?;
            let mut start: Vec<f64> = (0..series.len()).map(|_| random.random_range(-1.0..1.0)).collect();
            series.start(&mut start, &centre);
            shrunk(arm, &allowed, &series, start, COARSE).map(|(start, _)| start)
        })
        .collect::<Result<_, _>>()?;
    let best = search::best(&criterion, starts, progress).map_err(ExcitationError::Search)?;
    let (found, needed) = shrunk(arm, &allowed, &series, best, FINE)?;
    let reference = series.reference(&found);
    let measured = base.measure(arm, &reference, period);
    let naive = naive::motion(arm, &allowed).map(|motion| base.measure(arm, &motion, DURATION));
    Ok(Excitation {
        reference,
        duration: options.duration,
        period,
        harmonics,
        determined: base.determined(arm),
        quality: measured.quality(&measured),
        naive: naive.map(|naive| naive.quality(&measured)),
        needed,
    })
}

/// How well the motion of `inputs`, after the diagnosis' filter, determines the base parameters of `arm`, relative to the
/// motion `proposed` for `limits`.
///
/// # Errors
/// If `limits` leave no room.
pub fn quality_of(
    arm: &Arm,
    limits: &[MotionLimits],
    proposed: &Excitation,
    inputs: &[Input<'_>],
) -> Result<Quality, ExcitationError> {
    let allowed = Allowed::new(arm, limits)?;
    let base = Base::new(arm, &allowed);
    let motions = filtered(inputs, None, arm);
    let samples = motions.chunks.iter().flat_map(|chunk| {
        (0..chunk.ticks()).map(|tick| {
            [&chunk.q, &chunk.qd, &chunk.qdd].map(|signal| signal.iter().map(|values| values[tick]).collect())
        })
    });
    let measured = base.sum(arm, samples);
    Ok(measured.quality(&base.measure(arm, &proposed.reference, proposed.period)))
}

/// Scales the coefficients down until the motion is within what is allowed, checked at `hertz`; returns the demands of the
/// motion. Position, velocity and acceleration scale one joint's amplitude, torque scales all amplitudes.
fn shrunk(
    arm: &Arm,
    allowed: &Allowed,
    series: &Series,
    mut coefficients: Vec<f64>,
    hertz: f64,
) -> Result<(Vec<f64>, Vec<JointUse>), ExcitationError> {
    let mut workspace = Workspace::new(arm);
    for _ in 0..SHRUNK {
        let reference = series.reference(&coefficients);
        let needed = allowed.needed(arm, &mut workspace, &reference, series.period, hertz);
        let mut is_within = true;
        for (joint, needed) in needed.iter().enumerate() {
            let beyond = needed.beyond_motion(series.centre(&coefficients, joint));
            if beyond > 1.0 {
                series.shrink(&mut coefficients, joint, 1.0 / beyond - 1e-12);
                is_within = false;
            }
        }
        if !is_within {
            continue;
        }
        let strongest = needed.iter().map(|needed| needed.limits.torque / needed.limits.torque_allowed);
        let strongest = strongest.fold(0.0, f64::max);
        if strongest <= 1.0 {
            return Ok((coefficients, needed));
        }
        for joint in 0..arm.dof() {
            series.shrink(&mut coefficients, joint, (1.0 / strongest).clamp(0.8, 0.998));
        }
    }
    let centre: Vec<f64> = (0..arm.dof()).map(|joint| series.centre(&coefficients, joint)).collect();
    Err(allowed.too_weak(arm, &mut workspace, &centre))
}
