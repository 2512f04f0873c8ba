//! The gains of columns that are added to a fit.

use std::collections::HashMap;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::{Fit, Products, cholesky};
use crate::lanes::{LANES, Lanes, forward_by_columns};
use crate::regression::table::Table;

/// Columns that may be added to a fit, without the part that its columns explain.
pub struct Reduced(HashMap<usize, Column>);

/// One such column.
struct Column {
    /// The root of its weighted square.
    size: f64,
    /// L⁻¹ of its scaled products with the fit's columns.
    cross: Vec<f64>,
    /// Its scaled product with y.
    right: f64,
}

impl Products {
    /// The columns `added` for [`Self::drop`].
    pub fn reduced(&self, table: &Table, fit: &Fit, added: &[usize]) -> Reduced {
        if let Some(eliminated) = &fit.eliminated {
            eliminated.store(fit.selected());
            self.eliminate(table, eliminated, fit.selected());
        }
        let groups = added.par_chunks(LANES);
        let columns: Vec<Vec<(usize, Column)>> = groups.map(|group| self.reduced_group(table, fit, group)).collect();
        Reduced(columns.into_iter().flatten().collect())
    }

    fn reduced_group(&self, table: &Table, fit: &Fit, group: &[usize]) -> Vec<(usize, Column)> {
        let (selected, eliminated) = (fit.selected(), fit.eliminated.as_deref());
        let inner = |a: usize, b: Option<usize>| self.inner(table, &fit.weights, eliminated, a, b);
        let mut cross: Vec<Lanes> = match eliminated {
            Some(eliminated) => self.inner_in_lanes(table, eliminated, group, selected),
            None => {
                let of = |&b: &usize| std::array::from_fn(|k| group.get(k).map_or(0.0, |&a| inner(a, Some(b))));
                selected.iter().map(of).collect()
            }
        };
        let size_of = |&column: &usize| {
            let diagonal = match eliminated {
                Some(eliminated) => self.own_product(table, eliminated, column),
                None => inner(column, Some(column)),
            };
            if diagonal > 0.0 { diagonal.sqrt() } else { 1.0 }
        };
        let sizes: Vec<f64> = group.iter().map(size_of).collect();
        for (row, scale) in cross.iter_mut().zip(&fit.scale) {
            for (value, size) in row.iter_mut().zip(&sizes) {
                *value /= scale * size;
            }
        }
        forward_by_columns(fit.factor.as_slice(), &mut cross);
        let column = |(k, &column): (usize, &usize)| {
            let size = sizes[k];
            let right = inner(column, None) / size;
            let cross = cross.iter().map(|row| row[k]).collect();
            (column, Column { size, cross, right })
        };
        group.iter().enumerate().map(column).collect()
    }

    /// The reduction of the weighted sum of squares of `fit` by `added` columns (one at least), at its weights, and the fitted
    /// coefficient of the first of them.
    pub fn drop(&self, table: &Table, fit: &Fit, added: &[usize], reduced: &Reduced) -> (f64, f64) {
        let (p, c) = (fit.selected().len(), added.len());
        let columns: Vec<&Column> = added.iter().map(|column| &reduced.0[column]).collect();
        let mut own = DMatrix::zeros(c, c);
        let mut row = vec![0.0; c];
        for k in 0..c {
            let eliminated = fit.eliminated.as_deref();
            self.inner_with(table, &fit.weights, eliminated, added[k], &added[..=k], &mut row);
            for l in 0..=k {
                let value = row[l] / (columns[k].size * columns[l].size);
                own[(k, l)] = value;
                own[(l, k)] = value;
            }
        }
        let mut right = DVector::from_fn(c, |k, _| columns[k].right);
        if p > 0 {
            let cross = DMatrix::from_fn(p, c, |i, k| columns[k].cross[i]);
            own -= cross.tr_mul(&cross);
            right -= cross.tr_mul(&fit.reduced);
        }
        // A part of the span of the present columns must not count as a gain again.
        for k in 0..c {
            own[(k, k)] += 1e-6;
        }
        let factor = cholesky(&own);
        factor.solve_lower_triangular_mut(&mut right);
        let drop = right.norm_squared();
        factor.tr_solve_lower_triangular_mut(&mut right);
        let coefficient = right[0] / columns[0].size;
        match (&fit.eliminated, added.first()) {
            (Some(_), Some(&first)) => (drop / self.per_row(table, first), coefficient),
            _ => (drop, coefficient),
        }
    }

    /// The evidence (nats) that a column with a coefficient of one has in addition to the columns of `fit`, to second order in the
    /// coefficient.
    pub fn evidence_of(&self, table: &Table, fit: &Fit, column: usize) -> f64 {
        0.5 * self.drop_of(table, fit, column) * self.per_row(table, column)
    }

    /// The amount that a column with a coefficient of one adds to the weighted sum of squares in addition to the columns of
    /// `fit`.
    pub fn drop_of(&self, table: &Table, fit: &Fit, column: usize) -> f64 {
        let inner = |b: usize| self.inner(table, &fit.weights, fit.eliminated.as_deref(), column, Some(b));
        let own = inner(column);
        let mut cross = DVector::from_fn(fit.selected().len(), |i, _| inner(fit.selected()[i]) / fit.scale[i]);
        fit.factor.solve_lower_triangular_mut(&mut cross);
        let drop = (own - cross.norm_squared()).max(0.0);
        match &fit.eliminated {
            Some(_) => drop / self.per_row(table, column),
            None => drop,
        }
    }
}
