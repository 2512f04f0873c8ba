//! A rigid model with named effects put in: the corrected model of a diagnosis.

mod check;
mod laws;
mod loads;
#[cfg(test)]
mod tests;

use arm::{Arm, Frame, Inertia, Vector3};

use self::laws::{Circumstance, Dry, Law, Smooth, sign};
use crate::effect::Effect;
use crate::error::TorqueError;
use crate::model::{Prediction, TorqueModel, Workspace};

/// A force on the tool for a while.
#[derive(Clone, Debug)]
struct Contact {
    start: f64,
    end: f64,
    force: Vector3<f64>,
}

/// An arm and the [`Effect`]s that its URDF leaves out.
///
/// The torque of joint j, in N m (N) as the drive reports it, is
///
/// τ_j = clip( factor_j ( rigid_j(q + offset, q̇, q̈) + Σ effects_j(q, q̇, q̈) ), ± limit_j )
///
/// - *rigid* is the inverse dynamics of [`Self::arm`]: payload, link errors, scale, rotor inertias and a turned base are
///   in it. A payload is added after links are scaled, and is not scaled with them.
/// - A base turned by `angle` about `axis` turns gravity, seen from it, the other way: g' = R(axis, angle)ᵀ g.
/// - The friction forms take the exact sign of q̇, and nothing at rest. [`TorqueModel::predict`] takes a drifting friction
///   as warm; [`Self::predict_at`] knows the time. The load of load-dependent friction is |rigid_j|.
/// - What sets in at an onset acts from then on; where no time is given, it acts.
/// - `q` is what the encoder says; springs and ripple take it as it is.
/// - Delay, elasticity and backlash are no functions of (q, q̇, q̈) and are left out, as is a contact where no time is given.
///
/// Effects that come twice add up (factors multiply, the smaller limit holds, base turns follow each other).
/// Friction that the URDF gives is not part of it.
#[derive(Clone, Debug)]
pub struct Corrected {
    arm: Arm,
    /// The arm before something is picked up, until when (s), the earliest first.
    earlier: Vec<(f64, Arm)>,
    tool: Frame,
    encoder_offsets: Vec<f64>,
    dry: Vec<(usize, Dry)>,
    /// The joint, the law, and when it sets in.
    smooth: Vec<(usize, Smooth, Option<f64>)>,
    /// Of each joint, the torque reported over the true one, and from when on (s).
    factors: Vec<(usize, f64, Option<f64>)>,
    limits: Vec<f64>,
    contacts: Vec<Contact>,
}

/// Whether what sets in at `onset` acts at `time`.
fn acts(onset: Option<f64>, time: Option<f64>) -> bool {
    !matches!((onset, time), (Some(onset), Some(time)) if time < onset)
}

impl Corrected {
    /// `arm` with `effects`.
    ///
    /// # Errors
    /// [`TorqueError::UnknownJoint`] or [`TorqueError::Parameter`], naming effect, joint and value.
    pub fn new(arm: &Arm, effects: &[Effect]) -> Result<Self, TorqueError> {
        let dof = arm.dof();
        let mut model = Self {
            arm: arm.clone(),
            earlier: Vec::new(),
            tool: arm.tool_frame(),
            encoder_offsets: vec![0.0; dof],
            dry: Vec::new(),
            smooth: Vec::new(),
            factors: Vec::new(),
            limits: vec![f64::INFINITY; dof],
            contacts: Vec::new(),
        };
        let mut rotors: Vec<f64> = arm.joints().iter().map(|joint| joint.rotor_inertia).collect();
        let mut payloads = Vec::new();
        for effect in effects {
            check::check(effect)?;
            let joint = effect
                .joint()
                .map(|name| check::joint_of(arm, effect, name))
                .transpose()?;
            model.take(effect, joint, &mut rotors, &mut payloads)?;
        }
        model.arm = model.arm.with_rotor_inertias(&rotors);
        payloads.sort_by(|(a, _), (b, _): &(Option<f64>, Inertia)| {
            let key = |onset: &Option<f64>| onset.unwrap_or(f64::NEG_INFINITY);
            key(a).total_cmp(&key(b))
        });
        for (onset, payload) in &payloads {
            if let Some(onset) = onset {
                model.earlier.push((*onset, model.arm.clone()));
            }
            model.arm = model.arm.with_payload(payload);
        }
        Ok(model)
    }

    fn take(
        &mut self,
        effect: &Effect,
        joint: Option<usize>,
        rotors: &mut [f64],
        payloads: &mut Vec<(Option<f64>, Inertia)>,
    ) -> Result<(), TorqueError> {
        let Some(j) = joint else {
            // The arm is moved out and back: builders take it whole.
            let arm = self.arm.clone();
            match *effect {
                Effect::Payload {
                    mass,
                    com,
                    inertia,
                    onset,
                } => {
                    let (com, tensor) = (Vector3::from(com), check::tensor(inertia));
                    payloads.push((onset, Inertia { mass, com, tensor }));
                }
                Effect::InertialScale { factor } => self.arm = arm.with_scaled_inertias(factor),
                Effect::GravityMisalignment { angle, axis } => {
                    self.arm = arm.with_turned_base(Vector3::from(axis), angle);
                }
                Effect::ExternalContact { start, duration, force } => self.contacts.push(Contact {
                    start,
                    end: start + duration,
                    force: Vector3::from(force),
                }),
                _ => {}
            }
            return Ok(());
        };
        match *effect {
            Effect::LinkInertialError { relative, .. } => {
                self.arm = self.arm.clone().with_scaled_link(j, 1.0 + relative);
            }
            Effect::RotorInertia { inertia, .. } => rotors[j] += inertia,
            Effect::EncoderOffset { offset, .. } => self.encoder_offsets[j] -= offset,
            Effect::TorqueScale { factor, onset, .. } => self.factors.push((j, factor, onset)),
            Effect::TorqueSaturation { limit, .. } => self.limits[j] = self.limits[j].min(limit),
            _ => {
                let other = match effect {
                    Effect::TransmissionCoupling { other, .. } => Some(check::joint_of(&self.arm, effect, other)?),
                    _ => None,
                };
                // The reaction on the other joint is the same with the two exchanged.
                if let (Some(o), Some(Law::Smooth(smooth))) = (other, laws::law(effect, joint)) {
                    self.smooth.push((o, smooth, None));
                }
                match laws::law(effect, other) {
                    Some(Law::Dry(dry)) => self.dry.push((j, dry)),
                    Some(Law::Smooth(smooth)) => self.smooth.push((j, smooth, effect.onset())),
                    None => {}
                }
            }
        }
        Ok(())
    }

    /// The rigid arm with all that changes its inertia or gravity, and all that is ever picked up.
    pub fn arm(&self) -> &Arm {
        &self.arm
    }

    /// How far each joint stands beyond what its encoder says (rad or m).
    pub fn encoder_offsets(&self) -> &[f64] {
        &self.encoder_offsets
    }

    /// The torque of `joint` as the drive reports it over the true one, at `time` (s on the recordings' own clock); without
    /// a time, after all onsets.
    pub fn torque_factor(&self, joint: usize, time: Option<f64>) -> f64 {
        let acting = |(j, _, onset): &&(usize, f64, Option<f64>)| *j == joint && acts(*onset, time);
        self.factors
            .iter()
            .filter(acting)
            .map(|(_, factor, _)| factor)
            .product()
    }

    /// The largest torque each drive applies (N m or N), as the drive reports it; infinite where there is no limit.
    pub fn torque_limits(&self) -> &[f64] {
        &self.limits
    }

    /// As [`TorqueModel::predict`], at `time` (s on the recordings' own clock): friction that drifts is as it was then, and
    /// a contact acts while it lasts.
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
        self.evaluate(Some(time), workspace, q, qd, qdd, prediction);
    }

    fn evaluate(
        &self,
        time: Option<f64>,
        workspace: &mut Workspace,
        q: &[f64],
        qd: &[f64],
        qdd: &[f64],
        prediction: &mut Prediction,
    ) {
        let Prediction {
            rigid,
            effects,
            learned,
        } = prediction;
        self.rigid_torque(time, workspace, [q, qd, qdd], rigid);
        effects.fill(0.0);
        learned.fill(0.0);
        for (joint, dry) in &self.dry {
            let at = Circumstance {
                time,
                load: rigid[*joint],
            };
            let direction = sign(qd[*joint]);
            effects[*joint] += direction * dry.level(qd[*joint], at) + direction.abs() * dry.bias();
        }
        self.add_smooth(time, workspace, q, qd, qdd, effects);
        for (joint, effect) in effects.iter_mut().enumerate() {
            let limit = self.limits[joint];
            let total = self.torque_factor(joint, time) * (rigid[joint] + *effect);
            // What is not rigid is an effect, a scale and a cut too.
            *effect = total.clamp(-limit, limit) - rigid[joint];
        }
    }

    /// The inverse dynamics at the angles where the joints stand, of the arm as it is at `time`.
    fn rigid_torque(&self, time: Option<f64>, workspace: &mut Workspace, [q, qd, qdd]: [&[f64]; 3], rigid: &mut [f64]) {
        let Workspace {
            arm: scratch, input, ..
        } = workspace;
        let scratch = scratch.get_or_insert_with(|| arm::Workspace::new(&self.arm));
        let standing = &mut input[..q.len()];
        for ((standing, q), offset) in standing.iter_mut().zip(q).zip(&self.encoder_offsets) {
            *standing = q + offset;
        }
        let earlier = self.earlier.iter().find(|(until, _)| !acts(Some(*until), time));
        let arm = earlier.map_or(&self.arm, |(_, arm)| arm);
        arm.inverse_dynamics(scratch, standing, qd, qdd, rigid);
    }

    /// Adds all but rigid body and dry friction to `tau`; the workspace knows where the joints stand.
    fn add_smooth(
        &self,
        time: Option<f64>,
        workspace: &mut Workspace,
        q: &[f64],
        qd: &[f64],
        qdd: &[f64],
        tau: &mut [f64],
    ) {
        for (joint, smooth, _) in self.smooth.iter().filter(|(.., onset)| acts(*onset, time)) {
            tau[*joint] += smooth.torque(*joint, q, qd, qdd);
        }
        self.add_contacts(time, workspace, tau);
    }
}

impl TorqueModel for Corrected {
    fn dof(&self) -> usize {
        self.arm.dof()
    }

    fn predict(&self, workspace: &mut Workspace, q: &[f64], qd: &[f64], qdd: &[f64], prediction: &mut Prediction) {
        self.evaluate(None, workspace, q, qd, qdd, prediction);
    }

    fn variance<'w>(&self, _: &'w mut Workspace, _: &[f64], _: &[f64], _: &[f64]) -> Option<&'w [f64]> {
        None
    }
}
