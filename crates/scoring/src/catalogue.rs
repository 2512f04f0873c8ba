//! Properties of effects that the score needs, by name. They repeat a part of the catalogue, because `scoring` does not depend
//! on `effects`.

/// Effects that every machine has and most URDFs omit; they are scored separately.
pub const BASELINE: &[&str] = &["coulomb_friction", "viscous_friction"];

/// The baseline effects where the robot's drives have inertia that its URDF omits.
pub const BASELINE_WITH_DRIVES: &[&str] = &["coulomb_friction", "viscous_friction", DRIVE_INERTIA];

/// The inertia of a drive's rotor.
pub const DRIVE_INERTIA: &str = "rotor_inertia";

/// A general change of links' masses, centres of mass and inertias.
pub const INERTIALS: &str = "inertial_parameters";

/// A link with wrong inertial parameters.
pub const LINK_INERTIAL: &str = "link_inertial_error";

/// A common factor of all masses and inertias.
pub const ALL_INERTIALS: &str = "inertial_scale";

/// Effects from which a wrong term on a joint is chosen.
pub const ON_A_JOINT: [&str; 9] = [
    "quadratic_drag",
    "rotor_inertia",
    "torque_offset",
    "spring",
    "torque_scale",
    "stribeck_friction",
    "load_dependent_friction",
    "friction_asymmetry",
    "encoder_offset",
];

/// Effects from which a wrong term on the whole arm is chosen.
pub const ON_THE_ARM: [&str; 3] = ["payload", "gravity_misalignment", "inertial_scale"];

/// The name in the catalogue, also for effects that were written under an older name.
pub fn canonical(effect: &str) -> &str {
    match effect {
        "link_mass_error" => "link_inertial_error",
        "gravity_tilt" => "gravity_misalignment",
        name => name,
    }
}

/// Whether the effect is outside the catalogue: ground truths name such effects with this ending.
pub fn is_outside(effect: &str) -> bool {
    effect.ends_with("_unknown")
}

/// The scored parameters of an effect, the main one first. Phases, times of day, directions and values that depend on the
/// choice of a zero have no relative error and are omitted.
pub fn parameters(effect: &str) -> &'static [&'static str] {
    match effect {
        "viscous_friction" | "quadratic_drag" => &["coefficient"],
        "coulomb_friction" => &["level"],
        "friction_asymmetry" => &["positive", "negative"],
        "stribeck_friction" => &["breakaway", "coulomb", "velocity"],
        "load_dependent_friction" => &["gain", "coulomb"],
        "thermal_drift" => &["amplitude", "coulomb", "time_constant"],
        "rotor_inertia" => &["inertia"],
        "torque_scale" | "inertial_scale" => &["factor"],
        "torque_offset" | "encoder_offset" => &["offset"],
        "gravity_compensator" => &["amplitude"],
        "torque_ripple" => &["amplitude", "periods"],
        "torque_saturation" => &["limit"],
        "actuation_delay" => &["delay"],
        "joint_elasticity" => &["stiffness", "damping"],
        "backlash" => &["halfgap"],
        "transmission_coupling" => &["viscous", "coulomb", "inertia"],
        "payload" => &["mass", "com_x", "com_y", "com_z"],
        "inertial_parameters" => &["mass"],
        "link_inertial_error" => &["relative"],
        "gravity_misalignment" => &["angle"],
        "spring" => &["stiffness"],
        "external_contact" => &["force", "duration"],
        _ => &[],
    }
}

/// Whether a parameter of an effect on a joint is proportional to the recorded torque.
pub fn is_weighed(effect: &str, parameter: &str) -> bool {
    match parameter {
        "coefficient" | "level" | "positive" | "negative" | "breakaway" | "coulomb" | "viscous" | "inertia"
        | "amplitude" | "stiffness" | "damping" => true,
        "offset" => effect == "torque_offset",
        _ => false,
    }
}

/// Whether an effect is dry friction in some form.
pub fn is_dry_friction(effect: &str) -> bool {
    matches!(
        effect,
        "coulomb_friction" | "friction_asymmetry" | "stribeck_friction" | "load_dependent_friction" | "thermal_drift"
    )
}

/// Whether an effect is a part of a joint's friction curve.
pub fn is_friction_curve(effect: &str) -> bool {
    is_dry_friction(effect) && effect != "thermal_drift" || matches!(effect, "viscous_friction" | "quadratic_drag")
}

/// The value of an effect's main parameter without effect: one for a factor.
pub fn neutral(effect: &str) -> f64 {
    if matches!(effect, "torque_scale" | "inertial_scale") { 1.0 } else { 0.0 }
}

/// Effects that accompany an effect and are neither right nor wrong beside it: Coulomb friction is a part of every friction
/// curve, and the rotor inertia moves behind a spring or a gap.
pub fn brings(effect: &str) -> &'static [&'static str] {
    match effect {
        "stribeck_friction" | "load_dependent_friction" | "thermal_drift" => &["coulomb_friction"],
        "friction_asymmetry" => &["coulomb_friction", "torque_offset"],
        "joint_elasticity" | "backlash" => &["rotor_inertia"],
        _ => &[],
    }
}
