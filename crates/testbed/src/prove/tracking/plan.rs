//! The feed-forward of a model along the course: torques, and what the encoders are to say.

use arm::Arm;
use effects::Effect;
use effects::drive::{ActuationDelay, JointElasticity, TorqueSaturation};
use faults::{CaseMachine, LinkMotion};
use torque::{Corrected, Learned, Prediction, RigidBody, TorqueModel, Workspace};

use super::course::{Course, TICK};

/// What a model says of the middles of the course; `[tick × dof + joint]`.
#[derive(Clone)]
pub struct Plan {
    /// Torques of all that has a law (N m or N), as the drives report them.
    pub known: Vec<f64>,
    /// Torques that were learned.
    pub learned: Vec<f64>,
    /// What the encoders say beyond the links' positions (rad or m).
    beyond: Vec<f64>,
    /// How late each drive acts (s).
    delays: Vec<f64>,
}

impl Plan {
    fn new(course: &Course) -> Self {
        let zeros = || vec![0.0; course.middle.q.len()];
        Self {
            known: zeros(),
            learned: zeros(),
            beyond: zeros(),
            delays: vec![0.0; course.dof],
        }
    }

    /// The URDF alone.
    pub fn nominal(arm: &Arm, course: &Course) -> Self {
        let mut plan = Self::new(course);
        let model = RigidBody::new(arm.clone());
        along(course, |row, workspace, [q, qd, qdd], prediction| {
            model.predict(workspace, q, qd, qdd, prediction);
            plan.known[row..row + q.len()].copy_from_slice(&prediction.rigid);
        });
        plan
    }

    /// The URDF and the effects named: torques, delays made up for by commanding early, encoder offsets and the give of a spring by
    /// where the encoder is sent. Limits and gaps stay what they are.
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
                if effect.is(&ActuationDelay) {
                    plan.delays[j] += effect.number("delay");
                } else if effect.is(&JointElasticity) {
                    let stiffness = effect.number("stiffness");
                    plan.stretch(arm, effects, &model, course, (j, stiffness))?;
                }
            }
        }
        Ok(plan)
    }

    /// A rotor behind a spring goes ahead of its link by the link's torque over the stiffness, and is accelerated accordingly.
    fn stretch(
        &mut self,
        arm: &Arm,
        effects: &[Effect],
        model: &Corrected,
        course: &Course,
        (j, stiffness): (usize, f64),
    ) -> anyhow::Result<()> {
        let is_behind = |effect: &&Effect| effect.spec().is_behind_the_drive;
        let behind: Vec<Effect> = effects.iter().filter(is_behind).cloned().collect();
        let links = Corrected::new(&arm.clone().with_rotor_inertias(&vec![0.0; arm.dof()]), &behind)?;
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

    /// With what was learned on top of it.
    pub fn with(mut self, model: &Learned, course: &Course) -> Self {
        along(course, |row, workspace, [q, qd, qdd], prediction| {
            model.predict(workspace, q, qd, qdd, prediction);
            self.learned[row..row + q.len()].copy_from_slice(&prediction.learned);
        });
        self
    }

    /// The true machine's own laws.
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

    /// The torques, known and learned, that joint `j` is to be commanded at a tick so that they act when they are needed.
    pub fn command(&self, tick: usize, j: usize) -> [f64; 2] {
        let dof = self.delays.len();
        let ticks = self.delays[j] / TICK;
        let (whole, part) = (ticks.floor() as usize, ticks.fract());
        let last = self.known.len() / dof - 1;
        let [at, next] = [tick + whole, tick + whole + 1].map(|tick| tick.min(last) * dof + j);
        [&self.known, &self.learned].map(|torque| torque[at] + part * (torque[next] - torque[at]))
    }

    /// What the encoder of joint `j` is to say at a tick, and at what rate, beyond the course (rad or m).
    pub fn beyond(&self, tick: usize, j: usize) -> [f64; 2] {
        let dof = self.delays.len();
        let [before, after] = [tick.saturating_sub(1), tick].map(|tick| self.beyond[tick * dof + j]);
        [0.5 * (before + after), (after - before) / TICK]
    }
}

/// The named effects as a model of what a drive must give: what cuts its torque is no reason to ask for less.
pub fn correction(arm: &Arm, effects: &[Effect]) -> anyhow::Result<Corrected> {
    let asked = effects.iter().filter(|effect| !effect.is(&TorqueSaturation));
    Ok(Corrected::new(arm, &asked.cloned().collect::<Vec<_>>())?)
}

/// Goes along the middles of the course; `visit` gets the row's place, scratch, and the motion.
fn along(course: &Course, mut visit: impl FnMut(usize, &mut Workspace, [&[f64]; 3], &mut Prediction)) {
    let dof = course.dof;
    let (mut workspace, mut prediction) = (Workspace::new(dof), Prediction::new(dof));
    let table = &course.middle;
    for row in (0..table.q.len()).step_by(dof) {
        let motion = [&table.q, &table.qd, &table.qdd].map(|signal| &signal[row..row + dof]);
        visit(row, &mut workspace, motion, &mut prediction);
    }
}
