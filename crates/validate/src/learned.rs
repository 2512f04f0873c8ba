//! The learned correction, for comparison: Independent Joint Learning on a few hundred samples of the same recordings.

use arm::Arm;
use torque::{Inputs, Learned, LengthScales, Prediction, Sample, Samples, TorqueModel, TrainingOptions, Workspace};

use crate::error::ValidateError;

/// Motion and torque of one recording, `[joint][row]`, joints in the arm's order: rad, rad/s, rad/s², N m (or m …, N).
#[derive(Clone, Copy)]
pub struct RecordedMotion<'a> {
    /// Positions.
    pub q: &'a [Vec<f64>],
    /// Velocities.
    pub qd: &'a [Vec<f64>],
    /// Accelerations.
    pub qdd: &'a [Vec<f64>],
    /// Torques, with the same filter as the motion. Not used in prediction.
    pub tau: &'a [Vec<f64>],
    /// Whether a joint moves. At rest, friction is undetermined.
    pub moving: &'a [Vec<bool>],
}

/// Options of the learned correction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LearnedOptions {
    /// The largest number of samples. The cost grows with its cube, and more samples do not improve the prediction of other
    /// motions where the Newton-Euler inputs do not determine the torque (the speed of a joint parallel to the one before it).
    pub samples: usize,
    /// Options of the regressions.
    pub training: TrainingOptions,
}

impl Default for LearnedOptions {
    fn default() -> Self {
        Self {
            samples: 150,
            training: TrainingOptions { lengths: LengthScales::PerInput, starts: 1, max_iterations: 8, inducing: None },
        }
    }
}

impl RecordedMotion<'_> {
    fn rows(&self) -> usize {
        self.q.first().map_or(0, Vec::len)
    }

    fn row(signal: &[Vec<f64>], row: usize, into: &mut [f64]) {
        for (value, joint) in into.iter_mut().zip(signal) {
            *value = joint[row];
        }
    }
}

/// Learns the residual of `arm` in `training`.
///
/// The rows are spread evenly over those in which all joints move that ever move, or, if these are too few, over those in which
/// any joint moves. Equal inputs give equal bits.
///
/// # Errors
/// [`ValidateError::Learning`], if no row can be learned from or a regression fails.
///
/// # Panics
/// If a signal has not one row per joint of the arm, or rows of different lengths.
pub fn learn(arm: &Arm, training: &[RecordedMotion<'_>], options: &LearnedOptions) -> Result<Learned, ValidateError> {
    let dof = arm.dof();
    let mut samples = Samples::new(dof);
    let mut row_of = [vec![0.0; dof], vec![0.0; dof], vec![0.0; dof], vec![0.0; dof]];
    for (recording, row) in training_rows(training, options.samples) {
        let motion = &training[recording];
        for (into, signal) in row_of.iter_mut().zip([motion.q, motion.qd, motion.qdd, motion.tau]) {
            RecordedMotion::row(signal, row, into);
        }
        let [q, qd, qdd, tau] = &row_of;
        samples.push(Sample { q, qd, qdd, tau }).map_err(ValidateError::Learning)?;
    }
    Learned::on_top_of(arm, Inputs::NewtonEuler13, &samples, &options.training).map_err(ValidateError::Learning)
}

/// Learns as [`learn`] does, and predicts the torque of the rows of `held_out`: `[recording][joint][row]` (N m or N).
///
/// # Errors
/// Those of [`learn`].
///
/// # Panics
/// Those of [`learn`].
pub fn predict(
    arm: &Arm,
    training: &[RecordedMotion<'_>],
    held_out: &[RecordedMotion<'_>],
    options: &LearnedOptions,
) -> Result<Vec<Vec<Vec<f64>>>, ValidateError> {
    let dof = arm.dof();
    let model = learn(arm, training, options)?;
    let mut row_of = [vec![0.0; dof], vec![0.0; dof], vec![0.0; dof], vec![0.0; dof]];
    let mut workspace = Workspace::new(dof);
    let mut prediction = Prediction::new(dof);
    let mut predict = |motion: &RecordedMotion<'_>| {
        let mut torque = vec![Vec::with_capacity(motion.rows()); dof];
        for row in 0..motion.rows() {
            let [q, qd, qdd, _] = &mut row_of;
            for (into, signal) in [(&mut *q, motion.q), (&mut *qd, motion.qd), (&mut *qdd, motion.qdd)] {
                RecordedMotion::row(signal, row, into);
            }
            model.predict(&mut workspace, q, qd, qdd, &mut prediction);
            for (joint, torque) in torque.iter_mut().enumerate() {
                torque.push(prediction.torque(joint));
            }
        }
        torque
    };
    Ok(held_out.iter().map(&mut predict).collect())
}

/// The rows to learn from, as (recording, row).
fn training_rows(training: &[RecordedMotion<'_>], samples: usize) -> Vec<(usize, usize)> {
    let ever = |joint: usize| training.iter().any(|motion| motion.moving[joint].contains(&true));
    let joints = training.first().map_or(0, |motion| motion.moving.len());
    let movers: Vec<usize> = (0..joints).filter(|&joint| ever(joint)).collect();
    let rows_where = |fits: &dyn Fn(&RecordedMotion<'_>, usize) -> bool| -> Vec<(usize, usize)> {
        let rows = training.iter().enumerate();
        rows.flat_map(|(recording, motion)| (0..motion.rows()).map(move |row| (recording, row)))
            .filter(|&(recording, row)| fits(&training[recording], row))
            .collect()
    };
    let mut rows = rows_where(&|motion, row| movers.iter().all(|&joint| motion.moving[joint][row]));
    if rows.len() < 4 * samples {
        rows = rows_where(&|motion, row| movers.iter().any(|&joint| motion.moving[joint][row]));
    }
    let count = samples.min(rows.len());
    (0..count).map(|k| rows[(2 * k + 1) * rows.len() / (2 * count)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use effects::Effect;
    use effects::friction::VISCOUS_FRICTION;
    use recording::statistics::mean_square;
    use std::time::Instant;
    use torque::Corrected;

    struct Data([Vec<Vec<f64>>; 4], Vec<Vec<bool>>);

    impl Data {
        /// The PUMA under `model` for `rows` rows of a hundredth of a second; `variant` shifts the motion.
        fn new(model: &dyn TorqueModel, rows: usize, variant: f64) -> Self {
            let mut data = Self([(); 4].map(|()| vec![Vec::new(); 6]), vec![vec![true; rows]; 6]);
            let mut workspace = Workspace::new(6);
            let mut prediction = Prediction::new(6);
            for row in 0..rows {
                let time = 0.01 * row as f64;
                let omega = |j: usize| 0.9 + 0.17 * j as f64 + variant;
                let q: Vec<f64> = (0..6).map(|j| 0.7 * (omega(j) * time).sin()).collect();
                let qd: Vec<f64> = (0..6).map(|j| 0.7 * omega(j) * (omega(j) * time).cos()).collect();
                let qdd: Vec<f64> = (0..6).map(|j| -omega(j).powi(2) * q[j]).collect();
                model.predict(&mut workspace, &q, &qd, &qdd, &mut prediction);
                for j in 0..6 {
                    // Deterministic noise.
                    let noise = 0.02 * ((row * 7919 + j * 104_729) % 1000) as f64 / 1000.0;
                    for (signal, value) in self_signals(&mut data.0, j).into_iter().zip([
                        q[j],
                        qd[j],
                        qdd[j],
                        prediction.torque(j) + noise,
                    ]) {
                        signal.push(value);
                    }
                }
            }
            data
        }

        fn motion(&self) -> RecordedMotion<'_> {
            let [q, qd, qdd, tau] = &self.0;
            RecordedMotion { q, qd, qdd, tau, moving: &self.1 }
        }
    }

    fn self_signals(signals: &mut [Vec<Vec<f64>>; 4], joint: usize) -> Vec<&mut Vec<f64>> {
        signals.iter_mut().map(|signal| &mut signal[joint]).collect()
    }

    fn puma() -> Arm {
        Arm::from_urdf_text(include_str!("../../../assets/puma560.urdf"), "puma560.urdf").expect("it is an arm")
    }

    #[test]
    fn friction_is_learned() {
        let arm = puma();
        let viscous =
            |joint: usize| Effect::of(&VISCOUS_FRICTION).on(arm.joints()[joint].name.clone()).with("coefficient", 8.0);
        let effects: Vec<Effect> = (0..6).map(viscous).collect();
        let truth = Corrected::new(&arm, &effects).expect("they are physical");
        let training = [Data::new(&truth, 2500, 0.0), Data::new(&truth, 2500, 0.05)];
        let held_out = Data::new(&truth, 2500, 0.1);
        let motions: Vec<RecordedMotion<'_>> = training.iter().map(Data::motion).collect();
        let started = Instant::now();
        let options = LearnedOptions::default();
        let predicted = predict(&arm, &motions, &[held_out.motion()], &options).expect("it learns");
        println!("learned in {:.3} s", started.elapsed().as_secs_f64());
        let nominal = Data::new(&Corrected::new(&arm, &[]).expect("nothing is physical"), 2500, 0.1);
        for joint in 0..6 {
            let tau = &held_out.0[3][joint];
            let rms = |other: &[f64]| mean_square(tau.iter().zip(other).map(|(a, b)| a - b)).sqrt();
            let (before, after) = (rms(&nominal.0[3][joint]), rms(&predicted[0][joint]));
            assert!(after < 0.5 * before, "joint {joint}: {before} → {after}");
        }
        let again = predict(&arm, &motions, &[held_out.motion()], &options).expect("it learns");
        assert_eq!(predicted, again);
    }

    #[test]
    fn rows_at_rest_are_not_learned_from() {
        let truth = Corrected::new(&puma(), &[]).expect("nothing is physical");
        let mut data = Data::new(&truth, 100, 0.0);
        for row in 0..40 {
            for joint in 0..6 {
                data.1[joint][row] = false;
            }
        }
        let rows = training_rows(&[data.motion()], 10);
        assert_eq!(rows.len(), 10);
        assert!(rows.iter().all(|(_, row)| (40..100).contains(row)));
        assert!(predict(&puma(), &[], &[data.motion()], &LearnedOptions::default()).is_err());
    }
}
