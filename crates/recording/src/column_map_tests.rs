//! Column maps: their meaning, and what is refused.

use super::*;

const GOOD: &str = r#"delimiter = ";"
[time]
column = "stamp"
unit = "ms"
[joints.shoulder]
q = "pos_1"
q_unit = "deg"
sign = -1
tau = "current_1"
tau_unit = "A"
tau_scale = 12.3
[joints.base]
q = "pos_0"
gear = 100
tau = "tau_0"
"#;

fn parse(text: &str) -> Result<ColumnMap, RecordingError> {
    ColumnMap::parse(text, Path::new("map.toml"))
}

fn refusal(from: &str, to: &str) -> String {
    assert!(GOOD.contains(from));
    parse(&GOOD.replace(from, to)).expect_err("it is refused").to_string()
}

#[test]
fn units_signs_gears_and_order_come_out() {
    let map = parse(GOOD).expect("it is good");
    assert_eq!(map.joints, ["shoulder", "base"]);
    let headers: Vec<String> = ["stamp", "pos_0", "pos_1", "current_1", "tau_0", "mode"].map(str::to_owned).to_vec();
    let plan = map.plan(&headers, &[], Path::new("r.csv")).expect("it fits");
    assert_eq!((plan.time.index, plan.time.factor), (0, 1e-3));
    let factors: Vec<f64> = plan.channels.iter().map(|channel| channel.factor).collect();
    let expected = [-std::f64::consts::PI / 180.0, -12.3, 0.01, 100.0];
    for (factor, expected) in factors.iter().zip(expected) {
        assert!((factor - expected).abs() < 1e-12, "{factor} {expected}");
    }
    assert_eq!(plan.others, [(5, "mode".to_owned())]);
    let missing = map.plan(&headers[..4], &[], Path::new("r.csv")).expect_err("a column is missing").to_string();
    assert!(missing.contains("map.toml:15") && missing.contains("r.csv has no column \"tau_0\""), "{missing}");
}

#[test]
fn a_bad_map_is_refused_with_its_line() {
    assert!(refusal("q_unit", "q_unti").contains("map.toml:7: unknown key `q_unti`; did you mean `q_unit`?"));
    assert!(refusal("\"deg\"", "\"degrees\"").contains("map.toml:7: unknown unit \"degrees\"; known here: rad"));
    assert!(refusal("sign = -1", "sign = 2").contains("map.toml:8: sign is 2; it must be 1 or -1"));
    assert!(refusal("tau_scale = 12.3\n", "").contains("map.toml:10: a torque in \"A\" needs tau_scale"));
    assert!(refusal("gear = 100", "gear = 0").contains("map.toml:14: gear is 0"));
    assert!(refusal("\"ms\"", "\"hours\"").contains("map.toml:4"));
    assert!(refusal("gear = 100", "qd = \"v\"").contains("joint \"shoulder\" has no `qd`"));
    assert!(refusal("tau = \"tau_0\"\n", "").contains("missing field `tau`"));
    assert!(refusal("\";\"", "\";;\"").contains("map.toml:1"));
}

#[test]
fn the_example_of_the_documentation_is_good() {
    let page = include_str!("../../../docs/recordings.md");
    let example = page.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next());
    let map = parse(example.expect("the page has an example")).expect("it is good");
    assert_eq!(map.joints, ["shoulder", "elbow"]);
}

#[test]
fn a_column_is_one_thing() {
    let parse = |text: &str| ColumnMap::parse(text, Path::new("m.toml")).map_err(|error| error.to_string());
    let map = |a: &str, b: &str| {
        format!("[time]\ncolumn = \"t\"\n[joints.a]\nq = \"x\"\ntau = \"{a}\"\n[joints.b]\nq = \"{b}\"\ntau = \"w\"\n")
    };
    assert!(parse(&map("y", "z")).is_ok());
    for (text, line, other) in
        [(map("y", "x"), 7, 4), (map("x", "z"), 5, 4), (map("y", "t"), 7, 2), (map("w", "z"), 8, 5)]
    {
        let found = parse(&text).expect_err("it is refused");
        let said = format!("m.toml:{line}: column");
        assert!(found.starts_with(&said) && found.contains(&format!("taken in line {other} already")), "{found}");
    }
    let current =
        map("y", "z").replace("tau = \"y\"", "tau = \"y\"\ntau_unit = \"A\"\ntau_scale = 2.0\ncurrent = \"y\"");
    assert!(parse(&current).is_ok());
}

#[test]
fn one_joint_stands_for_all_of_a_pattern() {
    let headers = |names: &str| -> Vec<String> { names.split(' ').map(str::to_owned).collect() };
    let map = "[time]\ncolumn = \"s\"\nnanosec = \"ns\"\nrun = \"take\"\n[joints.\"{joint}\"]\nq = \"{joint}.pos\"\n\
               qd = \"{joint}.vel\"\ntau = \"{joint}.eff\"\nsign = -1\n";
    let map = parse(map).expect("it is good");
    let file = Path::new("r.csv");
    let plan = map.plan(&headers("s ns take b.pos b.vel b.eff a.pos a.eff hand.pos"), &[], file).expect("it fits");
    assert_eq!(plan.joints, ["b", "a"]);
    assert_eq!((plan.time.nanos, plan.time.run), (Some((1, "ns".into())), Some((2, "take".into()))));
    // Only one of them has a velocity.
    assert!(plan.channels.iter().all(|channel| channel.quantity != Quantity::Velocity && channel.factor == -1.0));
    assert_eq!(plan.others.len(), 2);
    let error = map.plan(&headers("s ns take b.pos"), &[], file).expect_err("no torque").to_string();
    assert!(error.contains("no column \"{joint}.eff\""), "{error}");
    let two = "[time]\ncolumn = \"t\"\n[joints.\"{joint}\"]\nq = \"{joint}.pos\"\ntau = \"eff\"\n";
    let error = parse(two).expect_err("one column for all").to_string();
    assert!(error.contains("map.toml:5: column \"eff\" would be that of every joint"), "{error}");
    let error = parse(&format!("{two}[joints.b]\nq = \"q\"\ntau = \"w\"\n")).expect_err("two").to_string();
    assert!(error.contains("it must be the only one"), "{error}");
    let error = parse("delimiter = \";\"\n").expect_err("no joints").to_string();
    assert!(error.contains("there are no joints"), "{error}");
}
