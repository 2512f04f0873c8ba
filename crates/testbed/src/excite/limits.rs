//! The limits of the joints: those of the URDF, and those given in their place.

use anyhow::bail;
use arm::Arm;
use diagnosis::MotionLimits;

use crate::cli::{ExciteArgs, Limit};
use recording::nearest;

/// The limits of the joints of `arm`, one per joint.
///
/// # Errors
/// If one is given for a joint that the arm does not have.
pub fn of(args: &ExciteArgs, arm: &Arm) -> anyhow::Result<Vec<MotionLimits>> {
    let mut limits = MotionLimits::of(arm);
    replace("position", &args.position_limit, arm, &mut limits, |limits, value| {
        limits.position = value;
    })?;
    replace("velocity", &args.velocity_limit, arm, &mut limits, |limits, value| {
        limits.velocity = value;
    })?;
    replace("acceleration", &args.acceleration_limit, arm, &mut limits, |limits, value| {
        limits.acceleration = value;
    })?;
    replace("effort", &args.effort_limit, arm, &mut limits, |limits, value| {
        limits.effort = value;
    })?;
    Ok(limits)
}

/// Replaces limits by those given: first the ones for all joints, then those of named joints.
fn replace<T: Copy>(
    what: &str,
    given: &[Limit<T>],
    arm: &Arm,
    limits: &mut [MotionLimits],
    set: impl Fn(&mut MotionLimits, T),
) -> anyhow::Result<()> {
    for (_, value) in given.iter().filter(|(joint, _)| joint.is_none()) {
        limits.iter_mut().for_each(|limits| set(limits, *value));
    }
    for (name, value) in given.iter().filter_map(|(joint, value)| Some((joint.as_ref()?, value))) {
        let Some(joint) = arm.joints().iter().position(|joint| joint.name == *name) else {
            let names: Vec<String> = arm.joints().iter().map(|joint| joint.name.clone()).collect();
            let hint = nearest(name, &names).map_or(String::new(), |nearest| format!("did you mean {nearest}? "));
            bail!(
                "--{what}-limit {name}=…: the arm has no joint \"{name}\"; {hint}its joints are {}",
                names.join(", ")
            );
        };
        set(&mut limits[joint], *value);
    }
    Ok(())
}
