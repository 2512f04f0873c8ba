//! Effect files that are written and read again are the same, and errors name their line.

use super::*;
use effects::arm::{EXTERNAL_CONTACT, GRAVITY_MISALIGNMENT, INERTIAL_SCALE, LINK_INERTIAL_ERROR, PAYLOAD};
use effects::drive::{
    ACTUATION_DELAY, BACKLASH, JOINT_ELASTICITY, ROTOR_INERTIA, TORQUE_RIPPLE, TORQUE_SATURATION, TRANSMISSION_COUPLING,
};
use effects::friction::{
    COULOMB_FRICTION, FRICTION_ASYMMETRY, LOAD_DEPENDENT_FRICTION, QUADRATIC_DRAG, STRIBECK_FRICTION, THERMAL_DRIFT,
    VISCOUS_FRICTION,
};
use effects::joint::SPRING;
use effects::sensor::{ENCODER_OFFSET, TORQUE_OFFSET, TORQUE_SCALE};

fn arm() -> Arm {
    Arm::from_urdf_text(include_str!("../../../../assets/puma560.urdf"), "puma560.urdf").expect("it is an arm")
}

/// One effect of each kind.
fn all(joint: &str, other: &str) -> Vec<Effect> {
    let joint = || joint.to_owned();
    vec![
        Effect::of(&VISCOUS_FRICTION).on(joint()).with("coefficient", 0.1),
        Effect::of(&COULOMB_FRICTION).on(joint()).with("level", 2.0),
        Effect::of(&FRICTION_ASYMMETRY).on(joint()).with("positive", 1.0 / 3.0).with("negative", 0.25),
        Effect::of(&STRIBECK_FRICTION)
            .on(joint())
            .with("coulomb", 1.0)
            .with("breakaway", 1.5)
            .with("velocity", 0.02)
            .with("exponent", 1.0),
        Effect::of(&LOAD_DEPENDENT_FRICTION).on(joint()).with("coulomb", 1e-9).with("gain", 0.1),
        Effect::of(&THERMAL_DRIFT).on(joint()).with("coulomb", 1.0).with("amplitude", 0.4).with("time_constant", 600.0),
        Effect::of(&QUADRATIC_DRAG).on(joint()).with("coefficient", 0.3).with("exponent", 2.0),
        Effect::of(&ROTOR_INERTIA).on(joint()).with("inertia", 0.2),
        Effect::of(&TORQUE_SCALE).on(joint()).with("factor", 1.1),
        Effect::of(&TORQUE_OFFSET).on(joint()).with("offset", -0.1),
        Effect::of(&TORQUE_RIPPLE).on(joint()).with("amplitude", 0.2).with("periods", 12.0).with("phase", 0.3),
        Effect::of(&TORQUE_SATURATION).on(joint()).with("limit", 20.0),
        Effect::of(&ACTUATION_DELAY).on(joint()).with("delay", 0.004),
        Effect::of(&JOINT_ELASTICITY).on(joint()).with("stiffness", 1e4).with("damping", 3.0),
        Effect::of(&BACKLASH).on(joint()).with("halfgap", 0.001),
        Effect::of(&TRANSMISSION_COUPLING)
            .on(joint())
            .with("sense", 1.0)
            .with_other(other)
            .with("viscous", 0.6)
            .with("coulomb", 1.9)
            .with("inertia", 0.01),
        Effect::of(&PAYLOAD)
            .with("mass", 1.5)
            .with("com", [0.0, 0.01, 0.1])
            .with("inertia", [0.01, 0.0, 0.01, 0.0, 0.0, 0.02]),
        Effect::of(&LINK_INERTIAL_ERROR).on(joint()).with("relative", -0.1),
        Effect::of(&INERTIAL_SCALE).with("factor", 1.05),
        Effect::of(&GRAVITY_MISALIGNMENT).with("angle", 0.05).with("axis", [0.0, 1.0, 0.0]),
        Effect::of(&ENCODER_OFFSET).on(joint()).with("offset", 0.01),
        Effect::of(&SPRING).on(joint()).with("stiffness", 10.0).with("rest", 0.1),
        Effect::of(&SPRING)
            .on(joint())
            .with("stiffness", 0.0)
            .with("rest", 0.0)
            .with("curve", vec![[-1.0, 2.0], [0.5, 1.0]]),
        Effect::of(&EXTERNAL_CONTACT).with("start", 12.0).with("duration", 0.5).with("force", [0.0, 10.0, -5.0]),
    ]
}

#[test]
fn every_effect_is_read_as_written() {
    let arm = arm();
    let joints = joints(&arm);
    let file = EffectFile { robot: Some(arm.name().to_owned()), effects: all(&joints[1], &joints[2]) };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("corrected.toml");
    file.write(&path).expect("it is written");
    assert_eq!(EffectFile::load(&path, &arm).expect("it is read"), file);
    let text = file.to_text().expect("it is text");
    assert!(text.contains("level = 2.0 # N m\n"), "{text}");
    assert!(text.contains("com = [0.0, 0.01, 0.1] # m, in the tool's frame\n"), "{text}");
}

#[test]
fn a_file_without_effects_is_valid() {
    let read = EffectFile::parse(format!("schema = \"{SCHEMA}\"\n"), Path::new("k.toml"), &arm());
    assert_eq!(read.expect("it is read"), EffectFile::default());
}

#[test]
fn errors_name_line_and_remedy() {
    let arm = arm();
    let joint = joints(&arm)[1].clone();
    let head =
        format!("schema = \"{SCHEMA}\"\n\n[[effects]]\neffect = \"inertial_scale\"\nfactor = 1\n\n[[effects]]\n");
    let cases = [
        (
            "effect = \"coulomb_frictoin\"\n".to_owned(),
            ":8: there is no effect \"coulomb_frictoin\"; did you mean \"coulomb_friction\"?",
        ),
        ("joint = \"x\"\n".to_owned(), ":7: the line effect = … is missing"),
        (
            "effect = \"coulomb_friction\"\nlevel = 2\n".to_owned(),
            ":7: the line joint = \"…\" is missing; the robot has",
        ),
        (format!("effect = \"coulomb_friction\"\njoint = \"{joint}\"\n"), ":7: the line level = … is missing"),
        (
            format!("effect = \"coulomb_friction\"\njoint = \"{joint}x\"\nlevel = 2\n"),
            &format!(":9: coulomb_friction: the robot has no joint \"{joint}x\""),
        ),
        (
            format!("effect = \"coulomb_friction\"\njoint = \"{joint}\"\n# a remark\nlevel = -2\n"),
            ":11: coulomb_friction of ",
        ),
        (
            format!("effect = \"transmission_coupling\"\njoint = \"{joint}\"\nother = \"{joint}\"\nviscous = 2\n"),
            ":10: transmission_coupling of",
        ),
        (
            format!("effect = \"coulomb_friction\"\njoint = \"{joint}\"\nlevle = 2\n"),
            ":10: unknown key `levle`; did you mean `level`?",
        ),
        (
            format!("effect = \"coulomb_friction\"\njoint = \"{joint}\"\nlevel = nan\n"),
            "level is NaN; it must be finite",
        ),
        ("effect = \n".to_owned(), ":8: "),
    ];
    for (text, expected) in cases {
        let error =
            EffectFile::parse(format!("{head}{text}"), Path::new("known.toml"), &arm).expect_err("it is refused");
        let error = error.to_string();
        assert!(error.starts_with("known.toml:") && error.contains(expected), "{error}\n is not\n{expected}");
    }
    for (text, expected) in [
        ("schema = \"testbed.model/9\"\n", "known.toml:1: the schema is"),
        ("[[effects]]\n", "the line schema = \"testbed.model/1\" is missing"),
        ("schema = \"testbed.model/1\"\nrobot = \"other\"\n", "known.toml:2: the effects are of robot \"other\""),
    ] {
        let error = EffectFile::parse(text.to_owned(), Path::new("known.toml"), &arm).expect_err("it is refused");
        assert!(error.to_string().contains(expected), "{error}");
    }
}

#[test]
fn an_effect_given_twice_is_refused_with_both_places() {
    let friction = |joint: &str, size: &str| {
        format!("[[effects]]\neffect = \"viscous_friction\"\njoint = \"{joint}\"\ncoefficient = {size}\n")
    };
    let ripple = |periods: &str| {
        format!(
            "[[effects]]\neffect = \"torque_ripple\"\njoint = \"joint1\"\namplitude = 1.0\nperiods = {periods}\nphase = 0.0\n"
        )
    };
    let parse = |effects: &[String]| {
        let text = format!("schema = \"testbed.model/1\"\n{}", effects.concat());
        EffectFile::parse(text, Path::new("k.toml"), &arm()).map_err(|error| error.to_string())
    };
    let twice = [friction("joint1", "1.0"), friction("joint2", "1.0"), friction("joint1", "2.0")];
    let found = parse(&twice).expect_err("it is refused");
    for part in ["k.toml:10: viscous_friction on joint1 is given twice", "first at k.toml:2", "keep one"] {
        assert!(found.contains(part), "\"{part}\" is missing from: {found}");
    }
    assert!(parse(&twice[..2]).is_ok());
    assert!(parse(&[ripple("10.0"), ripple("20.0")]).is_ok());
    assert!(parse(&[ripple("10.0"), ripple("10.0")]).is_err());
    let payload = |mass: &str| format!("[[effects]]\neffect = \"payload\"\nmass = {mass}\ncom = [0.0, 0.0, 0.1]\n");
    // A known body, and another that was found in addition.
    assert_eq!(parse(&[payload("1.0"), payload("-0.3")]).map(|file| file.effects.len()), Ok(2));
    assert!(parse(&[payload("1.0"), payload("1.0")]).is_err());
    let found = parse(&[friction("joint1", "1e308")]).expect_err("it is refused");
    assert!(found.contains("k.toml:5: coefficient is 1e308") && found.len() < 200, "{found}");
    // Whole numbers and lists, too.
    assert!(parse(&[friction("joint1", "8352007717348")]).is_err());
    assert!(parse(&[payload("1.0").replace("0.1]", "1e13]")]).is_err());
}
