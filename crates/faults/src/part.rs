//! The places of a machine that a fault can change: dry friction, drive, encoder, what lies between rotor and link, what acts on links,
//! the arm itself. Laws are torques (N m or N) that the motion costs on top of the rigid ones.
//!
//! The laws are this crate's own: a diagnosis is to find the effect, not its own formula.

use arm::{Arm, Inertia};

use crate::fault::external_contact::Contact;

/// One thing that the machine has, from `onset` on.
pub(crate) struct Part {
    /// s, on the recordings' clock; minus infinity if from the start.
    pub onset: f64,
    pub what: What,
}

/// One thing that a fault brings.
pub(crate) struct Piece {
    pub what: What,
    /// In which of the two machines it is.
    pub there: There,
}

/// In which machine a piece is: in the one with the fault, or in the one without it.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum There {
    /// In the machine with the fault, from its onset on.
    With,
    /// In both machines, from the start.
    Always,
    /// Only in the machine without the fault, from the start: the user believes it to be there, and it is not.
    Without,
}

/// What it is, and the joint it is on.
pub(crate) enum What {
    Dry(usize, Box<dyn DryLaw>),
    Drive(usize, Box<dyn DriveLaw>),
    Link(usize, Box<dyn LinkLaw>),
    /// Joint, other joint and the inertia of the drive that both turn (kg m²).
    CouplingInertia(usize, usize, f64),
    /// Reported over true.
    Scale(usize, f64),
    /// The most a drive applies, as it reports torque; softly or sharply.
    Limit(usize, f64, bool),
    /// s; a pure delay or a first-order lag.
    Delay(usize, f64, bool),
    /// What the encoder says too much (rad or m).
    Encoder(usize, f64),
    Elastic(usize, Connection),
    Body(Body),
    Contact(Contact),
}

impl What {
    /// A piece that remains when its fault is removed.
    pub(crate) fn stays(self) -> Piece {
        Piece {
            what: self,
            there: There::Always,
        }
    }

    /// A piece that is added when its fault is removed.
    pub(crate) fn comes_without(self) -> Piece {
        Piece {
            what: self,
            there: There::Without,
        }
    }
}

impl From<What> for Piece {
    fn from(what: What) -> Self {
        Self {
            what,
            there: There::With,
        }
    }
}

/// What lies between a rotor and its link; the encoder is the rotor's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Connection {
    /// N m/rad; `None`: stiff, yet resolved by the plant's step.
    pub stiffness: Option<f64>,
    /// N m s/rad; `None`: a quarter of the critical damping.
    pub damping: Option<f64>,
    /// rad.
    pub halfgap: f64,
    /// What the rotor has beyond what the drive is known to have (kg m²).
    pub more_rotor: f64,
    /// The torque at which the stiffness is twice what it is at none (N m); infinite: it does not harden.
    pub hardening: f64,
    /// Whether the gap's ends are rounded.
    pub round: bool,
}

/// A change of masses, drives or gravity.
pub(crate) enum Body {
    /// More inertia of a joint's drive (kg m² or kg).
    Rotor(usize, f64),
    /// Another arm for the arm.
    Changed(Box<dyn Fn(Arm) -> Arm + Send + Sync>),
    /// A mass at the tool.
    Payload(Inertia),
}

impl Body {
    /// The piece that makes another arm of the arm.
    pub(crate) fn changed(change: impl Fn(Arm) -> Arm + Send + Sync + 'static) -> Piece {
        What::Body(Self::Changed(Box::new(change))).into()
    }

    /// `arm` with it. Payloads must come last: they are not scaled with the links.
    pub(crate) fn put_into(&self, arm: Arm) -> Arm {
        match self {
            Self::Rotor(joint, inertia) => {
                let mut rotors: Vec<f64> = arm.joints().iter().map(|joint| joint.rotor_inertia).collect();
                rotors[*joint] += inertia;
                arm.with_rotor_inertias(&rotors)
            }
            Self::Changed(change) => change(arm),
            Self::Payload(payload) => arm.with_payload(payload),
        }
    }
}

/// A part of a joint's dry friction.
pub(crate) trait DryLaw: Send + Sync {
    /// Adds what it makes to what the parts before it made.
    fn add_to(&self, sum: &mut DrySum, at: &DryAt);

    /// Whether it depends on [`DryAt::rigid_load`].
    fn feels_rigid_load(&self) -> bool {
        false
    }
}

/// What dry friction may depend on.
#[derive(Clone, Copy)]
pub(crate) struct DryAt {
    pub velocity: f64,
    /// s, on the recordings' clock.
    pub time: f64,
    /// The rigid torque (N m or N).
    pub rigid_load: f64,
    /// What the drive gives, behind a low-pass filter of 20 ms (N m or N).
    pub drive_load: f64,
}

impl DryAt {
    /// At a velocity and a time, under the rigid load and the drive's.
    pub(crate) fn new(velocity: f64, time: f64, [rigid_load, drive_load]: [f64; 2]) -> Self {
        Self {
            velocity,
            time,
            rigid_load,
            drive_load,
        }
    }
}

/// What the parts of a joint's dry friction add up to: ± `level`, `bias` in both directions alike (N m or N), both times `factor`.
pub(crate) struct DrySum {
    pub level: f64,
    pub bias: f64,
    pub factor: f64,
}

/// Dry friction at a moment: ± `level`, and `bias` in both directions alike (N m or N).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Resistance {
    pub level: f64,
    pub bias: f64,
}

impl Resistance {
    /// So many times as much.
    pub(crate) fn times(self, factor: f64) -> Self {
        Self {
            level: factor * self.level,
            bias: factor * self.bias,
        }
    }
}

/// The dry friction that its parts make.
pub(crate) fn resistance<'a>(parts: impl Iterator<Item = &'a dyn DryLaw>, at: &DryAt) -> Resistance {
    let mut sum = DrySum {
        level: 0.0,
        bias: 0.0,
        factor: 1.0,
    };
    for part in parts {
        part.add_to(&mut sum, at);
    }
    // Asymmetry beyond the level would push, and a Stribeck dip or a cold drive below nothing too.
    let level = (sum.level * sum.factor).max(0.0);
    Resistance {
        level,
        bias: (sum.bias * sum.factor).clamp(-level, level),
    }
}

/// A torque on the drive's side of a joint, smooth or nearly so.
pub(crate) trait DriveLaw: Send + Sync {
    /// The torque at the drive's own position and velocity.
    fn torque(&self, q: f64, v: f64) -> f64;
}

/// A torque on the link's side of a joint; some remember, in one number of state.
pub(crate) trait LinkLaw: Send + Sync {
    /// The torque; the state becomes that of a `step` (s) later.
    fn torque(&self, at: At<'_>, state: &mut f64, step: f64) -> f64;
}

/// What a law on the link's side may depend on, of the whole arm.
#[derive(Clone, Copy, Debug)]
pub(crate) struct At<'a> {
    /// s, on the recordings' clock.
    pub time: f64,
    /// The joint that the law is on.
    pub joint: usize,
    /// Positions of all joints (rad or m).
    pub q: &'a [f64],
    /// Velocities of all joints.
    pub qd: &'a [f64],
}

impl At<'_> {
    /// Of the joint that the law is on (rad or m).
    pub(crate) fn position(&self) -> f64 {
        self.q[self.joint]
    }

    /// Of the joint that the law is on.
    pub(crate) fn velocity(&self) -> f64 {
        self.qd[self.joint]
    }
}
