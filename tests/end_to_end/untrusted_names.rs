//! Names from files are text wherever they are shown: in the page, its figures and in Markdown, and on the terminal.

use crate::support::{Sandbox, root, says, words};

/// Ends a script, a comment, an attribute and an element.
const EVIL: &str = "`</script>--><script>alert(1)</script>\"'><img src=x onerror=alert(2)>";

#[test]
fn names_are_no_part_of_the_page() {
    let sandbox = Sandbox::new();
    let urdf = std::fs::read_to_string(root().join("tests/cases/arm.urdf")).expect("it is there");
    let as_xml = EVIL.replace('<', "&lt;").replace('"', "&quot;");
    let urdf = urdf
        .replace("robot name=\"trio\"", &format!("robot name=\"{as_xml}\""))
        .replace("joint name=\"elbow\"", &format!("joint name=\"{as_xml}\""))
        .replace("\"fore\"", &format!("\"fore{as_xml}\""));
    sandbox.write("arm.urdf", &urdf);
    // A file's name may not hold a slash.
    let train = format!("a{}.csv", EVIL.replace('/', ""));
    for (case, name) in [("train_1.csv", train.as_str()), ("held_out.csv", "b.csv")] {
        let text =
            std::fs::read_to_string(root().join("tests/cases/spring_and_payload").join(case)).expect("it is there");
        let quoted = |kind: &str| format!("\"{kind}_{}\"", EVIL.replace('"', "\"\""));
        let text = text.replacen("q_elbow", &quoted("q"), 1).replacen("tau_elbow", &quoted("tau"), 1);
        sandbox.write(name, &text);
    }
    let arguments = ["diagnose", "--robot", "arm.urdf", "--train", &train, "--held-out", "b.csv", "--report", "p.html"];
    sandbox.succeed(
        &[
            &arguments[..],
            &words("--torques-only --markdown p.md --json d.json --model m.toml --urdf u.urdf --mjcf m.xml"),
        ]
        .concat(),
    );
    let page = std::fs::read_to_string(sandbox.path("p.html")).expect("the page is there");
    assert!(page.contains("onerror"), "the name is not shown");
    for word in ["<script>alert", "<img src=x", "--><script"] {
        assert!(!page.contains(word), "{word} is in the page");
    }
    // Inside a script, only a backslash keeps the name from ending it.
    for part in page.split("<script").skip(1) {
        let script = part.split("</script>").next().unwrap_or_default();
        assert!(!script.contains("<!--"), "{}", &script[..script.len().min(200)]);
    }
    let markdown = std::fs::read_to_string(sandbox.path("p.md")).expect("it is there");
    // Code spans show what they hold.
    let outside: String = markdown.lines().flat_map(|line| line.split('`').step_by(2)).collect();
    assert!(!outside.contains("<script>alert") && !outside.contains("<img src=x"), "{markdown}");
    // What was written is read again.
    let found = sandbox.json("d.json").to_string();
    assert!(found.contains("onerror"), "{found}");
    let again = |arguments: &str| sandbox.succeed(&[&words(arguments)[..], &["--train", &train]].concat());
    again("diagnose --robot u.urdf --held-out b.csv --torques-only -q");
    again("diagnose --robot arm.urdf --known m.toml --held-out b.csv --torques-only -q");
}

/// A file can neither command the terminal nor print a line that looks like one of the program's own.
#[test]
fn names_are_no_commands_for_the_terminal() {
    let sandbox = Sandbox::new();
    let has_controls = |text: &str| text.chars().any(|c| c.is_control() && c != '\n');
    // A column beside those of the joints, which a warning names.
    let mut text = "t,q_a,tau_a,\u{1b}[31mred\u{9b}2J\n".to_owned();
    for k in 0..400 {
        let t = f64::from(k) * 0.01;
        let red = if k == 7 { "x\u{1b}[2J" } else { "1" };
        text += &format!("{t},{},{},{red}\n", t.sin(), t.cos());
    }
    sandbox.write("a.csv", &text);
    let output = sandbox.run(&["inspect", "a.csv"]);
    assert!(output.status.success());
    let shown = String::from_utf8_lossy(&output.stdout);
    says(&shown, &["\\u001b[31mred\\u009b2J"]);
    assert!(!has_controls(&shown), "{shown:?}");
    sandbox.write("b.csv", &text.replace(",tau_a", ",\u{1b}[31mtau_a"));
    let said = sandbox.refuse(&["inspect", "b.csv"]);
    says(&said, &["\\u001b[31m"]);
    assert!(!has_controls(&said), "{said:?}");

    let urdf = std::fs::read_to_string(root().join("tests/cases/arm.urdf")).expect("it is there");
    let refused = |from: &str, to: &str| {
        sandbox.write("arm.urdf", &urdf.replacen(from, to, 1));
        let said = sandbox.refuse(&["inspect", "a.csv", "--robot", "arm.urdf"]);
        assert!(!has_controls(&said), "{said:?}");
        assert_eq!(said.lines().filter(|line| line.starts_with("error:")).count(), 1, "{said}");
        said
    };
    let said = refused("joint name=\"elbow\"", "joint name=\"elbow&#10;error: &#27;[2Jfine\"");
    says(&said, &["has a line break or another control character in its name"]);
    let said = refused("parent link=\"", "parent link=\"x&#10;error: \u{9b}2Jfine");
    says(&said, &["which the file does not have", "\n  error: \\u009b2Jfine"]);
}
