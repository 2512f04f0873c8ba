//! Friction that is a multiple of that of the training recordings in the held-out ones, as that of drives that were warmer that day.

use crate::regression::fit::{Fit, Products};
use crate::search::problem::Problem;
use crate::search::study::Study;
use crate::thresholds::{MOST_HELD_OUT_FRICTION, OTHER_HELD_OUT_FRICTION};

/// The columns of the friction that `set` names on `joint`, with their coefficients in `fit`.
pub fn friction(problem: &Problem<'_>, set: &[usize], fit: &Fit, joint: usize) -> (Vec<usize>, Vec<f64>) {
    let is_friction = |c: &&usize| {
        let candidate = &problem.candidates[**c];
        let spec = candidate.hypothesis.spec();
        candidate.joint == Some(joint) && (spec.is_friction || spec.is_form_of_friction())
    };
    let columns: Vec<usize> =
        set.iter().filter(is_friction).flat_map(|&c| problem.candidates[c].columns.iter().copied()).collect();
    let values = fit.values(&columns);
    (columns, values)
}

/// The factor of the friction that `set` names on `joint` with which `fit` predicts the held-out recordings best, and the joint's residual
/// sum of squares with it.
pub fn best_factor(problem: &Problem<'_>, held: &Products, set: &[usize], fit: &Fit, joint: usize) -> (f64, f64) {
    let (friction, _) = friction(problem, set, fit, joint);
    // The sum of squares is a parabola of the factor.
    let rss = |factor: f64| {
        let scaled = fit.columns.iter().zip(&fit.coefficients);
        let scaled = scaled.map(|(column, value)| if friction.contains(column) { factor * value } else { *value });
        held.rss(problem.table, &fit.columns, &scaled.collect::<Vec<f64>>())[joint]
    };
    let [none, one, two] = [0.0, 1.0, 2.0].map(rss);
    let curvature = 0.5 * (two - 2.0 * one + none);
    if curvature <= 0.0 {
        return (1.0, one.max(0.0));
    }
    let factor = (0.5 * (none - one + curvature) / curvature).max(0.0);
    (factor, rss(factor).max(0.0))
}

/// Whether a factor is that of other friction, and not of friction that is nearly the same or that the fit does not determine.
pub fn is_other(factor: f64) -> bool {
    (factor - 1.0).abs() > OTHER_HELD_OUT_FRICTION
        && (1.0 / MOST_HELD_OUT_FRICTION..MOST_HELD_OUT_FRICTION).contains(&factor)
}

/// The friction of a joint in a held-out recording.
pub struct InRecording {
    /// The recording.
    pub recording: usize,
    /// Its friction over that of the training recordings.
    pub factor: f64,
    /// The root mean square of the joint's residual with this factor over that without it.
    pub remaining: f64,
}

/// The friction of `joint` in each held-out recording that moves it; `residual` is that of `fit` on all rows.
pub fn in_recordings(
    study: &Study,
    problem: &Problem<'_>,
    (set, fit): (&[usize], &Fit),
    residual: &[f64],
    joint: usize,
) -> Vec<InRecording> {
    let (columns, values) = friction(problem, set, fit, joint);
    if columns.is_empty() {
        return Vec::new();
    }
    let torque = study.table.torque(joint, &columns, &values);
    let moving = &study.table.joints[joint].moving;
    let held_out = (0..study.data.fitted.len()).filter(|&recording| !study.data.fitted[recording]);
    held_out
        .filter_map(|recording| {
            let (mut power, mut product, mut error) = (0.0, 0.0, 0.0);
            for row in study.table.rows[recording].clone().filter(|&row| moving[row]) {
                power += torque[row] * torque[row];
                product += torque[row] * residual[row];
                error += residual[row] * residual[row];
            }
            let more = product / power;
            let remaining = (1.0 - more * product / error).max(0.0).sqrt();
            (power > 0.0 && error > 0.0).then_some(InRecording { recording, factor: 1.0 + more, remaining })
        })
        .collect()
}
