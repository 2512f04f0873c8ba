//! Known effects: what they hold at rest, what a torque constant multiplies, and what is less than known.

use crate::support::{
    ELBOW, Motion, SHOULDER, baseline_friction, diagnosed, effects_on, motion, named, sentences, trio,
};
use arm::{Arm, Inertia, Matrix3, Vector3, Workspace};
use diagnosis::{Diagnosis, Verdict};
use effects::Effect;
use effects::friction::{COULOMB_FRICTION, VISCOUS_FRICTION};
use effects::joint::SPRING;

/// The friction of [`baseline_friction`], and a spring on the shoulder.
fn known() -> Vec<Effect> {
    let on = |joint: &str| {
        let coulomb = Effect::of(&COULOMB_FRICTION).on(joint).with("level", 0.6);
        let viscous = Effect::of(&VISCOUS_FRICTION).on(joint).with("coefficient", 0.4);
        [coulomb, viscous]
    };
    let spring = Effect::of(&SPRING).on("shoulder").with("stiffness", 8.0).with("rest", 0.2);
    ["turn", "shoulder", "elbow"].into_iter().flat_map(on).chain([spring]).collect()
}

fn with_spring(motion: &Motion, tau: &mut [f64]) {
    baseline_friction(motion, tau);
    tau[SHOULDER] += 8.0 * (motion.q[SHOULDER] - 0.2);
}

/// The time of a motion that slows down from 4 s on, rests from 4.5 to 6.5 s, and has its speed again from 7 s on, with its first and second
/// derivatives.
fn slowed(time: f64) -> [f64; 3] {
    let blend = |u: f64| [0.5 * (u.powi(3) - 0.5 * u.powi(4)), 3.0 * u * u - 2.0 * u.powi(3), 12.0 * (u - u * u)];
    match time {
        ..4.0 => [time, 1.0, 0.0],
        4.0..4.5 => {
            let u = 2.0 * (time - 4.0);
            let [place, rate, change] = blend(u);
            [4.0 + 0.5 * u - place, 1.0 - rate, -change]
        }
        4.5..6.5 => [4.25, 0.0, 0.0],
        6.5..7.0 => {
            let [place, rate, change] = blend(2.0 * (time - 6.5));
            [4.25 + place, rate, change]
        }
        _ => [time - 2.5, 1.0, 0.0],
    }
}

/// The shoulder rests for some seconds, and its dry friction holds a part of its weight. Friction that is known holds as much as
/// friction that is found.
#[test]
fn known_friction_holds_a_joint_at_rest() {
    let arm = trio();
    let machine = |now: &mut Motion, tau: &mut [f64]| {
        let is_this = |&variant: &usize| motion(3, now.time, variant).q == now.q;
        let variant = (0..3).find(is_this).expect("it is one of the three");
        let [time, rate, change] = slowed(now.time);
        let then = motion(3, time, variant);
        now.q[SHOULDER] = then.q[SHOULDER];
        now.qd[SHOULDER] = if rate == 0.0 { 0.0 } else { rate * then.qd[SHOULDER] };
        now.qdd[SHOULDER] = rate * rate * then.qdd[SHOULDER] + change * then.qd[SHOULDER];
        arm.inverse_dynamics(&mut Workspace::new(&arm), &now.q, &now.qd, &now.qdd, tau);
        with_spring(now, tau);
        if rate == 0.0 {
            // The sign of zero is that of a positive number, so that friction at rest would be 0.6 N m.
            tau[SHOULDER] -= 0.1;
        }
    };
    let diagnosis = diagnosed(&arm, &arm, &machine, known());
    let resting = diagnosis.report.fit["shoulder"].held_out_nrmse_resting;
    assert!(resting.is_some_and(|error| error < 0.01), "{resting:?}");
    let notes: Vec<&String> = diagnosis.remarks.iter().filter(|note| note.contains("a brake")).collect();
    assert!(notes.is_empty(), "{notes:?}");
}

/// A torque constant that changed multiplies the torques of known effects as well: none of them returns as a new one.
#[test]
fn a_torque_scale_multiplies_known_effects() {
    let arm = trio();
    let machine = |motion: &mut Motion, tau: &mut [f64]| {
        with_spring(motion, tau);
        tau[SHOULDER] *= 1.2;
    };
    let diagnosis = diagnosed(&arm, &arm, &machine, known());
    assert_eq!(named(&diagnosis), [("torque_scale", Some("shoulder"))], "{:?}", sentences(&diagnosis));
    assert_eq!(effects_on(&diagnosis, "shoulder"), ["torque_scale"]);
    let factor = diagnosis.report.findings[0].parameters["factor"].value;
    assert!((factor - 1.2).abs() < 0.01, "{factor}");
}

/// Friction that fell since it was known is no effect of the catalogue, and the recordings are not called explained.
#[test]
fn less_friction_than_known_is_unexplained() {
    let arm = trio();
    let machine = |motion: &mut Motion, tau: &mut [f64]| {
        with_spring(motion, tau);
        tau[ELBOW] -= 0.4 * motion.qd[ELBOW].signum();
    };
    let diagnosis = diagnosed(&arm, &arm, &machine, known());
    assert_eq!(diagnosis.report.verdict, Verdict::Unexplained, "{:?}", sentences(&diagnosis));
    let open: Vec<&str> = diagnosis.report.unexplained.iter().map(|open| &*open.joint).collect();
    assert_eq!(open, ["elbow"]);
    let next = &diagnosis.report.unexplained[0].next;
    assert!(next.contains("without the known effects of elbow"), "{next}");
}

/// The robot's torques as its controller reports them: without those against gravity.
fn without_gravity(model: &Arm, robot: &Arm) -> Diagnosis {
    let arm = robot.clone();
    let machine = move |motion: &mut Motion, tau: &mut [f64]| {
        let mut weight = vec![0.0; 3];
        arm.gravity_torque(&mut Workspace::new(&arm), &motion.q, &mut weight);
        baseline_friction(motion, tau);
        tau.iter_mut().zip(weight).for_each(|(tau, weight)| *tau -= weight);
    };
    diagnosed(model, robot, &machine, Vec::new())
}

/// Torques without gravity are no reason to doubt the masses of all links. The vertical axis, which gravity does not load, is diagnosed.
#[test]
fn torques_without_gravity_are_recognised() {
    let payload = Inertia { mass: 0.5, com: Vector3::new(0.0, 0.0, 0.1), tensor: Matrix3::identity() * 1e-3 };
    for robot in [trio(), trio().with_payload(&payload)] {
        let diagnosis = without_gravity(&trio(), &robot);
        let [not_diagnosed] = &diagnosis.report.not_diagnosed[..] else {
            panic!("{:?}", diagnosis.report.not_diagnosed);
        };
        assert_eq!(not_diagnosed.joints, ["shoulder", "elbow"]);
        assert!(not_diagnosed.because.contains("contain no gravity"));
        let loaded = ["shoulder", "elbow"].map(|joint| effects_on(&diagnosis, joint));
        assert!(loaded.iter().all(Vec::is_empty), "{:?}", sentences(&diagnosis));
        assert!(effects_on(&diagnosis, "turn").contains(&COULOMB_FRICTION.name));
    }
    // On a base that is not level, gravity loads the column, too, if only a little.
    let slope = trio().with_gravity(Vector3::new(0.3, 0.0, -9.8));
    let diagnosis = without_gravity(&slope, &slope);
    let not_diagnosed: Vec<_> = diagnosis.report.not_diagnosed.iter().map(|group| &group.joints[..]).collect();
    assert_eq!(not_diagnosed, [["turn", "shoulder", "elbow"]]);
    assert_eq!(diagnosis.report.verdict, Verdict::NotEnoughData);
    // A base that was mounted on a wall has gravity in another direction.
    let wall = trio().with_gravity(Vector3::new(9.81, 0.0, 0.0));
    let diagnosis = diagnosed(&trio(), &wall, &|motion, tau| baseline_friction(motion, tau), Vec::new());
    assert_eq!(diagnosis.report.not_diagnosed, []);
}
