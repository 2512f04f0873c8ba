//! What can go wrong with a torque model.

/// Why a torque model or a controller could not be made.
#[derive(Debug, thiserror::Error)]
pub enum TorqueError {
    /// A joint vector of another size than the arm.
    #[error("{what}: {found} values for an arm of {expected} joints")]
    Joints {
        /// What was given.
        what: String,
        /// How many values it has.
        found: usize,
        /// How many joints the arm has.
        expected: usize,
    },
    /// A number that must be finite and not negative.
    #[error("{what} of joint {joint} is {value}; it must be finite and not negative")]
    Gain {
        /// Which gain.
        what: &'static str,
        /// The joint, from 1.
        joint: usize,
        /// What was found.
        value: f64,
    },
    /// Nothing to learn from.
    #[error("no training samples")]
    NoSamples,
    /// The regression of one joint failed.
    #[error("joint {joint}: {source}")]
    Regression {
        /// The joint, from 1.
        joint: usize,
        /// What the regression says.
        source: gp::GpError,
    },
    /// An effect on a joint that the arm has not.
    #[error("{effect}: the robot has no joint \"{joint}\"; it has {}", known.join(", "))]
    UnknownJoint {
        /// The catalogue's name of the effect.
        effect: &'static str,
        /// The name that was given.
        joint: String,
        /// The arm's joints.
        known: Vec<String>,
    },
    /// A parameter of an effect that no physics has.
    #[error("{effect} of {joint}: {parameter} is {value}; it must be {requirement}")]
    Parameter {
        /// The catalogue's name of the effect.
        effect: &'static str,
        /// The joint's name, or `the whole arm`.
        joint: String,
        /// The parameter.
        parameter: &'static str,
        /// What was found.
        value: f64,
        /// What it must be.
        requirement: &'static str,
    },
}
