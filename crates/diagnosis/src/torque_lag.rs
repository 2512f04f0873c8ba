//! A lag of all recorded torques behind the positions: a filter in the drives, or another clock.
//!
//! Where little accelerates, the torque of gravity that comes late is a torque along the velocities of all joints that gravity depends on.
//! It resembles viscous friction and drives that turn with two joints.

mod agreement;
mod own;

use effects::Term;
use effects::background::LAG;
use effects::drive::{ACTUATION_DELAY, LATE, LATE_SIGN, UNIT_LAG};
use nalgebra::DVector;
use recording::RegularRecording;

use self::agreement::Common;
use crate::data::input::Input;
use crate::data::statistics::NORMAL_95;
use crate::regression::fit::Fit;
use crate::regression::table::Table;
use crate::report::Report;
use crate::search::problem::Selection;
use crate::selection::FinalFit;
use crate::selection::bootstrap::Resampled;
use crate::thresholds::{LEAST_LAG, LEAST_LAG_NATS, LEAST_LAGGING, LEAST_NOTED_LAG, SURE_OF_LAG, TURNS_LATE};

pub use own::remark_on_own;

/// A lag that the torques of all joints have in common.
#[derive(Clone, Copy, Debug)]
pub struct TorqueLag {
    /// The lag (s); negative if the torques are ahead of the positions.
    pub seconds: f64,
    /// Half the 95 % interval (s).
    half: f64,
}

impl TorqueLag {
    /// The lag that the residuals of a fit have in common, if the joints agree on it. Delays that are named on joints may be parts of
    /// it and are left out of the fit.
    pub fn of(Lagging { joints, fit: lagging, .. }: &Lagging) -> Option<Self> {
        let count = joints.len();
        // The column is the torque less the earlier torque, which a late torque lacks.
        let lags = -DVector::from_column_slice(&lagging.coefficients[lagging.coefficients.len() - count..]);
        let covariance = lagging.information_of_last(count).try_inverse()?;
        let (common, agreeing) = Common::of_most(&lags, &covariance)?;
        let is_clear = |&&k: &&usize| lags[k] * common.value.signum() > SURE_OF_LAG * covariance[(k, k)].sqrt();
        let clear = agreeing.iter().filter(is_clear).count();
        let lag = Self { seconds: UNIT_LAG * common.value, half: UNIT_LAG * NORMAL_95 * common.deviation };
        let is_seen = common.is_seen_without_each(&lags, &covariance, &agreeing, LEAST_LAG_NATS);
        let is_shared = clear >= LEAST_LAGGING && 2 * clear > count && is_seen;
        (is_shared && lag.seconds.abs() >= LEAST_LAG).then_some(lag)
    }

    /// A note on a lag of `seconds`, of which this is the last part that was found.
    pub fn remark(&self, seconds: f64) -> String {
        let [ms, half] = [1e3 * seconds.abs(), 1e3 * self.half];
        let way = if seconds > 0.0 { "later" } else { "earlier" };
        format!(
            "the torques of all joints were recorded {ms:.1} ± {half:.1} ms {way} than the positions, as after a filter or on another clock; \
             they are compared without this lag (--torque-lag 0 compares them as they were recorded)"
        )
    }
}

/// A note on the lag that is a part of the background, if it is clear.
pub fn note_on_short(table: &Table, resampled: &Resampled) -> Option<String> {
    let lag = table.terms.iter().position(|term| term.is(&LAG))?;
    let place = resampled.column(lag)?;
    let (value, [low, high]) = resampled.interval_within(0.0, |draw| draw[place]);
    let is_clear = value.abs() >= LEAST_NOTED_LAG && low * high > 0.0;
    is_clear.then(|| {
        let [ms, half] = [1e3 * value.abs(), 500.0 * (high - low)];
        let (way, cause) = if value > 0.0 {
            ("later", "behind a filter, or on another clock")
        } else {
            ("earlier", "where a controller holds for a period the torque that is recorded")
        };
        format!(
            "the torques of all joints are {ms:.1} ± {half:.1} ms {way} than the positions, in addition to any lag that was removed, as \
             {cause}; every size allows for it, and the corrected model does not contain it"
        )
    })
}

/// The fit of a pass with a lag of the torque of each joint in addition.
pub struct Lagging {
    /// The joints.
    joints: Vec<usize>,
    /// The columns: the last ones are [`LATE`] on each of the joints.
    table: Table,
    fit: Fit,
}

impl Lagging {
    /// Delays that are named on joints may be parts of a lag and are left out of the fit. `None` if too few joints move.
    pub fn of(last: &FinalFit) -> Option<Self> {
        let (study, Selection { fit, set, .. }) = (&last.study, &last.judged.named);
        let delays = set.iter().map(|&c| &study.candidates[c]);
        let delays: Vec<usize> = delays
            .filter(|candidate| candidate.hypothesis.is(&ACTUATION_DELAY))
            .flat_map(|candidate| candidate.columns.iter().copied())
            .collect();
        let columns: Vec<usize> = fit.selected().iter().copied().filter(|column| !delays.contains(column)).collect();
        let joints = (0..study.data.motions.dof)
            .filter(|&joint| study.data.scales.moves(joint) && study.data.scales.torque[joint] > 0.0);
        let joints: Vec<usize> = joints.collect();
        if joints.len() < LEAST_LAGGING {
            return None;
        }
        // Dry friction turns round over a distance, and so late, but gravity and inertia do not.
        let turns = joints.iter().flat_map(|&joint| TURNS_LATE.map(|delay| Term::on(&LATE_SIGN, joint).sized([delay])));
        let lags = joints.iter().map(|&joint| Term::on(&LATE, joint).sized([UNIT_LAG]));
        let strengths = study.strengths.without_lag();
        let (table, fit) = study.table_and_fit_at(&strengths, &columns, turns.chain(lags).collect(), &fit.weights);
        Some(Self { joints, table, fit })
    }
}

/// The lags of the torques behind the positions that are removed from recordings (s).
#[derive(Clone, Debug, Default)]
pub struct Lags {
    /// That of all recordings.
    pub common: f64,
    /// What each recording has in addition; empty if none has.
    pub own: Vec<f64>,
}

impl Lags {
    /// The lag of a recording.
    fn of(&self, recording: usize) -> f64 {
        self.common + self.own.get(recording).copied().unwrap_or(0.0)
    }
}

/// Recordings without a lag of their torques; none if there is no lag.
pub struct WithoutLag(Vec<RegularRecording>);

impl WithoutLag {
    /// The recordings of `inputs` without these lags.
    pub fn new(inputs: &[Input<'_>], lags: &Lags) -> Self {
        let without = |(at, input): (usize, &Input<'_>)| match lags.of(at) {
            0.0 => input.recording.clone(),
            lag => input.recording.without_torque_lag(lag),
        };
        let some = (0..inputs.len()).any(|at| lags.of(at) != 0.0);
        Self(inputs.iter().enumerate().filter(|_| some).map(without).collect())
    }

    /// The recordings of `inputs` without the lags that their diagnosis removed.
    pub fn of_report(inputs: &[Input<'_>], report: &Report) -> Self {
        let own = |input: &Input<'_>| report.own_torque_lags.get(input.name).copied().unwrap_or(0.0);
        let own = inputs.iter().map(own).collect();
        Self::new(inputs, &Lags { common: report.torque_lag.unwrap_or(0.0), own })
    }

    /// `inputs` with these recordings.
    pub fn of<'a>(&'a self, inputs: &[Input<'a>]) -> Vec<Input<'a>> {
        let of =
            |(at, input): (usize, &Input<'a>)| Input { recording: self.0.get(at).unwrap_or(input.recording), ..*input };
        inputs.iter().enumerate().map(of).collect()
    }
}
