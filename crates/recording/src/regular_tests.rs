//! Recordings put on their clock: what comes out is what was sampled.

use super::*;

fn sample(time: Vec<f64>, at: &[f64]) -> Recording {
    Recording {
        joints: vec!["a".into()],
        q: vec![at.iter().map(|t| (3.0 * t).sin()).collect()],
        tau: vec![at.iter().map(|t| 10.0 * (3.0 * t).cos()).collect()],
        time,
        ..Recording::default()
    }
}

#[test]
fn an_even_recording_stays_as_it_is() {
    let at: Vec<f64> = (0..1000).map(|k| f64::from(k) * 0.004).collect();
    let recording = sample(at.clone(), &at);
    let (regular, warnings) = recording.regular().expect("it has a clock");
    assert_eq!(warnings, []);
    assert_eq!((&regular.q, &regular.tau), (&recording.q, &recording.tau));
    assert!(regular.present.iter().all(|present| *present));
    assert_eq!((regular.period, regular.segments.len()), (0.004, 1));
    assert!(regular.times().zip(&at).all(|(tick, stamp)| (tick - stamp).abs() < 1e-9));
    assert!((regular.time(500) - 2.0).abs() < 1e-9);
}

#[test]
fn lost_rows_are_interpolated_and_long_gaps_part() {
    let all: Vec<f64> = (0..2000).map(|k| f64::from(k) * 0.002).collect();
    let kept = |k: usize| !(k % 97 == 50 || (600..603).contains(&k) || (1200..1300).contains(&k));
    let at: Vec<f64> = (0..2000).filter(|&k| kept(k)).map(|k| all[k]).collect();
    let jittered = at.iter().enumerate().map(|(k, t)| t + 2e-4 * (k as f64 * 1.7).sin()).collect();
    let (regular, warnings) = sample(jittered, &at).regular().expect("it has a clock");
    assert_eq!(regular.segments.len(), 2);
    assert_eq!(regular.len(), 1900);
    assert!((regular.segments[1].start - 2.6).abs() < 1e-4);
    for (tick, time) in regular.times().enumerate() {
        let truth = (3.0 * time).sin();
        assert!((regular.q[0][tick] - truth).abs() < 1e-3, "tick {tick}");
    }
    let lost = (0..2000).filter(|&k| !kept(k) && !(1200..1300).contains(&k)).count();
    assert_eq!(regular.present.iter().filter(|present| !**present).count(), lost);
    assert!(warnings.iter().any(|w| matches!(w, Warning::LostRows { rows, of: 1900, .. } if *rows == lost)));
    assert!(warnings.iter().any(|w| matches!(w, Warning::Gap { .. })));
    assert!(warnings.iter().any(|w| matches!(w, Warning::Jitter { .. })));
    // On its ticks, the sine differentiates cleanly.
    let second = |k: usize| (regular.q[0][k + 1] - 2.0 * regular.q[0][k] + regular.q[0][k - 1]) / 4e-6;
    assert!((1..1100).all(|k| (second(k) + 9.0 * regular.q[0][k]).abs() < 0.02));
}

#[test]
fn rows_without_a_clock_are_resampled() {
    let at: Vec<f64> = (0..2000)
        .scan(0.0, |at, k| {
            *at += 0.005 * (1.0 + 0.8 * (f64::from(k) * 2.3).sin() * (f64::from(k) * 0.011).cos());
            Some(*at)
        })
        .collect();
    let (regular, warnings) = sample(at.clone(), &at).regular().expect("it is resampled");
    assert!(!regular.has_clock);
    assert!(warnings.iter().any(|w| matches!(w, Warning::NoRegularClock { .. })));
    for (tick, time) in regular.times().enumerate() {
        assert!((regular.q[0][tick] - (3.0 * time).sin()).abs() < 1e-6);
    }
}

#[test]
fn spikes_are_reported_with_joint_and_time() {
    let at: Vec<f64> = (0..1000).map(|k| f64::from(k) * 0.004).collect();
    let mut recording = sample(at.clone(), &at);
    recording.q[0][500] += 0.2;
    recording.tau[0][250] -= 30.0;
    let (regular, warnings) = recording.regular().expect("it has a clock");
    assert!((regular.q[0][500] - (3.0 * at[500]).sin()).abs() < 1e-6);
    let found: Vec<String> = warnings.iter().map(Warning::to_string).collect();
    assert!(found[0].contains("q_a: 1 single-sample spike") && found[0].contains("2.000"), "{found:?}");
    assert!(found[1].contains("tau_a") && found[1].contains("1.000"), "{found:?}");
}

#[test]
fn what_has_no_order_or_length_is_refused() {
    assert!(matches!(sample(vec![0.0], &[0.0]).regular(), Err(RecordingError::TooShort { .. })));
    let back = sample(vec![0.0, 1.0, 0.5], &[0.0, 1.0, 0.5]).regular();
    assert!(matches!(back, Err(RecordingError::Time { row: 2, .. })));
}

/// Pairs of rows half a second apart: a clock of their mean period would put both rows of a pair on one tick.
#[test]
fn rows_of_one_tick_have_no_clock() {
    let at = [0.0, 2.663, 2.667, 2.679, 2.683, 2.695, 2.699, 3.203, 3.207];
    let (regular, _) = sample(at.to_vec(), &at).regular().expect("it is resampled");
    assert!(!regular.has_clock);
    assert!(regular.q[0].iter().all(|q| q.abs() < 2.0), "{:?}", regular.q[0]);
}

#[test]
fn a_position_that_jumps_begins_another_run() {
    let at: Vec<f64> = (0..1000).map(|k| f64::from(k) * 0.004).collect();
    let mut recording = sample(at.clone(), &at);
    recording.q[0][500..].iter_mut().for_each(|q| *q += 0.3);
    let (regular, warnings) = recording.regular().expect("it has a clock");
    let ticks: Vec<_> = regular.segments.iter().map(|segment| segment.ticks.clone()).collect();
    assert_eq!(ticks, [0..500, 500..1000]);
    assert!((regular.segments[1].start - 2.0).abs() < 1e-6);
    let texts: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    assert!(texts.len() == 1 && texts[0].contains("q_a") && texts[0].contains("2.000 s"), "{texts:?}");
}
