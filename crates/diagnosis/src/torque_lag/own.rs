//! Lags of the torques of single recordings, as of logs that were put together from two clocks.

use std::collections::BTreeMap;

use effects::Term;
use effects::drive::{LATE, UNIT_LAG};
use effects::laws::{SIGN, VELOCITY};
use nalgebra::{DMatrix, DVector};

use super::Lagging;
use super::agreement::Common;
use crate::data::input::Input;
use crate::data::statistics::{mean_square, median};
use crate::selection::FinalFit;
use crate::thresholds::{LEAST_LAGGING, LEAST_MORE_OWN_LAG, LEAST_OWN_LAG, LEAST_OWN_LAG_NATS, LEAST_WITH_OWN_LAG};
use crate::words::late;

/// The lag of a recording beyond that of the fit.
struct Residual {
    common: Common,
    /// Whether it is seen without each of the joints that agree on it.
    is_seen: bool,
}

impl Lagging {
    /// The lags (s) that single recordings have beyond that of most others, in addition to those that were `removed` from them, one per
    /// recording; `None` if no recording has another one.
    pub fn own_lags(&self, last: &FinalFit, removed: &[f64]) -> Option<Vec<f64>> {
        let recordings = last.study.data.motions.sources.len();
        let all: Vec<Option<Residual>> = (0..recordings).map(|recording| self.common_in(last, recording)).collect();
        let known: Vec<f64> = all.iter().flatten().map(|lag| lag.common.value).collect();
        if known.len() < LEAST_WITH_OWN_LAG {
            // Of two recordings, none is the usual one.
            return None;
        }
        let usual = median(known.clone());
        let as_usual = known.iter().filter(|&&lag| UNIT_LAG * (lag - usual).abs() < LEAST_OWN_LAG).count();
        if 2 * as_usual <= known.len() {
            return None;
        }
        let own = |(recording, lag): (usize, &Option<Residual>)| {
            let Some(Residual { common, .. }) = lag.as_ref().filter(|lag| lag.is_seen) else { return 0.0 };
            let lag = UNIT_LAG * (common.value - usual);
            let has_some = removed.get(recording).is_some_and(|removed| *removed != 0.0);
            let least = if has_some { LEAST_MORE_OWN_LAG } else { LEAST_OWN_LAG };
            let nats = 0.5 * ((common.value - usual) / common.deviation).powi(2);
            if lag.abs() >= least && nats >= LEAST_OWN_LAG_NATS { lag } else { 0.0 }
        };
        let own: Vec<f64> = all.iter().enumerate().map(own).collect();
        own.iter().any(|lag| *lag != 0.0).then_some(own)
    }

    /// The lag (in [`UNIT_LAG`]) beyond that of the fit that the residuals of most joints show in a recording, if they agree on one.
    fn common_in(&self, last: &FinalFit, recording: usize) -> Option<Residual> {
        let of = |&joint: &usize| self.of_joint(last, recording, joint);
        let (lags, variances): (Vec<f64>, Vec<f64>) = self.joints.iter().filter_map(of).unzip();
        let (lags, covariance) = (DVector::from_vec(lags), DMatrix::from_diagonal(&DVector::from_vec(variances)));
        let (common, agreeing) = Common::of_most(&lags, &covariance)?;
        let are_enough = agreeing.len() >= LEAST_LAGGING && 2 * agreeing.len() > self.joints.len();
        are_enough.then_some(Residual {
            is_seen: common.is_seen_without_each(&lags, &covariance, &agreeing, LEAST_OWN_LAG_NATS),
            common,
        })
    }

    /// The lag of a joint in a recording and its variance: the residual regressed on the torque's change, beside friction of the
    /// recording's own.
    fn of_joint(&self, last: &FinalFit, recording: usize, joint: usize) -> Option<(f64, f64)> {
        let data = &last.study.data;
        let moving = &self.table.joints[joint].moving;
        let rows: Vec<usize> = self.table.rows[recording].clone().filter(|&row| moving[row]).collect();
        let column = |term: Term| self.table.terms.iter().position(|known| *known == term);
        let late = column(Term::on(&LATE, joint).sized([UNIT_LAG]))?;
        // Also friction that has no name.
        let all = &last.study.table;
        let friction = [&SIGN, &VELOCITY].into_iter().filter_map(|law| {
            let column = all.terms.iter().position(|known| *known == Term::on(law, joint))?;
            Some(all.torque(joint, &[column], &[1.0]))
        });
        let columns: Vec<Vec<f64>> = [self.table.torque(joint, &[late], &[1.0])].into_iter().chain(friction).collect();
        let residual = self.table.residual(joint, &self.fit.columns, &self.fit.coefficients);
        if rows.len() <= columns.len() {
            return None;
        }
        let x = DMatrix::from_fn(rows.len(), columns.len(), |k, column| columns[column][rows[k]]);
        let y = DVector::from_iterator(rows.len(), rows.iter().map(|&row| residual[row]));
        let inverse = (x.transpose() * &x).try_inverse()?;
        let solution = &inverse * x.transpose() * &y;
        let rest = &y - &x * &solution;
        // Filtered rows that are closer than half the period of the cut-off are not independent.
        let dependent = (0.5 / (data.motions.cutoff * data.seconds[recording])).max(1.0);
        let variance = mean_square(rest.iter().copied()) * dependent * inverse[(0, 0)];
        // The column is the torque less the earlier torque, which a late torque lacks.
        (variance > 0.0).then_some((-solution[0], variance))
    }
}

/// A note on the lags of single recordings.
pub fn remark_on_own(inputs: &[Input<'_>], own: &BTreeMap<String, f64>) -> Option<String> {
    let named = inputs.iter().filter_map(|input| Some((input.name, own.get(input.name)?)));
    let list: Vec<String> = named.map(|(name, lag)| format!("{name}: {}", late(*lag))).collect();
    (!list.is_empty()).then(|| {
        format!(
            "the torques of single recordings were recorded later or earlier than in the others, as on another clock ({}); they are compared \
             without this difference (--torque-lag 0 compares them as they were recorded)",
            list.join(", ")
        )
    })
}
