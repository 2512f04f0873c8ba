//! The onset of an effect, and its interval.

use effects::Term;

use super::Reader;
use crate::report::Parameter;
use crate::thresholds::{MOST_OF_AN_ONSET, ONSET_INTERVAL, PUSH_START};

impl Reader<'_> {
    /// Records and returns the onset of the candidate; `None` if it always acts.
    pub(super) fn note_onset(&mut self) -> Option<f64> {
        let onset = self.study.terms(self.candidate).iter().find_map(Term::onset)?;
        // The recordings from before and those of today have no common clock, and for today's robot the effect always acts.
        if Some(onset) == self.study.data.motions.changed_at {
            return None;
        }
        let (value, ci95) = self.likeliest_onset(onset);
        let parameter = Parameter { value, ci95, unit: "s" };
        self.parameters.insert("onset", parameter);
        Some(value)
    }

    /// Records the start of a contact of a `duration` (s).
    pub(super) fn note_start(&mut self, start: f64, duration: f64) {
        let half = PUSH_START * duration;
        let parameter = Parameter { value: start, ci95: [start - half, start + half], unit: "s" };
        self.parameters.insert("start", parameter);
    }

    /// The most likely onset (s), and the interval of times at which the fit is not clearly worse, by all rows including those
    /// near reversals, with the sizes found from `near` on. With an earlier or a later onset, the effect's torque on the rows
    /// between would be added wrongly or remain in the residual. Where there is no such torque, at rest or between recordings,
    /// the time is undetermined.
    fn likeliest_onset(&self, near: f64) -> (f64, [f64; 2]) {
        let study = self.study;
        let table = &study.table;
        let fitted = study.training_products();
        let columns = &study.candidates[self.candidate].columns;
        let value = |column: usize| self.resampled.column(column).map(|at| self.resampled.estimate[at]);
        // Its torque if it always acted.
        let (terms, sizes): (Vec<Term>, Vec<f64>) =
            columns.iter().filter_map(|&column| Some((table.terms[column].always(), value(column)?))).unzip();
        // The study's table has such columns for some forms only.
        let always = study.table_of(terms);
        let places: Vec<usize> = (0..sizes.len()).collect();
        let all = &self.resampled.columns;
        let model = &self.resampled.estimate[..all.len()];
        let joints: Vec<(usize, Vec<f64>, Vec<f64>, f64)> = (0..table.dof())
            .filter(|&joint| fitted.count[joint] > 0.0)
            .map(|joint| {
                let residual = table.residual(joint, all, model);
                let rows = table.moving_rows(joint, &study.data.fitted);
                let power = rows.iter().map(|&row| residual[row].powi(2)).sum::<f64>() / rows.len().max(1) as f64;
                let evidence = fitted.evidence[joint] / fitted.count[joint];
                let weight = 0.5 * evidence / power.max(fitted.floor[joint]).max(1e-300);
                (joint, always.torque(joint, &places, &sizes), residual, weight)
            })
            .collect();
        // The increase of a row's misfit (nats) if the effect also acts on it (−1), or does not (1).
        let growth = |row: usize, sign: f64| -> f64 {
            let acting = joints.iter().filter(|(joint, ..)| table.joints[*joint].moving[row]);
            acting
                .map(|(_, torque, residual, weight)| weight * torque[row] * (2.0 * sign * residual[row] + torque[row]))
                .sum()
        };
        let times = study.data.motions.row_times();
        let mut rows: Vec<usize> = table.rows_of(|recording| study.data.fitted[recording]);
        rows.sort_by(|&a, &b| times[a].total_cmp(&times[b]));
        let now = rows.partition_point(|&row| times[row] < near);
        // The misfit if it acts from the k-th row on.
        let mut misfit = vec![0.0; rows.len() + 1];
        for k in (0..now).rev() {
            misfit[k] = misfit[k + 1] + growth(rows[k], -1.0);
        }
        for k in now..rows.len() {
            misfit[k + 1] = misfit[k] + growth(rows[k], 1.0);
        }
        let inner = 1..rows.len().max(2);
        let best = inner.clone().min_by(|&a, &b| misfit[a].total_cmp(&misfit[b])).unwrap_or(now);
        let is_near = |k: &usize| misfit[*k] < misfit[best] + ONSET_INTERVAL;
        let first = (1..=best).rev().take_while(is_near).last().unwrap_or(best);
        let last = (best..rows.len()).take_while(is_near).last().unwrap_or(best);
        let time = |k: usize| rows.get(k).map_or(near, |&row| times[row]);
        let likeliest = if best == now { near } else { time(best) };
        (likeliest, [time(first.saturating_sub(1)).min(likeliest), time(last).max(likeliest)])
    }
}

/// Whether the interval of an onset (s) contains so many of the rows on which the effect's joints move, which have these `times`, that it
/// does not set in within them.
pub fn is_anywhere([first, last]: [f64; 2], times: &[f64]) -> bool {
    let within = times.iter().filter(|time| (first..=last).contains(*time)).count();
    within as f64 > MOST_OF_AN_ONSET * times.len() as f64
}

#[cfg(test)]
mod tests {
    use super::is_anywhere;

    /// An hour between two recordings contains no rows: an onset within it has a place.
    #[test]
    fn an_onset_between_recordings_is_located_and_one_at_any_row_is_not() {
        let times: Vec<f64> = (0..100).chain(3700..3800).map(f64::from).collect();
        for (onset, anywhere) in
            [([98.0, 3701.0], false), ([0.0, 90.0], false), ([0.0, 3799.0], true), ([0.2, 3703.0], true)]
        {
            assert_eq!(is_anywhere(onset, &times), anywhere, "{onset:?}");
        }
    }
}
