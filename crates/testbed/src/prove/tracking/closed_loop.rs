//! The closed loop on a case's machine: computed torque with the same gains for all models.

use arm::Arm;
use diagnosis::statistics;
use faults::{CaseMachine, FaultError, VelocityFilter};
use torque::{Command, Controller, RigidBody};

use super::course::Course;
use super::plan::Plan;
use super::{Model, Tracked};
use crate::scenario::Scenario;

/// A run under a model; `[tick × dof + joint]`.
pub struct Run {
    /// The positions of the links (rad or m); empty if the loop left all bounds.
    pub links: Vec<f64>,
    /// The commanded torques (N m or N); empty if the loop left all bounds.
    #[cfg_attr(not(feature = "viewer"), expect(dead_code, reason = "the viewer is its reader"))]
    pub tau: Vec<f64>,
    /// The number of ticks in which an effort limit cut the torque, one per joint.
    cut: Vec<usize>,
}

/// The reference velocity with which the filtered measured velocity is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rate {
    /// The unfiltered reference velocity, as in the loop of the recordings. The lag of the filter is then an error with
    /// every model.
    AsItIs,
    /// The reference velocity passes the same filter, so that only model errors remain.
    Filtered,
}

/// Tracks the course on `machine` with the gains of `task` and the feed-forward of `plan`.
///
/// The feedback's mass matrix is that of `arm`: the URDF of the case with the drives' baseline rotor inertias.
///
/// # Errors
/// If the controller does not fit the arm.
pub fn run(
    machine: &CaseMachine<'_>,
    arm: &Arm,
    task: &Scenario,
    course: &Course,
    plan: &Plan,
    rate: Rate,
) -> anyhow::Result<Run> {
    let dof = course.dof;
    // The feed-forward comes from the plan, not from the controller's own model.
    let model = RigidBody::new(arm.clone());
    let mut controller = Controller::new(&model, arm.clone(), task.feedback.clone())?;
    let mut command = Command::new(dof);
    let (mut error, mut error_rate) = (vec![0.0; dof], vec![0.0; dof]);
    let mut cut = vec![0; dof];
    let begin: Vec<f64> = (0..dof).map(|j| course.at.q[j] + plan.beyond(0, j)[0]).collect();
    let mut wanted: Vec<VelocityFilter> = begin.iter().map(|&q| VelocityFilter::new(q)).collect();
    let driven = machine.drive(course.begin, &begin, course.ticks, |seen, torque| {
        for j in 0..dof {
            let at = seen.tick * dof + j;
            let [beyond, its_rate] = plan.beyond(seen.tick, j);
            wanted[j].take(course.at.q[at] + beyond);
            error[j] = wanted[j].position - seen.q[j];
            error_rate[j] = match rate {
                Rate::Filtered => wanted[j].velocity,
                Rate::AsItIs => course.at.qd[at] + its_rate,
            } - seen.qd[j];
            let [known, learned] = plan.command(seen.tick, j);
            (command.feedforward.rigid[j], command.feedforward.learned[j]) = (known, learned);
        }
        controller.feed_back(seen.q, &error, &error_rate, &mut command);
        torque.copy_from_slice(&command.torque);
        for (count, &is_cut) in cut.iter_mut().zip(&command.saturated) {
            *count += usize::from(is_cut);
        }
    });
    let (links, tau) = match driven {
        Ok(driven) => (driven.links, driven.tau),
        // An arm that leaves all bounds with a model is a result, not an error.
        Err(FaultError::Plant(_)) => (Vec::new(), Vec::new()),
        Err(error) => return Err(error.into()),
    };
    Ok(Run { links, tau, cut })
}

impl Run {
    /// The tracking error of the links; `other` is the run of the same model with [`Rate::Filtered`].
    pub fn tracked(&self, model: Model, other: &Self, course: &Course) -> Tracked {
        let (rms, largest) = self.errors(course);
        Tracked {
            error: statistics::rms(rms.iter().copied()),
            error_without_lag: statistics::rms(other.errors(course).0),
            cut: match rms.is_empty() {
                true => Vec::new(),
                false => self.cut.iter().map(|&count| count as f64 / course.ticks as f64).collect(),
            },
            model,
            rms,
            largest,
        }
    }

    /// Root mean square and largest, one per joint; empty if the loop left all bounds.
    fn errors(&self, course: &Course) -> (Vec<f64>, Vec<f64>) {
        if self.links.is_empty() {
            return (Vec::new(), Vec::new());
        }
        let dof = course.dof;
        let first = course.run_in * dof;
        let ticks = (course.ticks - course.run_in) as f64;
        let (mut rms, mut largest) = (vec![0.0; dof], vec![0.0_f64; dof]);
        let rows = self.links.iter().zip(&course.at.q).enumerate().skip(first);
        for (k, (q, wanted)) in rows {
            let error = wanted - q;
            rms[k % dof] += error * error / ticks;
            largest[k % dof] = largest[k % dof].max(error.abs());
        }
        (rms.into_iter().map(f64::sqrt).collect(), largest)
    }
}
