//! Inner products of some columns, and of two sets of recordings together.

use std::sync::Arc;

use super::Products;
use crate::regression::table::{Gram, Table};

impl Products {
    /// The products of `columns` alone, in the order of [`Table::bare`] for their terms. They are in ascending order, and those of the
    /// background are among them.
    pub fn picked(&self, table: &Table, columns: &[usize]) -> Self {
        let of = |joint: usize| {
            let places: Vec<Option<usize>> = columns.iter().map(|&column| table.place[joint][column]).collect();
            self.gram[joint].picked(&places)
        };
        Self {
            gram: Arc::new((0..self.gram.len()).map(of).collect()),
            background: self.background.as_ref().map(|all| Arc::new(all.among(columns))),
            eliminated: Arc::default(),
            ..self.clone()
        }
    }

    /// These products and `more` of the same columns, whose rows have an error of variance `variance` on each joint ((N m)²
    /// or N²), with the evidence and the floor of both together, and the background of these.
    pub fn joined(&self, more: &Self, variance: &[f64], evidence: Vec<f64>, floor: Vec<f64>) -> Self {
        let of = |joint: usize| {
            let grams = [&self.gram[joint], &more.gram[joint]].map(|gram| Arc::new(gram.clone()));
            let noise = variance[joint] * more.count[joint];
            Gram::sum(Gram::default(), grams[0].len(), grams.into()).with_noise(noise)
        };
        Self {
            gram: Arc::new((0..self.gram.len()).map(of).collect()),
            background: self.background.clone(),
            eliminated: Arc::default(),
            count: self.count.iter().zip(&more.count).map(|(a, b)| a + b).collect(),
            evidence,
            floor,
            recordings: self.recordings.clone(),
        }
    }

    /// The standard deviation of a column on a joint; `place` is its index.
    pub fn spread(&self, joint: usize, place: usize) -> f64 {
        let (gram, n) = (&self.gram[joint], self.count[joint].max(1.0));
        (gram.of(place, place) / n - (gram.sum_of(place) / n).powi(2)).max(0.0).sqrt()
    }
}
