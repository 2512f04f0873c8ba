//! `testbed inspect`: what it says of good recordings, of flawed ones, and what it refuses.

use crate::support::{Sandbox, root, says, words};

/// Two joints at 250 Hz for 12 s, each row as the closures say.
fn recording(row: impl Fn(usize, f64) -> Option<String>) -> String {
    let mut text = "t,q_joint1,q_joint2,qd_joint1,qd_joint2,tau_joint1,tau_joint2\n".to_owned();
    for k in 0..3000 {
        if let Some(row) = row(k, k as f64 * 0.004) {
            text += &row;
            text.push('\n');
        }
    }
    text
}

fn good_row(stamp: f64, t: f64) -> String {
    format!(
        "{stamp:.6},{:.5},{:.5},{:.4},{:.4},{:.3},{:.3}",
        (1.3 * t).sin(),
        0.7 * (2.1 * t).sin(),
        1.3 * (1.3 * t).cos(),
        1.47 * (2.1 * t).cos(),
        10.0 * (1.3 * t).cos(),
        4.0 * (2.1 * t).cos()
    )
}

fn good() -> String {
    recording(|_, t| Some(good_row(t, t)))
}

#[test]
fn a_good_recording_has_nothing_to_remark() {
    let sandbox = Sandbox::new();
    sandbox.write("good.csv", &good());
    let text = sandbox.succeed(&["inspect", "good.csv", "--json", "out.json"]);
    says(
        &text,
        &[
            "good.csv: 2 joints, 3000 rows, 12.00 s at 250 Hz, regular clock",
            "reversals",
            "(rad, m)",
            "(rad/s, m/s)",
            "(N m, N)",
            "no remarks",
        ],
    );
    let json = sandbox.json("out.json");
    assert_eq!(json["schema"], "testbed.inspect/1");
    assert_eq!(json["files"][0]["rate"], 250.0);
    assert_eq!(json["files"][0]["joints"][1]["moves"], true);
    let again = sandbox.succeed(&["inspect", "good.csv", "--json", "out2.json"]);
    assert_eq!(again.replace("out2", "out"), text);
    assert_eq!(sandbox.json("out2.json"), json);
    let over = sandbox.succeed(&["inspect", "good.csv", "--json", "out2.json"]);
    says(&over, &["written: out2.json (in place of an earlier one)"]);
    let printed = sandbox.succeed(&["inspect", "good.csv", "--json", "-"]);
    let printed: serde_json::Value = serde_json::from_str(&printed).expect("standard output is JSON");
    assert_eq!(printed, json);
    assert!(!sandbox.path("-").exists());
}

#[test]
fn flaws_are_reported_with_their_place_and_are_no_failure() {
    let sandbox = Sandbox::new();
    let flawed = recording(|k, t| match k {
        100 => Some(format!("{}\n{}", good_row(t, t), good_row(t, t))),
        500 | 700 | 701 | 1500..=1600 => None,
        1000 => Some(good_row(t, t).replacen(",-0.", ",-9.", 1)),
        k => Some(good_row(t + 4e-4 * (k as f64 * 2.7).sin(), t)),
    });
    let cut = flawed.trim_end().len() - 9;
    sandbox.write("flawed.csv", &flawed[..cut]);
    let text = sandbox.succeed(&["inspect", "flawed.csv", "--json", "out.json"]);
    says(
        &text,
        &[
            "cut in the middle",
            "line 103: 1 row was left out, equal to the row before",
            "q_joint1: 1 single-sample spike",
            "at 4.000 s",
            "3 of ",
            "no rows from 5.99",
            "the time stamps deviate from a clock of 250",
        ],
    );
    let json = sandbox.json("out.json");
    let kinds: Vec<&str> = json["files"][0]["warnings"]
        .as_array()
        .expect("a list")
        .iter()
        .filter_map(|warning| warning["kind"].as_str())
        .collect();
    for kind in ["cut_file", "duplicates", "gap", "jitter", "lost_rows", "spikes"] {
        assert!(kinds.contains(&kind), "{kind} is missing from {kinds:?}");
    }
}

#[test]
fn no_motion_and_no_torque_are_reported() {
    let sandbox = Sandbox::new();
    sandbox.write("still.csv", &recording(|_, t| Some(format!("{t:.6},0.1,0.2,0,0,0,0"))));
    let text = sandbox.succeed(&["inspect", "still.csv"]);
    says(&text, &["no joint moves", "joint1: the torque is 0 throughout"]);
}

#[test]
fn unreadable_recordings_are_refused_with_their_place_and_the_others_shown() {
    let sandbox = Sandbox::new();
    sandbox.write("good.csv", &good());
    for (flaw, parts) in [
        ("x", &["bad.csv:3: column \"q_joint1\" is \"x\"", "delete the row"][..]),
        ("NaN", &["bad.csv:3: column \"q_joint1\" is \"NaN\""]),
        ("inf", &["bad.csv:3: column \"q_joint1\" is \"inf\""]),
        ("", &["bad.csv:3: column \"q_joint1\" is \"\""]),
    ] {
        let bad = good().replacen("\n0.004000,0.00520", &format!("\n0.004000,{flaw}"), 1);
        assert_ne!(bad, good());
        sandbox.write("bad.csv", &bad);
        let output = sandbox.run(&["inspect", "bad.csv", "good.csv", "--json", "out.json"]);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success());
        says(&stderr, parts);
        says(&stderr, &["1 of 2 recordings cannot be used"]);
        says(&String::from_utf8_lossy(&output.stdout), &["good.csv: 2 joints"]);
        assert!(!sandbox.path("out.json").exists(), "something was left behind");
    }
    let refusal = |text: &str| {
        sandbox.write("bad.csv", text);
        sandbox.refuse(&["inspect", "bad.csv"])
    };
    let back = good().replacen("\n4.000000,", "\n3.000000,", 1);
    says(&refusal(&back), &["bad.csv:1002: time runs back, from 3.996 s to 3 s"]);
    says(&refusal("t,q_a,tau_a\n0,1,2\n"), &["one row"]);
    says(&refusal("t,q_a,q_b,tau_a\n"), &["bad.csv:1: there is no column \"tau_b\""]);
    says(&sandbox.refuse(&["inspect", "gone.csv"]), &["gone.csv: cannot be read"]);
    says(
        &sandbox.refuse(&["inspect", "good.csv", "--json", "./good.csv"]),
        &["./good.csv is an input of this command (good.csv); write to another file"],
    );
    says(&sandbox.refuse(&["inspect", "good.csv", "--json", "no/o.json"]), &["no/o.json", "cannot be written"]);
}

#[test]
fn a_column_map_reads_anybodys_file() {
    let sandbox = Sandbox::new();
    let degrees = 180.0 / std::f64::consts::PI;
    let mut text = "stamp;pos;cur;state\n".to_owned();
    for k in 0..2000 {
        let t = f64::from(k) * 0.01;
        text += &format!("{};{};{};RUN\n", 10 * k, -degrees * t.sin(), 2.0 * t.cos());
    }
    sandbox.write("theirs.csv", &text);
    let map = "[time]\ncolumn = \"stamp\"\nunit = \"ms\"\n[joints.elbow]\nq = \"pos\"\nq_unit = \"deg\"\nsign = -1\n\
               tau = \"cur\"\ntau_unit = \"A\"\ntau_scale = 12.5\n";
    sandbox.write("map.toml", map);
    let text = sandbox.succeed(&["inspect", "theirs.csv", "--map", "map.toml"]);
    says(&text, &["19.99 s at 100 Hz", "elbow", "-1 … 1", "-25 … 25", "column \"state\" is \"RUN\""]);
    sandbox.write("bad.toml", &map.replace("q_unit", "q_untis"));
    let message = sandbox.refuse(&["inspect", "theirs.csv", "--map", "bad.toml"]);
    says(&message, &["bad.toml:6: unknown key `q_untis`; did you mean `q_unit`?"]);
    sandbox.write("bad.toml", &map.replace("\"pos\"", "\"poss\""));
    let message = sandbox.refuse(&["inspect", "theirs.csv", "--map", "bad.toml"]);
    says(&message, &["bad.toml:5: theirs.csv has no column \"poss\"; did you mean \"pos\"?"]);
}

/// A recording of the PUMA 560 in the simulation, as CSV.
fn simulated(sandbox: &Sandbox) -> String {
    sandbox.succeed(&words("--scenario taskA --model true --rerun off --out run"));
    std::fs::read_to_string(sandbox.path("run/recording.csv")).expect("the run wrote it")
}

#[test]
fn what_does_not_fit_the_robot_is_reported() {
    let sandbox = Sandbox::new();
    let text = simulated(&sandbox);
    let inspect = |text: &str| {
        sandbox.write("r.csv", text);
        sandbox.succeed(&["inspect", "r.csv", "--robot", "puma560"])
    };
    let as_it_is = inspect(&text);
    for word in ["opposite", "swapped", "meant", "tau_scale"] {
        assert!(!as_it_is.contains(word), "{as_it_is}");
    }
    let (header, rows) = text.split_once('\n').expect("it has rows");
    let renamed = format!("{}\n{rows}", header.replace("_joint2", "_jont2"));
    says(
        &inspect(&renamed),
        &[
            "jont2: is in the recording, but the URDF has no such joint; is \"joint2\" meant?",
            "joint2: is in the URDF, but the recording has no such joint; is \"jont2\" meant?",
        ],
    );
    let swapped = header.replace("tau_joint2", "tau_x").replace("tau_joint3", "tau_joint2");
    let swapped = format!("{}\n{rows}", swapped.replace("tau_x", "tau_joint3"));
    says(&inspect(&swapped), &["the torques of joint2 and joint3 seem swapped"]);
    // A torque as the motor would feel it behind a gear of 100, turned, and in mN m. That of joint 1, whose axis is vertical, is also what
    // an inertia of its drive would need.
    let with = |torque: &str, factor: f64| {
        let at = header.split(',').position(|name| name == torque).expect("it is there");
        let mut changed = format!("{header}\n");
        for row in rows.lines() {
            let mut cells: Vec<String> = row.split(',').map(str::to_owned).collect();
            cells[at] = (factor * cells[at].parse::<f64>().expect("a number")).to_string();
            changed += &cells.join(",");
            changed.push('\n');
        }
        changed
    };
    says(&inspect(&with("tau_joint2", 0.01)), &["joint2: the torque is", "motor side"]);
    says(&inspect(&with("tau_joint2", -1.0)), &["joint2: the torque", "the sign opposite"]);
    for joint in ["joint1", "joint2"] {
        let said = inspect(&with(&format!("tau_{joint}"), 1000.0));
        says(&said, &[&format!("{joint}: the torque is"), "another unit", "about 1.0e-3"]);
    }
}

/// The drive of a wrist may have a thousand times the inertia of its link, which the URDF does not contain.
#[test]
fn the_inertia_of_a_drive_is_not_another_unit() {
    let sandbox = Sandbox::new();
    let text = simulated(&sandbox);
    let (header, rows) = text.split_once('\n').expect("it has rows");
    let at = |wanted: &str| header.split(',').position(|name| name == wanted).expect("it is there");
    let [time, speed, torque] = ["t", "qd_joint6", "tau_joint6"].map(at);
    let cells: Vec<Vec<f64>> =
        rows.lines().map(|row| row.split(',').map(|cell| cell.parse().expect("a number")).collect()).collect();
    let mut changed = format!("{header}\n");
    for k in 1..cells.len() - 1 {
        let (before, after) = (&cells[k - 1], &cells[k + 1]);
        let acceleration = (after[speed] - before[speed]) / (after[time] - before[time]);
        let mut row = cells[k].clone();
        row[torque] += 0.2 * acceleration;
        let row: Vec<String> = row.iter().map(f64::to_string).collect();
        changed += &row.join(",");
        changed.push('\n');
    }
    sandbox.write("r.csv", &changed);
    let said = sandbox.succeed(&["inspect", "r.csv", "--robot", "puma560"]);
    assert!(!said.contains("tau_scale"), "{said}");
}

#[test]
#[ignore = "needs ../shared"]
fn real_recordings_are_inspected() {
    let shared = root().join("../shared/recordings/iiwa14");
    let sandbox = Sandbox::new();
    let path = |name: &str| shared.join(name).to_string_lossy().into_owned();
    let text = sandbox.succeed(&[
        "inspect",
        &path("joint2_chirp.csv"),
        &path("joints_3_to_7.csv"),
        "--robot",
        &path("robot.urdf"),
    ]);
    says(&text, &["no rows from 2.3000 s to 2.3430 s", "line 3003: time starts again", "iiwa_joint_7"]);
    assert!(!text.contains("swapped") && !text.contains("opposite"), "{text}");
}

/// The units are those of the joints' kinds, which only the robot knows.
#[test]
fn the_table_has_units() {
    let sandbox = Sandbox::new();
    sandbox.write("good.csv", &good());
    let joint = |name: &str, kind: &str, parent: &str| {
        format!(
            "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"of_{name}\"/><axis xyz=\"0 0 1\"/>\
             <limit lower=\"-9\" upper=\"9\" effort=\"99\" velocity=\"9\"/></joint><link name=\"of_{name}\"><inertial><mass \
             value=\"1\"/><inertia ixx=\".1\" ixy=\"0\" ixz=\"0\" iyy=\".1\" iyz=\"0\" izz=\".1\"/></inertial></link>"
        )
    };
    let header = |kinds: [&str; 2]| {
        let [first, second] = [joint("joint1", kinds[0], "b"), joint("joint2", kinds[1], "of_joint1")];
        sandbox.write("r.urdf", &format!("<robot name=\"r\"><link name=\"b\"/>{first}{second}</robot>"));
        let text = sandbox.succeed(&["inspect", "good.csv", "--robot", "r.urdf"]);
        text.lines()
            .skip(2)
            .take(2)
            .map(|line| line.split_whitespace().collect::<Vec<_>>().join(" "))
            .collect::<Vec<_>>()
    };
    assert_eq!(
        header(["revolute", "revolute"]),
        ["joint position speed in reversals torque encoder velocity", "(rad) (rad/s) motion (N m) step delay"]
    );
    assert_eq!(header(["prismatic", "prismatic"])[1], "(m) (m/s) motion (N) step delay");
    assert_eq!(header(["revolute", "prismatic"])[1], "(rad, m) (rad/s, m/s) motion (N m, N) step delay");
}
