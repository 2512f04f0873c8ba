//! A step of a plant with dry friction, divided where a joint stops or breaks away.
//!
//! Extrapolation requires a smooth motion, and with dry friction the motion is smooth only between events. Therefore a
//! joint's friction is a constant torque while the joint slides in one direction and a lock while it sticks; a step
//! within which a joint stops or breaks away is divided at that event.

use arm::DMatrix;

use super::Plant;
use crate::complementarity::{holding_torques, locking_torques};
use crate::error::PlantError;
use crate::friction::Contact;

/// A velocity (rad/s or m/s), or a distance of a torque from its level (N m or N), up to this size counts as the
/// event.
const AT_EVENT: f64 = 1e-12;

/// The largest number of times that the interval around an event is divided.
const CUTS: usize = 60;

/// The largest number of events of one step, per joint; events beyond it are left to the next step.
const EVENTS_A_JOINT: usize = 8;

impl Plant {
    /// [`Plant::step`] over `remaining` seconds for an arm with dry friction.
    pub(super) fn step_with_friction(&mut self, tau: &[f64], mut remaining: f64) -> Result<(), PlantError> {
        self.friction.pinned.fill(false);
        for _ in 0..EVENTS_A_JOINT * self.dof() {
            self.settle(tau);
            self.try_interval(tau, remaining);
            let Some(mut joint) = self.friction.violated(None) else {
                return self.accept();
            };
            let mut until = self.locate(tau, joint, remaining);
            // At the event of this joint, another joint may be past its own event, which was earlier then.
            for _ in 0..self.dof() {
                let Some(earlier) = self.friction.violated(Some(joint)) else {
                    break;
                };
                joint = earlier;
                until = self.locate(tau, joint, until);
            }
            if until > 0.0 {
                self.accept()?;
                remaining -= until;
            } else {
                self.friction.pinned[joint] = true;
            }
            if !self.friction.is_stuck(joint) {
                self.qd[joint] = 0.0;
            }
        }
        self.settle(tau);
        self.try_interval(tau, remaining);
        for i in 0..self.dof() {
            if self.friction.margins[i] < 0.0 {
                self.trial_qd[i] = 0.0;
            }
        }
        self.accept()
    }

    /// Determines in the present state, for every joint, whether it sticks or in which direction it slides.
    pub(super) fn settle(&mut self, tau: &[f64]) {
        let friction = &mut self.friction;
        for (i, contact) in friction.contacts.iter_mut().enumerate() {
            *contact = match (friction.levels[i] > 0.0, self.qd[i] != 0.0) {
                (false, _) => Contact::Sliding(0.0),
                (true, true) => Contact::Sliding(self.qd[i].signum()),
                (true, false) => Contact::Stuck,
            };
        }
        let resting = friction.stuck();
        if resting.is_empty() {
            return;
        }
        let limits: Vec<f64> =
            resting.iter().map(|&i| if friction.pinned[i] { f64::INFINITY } else { friction.levels[i] }).collect();
        let (response, free) = self.contact_problem(tau, &resting, false);
        let holding = holding_torques(&response, &free, &limits);
        for ((&i, torque), limit) in resting.iter().zip(holding).zip(limits) {
            if torque.abs() >= limit {
                self.friction.contacts[i] = Contact::Sliding(-torque.signum());
            }
        }
    }

    /// Tries an interval, and computes how far every joint is from its event at the end of it.
    fn try_interval(&mut self, tau: &[f64], time: f64) {
        for (i, torque) in tau.iter().enumerate() {
            self.engine.drive(i, torque + self.friction.torque(i), self.friction.is_stuck(i));
        }
        self.advance(time);
        let friction = &mut self.friction;
        for (i, margin) in friction.margins.iter_mut().enumerate() {
            *margin = match friction.contacts[i] {
                Contact::Sliding(sign) if sign != 0.0 => sign * self.trial_qd[i],
                _ => f64::INFINITY,
            };
        }
        let stuck = friction.stuck();
        if stuck.is_empty() {
            return;
        }
        let (response, free) = self.contact_problem(tau, &stuck, true);
        for (&i, torque) in stuck.iter().zip(locking_torques(&response, &free)) {
            if !self.friction.pinned[i] {
                self.friction.margins[i] = self.friction.levels[i] - torque.abs();
            }
        }
    }

    /// Shortens the trial, which takes `until` seconds and passes the event of `joint`, so that it ends at that event.
    ///
    /// Returns the new duration (s). It is 0, without a trial, if the joint is past its event during the whole
    /// interval. Source: the Illinois method (Dowell and Jarratt 1971).
    fn locate(&mut self, tau: &[f64], joint: usize, until: f64) -> f64 {
        let (mut after, mut margin_after) = (until, self.friction.margins[joint]);
        let (mut before, mut margin_before) = (0.0, self.qd[joint].abs());
        if margin_before == 0.0 {
            // A joint that has just started to slide or to stick may begin exactly at its event; the interval must
            // begin before the event.
            let mut cuts = 0..CUTS;
            before = after;
            while margin_before <= 0.0 {
                if cuts.next().is_none() {
                    return 0.0;
                }
                before *= 0.125;
                self.try_interval(tau, before);
                margin_before = self.friction.margins[joint];
                if margin_before < 0.0 {
                    (after, margin_after) = (before, margin_before);
                }
            }
        }
        let mut latest_is_after = None;
        for _ in 0..CUTS {
            let middle = before + (after - before) * margin_before / (margin_before - margin_after);
            self.try_interval(tau, middle);
            let margin = self.friction.margins[joint];
            let is_after = margin < 0.0;
            if is_after {
                (after, margin_after) = (middle, margin);
                margin_before *= if latest_is_after == Some(true) { 0.5 } else { 1.0 };
            } else {
                (before, margin_before) = (middle, margin);
                margin_after *= if latest_is_after == Some(false) { 0.5 } else { 1.0 };
            }
            latest_is_after = Some(is_after);
            // The joint must be released past its level; at its level it would stick again.
            let arrived = margin.abs() <= AT_EVENT || after - before <= f64::EPSILON * until;
            if arrived && (is_after || !self.friction.is_stuck(joint)) {
                return middle;
            }
        }
        self.try_interval(tau, after);
        after
    }

    /// For joints at rest, in the present state or at the end of the trial: the response of their accelerations to
    /// each other's torques, and their accelerations without friction.
    fn contact_problem(&mut self, tau: &[f64], resting: &[usize], of_trial: bool) -> (DMatrix<f64>, Vec<f64>) {
        for (i, torque) in tau.iter().enumerate() {
            self.engine.drive(i, torque + self.friction.torque(i), false);
        }
        let (q, qd) = if of_trial { (&self.trial_q, &self.trial_qd) } else { (&self.q, &self.qd) };
        self.engine.probe(q, qd, &mut self.friction.qdd);
        let mut response = DMatrix::zeros(resting.len(), resting.len());
        for (b, &j) in resting.iter().enumerate() {
            let column = self.engine.inverse_mass_column(j);
            for (a, &i) in resting.iter().enumerate() {
                response[(a, b)] = column[i];
            }
        }
        (response, resting.iter().map(|&i| self.friction.qdd[i]).collect())
    }
}
