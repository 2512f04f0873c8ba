//! The paper's tables and its tracking figure, through the built program.
//!
//! Law: what docs/track.md and docs/paper.md claim comes out of `testbed tables`, and the order of the models is the paper's.

use std::sync::OnceLock;

use crate::support::Sandbox;
use serde_json::Value;

/// One run of `testbed tables --json` for all tests of this file.
fn report() -> &'static Value {
    static REPORT: OnceLock<Value> = OnceLock::new();
    REPORT.get_or_init(|| {
        let sandbox = Sandbox::new();
        sandbox.succeed(&["tables", "--today", "--json", "tables.json"]);
        sandbox.json("tables.json")
    })
}

fn numbers(value: &Value) -> Vec<f64> {
    let array = value.as_array().expect("a list");
    array.iter().map(|number| number.as_f64().expect("a number")).collect()
}

/// Errors of the joints and their mean, of `model` after training on `train`.
fn torque_error(train: &[&str], model: &str) -> (Vec<f64>, f64) {
    let tables = report()["tables"].as_array().expect("tables");
    let table = tables.iter().find(|table| table["train"] == serde_json::json!(train)).expect("the table");
    assert_eq!(table["test"], "D");
    let rows = table["rows"].as_array().expect("rows");
    let row = rows.iter().find(|row| row["model"] == model).expect("the row");
    let mse = numbers(&row["mse"]);
    let mean = row["mean"].as_f64().expect("a mean");
    assert!((mean - mse.iter().sum::<f64>() / 6.0).abs() <= 1e-12 * mean);
    (mse, mean)
}

/// RMS tracking error of `model`, joint by joint (rad).
fn tracking(model: &str) -> Vec<f64> {
    let rows = report()["tracking"].as_array().expect("tracking");
    let row = rows.iter().find(|row| row["model"] == model).expect("the row");
    let (rms, max) = (numbers(&row["rms_error_rad"]), numbers(&row["max_error_rad"]));
    assert!(rms.iter().zip(&max).all(|(rms, max)| rms <= max));
    rms
}

/// The mean of joints 1 to 3, which carry the arm.
fn arm_error(model: &str) -> f64 {
    tracking(model)[..3].iter().sum::<f64>() / 3.0
}

/// The figure by which sampling rate, robot and error model were settled. Fails if any of them is off.
#[test]
fn rigid_body_row_is_the_papers() {
    for train in [&["A"][..], &["A", "B", "C"]] {
        let (mse, _) = torque_error(train, "rigid_body");
        for (ours, expected) in mse.iter().zip([0.6203, 46.50, 1.230, 1.218e-6, 1.737e-5, 2.279e-10]) {
            assert!((ours / expected - 1.0).abs() < 5e-3, "{ours} is not {expected}");
        }
    }
}

/// Means after training on A, within bands about the best optimum of the likelihood.
#[test]
fn table_1_is_met() {
    let mean = |model| torque_error(&["A"], model).1;
    assert!((20.0..45.0).contains(&mean("gp")), "{}", mean("gp"));
    assert!((0.9..1.8).contains(&mean("hybrid")), "{}", mean("hybrid"));
    assert!(mean("independent_joint") <= 0.35, "{}", mean("independent_joint"));
    assert!(mean("independent_joint_own_frame") <= 7e-3, "{}", mean("independent_joint_own_frame"));
    assert!(mean("independent_joint_13") <= 0.02, "{}", mean("independent_joint_13"));
    assert!(mean("lagrangian") <= 5e-4, "{}", mean("lagrangian"));
    assert!(mean("lagrangian_only") <= 2e-2, "{}", mean("lagrangian_only"));
}

/// Means after training on A, B and C, likewise.
#[test]
fn table_2_is_met() {
    let mean = |model| torque_error(&["A", "B", "C"], model).1;
    assert!((8.0..20.0).contains(&mean("gp")), "{}", mean("gp"));
    assert!((0.3..0.8).contains(&mean("hybrid")), "{}", mean("hybrid"));
    assert!(mean("independent_joint") <= 0.045, "{}", mean("independent_joint"));
    assert!(mean("independent_joint_own_frame") <= 3e-4, "{}", mean("independent_joint_own_frame"));
    assert!(mean("independent_joint_13") <= 1e-4, "{}", mean("independent_joint_13"));
    assert!(mean("lagrangian") <= 1e-6, "{}", mean("lagrangian"));
    assert!(mean("lagrangian_only") <= 3e-5, "{}", mean("lagrangian_only"));
}

/// Every row that the paper has stands beside ours, and none where it has none.
#[test]
fn the_papers_rows_stand_beside_ours() {
    for table in report()["tables"].as_array().expect("tables") {
        for row in table["rows"].as_array().expect("rows") {
            let ours = ["independent_joint_own_frame", "independent_joint_13", "lagrangian", "lagrangian_only"];
            let ours = ours.iter().any(|model| row["model"] == *model);
            assert_eq!(row["paper"].is_null(), ours);
        }
    }
    let tables = report()["tables"].as_array().expect("tables");
    assert_eq!(tables[0]["rows"][1]["paper"][1], 46.498);
}

/// Figure 4, as bands: tracking error on task D of each model, averaged over joints 1 to 3 (rad).
#[test]
fn tracking_error_of_each_model_is_in_its_band() {
    let bands = [
        ("true", 0.0, 5e-7),
        ("independent_joint_13", 5e-5, 3e-4),
        ("independent_joint", 2e-3, 5e-3),
        ("independent_joint_own_frame", 1e-4, 4e-4),
        ("hybrid", 7e-3, 1.5e-2),
        ("rigid_body", 2.2e-2, 2.7e-2),
        ("gp", 3e-2, 9e-2),
        ("lagrangian", 1e-6, 2e-5),
        ("lagrangian_only", 1e-5, 1e-4),
    ];
    for (model, low, high) in bands {
        let error = arm_error(model);
        assert!((low..=high).contains(&error), "{model}: {error} rad is not in {low} to {high}");
    }
    assert!(tracking("rigid_body").iter().any(|error| *error >= 5e-3));
}

/// The order of the models, which is the paper's claim.
#[test]
fn independent_joint_learning_tracks_best() {
    assert!(arm_error("independent_joint") <= arm_error("rigid_body") / 5.0);
    assert!(arm_error("independent_joint") <= arm_error("hybrid") / 2.0);
    let order = ["true", "independent_joint_13", "independent_joint", "hybrid", "rigid_body", "gp"];
    for pair in order.windows(2) {
        assert!(arm_error(pair[0]) < arm_error(pair[1]), "{} does not beat {}", pair[0], pair[1]);
    }
}
