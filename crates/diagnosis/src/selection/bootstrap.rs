//! Intervals by resampling: each draw fits the data with random weights on blocks of time (Rubin 1981, The Bayesian
//! bootstrap). All blocks have a positive weight, so that rows of a short event, such as a contact, always count.

use effects::background::{FRICTION_CURVE, GAIN as GAIN_LAW, OFFSET, OWN_FRICTION};
use effects::laws::RIGID;
use effects::{Size, Term};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::data::statistics::{NORMAL_95, quantile_of_sorted};
use crate::regression::table::SharedColumn;
use crate::search::problem::Selection;
use crate::search::refine::{sizes, varied};
use crate::search::study::Study;
use crate::thresholds::{
    BLOCK, DRAWS, INFLATION, INFLATION_IN_DRIVES, LARGEST_CORRECTION, MOST_BLOCKS, UNEVEN, UNEVEN_WITH_SPEED,
};

/// The relative step of a derivative by a size.
const STEP: f64 = 0.02;

/// The resampled coefficients, and the relative corrections of the sizes on which columns depend nonlinearly.
#[derive(Clone, Debug)]
pub struct Resampled {
    /// The columns of the fit.
    pub columns: Vec<usize>,
    /// The estimate of each coefficient, then of each correction of a size.
    pub estimate: Vec<f64>,
    /// The coefficients and corrections of each draw.
    pub draws: Vec<Vec<f64>>,
    /// The draws for a background whose strength is the same in all directions.
    even: Vec<Vec<f64>>,
    /// The candidate and the size of each correction, in order.
    pub sizes: Vec<(usize, Size)>,
    /// The factor on the standard deviation of the draws.
    inflation: f64,
    /// The estimate and the draws, in the same order, for another background that explains nearly as much.
    other: Option<Box<Self>>,
}

impl Resampled {
    /// The estimate and the 95 % interval of a function of the parameters. `systematic` is the part of the value by which
    /// resampling underestimates the error. The interval also holds that of the other background.
    pub fn interval_within(&self, systematic: f64, f: impl Fn(&[f64]) -> f64) -> (f64, [f64; 2]) {
        let (value, [low, high]) = self.own_interval(systematic, &f);
        let other = self.other.as_ref().map(|other| other.own_interval(systematic, &f).1);
        let [other_low, other_high] = other.unwrap_or([low, high]);
        (value, [low.min(other_low), high.max(other_high)])
    }

    /// The estimate and the interval for this background alone.
    fn own_interval(&self, systematic: f64, f: &impl Fn(&[f64]) -> f64) -> (f64, [f64; 2]) {
        let value = f(&self.estimate);
        let mut draws: Vec<f64> = self.draws.iter().map(|draw| f(draw)).filter(|v| v.is_finite()).collect();
        if draws.len() < 3 {
            return (value, [f64::NEG_INFINITY, f64::INFINITY]);
        }
        draws.sort_by(f64::total_cmp);
        // Half the interquartile range of a normal distribution is 0.6745 of its standard deviation.
        let spread = (quantile_of_sorted(&draws, 0.75) - quantile_of_sorted(&draws, 0.25)) / (2.0 * 0.6745);
        let half = self.inflation * NORMAL_95 * spread + systematic * value.abs();
        (value, [value - half, value + half])
    }

    /// These resamplings with intervals for a background whose strength is the same in all directions. They decide whether an
    /// effect differs from zero, and are not reported.
    pub fn evenly(&self) -> Self {
        Self { draws: self.even.clone(), inflation: INFLATION, other: None, ..self.clone() }
    }

    /// If the held-out recordings reduced the background, or only some links differ from the URDF and a background in which all links
    /// do may explain nearly as much as that of `selected`, effects have other sizes beside the other background. The intervals then
    /// hold those of both.
    pub fn allow_for_other_background(&mut self, study: &mut Study, selected: &Selection) {
        let preferred = study.preferred.clone().map(|strengths| {
            let products = study.products_at(&strengths);
            let next = study.problem(&products).choose(selected.set.clone(), &selected.fit.weights);
            (strengths, next)
        });
        let Some((strengths, next)) = preferred.or_else(|| study.with_all_links(selected)) else {
            return;
        };
        let own = std::mem::replace(&mut study.strengths, strengths);
        let other = resample(study, &next);
        study.strengths = own;
        self.other = other.in_order_of(self).map(Box::new);
    }

    /// These resamplings in the order of the columns of `first`, which are all among their own.
    fn in_order_of(mut self, first: &Self) -> Option<Self> {
        let places: Option<Vec<usize>> = first.columns.iter().map(|&column| self.column(column)).collect();
        let mut places = places?;
        places.extend(self.columns.len()..self.columns.len() + self.sizes.len());
        let lists = self.draws.iter_mut().chain(&mut self.even);
        for values in lists.chain([&mut self.estimate]) {
            *values = places.iter().map(|&place| values[place]).collect();
        }
        self.columns.clone_from(&first.columns);
        Some(self)
    }

    /// The index of a column's coefficient in a draw.
    pub fn column(&self, column: usize) -> Option<usize> {
        self.columns.iter().position(|&c| c == column)
    }

    /// The index of the correction of a candidate's size in a draw.
    pub fn size(&self, candidate: usize, size: Size) -> Option<usize> {
        let at = self.sizes.iter().position(|&known| known == (candidate, size))?;
        Some(self.columns.len() + at)
    }
}

/// Resamples the fit of `selected`.
pub fn resample(study: &mut Study, selected: &Selection) -> Resampled {
    let mut all: Vec<(usize, Size)> = Vec::new();
    let mut missing: Vec<Term> = Vec::new();
    for &member in &selected.set {
        let terms = study.terms(member);
        for size in sizes(&terms) {
            for term in varied(&terms, size, 1.0 + STEP) {
                if !study.table.terms.contains(&term) && !missing.contains(&term) {
                    missing.push(term);
                }
            }
            all.push((member, size));
        }
    }
    study.extend(missing);
    let columns = selected.fit.columns.clone();
    debug_assert!(
        study.background().is_none_or(|background| columns.starts_with(&background.columns)),
        "the fit is beside another background"
    );
    let scaled = scaled(study, selected);
    let p = columns.len() + all.len();
    let systems = systems(study, selected, &columns, &all);
    let prior = PriorDraws::new(study, columns.len(), all.len());
    let total = systems.iter().fold((prior.precision.clone(), prior.pull.clone()), |(a, b), (c, d)| (a + c, b + d));
    let estimate = in_true_torque(solve(&total.0, &total.1), &scaled);
    let (draws, even): (Vec<Vec<f64>>, Vec<Vec<f64>>) = (0..DRAWS)
        .into_par_iter()
        .map(|draw| {
            // Each draw has its own generator, so that the result does not depend on threads (splitmix64).
            let mut state = 0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(draw as u64 + 1);
            let (mut a, mut b) = (prior.precision.clone(), prior.pull.clone());
            for (matrix, right) in &systems {
                // Exponential weights.
                let weight = -uniform(&mut state).ln();
                a += matrix * weight;
                b += right * weight;
            }
            let mean = prior.draw(&mut state, p);
            let right = |times: &DVector<f64>| &b + mean.component_mul(times);
            let [draw, even] = solve_both(&a, &right(&prior.times), &right(&prior.times_evenly));
            (in_true_torque(draw, &scaled), in_true_torque(even, &scaled))
        })
        .unzip();
    Resampled { columns, estimate, draws, even, other: None, sizes: all, inflation: inflation(study) }
}

/// The factor on the standard deviation of the draws.
fn inflation(study: &Study) -> f64 {
    if study.strengths.is_of_joints() { INFLATION_IN_DRIVES } else { INFLATION }
}

/// The indices of a column whose torque is measured through a torque scale, and of that scale's column.
type ScaledBy = (usize, usize);

/// The columns of `selected` that a torque scale of their joint multiplies. The scale's own column is the rigid torque alone, so
/// that the other effects on the joint are fitted in measured newton metres. Effects carried in the arm are rigid torque
/// already.
fn scaled(study: &Study, selected: &Selection) -> Vec<ScaledBy> {
    let columns = &selected.fit.columns;
    let term = |k: usize| study.table.terms[columns[k]];
    let is_scale = |&k: &usize| term(k).is(&RIGID);
    let scales = (selected.fit.background..columns.len()).filter(is_scale);
    let of = |scale: usize| {
        let is_scaled = move |&k: &usize| {
            let (this, law) = (term(k), term(k).law);
            (k >= selected.fit.background || this.is(&OFFSET))
                && this.joint() == term(scale).joint()
                && !this.always().is(&RIGID)
                && law.carry.is_none()
        };
        (0..columns.len()).filter(is_scaled).map(move |k| (k, scale))
    };
    scales.flat_map(of).collect()
}

/// A solution with every coefficient in true newton metres: measured = factor × true.
fn in_true_torque(solution: DVector<f64>, scaled: &[ScaledBy]) -> Vec<f64> {
    let mut values = solution.as_slice().to_vec();
    for &(at, scale) in scaled {
        values[at] /= 1.0 + solution[scale];
    }
    values
}

/// A number that is uniform in (0, 1], from the upper 53 bits (splitmix64).
fn uniform(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (((z ^ (z >> 31)) >> 11) + 1) as f64 / (1_u64 << 53) as f64
}

/// The background's prior in the normal equations. In each draw, its mean is drawn about its centre, as the data are resampled, so
/// that the draws include the prior's uncertainty. The mean is drawn with [`UNEVEN`] times the prior's standard deviation.
struct PriorDraws {
    /// K, with the background's columns first, and zeros for the other columns.
    precision: DMatrix<f64>,
    /// K m, with m the prior's centre, and zeros for the other columns.
    pull: DVector<f64>,
    /// The Cholesky factor of K.
    lower: DMatrix<f64>,
    /// The multiples with which the mean is drawn,
    times: DVector<f64>,
    /// and those for a background whose strength is the same in all directions.
    times_evenly: DVector<f64>,
    /// The number of corrections of sizes.
    sizes: usize,
}

impl PriorDraws {
    /// For `columns` of coefficients and the corrections of `sizes`, which are relative: the search found the sizes, so that a correction by
    /// more than [`LARGEST_CORRECTION`] is unlikely. Without it, a gap's coefficient and its size, which have almost the same column, would
    /// cancel each other with any values.
    fn new(study: &Study, columns: usize, sizes: usize) -> Self {
        let p = columns + sizes;
        let background = study.background();
        let mut pull = DVector::zeros(p);
        if let Some(background) = &background {
            let own = background.pull();
            pull.rows_mut(0, own.len()).copy_from(&own);
        }
        let background_columns = background.as_ref().map_or_else(Vec::new, |background| background.columns.clone());
        let own = background.map_or_else(|| DMatrix::zeros(0, 0), |b| b.precision);
        let mut precision = DMatrix::zeros(p, p);
        precision.view_mut((0, 0), own.shape()).copy_from(&own);
        for size in columns..p {
            precision[(size, size)] = LARGEST_CORRECTION.powi(-2);
        }
        let lower = own.clone().cholesky().map_or(own, nalgebra::Cholesky::unpack);
        let term = |k: usize| background_columns.get(k).map(|&column| study.table.terms[column]);
        let is_stated = study.stated.gain.is_some();
        // The spread of the draws is multiplied by an inflation that is not that of a stated deviation.
        let times = |k: usize, uneven: f64, inflation: f64| match term(k) {
            Some(term) if is_stated && term.is(&GAIN_LAW) => inflation.recip(),
            Some(term) if grows_with_speed(&term) => UNEVEN_WITH_SPEED,
            _ => uneven,
        };
        let times = |uneven: f64, inflation: f64| DVector::from_fn(p, |k, _| times(k, uneven, inflation));
        Self {
            precision,
            pull,
            lower,
            times: times(UNEVEN, inflation(study)),
            times_evenly: times(1.0, INFLATION),
            sizes,
        }
    }

    /// K ξ for the right-hand side of `p` columns, ξ ~ N(0, K⁻¹).
    fn draw(&self, state: &mut u64, p: usize) -> DVector<f64> {
        let n = self.lower.nrows();
        // Box and Muller 1958.
        let mut normal = |count: usize| {
            DVector::from_fn(count, |_, _| {
                (-2.0 * uniform(state).ln()).sqrt() * (std::f64::consts::TAU * uniform(state)).cos()
            })
        };
        let mut right = DVector::zeros(p);
        right.rows_mut(0, n).copy_from(&(&self.lower * normal(n)));
        let sizes = normal(self.sizes) / LARGEST_CORRECTION;
        right.rows_mut(p - self.sizes, self.sizes).copy_from(&sizes);
        right
    }
}

/// Whether a term of the background is a part of the friction that grows with the speed: that of a recording of its own, or drag.
fn grows_with_speed(term: &Term) -> bool {
    term.form == 1 && (term.is(&FRICTION_CURVE) || term.is(&OWN_FRICTION))
}

/// The weighted normal equations of each block.
fn systems(
    study: &Study,
    selected: &Selection,
    columns: &[usize],
    sizes: &[(usize, Size)],
) -> Vec<(DMatrix<f64>, DVector<f64>)> {
    let table = &study.table;
    let p = columns.len() + sizes.len();
    let weights = study.training_products().evidence_weights(&selected.fit.weights);
    // The columns of each joint, with the derivatives by the sizes last.
    let by_joint: Vec<Vec<Option<SharedColumn>>> = (0..table.dof())
        .into_par_iter()
        .map(|joint| {
            let mut list: Vec<Option<SharedColumn>> = columns
                .iter()
                .map(|&column| table.place[joint][column].map(|place| table.joints[joint].x[place].clone()))
                .collect();
            for &(member, size) in sizes {
                let terms = study.terms(member);
                let mut derivative = vec![0.0; table.len()];
                let mut acts = false;
                for (old, new) in terms.iter().zip(varied(&terms, size, 1.0 + STEP)) {
                    let find = |term: &Term| table.terms.iter().position(|known| known == term);
                    let (Some(old), Some(new)) = (find(old), find(&new)) else {
                        continue;
                    };
                    let coefficient = selected.fit.coefficient(old);
                    let (Some(a), Some(b)) = (table.place[joint][old], table.place[joint][new]) else {
                        continue;
                    };
                    acts |= old != new;
                    let (a, b) = (&table.joints[joint].x[a], &table.joints[joint].x[b]);
                    for (row, sum) in derivative.iter_mut().enumerate() {
                        *sum += coefficient * (b[row] - a[row]) / STEP;
                    }
                }
                list.push(acts.then(|| SharedColumn::new(derivative)));
            }
            list
        })
        .collect();
    let mut blocks = Vec::new();
    let time: f64 = (0..table.rows.len())
        .filter(|&r| study.data.fitted[r])
        .map(|r| table.rows[r].len() as f64 * study.data.seconds[r])
        .sum();
    let length = BLOCK.max(time / MOST_BLOCKS as f64);
    for (recording, rows) in table.rows.iter().enumerate().filter(|(r, _)| study.data.fitted[*r]) {
        let count = ((rows.len() as f64 * study.data.seconds[recording] / length).round() as usize).max(1);
        for block in 0..count {
            let from = rows.start + rows.len() * block / count;
            blocks.push(from..rows.start + rows.len() * (block + 1) / count);
        }
    }
    blocks
        .into_par_iter()
        .map(|rows| {
            let (mut a, mut b) = (DMatrix::zeros(p, p), DVector::zeros(p));
            for (joint, list) in by_joint.iter().enumerate() {
                let this = &table.joints[joint];
                let weight = weights[joint];
                let acting: Vec<(usize, &Vec<f64>)> =
                    list.iter().enumerate().filter_map(|(k, x)| x.as_deref().map(|x| (k, x))).collect();
                for row in rows.clone().filter(|&row| this.moving[row]) {
                    for (at, &(i, x)) in acting.iter().enumerate() {
                        let wx = weight * x[row];
                        b[i] += wx * this.y[row];
                        for &(k, y) in &acting[..=at] {
                            a[(i, k)] += wx * y[row];
                        }
                    }
                }
            }
            for i in 0..p {
                for k in 0..i {
                    a[(k, i)] = a[(i, k)];
                }
            }
            (a, b)
        })
        .collect()
}

/// Least squares of scaled columns with a very small ridge.
fn solve(a: &DMatrix<f64>, b: &DVector<f64>) -> DVector<f64> {
    let [solution, _] = solve_both(a, b, b);
    solution
}

/// Least squares with two right-hand sides, as in [`solve`].
fn solve_both(a: &DMatrix<f64>, b: &DVector<f64>, c: &DVector<f64>) -> [DVector<f64>; 2] {
    let p = b.len();
    let scale: Vec<f64> = (0..p).map(|i| if a[(i, i)] > 0.0 { a[(i, i)].sqrt() } else { 1.0 }).collect();
    let mut matrix = DMatrix::from_fn(p, p, |i, k| a[(i, k)] / (scale[i] * scale[k]));
    for i in 0..p {
        matrix[(i, i)] += 1e-8;
    }
    let right = DMatrix::from_fn(p, 2, |i, side| [b, c][side][i] / scale[i]);
    let solution = match matrix.clone().cholesky() {
        Some(factor) => factor.solve(&right),
        None => matrix.lu().solve(&right).unwrap_or_else(|| DMatrix::zeros(p, 2)),
    };
    [0, 1].map(|side| DVector::from_fn(p, |i, _| solution[(i, side)] / scale[i]))
}
