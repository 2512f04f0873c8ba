//! Errors of torque models and controllers.

/// Why a torque model or a controller could not be made.
#[derive(Debug, thiserror::Error)]
pub enum TorqueError {
    /// A joint vector has another size than the arm.
    #[error("{what}: {found} values for an arm of {expected} joints")]
    Joints {
        /// The name of the vector.
        what: String,
        /// The number of its values.
        found: usize,
        /// The number of the arm's joints.
        expected: usize,
    },
    /// A gain is negative or not finite.
    #[error("{what} of joint {joint} is {value}; it must be finite and not negative")]
    Gain {
        /// The name of the gain.
        what: &'static str,
        /// The joint, from 1.
        joint: usize,
        /// The value.
        value: f64,
    },
    /// There are no samples.
    #[error("no training samples")]
    NoSamples,
    /// The regression of one joint failed.
    #[error("joint {joint}: {source}")]
    Regression {
        /// The joint, from 1.
        joint: usize,
        /// The error of the regression.
        source: gp::GpError,
    },
    /// The regression of all joints' torques by the arm's energies failed.
    #[error("the energies cannot be learned: {0}")]
    Energies(gp::GpError),
    /// An effect that does not fit the arm.
    #[error(transparent)]
    Effect(#[from] effects::EffectError),
}
