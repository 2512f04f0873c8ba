//! The catalogue of the effects that a rigid model omits: one file per effect, and its lines below (module, type, [`CATALOGUE`]).
//!
//! A file holds all that the program knows of an effect, behind the trait [`EffectKind`]: its [`Spec`] (name, parameters,
//! relations, words), the forms to try, the law of its columns, what physics allows, how its parameters are read from an
//! estimate, and how it is put into a [`Machine`]. The fit of a diagnosis and the feed-forward of a corrected model come
//! from the same file. [`spec`](spec()) gives what is known of a name.
//!
//! ```
//! use effects::Effect;
//! use effects::friction::CoulombFriction;
//!
//! let friction = Effect::of(&CoulombFriction).on("elbow").with("level", 0.4);
//! assert_eq!(friction.name(), "coulomb_friction");
//! assert_eq!(friction.number("level"), 0.4);
//! assert_eq!(effects::spec("coulomb_friction").map(|spec| spec.title), Some("Coulomb friction"));
//! ```

// Only the command line prints.
#![warn(clippy::print_stderr, clippy::print_stdout)]

mod apply;
pub mod background;
mod compliance;
mod effect;
mod error;
mod estimate;
mod files;
mod fitted;
mod form;
mod kind;
mod kinds;
pub mod laws;
mod machine;
mod quantity;
mod regressor;
mod signals;
mod spec;
mod term;
#[cfg(test)]
mod test_support;

pub use apply::check;
pub use compliance::LinkSide;
pub use effect::{Effect, Value};
pub use error::EffectError;
pub use estimate::{Estimate, Systematic};
pub use files::ReadError;
pub use fitted::{Fitted, UNIT};
pub use form::{Form, Grounds, SetsIn, Turn};
pub use kind::EffectKind;
pub use kinds::{Kind, NAMES, experiment_against, spec};
pub use laws::Times;
pub use machine::{Circumstance, Contact, Dry, Machine, Place, Scaled, Smooth, Sprung, State, sign};
pub use quantity::Quantity;
pub use regressor::Regressor;
pub use signals::{Rigid, Scales, Signals};
pub use spec::{Against, Detectability, Experiment, InUrdf, ONSET, Parameter, Range, Scope, Shape, Spec};
pub use term::{Acts, Carried, Column, Cone, Law, OtherForm, Size, Term};

/// Friction in the drive and its gear.
pub mod friction {
    mod asymmetry;
    mod coulomb;
    mod drag;
    mod load_dependent;
    mod stribeck;
    mod thermal;
    mod viscous;

    pub use asymmetry::FrictionAsymmetry;
    pub use coulomb::CoulombFriction;
    pub use drag::{DRAG, QuadraticDrag, TURBULENT};
    pub use load_dependent::LoadDependentFriction;
    pub use stribeck::{StribeckFriction, velocity as stribeck_velocity};
    pub use thermal::{ThermalDrift, WARMING};
    pub use viscous::ViscousFriction;
}

/// Torques that a drive adds, and changes of its torque.
pub mod drive {
    mod backlash;
    mod coupling;
    mod delay;
    mod elasticity;
    mod ripple;
    mod rotor_inertia;
    mod saturation;

    pub use backlash::Backlash;
    pub use coupling::{FARTHEST_COUPLED, TransmissionCoupling};
    pub use delay::{ActuationDelay, LATE, LATE_SIGN, UNIT_LAG};
    pub use elasticity::JointElasticity;
    pub use ripple::{TorqueRipple, columns as ripple_columns};
    pub use rotor_inertia::RotorInertia;
    pub use saturation::TorqueSaturation;
}

/// Errors of sensors.
pub mod sensor {
    mod encoder_offset;
    mod torque_offset;
    mod torque_scale;

    pub use encoder_offset::EncoderOffset;
    pub use torque_offset::TorqueOffset;
    pub use torque_scale::TorqueScale;
    pub(crate) use torque_scale::is_beyond_tolerance;
}

/// Errors of the arm's bodies and of its mounting, and forces on it.
pub mod arm {
    mod contact;
    mod inertial_parameters;
    mod inertial_scale;
    mod link_error;
    mod payload;
    mod tensor;
    mod tilt;

    pub use contact::{ExternalContact, columns as contact_columns, window as contact_window};
    pub use inertial_parameters::{InertialParameters, PARAMETER as INERTIAL_PARAMETER};
    pub use inertial_scale::InertialScale;
    pub use link_error::LinkInertialError;
    pub use payload::{
        PARAMETER as PAYLOAD_PARAMETER, Payload, WITHOUT_MOMENTS as PAYLOAD_WITHOUT_MOMENTS, body, exists,
        moments_by_first,
    };
    pub use tensor::{entries, second_moments, tensor};
    pub use tilt::GravityMisalignment;
}

/// Torques that depend on a joint's position.
pub mod joint {
    mod gravity_compensator;
    mod spring;

    pub use gravity_compensator::GravityCompensator;
    pub use spring::Spring;
}

/// Unmodelled forms. They compete with the catalogue, so that other physics is not attributed to the most similar effect.
pub mod unmodelled {
    mod history;
    mod load;
    mod other_position;
    mod other_speed;
    mod own_position;
    mod periodic;
    mod product;
    mod time;

    pub use history::History;
    pub use load::Load;
    pub use other_position::OtherPosition;
    pub use other_speed::OtherSpeed;
    pub use own_position::OwnPosition;
    pub use periodic::{Periodic, columns as periodic_columns};
    pub use product::Product;
    pub use time::Time;
}

/// The effects that have a name, in the order of the documentation.
pub static CATALOGUE: &[&dyn EffectKind] = &[
    &friction::ViscousFriction,
    &friction::CoulombFriction,
    &friction::FrictionAsymmetry,
    &friction::StribeckFriction,
    &friction::LoadDependentFriction,
    &friction::ThermalDrift,
    &friction::QuadraticDrag,
    &drive::RotorInertia,
    &sensor::TorqueScale,
    &sensor::TorqueOffset,
    &drive::TorqueRipple,
    &drive::TorqueSaturation,
    &drive::ActuationDelay,
    &drive::JointElasticity,
    &drive::Backlash,
    &drive::TransmissionCoupling,
    &arm::Payload,
    &arm::LinkInertialError,
    &arm::InertialScale,
    &arm::InertialParameters,
    &arm::GravityMisalignment,
    &sensor::EncoderOffset,
    &joint::Spring,
    &joint::GravityCompensator,
    &arm::ExternalContact,
];

/// The effects that nearly every URDF omits, and that act on every joint.
pub static OMITTED_BY_MOST: [&dyn EffectKind; 4] =
    [&friction::CoulombFriction, &friction::ViscousFriction, &drive::RotorInertia, &sensor::TorqueOffset];

/// Unmodelled forms. They compete with the catalogue, so that other physics is not attributed to the most similar effect.
pub static UNMODELLED: &[&dyn EffectKind] = &[
    &unmodelled::OwnPosition,
    &unmodelled::OtherPosition,
    &unmodelled::OtherSpeed,
    &unmodelled::History,
    &unmodelled::Load,
    &unmodelled::Product,
    &unmodelled::Periodic,
    &unmodelled::Time,
];
