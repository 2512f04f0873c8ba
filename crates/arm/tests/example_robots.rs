//! The 69 URDFs of the PyPI package example-robot-data load, or say why not. They are not part of the repository.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use arm::{Arm, ChainOptions, Workspace};

/// The folder of the unpacked package.
const VARIABLE: &str = "EXAMPLE_ROBOT_DATA";

/// The robots that load as they are, with their number of joints.
const PLAIN: [(&str, usize); 23] = [
    ("asr_twodof_description/urdf/TwoDofs.urdf", 2),
    ("borinot_description/urdf/borinot_flying_arm_2.urdf", 2),
    ("double_pendulum_description/urdf/double_pendulum.urdf", 2),
    ("double_pendulum_description/urdf/double_pendulum_continuous.urdf", 2),
    ("double_pendulum_description/urdf/double_pendulum_simple.urdf", 2),
    ("finger_edu_description/robots/finger_edu.urdf", 3),
    ("hextilt_description/urdf/hextilt_flying_arm_5.urdf", 5),
    ("kinova_description/robots/kinova.urdf", 6),
    ("panda_description/urdf/panda.urdf", 7),
    ("panda_description/urdf/panda_collision.urdf", 7),
    ("so_arm_description/urdf/so100.urdf", 5),
    ("so_arm_description/urdf/so101.urdf", 5),
    ("talos_data/robots/talos_left_arm.urdf", 6),
    ("ur_description/urdf/ur10_joint_limited_robot.urdf", 6),
    ("ur_description/urdf/ur10_robot.urdf", 6),
    ("ur_description/urdf/ur3_gripper.urdf", 6),
    ("ur_description/urdf/ur3_joint_limited_robot.urdf", 6),
    ("ur_description/urdf/ur3_robot.urdf", 6),
    ("ur_description/urdf/ur5_gripper.urdf", 6),
    ("ur_description/urdf/ur5_joint_limited_robot.urdf", 6),
    ("ur_description/urdf/ur5_robot.urdf", 6),
    ("xarm_description/urdf/xarm7.urdf", 7),
    ("z1_description/urdf/z1.urdf", 6),
];

/// The robots with an arm among other chains: base and tip of the arm, and its number of joints. The error for each
/// robot proposes these flags.
const NAMED: [(&str, &str, &str, usize); 27] = [
    ("alex_description/urdf/alex_nub_hands.urdf", "Torso", "LeftWristRollLink", 6),
    ("alex_description/urdf/alex_psyonic_hands.urdf", "Torso", "LeftGripperYawLink", 7),
    ("alex_description/urdf/alex_sake_hands.urdf", "Torso", "LeftWristRollLink", 6),
    ("anymal_b_simple_description/robots/anymal-kinova.urdf", "base", "j2s6s200_link_6", 6),
    ("b1_description/urdf/b1-z1.urdf", "base", "link06", 6),
    ("baxter_description/urdf/baxter.urdf", "base", "right_wrist", 7),
    ("centauro_description/urdf/centauro.urdf", "pelvis", "wheel_1", 6),
    ("g1_description/urdf/g1_29dof_rev_1_0.urdf", "torso_link", "left_wrist_yaw_link", 7),
    ("g1_description/urdf/g1_29dof_with_hand_rev_1_0.urdf", "torso_link", "left_wrist_yaw_link", 7),
    ("human_description/robots/human.urdf", "middle_thorax", "left_hand", 8),
    ("icub_description/robots/icub.urdf", "chest", "l_hand", 7),
    ("icub_description/robots/icub_reduced.urdf", "chest", "l_hand", 7),
    ("pr2_description/urdf/pr2.urdf", "torso_lift_link", "r_wrist_roll_link", 7),
    ("romeo_description/urdf/romeo.urdf", "torso", "LFinger11Link", 8),
    ("romeo_description/urdf/romeo_laas_small.urdf", "torso", "l_wrist", 7),
    ("romeo_description/urdf/romeo_small.urdf", "torso", "l_wrist", 7),
    ("simple_humanoid_description/urdf/simple_humanoid.urdf", "torso", "r_wrist", 7),
    ("simple_humanoid_description/urdf/simple_humanoid_classical.urdf", "torso", "r_wrist", 7),
    ("talos_data/robots/talos_full_v2.urdf", "torso_2_link", "arm_left_7_link", 7),
    ("talos_data/robots/talos_full_v2_box.urdf", "torso_2_link", "arm_left_7_link", 7),
    ("talos_data/robots/talos_reduced.urdf", "torso_2_link", "arm_left_7_link", 7),
    ("talos_data/robots/talos_reduced_box.urdf", "torso_2_link", "arm_left_7_link", 7),
    ("talos_data/robots/talos_reduced_corrected.urdf", "torso_2_link", "arm_left_7_link", 7),
    ("tiago_description/robots/tiago.urdf", "torso_lift_link", "arm_7_link", 7),
    ("tiago_description/robots/tiago_dual.urdf", "torso_lift_link", "arm_left_7_link", 7),
    ("tiago_description/robots/tiago_no_hand.urdf", "torso_lift_link", "arm_7_link", 7),
    ("tiago_pro_description/robots/tiago_pro.urdf", "torso_lift_link", "arm_left_7_link", 7),
];

/// The robots without an arm, with a part of the error.
const REFUSED: [(&str, &str); 19] = [
    ("a1_description/urdf/a1.urdf", "with 4 ends"),
    ("alexander_description/urdf/alexander_v1.lowerBodyOnly.urdf", "with 3 ends"),
    ("allegro_hand_description/urdf/allegro_left_hand.urdf", "with 4 ends"),
    ("allegro_hand_description/urdf/allegro_right_hand.urdf", "with 4 ends"),
    ("anymal_b_simple_description/robots/anymal.urdf", "with 4 ends"),
    ("anymal_c_simple_description/urdf/anymal.urdf", "with 4 ends"),
    ("b1_description/urdf/b1.urdf", "with 4 ends"),
    ("bolt_description/robots/bolt.urdf", "with 2 ends"),
    ("go1_description/urdf/go1.urdf", "with 4 ends"),
    ("go2_description/urdf/go2.urdf", "with 4 ends"),
    ("hector_description/robots/quadrotor_base.urdf", "no joint that moves"),
    ("hyq_description/robots/hyq_no_sensors.urdf", "with 4 ends"),
    ("iris_description/robots/iris.urdf", "with 4 ends"),
    ("iris_description/robots/iris_simple.urdf", "no joint that moves"),
    ("laikago_description/urdf/laikago.urdf", "with 4 ends"),
    ("quadruped_description/urdf/quadruped.urdf", "with 4 ends"),
    ("solo_description/robots/solo.urdf", "with 4 ends"),
    ("solo_description/robots/solo12.urdf", "with 4 ends"),
    ("ur_description/urdf/ur3.urdf", "has no links"),
];

/// The files below `folder`, by their path from the second folder above them.
fn urdfs(folder: &Path, found: &mut BTreeMap<String, PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            urdfs(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "urdf") {
            let parts: Vec<_> = path.iter().map(|part| part.to_string_lossy()).collect();
            let key = parts[parts.len() - 3..].join("/");
            assert!(found.insert(key.clone(), path).is_none(), "{key} is there twice");
        }
    }
}

fn package() -> Option<PathBuf> {
    let given = std::env::var_os(VARIABLE).map(PathBuf::from);
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/example-robot-data");
    given.or_else(|| shared.is_dir().then_some(shared))
}

#[test]
#[ignore = "needs the PyPI package example-robot-data 6.0.0, unpacked, with EXAMPLE_ROBOT_DATA as its folder"]
fn all_example_robots_load_or_say_why_not() {
    let folder = package().unwrap_or_else(|| {
        panic!(
            "{VARIABLE} and ../shared/example-robot-data do not exist: run tests/packages, which installs the package"
        )
    });
    let mut found = BTreeMap::new();
    urdfs(&folder, &mut found);
    assert_eq!(found.len(), PLAIN.len() + NAMED.len() + REFUSED.len(), "in {}", folder.display());
    let load = |key: &str, options: &ChainOptions| {
        let path = found.get(key).unwrap_or_else(|| panic!("{key} is missing"));
        let text = std::fs::read_to_string(path).expect("it can be read");
        Arm::from_urdf_chain(&text, path, options).map_err(|error| error.to_string())
    };
    let plain = ChainOptions::default();
    for (key, joints) in PLAIN {
        let arm = load(key, &plain).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(arm.dof(), joints, "{key}");
        check_torques(&arm);
    }
    for (key, base, tip, joints) in NAMED {
        let error = load(key, &plain).expect_err(key);
        let flags = format!("--base {base} --tip {tip} ({joints} joints: ");
        assert!(error.contains(&flags), "{flags} is not in {error}");
        let options = ChainOptions { base: Some(base.into()), tip: Some(tip.into()), ..ChainOptions::default() };
        let arm = load(key, &options).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((arm.dof(), arm.base_link()), (joints, base), "{key}");
        check_torques(&arm);
    }
    for (key, reason) in REFUSED {
        let error = load(key, &plain).expect_err(key);
        assert!(error.contains(reason), "{error}");
    }
}

/// The torque of a motion is finite, and the power of gravity is that of the potential energy's change.
fn check_torques(arm: &Arm) {
    let q: Vec<f64> = (0..arm.dof()).map(|joint| 0.3 + 0.1 * joint as f64).collect();
    let mut workspace = Workspace::new(arm);
    let mut tau = vec![0.0; arm.dof()];
    arm.gravity_torque(&mut workspace, &q, &mut tau);
    let step = 1e-6;
    for joint in 0..arm.dof() {
        let mut at = |offset: f64| {
            let mut moved = q.clone();
            moved[joint] += offset;
            arm.potential_energy(&mut workspace, &moved)
        };
        let slope = (at(step) - at(-step)) / (2.0 * step);
        assert!((slope - tau[joint]).abs() < 1e-5 * (1.0 + slope.abs()), "{}: {slope}, {}", arm.name(), tau[joint]);
    }
}
