//! A rigid model with named effects: the corrected model of a diagnosis.

mod loads;
#[cfg(test)]
mod tests;

use arm::{Arm, Frame, Inertia};
use effects::{Circumstance, Effect, Machine, Scaled, State, sign};

use crate::error::TorqueError;
use crate::model::{Prediction, TorqueModel, Workspace};

/// An arm and the [`Effect`]s that its URDF omits.
///
/// The torque of joint j, in N m or N as the drive reports it, is
///
/// τ_j = clip( factor_j ( rigid_j(q + offset, q̇, q̈) + Σ effects_j(q, q̇, q̈) ), ± limit_j )
///
/// - *rigid* is the inverse dynamics of [`Self::arm`], which includes payload, link errors, scale, rotor inertias and
///   a rotated base. A payload is added after the links are scaled, and is not scaled with them.
/// - On a base that is rotated by `angle` about `axis`, gravity is rotated in the opposite direction:
///   g' = R(axis, angle)ᵀ g.
/// - Friction uses the exact sign of q̇, and is zero at rest. [`TorqueModel::predict`] assumes warm drives for thermal
///   drift; [`Self::predict_at`] uses the time. The load of load-dependent friction is what the gear transmits to the
///   links: rigid_j without the torque that accelerates the rotor, |rigid_j − I_j q̈_j|.
/// - An effect with an onset acts from then on; if no time is given, it acts.
/// - `q` is the position of the encoder, which springs and ripple use directly.
/// - Delay, elasticity and backlash are not functions of (q, q̇, q̈) and are omitted, as is a contact if no time is
///   given.
///
/// Effects of the same kind add up (factors are multiplied, the smaller limit applies, base rotations are applied one
/// after the other). Friction in the URDF is not included.
#[derive(Clone, Debug)]
pub struct Corrected {
    /// The arm with all payloads, and the effects that do not change the arm.
    machine: Machine,
    /// The arms before payloads are picked up, with the time (s) until which each applies, the earliest first.
    earlier: Vec<(f64, Arm)>,
    tool: Frame,
}

/// Whether an effect with this onset acts at `time`.
fn acts(onset: Option<f64>, time: Option<f64>) -> bool {
    !matches!((onset, time), (Some(onset), Some(time)) if time < onset)
}

impl Corrected {
    /// `arm` with `effects`.
    ///
    /// # Errors
    /// [`TorqueError`], naming effect, joint and value.
    pub fn new(arm: &Arm, effects: &[Effect]) -> Result<Self, TorqueError> {
        let mut machine = Machine::new(arm, effects)?;
        let rotors = std::mem::take(&mut machine.rotors);
        machine.change_arm(|arm| arm.with_rotor_inertias(&rotors));
        let mut payloads = std::mem::take(&mut machine.payloads);
        payloads.sort_by(|(a, _), (b, _): &(Option<f64>, Inertia)| {
            let key = |onset: &Option<f64>| onset.unwrap_or(f64::NEG_INFINITY);
            key(a).total_cmp(&key(b))
        });
        let mut earlier = Vec::new();
        for (onset, payload) in &payloads {
            if let Some(onset) = onset {
                earlier.push((*onset, machine.arm.clone()));
            }
            machine.change_arm(|arm| arm.with_payload(payload));
        }
        Ok(Self { machine, earlier, tool: arm.tool_frame() })
    }

    /// The rigid arm with all effects on its inertia or gravity, and with all payloads.
    pub fn arm(&self) -> &Arm {
        &self.machine.arm
    }

    /// The true position of each joint minus the encoder's (rad or m).
    pub fn encoder_offsets(&self) -> &[f64] {
        &self.machine.encoder_offsets
    }

    /// The effects that do not change the arm, such as delays, springs and gaps. Rotors and payloads are in
    /// [`Self::arm`].
    pub fn machine(&self) -> &Machine {
        &self.machine
    }

    /// The ratio of the torque of `joint` that the drive reports to the true torque, at `time` (s on the recordings'
    /// own clock); without a time, after all onsets.
    pub fn torque_factor(&self, joint: usize, time: Option<f64>) -> f64 {
        let acting = |scaled: &&Scaled| scaled.joint == joint && acts(scaled.onset, time);
        let acting = self.machine.factors.iter().filter(acting);
        acting.map(|scaled| scaled.factor).product()
    }

    /// The largest torque each drive applies (N m or N), as the drive reports it; infinite where there is no limit.
    pub fn torque_limits(&self) -> &[f64] {
        &self.machine.limits
    }

    /// Predicts as [`TorqueModel::predict`] does, at `time` (s on the recordings' own clock): with the thermal state
    /// of that time, and with a contact during its window.
    ///
    /// # Panics
    /// If a slice or the workspace is of another size than the arm.
    pub fn predict_at(
        &self,
        time: f64,
        workspace: &mut Workspace,
        q: &[f64],
        qd: &[f64],
        qdd: &[f64],
        prediction: &mut Prediction,
    ) {
        self.evaluate(Some(time), workspace, State { q, qd, qdd }, prediction);
    }

    fn evaluate(&self, time: Option<f64>, workspace: &mut Workspace, state: State<'_>, prediction: &mut Prediction) {
        let Prediction { rigid, effects, learned } = prediction;
        self.rigid_torque(time, workspace, state, rigid);
        effects.fill(0.0);
        learned.fill(0.0);
        for (joint, dry) in &self.machine.dry {
            let at = Circumstance { time, load: self.gear_load(*joint, rigid, state.qdd) };
            let speed = state.qd[*joint];
            let direction = sign(speed);
            effects[*joint] += direction * dry.level(speed, at) + direction.abs() * dry.bias();
        }
        self.add_smooth(time, workspace, state, effects);
        for (joint, effect) in effects.iter_mut().enumerate() {
            let limit = self.machine.limits[joint];
            let total = self.torque_factor(joint, time) * (rigid[joint] + *effect);
            // All parts but the rigid torque count as effects, including scale and limit.
            *effect = total.clamp(-limit, limit) - rigid[joint];
        }
    }

    /// The dry friction of each joint in a `prediction` for these velocities and accelerations at `time`, as the drive reports it: what
    /// it adds there beyond the torque that is the same in both directions, and the largest torque that it holds at rest (N m or N).
    pub fn dry_friction(&self, time: f64, qd: &[f64], qdd: &[f64], prediction: &Prediction) -> Vec<[f64; 2]> {
        let time = Some(time);
        let mut friction = vec![[0.0; 2]; self.dof()];
        for (joint, dry) in &self.machine.dry {
            let at = Circumstance { time, load: self.gear_load(*joint, &prediction.rigid, qdd) };
            let (direction, factor) = (sign(qd[*joint]), self.torque_factor(*joint, time));
            let added = direction * dry.level(qd[*joint], at) + (direction.abs() - 1.0) * dry.bias();
            friction[*joint][0] += factor * added;
            friction[*joint][1] += factor * dry.level(0.0, at);
        }
        friction
    }

    /// The torque that the gear of `joint` transmits to the links: the rigid torque without the rotor's.
    fn gear_load(&self, joint: usize, rigid: &[f64], qdd: &[f64]) -> f64 {
        rigid[joint] - self.machine.arm.joints()[joint].rotor_inertia * qdd[joint]
    }

    /// The inverse dynamics of the arm at `time`, at the true positions of the joints.
    fn rigid_torque(&self, time: Option<f64>, workspace: &mut Workspace, state: State<'_>, rigid: &mut [f64]) {
        let State { q, qd, qdd } = state;
        let Workspace { arm: scratch, input, .. } = workspace;
        let scratch = scratch.get_or_insert_with(|| arm::Workspace::new(&self.machine.arm));
        let standing = &mut input[..q.len()];
        for ((standing, q), offset) in standing.iter_mut().zip(q).zip(&self.machine.encoder_offsets) {
            *standing = q + offset;
        }
        let earlier = self.earlier.iter().find(|(until, _)| !acts(Some(*until), time));
        let arm = earlier.map_or(&self.machine.arm, |(_, arm)| arm);
        arm.inverse_dynamics(scratch, standing, qd, qdd, rigid);
    }

    /// Adds all torques except rigid body and dry friction to `tau`; the workspace contains the true positions.
    fn add_smooth(&self, time: Option<f64>, workspace: &mut Workspace, state: State<'_>, tau: &mut [f64]) {
        for smooth in self.machine.smooth.iter().filter(|smooth| acts(smooth.onset, time)) {
            tau[smooth.joint] += smooth.torque(state);
        }
        self.add_contacts(time, workspace, tau);
    }
}

impl TorqueModel for Corrected {
    fn dof(&self) -> usize {
        self.machine.arm.dof()
    }

    fn predict(&self, workspace: &mut Workspace, q: &[f64], qd: &[f64], qdd: &[f64], prediction: &mut Prediction) {
        self.evaluate(None, workspace, State { q, qd, qdd }, prediction);
    }

    fn variance<'w>(&self, _: &'w mut Workspace, _: &[f64], _: &[f64], _: &[f64]) -> Option<&'w [f64]> {
        None
    }
}
