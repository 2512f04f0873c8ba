//! The plant: an arm that moves under torques.

mod events;

use arm::Arm;

use crate::engine::Engine;
use crate::error::PlantError;
use crate::friction::DryFriction;
use crate::options::{PlantOptions, check_count, extrapolation_weights};

/// Faster than any robot's joint (rad/s or m/s). rapier silently puts a body with infinite values to rest, so that a
/// diverging motion must be detected earlier.
const FASTEST: f64 = 1e6;

/// The true arm, a rapier multibody on a fixed base, driven by joint torques.
///
/// Joint vectors have one entry per joint, base to tip: rad, rad/s, rad/s² and N m, or m, m/s, m/s² and N for a
/// prismatic joint. Positions are not wrapped, and limits are not enforced.
pub struct Plant {
    engine: Engine,
    friction: DryFriction,
    weights: Vec<f64>,
    names: Vec<String>,
    step: f64,
    steps: u64,
    q: Vec<f64>,
    qd: Vec<f64>,
    /// The result of a trial interval.
    trial_q: Vec<f64>,
    trial_qd: Vec<f64>,
}

impl Plant {
    /// A plant of `arm`, with its rotor inertias and its gravity, at q = 0 and at rest.
    ///
    /// # Errors
    /// [`PlantError`], if an option does not fit the arm, or if rapier cannot simulate one of its links.
    pub fn new(arm: &Arm, options: &PlantOptions) -> Result<Self, PlantError> {
        options.check(arm)?;
        if let Some(joint) = arm.massless_joint() {
            let joint = arm.joints()[joint].name.clone();
            return Err(PlantError::Massless { joint });
        }
        let zeros = vec![0.0; arm.dof()];
        Ok(Self {
            engine: Engine::new(arm, &options.viscous)?,
            friction: DryFriction::new(&options.coulomb, arm.dof()),
            weights: extrapolation_weights(options.order),
            names: arm.joints().iter().map(|joint| joint.name.clone()).collect(),
            step: options.step,
            steps: 0,
            q: zeros.clone(),
            qd: zeros.clone(),
            trial_q: zeros.clone(),
            trial_qd: zeros,
        })
    }

    /// The number of joints.
    pub fn dof(&self) -> usize {
        self.q.len()
    }

    /// The joints' positions (rad or m).
    pub fn q(&self) -> &[f64] {
        &self.q
    }

    /// The joints' velocities (rad/s or m/s).
    pub fn qd(&self) -> &[f64] {
        &self.qd
    }

    /// The time since the plant was made or reset (s).
    pub fn time(&self) -> f64 {
        self.steps as f64 * self.step
    }

    /// Whether dry friction holds joint `i` at rest.
    pub fn is_stuck(&self, i: usize) -> bool {
        self.friction.is_stuck(i)
    }

    /// Sets the levels of dry friction, one value per joint (N m or N); they may differ from step to step.
    ///
    /// # Errors
    /// [`PlantError::Count`] if there is not one value per joint, [`PlantError::Value`] if one is negative or not finite.
    pub fn set_dry_friction(&mut self, levels: &[f64]) -> Result<(), PlantError> {
        let what = "the dry friction";
        check_count(what, levels, self.dof())?;
        if let Some(i) = levels.iter().position(|level| !(level.is_finite() && *level >= 0.0)) {
            let (joint, value) = (self.names[i].clone(), levels[i]);
            return Err(PlantError::Value { what, joint, value });
        }
        self.friction.set_levels(levels);
        Ok(())
    }

    /// Sets the state to the positions `q` and velocities `qd`; the time continues.
    ///
    /// # Errors
    /// [`PlantError::Count`] if there is not one value per joint, [`PlantError::Diverged`] if one is out of bounds.
    pub fn set_state(&mut self, q: &[f64], qd: &[f64]) -> Result<(), PlantError> {
        check_count("the position", q, self.dof())?;
        check_count("the velocity", qd, self.dof())?;
        self.check_bounds(q, qd)?;
        self.q.copy_from_slice(q);
        self.qd.copy_from_slice(qd);
        self.friction.release();
        Ok(())
    }

    /// Resets the state to q = 0 at rest, and the time to 0.
    pub fn reset(&mut self) {
        self.q.fill(0.0);
        self.qd.fill(0.0);
        self.steps = 0;
        self.friction.release();
    }

    /// Advances by one step under the constant torques `tau`.
    ///
    /// # Errors
    /// [`PlantError::Count`] if there is not one torque per joint; [`PlantError::Diverged`] if the torques or the
    /// motion exceed all bounds. The state is then that before the step, or of the last event within it.
    pub fn step(&mut self, tau: &[f64]) -> Result<(), PlantError> {
        check_count("the torque", tau, self.dof())?;
        self.check_bounds(tau, &self.qd)?;
        if self.friction.is_dry() {
            self.step_with_friction(tau, self.step)?;
        } else {
            for (i, &torque) in tau.iter().enumerate() {
                self.engine.drive(i, torque, false);
            }
            self.advance(self.step);
            self.accept()?;
        }
        self.steps += 1;
        Ok(())
    }

    /// Writes the accelerations that rapier computes in the present state under the torques `tau`, friction included,
    /// to `qdd`.
    ///
    /// # Errors
    /// [`PlantError::Count`] if there is not one torque and one acceleration per joint.
    pub fn accelerations(&mut self, tau: &[f64], qdd: &mut [f64]) -> Result<(), PlantError> {
        check_count("the torque", tau, self.dof())?;
        check_count("the acceleration", qdd, self.dof())?;
        if self.friction.is_dry() {
            self.settle(tau);
        }
        for (i, &torque) in tau.iter().enumerate() {
            self.engine.drive(i, torque + self.friction.torque(i), self.friction.is_stuck(i));
        }
        self.engine.probe(&self.q, &self.qd, qdd);
        Ok(())
    }

    /// Tries an interval of `time` seconds from the present state under the present torques, by extrapolated rapier
    /// steps. There is no event of dry friction within it.
    fn advance(&mut self, time: f64) {
        self.trial_q.copy_from_slice(&self.q);
        self.trial_qd.copy_from_slice(&self.qd);
        for (n, weight) in self.weights.iter().enumerate() {
            self.engine.load(&self.q, &self.qd);
            self.engine.run(time, n + 1);
            // Sums of differences have smaller rounding errors, and leave a joint that does not move exactly where it
            // is.
            for (i, (q, qd)) in self.engine.state().enumerate() {
                self.trial_q[i] += weight * (q - self.q[i]);
                self.trial_qd[i] += weight * (qd - self.qd[i]);
            }
        }
    }

    /// Makes the end of the trial the present state.
    fn accept(&mut self) -> Result<(), PlantError> {
        self.check_bounds(&self.trial_q, &self.trial_qd)?;
        self.q.copy_from_slice(&self.trial_q);
        self.qd.copy_from_slice(&self.trial_qd);
        Ok(())
    }

    /// Refuses positions or torques that are not finite, and velocities beyond those of any robot.
    fn check_bounds(&self, q: &[f64], qd: &[f64]) -> Result<(), PlantError> {
        let is_bounded = |(q, qd): (&f64, &f64)| q.is_finite() && qd.abs() < FASTEST;
        match q.iter().zip(qd).position(|joint| !is_bounded(joint)) {
            None => Ok(()),
            Some(i) => Err(PlantError::Diverged { joint: self.names[i].clone(), time: self.time() }),
        }
    }
}
