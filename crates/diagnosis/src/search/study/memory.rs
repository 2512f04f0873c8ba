//! How long a joint's residual remembers, which reduces what its rows are worth.
//!
//! Pieces of evidence are independent if the model is right but for noise. The residual of friction that no effect describes keeps its sign
//! over whole motions, so that many rows repeat what one says. A mean over n rows of such a residual, with the autocorrelation ρₖ at a
//! distance of k rows, is as accurate as that of n / (1 + 2 Σ ρₖ) independent ones, the effective sample size of a correlated series.

use super::Study;
use crate::data::statistics::rms;
use crate::regression::fit::{Fit, evidence_rate};
use crate::thresholds::{FORGOTTEN, LEAST_REMEMBERED, SAME_MEMORY, USUAL_MEMORY};
use crate::trace::Action;

/// The largest number of pieces of evidence over which a residual is compared with itself.
const LONGEST: usize = 80;

/// Why the rows of a joint count less.
const REPEATS: &str = "its residual repeats itself";

impl Study {
    /// Takes the memory of the residuals of `fit` into account. Returns whether that changes what the rows of a joint are worth.
    pub fn remember(&mut self, fit: &Fit) -> bool {
        let memory: Vec<f64> = (0..self.data.motions.dof).map(|joint| self.memory_of(joint, fit)).collect();
        let differs = |(new, old): (&f64, &f64)| (new / old).ln().abs() > SAME_MEMORY.ln();
        let changes = memory.iter().zip(&self.memory).any(differs);
        if changes {
            self.set_memory(memory);
            self.note_memory();
        }
        changes
    }

    fn note_memory(&self) {
        let name = |joint: usize| self.data.arm.joints()[joint].name.clone();
        let less = self.memory.iter().enumerate().filter(|(_, memory)| **memory > 1.0);
        let rows: Vec<_> = less
            .map(|(joint, memory)| {
                (
                    Action::Memory,
                    format!("{memory:.1} pieces of evidence count as one"),
                    Some(name(joint)),
                    REPEATS,
                    0.0,
                )
            })
            .collect();
        if !rows.is_empty() {
            self.trace.step(rows);
        }
    }

    /// Counts every piece of evidence again.
    pub fn forget(&mut self) {
        self.set_memory(vec![1.0; self.data.motions.dof]);
    }

    fn set_memory(&mut self, memory: Vec<f64>) {
        if self.memory != memory {
            self.memory = memory;
            self.forget_backgrounds();
        }
    }

    /// The number of pieces of evidence that are worth one on `joint`; one if the residual of `fit` is small, or
    /// forgets as quickly as noise does.
    fn memory_of(&self, joint: usize, fit: &Fit) -> f64 {
        let residual = self.table.residual(joint, &fit.columns, &fit.coefficients);
        let moving = self.table.moving_rows(joint, &self.data.fitted);
        let size = rms(moving.into_iter().map(|row| residual[row])).unwrap_or(0.0);
        if size < LEAST_REMEMBERED * self.data.scales.torque[joint] {
            return 1.0;
        }
        let piece = 1.0 / evidence_rate(self.data.motions.tempo[joint]);
        let correlation = |k: usize| self.autocorrelation(joint, &residual, k as f64 * piece);
        pieces_worth_one(correlation)
    }

    /// The autocorrelation of a residual of `joint` over `lag` (s), on the training rows on which it moves.
    fn autocorrelation(&self, joint: usize, residual: &[f64], lag: f64) -> f64 {
        let moving = &self.table.joints[joint].moving;
        let (mut product, mut power) = (0.0, 0.0);
        for (recording, rows) in
            self.table.rows.iter().enumerate().filter(|(recording, _)| self.data.fitted[*recording])
        {
            let later = (lag / self.data.seconds[recording]).round().max(1.0) as usize;
            for row in rows.start..rows.end.saturating_sub(later) {
                if moving[row] && moving[row + later] {
                    product += residual[row] * residual[row + later];
                    power += 0.5 * (residual[row].powi(2) + residual[row + later].powi(2));
                }
            }
        }
        if power > 0.0 { product / power } else { 0.0 }
    }
}

/// The number of pieces of evidence that are worth one if those at a distance of k have the `correlation` of k; at least one.
fn pieces_worth_one(correlation: impl Fn(usize) -> f64) -> f64 {
    let sum: f64 = (1..=LONGEST).map(correlation).take_while(|&rho| rho > FORGOTTEN).sum();
    ((1.0 + 2.0 * sum) / USUAL_MEMORY).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::pieces_worth_one;

    /// A mean of a first-order residual with the autocorrelation 0.8ᵏ is as accurate as that of a ninth as many independent rows. Twice as many
    /// are counted, as for every residual that remembers little.
    #[test]
    fn rows_that_repeat_others_are_worth_less() {
        assert_eq!(pieces_worth_one(|_| 0.04), 1.0);
        assert_eq!(pieces_worth_one(|k| 0.3_f64.powi(k as i32)), 1.0);
        let memory = pieces_worth_one(|k| 0.8_f64.powi(k as i32));
        assert!((4.1..4.5).contains(&memory), "{memory}");
    }
}
