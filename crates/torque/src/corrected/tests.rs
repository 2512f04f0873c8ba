//! The torques of effects against values computed by hand, and parameters that are refused.

use arm::Arm;
use effects::arm::{EXTERNAL_CONTACT, GRAVITY_MISALIGNMENT, INERTIAL_SCALE, LINK_INERTIAL_ERROR, PAYLOAD};
use effects::drive::{ROTOR_INERTIA, TORQUE_RIPPLE, TORQUE_SATURATION, TRANSMISSION_COUPLING};
use effects::friction::{
    COULOMB_FRICTION, FRICTION_ASYMMETRY, LOAD_DEPENDENT_FRICTION, QUADRATIC_DRAG, STRIBECK_FRICTION, THERMAL_DRIFT,
    VISCOUS_FRICTION,
};
use effects::joint::SPRING;
use effects::sensor::{ENCODER_OFFSET, TORQUE_OFFSET, TORQUE_SCALE};

use super::*;

/// Two parallel axes along z in a horizontal plane: without motion, the rigid torque is zero.
const FLAT: &str = r#"<robot name="flat"><link name="base"/>
<joint name="a" type="continuous"><parent link="base"/><child link="la"/><axis xyz="0 0 1"/></joint>
<link name="la"><inertial><mass value="1"/><inertia ixx=".1" ixy="0" ixz="0" iyy=".1" iyz="0" izz=".2"/></inertial></link>
<joint name="b" type="continuous"><origin xyz="1 0 0"/><parent link="la"/><child link="lb"/><axis xyz="0 0 1"/></joint>
<link name="lb"><inertial><mass value="2"/><inertia ixx=".1" ixy="0" ixz="0" iyy=".1" iyz="0" izz=".3"/></inertial></link>
<joint name="f" type="fixed"><origin xyz=".5 0 0"/><parent link="lb"/><child link="tool"/></joint><link name="tool"/></robot>"#;

/// One axis along y, with the centre of mass 0.5 m from it.
const PENDULUM: &str = r#"<robot name="pendulum"><link name="base"/>
<joint name="a" type="continuous"><parent link="base"/><child link="l"/><axis xyz="0 1 0"/></joint>
<link name="l"><inertial><origin xyz=".5 0 0"/><mass value="2"/><inertia ixx=".1" ixy="0" ixz="0" iyy=".1" iyz="0" izz=".1"/></inertial></link></robot>"#;

fn arm(urdf: &str) -> Arm {
    Arm::from_urdf_text(urdf, "test.urdf").expect("it is an arm")
}

fn a() -> String {
    "a".into()
}

fn predict(model: &Corrected, time: Option<f64>, q: &[f64], qd: &[f64], qdd: &[f64]) -> Prediction {
    let mut workspace = Workspace::new(model.dof());
    let mut prediction = Prediction::new(model.dof());
    match time {
        Some(time) => model.predict_at(time, &mut workspace, q, qd, qdd, &mut prediction),
        None => model.predict(&mut workspace, q, qd, qdd, &mut prediction),
    }
    prediction
}

/// The torque of `effect` on joint a of the flat arm at angle `q` and velocity `qd`, without acceleration.
fn added(effect: Effect, q: f64, qd: f64) -> f64 {
    let model = Corrected::new(&arm(FLAT), &[effect]).expect("it is physical");
    predict(&model, None, &[q, 0.0], &[qd, 0.0], &[0.0, 0.0]).effects[0]
}

fn offset(offset: f64, onset: Option<f64>) -> Effect {
    let joint = a();
    Effect::of(&TORQUE_OFFSET).on(joint).with("offset", offset).since(onset)
}

fn scale(factor: f64, onset: Option<f64>) -> Effect {
    let joint = a();
    Effect::of(&TORQUE_SCALE).on(joint).with("factor", factor).since(onset)
}

#[track_caller]
fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-12, "{found} instead of {expected}");
}

#[test]
fn friction_follows_the_sign_of_the_velocity() {
    let coulomb = || Effect::of(&COULOMB_FRICTION).on(a()).with("level", 2.0);
    for (qd, expected) in [(0.3, 2.0), (-0.3, -2.0), (0.0, 0.0), (-0.0, 0.0)] {
        near(added(coulomb(), 0.0, qd), expected);
    }
    near(added(Effect::of(&VISCOUS_FRICTION).on(a()).with("coefficient", 4.0), 0.0, -0.5), -2.0);
    near(added(Effect::of(&QUADRATIC_DRAG).on(a()).with("coefficient", 4.0).with("exponent", 2.0), 0.0, -0.5), -1.0);
    let uneven = || Effect::of(&FRICTION_ASYMMETRY).on(a()).with("positive", 3.0).with("negative", 1.0);
    for (qd, expected) in [(0.3, 3.0), (-0.3, -1.0), (0.0, 0.0)] {
        near(added(uneven(), 0.0, qd), expected);
    }
    let stribeck = Effect::of(&STRIBECK_FRICTION)
        .on(a())
        .with("coulomb", 1.0)
        .with("breakaway", 3.0)
        .with("velocity", 0.2)
        .with("exponent", 2.0);
    near(added(stribeck, 0.0, -0.4), -(1.0 + 2.0 * (-4.0_f64).exp()));
}

#[test]
fn position_makes_springs_and_ripple() {
    near(added(Effect::of(&TORQUE_OFFSET).on(a()).with("offset", -0.7), 1.0, 1.0), -0.7);
    let ripple = Effect::of(&TORQUE_RIPPLE).on(a()).with("amplitude", 0.5).with("periods", 6.0).with("phase", 0.1);
    near(added(ripple, 0.3, 0.0), 0.5 * 1.9_f64.sin());
    let spring = |curve: Vec<[f64; 2]>| {
        Effect::of(&SPRING).on(a()).with("stiffness", 10.0).with("rest", 0.2).with("curve", curve)
    };
    near(added(spring(vec![]), 0.5, 0.0), 3.0);
    let curve = vec![[-1.0, 4.0], [0.0, 2.0], [1.0, 3.0]];
    for (q, expected) in [(-2.0, 4.0), (-0.5, 3.0), (0.0, 2.0), (0.25, 2.25), (9.0, 3.0)] {
        near(added(spring(curve.clone()), q, 0.0), expected);
    }
}

#[test]
fn drift_is_warm_unless_the_time_is_given() {
    let drift =
        Effect::of(&THERMAL_DRIFT).on(a()).with("coulomb", 2.0).with("amplitude", 0.5).with("time_constant", 10.0);
    let model = Corrected::new(&arm(FLAT), &[drift]).expect("it is physical");
    let at = |time| predict(&model, time, &[0.0, 0.0], &[-1.0, 0.0], &[0.0, 0.0]).effects[0];
    near(at(None), -2.0);
    near(at(Some(0.0)), -3.0);
    near(at(Some(10.0)), -2.0 * (1.0 + 0.5 * (-1.0_f64).exp()));
}

#[test]
fn load_is_the_rigid_torque_of_the_corrected_arm() {
    let effects = [
        Effect::of(&PAYLOAD).with("mass", 1.0).with("com", [0.5, 0.0, 0.0]).with("inertia", [0.0; 6]),
        Effect::of(&LOAD_DEPENDENT_FRICTION).on(a()).with("coulomb", 0.5).with("gain", 0.1),
    ];
    let model = Corrected::new(&arm(PENDULUM), &effects).expect("it is physical");
    // Gravity on a mass along x turns the arm downwards about y: the drive holds it with a negative torque.
    let found = predict(&model, None, &[0.0], &[0.0], &[0.0]);
    near(found.rigid[0], -9.81 * 1.5);
    near(found.effects[0], 0.0);
    near(predict(&model, None, &[0.0], &[-1e-9], &[0.0]).effects[0], -(0.5 + 0.1 * 9.81 * 1.5));
}

#[test]
fn inertial_effects_are_in_the_rigid_part() {
    let rigid = |effects: &[Effect], q: f64, qdd: f64| {
        let model = Corrected::new(&arm(PENDULUM), effects).expect("they are physical");
        let found = predict(&model, None, &[q], &[0.0], &[qdd]);
        assert_eq!(found.effects[0], 0.0);
        found.rigid[0]
    };
    let weight = -9.81 * 2.0 * 0.5;
    near(rigid(&[], 0.0, 0.0), weight);
    near(rigid(&[Effect::of(&ROTOR_INERTIA).on(a()).with("inertia", 0.4)], 0.0, 2.0), weight + 2.0 * (0.1 + 0.5 + 0.4));
    near(rigid(&[Effect::of(&LINK_INERTIAL_ERROR).on(a()).with("relative", 0.1)], 0.0, 0.0), 1.1 * weight);
    near(rigid(&[Effect::of(&INERTIAL_SCALE).with("factor", 1.2)], 0.0, 0.0), 1.2 * weight);
    near(rigid(&[Effect::of(&ENCODER_OFFSET).on(a()).with("offset", -0.3)], 0.2, 0.0), weight * 0.5_f64.cos());
    // Rotating the base about the joint's own axis is equivalent to rotating the joint.
    let tilt = Effect::of(&GRAVITY_MISALIGNMENT).with("angle", 0.3).with("axis", [0.0, 1.0, 0.0]);
    near(rigid(&[tilt], 0.2, 0.0), weight * 0.5_f64.cos());
}

#[test]
fn a_coupling_follows_the_other_joint() {
    let coupling = Effect::of(&TRANSMISSION_COUPLING)
        .on(a())
        .with("sense", 1.0)
        .with_other("b")
        .with("viscous", 2.0)
        .with("coulomb", 0.5)
        .with("inertia", 3.0);
    let model = Corrected::new(&arm(FLAT), &[coupling]).expect("it is physical");
    let found = predict(&model, None, &[0.0, 0.0], &[0.0, -0.1], &[0.0, 0.2]);
    near(found.effects[0], -0.2 - 0.5 + 0.6);
    // The reaction: the other joint is affected by this joint's motion, while it is at rest, and by the drive's dry
    // friction.
    near(found.effects[1], -0.5);
}

/// An effect with an onset does not act before it; without a time, it acts.
#[test]
fn an_onset_is_waited_for() {
    let effects = [offset(2.0, Some(10.0)), scale(1.5, Some(20.0))];
    let model = Corrected::new(&arm(PENDULUM), &effects).expect("they are physical");
    let of = |time| predict(&model, time, &[std::f64::consts::FRAC_PI_2], &[0.0], &[1.0]).torque(0);
    near(of(Some(9.9)), 0.6);
    near(of(Some(10.0)), 2.6);
    near(of(Some(20.0)), 3.9);
    near(of(None), 3.9);
}

#[test]
fn scale_and_limit_come_last() {
    let limit = Effect::of(&TORQUE_SATURATION).on(a()).with("limit", 2.5);
    let effects = [offset(2.0, None), scale(1.5, None), limit];
    let of = |effects: &[Effect]| {
        let model = Corrected::new(&arm(PENDULUM), effects).expect("they are physical");
        predict(&model, None, &[std::f64::consts::FRAC_PI_2], &[0.0], &[1.0]).torque(0)
    };
    near(of(&effects[..1]), 2.6);
    near(of(&effects[..2]), 3.9);
    near(of(&effects), 2.5);
}

/// At q = 0 the tool is 1.5 m from axis a and 0.5 m from axis b, along x.
#[test]
fn a_contact_pushes_while_it_lasts() {
    let contact = Effect::of(&EXTERNAL_CONTACT).with("start", 1.0).with("duration", 0.5).with("force", [5.0, 2.0, 7.0]);
    let model = Corrected::new(&arm(FLAT), &[contact]).expect("it is physical");
    let at = |time| predict(&model, time, &[0.0; 2], &[0.0; 2], &[0.0; 2]).effects;
    assert_eq!(at(None), [0.0, 0.0]);
    assert_eq!(at(Some(1.5)), [0.0, 0.0]);
    near(at(Some(1.0))[0], -3.0);
    near(at(Some(1.4))[1], -1.0);
}

/// The gear does not transmit the torque that accelerates the rotor, which is the motor's own.
#[test]
fn load_dependent_friction_does_not_grow_with_the_rotors_torque() {
    let friction = Effect::of(&LOAD_DEPENDENT_FRICTION).on(a()).with("coulomb", 0.5).with("gain", 0.1);
    let rotor = Effect::of(&ROTOR_INERTIA).on(a()).with("inertia", 7.0);
    let model = Corrected::new(&arm(PENDULUM), &[friction, rotor]).expect("they are physical");
    let prediction = predict(&model, None, &[0.0], &[1.0], &[3.0]);
    // Weight and inertia of the link: m g l acts against the positive direction about y.
    let link = (0.1 + 2.0 * 0.25) * 3.0 - 2.0 * 9.81 * 0.5;
    near(prediction.rigid[0], link + 7.0 * 3.0);
    near(prediction.effects[0], 0.5 + 0.1 * link.abs());
}

/// The sum of the effects as loads on a simulated arm is the torque of the model.
#[test]
fn loads_and_torques_agree() {
    let effects = [
        Effect::of(&FRICTION_ASYMMETRY).on(a()).with("positive", 3.0).with("negative", 1.0),
        Effect::of(&LOAD_DEPENDENT_FRICTION).on("b").with("coulomb", 0.5).with("gain", 0.1),
        Effect::of(&ROTOR_INERTIA).on("b").with("inertia", 0.4),
        Effect::of(&VISCOUS_FRICTION).on(a()).with("coefficient", 0.7),
        Effect::of(&SPRING).on("b").with("stiffness", 3.0).with("rest", 0.1),
        Effect::of(&EXTERNAL_CONTACT).with("start", 0.0).with("duration", 1.0).with("force", [1.0, 2.0, 3.0]),
    ];
    let model = Corrected::new(&arm(FLAT), &effects).expect("they are physical");
    let (q, qd, qdd) = ([0.3, -0.8], [-0.5, 0.9], [2.0, -1.0]);
    let mut workspace = Workspace::new(2);
    let (mut dry, mut opposing) = ([0.0; 2], [0.0; 2]);
    model.joint_loads(0.5, &mut workspace, &q, &qd, &qdd, &mut dry, &mut opposing);
    let expected = predict(&model, Some(0.5), &q, &qd, &qdd).effects;
    for j in 0..2 {
        near(dry[j] * sign(qd[j]) + opposing[j] + model.viscous()[j] * qd[j], expected[j]);
    }
}

#[test]
fn refusals_name_effect_joint_and_value() {
    let refused = |effect| Corrected::new(&arm(FLAT), &[effect]).expect_err("it is refused").to_string();
    assert_eq!(
        refused(Effect::of(&COULOMB_FRICTION).on("c").with("level", 1.0)),
        "coulomb_friction: the robot has no joint \"c\"; it has a, b"
    );
    assert_eq!(
        refused(Effect::of(&COULOMB_FRICTION).on(a()).with("level", -1.0)),
        "coulomb_friction of a: level is -1; it must be finite and not negative"
    );
    assert_eq!(
        refused(Effect::of(&TORQUE_SCALE).on(a()).with("factor", f64::NAN)),
        "torque_scale of a: factor is NaN; it must be finite and positive"
    );
    assert_eq!(
        refused(
            Effect::of(&PAYLOAD)
                .with("mass", 1.0)
                .with("com", [0.0; 3])
                .with("inertia", [-1.0, 0.0, 1.0, 0.0, 0.0, 1.0])
        ),
        "payload of the whole arm: inertia's smallest principal moment is -1; it must be finite and not negative"
    );
    let coupling = Effect::of(&TRANSMISSION_COUPLING)
        .on(a())
        .with("sense", 1.0)
        .with_other("x")
        .with("viscous", 1.0)
        .with("coulomb", 0.0)
        .with("inertia", 0.0);
    assert!(refused(coupling).contains("no joint \"x\""));
    let bent = Effect::of(&SPRING)
        .on(a())
        .with("stiffness", 0.0)
        .with("rest", 0.0)
        .with("curve", vec![[1.0, 0.0], [0.5, 0.0]]);
    assert!(refused(bent).contains("larger than the one before"));
    let nowhere = Effect::of(&GRAVITY_MISALIGNMENT).with("angle", 0.1).with("axis", [0.0; 3]);
    assert!(refused(nowhere).contains("axis' length is 0"));
}
