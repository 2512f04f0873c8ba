//! Friction and a rotor inertia on one joint: the exported effects are the fitted ones, and with them as known effects
//! nothing is found.

use crate::support::{
    ELBOW, Injected, Motion, SHOULDER, delayed_on, exports_what_it_reports, inputs, named, recorded, regular,
    sentences, start, trio,
};
use arm::Arm;
use diagnosis::{Diagnosis, Options, Verdict, diagnose};
use effects::Effect;
use effects::drive::ROTOR_INERTIA;
use recording::RegularRecording;

/// The rotor inertias of the true arm (kg m²).
const ROTORS: [f64; 3] = [0.0, 0.9, 0.25];

fn driven() -> Arm {
    trio().with_rotor_inertias(&ROTORS)
}

/// The rotors of [`ROTORS`], as known effects.
fn rotors() -> Vec<Effect> {
    let arm = trio();
    let on = |joint: usize| {
        let name = &arm.joints()[joint].name;
        Effect::of(&ROTOR_INERTIA).on(name).with("inertia", ROTORS[joint])
    };
    vec![on(SHOULDER), on(ELBOW)]
}

/// The seconds from the start of a recording to that of the next: recordings of 16 s follow each other closely, as a drive that
/// warms up needs.
const APART: f64 = 20.0;

/// Diagnoses the arm with the `known` effects on four recordings, one of them held out, of the driven arm with the torques
/// `injected`.
fn diagnosed(injected: Injected<'_>, known: Vec<Effect>) -> Diagnosis {
    let one = |variant: usize| -> RegularRecording {
        let later = APART * variant as f64 - start(variant);
        let at = |motion: &mut Motion, tau: &mut [f64]| {
            motion.clock += later;
            injected(motion, tau);
        };
        let mut recording = recorded(&driven(), variant, 16.0, &at);
        recording.time.iter_mut().for_each(|time| *time += later);
        regular(&recording)
    };
    let recordings: Vec<RegularRecording> = (0..4).map(one).collect();
    let options = Options { known, ..Options::default() };
    diagnose(&trio(), &inputs(&recordings), &options, &|_| {}).expect("it can be diagnosed")
}

/// Friction with a level on the shoulder, beside viscous friction, as a function of the speed, the load of the gear and the clock.
fn friction(level: impl Fn(f64, f64, f64) -> f64) -> impl Fn(&mut Motion, &mut [f64]) {
    move |motion, tau| {
        let speed = motion.qd[SHOULDER];
        // The gear moves the links. The motor itself accelerates the rotor.
        let load = tau[SHOULDER] - ROTORS[SHOULDER] * motion.qdd[SHOULDER];
        tau[SHOULDER] += level(speed, load, motion.clock) * speed.signum() + 0.4 * speed;
        tau[ELBOW] += 0.3 * motion.qd[ELBOW].signum();
    }
}

/// The known effects and those of a diagnosis.
fn all(known: &[Effect], found: &Diagnosis) -> Vec<Effect> {
    known.iter().chain(&found.effects).cloned().collect()
}

/// Checks that `effect` is found on the shoulder with its main size, whether the rotors are known or found. In both cases,
/// the exported effects have the reported error, and with them as known effects nothing is found.
fn check(injected: Injected<'_>, effect: &str, (parameter, truth): (&str, f64)) {
    for known in [Vec::new(), rotors()] {
        let diagnosis = diagnosed(injected, known.clone());
        let said = sentences(&diagnosis);
        let report = &diagnosis.report;
        assert_eq!(report.verdict, Verdict::Explained, "{said:?} {:?}", report.unexplained);
        let is_it =
            |finding: &&diagnosis::Finding| finding.effect == effect && finding.joint.as_deref() == Some("shoulder");
        let finding = report.findings.iter().find(is_it).unwrap_or_else(|| panic!("{said:?}"));
        let found = finding.parameters[parameter].value;
        assert!((found / truth - 1.0).abs() < 0.1, "{parameter}: {found} instead of {truth}");
        let finds_rotors = report.findings.iter().any(|finding| finding.effect == "rotor_inertia");
        assert_eq!(finds_rotors, known.is_empty(), "{said:?}");

        let again = diagnosed(injected, all(&known, &diagnosis));
        assert!(again.report.findings.is_empty(), "known: {:?}", sentences(&again));
        assert_eq!(again.report.verdict, Verdict::NoMismatch, "{:?}", again.report.unexplained);
        exports_what_it_reports(&diagnosis, &again, 0.2);
    }
}

#[test]
fn coulomb_friction() {
    let injected = friction(|_, _, _| 2.0);
    check(&injected, "coulomb_friction", ("level", 2.0));
}

#[test]
fn friction_asymmetry() {
    let injected = friction(|speed, _, _| if speed > 0.0 { 3.0 } else { 1.5 });
    check(&injected, "friction_asymmetry", ("positive", 3.0));
}

#[test]
fn stribeck_friction() {
    let injected = friction(|speed, _, _| 1.0 + 4.0 * (-(speed / 0.12).powi(2)).exp());
    check(&injected, "stribeck_friction", ("coulomb", 1.0));
}

#[test]
fn load_dependent_friction() {
    let injected = friction(|_, load, _| 0.5 + 0.2 * load.abs());
    check(&injected, "load_dependent_friction", ("gain", 0.2));
}

#[test]
fn thermal_drift() {
    let injected = friction(|_, _, clock| 2.0 + 2.4 * (-clock / 25.0).exp());
    check(&injected, "thermal_drift", ("coulomb", 2.0));
}

/// The links behind the elbow need a hundredth of its torque, and its drive all the rest.
#[test]
fn a_delay_shows_in_the_torque_of_a_drive_that_the_urdf_does_not_contain() {
    let diagnosis = crate::support::diagnosed(&trio(), &trio(), &delayed_on(ELBOW, 0.009, 20.0), Vec::new());
    assert_eq!(
        named(&diagnosis),
        [("rotor_inertia", Some("elbow")), ("actuation_delay", Some("elbow"))],
        "{:?}",
        sentences(&diagnosis)
    );
    let delay = diagnosis.report.findings.iter().find_map(|finding| finding.parameters.get("delay"));
    let delay = delay.expect("it is named").value;
    assert!((delay / 0.009 - 1.0).abs() < 0.15, "{delay}");
}

/// What a changed torque constant multiplies is known only when it has been found; until then, the friction that is left seems to fall
/// with time.
#[test]
fn a_torque_constant_that_changes_leaves_no_drift() {
    for (factor, level) in [(0.6, 1.0), (0.75, 0.3)] {
        let injected = |motion: &mut Motion, tau: &mut [f64]| {
            for joint in 0..3 {
                tau[joint] += level * motion.qd[joint].signum() + 0.3 * motion.qd[joint];
            }
            if motion.clock >= 24.0 {
                tau[ELBOW] *= factor;
            }
        };
        let found = diagnosed(&injected, rotors());
        assert_eq!(named(&found), [("torque_scale", Some("elbow"))], "{:?}", sentences(&found));
    }
}
