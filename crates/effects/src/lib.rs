//! The catalogue of the effects that a rigid model omits: one file per effect, and its lines below (module, spec, [`CATALOGUE`]).
//!
//! A file holds all that the program knows of an effect, as a static [`Spec`]: name, parameters, relations, words, the forms
//! to try, the law of its columns, what physics allows, how its parameters are read from an estimate, and how it is put into a
//! [`Machine`]. The fit of a diagnosis and the feed-forward of a corrected model come
//! from the same file. [`spec`](spec()) gives what is known of a name.
//!
//! ```
//! use effects::Effect;
//! use effects::friction::COULOMB_FRICTION;
//!
//! let friction = Effect::of(&COULOMB_FRICTION).on("elbow").with("level", 0.4);
//! assert_eq!(friction.name(), "coulomb_friction");
//! assert_eq!(friction.number("level"), 0.4);
//! assert_eq!(effects::spec("coulomb_friction").map(|spec| spec.title), Some("Coulomb friction"));
//! ```

// Only the command line prints.
#![warn(clippy::print_stderr, clippy::print_stdout)]

mod apply;
pub mod background;
mod compliance;
mod error;
mod estimate;
mod files;
mod fitted;
mod form;
mod kinds;
pub mod laws;
mod machine;
mod on_links;
mod quantity;
mod regressor;
mod signals;
mod spec;
mod term;
#[cfg(test)]
mod test_support;

pub use apply::check;
pub use compliance::LinkSide;
pub use error::EffectError;
pub use estimate::{Estimate, Systematic};
pub use files::ReadError;
pub use fitted::{Fitted, UNIT};
pub use form::{Form, Grounds, SetsIn, Turn};
pub use kinds::{Kind, NAMES, experiment_against, spec};
pub use laws::Times;
pub use machine::{Circumstance, Contact, Dry, JointIndices, Machine, Scaled, Smooth, Sprung, State, sign};
pub use quantity::Quantity;
pub use regressor::Regressor;
pub use signals::{Base, OnLinks, Rigid, Scales, Signals};
pub use spec::{
    Against, Detectability, Effect, Experiment, InUrdf, Intervals, ONSET, Parameter, Range, Scope, Shape, Spec, Value,
};
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

    pub use asymmetry::FRICTION_ASYMMETRY;
    pub use coulomb::COULOMB_FRICTION;
    pub use drag::{DRAG, QUADRATIC_DRAG, TURBULENT};
    pub use load_dependent::LOAD_DEPENDENT_FRICTION;
    pub use stribeck::{STRIBECK_FRICTION, velocity as stribeck_velocity};
    pub use thermal::{THERMAL_DRIFT, WARMING};
    pub use viscous::VISCOUS_FRICTION;
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

    pub use backlash::BACKLASH;
    pub use coupling::{FARTHEST_COUPLED, TRANSMISSION_COUPLING};
    pub use delay::{ACTUATION_DELAY, LATE, LATE_SIGN, UNIT_LAG};
    pub use elasticity::JOINT_ELASTICITY;
    pub use ripple::{TORQUE_RIPPLE, columns as ripple_columns};
    pub use rotor_inertia::ROTOR_INERTIA;
    pub use saturation::TORQUE_SATURATION;
}

/// Errors of sensors.
pub mod sensor {
    mod encoder_offset;
    mod torque_offset;
    mod torque_scale;

    pub use encoder_offset::ENCODER_OFFSET;
    pub use torque_offset::TORQUE_OFFSET;
    pub use torque_scale::TORQUE_SCALE;
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

    pub use contact::{EXTERNAL_CONTACT, columns as contact_columns, window as contact_window};
    pub use inertial_parameters::{INERTIAL_PARAMETERS, PARAMETER as INERTIAL_PARAMETER, link_body, link_effect};
    pub use inertial_scale::INERTIAL_SCALE;
    pub use link_error::LINK_INERTIAL_ERROR;
    pub use payload::{
        PARAMETER as PAYLOAD_PARAMETER, PAYLOAD, WITHOUT_MOMENTS as PAYLOAD_WITHOUT_MOMENTS, body, exists,
        moments_by_first, payload_body,
    };
    pub use tensor::{entries, second_moments, tensor};
    pub use tilt::GRAVITY_MISALIGNMENT;
}

/// Torques that depend on a joint's position.
pub mod joint {
    mod gravity_compensator;
    mod spring;

    pub use gravity_compensator::GRAVITY_COMPENSATOR;
    pub use spring::SPRING;
}

/// Unmodelled forms. They compete with the catalogue, so that other physics is not attributed to the most similar effect.
pub mod unmodelled {
    mod base_motion;
    mod history;
    mod load;
    mod other_position;
    mod other_speed;
    mod other_torque;
    mod own_position;
    mod periodic;
    mod position_scale;
    mod product;
    mod time;
    mod tool_position;
    mod tool_velocity;

    pub use base_motion::BASE_MOTION;
    pub use history::HISTORY;
    pub use load::LOAD;
    pub use other_position::OTHER_POSITION;
    pub use other_speed::OTHER_SPEED;
    pub use other_torque::OTHER_TORQUE;
    pub use own_position::OWN_POSITION;
    pub use periodic::{PERIODIC, columns as periodic_columns};
    pub use position_scale::POSITION_SCALE;
    pub use product::PRODUCT;
    pub use time::TIME;
    pub use tool_position::TOOL_POSITION;
    pub use tool_velocity::TOOL_VELOCITY;
}

/// The effects that have a name, in the order of the documentation.
pub static CATALOGUE: &[&Spec] = &[
    &friction::VISCOUS_FRICTION,
    &friction::COULOMB_FRICTION,
    &friction::FRICTION_ASYMMETRY,
    &friction::STRIBECK_FRICTION,
    &friction::LOAD_DEPENDENT_FRICTION,
    &friction::THERMAL_DRIFT,
    &friction::QUADRATIC_DRAG,
    &drive::ROTOR_INERTIA,
    &sensor::TORQUE_SCALE,
    &sensor::TORQUE_OFFSET,
    &drive::TORQUE_RIPPLE,
    &drive::TORQUE_SATURATION,
    &drive::ACTUATION_DELAY,
    &drive::JOINT_ELASTICITY,
    &drive::BACKLASH,
    &drive::TRANSMISSION_COUPLING,
    &arm::PAYLOAD,
    &arm::LINK_INERTIAL_ERROR,
    &arm::INERTIAL_SCALE,
    &arm::INERTIAL_PARAMETERS,
    &arm::GRAVITY_MISALIGNMENT,
    &sensor::ENCODER_OFFSET,
    &joint::SPRING,
    &joint::GRAVITY_COMPENSATOR,
    &arm::EXTERNAL_CONTACT,
];

/// The effects that nearly every URDF omits, and that act on every joint.
pub static OMITTED_BY_MOST: [&Spec; 4] =
    [&friction::COULOMB_FRICTION, &friction::VISCOUS_FRICTION, &drive::ROTOR_INERTIA, &sensor::TORQUE_OFFSET];

/// Unmodelled forms. They compete with the catalogue, so that other physics is not attributed to the most similar effect.
pub static UNMODELLED: &[&Spec] = &[
    &unmodelled::OWN_POSITION,
    &unmodelled::OTHER_POSITION,
    &unmodelled::OTHER_SPEED,
    &unmodelled::OTHER_TORQUE,
    &unmodelled::HISTORY,
    &unmodelled::LOAD,
    &unmodelled::PRODUCT,
    &unmodelled::PERIODIC,
    &unmodelled::TIME,
    &unmodelled::POSITION_SCALE,
    &unmodelled::TOOL_POSITION,
    &unmodelled::TOOL_VELOCITY,
    &unmodelled::BASE_MOTION,
];
