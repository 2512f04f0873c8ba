//! The names of effects and of the forms each can take.

/// Names outside the catalogue.
pub const UNKNOWN: [&str; 8] = [
    "cross_coupling_unknown",
    "time_periodic_unknown",
    "dead_band_unknown",
    "hysteresis_unknown",
    "other_velocity_unknown",
    "history_unknown",
    "random_walk_unknown",
    "multiplicative_unknown",
];

/// The catalogue's names, what is ordinary first.
pub const EFFECTS: [&str; 23] = [
    "viscous_friction",
    "coulomb_friction",
    "friction_asymmetry",
    "stribeck_friction",
    "load_dependent_friction",
    "thermal_drift",
    "quadratic_drag",
    "rotor_inertia",
    "torque_scale",
    "torque_offset",
    "torque_ripple",
    "torque_saturation",
    "actuation_delay",
    "joint_elasticity",
    "backlash",
    "transmission_coupling",
    "payload",
    "link_inertial_error",
    "inertial_scale",
    "gravity_misalignment",
    "encoder_offset",
    "spring",
    "external_contact",
];

/// The forms that `effect` can have beside the first, which is the textbook's (or the plainest).
pub fn forms(effect: &str) -> &'static [&'static str] {
    match effect {
        "viscous_friction" | "quadratic_drag" => &["power"],
        "stribeck_friction" => &["another exponent"],
        "load_dependent_friction" => &["drive load"],
        "thermal_drift" => &["hyperbolic", "stretched"],
        "torque_ripple" => &["second harmonic"],
        "torque_saturation" => &["soft"],
        "actuation_delay" => &["first-order lag"],
        "joint_elasticity" => &["hardening"],
        "backlash" => &["rounded"],
        "spring" => &["gas spring", "hardening", "knee"],
        "external_contact" => &["half-sine", "decaying"],
        "cross_coupling_unknown" => &["step"],
        "time_periodic_unknown" => &["rounded square"],
        "dead_band_unknown" => &["gaussian"],
        "hysteresis_unknown" => &["sharp"],
        "other_velocity_unknown" => &["square", "saturating"],
        "history_unknown" => &["signed square", "position"],
        "multiplicative_unknown" => &["speed times position"],
        _ => &[],
    }
}

/// The parameters, all with defaults, that `effect` has beyond the catalogue's.
pub fn form_parameters(effect: &str) -> &'static [&'static str] {
    match effect {
        "viscous_friction" | "quadratic_drag" => &["exponent"],
        "torque_ripple" => &["second"],
        "joint_elasticity" => &["rotor", "hardening_torque"],
        "backlash" => &["rotor", "stiffness", "damping"],
        _ => &[],
    }
}
