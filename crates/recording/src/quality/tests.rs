//! Quality of recordings whose flaws are known.

use super::*;

/// Three joints on sines of their own, at 250 Hz for 20 s; the velocity is late by 6.5 ms.
fn good() -> Recording {
    let time: Vec<f64> = (0..5000).map(|k| f64::from(k) * 0.004).collect();
    let of = |f: &dyn Fn(f64, f64) -> f64| -> Vec<Vec<f64>> {
        [1.1, 1.7, 2.9].iter().map(|w| time.iter().map(|t| f(*w, *t)).collect()).collect()
    };
    let step = 1e-5;
    Recording {
        joints: ["a", "b", "c"].map(str::to_owned).to_vec(),
        q: of(&|w, t| ((0.8 * (w * t).sin()) / step).round() * step),
        qd: Some(of(&|w, t| 0.8 * w * (w * (t - 0.0065)).cos())),
        tau: of(&|w, t| 20.0 * (w * t).cos() + 0.06 * ((t * 3137.3).sin() * 43_758.547).fract()),
        time,
        ..Recording::default()
    }
}

fn quality(recording: &Recording) -> Quality {
    let (regular, _) = recording.regular().expect("it has a clock");
    Quality::of(recording, &regular)
}

fn kinds(recording: &Recording) -> Vec<(FindingKind, Option<String>)> {
    let findings = quality(recording).findings;
    findings.into_iter().map(|finding| (finding.kind, finding.joint)).collect()
}

const LATE: (FindingKind, Option<String>) = (FindingKind::VelocityLate, None);

#[test]
fn a_good_recording_is_measured() {
    let quality = quality(&good());
    assert_eq!((quality.rows, quality.rate, quality.lost_rows, quality.segments), (5000, 250.0, 0, 1));
    for (joint, w) in quality.joints.iter().zip([1.1, 1.7, 2.9]) {
        assert!((joint.q_step.expect("it is quantised") / 1e-5 - 1.0).abs() < 1e-3);
        assert!((joint.velocity_lag.expect("it moves") - 0.0065).abs() < 2e-4, "{:?}", joint.velocity_lag);
        assert!((joint.velocity_ratio.expect("it moves") - 1.0).abs() < 0.01);
        assert!((joint.speed_max / (0.8 * w) - 1.0).abs() < 0.02);
        assert!(joint.moves && joint.moving_share > 0.9);
        assert!((joint.reversals as f64 - 20.0 * w / std::f64::consts::PI).abs() < 1.5);
        assert!((joint.tau_noise / 0.035 - 1.0).abs() < 0.4, "{}", joint.tau_noise);
        assert_eq!((joint.tau_step, joint.plateaus), (None, [None; 2]));
    }
    let found: Vec<FindingKind> = quality.findings.iter().map(|finding| finding.kind).collect();
    assert_eq!(found, [FindingKind::VelocityLate]);
}

/// The positions and velocities of a robot whose logger's clock is slow agree on another rate.
#[test]
fn a_wrong_clock_is_told_apart_from_a_unit() {
    let mut recording = good();
    recording.time.iter_mut().for_each(|time| *time *= 0.9);
    assert_eq!(kinds(&recording), [(FindingKind::ClockRate, None), LATE]);
    let text = &quality(&recording).findings[0].text;
    assert!(text.contains("the time stamps are probably 0.9"), "{text}");
}

#[test]
fn flaws_are_found_on_their_joint() {
    let b = || Some("b".to_owned());
    let flawed = |flaw: &dyn Fn(&mut Recording)| {
        let mut recording = good();
        flaw(&mut recording);
        kinds(&recording)
    };
    let scale = |values: &mut Vec<f64>, factor: f64| values.iter_mut().for_each(|value| *value *= factor);
    let qd = |recording: &mut Recording, factor: f64| {
        scale(&mut recording.qd.as_mut().expect("it is there")[1], factor);
    };
    assert_eq!(flawed(&|r| qd(r, -1.0)), [(FindingKind::VelocitySign, b()), LATE]);
    assert_eq!(flawed(&|r| qd(r, 57.3)), [(FindingKind::VelocityUnit, b()), LATE]);
    assert_eq!(flawed(&|r| scale(&mut r.q[1], 57.3)), [(FindingKind::VelocityUnit, b()), LATE]);
    let swap = |r: &mut Recording| r.qd.as_mut().expect("it is there").swap(1, 2);
    let c = Some("c".to_owned());
    let expected = [(FindingKind::VelocitySwapped, b()), (FindingKind::VelocitySwapped, c)];
    assert_eq!(flawed(&swap)[..2], expected);
    let clip = |r: &mut Recording| r.tau[1].iter_mut().for_each(|tau| *tau = tau.clamp(-15.0, 30.0));
    assert_eq!(flawed(&clip), [(FindingKind::Saturation, b()), LATE]);
    let no_velocity = |r: &mut Recording| {
        r.qd = None;
        scale(&mut r.q[1], 57.3);
    };
    assert_eq!(flawed(&no_velocity), [(FindingKind::Degrees, b())]);
    assert_eq!(flawed(&|r| r.tau[1].fill(0.0)), [(FindingKind::NoTorque, b()), LATE]);
    let at_rest = |r: &mut Recording| {
        r.q[1].fill(0.3);
        r.qd.as_mut().expect("it is there")[1].fill(0.0);
    };
    assert_eq!(flawed(&at_rest), [(FindingKind::JointAtRest, None), LATE]);
    let stamps_in_ms = |r: &mut Recording| scale(&mut r.time, 1e3);
    assert_eq!(flawed(&stamps_in_ms), [(FindingKind::TimeUnit, None), LATE]);
    let still = |r: &mut Recording| r.q.iter_mut().for_each(|q| q.fill(0.3));
    assert_eq!(flawed(&still), [(FindingKind::NoMotion, None)]);
}
