//! What changed since the recordings from before.

use crate::support::{ELBOW, Injected, Motion, SHOULDER, baseline_friction, regular, sentences, start, trio};
use arm::{Arm, Inertia, Workspace};
use diagnosis::{Change, Diagnosis, Finding, Input, Options, diagnose};
use effects::arm::PAYLOAD;
use effects::friction::COULOMB_FRICTION;
use recording::RegularRecording;

/// The diagnosis of four recordings, two of which are from before. The last is held out.
fn diagnosed(recordings: &[RegularRecording]) -> Diagnosis {
    let input = |(number, recording)| Input {
        name: ["a", "b", "c", "d"][number],
        recording,
        held_out: number == 3,
        before: number < 2,
    };
    let inputs: Vec<Input<'_>> = recordings.iter().enumerate().map(input).collect();
    diagnose(&trio(), &inputs, &Options::default(), &|_| {}).expect("it can be diagnosed")
}

/// The diagnosis of recordings with the effects `injected`.
pub fn with(injected: Injected<'_>) -> Diagnosis {
    let recorded = |variant| regular(&crate::support::recorded(&trio(), variant, 16.0, injected));
    diagnosed(&(0..4).map(recorded).collect::<Vec<_>>())
}

/// Whether a motion is after the change.
pub fn is_after(motion: &Motion) -> bool {
    motion.clock >= start(2)
}

/// The findings that changed, as effect, joint and change.
fn changes(diagnosis: &Diagnosis) -> Vec<(&Finding, &str, Option<&str>, Change)> {
    let list = diagnosis.report.findings.iter();
    let changed = list.filter_map(|f| Some((f, f.effect, f.joint.as_deref(), f.change?)));
    let changed: Vec<_> = changed.collect();
    let told = diagnosis.report.changed.as_ref().map_or(0, Vec::len);
    assert_eq!(told == 0, changed.is_empty(), "{:?}", sentences(diagnosis));
    assert!(told <= changed.len(), "{:?}", sentences(diagnosis));
    changed
}

/// The sum of the levels of Coulomb friction on a joint that the corrected model has (N m).
fn level(diagnosis: &Diagnosis, joint: &str) -> f64 {
    let of_joint = |effect: &&effects::Effect| effect.is(&COULOMB_FRICTION) && effect.joint() == Some(joint);
    let levels = diagnosis.effects.iter().filter(of_joint).map(|effect| {
        assert_eq!(effect.onset(), None, "today it always acts");
        effect.number("level")
    });
    levels.sum()
}

/// Friction that grew is in addition to that from before, and friction that fell is found as well. The corrected model has
/// that of today.
#[test]
fn friction_that_grew_or_fell_is_found() {
    for (before, after, change) in [(0.5, 1.1, Change::Increased), (1.3, 0.5, Change::Reduced)] {
        let diagnosis = with(&|motion, tau| {
            baseline_friction(motion, tau);
            let level = if is_after(motion) { after } else { before };
            tau[ELBOW] += level * motion.qd[ELBOW].signum();
        });
        let [(finding, effect, joint, found)] = changes(&diagnosis)[..] else { panic!("{:?}", sentences(&diagnosis)) };
        assert_eq!((effect, joint, found), ("coulomb_friction", Some("elbow"), change));
        let size = finding.parameters["level"].value;
        assert!((size / f64::abs(after - before) - 1.0).abs() < 0.05, "{size}");
        // Baseline friction has a level of its own.
        let today = level(&diagnosis, "elbow") - 0.6;
        assert!((today / after - 1.0).abs() < 0.05, "{today} instead of {after}");
    }
}

/// A constant torque that went away is in the recordings from before only. Half of it was taken for one of all recordings, which most
/// sensors have.
#[test]
fn a_constant_torque_that_went_away_is_found() {
    for (sign, change) in [(1.0, Change::Added), (-1.0, Change::Removed)] {
        let diagnosis = with(&|motion, tau| {
            baseline_friction(motion, tau);
            if is_after(motion) == (sign > 0.0) {
                tau[ELBOW] += 2.0;
            }
        });
        let [(finding, effect, joint, found)] = changes(&diagnosis)[..] else { panic!("{:?}", sentences(&diagnosis)) };
        assert_eq!((effect, joint, found), ("torque_offset", Some("elbow"), change));
        let offset = finding.parameters["offset"].value;
        assert!((offset / 2.0 - 1.0).abs() < 0.05, "{offset}");
        let offsets = diagnosis.effects.iter().filter(|effect| effect.name() == "torque_offset");
        let today: f64 = offsets.map(|effect| effect.number("offset")).sum();
        let truth = if sign > 0.0 { 2.0 } else { 0.0 };
        assert!((today - truth).abs() < 0.1, "{today} instead of {truth}");
    }
}

/// One torque constant that changed by less than torque constants are usually wrong: it was wrong by the same amount before. The URDF's
/// masses are wrong as well.
#[test]
fn a_torque_constant_that_changed_a_little_is_found() {
    let robot = [1.06, 0.95, 1.04].into_iter().enumerate();
    let robot = robot.fold(trio(), |arm, (link, factor)| arm.with_scaled_link(link, factor));
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        if is_after(motion) {
            tau[SHOULDER] *= 1.04;
        }
    };
    let recorded = |variant| regular(&crate::support::recorded(&robot, variant, 16.0, &injected));
    let diagnosis = diagnosed(&(0..4).map(recorded).collect::<Vec<_>>());
    let changes = changes(&diagnosis);
    let [(finding, effect, joint, change)] = &changes[..] else {
        panic!("{:?}", sentences(&diagnosis));
    };
    assert_eq!((*effect, *joint, *change), ("torque_scale", Some("shoulder"), Change::Added));
    let factor = finding.parameters["factor"].value;
    assert!((factor / 1.04 - 1.0).abs() < 0.005, "{factor}");
}

/// If friction differs between recordings anyway, the recordings of today do not test what only the earlier ones have.
#[test]
fn friction_that_fell_is_found_although_it_varies() {
    let diagnosis = with(&|motion, tau| {
        let recording = (motion.clock / start(1)).floor() as usize;
        let varied = [0.9, 1.08, 0.95, 1.05][recording.min(3)];
        for joint in 0..3 {
            let level = if joint == ELBOW && !is_after(motion) { 2.0 } else { 0.7 };
            tau[joint] += varied * (level * motion.qd[joint].signum() + 0.4 * motion.qd[joint]);
        }
    });
    let changes = changes(&diagnosis);
    let is_it = |&&(_, effect, joint, change): &&(&Finding, &str, Option<&str>, Change)| {
        (effect, joint, change) == ("coulomb_friction", Some("elbow"), Change::Reduced)
    };
    let found = changes.iter().find(is_it).unwrap_or_else(|| panic!("{:?}", sentences(&diagnosis)));
    let size = found.0.parameters["level"].value;
    assert!((size / 1.28 - 1.0).abs() < 0.2, "{size}");
}

/// Where the recorder writes torques in another unit, the torque constants of all joints change. A factor of all masses with more
/// friction resembles them, and the torques at rest resemble a load, but neither is there.
#[test]
fn torque_constants_that_all_changed_are_found() {
    let diagnosis = with(&|motion, tau| {
        for joint in 0..3 {
            tau[joint] += 1.5 * motion.qd[joint].signum() + 0.8 * motion.qd[joint];
        }
        if is_after(motion) {
            tau.iter_mut().for_each(|tau| *tau *= 1.12);
        }
    });
    let changes = changes(&diagnosis);
    assert_eq!(changes.len(), 3, "{:?}", sentences(&diagnosis));
    for (finding, effect, _, change) in changes {
        assert_eq!((effect, change), ("torque_scale", Change::Added));
        let factor = finding.parameters["factor"].value;
        assert!((factor / 1.12 - 1.0).abs() < 0.01, "{factor}");
    }
    assert!(diagnosis.report.different_load.is_none());
}

/// A joint that stands still before cannot be compared.
#[test]
fn a_joint_that_moves_on_one_side_only_is_noted() {
    let diagnosis = with(&|motion, tau| {
        if !is_after(motion) {
            let (q, qd, qdd) = (0.4, 0.0, 0.0);
            (motion.q[ELBOW], motion.qd[ELBOW], motion.qdd[ELBOW]) = (q, qd, qdd);
            let mut workspace = Workspace::new(&trio());
            trio().inverse_dynamics(&mut workspace, &motion.q, &motion.qd, &motion.qdd, tau);
        }
        baseline_friction(motion, tau);
    });
    let expected = "(joints that do not move in the recordings from before: elbow)";
    let is_noted = diagnosis.remarks.iter().any(|remark| remark.ends_with(expected));
    assert!(is_noted, "{:?}", diagnosis.remarks);
}

/// A spring that broke is in the recordings from before only, and the corrected model does not contain it.
#[test]
fn a_spring_that_broke_is_found() {
    let diagnosis = with(&|motion, tau| {
        baseline_friction(motion, tau);
        if !is_after(motion) {
            tau[SHOULDER] += 6.0 * (motion.q[SHOULDER] - 0.2);
        }
    });
    let [(finding, effect, joint, change)] = changes(&diagnosis)[..] else { panic!("{:?}", sentences(&diagnosis)) };
    assert_eq!((effect, joint, change), ("spring", Some("shoulder"), Change::Removed));
    let stiffness = finding.parameters["stiffness"].value;
    assert!((stiffness / 6.0 - 1.0).abs() < 0.05, "{stiffness}");
    assert!(diagnosis.effects.iter().all(|effect| effect.name() != "spring"));
}

/// A load that was taken off may be heavier than the last link. The model without it is right, so that no payload and no link is wrong.
#[test]
fn a_load_that_was_taken_off_is_no_error_of_the_model() {
    let last = trio().joints().last().map_or(0.0, |joint| joint.inertia.mass);
    let mass = 1.5 * last;
    let diagnosis = changed_load(&load(mass), [1.0; 3], 0.0, |motion| !is_after(motion));
    let [(finding, effect, joint, change)] = changes(&diagnosis)[..] else { panic!("{:?}", sentences(&diagnosis)) };
    assert_eq!((effect, joint, change), ("payload", None, Change::Removed));
    let found = finding.parameters["mass"].value;
    assert!((found / mass - 1.0).abs() < 0.02, "{found} instead of {mass}");
    assert!(!finding.since_before && !diagnosis.effects.iter().any(|effect| effect.is(&PAYLOAD)));
    let others = diagnosis.report.findings.iter().filter(|other| other.effect != "payload");
    assert!(others.clone().all(|other| other.effect.ends_with("friction")), "{:?}", sentences(&diagnosis));
}

/// A body of `mass` (kg) on the tool.
fn load(mass: f64) -> Inertia {
    Inertia { mass, com: arm::Vector3::new(0.02, -0.01, 0.08), tensor: arm::Matrix3::identity() * (2e-3 * mass / 1.2) }
}

/// The diagnosis of a robot with `load` in the motions that `is_loaded` selects, whose torques are recorded with these `factors`. Each
/// recording has a `pause` (s).
fn changed_load(load: &Inertia, factors: [f64; 3], pause: f64, is_loaded: impl Fn(&Motion) -> bool) -> Diagnosis {
    let loaded: Arm = trio().with_payload(load);
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        if is_loaded(motion) {
            let mut workspace = Workspace::new(&loaded);
            loaded.inverse_dynamics(&mut workspace, &motion.q, &motion.qd, &motion.qdd, tau);
        }
        baseline_friction(motion, tau);
        for (tau, factor) in tau.iter_mut().zip(factors) {
            *tau *= factor;
        }
    };
    let recording = |variant: usize| {
        let mut recording = crate::support::recorded(&trio(), variant, 16.0, &injected);
        let second_half = recording.time.len() / 2;
        recording.time.iter_mut().skip(second_half).for_each(|time| *time += pause);
        regular(&recording)
    };
    let recordings: Vec<RegularRecording> = (0..4).map(recording).collect();
    diagnosed(&recordings)
}

/// The mass of a payload of 1.2 kg that was added after the recordings from before. Checks that no other change is found.
fn new_payload(factors: [f64; 3], pause: f64) -> diagnosis::Parameter {
    let diagnosis = changed_load(&load(1.2), factors, pause, is_after);
    let [(finding, effect, None, Change::Added)] = changes(&diagnosis)[..] else {
        panic!("{:?}", sentences(&diagnosis))
    };
    assert_eq!((effect, finding.since_before), ("payload", true));
    finding.parameters["mass"]
}

/// Torque constants that are wrong by a few per cent also apply to the torque of a new payload. Therefore no torque scale
/// is found to have changed, and the mass is as uncertain as the constants.
#[test]
fn torque_constants_also_apply_to_a_new_payload() {
    let [low, high] = new_payload([1.05, 0.94, 1.08], 0.0).ci95;
    assert!(low <= 1.2 && 1.2 <= high, "{low} … {high}");
}

/// Pauses in recordings from before also count as time before the change.
#[test]
fn pauses_of_recordings_from_before_are_before_the_change() {
    let mass = new_payload([1.0; 3], 100.0);
    assert!((mass.value / 1.2 - 1.0).abs() < 0.02, "{mass:?}");
}

/// Coulomb friction fell by half on a joint whose friction depends on the load: some friction remains, so that it is less, and not gone.
#[test]
fn friction_of_another_form_remains() {
    let diagnosis = with(&|motion, tau| {
        let load = tau[ELBOW].abs();
        baseline_friction(motion, tau);
        let level = if is_after(motion) { 0.5 } else { 1.3 };
        tau[ELBOW] += (level + 0.25 * load) * motion.qd[ELBOW].signum();
    });
    let on_elbow: Vec<_> =
        changes(&diagnosis).into_iter().map(|(_, effect, joint, change)| (effect, joint, change)).collect();
    assert_eq!(on_elbow, [("coulomb_friction", Some("elbow"), Change::Reduced)], "{:?}", sentences(&diagnosis));
    let today = crate::support::effects_on(&diagnosis, "elbow");
    assert!(today.contains(&"load_dependent_friction"), "{today:?}");
}

/// One recording of each side: the drives' friction differs by 5 % between them, as it does from day to day.
#[test]
fn the_friction_of_another_day_is_no_change() {
    for (part, is_named) in [(0.95, false), (0.6, true)] {
        let machine = |motion: &mut Motion, tau: &mut [f64]| {
            let mut friction = [0.0; 3];
            baseline_friction(motion, &mut friction);
            let today = if is_after(motion) { part } else { 1.0 };
            tau.iter_mut().zip(friction).for_each(|(tau, friction)| *tau += today * friction);
        };
        let recordings: Vec<RegularRecording> =
            [1, 2, 3].map(|variant| regular(&crate::support::recorded(&trio(), variant, 16.0, &machine))).into();
        let input = |(number, recording)| Input {
            name: ["a", "b", "c"][number],
            recording,
            held_out: number == 2,
            before: number == 0,
        };
        let inputs: Vec<Input<'_>> = recordings.iter().enumerate().map(input).collect();
        let diagnosis = diagnose(&trio(), &inputs, &Options::default(), &|_| {}).expect("it can be diagnosed");
        assert_eq!(!changes(&diagnosis).is_empty(), is_named, "{part}: {:?}", sentences(&diagnosis));
    }
}

/// One recording from before and one from after are enough to name a change.
#[test]
fn one_recording_on_each_side_shows_a_change() {
    let injected = |motion: &mut Motion, tau: &mut [f64]| {
        baseline_friction(motion, tau);
        if is_after(motion) {
            tau[ELBOW] += 3.0 * (motion.q[ELBOW] - 0.5);
        }
    };
    let recorded = |variant| regular(&crate::support::recorded(&trio(), variant, 16.0, &injected));
    let recordings = [recorded(0), recorded(2)];
    let input =
        |(number, recording)| Input { name: ["a", "b"][number], recording, held_out: false, before: number == 0 };
    let inputs: Vec<Input<'_>> = recordings.iter().enumerate().map(input).collect();
    let diagnosis = diagnose(&trio(), &inputs, &Options::default(), &|_| {}).expect("it can be diagnosed");
    let [(finding, effect, joint, found)] = changes(&diagnosis)[..] else { panic!("{:?}", sentences(&diagnosis)) };
    assert_eq!((effect, joint, found), ("spring", Some("elbow"), Change::Added));
    let stiffness = finding.parameters["stiffness"].value;
    assert!((stiffness / 3.0 - 1.0).abs() < 0.05, "{stiffness}");
}

/// Friction that falls as the drive warms up in each recording is a slow function of time. It is not the reason for a constant torque of the
/// recordings from after the change.
#[test]
fn a_constant_torque_beside_slow_drifts_is_a_change() {
    let diagnosis = with(&|motion, tau| {
        baseline_friction(motion, tau);
        let drift = 0.1 * (-motion.time / 5.0).exp() + 0.05 * (0.4 * motion.time).sin();
        tau[ELBOW] += drift + if is_after(motion) { 1.0 } else { 0.0 };
    });
    let [(finding, effect, joint, found)] = changes(&diagnosis)[..] else { panic!("{:?}", sentences(&diagnosis)) };
    assert_eq!((effect, joint, found), ("torque_offset", Some("elbow"), Change::Added));
    let offset = finding.parameters["offset"].value;
    assert!((offset - 1.0).abs() < 0.15, "{offset}");
}

/// A ripple that began is a change: a tooth of the gear broke.
#[test]
fn a_ripple_that_began_is_found() {
    let diagnosis = with(&|motion, tau| {
        baseline_friction(motion, tau);
        if is_after(motion) {
            tau[SHOULDER] += 1.5 * (20.0 * motion.q[SHOULDER] + 0.6).sin();
        }
    });
    let [(finding, effect, joint, found)] = changes(&diagnosis)[..] else { panic!("{:?}", sentences(&diagnosis)) };
    assert_eq!((effect, joint, found), ("torque_ripple", Some("shoulder"), Change::Added));
    let amplitude = finding.parameters["amplitude"].value;
    assert!((amplitude / 1.5 - 1.0).abs() < 0.1, "{amplitude}");
}
