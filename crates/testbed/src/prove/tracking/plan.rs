//! The feed-forward of a model along the course: torques, and reference positions of the encoders.

use arm::Arm;
use effects::Effect;
use effects::drive::{ACTUATION_DELAY, JOINT_ELASTICITY, TORQUE_SATURATION};
use faults::{CaseMachine, LinkMotion};
use torque::{Corrected, Learned, Prediction, RigidBody, TorqueModel, Workspace};

use super::course::{Course, TICK};

/// The feed-forward of a model at the middles between ticks; `[tick × dof + joint]`.
#[derive(Clone)]
pub struct Plan {
    /// The torques of the rigid body and of effects (N m or N), as the drives report them.
    pub known: Vec<f64>,
    /// The learned torques (N m or N).
    pub learned: Vec<f64>,
    /// The difference between the encoders' readings and the links' positions (rad or m).
    beyond: Vec<f64>,
    /// The delay of each drive (s).
    delays: Vec<f64>,
}

impl Plan {
    fn new(course: &Course) -> Self {
        let zeros = || vec![0.0; course.middle.q.len()];
        Self { known: zeros(), learned: zeros(), beyond: zeros(), delays: vec![0.0; course.dof] }
    }

    /// The feed-forward of the URDF.
    pub fn nominal(arm: &Arm, course: &Course) -> Self {
        let mut plan = Self::new(course);
        let model = RigidBody::new(arm.clone());
        along(course, |row, workspace, [q, qd, qdd], prediction| {
            model.predict(workspace, q, qd, qdd, prediction);
            plan.known[row..row + q.len()].copy_from_slice(&prediction.rigid);
        });
        plan
    }

    /// The feed-forward of the URDF with the named effects. A delay is compensated by an earlier command, an encoder offset
    /// and the deflection of a spring by the reference of the encoder. Limits and gaps are not compensated.
    pub fn diagnosed(arm: &Arm, effects: &[Effect], course: &Course) -> anyhow::Result<Self> {
        let (model, mut plan) = (correction(arm, effects)?, Self::new(course));
        let offsets = model.encoder_offsets();
        let mut said = vec![0.0; course.dof];
        let mut tick = 0;
        along(course, |row, workspace, [q, qd, qdd], prediction| {
            for (j, said) in said.iter_mut().enumerate() {
                *said = q[j] - offsets[j];
                plan.beyond[row + j] = -offsets[j];
            }
            model.predict_at(course.middle_time(tick), workspace, &said, qd, qdd, prediction);
            for j in 0..q.len() {
                plan.known[row + j] = prediction.torque(j);
            }
            tick += 1;
        });
        for (j, joint) in arm.joints().iter().enumerate() {
            for effect in effects.iter().filter(|effect| effect.joint() == Some(&joint.name)) {
                if effect.is(&ACTUATION_DELAY) {
                    plan.delays[j] += effect.number("delay");
                } else if effect.is(&JOINT_ELASTICITY) {
                    let stiffness = effect.number("stiffness");
                    plan.stretch(arm, effects, &model, course, (j, stiffness))?;
                }
            }
        }
        Ok(plan)
    }

    /// A rotor that drives its link through a spring leads the link by the link's torque over the stiffness. Its
    /// acceleration differs accordingly.
    fn stretch(
        &mut self,
        arm: &Arm,
        effects: &[Effect],
        model: &Corrected,
        course: &Course,
        (j, stiffness): (usize, f64),
    ) -> anyhow::Result<()> {
        let is_beyond = |effect: &&Effect| effect.spec().is_beyond_the_drive;
        let beyond: Vec<Effect> = effects.iter().filter(is_beyond).cloned().collect();
        let links = Corrected::new(&arm.clone().with_rotor_inertias(&vec![0.0; arm.dof()]), &beyond)?;
        let mut ahead = Vec::with_capacity(course.middle.q.len() / course.dof);
        along(course, |_, workspace, [q, qd, qdd], prediction| {
            links.predict(workspace, q, qd, qdd, prediction);
            ahead.push(prediction.torque(j) / stiffness);
        });
        let inertia = model.torque_factor(j, None) * model.arm().joints()[j].rotor_inertia;
        for (tick, &here) in ahead.iter().enumerate() {
            let at = tick * course.dof + j;
            self.beyond[at] += here;
            if tick > 0 && tick + 1 < ahead.len() {
                self.known[at] += inertia * (ahead[tick + 1] - 2.0 * here + ahead[tick - 1]) / (TICK * TICK);
            }
        }
        Ok(())
    }

    /// This plan with the learned torques of `model`.
    pub fn with(mut self, model: &Learned, course: &Course) -> Self {
        along(course, |row, workspace, [q, qd, qdd], prediction| {
            model.predict(workspace, q, qd, qdd, prediction);
            self.learned[row..row + q.len()].copy_from_slice(&prediction.learned);
        });
        self
    }

    /// The feed-forward by the true machine's own laws.
    pub fn exact(machine: &CaseMachine<'_>, course: &Course) -> Self {
        let inverse = machine.inverse(&LinkMotion {
            start: course.middle_time(0),
            q: &course.middle.q,
            qd: &course.middle.qd,
            qdd: &course.middle.qdd,
        });
        Self {
            learned: vec![0.0; inverse.tau.len()],
            known: inverse.tau,
            beyond: inverse.beyond,
            delays: inverse.delays,
        }
    }

    /// The model's and the learned torque to command to joint `j` at a tick (N m or N), advanced by the delay of the drive.
    pub fn command(&self, tick: usize, j: usize) -> [f64; 2] {
        let dof = self.delays.len();
        let ticks = self.delays[j] / TICK;
        let (whole, part) = (ticks.floor() as usize, ticks.fract());
        let last = self.known.len() / dof - 1;
        let [at, next] = [tick + whole, tick + whole + 1].map(|tick| tick.min(last) * dof + j);
        [&self.known, &self.learned].map(|torque| torque[at] + part * (torque[next] - torque[at]))
    }

    /// The difference between the reference of the encoder of joint `j` and the course at a tick, and its rate (rad or m,
    /// per s).
    pub fn beyond(&self, tick: usize, j: usize) -> [f64; 2] {
        let dof = self.delays.len();
        let [before, after] = [tick.saturating_sub(1), tick].map(|tick| self.beyond[tick * dof + j]);
        [0.5 * (before + after), (after - before) / TICK]
    }
}

/// The named effects as a model of the torque that a drive must give. Torque limits are omitted, because they are no reason
/// to command less.
pub fn correction(arm: &Arm, effects: &[Effect]) -> anyhow::Result<Corrected> {
    let asked = effects.iter().filter(|effect| !effect.is(&TORQUE_SATURATION));
    Ok(Corrected::new(arm, &asked.cloned().collect::<Vec<_>>())?)
}

/// Calls `visit` for each middle of the course, with the index of the row, scratch, the motion and scratch for a
/// prediction.
fn along(course: &Course, mut visit: impl FnMut(usize, &mut Workspace, [&[f64]; 3], &mut Prediction)) {
    let dof = course.dof;
    let (mut workspace, mut prediction) = (Workspace::new(dof), Prediction::new(dof));
    let table = &course.middle;
    for row in (0..table.q.len()).step_by(dof) {
        let motion = [&table.q, &table.qd, &table.qdd].map(|signal| &signal[row..row + dof]);
        visit(row, &mut workspace, motion, &mut prediction);
    }
}
