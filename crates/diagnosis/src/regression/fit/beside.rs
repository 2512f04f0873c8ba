//! Residuals beside corrections that only the recordings of the residuals have.

use nalgebra::{SMatrix, SVector};

use super::{Fit, Products};
use crate::regression::table::Table;

impl Products {
    /// The residual sums of squares `rss` of `fit` on each joint, less what the joint's `corrections` explain of them: columns with the
    /// standard deviations of their coefficients.
    pub fn rss_beside<const N: usize>(
        &self,
        table: &Table,
        (fit, rss): (&Fit, &[f64]),
        corrections: &[Option<[(usize, f64); N]>],
    ) -> Vec<f64> {
        let beside = |joint: usize| -> Option<f64> {
            let (gram, place) = (&self.gram[joint], &table.place[joint]);
            let own = corrections[joint].as_ref()?;
            let places: Vec<usize> = own.iter().filter_map(|&(column, _)| place[column]).collect();
            let places: [usize; N] = places.try_into().ok()?;
            // A row's weight is that of its share of the evidence.
            let ridge = self.variance(joint, rss[joint]) / self.evidence_per_row(joint).max(1e-300);
            let matrix = SMatrix::<f64, N, N>::from_fn(|i, k| {
                let prior = if i == k { ridge / own[i].1.powi(2) } else { 0.0 };
                gram.of(places[i], places[k]) + prior
            });
            let right = SVector::<f64, N>::from_fn(|i, _| {
                let fitted = fit.columns.iter().zip(&fit.coefficients);
                let fitted = fitted.filter_map(|(&column, value)| Some(value * gram.of(places[i], place[column]?)));
                gram.with_y(places[i]) - fitted.sum::<f64>()
            });
            Some(rss[joint] - right.dot(&matrix.cholesky()?.solve(&right)))
        };
        (0..rss.len()).map(|joint| beside(joint).unwrap_or(rss[joint])).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use effects::Term;
    use effects::laws::{SIGN, VELOCITY};
    use nalgebra::{DMatrix, DVector};

    use super::{Fit, Products, Table};
    use crate::regression::table::Stretch;

    /// The residual beside corrections is that of a ridge regression on the rows, whose ridges are the inverse prior variances.
    #[test]
    fn what_corrections_explain_is_what_a_ridge_regression_on_the_rows_explains() {
        let time = (0..400).map(|row| 0.02 * f64::from(row));
        let speed: Vec<f64> = time.map(|t| (2.1 * t).sin() + 0.4 * (3.3 * t).cos()).collect();
        let sign: Vec<f64> = speed.iter().map(|speed| speed.signum()).collect();
        let x = [sign, speed].map(Arc::new);
        let y: Vec<f64> = (0..x[0].len())
            .map(|row| 1.3 * x[0][row] + 0.9 * x[1][row] + 0.3 * (f64::from(row as u32) * 0.7).sin())
            .collect();
        let rows = 0..y.len();
        let mut stretches = Stretch::of(std::slice::from_ref(&rows), &[0], &[true], &[false], &vec![true; y.len()]);
        stretches[0].refresh(&x, &y, &[false, true]);
        let mut table = Table::bare([&SIGN, &VELOCITY].map(|law| Term::on(law, 0)).to_vec(), 1);
        table.rows.push(rows);
        table.joints[0].x = x.to_vec();
        table.joints[0].count = vec![y.len()];
        table.joints[0].stretches = stretches;
        let held = Products::new(&table, |_| true, &[0.02], &[0.4], &[1e-4]);
        // A fit to other recordings, in which friction is smaller.
        let fit = Fit { coefficients: vec![1.0, 0.5], ..held.solve(&table, &[0, 1], &[1.0]) };
        let rss = held.rss(&table, &fit.columns, &fit.coefficients);
        let deviations = [0.2, 0.1];
        let corrections = [Some([(0, deviations[0]), (1, deviations[1])])];
        let beside = held.rss_beside(&table, (&fit, &rss), &corrections)[0];

        let design = DMatrix::from_fn(y.len(), 2, |row, column| x[column][row]);
        let residual = DVector::from_fn(y.len(), |row, _| y[row] - x[0][row] - 0.5 * x[1][row]);
        let variance = (residual.norm_squared() / y.len() as f64 + 1e-4) / held.evidence_per_row(0);
        let ridge = DMatrix::from_diagonal(&DVector::from_iterator(2, deviations.map(|s| variance / (s * s))));
        let right = design.transpose() * &residual;
        let normal = design.transpose() * &design + ridge;
        let explained = right.dot(&normal.cholesky().expect("it is positive definite").solve(&right));
        assert!((rss[0] - residual.norm_squared()).abs() < 1e-9 * rss[0], "{rss:?}");
        assert!(
            (beside - (rss[0] - explained)).abs() < 1e-9 * rss[0],
            "{beside} instead of {} of {rss:?}",
            rss[0] - explained
        );
        // Without corrections, nothing is explained.
        assert_eq!(held.rss_beside::<2>(&table, (&fit, &rss), &[None]), rss);
    }
}
