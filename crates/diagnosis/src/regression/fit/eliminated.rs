//! The background eliminated from the normal equations at fixed weights, so that only the selected columns remain.
//!
//! With A = BᵀWB + K = LLᵀ for the background's columns B, their precision K and W the weights of the evidence, a product of two
//! columns becomes xᵀWx' − (L⁻¹BᵀWx)ᵀ(L⁻¹BᵀWx'), and the background costs ½ (ln det A − ln det K) + ½ (δ − m)ᵀK(δ − m) with m the prior's centre.

use std::sync::{Arc, OnceLock, PoisonError};

use nalgebra::{Cholesky, DMatrix, DVector};

use super::Products;
use crate::lanes::{LANES, Lanes, dot, dots_of, dots_with, forward};
use crate::regression::background::Background;
use crate::regression::lazy::Lazy;
use crate::regression::table::Table;

/// The number of weights for which the elimination is stored.
const KEPT: usize = 12;

/// The background eliminated at given weights.
#[derive(Debug)]
pub struct Eliminated {
    /// The weights of the joints' rows: the reciprocals of their variances.
    weights: Vec<f64>,
    /// The weights of the joints' rows where rows count as evidence.
    scaled: Vec<f64>,
    /// The rows of L.
    lower: Vec<Vec<f64>>,
    /// L⁻¹ (BᵀW y + K m).
    with_y: Vec<f64>,
    /// L⁻¹ BᵀW x of each requested column of the table.
    with_columns: Vec<OnceLock<Vec<f64>>>,
    /// The products of the columns of a fit with all others. They are cached, because every candidate needs them
    /// in every round.
    with_others: Vec<OnceLock<Vec<Lazy>>>,
    /// ½ (ln det A − ln det K) (nats).
    pub occam: f64,
}

impl Background {
    /// K m: what the prior adds to the right side of the normal equations.
    pub fn pull(&self) -> DVector<f64> {
        &self.precision * &self.centre
    }

    /// Twice the cost of coefficients (nats): (δ − m)ᵀ K (δ − m).
    pub fn energy(&self, coefficients: &[f64]) -> f64 {
        let p = coefficients.len();
        let from_centre = |i: usize| coefficients[i] - self.centre[i];
        let row = |i: usize| (0..p).map(|k| self.precision[(i, k)] * from_centre(k)).sum::<f64>();
        (0..p).map(|i| from_centre(i) * row(i)).sum()
    }
}

impl Eliminated {
    fn new(products: &Products, table: &Table, background: &Background, weights: &[f64]) -> Self {
        let scaled = products.evidence_weights(weights);
        let columns = &background.columns;
        let p = columns.len();
        let mut matrix = DMatrix::zeros(p, p);
        for i in 0..p {
            for k in 0..=i {
                matrix[(i, k)] =
                    products.product(table, &scaled, columns[i], Some(columns[k])) + background.precision[(i, k)];
                matrix[(k, i)] = matrix[(i, k)];
            }
        }
        // K is positive definite, and BᵀWB is positive semidefinite up to rounding.
        let factor = Cholesky::new(matrix).map_or_else(|| DMatrix::identity(p, p), Cholesky::unpack);
        let log_det = 2.0 * factor.diagonal().iter().map(|d| d.ln()).sum::<f64>();
        let lower = (0..p).map(|i| (0..=i).map(|k| factor[(i, k)]).collect()).collect();
        let mut eliminated = Self {
            weights: weights.to_vec(),
            scaled,
            lower,
            with_y: Vec::new(),
            with_columns: (0..table.terms.len()).map(|_| OnceLock::new()).collect(),
            with_others: (0..table.terms.len()).map(|_| OnceLock::new()).collect(),
            occam: 0.5 * (log_det - background.log_det),
        };
        let with_y = |(&column, pull): (&usize, &f64)| products.product(table, &eliminated.scaled, column, None) + pull;
        let right = columns.iter().zip(&background.pull()).map(with_y).collect();
        eliminated.with_y = eliminated.forward(right);
        eliminated
    }

    /// L⁻¹ of a right-hand side.
    fn forward(&self, mut right: Vec<f64>) -> Vec<f64> {
        for (i, row) in self.lower.iter().enumerate() {
            let (before, rest) = right.split_at_mut(i);
            rest[0] = (rest[0] - dot(row, before)) / row[i];
        }
        right
    }

    fn with_column(&self, products: &Products, table: &Table, background: &Background, column: usize) -> &[f64] {
        self.with_columns[column].get_or_init(|| {
            let product = |&own: &usize| products.product(table, &self.scaled, column, Some(own));
            self.forward(background.columns.iter().map(product).collect())
        })
    }

    /// Stores the products of these columns with others from now on.
    pub fn store(&self, columns: &[usize]) {
        let none = || self.with_others.iter().map(|_| Lazy::default()).collect();
        for &column in columns {
            self.with_others[column].get_or_init(none);
        }
    }

    /// The place where the product of two columns is stored; `None` if products of neither are stored.
    fn place(&self, a: usize, b: usize) -> Option<&Lazy> {
        let of = |one: usize, other: usize| self.with_others[one].get().map(|row| &row[other]);
        of(b, a).or_else(|| of(a, b))
    }

    /// Reads the products of the columns of a group with `other`; whether all of them are stored.
    fn stored(&self, group: &[usize], other: usize, products: &mut Lanes) -> bool {
        group.iter().zip(products).all(|(&column, product)| {
            let stored = self.place(column, other).and_then(Lazy::get);
            *product = stored.unwrap_or(f64::NAN);
            stored.is_some()
        })
    }

    /// The background's coefficients for `values` of the selected `columns`.
    pub fn coefficients(&self, products: &Products, table: &Table, columns: &[usize], values: &[f64]) -> Vec<f64> {
        let mut solution = self.with_y.clone();
        if let Some(background) = products.background.as_deref() {
            for (&column, &value) in columns.iter().zip(values) {
                let with = self.with_column(products, table, background, column);
                solution.iter_mut().zip(with).for_each(|(sum, x)| *sum -= value * x);
            }
        }
        // L⁻ᵀ, row by row from the last.
        for i in (0..solution.len()).rev() {
            let row = &self.lower[i];
            solution[i] /= row[i];
            let value = solution[i];
            solution[..i].iter_mut().zip(row).for_each(|(sum, x)| *sum -= value * x);
        }
        solution
    }
}

impl Products {
    /// The background eliminated at `weights`; `None` if there is none.
    pub(super) fn eliminated(&self, table: &Table, weights: &[f64]) -> Option<Arc<Eliminated>> {
        let background = self.background.as_deref()?;
        let known = |list: &[Arc<Eliminated>]| {
            let is_same =
                |one: &&Arc<Eliminated>| one.weights == weights && one.with_columns.len() == table.terms.len();
            list.iter().find(is_same).cloned()
        };
        if let Some(known) = known(&self.eliminated.lock().unwrap_or_else(PoisonError::into_inner)) {
            return Some(known);
        }
        let new = Arc::new(Eliminated::new(self, table, background, weights));
        let mut list = self.eliminated.lock().unwrap_or_else(PoisonError::into_inner);
        if list.len() == KEPT {
            list.remove(0);
        }
        list.push(Arc::clone(&new));
        Some(new)
    }

    /// The product of two columns at `weights`, or with y (`None`), minus the part that the background explains.
    pub(super) fn inner(
        &self,
        table: &Table,
        weights: &[f64],
        eliminated: Option<&Eliminated>,
        a: usize,
        b: Option<usize>,
    ) -> f64 {
        let (Some(eliminated), Some(background)) = (eliminated, self.background.as_deref()) else {
            return self.product(table, weights, a, b);
        };
        let form = || {
            let full = self.product(table, &eliminated.scaled, a, b);
            let x = eliminated.with_column(self, table, background, a);
            match b {
                Some(b) => full - dot(x, eliminated.with_column(self, table, background, b)),
                None => full - dot(x, &eliminated.with_y),
            }
        };
        // The product has the same bits in either order of the columns.
        match b.and_then(|b| eliminated.place(a, b)) {
            Some(place) => place.get_or(form),
            None => form(),
        }
    }

    /// Eliminates the background from these columns of the table, several at a time.
    pub(super) fn eliminate(&self, table: &Table, eliminated: &Eliminated, columns: &[usize]) {
        let is_new = |column: &usize| eliminated.with_columns[*column].get().is_none();
        let new: Vec<usize> = columns.iter().copied().filter(is_new).collect();
        for group in new.chunks(LANES) {
            self.in_lanes(table, eliminated, group);
        }
    }

    /// L⁻¹ BᵀW x of up to [`LANES`] columns; the results are also stored.
    fn in_lanes(&self, table: &Table, eliminated: &Eliminated, group: &[usize]) -> Vec<Lanes> {
        let known = |&column: &usize| eliminated.with_columns[column].get();
        if let Some(known) = group.iter().map(known).collect::<Option<Vec<_>>>() {
            let row = |i: usize| std::array::from_fn(|lane| known.get(lane).map_or(0.0, |x| x[i]));
            return (0..eliminated.lower.len()).map(row).collect();
        }
        let Some(background) = self.background.as_deref() else {
            return Vec::new();
        };
        let mut right = vec![[0.0; LANES]; background.columns.len()];
        for (lane, &column) in group.iter().enumerate() {
            for (row, &own) in right.iter_mut().zip(&background.columns) {
                row[lane] = self.product(table, &eliminated.scaled, column, Some(own));
            }
        }
        forward(&eliminated.lower, &mut right);
        for (lane, &column) in group.iter().enumerate() {
            eliminated.with_columns[column].get_or_init(|| right.iter().map(|row| row[lane]).collect());
        }
        right
    }

    /// The products as of [`Self::inner`] of each of `others` with the columns of a group.
    pub(super) fn inner_in_lanes(
        &self,
        table: &Table,
        eliminated: &Eliminated,
        group: &[usize],
        others: &[usize],
    ) -> Vec<Lanes> {
        let Some(background) = self.background.as_deref() else {
            return Vec::new();
        };
        let mut products = vec![[0.0; LANES]; others.len()];
        let is_missing = |&k: &usize| !eliminated.stored(group, others[k], &mut products[k]);
        let missing: Vec<usize> = (0..others.len()).filter(is_missing).collect();
        if missing.is_empty() {
            return products;
        }
        let columns = self.in_lanes(table, eliminated, group);
        let with = |&k: &usize| eliminated.with_column(self, table, background, others[k]);
        let rows: Vec<&[f64]> = missing.iter().map(with).collect();
        for (&k, explained) in missing.iter().zip(dots_of(&rows, &columns)) {
            for (lane, &column) in group.iter().enumerate() {
                let value = self.product(table, &eliminated.scaled, column, Some(others[k])) - explained[lane];
                products[k][lane] = value;
                if let Some(place) = eliminated.place(column, others[k]) {
                    place.set(value);
                }
            }
        }
        products
    }

    /// The products as of [`Self::inner`] of a column with each of `others`, to the beginning of `row`.
    pub(super) fn inner_with(
        &self,
        table: &Table,
        weights: &[f64],
        eliminated: Option<&Eliminated>,
        a: usize,
        others: &[usize],
        row: &mut [f64],
    ) {
        let (Some(eliminated), Some(background)) = (eliminated, self.background.as_deref()) else {
            for (value, &b) in row.iter_mut().zip(others) {
                *value = self.product(table, weights, a, Some(b));
            }
            return;
        };
        let mut missing: Vec<usize> = Vec::with_capacity(others.len());
        for (k, &b) in others.iter().enumerate() {
            match eliminated.place(a, b).and_then(Lazy::get) {
                Some(value) => row[k] = value,
                None => missing.push(k),
            }
        }
        if missing.is_empty() {
            return;
        }
        let with = |column: usize| eliminated.with_column(self, table, background, column);
        let columns: Vec<&[f64]> = missing.iter().map(|&k| with(others[k])).collect();
        for (&k, explained) in missing.iter().zip(dots_with(with(a), &columns)) {
            row[k] = self.product(table, &eliminated.scaled, a, Some(others[k])) - explained;
            if let Some(place) = eliminated.place(a, others[k]) {
                place.set(row[k]);
            }
        }
    }

    /// The weighted square of a column, with rows counted as evidence.
    pub(super) fn own_product(&self, table: &Table, eliminated: &Eliminated, column: usize) -> f64 {
        self.product(table, &eliminated.scaled, column, Some(column))
    }

    /// The joints' `weights` with rows counted as evidence, as the background's prior needs; without a background, they are
    /// unchanged.
    pub fn evidence_weights(&self, weights: &[f64]) -> Vec<f64> {
        let scale = |joint: usize| self.background.as_ref().map_or(1.0, |_| self.evidence_per_row(joint));
        (0..weights.len()).map(|joint| weights[joint] * scale(joint)).collect()
    }

    /// The weighted sum of squares of `column` with every row counted as one, from the one with rows counted as evidence.
    pub(super) fn per_row(&self, table: &Table, column: usize) -> f64 {
        match table.terms[column].joint() {
            Some(joint) => self.evidence_per_row(joint),
            None => {
                let moved = (0..self.count.len()).filter(|&joint| self.count[joint] > 0.0);
                let (sum, count) =
                    moved.fold((0.0, 0.0), |(sum, count), joint| (sum + self.evidence_per_row(joint), count + 1.0));
                sum / f64::max(count, 1.0)
            }
        }
        .max(1e-12)
    }
}
