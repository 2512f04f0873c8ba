//! Diagnoses of long recordings and of slow logs: which parts are used, and what is reported.

mod support;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use diagnosis::Verdict;
use study::inputs::{Given, Recordings};
use study::{Diagnosed, Request};

use support::Heard;

const ARM: &str = r#"<robot name="pendulum"><link name="base"/><link name="arm"><inertial><origin xyz="0 0 -0.3"/><mass value="2"/>
<inertia ixx="0.05" iyy="0.05" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="swing" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" velocity="5" effort="30"/></joint></robot>"#;

/// Position, velocity and torque of the pendulum, which has viscous friction of 0.6 N m s/rad.
fn motion(t: f64) -> [f64; 3] {
    let (mut q, mut qd, mut qdd) = (0.0, 0.0, 0.0);
    for (size, pace) in [(0.7, 0.9), (0.4, 2.1), (0.3_f64, 0.37_f64)] {
        let (sine, cosine) = (pace * t).sin_cos();
        q += size * sine;
        qd += size * pace * cosine;
        qdd -= size * pace * pace * sine;
    }
    [q, qd, 0.23 * qdd + 2.0 * 9.81 * 0.3 * q.sin() + 0.6 * qd]
}

/// Writes a file of the motion from `from` (s) on, for `seconds` at `rate` (Hz), in slow motion if `pace` is below one.
fn write(file: &Path, seconds: u32, rate: u32, from: f64, pace: f64) {
    let mut text = "t,q_swing,tau_swing\n".to_owned();
    for row in 0..seconds * rate {
        let t = f64::from(row) / f64::from(rate);
        let [q, _, tau] = motion(from + pace * t);
        // Noise of the torque sensor.
        let tau = tau + 0.02 * (f64::from(row) * 12.9898).sin() * (f64::from(row) * 78.233).cos();
        writeln!(text, "{t:.3},{q:.6},{tau:.6}").expect("it is written");
    }
    std::fs::write(file, text).expect("it is written");
}

/// The diagnosis of training and held-out recordings, and the notes.
fn diagnose(folder: &Path, train: &[&str], held_out: &[&str]) -> (Diagnosed, Vec<String>) {
    let robot = folder.join("arm.urdf");
    std::fs::write(&robot, ARM).expect("it is written");
    let given = |names: &[&str]| names.iter().map(|name| Given::File(folder.join(name))).collect();
    let request = Request {
        robot: robot.display().to_string(),
        recordings: Recordings { train: given(train), held_out: given(held_out), ..Recordings::default() },
        torques_only: true,
        ..Request::default()
    };
    let heard = Heard::default();
    let diagnosed = request.run(&heard).unwrap_or_else(|error| panic!("{error:#}"));
    (diagnosed, heard.0.into_inner())
}

fn json(diagnosed: &Diagnosed) -> serde_json::Value {
    serde_json::to_value(&diagnosed.diagnosis.report.recordings).expect("it is JSON")
}

#[test]
fn a_short_recording_beside_a_long_one_is_used_whole() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| -> PathBuf { folder.path().join(name) };
    write(&path("long.csv"), 2400, 50, 0.0, 1.0);
    write(&path("short.csv"), 30, 50, 5000.3, 1.0);
    write(&path("held.csv"), 25, 50, 9000.7, 1.0);
    let (diagnosed, notes) = diagnose(folder.path(), &["short.csv", "long.csv"], &["held.csv"]);
    let name = |name: &str| path(name).display().to_string();
    let note = format!("; {} is used whole", name("short.csv"));
    assert!(
        notes
            .iter()
            .any(|found| found.starts_with("of the 2430 s of training recordings, about 270 s")
                && found.ends_with(&note)),
        "{notes:?}"
    );
    let traces = &diagnosed.diagnosis.traces.recordings;
    let times = &traces[0].time;
    assert!(times[times.len() - 1] - times[0] > 28.0, "{times:?}");
    let recordings = json(&diagnosed);
    assert_eq!(recordings["train"], serde_json::json!([name("short.csv"), name("long.csv")]));
    let parts = recordings["used_in_part"].as_array().expect("a list");
    assert_eq!(parts.len(), 1, "{parts:?}");
    assert_eq!(parts[0]["recording"], name("long.csv"));
    let seconds = |key: &str| parts[0][key].as_f64().expect("a number");
    assert!((230.0..250.0).contains(&seconds("used_seconds")), "{parts:?}");
    assert!((seconds("of_seconds") - 2400.0).abs() < 1.0, "{parts:?}");
    // Of the short ones alone, all is used, and the JSON has nothing more.
    let (diagnosed, _) = diagnose(folder.path(), &["short.csv"], &["held.csv"]);
    let expected = serde_json::json!({"train": [name("short.csv")], "held_out": [name("held.csv")]});
    assert_eq!(json(&diagnosed), expected);
}

/// Logs of a day at 1 to 8 Hz, and half an hour in milliseconds that are taken for seconds.
#[test]
fn a_slow_log_is_distinguished_from_stamps_in_milliseconds() {
    let folder = tempfile::tempdir().expect("a folder");
    for rate in [1, 5, 8] {
        write(&folder.path().join("slow.csv"), 86_400, rate, 0.0, 0.05 * f64::from(rate));
        let (diagnosed, _) = diagnose(folder.path(), &["slow.csv"], &[]);
        let report = &diagnosed.diagnosis.report;
        assert_eq!(report.verdict, Verdict::UnitsFirst);
        let [doubt] = &report.doubts[..] else { panic!("{:?}", report.doubts) };
        let apart = format!("its rows are {:.3} s apart, too far for velocities", 1.0 / f64::from(rate));
        assert!(doubt.text.starts_with(&apart) && doubt.text.ends_with("record at 100 Hz or more"), "{doubt:?}");
        assert_eq!(doubt.column_map, None);
    }
    write(&folder.path().join("ms.csv"), 20_000, 1, 0.0, 1e-3);
    let (diagnosed, _) = diagnose(folder.path(), &["ms.csv"], &[]);
    let [doubt] = &diagnosed.diagnosis.report.doubts[..] else { panic!("no doubt") };
    assert!(
        doubt.text.contains("are its stamps in ms, or are they the numbers of the rows") && doubt.column_map.is_some(),
        "{doubt:?}"
    );
}
