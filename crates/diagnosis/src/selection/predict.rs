//! Prediction errors on all rows, at rest and in motion.

use effects::background::{FRICTION_CURVE, GAIN, LAG, OWN_FRICTION, OWN_LOAD};
use effects::{Cone, Term};

use crate::data::Data;
use crate::data::statistics::{deviation, rms};
use crate::regression::fit::Fit;
use crate::regression::table::Table;
use crate::report::JointFit;
use crate::thresholds::{
    LEAST_ROWS, POOR, POOR_ABOVE_NOISE, REMEMBERS, RESIDUAL_LAG, STRUCTURED, STRUCTURED_ABOVE_NOISE, SWINGING, SWINGS,
    SWINGS_ABOVE_NOISE,
};

/// The residual of the model with the effects and the background of `fit` on all rows of one joint. At rest, dry friction may hold
/// any torque within its cone, and the error is the distance to the cone.
pub fn augmented(data: &Data, table: &Table, fit: &Fit, joint: usize) -> Vec<f64> {
    residual(data, table, fit, joint, |_| true)
}

/// The residual of the exported model: the links' inertial parameters, the constant torques and the named effects, without the
/// background's corrections of friction and torque constants, the lag of all torques and the load of some recordings, which no file holds.
pub fn exported(data: &Data, table: &Table, fit: &Fit, joint: usize) -> Vec<f64> {
    let is_exported = |term: &Term| {
        let kept_apart = [&OWN_FRICTION, &FRICTION_CURVE, &GAIN, &LAG, &OWN_LOAD];
        kept_apart.iter().all(|law| !term.is(law))
    };
    residual(data, table, fit, joint, is_exported)
}

fn residual(data: &Data, table: &Table, fit: &Fit, joint: usize, counts: impl Fn(&Term) -> bool) -> Vec<f64> {
    let (columns, coefficients): (Vec<usize>, Vec<f64>) =
        fit.columns.iter().zip(&fit.coefficients).filter(|&(&column, _)| counts(&table.terms[column])).unzip();
    let mut residual = table.residual(joint, &columns, &coefficients);
    let dry: Vec<(usize, f64)> = fit
        .columns
        .iter()
        .zip(&fit.coefficients)
        .filter(|&(&column, _)| is_dry(table.terms[column], joint) && counts(&table.terms[column]))
        .map(|(&column, &value)| (column, value))
        .collect();
    if dry.is_empty() && !data.has_known_dry_friction(joint) {
        return residual;
    }
    let (columns, values): (Vec<usize>, Vec<f64>) = dry.iter().copied().unzip();
    let as_moving = table.torque(joint, &columns, &values);
    let rests = data.resting_rows(joint);
    let (loads, times) = data.loads_and_times(joint, &rests);
    for ((&row, load), time) in rests.iter().zip(loads).zip(times) {
        let (mut cone, mut middle) = (0.0, 0.0);
        let [subtracted, holds] = data.known_dry_at(joint, row);
        for &(column, value) in &dry {
            let term = table.terms[column];
            match term.law.cone {
                Cone::Level(level) => cone += value * level(&term, load, time),
                Cone::Middle => middle += value,
                Cone::No => {}
            }
        }
        let free = residual[row] + as_moving[row] - middle + subtracted;
        // Friction that is found beside a known one may be less than none.
        let cone = if holds > 0.0 { (holds + cone).max(0.0) } else { cone.abs() };
        residual[row] = free - free.clamp(-cone, cone);
    }
    residual
}

/// Whether a term is dry friction of a joint.
fn is_dry(term: Term, joint: usize) -> bool {
    !matches!(term.law.cone, Cone::No) && term.is_always() && term.joint() == Some(joint)
}

/// The errors on `joint`, nominal and with `fit`.
pub fn errors_with(data: &Data, table: &Table, fit: &Fit, joint: usize) -> JointFit {
    errors(data, table, joint, &augmented(data, table, fit, joint))
}

/// The errors on `joint`, nominal and `augmented`.
pub fn errors(data: &Data, table: &Table, joint: usize, augmented: &[f64]) -> JointFit {
    let (nominal, tau) = (&data.nominal[joint], &data.measured[joint]);
    let moving = &table.joints[joint].moving;
    let mut resting = vec![false; nominal.len()];
    for row in data.resting_rows(joint) {
        resting[row] = true;
    }
    let spread = |rows: &[usize]| deviation(rows.iter().map(|&row| tau[row]));
    let held = table.rows_of(|recording| !data.fitted[recording]);
    let train = table.rows_of(|recording| data.fitted[recording]);
    // A dead channel has no relative error.
    let over_spread =
        |error: f64, spread: f64| (data.scales.torque[joint] > 0.0 && spread > 0.0).then(|| error / spread);
    let over = |rows: &[usize], keep: &[bool], signal: &[f64]| -> Option<f64> {
        let kept: Vec<usize> = rows.iter().copied().filter(|&row| keep[row]).collect();
        let error = rms(kept.iter().map(|&row| signal[row]))?;
        over_spread(error, spread(&kept))
    };
    // A joint at rest may need the same torque all the time, so that the standard deviation is that of all rows.
    let at_rest = |signal: &[f64]| -> Option<f64> {
        let error = rms(held.iter().filter(|&&row| resting[row]).map(|&row| signal[row]))?;
        over_spread(error, spread(&held))
    };
    // Only samples in motion count. At rest, the measured torque depends on friction, a brake or the previous motion.
    let moves = held.iter().filter(|&&row| moving[row]).count() >= LEAST_ROWS;
    let counted = if moves { moving.clone() } else { vec![true; nominal.len()] };
    JointFit {
        torque_std: spread(&train),
        noise: data.noise[joint].sqrt(),
        held_out_nrmse_nominal: over(&held, &counted, nominal),
        held_out_nrmse_augmented: over(&held, &counted, augmented),
        held_out_nrmse_learned: None,
        held_out_nrmse_exported: None,
        held_out_nrmse_identified: None,
        held_out_nrmse_resting: at_rest(augmented),
        held_out_nrmse_resting_nominal: at_rest(nominal),
        train_nrmse_nominal: over(&train, moving, nominal).unwrap_or(0.0),
        train_nrmse_augmented: over(&train, moving, augmented).unwrap_or(0.0),
        residual_autocorrelation: autocorrelation(data, table, augmented, moving),
        residual_autocorrelation_nominal: autocorrelation(data, table, nominal, moving),
    }
}

/// The error (NRMSE) of a joint with the findings, if it is too large and too regular to be noise.
pub fn structured(fit: &JointFit) -> Option<f64> {
    let error = fit.error();
    let least = error.min(fit.train_nrmse_augmented);
    let is_structured = least >= STRUCTURED
        && least * fit.torque_std >= STRUCTURED_ABOVE_NOISE * fit.noise
        && fit.residual_autocorrelation > REMEMBERS;
    is_structured.then_some(error)
}

/// The part `counted` of the error (NRMSE) of a joint with the findings, if it is large and above the noise.
pub fn poor(fit: &JointFit, counted: f64) -> Option<f64> {
    let error = counted * fit.error();
    (error >= POOR && error * fit.torque_std >= POOR_ABOVE_NOISE * fit.noise).then_some(error)
}

/// The error (NRMSE) of a joint with the findings, if it is far above the noise and has lost its memory within [`RESIDUAL_LAG`], as that of a
/// link that swings against its drive.
pub fn swinging(fit: &JointFit) -> Option<f64> {
    let error = fit.error();
    let least = error.min(fit.train_nrmse_augmented);
    let swings = least >= SWINGING
        && least * fit.torque_std >= SWINGS_ABOVE_NOISE * fit.noise
        && fit.residual_autocorrelation < SWINGS;
    swings.then_some(error)
}

/// The autocorrelation of a signal over [`RESIDUAL_LAG`], on the rows that count.
pub fn autocorrelation(data: &Data, table: &Table, signal: &[f64], counts: &[bool]) -> f64 {
    let (mut product, mut power) = (0.0, 0.0);
    for (recording, rows) in table.rows.iter().enumerate() {
        let lag = (RESIDUAL_LAG / data.seconds[recording]).round().max(1.0) as usize;
        for row in rows.start..rows.end.saturating_sub(lag) {
            if counts[row] && counts[row + lag] {
                product += signal[row] * signal[row + lag];
                power += 0.5 * (signal[row].powi(2) + signal[row + lag].powi(2));
            }
        }
    }
    if power > 0.0 { product / power } else { 0.0 }
}
