//! Weighted least squares on inner products, all joints together.

use std::sync::{Arc, Mutex};

use nalgebra::{Cholesky, DMatrix, DVector};

use crate::regression::background::Background;
use crate::regression::table::{Gram, JointTable, Table};
use crate::thresholds::{EVIDENCE_PER_PERIOD, EVIDENCE_RATE, MOST_EVIDENCE_RATE};

mod added;
mod beside;
mod eliminated;
mod joined;
mod left_out;

pub use added::Reduced;
use eliminated::Eliminated;
pub use left_out::{ArmLeftOut, LeftOut};

/// The ridge, relative to the diagonal, so that collinear columns share a torque.
const RIDGE: f64 = 1e-9;
/// The number of times that weights are recomputed.
const REWEIGHTINGS: usize = 3;
/// Weights that change by less than this factor are not recomputed where a background would have to be eliminated for them.
const SAME_WEIGHT: f64 = 1.25;

/// Independent pieces of evidence per second of a motion of frequency `tempo` (Hz).
pub fn evidence_rate(tempo: f64) -> f64 {
    (EVIDENCE_PER_PERIOD * tempo).clamp(EVIDENCE_RATE, MOST_EVIDENCE_RATE)
}

/// The inner products over a set of recordings.
#[derive(Clone, Debug)]
pub struct Products {
    /// One per joint.
    gram: Arc<Vec<Gram>>,
    /// Moving rows, one per joint.
    pub count: Vec<f64>,
    /// Pieces of evidence, one per joint.
    pub evidence: Vec<f64>,
    /// The variance due to noise, filtering and small errors of the model, one per joint.
    pub floor: Vec<f64>,
    /// The recordings.
    recordings: Vec<usize>,
    /// The background of every fit, in addition to the selected columns.
    background: Option<Arc<Background>>,
    /// The background eliminated at the last weights.
    eliminated: Arc<Mutex<Vec<Arc<Eliminated>>>>,
}

/// A solution.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The columns, as indices into the table, ascending: those of the background, then the selected ones.
    pub columns: Vec<usize>,
    /// The number of columns of the background.
    pub background: usize,
    /// One coefficient per column.
    pub coefficients: Vec<f64>,
    /// The residual sum of squares, one per joint.
    pub rss: Vec<f64>,
    /// The weight of each joint's rows: the reciprocal of their variance.
    pub weights: Vec<f64>,
    /// Minus the logarithm of the likelihood, plus the cost of the background (nats).
    pub loss: f64,
    /// The Cholesky factor L of the scaled normal matrix of the selected columns, with the background eliminated.
    factor: DMatrix<f64>,
    scale: Vec<f64>,
    /// L⁻¹ of the scaled right side.
    reduced: DVector<f64>,
    /// The background eliminated at these weights.
    eliminated: Option<Arc<Eliminated>>,
}

impl Fit {
    /// The coefficient of a column; zero if it is not in the fit.
    pub fn coefficient(&self, column: usize) -> f64 {
        self.columns.iter().position(|&c| c == column).map_or(0.0, |k| self.coefficients[k])
    }

    /// The coefficients of some columns; zero for those that are not in the fit.
    pub fn values(&self, columns: &[usize]) -> Vec<f64> {
        columns.iter().map(|&column| self.coefficient(column)).collect()
    }

    /// The information about the coefficients of the last `count` selected columns, that is the inverse of their covariance, if nothing
    /// is known of the other coefficients but what the recordings and the background's prior say. Beside a background, every piece of
    /// evidence counts once; without one, every row.
    pub fn information_of_last(&self, count: usize) -> DMatrix<f64> {
        // The last block of a Cholesky factor is the factor of the Schur complement of the other blocks.
        let first = self.scale.len() - count;
        let mut factor = self.factor.view((first, first), (count, count)).lower_triangle();
        for (mut row, scale) in factor.row_iter_mut().zip(&self.scale[first..]) {
            row *= *scale;
        }
        &factor * factor.transpose()
    }

    /// The selected columns, without those of the background.
    pub fn selected(&self) -> &[usize] {
        &self.columns[self.background..]
    }
}

impl Products {
    /// The products over the recordings that `selected` selects; `seconds` is the time between rows, `tempo` the frequency of
    /// each joint's motion (Hz).
    pub fn new(table: &Table, selected: impl Fn(usize) -> bool, seconds: &[f64], tempo: &[f64], floor: &[f64]) -> Self {
        let recordings: Vec<usize> = (0..table.rows.len()).filter(|&r| selected(r)).collect();
        let gram = sums(table, &recordings, vec![Gram::default(); table.dof()]);
        let over = |joint: usize, weight: &dyn Fn(usize) -> f64| -> f64 {
            recordings.iter().map(|&r| table.joints[joint].count[r] as f64 * weight(r)).sum()
        };
        Self {
            gram: Arc::new(gram),
            count: (0..table.dof()).map(|joint| over(joint, &|_| 1.0)).collect(),
            evidence: (0..table.dof())
                .map(|joint| over(joint, &|r| seconds[r] * evidence_rate(tempo[joint])))
                .collect(),
            floor: floor.to_vec(),
            recordings,
            background: None,
            eliminated: Arc::default(),
        }
    }

    /// These products, without background, of `table` after columns were added to it.
    pub fn with_columns_added(self, table: &Table) -> Self {
        let known = Arc::unwrap_or_clone(self.gram);
        let gram = sums(table, &self.recordings, known);
        Self { gram: Arc::new(gram), background: None, eliminated: Arc::default(), ..self }
    }

    /// These products with another background.
    pub fn with_background(&self, background: Option<Background>) -> Self {
        Self { background: background.map(Arc::new), eliminated: Arc::default(), ..self.clone() }
    }

    /// These products, without background, with the pieces of evidence of a joint divided by its `memory`.
    pub fn remembering(mut self, memory: &[f64]) -> Self {
        self.evidence.iter_mut().zip(memory).for_each(|(evidence, memory)| *evidence /= memory);
        self
    }

    /// Whether there is a background that corrects the model, beside the lag of the torques.
    pub fn has_background(&self) -> bool {
        self.background.as_ref().is_some_and(|background| !background.is_lag_alone)
    }

    /// The strength of friction that other recordings than the fitted ones have of their own on `joint`, in the background.
    pub fn own_friction(&self, joint: usize) -> f64 {
        self.background.as_ref().map_or(0.0, |background| background.strengths.between_recordings(joint))
    }

    /// Independent pieces of evidence per row of a joint.
    fn evidence_per_row(&self, joint: usize) -> f64 {
        self.evidence[joint] / self.count[joint].max(1.0)
    }

    /// The mean square of y on a joint.
    pub fn power(&self, joint: usize) -> f64 {
        self.gram[joint].y_square() / self.count[joint].max(1.0)
    }

    fn variance(&self, joint: usize, rss: f64) -> f64 {
        rss.max(0.0) / self.count[joint].max(1.0) + self.floor[joint]
    }

    /// Minus the logarithm of the likelihood for residual sums of squares of the joints (nats).
    pub fn loss(&self, rss: &[f64]) -> f64 {
        (0..rss.len()).map(|joint| 0.5 * self.evidence[joint] * self.variance(joint, rss[joint]).ln()).sum()
    }

    /// The loss of `fit`, which may be one to other recordings.
    pub fn loss_of(&self, table: &Table, fit: &Fit) -> f64 {
        self.loss(&self.rss(table, &fit.columns, &fit.coefficients))
    }

    /// One joint's part of [`Self::loss`].
    pub fn joint_loss(&self, joint: usize, rss: f64) -> f64 {
        0.5 * self.evidence[joint] * self.variance(joint, rss).ln()
    }

    /// The weighted inner product of two columns; `None` stands for y.
    fn product(&self, table: &Table, weights: &[f64], a: usize, b: Option<usize>) -> f64 {
        let joints = match table.terms[a].joint() {
            Some(joint) => joint..joint + 1,
            None => 0..table.dof(),
        };
        let mut sum = 0.0;
        for joint in joints {
            let Some(i) = table.place[joint][a] else { continue };
            let gram = &self.gram[joint];
            let value = match b {
                None => gram.with_y(i),
                Some(b) => match table.place[joint][b] {
                    Some(k) => gram.of(i, k),
                    None => continue,
                },
            };
            sum += weights[joint] * value;
        }
        sum
    }

    /// The residual sum of squares of `coefficients` on each joint.
    pub fn rss(&self, table: &Table, columns: &[usize], coefficients: &[f64]) -> Vec<f64> {
        (0..table.dof())
            .map(|joint| {
                let gram = &self.gram[joint];
                let mine: Vec<(usize, f64)> = columns
                    .iter()
                    .zip(coefficients)
                    .filter_map(|(&column, &value)| table.place[joint][column].map(|place| (place, value)))
                    .collect();
                let mut rss = gram.y_square();
                for &(i, a) in &mine {
                    let mut inner = -2.0 * gram.with_y(i);
                    for &(k, b) in &mine {
                        inner += gram.of(i, k) * b;
                    }
                    rss += a * inner;
                }
                rss
            })
            .collect()
    }

    /// Fits `columns` with the joints weighted by their residuals, starting with the weights `weights`.
    ///
    /// With a background that corrects the model, the weights are kept, because its elimination for other weights costs more than many fits.
    /// [`Self::reweighted`] recomputes them after a decision.
    pub fn fit(&self, table: &Table, columns: &[usize], weights: &[f64]) -> Fit {
        let mut weights = weights.to_vec();
        let mut fit = self.solve(table, columns, &weights);
        if self.has_background() {
            return fit;
        }
        for _ in 1..REWEIGHTINGS {
            weights = (0..table.dof()).map(|joint| 1.0 / self.variance(joint, fit.rss[joint])).collect();
            fit = self.solve(table, columns, &weights);
        }
        fit
    }

    /// `fit` with the joints weighted by their residuals in it.
    pub fn reweighted(&self, table: &Table, mut fit: Fit) -> Fit {
        if !self.has_background() {
            return fit;
        }
        for _ in 1..REWEIGHTINGS {
            let weights: Vec<f64> = (0..table.dof()).map(|joint| 1.0 / self.variance(joint, fit.rss[joint])).collect();
            let is_same = |(a, b): (&f64, &f64)| a.max(*b) < SAME_WEIGHT * a.min(*b);
            if weights.iter().zip(&fit.weights).all(is_same) {
                break;
            }
            fit = self.solve(table, fit.selected(), &weights);
        }
        fit
    }

    /// The weights of the joints without any explanation.
    pub fn first_weights(&self) -> Vec<f64> {
        (0..self.gram.len()).map(|joint| 1.0 / (self.power(joint) + self.floor[joint]).max(1e-300)).collect()
    }

    /// Fits `columns` with fixed weights.
    pub fn solve(&self, table: &Table, columns: &[usize], weights: &[f64]) -> Fit {
        let p = columns.len();
        let eliminated = self.eliminated(table, weights);
        if let Some(eliminated) = &eliminated {
            self.eliminate(table, eliminated, columns);
        }
        let mut matrix = DMatrix::zeros(p, p);
        let mut right = DVector::zeros(p);
        let mut row = vec![0.0; p];
        for i in 0..p {
            let eliminated = eliminated.as_deref();
            self.inner_with(table, weights, eliminated, columns[i], &columns[..=i], &mut row);
            for k in 0..=i {
                matrix[(i, k)] = row[k];
                matrix[(k, i)] = row[k];
            }
            right[i] = self.inner(table, weights, eliminated, columns[i], None);
        }
        let scale: Vec<f64> = (0..p)
            .map(|i| {
                let diagonal = match &eliminated {
                    Some(eliminated) => self.own_product(table, eliminated, columns[i]),
                    None => matrix[(i, i)],
                };
                if diagonal > 0.0 { diagonal.sqrt() } else { 1.0 }
            })
            .collect();
        for i in 0..p {
            right[i] /= scale[i];
            for k in 0..p {
                matrix[(i, k)] /= scale[i] * scale[k];
            }
        }
        let factor = cholesky(&matrix);
        let [reduced, scaled] = solved(&factor, &right);
        let mut coefficients: Vec<f64> = (0..p).map(|i| scaled[i] / scale[i]).collect();
        let mut all = columns.to_vec();
        let mut cost = 0.0;
        let mut background = 0;
        if let (Some(eliminated), Some(prior)) = (&eliminated, &self.background) {
            let own = eliminated.coefficients(self, table, columns, &coefficients);
            cost = prior.cost + eliminated.occam + 0.5 * prior.energy(&own);
            background = own.len();
            coefficients.splice(0..0, own);
            all.splice(0..0, prior.columns.iter().copied());
        }
        let rss = self.rss(table, &all, &coefficients);
        Fit {
            columns: all,
            background,
            loss: self.loss(&rss) + cost,
            coefficients,
            rss,
            weights: weights.to_vec(),
            factor,
            scale,
            reduced,
            eliminated,
        }
    }
}

/// Inner products over `recordings`, one per joint; `known` are those of the first columns.
fn sums(table: &Table, recordings: &[usize], known: Vec<Gram>) -> Vec<Gram> {
    let sum = |(this, known): (&JointTable, Gram)| {
        let selected = this.stretches.iter().filter(|stretch| recordings.contains(&stretch.recording));
        Gram::sum(known, this.x.len(), selected.map(|stretch| Arc::clone(&stretch.gram)).collect())
    };
    table.joints.iter().zip(known).map(sum).collect()
}

/// L⁻¹ b and (L Lᵀ)⁻¹ b for a lower Cholesky factor L and a right-hand side b.
fn solved(factor: &DMatrix<f64>, right: &DVector<f64>) -> [DVector<f64>; 2] {
    let none = || DVector::zeros(right.len());
    let reduced = factor.solve_lower_triangular(right).unwrap_or_else(none);
    let solution = factor.tr_solve_lower_triangular(&reduced).unwrap_or_else(none);
    [reduced, solution]
}

/// The lower Cholesky factor of a matrix with unit diagonal that is positive semidefinite up to rounding.
fn cholesky(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let p = matrix.nrows();
    let ridged = matrix + DMatrix::identity(p, p) * RIDGE;
    Cholesky::new_with_substitute(ridged, RIDGE).map_or_else(|| DMatrix::identity(p, p), Cholesky::unpack)
}
