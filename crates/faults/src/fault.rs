//! The faults that can be injected, one file each: name and forms, where it can be, how it is drawn, how its parameters are
//! read and checked, its law, and an example for the tests.
//!
//! To add a fault, write its file, and add its name below, as a module and in [`FAULTS`].

use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};

use crate::error::FaultError;
use crate::part::Piece;
use crate::robot::Robot;
use crate::site::Site;
use crate::truth::Injected;

mod injected;
mod reader;
pub(crate) use reader::{Reader, parts};

mod actuation_delay;
mod backlash;
pub(crate) mod coulomb_friction;
mod cross_coupling_unknown;
mod dead_band_unknown;
mod encoder_offset;
mod external_contact;
mod friction_asymmetry;
mod gravity_compensator;
mod gravity_misalignment;
mod history_unknown;
mod hysteresis_unknown;
mod inertial_parameters;
mod inertial_scale;
mod joint_elasticity;
mod link_inertial_error;
mod load_dependent_friction;
mod multiplicative_unknown;
mod other_velocity_unknown;
mod payload;
mod quadratic_drag;
mod random_walk_unknown;
mod rotor_inertia;
mod spring;
mod stribeck_friction;
mod thermal_drift;
mod time_periodic_unknown;
mod torque_offset;
mod torque_ripple;
mod torque_saturation;
mod torque_scale;
mod transmission_coupling;
pub(crate) mod viscous_friction;

/// All faults. Draws depend on their order: first the baseline effects, then the catalogue's, then those outside it.
pub(crate) static FAULTS: &[Fault] = &[
    viscous_friction::FAULT,
    coulomb_friction::FAULT,
    friction_asymmetry::FAULT,
    stribeck_friction::FAULT,
    load_dependent_friction::FAULT,
    thermal_drift::FAULT,
    quadratic_drag::FAULT,
    rotor_inertia::FAULT,
    torque_scale::FAULT,
    torque_offset::FAULT,
    torque_ripple::FAULT,
    torque_saturation::FAULT,
    actuation_delay::FAULT,
    joint_elasticity::FAULT,
    backlash::FAULT,
    transmission_coupling::FAULT,
    payload::FAULT,
    link_inertial_error::FAULT,
    inertial_scale::FAULT,
    gravity_misalignment::FAULT,
    encoder_offset::FAULT,
    spring::FAULT,
    gravity_compensator::FAULT,
    inertial_parameters::FAULT,
    external_contact::FAULT,
    cross_coupling_unknown::FAULT,
    time_periodic_unknown::FAULT,
    dead_band_unknown::FAULT,
    hysteresis_unknown::FAULT,
    other_velocity_unknown::FAULT,
    history_unknown::FAULT,
    random_walk_unknown::FAULT,
    multiplicative_unknown::FAULT,
];

/// The definition of a kind of fault. The first fields repeat the catalogue of effects, because `faults` does not depend on it.
pub(crate) struct Fault {
    /// The catalogue's name, or one that ends in `_unknown`.
    pub name: &'static str,
    /// Whether campaigns draw it. Adding a fault that is not drawn does not change the cases of any seed.
    pub is_drawn: bool,
    /// On which joints it is drawn, or on the whole arm.
    pub joints: EligibleJoints,
    /// Whether it is outside the catalogue.
    pub is_outside: bool,
    /// Its forms in addition to the first, which is the textbook form (or the simplest).
    pub forms: &'static [&'static str],
    /// Its parameters in addition to the catalogue's that only such a form has.
    pub form_parameters: &'static [&'static str],
    /// Its further parameters in addition to the catalogue's; all have defaults.
    pub more_parameters: &'static [&'static str],
    /// Whether a robot can have it.
    pub can_be_on: fn(&Robot) -> bool,
    /// Whether it may begin at an onset when it is drawn.
    pub may_have_onset: bool,
    /// Its group: faults of one group are not drawn together, because they cannot be distinguished.
    pub similar_faults: Option<SimilarFaults>,
    /// The part of it that remains when it is removed.
    pub leaves: Leaves,
    /// Whether it is a constant torque, so that the mean of the torque counts in its share.
    pub is_constant: bool,
    /// Whether there may be several on one joint.
    pub may_repeat: bool,
    /// Whether it may make the position loop oscillate.
    pub may_oscillate: bool,
    /// How it is scaled.
    pub size: Size,
    /// Draws a form and parameters that a robot could have.
    pub draw: fn(Injected, &Site<'_>, &mut ChaCha8Rng) -> Injected,
    /// Its parts of the machine, from its checked parameters.
    pub read: fn(&Reader<'_>) -> Result<Vec<Piece>, FaultError>,
    /// Sets parameters at which it is detectable on axis 4 of the arm with seven axes.
    #[cfg(test)]
    pub example: fn(Injected) -> Injected,
}

/// The joints on which a fault is drawn.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum EligibleJoints {
    AnyJoint,
    /// All but the first.
    OuterJoints,
    /// All but the first and the last: the first may carry no load, and the last link may have almost no mass.
    InnerJoints,
    /// Those whose torque is mostly that of the URDF's bodies; on other joints, the factor cannot be distinguished
    /// from those of friction and drive.
    LoadedJoints,
    WholeArm,
}

/// Groups of similar faults.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum SimilarFaults {
    BetweenCommandAndLink,
    Scales,
}

/// The part of a fault that remains when it is removed.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Leaves {
    Nothing,
    /// The plain dry friction under a friction curve. It replaces the baseline friction of its joint.
    DryFriction,
    /// The rotor of a drive whose spring is rigid.
    Rotor,
    /// A tool that the URDF has and the machine does not have: without the fault, it is mounted.
    Tool,
}

/// How a fault is scaled by a factor.
#[derive(Clone, Copy)]
pub(crate) enum Size {
    /// Not at all: its sizes are those of real machines.
    AsDrawn,
    /// By multiplying these parameters by the factor.
    Times(&'static [&'static str]),
    /// By the new values of some parameters, within physical limits.
    Changed(fn(&Injected, f64) -> Vec<(&'static str, Value)>),
}

impl Fault {
    const ON_A_JOINT: Self = Self {
        name: "",
        is_drawn: true,
        joints: EligibleJoints::AnyJoint,
        is_outside: false,
        forms: &[],
        form_parameters: &[],
        more_parameters: &[],
        can_be_on: |_| true,
        may_have_onset: false,
        similar_faults: None,
        leaves: Leaves::Nothing,
        is_constant: false,
        may_repeat: false,
        may_oscillate: false,
        size: Size::AsDrawn,
        draw: |bare, _, _| bare,
        read: |_| Ok(Vec::new()),
        #[cfg(test)]
        example: |bare| bare,
    };

    const ON_THE_ARM: Self = Self { joints: EligibleJoints::WholeArm, ..Self::ON_A_JOINT };

    const OUTSIDE_THE_CATALOGUE: Self =
        Self { is_outside: true, may_repeat: true, size: Size::Times(&["amplitude"]), ..Self::ON_A_JOINT };

    /// The fault of this name.
    pub(crate) fn named(name: &str) -> Option<&'static Self> {
        FAULTS.iter().find(|fault| fault.name == name)
    }

    /// Scales a fault by `factor`.
    pub(crate) fn resize(&self, injected: &mut Injected, factor: f64) {
        let changed = match self.size {
            Size::AsDrawn => Vec::new(),
            Size::Times(names) => {
                let times = |name: &&'static str| (*name, json!(factor * injected.number(name).unwrap_or(0.0)));
                names.iter().map(times).collect()
            }
            Size::Changed(change) => change(injected, factor),
        };
        for (name, value) in changed {
            injected.parameters.insert(name.to_owned(), value);
        }
    }
}

/// The catalogue's names, the baseline effects first.
pub fn catalogue() -> Vec<&'static str> {
    names(|fault| !fault.is_outside)
}

/// Names outside the catalogue.
pub fn outside() -> Vec<&'static str> {
    names(|fault| fault.is_outside)
}

/// Whether `name` is that of an effect outside the catalogue.
pub fn is_outside(name: &str) -> bool {
    Fault::named(name).is_some_and(|fault| fault.is_outside)
}

/// The catalogue's families that are drawn, without the first two: plain viscous and Coulomb friction, which are baseline effects.
pub fn families() -> Vec<&'static str> {
    names(|fault| !fault.is_outside && fault.is_drawn).split_off(2)
}

/// The parameters of `effect` that only an effect with a form has.
pub fn form_parameters(effect: &str) -> &'static [&'static str] {
    Fault::named(effect).map_or(&[], |fault| fault.form_parameters)
}

/// The further parameters of `effect` in addition to the catalogue's; all have defaults.
pub fn more_parameters(effect: &str) -> &'static [&'static str] {
    Fault::named(effect).map_or(&[], |fault| fault.more_parameters)
}

fn names(counts: impl Fn(&Fault) -> bool) -> Vec<&'static str> {
    FAULTS.iter().filter(|fault| counts(fault)).map(|fault| fault.name).collect()
}

/// The names that the file of a fault needs.
mod prelude {
    pub(super) use std::f64::consts::TAU;

    pub(super) use arm::{Inertia, Matrix3, Vector3};
    pub(super) use rand::seq::IndexedRandom;
    pub(super) use rand::{Rng, SeedableRng};
    pub(super) use rand_chacha::ChaCha8Rng;
    pub(super) use rand_distr::{Distribution, StandardNormal};
    pub(super) use serde_json::{Value, json};

    pub(super) use super::{EligibleJoints, Fault, Leaves, Reader, SimilarFaults, Size};
    pub(super) use crate::error::FaultError;
    pub(super) use crate::part::{
        At, Body, Connection, Contact, DriveLaw, DryAt, DryLaw, DrySum, LinkLaw, Piece, Property, TimeCourse,
    };
    pub(super) use crate::pseudo_inertia::moved;
    pub(super) use crate::robot::has_another_joint;
    pub(super) use crate::site::{log_uniform, perhaps_in_form, sign};
}
