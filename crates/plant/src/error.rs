//! Errors of a plant.

/// Why a [`crate::Plant`] cannot be built or cannot continue.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlantError {
    /// A list does not have one value per joint.
    #[error("{what} has {found} values, but the arm has {expected} joints; give one per joint")]
    Count {
        /// The list.
        what: &'static str,
        /// The arm's number of joints.
        expected: usize,
        /// The list's length.
        found: usize,
    },
    /// A value of a joint is outside the range of its quantity.
    #[error("{what} of joint \"{joint}\" is {value}; give a finite number, not negative")]
    Value {
        /// The quantity.
        what: &'static str,
        /// The joint's name.
        joint: String,
        /// What was given.
        value: f64,
    },
    /// The step is not a positive duration.
    #[error("the plant's step is {step} s; give a positive, finite time")]
    Step {
        /// What was given (s).
        step: f64,
    },
    /// The extrapolation order is out of range.
    #[error("the plant's order is {order}; give 1 to {largest}")]
    Order {
        /// What was given.
        order: usize,
        /// The largest allowed order.
        largest: usize,
    },
    /// Gravity is not finite.
    #[error("the arm's gravity is not finite")]
    Gravity,
    /// rapier would move this link wrongly without an error, and there is no equivalent body.
    #[error(
        "link \"{link}\" has no moment of inertia about one of its axes ({smallest:e} kg m² at the least, {largest:e} at \
         the most), which rapier cannot simulate; give it a small one"
    )]
    Singular {
        /// The link's name.
        link: String,
        /// Its smallest principal moment (kg m²).
        smallest: f64,
        /// Its largest principal moment (kg m²).
        largest: f64,
    },
    /// A joint can move without moving a mass.
    #[error("joint \"{joint}\" moves no inertia; give the links beyond it an <inertial>, or its drive a rotor inertia")]
    Massless {
        /// The joint's name.
        joint: String,
    },
    /// A position, velocity or torque is not finite, or a joint is faster than any robot's.
    #[error("joint \"{joint}\" at {time:.3} s: its motion or torque has left all bounds")]
    Diverged {
        /// The first such joint's name.
        joint: String,
        /// The time the step began (s).
        time: f64,
    },
}
