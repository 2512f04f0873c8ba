//! What `testbed diagnose` writes for other tools: predictions and residuals row by row, and the findings as Markdown.

use std::collections::BTreeMap;

use crate::diagnose_made::{Case, Motion, SHOULDER, arguments, trio};
use crate::diagnose_refusals::case;
use crate::support::says;

/// Coulomb and viscous friction on the shoulder.
fn friction(motion: &Motion, tau: &mut [f64]) {
    let speed = motion.qd[SHOULDER];
    tau[SHOULDER] += 2.5 * speed.signum() + 1.8 * speed;
}

/// The columns of a CSV file by their headers.
fn columns(text: &str) -> BTreeMap<String, Vec<String>> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header: Vec<String> = reader.headers().expect("a header").iter().map(str::to_owned).collect();
    let mut columns: BTreeMap<String, Vec<String>> = header.iter().map(|name| (name.clone(), Vec::new())).collect();
    for row in reader.records() {
        for (name, cell) in header.iter().zip(row.expect("a row").iter()) {
            columns.get_mut(name).expect("a column").push(cell.to_owned());
        }
    }
    columns
}

/// The residuals are those of the errors in the JSON, which they do not change.
#[test]
fn residuals_are_those_of_the_errors() {
    let case = Case::new(&trio(), &friction);
    let run = |name: &str, further: &[&str]| {
        let list = [&["--torques-only", "--json", name], further].concat();
        case.sandbox.succeed(&arguments(&list));
        case.text(name)
    };
    let without = run("without.json", &[]);
    let with = run("with.json", &["--residuals", "r.csv"]);
    assert!(without == with, "the JSON depends on the other outputs");
    let found = case.sandbox.json("with.json");
    let columns = columns(&case.text("r.csv"));
    assert_eq!(columns.len(), 3 + 5 * 3);
    let rows = columns["t"].len();
    let number = |name: &str, row: usize| -> f64 { columns[name][row].parse().expect("a number") };
    for (file, role, [start, end]) in
        [("a.csv", "false", [0.0, 16.0]), ("b.csv", "false", [40.0, 56.0]), ("c.csv", "true", [80.0, 90.0])]
    {
        let of_file: Vec<usize> = (0..rows).filter(|&row| columns["recording"][row] == file).collect();
        assert!(of_file.len() > 200, "{file} has {} rows", of_file.len());
        assert!(of_file.iter().all(|&row| columns["held_out"][row] == role), "{file}");
        // Times are those in the file.
        assert!(of_file.windows(2).all(|pair| number("t", pair[0]) < number("t", pair[1])));
        for &row in &of_file {
            assert!((start..end).contains(&number("t", row)), "{file}: {}", number("t", row));
        }
    }
    for joint in ["turn", "shoulder", "elbow"] {
        let of = |signal: &str, row: usize| number(&format!("{signal}_{joint}"), row);
        let moving: Vec<usize> = (0..rows)
            .filter(|&row| columns["held_out"][row] == "true" && columns[&format!("moving_{joint}")][row] == "true")
            .collect();
        let count = moving.len() as f64;
        let mean = moving.iter().map(|&row| of("measured", row)).sum::<f64>() / count;
        let spread = moving.iter().map(|&row| (of("measured", row) - mean).powi(2)).sum::<f64>();
        for (signal, key) in [("nominal", "held_out_nrmse_nominal"), ("corrected", "held_out_nrmse_exported")] {
            let error = moving.iter().map(|&row| (of("measured", row) - of(signal, row)).powi(2)).sum::<f64>();
            let (error, expected) = ((error / spread).sqrt(), found["fit"][joint][key].as_f64());
            let expected = expected.expect("a number");
            assert!((error - expected).abs() < 1e-9 * expected, "{joint} {key}: {error} instead of {expected}");
        }
        for row in 0..rows {
            let left = of("measured", row) - of("corrected", row);
            assert!((left - of("residual", row)).abs() < 1e-9);
        }
    }
    run("again.json", &["--residuals", "r.parquet"]);
    let bytes = std::fs::read(case.path("r.parquet")).expect("the file is there");
    assert!(bytes.starts_with(b"PAR1") && bytes.ends_with(b"PAR1"));
}

#[test]
fn outputs_with_the_ending_of_another_format_are_refused() {
    let case = case();
    let before = case.sandbox.list("");
    let refused = |command: &[&str], parts: &[&str]| {
        says(&case.sandbox.refuse(command), parts);
        assert_eq!(case.sandbox.list(""), before, "something was left behind");
    };
    for (option, name, possible) in [
        ("--json", "o.xml", ".json"),
        ("--report", "o.pdf", ".html or .htm"),
        ("--markdown", "o.html", ".md or .markdown"),
        ("--residuals", "o.xlsx", ".csv or .parquet"),
        ("--model", "o.yaml", ".toml"),
        ("--urdf", "o.sdf", ".urdf or .xml"),
        ("--trace", "o.json", ".csv"),
        ("--mjcf", "o.urdf", ".xml or .mjcf"),
        ("--next", "o.csv", ".toml"),
    ] {
        let found = &name[1..];
        refused(&arguments(&[option, name]), &[option, name, found, possible]);
    }
    for (command, possible) in [
        (&["excite", "--robot", "robot.urdf", "--scenario", "o.yaml"][..], ".toml"),
        (&["excite", "--robot", "robot.urdf", "--csv", "o.txt"], ".csv"),
        (&["inspect", "a.csv", "--json", "o.txt"], ".json"),
        (&["tables", "--json", "o.txt"], ".json"),
        (&["transfer", "--json", "o.txt"], ".json"),
        (&["prove", "--markdown", "o.txt"], ".md or .markdown"),
        (&["--scenario", "taskA", "--rerun", "off", "--json", "o.txt"], ".json"),
    ] {
        refused(command, &["this option does not write", possible]);
    }
    // A name without an ending, and a device.
    case.sandbox.succeed(&["inspect", "a.csv", "--json", "o"]);
    assert!(case.text("o").starts_with('{'));
}

#[test]
fn the_findings_are_markdown() {
    let case = Case::new(&trio(), &friction);
    let printed = case.diagnose(&["--markdown", "d.md"]);
    assert!(printed.contains("written: d.md"), "{printed}");
    let text = case.text("d.md");
    for part in [
        "# Diagnosis of trio\n",
        "**The model omits 2 effects on shoulder. With these effects, the model explains the recordings.**",
        "Held-out recordings: `c.csv`.",
        "| `shoulder` | viscous friction |",
        "| `shoulder` | `coulomb_friction` | `level` | N m |",
        "## Torque error of each joint",
        "## Simulated motion",
        "## Not testable with these recordings",
        "schema `testbed.diagnosis/1`.\n",
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
    // All rows of a table have as many cells as its head.
    let cells = |line: &str| line.replace("\\|", "").matches('|').count();
    for pair in text.lines().collect::<Vec<_>>().windows(2) {
        if pair.iter().all(|line| line.starts_with('|')) {
            assert_eq!(cells(pair[0]), cells(pair[1]), "{pair:?}");
        }
    }
}
