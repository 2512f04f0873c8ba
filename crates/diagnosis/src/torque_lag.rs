//! A lag of all recorded torques behind the positions: a filter in the drives, or another clock.
//!
//! Where little accelerates, the torque of gravity that comes late is a torque along the velocities of all joints that gravity depends on.
//! It resembles viscous friction and drives that turn with two joints.

use effects::Term;
use effects::background::LAG;
use effects::drive::{ACTUATION_DELAY, LATE, LATE_SIGN, UNIT_LAG};
use nalgebra::{DMatrix, DVector};
use recording::RegularRecording;

use crate::data::input::Input;
use crate::data::statistics::NORMAL_95;
use crate::regression::table::Table;
use crate::search::problem::Selection;
use crate::selection::FinalFit;
use crate::selection::bootstrap::Resampled;
use crate::thresholds::{
    LEAST_LAG, LEAST_LAG_NATS, LEAST_LAGGING, LEAST_NOTED_LAG, MOST_OF_LAG, SURE_OF_LAG, TURNS_LATE,
};

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
        let count = joints.len();
        if count < LEAST_LAGGING {
            return None;
        }
        // Dry friction turns round over a distance, and so late, but gravity and inertia do not.
        let turns = joints.iter().flat_map(|&joint| TURNS_LATE.map(|delay| Term::on(&LATE_SIGN, joint).sized([delay])));
        let lags = joints.iter().map(|&joint| Term::on(&LATE, joint).sized([UNIT_LAG]));
        let strengths = study.strengths.without_lag();
        let (_, lagging) = study.table_and_fit_at(&strengths, &columns, turns.chain(lags).collect(), &fit.weights);
        // The column is the torque less the earlier torque, which a late torque lacks.
        let lags = -DVector::from_column_slice(&lagging.coefficients[lagging.coefficients.len() - count..]);
        let covariance = lagging.information_of_last(count).try_inverse()?;
        let mut agreeing: Vec<usize> = (0..count).collect();
        let common = loop {
            let common = Common::of(&lags, &covariance, &agreeing)?;
            if common.misfit <= MOST_OF_LAG * (common.misfit + common.explained) {
                break common;
            }
            // A joint may have a delay of its own.
            let without =
                |&joint: &usize| -> Vec<usize> { agreeing.iter().copied().filter(|&other| other != joint).collect() };
            let fewer = agreeing.iter().map(without);
            let fewer = fewer.filter_map(|fewer| Some((Common::of(&lags, &covariance, &fewer)?.misfit, fewer)));
            agreeing = fewer.min_by(|a, b| a.0.total_cmp(&b.0))?.1;
            if agreeing.len() < LEAST_LAGGING || 2 * agreeing.len() <= count {
                return None;
            }
        };
        let is_clear = |&&k: &&usize| lags[k] * common.value.signum() > SURE_OF_LAG * covariance[(k, k)].sqrt();
        let clear = agreeing.iter().filter(is_clear).count();
        let lag = Self { seconds: UNIT_LAG * common.value, half: UNIT_LAG * NORMAL_95 * common.deviation };
        // It must be seen without the joint that shows it best, because one joint alone may have any delay.
        let is_seen_without = |&joint: &usize| {
            let others: Vec<usize> = agreeing.iter().copied().filter(|&other| other != joint).collect();
            Common::of(&lags, &covariance, &others).is_some_and(|rest| {
                let agrees = rest.misfit <= MOST_OF_LAG * (rest.misfit + rest.explained);
                agrees && rest.value * common.value > 0.0 && 0.5 * rest.explained >= LEAST_LAG_NATS
            })
        };
        let is_shared = clear >= LEAST_LAGGING && 2 * clear > count && agreeing.iter().all(is_seen_without);
        (is_shared && lag.seconds.abs() >= LEAST_LAG).then_some(lag)
    }

    /// This lag of recordings from which a lag of `removed` (s) was removed, and that lag together.
    pub fn after(self, removed: f64) -> Self {
        let seconds = self.seconds + removed;
        Self { seconds, ..self }
    }

    /// A note on it.
    pub fn remark(&self) -> String {
        let [ms, half] = [1e3 * self.seconds.abs(), 1e3 * self.half];
        let way = if self.seconds > 0.0 { "later" } else { "earlier" };
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

/// The value that several estimates have in common, by generalised least squares.
struct Common {
    value: f64,
    /// Its standard deviation.
    deviation: f64,
    /// vᵀ C⁻¹ v of the estimates v with covariance C: the part that the common value explains,
    explained: f64,
    /// and the rest.
    misfit: f64,
}

impl Common {
    /// That of the estimates `chosen` among `values`; `None` if their covariance is singular.
    fn of(values: &DVector<f64>, covariance: &DMatrix<f64>, chosen: &[usize]) -> Option<Self> {
        let values = values.select_rows(chosen);
        let information = covariance.select_rows(chosen).select_columns(chosen).try_inverse()?;
        let weighted = &information * &values;
        let weight = information.sum();
        let value = weighted.sum() / weight;
        let explained = value * weighted.sum();
        Some(Self {
            value,
            deviation: weight.sqrt().recip(),
            explained,
            misfit: (values.dot(&weighted) - explained).max(0.0),
        })
    }
}

/// Recordings without a lag of their torques; none if there is no lag.
pub struct WithoutLag(Vec<RegularRecording>);

impl WithoutLag {
    /// The recordings of `inputs` without `lag` (s).
    pub fn new(inputs: &[Input<'_>], lag: f64) -> Self {
        let recordings = inputs.iter().filter(|_| lag != 0.0);
        Self(recordings.map(|input| input.recording.without_torque_lag(lag)).collect())
    }

    /// `inputs` with these recordings.
    pub fn of<'a>(&'a self, inputs: &[Input<'a>]) -> Vec<Input<'a>> {
        let of =
            |(at, input): (usize, &Input<'a>)| Input { recording: self.0.get(at).unwrap_or(input.recording), ..*input };
        inputs.iter().enumerate().map(of).collect()
    }
}
