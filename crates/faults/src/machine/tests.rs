//! The machine against inverse dynamics, and the influence of each part on it.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use serde_json::json;

use super::*;
use crate::expressed_share::{low_passed, share};
use crate::fault::{EligibleJoints, FAULTS, Fault};
use crate::motion::{LEAD_TICKS, excitation};
use crate::test_robots::{puma, seven_axis};

fn reference(robot: &Robot) -> Reference {
    excitation(robot, 0.0, &mut ChaCha8Rng::seed_from_u64(1))
}

fn run(robot: &Robot, effects: &[Injected], reference: &Reference) -> Run {
    let effects: Vec<&Injected> = effects.iter().collect();
    let machine = Machine::new(robot, &effects, None).expect("the effects fit");
    let run = machine.run(reference, 0.0);
    run.unwrap_or_else(|error| panic!("{effects:?}: {error}"))
}

/// The drives report the torque of the motion by inverse dynamics, to 0.2 % of its standard deviation below 20 Hz:
/// step, hold and loop cause no larger error.
#[test]
fn a_machine_without_faults_needs_the_rigid_torque() {
    for robot in [puma(), seven_axis()] {
        let n = robot.arm().dof();
        let reference = reference(&robot);
        let run = run(&robot, &[], &reference);
        let rigid = Reference::along(&robot.driven(), &run.q);
        let below = |tau: &[f64]| vec![low_passed(tau, n, TICK, LEAD_TICKS).0];
        let error = share(&below(&run.tau), &below(&rigid), false);
        assert!(error < 2e-3, "{}: {error}", robot.name());
    }
}

/// A fault of a clearly detectable size, on axis 4 of the arm with seven axes or on the whole arm.
fn detectable(name: &str) -> Injected {
    let fault = Fault::named(name).expect("there is such a fault");
    let joint = (fault.joints != EligibleJoints::WholeArm).then_some("axis4");
    (fault.example)(Injected::new(name, joint))
}

/// Every effect, in every form, changes the torque, and differently from any other form.
#[test]
fn every_effect_in_every_form_changes_the_torque() {
    let robot = seven_axis();
    let n = robot.arm().dof();
    let reference = reference(&robot).first_seconds(4.0);
    let below = |run: &Run| vec![low_passed(&run.tau, n, TICK, LEAD_TICKS).0];
    for fault in FAULTS {
        let name = fault.name;
        let effect = detectable(name);
        let without = Machine::new(&robot, &[&effect], Some(0)).expect("it fits");
        let without = below(&without.run(&reference, 0.0).expect("it follows"));
        let plain = below(&run(&robot, std::slice::from_ref(&effect), &reference));
        let size = share(&plain, &without, true);
        assert!(size > 0.01, "{name}: {size}");
        for form in fault.forms {
            let formed = match *form {
                "another exponent" => effect.clone().formed(form).with("exponent", 1.0),
                _ => effect.clone().formed(form),
            };
            let formed = below(&run(&robot, &[formed], &reference));
            let (size, other) = (share(&formed, &without, true), share(&formed, &plain, true));
            assert!(size > 0.01 && other > 1e-4, "{name}, {form}: {size} {other}");
        }
    }
}

/// Before the onset of an effect, the machine equals the one without it, bit for bit.
#[test]
fn before_an_onset_two_machines_are_equal() {
    let robot = seven_axis();
    let reference = reference(&robot).first_seconds(2.0);
    let plain = run(&robot, &[], &reference);
    for name in ["payload", "torque_offset", "torque_scale", "actuation_delay", "encoder_offset", "spring"] {
        let mut effect = detectable(name);
        effect.onset = Some(1.0);
        let with = run(&robot, &[effect], &reference);
        let first = plain.tau.iter().zip(&with.tau).position(|(a, b)| a != b);
        let time = reference.time(first.expect("they part") / robot.arm().dof());
        assert!((0.999..1.05).contains(&time), "{name}: {time}");
    }
    // The rotor of a drive whose connection fails moved with its link before.
    let mut gap = detectable("backlash");
    gap.onset = Some(1.0);
    let without = Machine::new(&robot, &[&gap], Some(0)).expect("it fits");
    let without = without.run(&reference, 0.0).expect("it follows");
    let with = run(&robot, &[gap], &reference);
    let first = without.tau.iter().zip(&with.tau).position(|(a, b)| a != b);
    let time = reference.time(first.expect("they part") / robot.arm().dof());
    assert!((0.999..1.05).contains(&time), "{time}");
}

/// Signs and sizes of reported torques at rest: an offset and a scale directly, a contact as −Jᵀ F.
#[test]
fn reported_torques_follow_the_catalogue() {
    let robot = seven_axis();
    let n = robot.arm().dof();
    let mut reference = reference(&robot).first_seconds(2.0);
    for (k, q) in reference.q.iter_mut().enumerate() {
        *q = [0.1, 0.4, -0.2, 0.5, 0.3, -0.4, 0.2][k % n];
    }
    let reference = Reference::new(robot.arm(), 0.0, reference.q);
    // The arm deflects in its position loop: the torque at rest is that of its actual pose.
    let at_rest = |effect: &Injected| -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let run = run(&robot, std::slice::from_ref(effect), &reference);
        let mut plain = vec![0.0; n];
        let last = run.tau.len() - n;
        let arm = robot.arm();
        arm.gravity_torque(&mut Workspace::new(arm), &run.q[last..], &mut plain);
        (run.tau[last..].to_vec(), plain, run.q[last..].to_vec())
    };
    let (found, plain, _) = at_rest(&detectable("torque_offset"));
    assert!((found[3] - plain[3] - 2.0).abs() < 1e-3, "{} {}", found[3], plain[3]);
    let (found, plain, _) = at_rest(&detectable("torque_scale"));
    assert!((found[3] / plain[3] - 1.2).abs() < 1e-3, "{} {}", found[3], plain[3]);
    let contact = Injected::new("external_contact", None)
        .with("start", 0.0)
        .with("duration", 9.0)
        .with("force", json!([3.0, -2.0, 4.0]));
    let (found, plain, q) = at_rest(&contact);
    let mut jacobian = Matrix6xX::zeros(n);
    let arm = robot.arm();
    arm.jacobian(&mut Workspace::new(arm), &q, &arm.tool_frame(), &mut jacobian);
    for j in 0..n {
        let force = jacobian.fixed_view::<3, 1>(3, j).dot(&arm::Vector3::new(3.0, -2.0, 4.0));
        assert!((found[j] - (plain[j] - force)).abs() < 5e-3, "{j}: {} {}", found[j], plain[j] - force);
    }
}

/// Dry friction that differs by direction is equivalent to an offset and dry friction, in motion and at rest.
#[test]
fn asymmetry_and_offset_give_one_recording() {
    let robot = seven_axis();
    let joint = Some(robot.arm().joints()[3].name.as_str());
    let uneven = Injected::new("friction_asymmetry", joint).with("positive", 2.0).with("negative", 1.0);
    let level = Injected::new("coulomb_friction", joint).with("level", 1.5);
    let offset = Injected::new("torque_offset", joint).with("offset", 0.5);
    // In motion, and then at rest.
    let mut reference = reference(&robot).first_seconds(4.0);
    let (n, half) = (robot.arm().dof(), reference.q.len() / 2);
    let held: Vec<f64> = reference.q[half - n..half].to_vec();
    reference.q[half..].iter_mut().enumerate().for_each(|(k, q)| *q = held[k % n]);
    let reference = Reference::new(robot.arm(), 0.0, reference.q);
    // From the start, and from the middle of the motion on.
    for onset in [None, Some(1.0)] {
        let [mut uneven, mut offset] = [uneven.clone(), offset.clone()];
        (uneven.onset, offset.onset) = (onset, onset);
        let pair = [vec![uneven], vec![level.clone(), offset]];
        let [a, b] = pair.map(|effects| run(&robot, &effects, &reference).tau);
        let apart = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-6, "{onset:?}: {apart}");
    }
}

/// A machine that cannot follow its reference is an error.
#[test]
fn a_machine_that_cannot_follow_is_refused() {
    let robot = seven_axis();
    let weak = Injected::new("torque_saturation", Some("axis2")).with("limit", 1.0);
    let machine = Machine::new(&robot, &[&weak], None).expect("it fits");
    let error = machine.run(&reference(&robot).first_seconds(4.0), 0.0).map(|_| ()).expect_err("it is refused");
    assert!(error.to_string().contains("axis"), "{error}");
    let gap = Injected::new("backlash", Some("axis2")).with("halfgap", 0.01);
    let machine = Machine::new(&robot, &[&gap], None).expect("it fits");
    let error = machine.run(&reference(&robot).first_seconds(1.0), 0.0).map(|_| ()).expect_err("it is refused");
    assert!(error.to_string().contains("rotor"), "{error}");
}
