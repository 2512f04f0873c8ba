//! Friction and drive inertias in the URDF, as known effects.

use arm::Arm;
use effects::drive::ROTOR_INERTIA;
use effects::friction::{COULOMB_FRICTION, VISCOUS_FRICTION};
use effects::{Effect, InUrdf};

use crate::held;
use crate::robot::RobotFile;
use crate::urdf_file::{diagnosed_joints, stated_drive_inertias};

/// Which friction in a URDF is known friction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UrdfFriction {
    /// The friction that a diagnosis wrote.
    #[default]
    Diagnosed,
    /// All.
    Known,
    /// None.
    Ignored,
}

/// The friction in the `<dynamics>` of `robot` that `which` takes as known, in addition to the effects `known`, which take
/// precedence on their joints. Drive inertias for Drake are also known, unless friction is ignored, because they are never
/// placeholders. The second value describes what was not used.
///
/// # Errors
/// If the URDF cannot be read again.
pub fn known_friction(
    robot: &RobotFile,
    arm: &Arm,
    which: UrdfFriction,
    known: &[Effect],
) -> anyhow::Result<(Vec<Effect>, Option<String>)> {
    let with_friction = |joint: &&arm::Joint| joint.damping > 0.0 || joint.friction > 0.0;
    let joints: Vec<&arm::Joint> = arm.joints().iter().filter(with_friction).collect();
    let diagnosed = match which {
        UrdfFriction::Diagnosed if !joints.is_empty() => diagnosed_joints(&robot.text)?,
        _ => Vec::new(),
    };
    let is_taken = |joint: &arm::Joint| match which {
        UrdfFriction::Known => true,
        UrdfFriction::Ignored => false,
        UrdfFriction::Diagnosed => diagnosed.contains(&joint.name),
    };
    let mut effects = Vec::new();
    let mut omitted = Vec::new();
    for joint in joints {
        if !is_taken(joint) {
            omitted.push(joint.name.as_str());
            continue;
        }
        let has = |is_such: &dyn Fn(&Effect) -> bool| {
            known.iter().any(|effect| effect.joint() == Some(&joint.name) && is_such(effect))
        };
        if joint.damping > 0.0 && !has(&|effect| effect.spec().in_urdf == InUrdf::Damping) {
            effects.push(Effect::of(&VISCOUS_FRICTION).on(&joint.name).with("coefficient", joint.damping));
        }
        if joint.friction > 0.0 && !has(&|effect| held::level(effect).is_some()) {
            effects.push(Effect::of(&COULOMB_FRICTION).on(&joint.name).with("level", joint.friction));
        }
    }
    if which != UrdfFriction::Ignored {
        let is_open = |name: &str| {
            let is_here = arm.joints().iter().any(|joint| joint.name == name);
            let is_known = |effect: &Effect| effect.is(&ROTOR_INERTIA) && effect.joint() == Some(name);
            is_here && !known.iter().any(is_known)
        };
        for (joint, inertia) in stated_drive_inertias(&robot.text)? {
            if inertia > 0.0 && is_open(&joint) {
                effects.push(Effect::of(&ROTOR_INERTIA).on(&joint).with("inertia", inertia));
            }
        }
    }
    let remark = (which == UrdfFriction::Diagnosed && !omitted.is_empty()).then(|| {
        format!(
            "the friction in <dynamics> of {} is not used, because it is a placeholder in most URDFs; --urdf-friction known \
             takes it as known",
            omitted.join(", ")
        )
    });
    Ok((effects, remark))
}

#[cfg(test)]
mod tests {
    use torque::summed;

    use super::*;
    use crate::held::Export;
    use crate::urdf_file::corrected_urdf;

    const TWO: &str = r#"<robot name="two"><link name="base"/>
<joint name="a" type="continuous"><parent link="base"/><child link="upper"/><dynamics damping="10" friction="0.1"/></joint>
<link name="upper"><inertial><mass value="2"/><inertia ixx=".1" ixy="0" ixz="0" iyy=".1" iyz="0" izz=".1"/></inertial></link>
<joint name="b" type="continuous"><parent link="upper"/><child link="lower"/><dynamics damping="10" friction="0.1"/></joint>
<link name="lower"><inertial><mass value="1"/><inertia ixx=".1" ixy="0" ixz="0" iyy=".1" iyz="0" izz=".1"/></inertial></link>
</robot>"#;

    fn robot(text: &str) -> (RobotFile, Arm) {
        let text = text.to_owned();
        let arm = Arm::from_urdf_text(&text, "two.urdf").expect("it is an arm");
        let path = "two.urdf".into();
        (RobotFile { path, text }, arm)
    }

    /// Friction that a diagnosis wrote is known in the next one; friction of the original file is a placeholder.
    #[test]
    fn diagnosed_friction_is_known_and_other_friction_only_on_request() {
        let (file, arm) = robot(TWO);
        let (none, remark) = known_friction(&file, &arm, UrdfFriction::Diagnosed, &[]).expect("it reads");
        assert!(none.is_empty());
        assert!(remark.expect("it says so").contains("of a, b is not used"));
        let (all, remark) = known_friction(&file, &arm, UrdfFriction::Known, &[]).expect("it reads");
        assert_eq!((all.len(), remark), (4, None));
        let (none, remark) = known_friction(&file, &arm, UrdfFriction::Ignored, &[]).expect("it reads");
        assert_eq!((none.len(), remark), (0, None));

        let found = [Effect::of(&VISCOUS_FRICTION).on("b").with("coefficient", 1.5)];
        let (file, arm) = robot(&corrected_urdf(TWO, &arm, &found).expect("it is written").text);
        let (known, remark) = known_friction(&file, &arm, UrdfFriction::Diagnosed, &[]).expect("it reads");
        assert_eq!(known, found);
        assert!(remark.expect("it says so").contains("of a is not used"));
        // The next findings are in addition to it, and become one effect of each kind.
        let level = Effect::of(&COULOMB_FRICTION).on("b").with("level", 0.25);
        let other = Effect::of(&VISCOUS_FRICTION).on("a").with("coefficient", 4.0);
        let more = summed(&known, &[level, found[0].clone(), other]);
        assert_eq!(more.len(), 3);
        let (_, arm) = robot(&corrected_urdf(&file.text, &arm, &more).expect("it is written").text);
        let joint = &arm.joints()[1];
        assert_eq!((joint.damping, joint.friction), (3.0, 0.25));
        // A written drive inertia is known, at the joint, and is replaced by the sum with the found one.
        let drive = |inertia: f64| Effect::of(&ROTOR_INERTIA).on("a").with("inertia", inertia);
        let geared = corrected_urdf(TWO, &arm, &[drive(0.5)]).expect("it is written").text;
        let geared = geared.replace("gear_ratio value=\"1\"", "gear_ratio value=\"10\"");
        let (file, arm) = robot(&geared);
        let (known, _) = known_friction(&file, &arm, UrdfFriction::Diagnosed, &[]).expect("it reads");
        assert_eq!(known, [drive(50.0)]);
        let more = summed(&known, &[drive(10.0)]);
        assert_eq!(more, [drive(60.0)]);
        let Export { text, omitted } = corrected_urdf(&file.text, &arm, &more).expect("it is written");
        assert!(omitted.is_empty() && text.contains("rotor_inertia value=\"0.6\""), "{omitted:?} {text}");
        let (none, _) = known_friction(&file, &arm, UrdfFriction::Ignored, &[]).expect("it reads");
        assert!(none.is_empty());
        let (file, arm) = robot(TWO);
        let (file, arm) = robot(&corrected_urdf(&file.text, &arm, &found).expect("it is written").text);
        // The damping of --known on a joint replaces the file's.
        let (known, _) = known_friction(&file, &arm, UrdfFriction::Diagnosed, &found).expect("it reads");
        assert!(known.iter().all(|effect| effect.is(&COULOMB_FRICTION)), "{known:?}");
    }
}
