//! Errors of effects.

/// Why an effect does not fit an arm.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EffectError {
    /// An effect on a joint that the arm does not have.
    #[error("{effect}: the robot has no joint \"{joint}\"; it has {}", known.join(", "))]
    UnknownJoint {
        /// The catalogue's name of the effect.
        effect: &'static str,
        /// The name that was given.
        joint: String,
        /// The arm's joints.
        known: Vec<String>,
    },
    /// An effect between two joints that are the same one.
    #[error("{effect} of {joint}: \"other\" is the same joint; give another one")]
    OwnJoint {
        /// The catalogue's name of the effect.
        effect: &'static str,
        /// The joint's name.
        joint: String,
    },
    /// A parameter value that is physically impossible.
    #[error("{effect} of {joint}: {parameter} is {value}; it must be {requirement}")]
    Parameter {
        /// The catalogue's name of the effect.
        effect: &'static str,
        /// The joint's name, or `the whole arm`.
        joint: String,
        /// The parameter.
        parameter: &'static str,
        /// The value.
        value: f64,
        /// The requirement on it.
        requirement: &'static str,
    },
}
