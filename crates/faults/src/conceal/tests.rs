//! Cases are reproducible, and their truths are complete.

use arm::Arm;

use super::real_life::RealLife;
use super::*;
use crate::machine::Machine;
use crate::test_robots::{puma, seven_axis};

fn plan(hard: bool, effects: &[&str]) -> CasePlan {
    CasePlan {
        index: 0,
        name: "case_007".into(),
        seed: 11,
        hard,
        background_friction: true,
        effects: effects.iter().map(ToString::to_string).collect(),
        lifelike: false,
        urdf_error: 0.0,
    }
}

#[test]
fn a_case_is_the_same_every_time() {
    let plan = plan(true, &["torque_offset"]);
    let robot = seven_axis();
    let first = conceal_case(&robot, &plan).expect("it comes out");
    assert_eq!(first, conceal_case(&robot, &plan).expect("it comes out"));
    assert_eq!((first.train.len(), first.truth.case.as_str()), (2, "case_007"));

    // Baseline friction is on every joint, without a share; the drawn effects are present, with shares within bounds.
    let baseline = first.truth.injected.iter().filter(|effect| effect.expressed_share.is_none());
    assert_eq!(baseline.count(), 14);
    let effect = first.truth.injected.iter().find(|effect| effect.effect == "torque_offset");
    let share = effect.and_then(|effect| effect.expressed_share).expect("it is there");
    assert!((0.01..1.2).contains(&share), "{share}");
    // One clock for the whole case: recordings of 25 s, 5 s apart.
    let starts: Vec<f64> = first.train.iter().chain([&first.held_out]).map(|run| run.time[0].round()).collect();
    assert_eq!(starts, [0.0, 30.0, 60.0]);
}

#[test]
fn the_truth_contains_the_given_effects() {
    let mut payload = Injected::new("payload", None).with("mass", 1.0).with("com", serde_json::json!([0.0, 0.0, 0.1]));
    payload.onset = Some(12.0);
    let settings = Settings { training: 1, rate: 100, ..Settings::default() };
    let made = conceal_effects(&puma(), "one", &[payload.clone()], &settings).expect("it can be");
    let (drives, given) = made.truth.injected.split_at(6);
    assert!(drives.iter().all(|effect| effect.effect == "rotor_inertia" && effect.expressed_share.is_none()));
    let share = given[0].expressed_share.expect("it was run without");
    assert!(share > 0.1, "{share}");
    payload.expressed_share = given[0].expressed_share;
    assert_eq!(given, [payload]);
    assert!(!made.truth.background_friction && made.truth.period == 0.01);
    assert_eq!((made.train.len(), made.train[0].len()), (1, 2500));
    // A written truth is read again unchanged.
    let text = serde_json::to_string(&made.truth).expect("it is JSON");
    let read: Truth = serde_json::from_str(&text).expect("it is a truth");
    assert_eq!(read, made.truth);
}

/// A saved diagnosis has the spring and the rotor as two effects. The share of the rotor is that of the rotor with its spring.
#[test]
fn a_spring_and_its_rotor_may_be_two_effects() {
    let spring = Injected::new("joint_elasticity", Some("axis4")).with("stiffness", 800.0).with("damping", 2.0);
    let rotor = Injected::new("rotor_inertia", Some("axis4")).with("inertia", 0.8);
    let settings = Settings { training: 1, ..Settings::default() };
    let made = conceal_effects(&seven_axis(), "two", &[spring.clone(), rotor.clone()], &settings).expect("it can be");
    let shares: Vec<f64> = made.truth.injected.iter().filter_map(|effect| effect.expressed_share).collect();
    assert!(shares.len() == 2 && shares.iter().all(|share| *share > 0.001), "{shares:?}");
    let alone = conceal_effects(&seven_axis(), "one", &[spring], &settings).expect_err("its rotor is missing");
    assert!(alone.to_string().contains("add rotor"), "{alone}");
}

/// A coupling is symmetric; given friction takes the place of the baseline friction on its joint.
#[test]
fn an_effect_is_listed_once_and_for_the_outer_joint() {
    let coupling = Injected::new("transmission_coupling", Some("axis3")).with("other", "axis4").with("viscous", 0.3);
    let coupling = coupling.with("inertia", 0.01);
    let friction = Injected::new("viscous_friction", Some("axis1")).with("coefficient", 0.2);
    let settings = Settings { training: 1, background_friction: true, ..Settings::default() };
    let made = conceal_effects(&seven_axis(), "one", &[coupling, friction], &settings).expect("it can be");
    let on = |name: &str, joint: &str| {
        let is_it = |e: &&Injected| e.effect == name && e.joint.as_deref() == Some(joint);
        made.truth.injected.iter().filter(is_it).count()
    };
    assert_eq!((on("transmission_coupling", "axis4"), on("transmission_coupling", "axis3")), (1, 0));
    assert_eq!((on("viscous_friction", "axis1"), on("coulomb_friction", "axis1")), (1, 1));
}

#[test]
fn impossible_effects_are_refused() {
    let robot = seven_axis();
    let refuse = |effect: Injected| {
        let error = conceal_effects(&robot, "no", &[effect], &Settings::default()).expect_err("it is refused");
        error.to_string()
    };
    let has = |text: String, part: &str| assert!(text.contains(part), "{text}");
    has(refuse(Injected::new("sprung", Some("axis1"))), "did you mean \"spring\"");
    has(refuse(Injected::new("spring", Some("axis9")).with("stiffness", 1.0)), "did you mean");
    has(refuse(Injected::new("spring", Some("axis1")).with("rest", 1.0)), "add stiffness");
    has(refuse(Injected::new("spring", None)), "the joint is missing");
    let spring = Injected::new("spring", Some("axis1")).with("stiffness", 1.0).with("rest", 1.0);
    has(refuse(spring.formed("air spring")), "gas spring, hardening, knee");
    let offset = Injected::new("torque_offset", Some("axis1")).with("offset", 1.0);
    has(refuse(offset.formed("round")), "one only");
    has(refuse(Injected::new("actuation_delay", Some("axis1")).with("delay", 2.0)), "delay");
    let payload = Injected::new("payload", None).with("mass", 1.0).with("com", serde_json::json!([0.0, 0.0, 0.05]));
    let inertia = serde_json::json!([0.02, 0.0, 0.001, 0.0, 0.0, 0.001]);
    has(refuse(payload.with("inertia", inertia)), "no body has the inertia");
    let contact = |start: f64| {
        let force = serde_json::json!([10.0, 0.0, 0.0]);
        Injected::new("external_contact", None).with("force", force).with("start", start).with("duration", 1.0)
    };
    has(refuse(contact(26.0)), "within one recording (0 to 25 s");
    let rotor = Injected::new("rotor_inertia", Some("axis2")).with("inertia", 1.0);
    let sprung = Injected::new("joint_elasticity", Some("axis2")).with("stiffness", 3000.0).with("damping", 5.0);
    let two = [sprung.with("rotor", 0.6), rotor];
    let error = conceal_effects(&robot, "no", &two, &Settings::default()).expect_err("it is refused");
    has(error.to_string(), "are one inertia");
    let rate = Settings { rate: 300, ..Settings::default() };
    has(conceal_effects(&robot, "no", &[], &rate).expect_err("it is refused").to_string(), "500");
}

/// A case is written to its folder, its truth elsewhere, and neither is ever overwritten.
#[test]
fn cases_are_written_once() {
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    let truths = folder.path().join("truth");
    let plan = plan(true, &[]);
    let made = conceal_case(&seven_axis(), &plan).expect("it comes out");
    let case = crate::write_case(&made, folder.path(), &truths).expect("it is written");
    let mut files: Vec<String> = std::fs::read_dir(&case)
        .expect("it is there")
        .flatten()
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    files.sort();
    assert_eq!(files, ["held_out.csv", "robot.urdf", "train_1.csv", "train_2.csv"]);
    let read = Recording::read(&case.join("train_2.csv")).expect("it is a recording");
    assert_eq!((read.time, read.tau), (made.train[1].time.clone(), made.train[1].tau.clone()));
    assert!(truths.join("case_007.json").is_file());
    let error = crate::write_case(&made, folder.path(), &truths).expect_err("it is refused").to_string();
    assert!(error.contains("nothing is overwritten"), "{error}");
}

/// A case that resembles a real robot: small effects on every joint that are not scored, friction that differs between
/// recordings, a URDF with errors. The truth contains them, and the machine can be made from it.
#[test]
fn the_truth_of_a_lifelike_case_is_complete() {
    let robot = seven_axis();
    let n = robot.arm().dof();
    let plan = CasePlan { lifelike: true, urdf_error: 0.1, ..plan(false, &["quadratic_drag"]) };
    let made = conceal_case(&robot, &plan).expect("it comes out");
    let truth = &made.truth;
    assert_eq!(truth.urdf_sigma, Some(0.1));
    let real = truth.lifelike.as_ref().expect("it is one");
    assert_eq!((real.friction.len(), real.friction[0].len()), (4, n));
    assert!(real.friction.iter().flatten().all(|factor| (factor - 1.0).abs() <= 0.1));
    for name in ["stribeck_friction", "friction_asymmetry", "load_dependent_friction", "torque_ripple", "torque_scale"]
    {
        let small = truth.injected.iter().filter(|effect| effect.minor && effect.effect == name);
        assert_eq!(small.count(), n, "{name}");
    }
    let asked: Vec<&Injected> = truth.injected.iter().filter(|effect| effect.expressed_share.is_some()).collect();
    assert_eq!((asked.len(), asked[0].effect.as_str(), asked[0].minor), (1, "quadratic_drag", false));
    let text = serde_json::to_string(truth).expect("it is JSON");
    assert_eq!(&serde_json::from_str::<Truth>(&text).expect("it is a truth"), truth);
    let believed = Arm::from_urdf_text(&made.urdf, "case").expect("it is an arm");
    for (is, was) in believed.joints().iter().zip(robot.arm().joints()) {
        assert!(is.inertia.mass != was.inertia.mass && is.inertia.mass > 0.0);
    }
    let all: Vec<&Injected> = truth.injected.iter().collect();
    assert!(Machine::new(&robot, &all, None).is_ok());
    // The machine is the true one, whatever errors the URDF has.
    let exact = CasePlan { urdf_error: 0.0, ..plan };
    let exact = conceal_case(&robot, &exact).expect("it comes out");
    assert_eq!((exact.train, exact.urdf.as_str()), (made.train, robot.urdf()));
}

/// The small effects of one kind, on all joints at the same time, with the part of each joint's torque that is not
/// scored.
#[test]
fn small_effects_are_small() {
    let robot = puma();
    let kind = Kind { seed: 5, hard: false, training: 1, friction: true, lifelike: true, urdf_error: 0.0 };
    let mut stage = Stage::new(&robot, kind).expect("it can be");
    let small = stage.real.take().expect("it is one").small;
    let mut torques = |small: Vec<Injected>| {
        stage.real = Some(RealLife { small, ..RealLife::default() });
        let run = stage.run(&[], None, &stage.training[0]).expect("it runs");
        [stage.torques(&run).0]
    };
    let bare = torques(Vec::new());
    for name in ["stribeck_friction", "friction_asymmetry", "load_dependent_friction", "torque_ripple"] {
        let of_the_kind: Vec<Injected> = small.iter().filter(|effect| effect.effect == name).cloned().collect();
        assert!(of_the_kind.len() == 6 && of_the_kind.iter().all(|effect| effect.minor));
        let share = crate::expressed_share::share(&torques(of_the_kind), &bare, true);
        assert!((1e-4..0.015).contains(&share), "{name}: {share}");
    }
}

/// A tool that is drawn and not mounted: the machine is the robot without it, the URDF has it, and its share is that
/// of its torque.
#[test]
fn a_tool_that_is_not_mounted_is_only_in_the_urdf() {
    let robot = puma();
    let tool = Injected::new("payload", None).with("mass", -0.7).with("com", serde_json::json!([0.0, 0.0, 0.1]));
    let settings = Settings { training: 1, ..Settings::default() };
    let record = |effects: &[Injected]| conceal_effects(&robot, "one", effects, &settings).expect("it can be");
    let (with, without) = (record(std::slice::from_ref(&tool)), record(&[]));
    assert_eq!(with.train, without.train);
    let mass = |urdf: &str| {
        let arm = Arm::from_urdf_text(urdf, "case").expect("it is an arm");
        arm.joints().iter().map(|joint| joint.inertia.mass).sum::<f64>()
    };
    assert!((mass(&with.urdf) - mass(&without.urdf) - 0.7).abs() < 1e-9);
    let share = with.truth.injected.last().and_then(|effect| effect.expressed_share);
    assert!(share.is_some_and(|share| share > 0.02), "{share:?}");
    let mut later = tool;
    later.onset = Some(3.0);
    assert!(conceal_effects(&robot, "one", &[later], &settings).is_err());
}
