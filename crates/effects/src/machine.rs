//! A machine to which effects are added: an arm, torques on its joints, and changes of its drives.

use std::fmt;
use std::sync::Arc;

use arm::{Arm, Inertia};
use nalgebra::Vector3;

/// The sign of a velocity: −1, 0 at rest, or 1.
pub fn sign(velocity: f64) -> f64 {
    if velocity == 0.0 { 0.0 } else { velocity.signum() }
}

/// The indices of the joints of an effect, 0 where it has none.
#[derive(Clone, Copy, Debug)]
pub struct JointIndices {
    /// The joint it is on.
    pub joint: usize,
    /// The other joint whose motion it depends on.
    pub other: usize,
}

/// The time and the load at which friction is evaluated.
#[derive(Clone, Copy, Debug)]
pub struct Circumstance {
    /// s on the recordings' own clock; `None` for a warm drive.
    pub time: Option<f64>,
    /// The torque of the links on the joint, which its gear transmits: the rigid torque without that of the rotor (N m or N).
    pub load: f64,
}

type Level = dyn Fn(f64, Circumstance) -> f64 + Send + Sync;

/// Friction whose direction is that of the joint's velocity and whose level varies slowly.
#[derive(Clone)]
pub struct Dry {
    level: Arc<Level>,
    bias: f64,
    depends_on_load: bool,
}

impl Dry {
    /// Friction with a `level`: the largest torque that it resists (N m or N), as a function of velocity and circumstance.
    pub fn new(level: impl Fn(f64, Circumstance) -> f64 + Send + Sync + 'static) -> Self {
        Self { level: Arc::new(level), bias: 0.0, depends_on_load: false }
    }

    /// This friction with an additional torque that is the same in both directions (N m or N).
    #[must_use]
    pub fn biased(mut self, bias: f64) -> Self {
        self.bias = bias;
        self
    }

    /// This friction with a level that depends on the load.
    #[must_use]
    pub fn loaded(mut self) -> Self {
        self.depends_on_load = true;
        self
    }

    /// The largest torque that it resists at a velocity (N m or N), averaged over both directions.
    pub fn level(&self, qd: f64, at: Circumstance) -> f64 {
        (self.level)(qd, at)
    }

    /// The torque that it adds in both directions alike (N m or N). Friction that differs by direction is a level and an
    /// offset.
    pub fn bias(&self) -> f64 {
        self.bias
    }

    /// Whether the level depends on the load.
    pub fn depends_on_load(&self) -> bool {
        self.depends_on_load
    }
}

impl fmt::Debug for Dry {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("Dry").field("bias", &self.bias).finish_non_exhaustive()
    }
}

/// The motion of all joints at one time (SI).
#[derive(Clone, Copy, Debug)]
pub struct State<'a> {
    /// Positions, as the encoders report them.
    pub q: &'a [f64],
    /// Velocities.
    pub qd: &'a [f64],
    /// Accelerations.
    pub qdd: &'a [f64],
}

type Torque = dyn Fn(usize, State<'_>) -> f64 + Send + Sync;

/// A torque on one joint, smooth in its own velocity.
#[derive(Clone)]
pub struct Smooth {
    /// The joint.
    pub joint: usize,
    /// Its onset (s); `None` if it always acts.
    pub onset: Option<f64>,
    /// Its coefficient if it is proportional to the joint's velocity (N m s/rad or N s/m).
    pub viscous: Option<f64>,
    torque: Arc<Torque>,
}

impl Smooth {
    /// The torque (N m or N) in a motion.
    pub fn torque(&self, state: State<'_>) -> f64 {
        (self.torque)(self.joint, state)
    }
}

impl fmt::Debug for Smooth {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut shown = formatter.debug_struct("Smooth");
        shown.field("joint", &self.joint).field("onset", &self.onset).finish_non_exhaustive()
    }
}

/// A force on the tool for a limited time.
#[derive(Clone, Debug)]
pub struct Contact {
    /// s, on the recordings' own clock.
    pub start: f64,
    /// s.
    pub end: f64,
    /// N, in the base's frame.
    pub force: Vector3<f64>,
}

/// A torque scale of a drive, from an onset on.
#[derive(Clone, Copy, Debug)]
pub struct Scaled {
    /// The joint.
    pub joint: usize,
    /// The torque reported over the true one.
    pub factor: f64,
    /// Its onset (s); `None` if it always acts.
    pub onset: Option<f64>,
}

/// A rotor that drives its link through a spring and a damper.
#[derive(Clone, Copy, Debug)]
pub struct Sprung {
    /// N m/rad or N/m.
    pub stiffness: f64,
    /// N m s/rad or N s/m.
    pub damping: f64,
}

/// An arm with the effects added to it; one entry per joint unless stated otherwise.
#[derive(Clone, Debug)]
pub struct Machine {
    /// The rigid arm, without rotors and payloads.
    pub arm: Arm,
    /// Rotor inertias (kg m² or kg).
    pub rotors: Vec<f64>,
    /// Bodies on the tool with their onsets (s); `None` for one that is always there.
    pub payloads: Vec<(Option<f64>, Inertia)>,
    /// The true position of each joint minus the encoder's (rad or m).
    pub encoder_offsets: Vec<f64>,
    /// Dry friction, with its joint.
    pub dry: Vec<(usize, Dry)>,
    /// All other torques on joints.
    pub smooth: Vec<Smooth>,
    /// Torque scales.
    pub factors: Vec<Scaled>,
    /// The largest torque (N m or N) as the drive reports it; infinite where there is no limit.
    pub limits: Vec<f64>,
    /// Forces on the tool.
    pub contacts: Vec<Contact>,
    /// The delay of each drive's torque (s).
    pub delays: Vec<f64>,
    /// The elastic transmission between rotor and link.
    pub springs: Vec<Option<Sprung>>,
    /// Half the gap between rotor and link (rad or m).
    pub gaps: Vec<f64>,
}

impl Machine {
    /// `arm` with its rotors and without effects.
    pub(crate) fn without_effects(arm: &Arm) -> Self {
        let dof = arm.dof();
        Self {
            arm: arm.clone(),
            rotors: arm.joints().iter().map(|joint| joint.rotor_inertia).collect(),
            payloads: Vec::new(),
            encoder_offsets: vec![0.0; dof],
            dry: Vec::new(),
            smooth: Vec::new(),
            factors: Vec::new(),
            limits: vec![f64::INFINITY; dof],
            contacts: Vec::new(),
            delays: vec![0.0; dof],
            springs: vec![None; dof],
            gaps: vec![0.0; dof],
        }
    }

    /// Adds a torque on a joint that is smooth in the joint's velocity: a function of the joint's index and the motion (N m or
    /// N).
    pub fn add_torque(
        &mut self,
        joint: usize,
        onset: Option<f64>,
        torque: impl Fn(usize, State<'_>) -> f64 + Send + Sync + 'static,
    ) {
        self.smooth.push(Smooth { joint, onset, viscous: None, torque: Arc::new(torque) });
    }

    /// Adds friction proportional to the velocity (N m s/rad or N s/m).
    pub fn add_viscous(&mut self, joint: usize, coefficient: f64) {
        self.smooth.push(Smooth {
            joint,
            onset: None,
            viscous: Some(coefficient),
            torque: Arc::new(move |joint, state| coefficient * state.qd[joint]),
        });
    }

    /// Changes the arm with one of its builders.
    pub fn change_arm(&mut self, change: impl FnOnce(Arm) -> Arm) {
        self.arm = change(self.arm.clone());
    }
}
