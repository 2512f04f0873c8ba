//! The evidence for a way to read recordings.

use crate::support::{ELBOW, Motion, SHOULDER, TRIO, baseline_friction, inputs, recorded, regular, trio};
use arm::{Arm, Inertia, Matrix3, Vector3, Workspace};
use diagnosis::{Agreement, Input, agreement};
use recording::RegularRecording;

/// A recording of the arm with dry and viscous friction.
fn with_friction() -> RegularRecording {
    let robot = trio();
    let recording = recorded(&robot, 0, 16.0, &|motion, tau| {
        for (tau, qd) in tau.iter_mut().zip(&motion.qd) {
            *tau += 0.8 * (qd / 0.01).tanh() + 0.5 * qd;
        }
    });
    regular(&recording)
}

fn of(arm: &Arm, recording: &RegularRecording) -> Agreement {
    let input = Input { name: "a.csv", recording, held_out: false, before: false };
    agreement(arm, &[input], &[], None).expect("it can be fitted")
}

#[test]
fn a_correct_reading_has_far_more_evidence_than_a_wrong_one() {
    let recording = with_friction();
    let right = of(&trio(), &recording);
    assert!(right.unexplained.iter().all(|share| *share < 0.01), "{right:?}");
    let sum: f64 = right.misfit_of.iter().sum();
    assert!(sum <= right.misfit, "the background has no cost: {right:?}");
    let mut inverted = recording.clone();
    inverted.tau.iter_mut().flatten().for_each(|tau| *tau *= -1.0);
    let mut exchanged = recording.clone();
    exchanged.tau.swap(SHOULDER, ELBOW);
    let mut shifted = recording.clone();
    shifted.q[ELBOW].iter_mut().for_each(|q| *q += 1.6);
    for wrong in [inverted, exchanged, shifted] {
        let wrong = of(&trio(), &wrong);
        assert!(wrong.misfit - right.misfit > 100.0, "{wrong:?}, not {right:?}");
    }
}

/// Masses that differ from the URDF cost little, compared with a wrong reading: the URDF is wrong everywhere.
#[test]
fn other_masses_cost_less_than_another_sign() {
    let recording = with_friction();
    let heavier = TRIO.replace("<mass value=\"", "<mass value=\"1");
    assert_ne!(heavier, TRIO);
    let heavier = Arm::from_urdf_text(&heavier, "heavier.urdf").expect("it is an arm");
    let scaled = of(&heavier, &recording);
    let mut inverted = recording.clone();
    inverted.tau[ELBOW].iter_mut().for_each(|tau| *tau *= -1.0);
    let inverted = of(&trio(), &inverted);
    assert!(scaled.unexplained.iter().all(|share| *share < 0.05), "{scaled:?}");
    assert!(scaled.misfit < inverted.misfit - 100.0, "{scaled:?}, {inverted:?}");
}

/// A load far heavier than the last link, in one of two recordings, is no wrong reading.
#[test]
fn a_load_in_one_recording_is_explained() {
    let robot = trio();
    let loaded = robot.clone().with_payload(&Inertia {
        mass: 6.0,
        com: Vector3::new(0.05, 0.02, 0.1),
        tensor: Matrix3::identity() * 6e-3,
    });
    let recorded = |variant, of: &Arm| {
        let injected = |motion: &mut Motion, tau: &mut [f64]| {
            of.inverse_dynamics(&mut Workspace::new(of), &motion.q, &motion.qd, &motion.qdd, tau);
            baseline_friction(motion, tau);
        };
        regular(&recorded(&robot, variant, 16.0, &injected))
    };
    let recordings = [recorded(0, &robot), recorded(1, &loaded)];
    let found = agreement(&robot, &inputs(&recordings), &[], None).expect("it can be fitted");
    assert!(found.unexplained.iter().all(|share| *share < 0.01), "{found:?}");
}

/// A torque with another sign in one of two recordings is not the torque of the model in both. It is compared nevertheless, because
/// the correction is weighed on the same joints as the recordings as they are.
#[test]
fn a_joint_whose_sign_differs_between_recordings_is_compared() {
    let recordings = [0, 1].map(|variant| {
        let mut recording = recorded(&trio(), variant, 16.0, &|_, _| ());
        if variant == 1 {
            recording.tau[ELBOW].iter_mut().for_each(|tau| *tau *= -1.0);
        }
        regular(&recording)
    });
    let found = agreement(&trio(), &inputs(&recordings), &[], None).expect("it can be fitted");
    assert!(found.unexplained[ELBOW] > 0.5, "{found:?}");
    assert!(found.unexplained[SHOULDER] < 0.05, "{found:?}");
}
