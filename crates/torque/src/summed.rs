//! Known effects and the effects that are found in addition to them, as one list.

use effects::Effect;

/// The known effects and the findings in addition to them. Findings, too, may be in addition to others: those that are new since the
/// recordings from before. Two effects of one kind that one effect of that kind can replace become one.
pub fn summed(known: &[Effect], found: &[Effect]) -> Vec<Effect> {
    let mut sum = known.to_vec();
    for effect in found {
        let together = |other: &Effect| {
            let key = |effect: &Effect| (effect.kind(), effect.joint().map(str::to_owned), effect.onset());
            let is_same = key(other) == key(effect);
            is_same.then(|| (effect.spec().sum)(other, effect)).flatten()
        };
        match sum.iter_mut().find_map(|other| Some((together(other)?, other))) {
            Some((both, one)) => *one = both,
            None => sum.push(effect.clone()),
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use arm::Arm;
    use effects::arm::{INERTIAL_SCALE, LINK_INERTIAL_ERROR, PAYLOAD};
    use effects::drive::{BACKLASH, ROTOR_INERTIA};
    use effects::friction::{COULOMB_FRICTION, QUADRATIC_DRAG, VISCOUS_FRICTION};
    use effects::joint::SPRING;
    use effects::sensor::{ENCODER_OFFSET, TORQUE_OFFSET, TORQUE_SCALE};

    use super::*;
    use crate::{Corrected, Prediction, TorqueModel, Workspace};

    const ARM: &str = r#"<robot name="two"><link name="base"/>
<joint name="a" type="continuous"><parent link="base"/><child link="la"/><axis xyz="0 1 0"/></joint>
<link name="la"><inertial><origin xyz=".5 0 0"/><mass value="1"/><inertia ixx=".1" ixy="0" ixz="0" iyy=".1" iyz="0" izz=".1"/></inertial></link>
<joint name="b" type="continuous"><origin xyz="1 0 0"/><parent link="la"/><child link="lb"/><axis xyz="0 1 0"/></joint>
<link name="lb"><inertial><origin xyz=".2 0 0"/><mass value="2"/><inertia ixx=".1" ixy="0" ixz="0" iyy=".1" iyz="0" izz=".1"/></inertial></link>
</robot>"#;

    /// The torque of joint a with these effects (N m).
    fn torque(effects: &[Effect]) -> f64 {
        let arm = Arm::from_urdf_text(ARM, "two.urdf").expect("it is an arm");
        let model = Corrected::new(&arm, effects).expect("it is physical");
        let (mut workspace, mut prediction) = (Workspace::new(2), Prediction::new(2));
        let [q, qd, qdd] = [[0.4, -0.9], [0.7, -1.1], [1.3, 0.6]];
        model.predict(&mut workspace, &q, &qd, &qdd, &mut prediction);
        prediction.torque(0)
    }

    /// One effect in the place of two has their torque.
    #[test]
    fn the_sum_of_two_effects_is_both() {
        let on = |kind| Effect::of(kind).on("a");
        let spring = |stiffness: f64, rest: f64| on(&SPRING).with("stiffness", stiffness).with("rest", rest);
        let drag = |exponent: f64| on(&QUADRATIC_DRAG).with("coefficient", 0.4).with("exponent", exponent);
        let scale = |factor: f64| Effect::of(&INERTIAL_SCALE).with("factor", factor);
        let body = |mass: f64| Effect::of(&PAYLOAD).with("mass", mass).with("com", [0.1, 0.0, 0.0]);
        let list = [
            (on(&COULOMB_FRICTION).with("level", 2.0), on(&COULOMB_FRICTION).with("level", 0.5), 1),
            (on(&VISCOUS_FRICTION).with("coefficient", 2.0), on(&VISCOUS_FRICTION).with("coefficient", 0.5), 1),
            (on(&ROTOR_INERTIA).with("inertia", 2.0), on(&ROTOR_INERTIA).with("inertia", 0.5), 1),
            (on(&TORQUE_OFFSET).with("offset", 2.0), on(&TORQUE_OFFSET).with("offset", -0.5), 1),
            (on(&ENCODER_OFFSET).with("offset", 0.05), on(&ENCODER_OFFSET).with("offset", -0.02), 1),
            (on(&TORQUE_SCALE).with("factor", 1.1), on(&TORQUE_SCALE).with("factor", 0.9), 1),
            (on(&LINK_INERTIAL_ERROR).with("relative", 0.2), on(&LINK_INERTIAL_ERROR).with("relative", -0.1), 1),
            (scale(1.2), scale(0.9), 1),
            (spring(3.0, 0.2), spring(-1.0, 0.5), 1),
            (drag(2.0), drag(2.0), 1),
            // Two laws, or two bodies, stay two.
            (drag(2.0), drag(1.5), 2),
            (body(0.4), body(0.2), 2),
        ];
        for (a, b, count) in list {
            let sum = summed(std::slice::from_ref(&a), std::slice::from_ref(&b));
            assert_eq!(sum.len(), count, "{sum:?}");
            let [together, both] = [torque(&sum), torque(&[a, b])];
            assert!((together - both).abs() < 1e-12, "{sum:?}: {together} instead of {both}");
        }
    }

    /// Effects on other joints, or with an onset of their own, are not added.
    #[test]
    fn effects_at_other_places_and_times_stay_apart() {
        let offset = |joint: &str, onset| Effect::of(&TORQUE_OFFSET).on(joint).with("offset", 1.0).since(onset);
        let sum = summed(&[offset("a", None)], &[offset("b", None), offset("a", Some(2.0))]);
        assert_eq!(sum.len(), 3, "{sum:?}");
        let gap = |size: f64| Effect::of(&BACKLASH).on("a").with("halfgap", size);
        assert_eq!(summed(&[gap(0.01)], &[gap(0.02)]).len(), 2);
    }
}
