//! The places at which a fault can change a machine: dry friction, drive, encoder, the connection of rotor and link,
//! torques on links, the arm itself. Laws are torques (N m or N) that the motion requires in addition to the rigid
//! ones.
//!
//! The laws are independent of those of the diagnosis: a diagnosis must find the effect, not its own formula.

use std::f64::consts::PI;

use arm::{Arm, Inertia, Vector3};

use crate::motion::TICK;

/// The number of commands that a drive stores, which bounds its delay (ticks).
pub(crate) const STORED_COMMANDS: usize = 128;

/// The longest delay (s) that a drive can have.
pub(crate) const LONGEST_DELAY: f64 = (STORED_COMMANDS - 2) as f64 * TICK;

/// One property of the machine, which is present from `onset` on.
pub(crate) struct Part {
    /// Time on the recordings' clock (s); minus infinity if it is present from the start.
    pub onset: f64,
    pub what: Property,
}

/// One property that a fault adds to the machine.
pub(crate) struct Piece {
    pub what: Property,
    /// In which of the two machines it is.
    pub there: Presence,
}

/// Where a piece is present: in the machine with the fault, in the one without it, or in both.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Presence {
    /// In the machine with the fault, from its onset on.
    With,
    /// In both machines, from the start.
    Always,
    /// Only in the machine without the fault, from the start: the user's model has it, and the machine with the fault
    /// does not.
    Without,
}

/// The property itself, with its joint.
pub(crate) enum Property {
    Dry(usize, Box<dyn DryLaw>),
    Drive(usize, Box<dyn DriveLaw>),
    Link(usize, Box<dyn LinkLaw>),
    /// Joint, other joint and the inertia of the drive that both move (kg m²).
    CouplingInertia(usize, usize, f64),
    /// The ratio of the reported to the true torque.
    Scale(usize, f64),
    /// The largest torque that a drive applies, as it is reported; with a soft or a sharp limit.
    Limit(usize, f64, bool),
    /// Time (s); a pure delay or a first-order lag.
    Delay(usize, f64, bool),
    /// The error of the encoder (rad or m).
    Encoder(usize, f64),
    Elastic(usize, Connection),
    Body(Body),
    Contact(Contact),
}

impl Property {
    /// A piece that remains when its fault is removed.
    pub(crate) fn in_both_machines(self) -> Piece {
        Piece { what: self, there: Presence::Always }
    }

    /// A piece that is added when its fault is removed.
    pub(crate) fn only_without_fault(self) -> Piece {
        Piece { what: self, there: Presence::Without }
    }
}

impl From<Property> for Piece {
    fn from(what: Property) -> Self {
        Self { what, there: Presence::With }
    }
}

/// The connection between a rotor and its link; the encoder is on the rotor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Connection {
    /// Stiffness (N m/rad); `None`: the highest that the plant's step resolves.
    pub stiffness: Option<f64>,
    /// Damping (N m s/rad); `None`: a quarter of the critical damping.
    pub damping: Option<f64>,
    /// The width of the gap (rad).
    pub halfgap: f64,
    /// The rotor's inertia in addition to the known inertia of the drive (kg m²).
    pub more_rotor: f64,
    /// The torque at which the stiffness is twice that at zero torque (N m); infinite if the spring does not harden.
    pub hardening: f64,
    /// Whether the ends of the gap are rounded.
    pub round: bool,
}

/// A change of masses, drives or gravity.
pub(crate) enum Body {
    /// Additional inertia of a joint's drive (kg m² or kg).
    Rotor(usize, f64),
    /// Replaces the arm by another one.
    Changed(Box<dyn Fn(Arm) -> Arm + Send + Sync>),
    /// A mass at the tool.
    Payload(Inertia),
}

impl Body {
    /// The piece that replaces the arm by another one.
    pub(crate) fn changed(change: impl Fn(Arm) -> Arm + Send + Sync + 'static) -> Piece {
        Property::Body(Self::Changed(Box::new(change))).into()
    }

    /// `arm` with this change. Payloads must come last, because they are not scaled with the links.
    pub(crate) fn applied_to(&self, arm: Arm) -> Arm {
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

/// A force on the tool (N, in the base's frame).
pub(crate) struct Contact {
    /// s, on the recordings' clock.
    pub start: f64,
    /// s.
    pub duration: f64,
    pub force: Vector3<f64>,
    pub course: TimeCourse,
}

/// The time course of a force.
#[derive(Clone, Copy)]
pub(crate) enum TimeCourse {
    Step,
    HalfSine,
    Decaying,
}

impl Contact {
    /// The share of the force at `time` (s, on the recordings' clock).
    pub(crate) fn at(&self, time: f64) -> f64 {
        let x = (time - self.start) / self.duration;
        if !(0.0..1.0).contains(&x) {
            return 0.0;
        }
        match self.course {
            TimeCourse::Step => 1.0,
            TimeCourse::HalfSine => (PI * x).sin(),
            TimeCourse::Decaying => (-3.0 * x).exp() * (20.0 * x).min(1.0),
        }
    }
}

/// A part of a joint's dry friction.
pub(crate) trait DryLaw: Send + Sync {
    /// Adds its contribution to that of the parts before it.
    fn add_to(&self, sum: &mut DrySum, at: &DryAt);

    /// Whether it depends on [`DryAt::rigid_load`].
    fn depends_on_rigid_load(&self) -> bool {
        false
    }
}

/// The variables of dry friction.
#[derive(Clone, Copy)]
pub(crate) struct DryAt {
    pub velocity: f64,
    /// Time on the recordings' clock (s).
    pub time: f64,
    /// The rigid torque (N m or N).
    pub rigid_load: f64,
    /// The torque of the drive behind a low-pass filter of 20 ms (N m or N).
    pub drive_load: f64,
}

impl DryAt {
    /// At a velocity and a time, under the rigid load and that of the drive.
    pub(crate) fn new(velocity: f64, time: f64, [rigid_load, drive_load]: [f64; 2]) -> Self {
        Self { velocity, time, rigid_load, drive_load }
    }
}

/// The sum of the parts of a joint's dry friction: ±`level`, and `bias` in both directions (N m or N), both multiplied
/// by `factor`.
pub(crate) struct DrySum {
    pub level: f64,
    pub bias: f64,
    pub factor: f64,
}

/// Dry friction at one time: ±`level`, and `bias` in both directions (N m or N).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Resistance {
    pub level: f64,
    pub bias: f64,
}

impl Resistance {
    /// Multiplied by a factor.
    pub(crate) fn times(self, factor: f64) -> Self {
        Self { level: factor * self.level, bias: factor * self.bias }
    }
}

/// The dry friction of its parts.
pub(crate) fn resistance<'a>(parts: impl Iterator<Item = &'a dyn DryLaw>, at: &DryAt) -> Resistance {
    let mut sum = DrySum { level: 0.0, bias: 0.0, factor: 1.0 };
    for part in parts {
        part.add_to(&mut sum, at);
    }
    // With an asymmetry larger than the level, or with a negative Stribeck or thermal factor, friction would drive the
    // joint.
    let level = (sum.level * sum.factor).max(0.0);
    Resistance { level, bias: (sum.bias * sum.factor).clamp(-level, level) }
}

/// A smooth, or nearly smooth, torque on the drive's side of a joint.
pub(crate) trait DriveLaw: Send + Sync {
    /// The torque at the drive's own position and velocity.
    fn torque(&self, q: f64, v: f64) -> f64;
}

/// A torque on the link's side of a joint; some depend on the past, through one state variable.
pub(crate) trait LinkLaw: Send + Sync {
    /// The torque; the state is advanced by `step` (s).
    fn torque(&self, at: At<'_>, state: &mut f64, step: f64) -> f64;
}

/// The variables of a law on the link's side, for the whole arm.
#[derive(Clone, Copy, Debug)]
pub(crate) struct At<'a> {
    /// Time on the recordings' clock (s).
    pub time: f64,
    /// The joint of the law.
    pub joint: usize,
    /// Positions of all joints (rad or m).
    pub q: &'a [f64],
    /// Velocities of all joints (rad/s or m/s).
    pub qd: &'a [f64],
}

impl At<'_> {
    /// The position of the law's joint (rad or m).
    pub(crate) fn position(&self) -> f64 {
        self.q[self.joint]
    }

    /// The velocity of the law's joint (rad/s or m/s).
    pub(crate) fn velocity(&self) -> f64 {
        self.qd[self.joint]
    }
}
