//! Figures over all joints.

use std::collections::BTreeMap;

use diagnosis::statistics::rms;
use report::numbers::nrmse;
use scoring::{HeldOutErrors, RobotScore};

/// The columns of errors, of a robot or of a joint.
pub const ERRORS: [&str; 6] = [
    "held-out error, URDF",
    "diagnosed",
    "published effects, fitted",
    "learned",
    "simulated position error (mrad or mm), URDF",
    "diagnosed",
];

/// The root mean square over the joints that have the figure; `None` if none has.
pub fn over_joints<T>(joints: &BTreeMap<String, T>, figure: impl Fn(&T) -> Option<f64>) -> Option<f64> {
    rms(joints.values().filter_map(figure))
}

/// The nominal, diagnosed and learned errors as text, `0.72 → 0.04 → 0.76`: root mean squares over the joints.
pub fn held_out(score: &RobotScore) -> String {
    let of = |figure: fn(&HeldOutErrors) -> Option<f64>| error(over_joints(&score.held_out, figure));
    let [nominal, diagnosed, learned] = [of(|e| e.nominal), of(|e| e.diagnosed), of(|e| e.learned)];
    format!("{nominal} → {diagnosed} → {learned}")
}

/// A relative error, a dash for none.
pub fn error(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), nrmse)
}
