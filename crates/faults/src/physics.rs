//! What a machine has that its URDF has not, read from the truth's own words.

use arm::{Arm, Inertia, Matrix3, Vector3};
use serde_json::Value;

use crate::error::FaultError;
use crate::law::{Dry, Link, Smooth};
use crate::truth::Injected;

mod forms;
mod read;
mod reader;

pub use forms::{EFFECTS, UNKNOWN, form_parameters, forms};
pub(crate) use read::parts;

/// One thing that the machine has, from `onset` on.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    /// s, on the recordings' clock; minus infinity if from the start.
    pub onset: f64,
    pub what: What,
}

/// What it is, and the joint it is on.
#[derive(Clone, Debug)]
pub(crate) enum What {
    Dry(usize, Dry),
    Smooth(usize, Smooth),
    Link(usize, Link),
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
#[derive(Clone, Debug)]
pub(crate) enum Body {
    Rotor(usize, f64),
    Link(usize, f64),
    All(f64),
    Turned(Vector3<f64>, f64),
    Payload(Inertia),
}

impl Body {
    /// `arm` with it. Payloads must come last: they are not scaled with the links.
    pub(crate) fn put_into(&self, arm: Arm) -> Arm {
        match self {
            Self::Rotor(joint, inertia) => {
                let mut rotors: Vec<f64> = arm.joints().iter().map(|joint| joint.rotor_inertia).collect();
                rotors[*joint] += inertia;
                arm.with_rotor_inertias(&rotors)
            }
            Self::Link(link, factor) => arm.with_scaled_link(*link, *factor),
            Self::All(factor) => arm.with_scaled_inertias(*factor),
            Self::Turned(axis, angle) => arm.with_turned_base(*axis, *angle),
            Self::Payload(payload) => arm.with_payload(payload),
        }
    }
}

/// A force on the tool (N, in the base's frame).
#[derive(Clone, Debug)]
pub(crate) struct Contact {
    pub start: f64,
    pub duration: f64,
    pub force: Vector3<f64>,
    pub shape: Shape,
}

/// How a force comes and goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Shape {
    Step,
    HalfSine,
    Decaying,
}

impl Contact {
    /// The force's part at `time` (s, on the recordings' clock).
    pub(crate) fn at(&self, time: f64) -> f64 {
        let x = (time - self.start) / self.duration;
        if !(0.0..1.0).contains(&x) {
            return 0.0;
        }
        match self.shape {
            Shape::Step => 1.0,
            Shape::HalfSine => (std::f64::consts::PI * x).sin(),
            Shape::Decaying => (-3.0 * x).exp() * (20.0 * x).min(1.0),
        }
    }
}

impl Injected {
    /// An effect on a joint, or on the whole arm, without parameters.
    pub fn new(effect: &str, joint: Option<&str>) -> Self {
        Self {
            effect: effect.to_owned(),
            joint: joint.map(str::to_owned),
            parameters: std::collections::BTreeMap::new(),
            form: None,
            onset: None,
            expressed_share: None,
        }
    }

    /// With a parameter.
    #[must_use]
    pub fn with(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.parameters.insert(name.to_owned(), value.into());
        self
    }

    /// In another functional form than the textbook's.
    #[must_use]
    pub fn formed(mut self, form: &str) -> Self {
        self.form = Some(form.to_owned());
        self
    }

    /// A parameter that is a number.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.parameters.get(name).and_then(Value::as_f64)
    }

    /// Refuses what cannot be concealed on `arm`.
    ///
    /// # Errors
    /// [`FaultError::Effect`], with the effect, what is wrong and the remedy.
    pub fn check(&self, arm: &Arm) -> Result<(), FaultError> {
        parts(self, arm, true).map(|_| ())
    }
}

/// Ixx Ixy Iyy Ixz Iyz Izz as a matrix.
pub(crate) fn tensor([xx, xy, yy, xz, yz, zz]: [f64; 6]) -> Matrix3<f64> {
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}
