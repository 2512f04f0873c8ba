//! What says nothing of the physics does not change a diagnosis: names, the start of the clock, units, rows written twice, the
//! order of columns, the unit of mass, the direction of an axis, and where fixed frames stand.

use std::collections::BTreeMap;

use serde_json::Value;

use crate::support::{Sandbox, root};

/// The case, with which every effect of another is compared: a spring, a payload and friction.
const CASE: &str = "spring_and_payload";
const JOINTS: [&str; 3] = ["turn", "shoulder", "elbow"];

/// A recording of [`CASE`], and how it is written.
struct Rows {
    header: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Rows {
    fn read(case: &str, name: &str) -> Self {
        let path = root().join("tests/cases").join(case).join(name);
        let text = std::fs::read_to_string(path).expect("the recording is there");
        let mut lines = text.lines();
        let header = lines.next().expect("a header").split(',').map(str::to_owned).collect();
        let row = |line: &str| line.split(',').map(|cell| cell.parse().expect("a number")).collect();
        Self { header, rows: lines.map(row).collect() }
    }

    fn each(&mut self, change: impl Fn(&mut Vec<f64>)) {
        self.rows.iter_mut().for_each(change);
    }

    fn text(&self) -> String {
        let line = |row: &Vec<f64>| row.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
        let rows: Vec<String> = self.rows.iter().map(line).collect();
        format!("{}\n{}\n", self.header.join(","), rows.join("\n"))
    }
}

/// What differs from the case as it is.
struct Variant<'a> {
    case: &'a str,
    urdf: &'a dyn Fn(String) -> String,
    rows: &'a dyn Fn(&mut Rows),
    map: Option<String>,
}

impl Default for Variant<'_> {
    fn default() -> Self {
        Self { case: CASE, urdf: &|text| text, rows: &|_| (), map: None }
    }
}

impl Variant<'_> {
    fn diagnose(&self) -> Value {
        let sandbox = Sandbox::new();
        let urdf = std::fs::read_to_string(root().join("tests/cases/arm.urdf")).expect("the robot is there");
        sandbox.write("arm.urdf", &(self.urdf)(urdf));
        for name in ["train_1.csv", "held_out.csv"] {
            let mut rows = Rows::read(self.case, name);
            (self.rows)(&mut rows);
            sandbox.write(name, &rows.text());
        }
        let mut arguments =
            vec!["diagnose", "--robot", "arm.urdf", "--train", "train_1.csv", "--held-out", "held_out.csv"];
        arguments.extend(["--torques-only", "--json", "d.json"]);
        if let Some(map) = &self.map {
            sandbox.write("map.toml", map);
            arguments.extend(["--map", "map.toml"]);
        }
        sandbox.succeed(&arguments);
        sandbox.json("d.json")
    }
}

/// Every value by its place in the diagnosis.
fn flat(value: &Value, place: &str, into: &mut BTreeMap<String, Value>) {
    match value {
        Value::Object(entries) => entries.iter().for_each(|(key, value)| flat(value, &format!("{place}.{key}"), into)),
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(k, value)| flat(value, &format!("{place}[{k}]"), into));
        }
        value => {
            into.insert(place.to_owned(), value.clone());
        }
    }
}

/// Fails if the two differ by more than rounding in anything but what `excepted` says of its place and its values.
fn is_same(what: &str, a: &Value, b: &Value, excepted: impl Fn(&str, &Value, &Value) -> bool) {
    let [mut ours, mut theirs] = [BTreeMap::new(), BTreeMap::new()];
    flat(a, "", &mut ours);
    flat(b, "", &mut theirs);
    assert!(ours.len() > 100, "{what}: {} values", ours.len());
    let names = |map: &BTreeMap<String, Value>| map.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(&ours), names(&theirs), "{what}");
    for (place, a) in &ours {
        let b = &theirs[place];
        let near = match (a.as_f64(), b.as_f64()) {
            (Some(a), Some(b)) => (a - b).abs() <= 1e-6 * a.abs().max(b.abs()) + 1e-9,
            _ => a == b,
        };
        assert!(near || excepted(place, a, b), "{what}: {place} is {a}, then {b}");
    }
}

fn nothing(_: &str, _: &Value, _: &Value) -> bool {
    false
}

/// Whether the second number is `factor` times the first; text is not compared, because it has the numbers.
fn is_scaled(a: &Value, b: &Value, factor: f64) -> bool {
    match (a.as_f64(), b.as_f64()) {
        (Some(a), Some(b)) => (a * factor - b).abs() <= 1e-6 * b.abs() + 1e-9,
        _ => a.is_string() && b.is_string(),
    }
}

#[test]
fn form_names_and_units_change_nothing() {
    let plain = Variant::default().diagnose();
    let doubled = |rows: &mut Rows| rows.rows = rows.rows.iter().flat_map(|row| [row.clone(), row.clone()]).collect();
    let of = |rows: &dyn Fn(&mut Rows)| Variant { rows, ..Variant::default() }.diagnose();
    assert_eq!(of(&doubled)["findings"], plain["findings"]);
    is_same("rows written twice", &plain, &of(&doubled), nothing);
    let turned = |rows: &mut Rows| {
        rows.header[1..].reverse();
        rows.each(|row| row[1..].reverse());
    };
    is_same("columns in another order", &plain, &of(&turned), nothing);

    // Names that sort in another order and have spaces.
    let others = ["z", "the 2nd axis", "a-3"];
    let renamed = Variant {
        urdf: &|text| {
            let pairs = JOINTS.iter().zip(others);
            pairs.fold(text, |text, (from, to)| {
                text.replace(&format!("joint name=\"{from}\""), &format!("joint name=\"{to}\""))
            })
        },
        rows: &|rows| {
            for header in &mut rows.header {
                if let Some((kind, joint)) = header.split_once('_') {
                    let at = JOINTS.iter().position(|name| *name == joint).expect("a joint");
                    *header = format!("{kind}_{}", others[at]);
                }
            }
        },
        ..Variant::default()
    };
    let text = JOINTS.iter().zip(others).fold(renamed.diagnose().to_string(), |text, (to, from)| {
        // As keys and values, and in sentences.
        text.replace(&format!("\"{from}\""), &format!("\"{to}\""))
            .replace(&format!("{from}:"), &format!("{to}:"))
            .replace(&format!(" {from}"), &format!(" {to}"))
    });
    is_same("joints renamed", &plain, &serde_json::from_str(&text).expect("it is JSON"), |_, a, b| {
        a.is_string() && b.as_str().is_some_and(|text| text.contains(' '))
    });

    let entry = |joint: &&str| {
        format!(
            "[joints.{joint}]\nq = \"q_{joint}\"\nq_unit = \"deg\"\ntau = \"tau_{joint}\"\ntau_scale = 0.001\nsign = -1\n"
        )
    };
    let map: String = JOINTS.iter().map(entry).collect();
    let units = Variant {
        rows: &|rows| {
            rows.each(|row| {
                row[0] *= 1000.0;
                row[1..4].iter_mut().for_each(|q| *q = -q.to_degrees());
                row[4..].iter_mut().for_each(|tau| *tau *= -1000.0);
            });
        },
        map: Some(format!("[time]\ncolumn = \"t\"\nunit = \"ms\"\n{map}")),
        ..Variant::default()
    };
    is_same("other units", &plain, &units.diagnose(), nothing);
}

/// Times are given on the recordings' clock. (Warming alone has its `amplitude` at the clock's zero, and is not invariant:
/// docs/diagnosis.md says so.)
#[test]
fn a_clock_that_began_earlier_shifts_the_times_and_nothing_else() {
    let later = |rows: &mut Rows| rows.each(|row| row[0] += 1000.5);
    for case in [CASE, "contact"] {
        let diagnose = |rows: &dyn Fn(&mut Rows)| Variant { case, rows, ..Variant::default() }.diagnose();
        let (plain, shifted) = (diagnose(&|_| ()), diagnose(&later));
        is_same("time shifted", &plain, &shifted, |place, a, b| {
            let is_time = place.contains(".time[") || place.contains(".start.");
            let warming = place.starts_with(".not_observable") && place.ends_with(".amplitude");
            let by = b.as_f64().zip(a.as_f64()).map(|(b, a)| b - a);
            is_time && by.is_some_and(|by| (by - 1000.5).abs() < 1e-6) || warming || place.ends_with(".sentence")
        });
    }
}

/// Warming is found on a clock that ran long before, too: its amplitude belongs to another time, the rest is the same.
#[test]
fn warming_is_found_on_a_clock_that_began_long_before() {
    let warming = |seconds: f64| -> Value {
        let later = move |rows: &mut Rows| rows.each(|row| row[0] += seconds);
        let diagnosis = Variant { case: "warming", rows: &later, ..Variant::default() }.diagnose();
        let findings = diagnosis["findings"].as_array().expect("findings").clone();
        let is_it = |finding: &Value| finding["effect"] == "thermal_drift";
        findings.into_iter().find(is_it).expect("warming is found")
    };
    let (plain, later) = (warming(0.0), warming(54_321.0));
    let value = |finding: &Value, key: &str| finding["parameters"][key]["value"].as_f64().expect("a number");
    for key in ["coulomb", "amplitude", "time_constant"] {
        let (a, b) = (value(&plain, key), value(&later, key));
        assert!((a - b).abs() < 1e-3 * a.abs(), "{key}: {a} and {b}");
    }
    assert_eq!(value(&later, "start"), 54_321.0);
    assert!(plain["parameters"].get("start").is_none());
}

/// Twice the masses and inertias under twice the torques are the same arm in another unit of mass.
#[test]
fn masses_and_torques_that_scale_alike_change_only_their_sizes() {
    let number = |text: &str, factor: f64| (text.parse::<f64>().expect("a number") * factor).to_string();
    let heavy = |text: String| {
        let keys = ["mass value=\"", "ixx=\"", "iyy=\"", "izz=\"", "effort=\""];
        keys.iter().fold(text, |text, key| {
            let mut parts = text.split(key);
            let first = parts.next().expect("a part").to_owned();
            parts.fold(first, |text, part| {
                let (value, rest) = part.split_once('"').expect("it is quoted");
                format!("{text}{key}{}\"{rest}", number(value, 2.0))
            })
        })
    };
    let scaled = Variant {
        urdf: &heavy,
        rows: &|rows| rows.each(|row| row[4..].iter_mut().for_each(|tau| *tau *= 2.0)),
        ..Variant::default()
    };
    let plain = Variant::default().diagnose();
    is_same("scaled", &plain, &scaled.diagnose(), |_, a, b| is_scaled(a, b, 2.0));
}

#[test]
fn an_axis_of_the_other_direction_is_the_same_joint() {
    let reversed = Variant {
        urdf: &|text| {
            let from = "<child link=\"fore\"/>\n<axis xyz=\"0 1 0\"/>";
            assert!(text.contains(from));
            text.replace(from, "<child link=\"fore\"/>\n<axis xyz=\"0 -1 0\"/>")
        },
        rows: &|rows| {
            rows.each(|row| {
                row[3] = -row[3];
                row[6] = -row[6];
            });
        },
        ..Variant::default()
    };
    let plain = Variant::default().diagnose();
    // Ends of ranges change places, and the regions of `located` are cut from the range's start.
    is_same("elbow reversed", &plain, &reversed.diagnose(), |place, a, b| {
        let is_place = place.contains(".rest.") || place.starts_with(".located") || place.contains(".state");
        is_place || place.ends_with(".sentence") || is_scaled(a, b, -1.0) && a.is_f64()
    });
}

/// A fixed joint below the base moves nothing but where the base is; one beyond the last link moves the tool alone, at which payloads
/// and contacts are described: the findings without them remain.
#[test]
fn fixed_frames_change_nothing() {
    let on_a_stand = Variant {
        urdf: &|text| {
            text.replace(
                "<link name=\"floor\"/>",
                "<link name=\"ground\"/><link name=\"floor\"/><joint name=\"stand\" type=\"fixed\"><origin xyz=\"1 2 0.5\" \
                 rpy=\"0 0 0.7\"/><parent link=\"ground\"/><child link=\"floor\"/></joint>",
            )
        },
        ..Variant::default()
    };
    is_same("on a stand", &Variant::default().diagnose(), &on_a_stand.diagnose(), nothing);
    let with_a_tool = Variant {
        case: "warming",
        urdf: &|text| {
            text.replace(
                "</robot>",
                "<link name=\"flange\"/><joint name=\"end\" type=\"fixed\"><origin xyz=\"0.1 0 0.05\" rpy=\"0 0.3 0\"/>\
                 <parent link=\"fore\"/><child link=\"flange\"/></joint></robot>",
            )
        },
        ..Variant::default()
    };
    let bare = Variant { case: "warming", ..Variant::default() };
    is_same("with a flange", &bare.diagnose(), &with_a_tool.diagnose(), nothing);
}
