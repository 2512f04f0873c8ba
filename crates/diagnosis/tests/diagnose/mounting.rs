//! A base on a slope, on a wall or on the ceiling, a tool that is not mounted, and channels without torque.

use crate::support::{Motion, TRIO, baseline_friction, diagnosed, inputs, named, recorded, regular, sentences, trio};
use arm::{Arm, Vector3};
use diagnosis::{Diagnosis, Options, diagnose};
use effects::Effect;
use effects::friction::COULOMB_FRICTION;

/// The diagnosis of the trio's arm on a base turned by an angle (°) about an axis.
fn mounted(degrees: f64) -> Diagnosis {
    let robot = trio().with_turned_base(Vector3::new(0.6, 0.8, 0.0), degrees.to_radians());
    diagnosed(&trio(), &robot, &|motion, tau| baseline_friction(motion, tau), Vec::new())
}

#[test]
fn a_base_on_a_slope_a_wall_or_the_ceiling_is_found() {
    for degrees in [12.0, 30.0, 45.0, 90.0, 180.0] {
        let diagnosis = mounted(degrees);
        assert_eq!(named(&diagnosis), [("gravity_misalignment", None)], "{degrees}: {:?}", sentences(&diagnosis));
        let found = diagnosis.report.findings.iter().find(|finding| finding.effect == "gravity_misalignment");
        let angle = found.expect("it is found").parameters["angle"];
        let [low, high] = angle.ci95.map(f64::to_degrees);
        assert!((low..=high).contains(&degrees), "{degrees}: {low} to {high}");
        assert!(high - low < 0.05 * degrees + 0.5, "{degrees}: {low} to {high}");
        assert!(diagnosis.report.unexplained.is_empty(), "{degrees}: {:?}", diagnosis.report.unexplained);
    }
}

/// The corrected model has the reported error, because gravity has its magnitude on a wall as well.
#[test]
fn a_known_wall_is_not_found_again() {
    let robot = trio().with_turned_base(Vector3::new(0.6, 0.8, 0.0), 90.0_f64.to_radians());
    let known = mounted(90.0).effects;
    let again = diagnosed(&trio(), &robot, &|motion, tau| baseline_friction(motion, tau), known);
    assert!(named(&again).is_empty(), "{:?}", sentences(&again));
    let worst = again.report.fit.values().filter_map(|fit| fit.held_out_nrmse_nominal).fold(0.0, f64::max);
    assert!(worst < 0.02, "{worst}");
}

/// The centre of mass is the URDF's: what was fitted is the absence of the body that the URDF draws.
#[test]
fn a_tool_that_is_drawn_and_not_mounted_is_named_beside_a_wrong_link() {
    let tool = r#"<joint name="flange" type="fixed"><origin xyz="0.3 0 0.05" rpy="0 0.5 0"/><parent link="fore"/><child link="tool"/></joint>
<link name="tool"><inertial><origin xyz="0.02 0.01 0.06"/><mass value="0.9"/>
<inertia ixx="0.002" ixy="0" ixz="0" iyy="0.002" iyz="0" izz="0.001"/></inertial></link></robot>"#;
    let drawn = Arm::from_urdf_text(&TRIO.replace("</robot>", tool), "trio.urdf").expect("it is an arm");
    let robot = trio().with_scaled_link(1, 0.9);
    let diagnosis = diagnosed(&drawn, &robot, &|motion, tau| baseline_friction(motion, tau), Vec::new());
    let payload = diagnosis.report.findings.iter().find(|finding| finding.effect == "payload");
    let parameters = &payload.unwrap_or_else(|| panic!("{:?}", sentences(&diagnosis))).parameters;
    let [low, high] = parameters["mass"].ci95;
    assert!(low < -0.9 && -0.9 < high && high - low < 0.3, "{low} to {high}");
    for (key, drawn) in [("com_x", 0.02), ("com_y", 0.01), ("com_z", 0.06)] {
        assert!((parameters[key].value - drawn).abs() < 1e-9, "{key}: {}", parameters[key].value);
    }
}

/// Beside links that are all wrong by about 5 %, the last link keeps nothing of the tool, and is not called a lighter link.
#[test]
fn a_tool_that_is_not_mounted_is_named_beside_links_that_are_all_wrong() {
    const PUMA: &str = include_str!("../../../../assets/puma560.urdf");
    let tool = arm::Inertia { mass: 0.9, com: Vector3::new(0.01, 0.02, 0.08), tensor: arm::Matrix3::identity() * 2e-3 };
    let shifts = [
        [1.06, 3.0, -4.0],
        [0.94, -4.0, 5.0],
        [1.07, 5.0, 2.0],
        [0.95, -2.0, -5.0],
        [0.93, 4.0, 3.0],
        [1.05, 2.0, -3.0],
    ];
    let mut robot = Arm::from_urdf_text(PUMA, "puma560.urdf").expect("it is an arm");
    let drawn = robot.clone().with_payload(&tool);
    for (link, [factor, x, z]) in shifts.into_iter().enumerate() {
        let mut body = robot.joints()[link].inertia;
        body.com += 1e-3 * Vector3::new(x, 0.0, z);
        robot = robot.with_link_inertia(link, body).with_scaled_link(link, factor);
    }
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        for (tau, qd) in tau.iter_mut().zip(&motion.qd) {
            *tau += 4.0 * qd.signum();
        }
    };
    let diagnosis = diagnosed(&drawn, &robot, &injected, Vec::new());
    let named = named(&diagnosis);
    assert!(named.contains(&("payload", None)), "{:?}", sentences(&diagnosis));
    assert!(named.iter().all(|(effect, _)| *effect != "link_inertial_error"), "{named:?}");
    let payload = diagnosis.report.findings.iter().find(|finding| finding.effect == "payload");
    let [low, high] = payload.expect("it is named").parameters["mass"].ci95;
    assert!(low < -0.9 && -0.9 < high && high < -0.3, "{low} to {high}");
}

/// The joints that are not diagnosed, with the reasons.
fn not_diagnosed(diagnosis: &Diagnosis) -> String {
    let groups = diagnosis.report.not_diagnosed.iter();
    let said: Vec<String> = groups.map(|group| format!("{}: {}", group.joints.join(", "), group.because)).collect();
    said.join("\n")
}

/// A channel that shows zero most of the time, or another quantity, does not affect the other joints.
#[test]
fn channels_without_torque_are_omitted() {
    let robot = trio();
    let injected = |motion: &Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        tau[2] = 0.0;
    };
    let recordings: Vec<_> = [16.0, 16.0, 10.0]
        .into_iter()
        .enumerate()
        .map(|(variant, seconds)| {
            let mut recording = recorded(&robot, variant, seconds, &|motion, tau| injected(motion, tau));
            // The other samples have another value.
            for (k, tau) in recording.tau[2].iter_mut().enumerate() {
                *tau = if k % 97 < 15 { 0.3 * (k as f64).sin() } else { 0.0 };
            }
            regular(&recording)
        })
        .collect();
    let rounded: Vec<_> = [16.0, 16.0, 10.0]
        .into_iter()
        .enumerate()
        .map(|(variant, seconds)| {
            let mut recording = recorded(&robot, variant, seconds, &|motion, tau| baseline_friction(motion, tau));
            // Two steps up and down.
            let largest = recording.tau[2].iter().fold(0.0_f64, |most, tau| most.max(tau.abs()));
            for tau in &mut recording.tau[2] {
                *tau = (2.0 * *tau / largest).round() * 0.5 * largest;
            }
            regular(&recording)
        })
        .collect();
    let coarse = diagnose(&trio(), &inputs(&rounded), &Options::default(), &|_| {}).expect("it can be diagnosed");
    let reasons = not_diagnosed(&coarse);
    assert!(reasons.contains("elbow: the torque channel shows only 5 different values"), "{reasons}");
    let diagnosis = diagnose(&trio(), &inputs(&recordings), &Options::default(), &|_| {}).expect("it can be diagnosed");
    assert!(named(&diagnosis).is_empty(), "{:?}", sentences(&diagnosis));
    let reasons = not_diagnosed(&diagnosis);
    assert!(reasons.contains("elbow: the torque channel shows one and the same value"), "{reasons}");
    let friction = |joint: &str| {
        diagnosis.report.findings.iter().filter(|finding| finding.joint.as_deref() == Some(joint)).count()
    };
    assert_eq!([friction("turn"), friction("shoulder"), friction("elbow")], [2, 2, 0]);
}

/// A drive that reports the commanded torque far beyond its limit still has a torque channel: below the limit it follows the model.
#[test]
fn the_channel_of_a_drive_at_its_limit_is_a_torque() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        // The commands of a loop that has lost its joint: in some half seconds hundreds of times what moves the joint.
        let half_seconds = 2.0 * motion.clock;
        let phase = (half_seconds.floor() * 12.9898).sin() * 43_758.545_3;
        let window = (std::f64::consts::PI * half_seconds).sin().powi(2);
        tau[2] *= 1.0 + 300.0 * (phase - phase.floor()).powi(60) * window;
    };
    let diagnosis = diagnosed(&trio(), &trio(), &injected, Vec::new());
    assert_eq!(not_diagnosed(&diagnosis), "");
}

/// A channel is judged as it was recorded: what known effects leave of it may be noise.
#[test]
fn a_channel_that_known_effects_explain_is_a_torque() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        let noise = (motion.clock * 23.0).sin() + (motion.clock * 31.7).sin() + (motion.clock * 43.1).sin();
        tau[0] += 90.0 * motion.qd[0].signum() + 12.0 * noise;
    };
    let known = Effect::of(&COULOMB_FRICTION).on("turn".to_owned()).with("level", 90.0);
    let diagnosis = diagnosed(&trio(), &trio(), &injected, vec![known]);
    assert_eq!(not_diagnosed(&diagnosis), "");
}

/// A body has nearly as many parameters as all links of an arm of three joints, so that none is surely named beside wrong ones.
#[test]
fn no_size_of_a_payload_is_promised_on_a_short_arm_whose_links_are_wrong() {
    let mut believed = trio();
    for (link, factor) in [1.08, 0.92, 1.1].into_iter().enumerate() {
        believed = believed.with_scaled_link(link, factor);
    }
    let injected = |motion: &mut Motion, tau: &mut [f64]| baseline_friction(motion, tau);
    let diagnosis = diagnosed(&believed, &trio(), &injected, Vec::new());
    let entry = diagnosis.report.not_observable.iter().find(|entry| entry.effect == "payload");
    let entry = entry.unwrap_or_else(|| panic!("{:?}", diagnosis.report.not_observable));
    assert!(entry.would_be_seen_above.is_empty(), "{entry:?}");
}
