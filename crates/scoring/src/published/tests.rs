//! Scores of made-up diagnoses against made-up publications.

use serde_json::json;

use super::*;

fn said(effects: &[&str], joint: Option<&str>, parameters: &[(&str, f64)]) -> PublishedEffect {
    let number = |value: f64| PublishedNumber { value, unit: "N m".into() };
    PublishedEffect {
        effects: effects.iter().map(|&effect| effect.to_owned()).collect(),
        joint: joint.map(str::to_owned),
        parameters: parameters.iter().map(|&(key, value)| (key.to_owned(), number(value))).collect(),
        evidence: Evidence::Number,
        place: "a table".into(),
    }
}

fn published(said: Vec<PublishedEffect>) -> Published {
    Published {
        robot: "axis".into(),
        said,
        denied: vec![Denied {
            effects: vec!["payload".into(), "spring".into()],
            joints: Vec::new(),
            place: "a sentence".into(),
        }],
    }
}

fn answer() -> Answer {
    let value = json!({
        "verdict": "partly_explained",
        "findings": [
            {"effect": "friction_asymmetry", "joint": "a", "share": 0.4, "sentence": "a: dry friction",
             "parameters": {"positive": {"value": 17.0, "ci95": [16.0, 18.0]}, "negative": {"value": 23.0, "ci95": [22.0, 24.0]}},
             "confusable_with": [{"effect": "gravity_misalignment", "joint": null}]},
            {"effect": "transmission_coupling", "joint": "b", "other": "a", "parameters": {"viscous": {"value": 0.5, "ci95": [0.4, 0.6]}}},
            {"effect": "payload", "joint": null, "parameters": {"mass": {"value": 2.0, "ci95": [1.0, 3.0]}}},
            {"effect": "torque_ripple", "joint": "b", "parameters": {}},
        ],
        "unexplained": [{"joint": "b"}],
        "not_observable": [
            {"effect": "viscous_friction", "joint": "c", "would_be_seen_above": {"coefficient": 3.0}},
            {"effect": "coulomb_friction", "joint": "c", "would_be_seen_above": {"level": 3.0}},
        ],
        "fit": {"a": {"torque_std": 1.0, "held_out_nrmse_nominal": 0.7, "held_out_nrmse_augmented": 0.1}},
        "rollout": {"a": {"nominal_rms_rad": 0.2, "augmented_rms_rad": 0.01}},
    });
    serde_json::from_value(value).expect("it is a diagnosis")
}

#[test]
fn each_fate_is_distinguished_from_the_others() {
    let published = published(vec![
        said(&["friction_asymmetry"], Some("a"), &[("positive", 16.5), ("negative", 20.0)]),
        said(&["coulomb_friction"], Some("a"), &[("level", 20.4)]),
        said(&["torque_offset"], Some("a"), &[("offset", -3.2)]),
        said(&["gravity_misalignment"], None, &[]),
        said(&["viscous_friction"], Some("c"), &[("coefficient", 2.0)]),
        said(&["viscous_friction"], Some("c"), &[("coefficient", 4.0)]),
        said(&["viscous_friction", "coulomb_friction"], Some("c"), &[]),
        said(&["transmission_coupling"], Some("a"), &[("viscous", 0.8), ("coulomb", 1.0)]),
        said(&["rotor_inertia"], Some("b"), &[]),
        said(&["rotor_inertia"], Some("c"), &[]),
    ]);
    let score = published.score(Some(&answer()), None);
    let fates: Vec<PublishedFate> = score.said.iter().map(|outcome| outcome.fate).collect();
    use PublishedFate::{Confusable, Missed, Named, NotObservable, SameTorque, Unexplained};
    let expected = [
        Named,
        SameTorque,
        SameTorque,
        Confusable,
        NotObservable,
        Missed,
        NotObservable,
        SameTorque,
        Unexplained,
        Missed,
    ];
    assert_eq!(fates, expected);
    assert_eq!(score.said[2].sentences, ["a: dry friction"]);
    let numbers = |k: usize| &score.said[k].numbers;
    assert!(numbers(0)[0].covered && !numbers(0)[1].covered);
    assert_eq!(numbers(0)[0].parameter, "positive");
    assert!((numbers(0)[1].difference.expect("a number") - 0.15).abs() < 1e-12);
    // (17 + 23) / 2 and (17 − 23) / 2, ± √2 / 2.
    let (level, offset) = (&numbers(1)[0], &numbers(2)[0]);
    assert_eq!((level.found, offset.found), (Some(20.0), Some(-3.0)));
    assert!((level.ci95[1].expect("a bound") - 20.0 - 0.5_f64.sqrt()).abs() < 1e-12);
    assert!(level.covered && offset.covered);
    assert!(offset.difference.expect("a number") > 0.0);
    // A parameter that the finding does not have has no found value.
    assert_eq!(numbers(7)[0].found, Some(0.5));
    assert_eq!((numbers(7)[1].found, numbers(7)[1].covered), (None, false));
    assert_eq!(score.held_out["a"].diagnosed, Some(0.1));
    assert!((score.rollout["a"].diagnosed - 0.01).abs() < 1e-12);
}

#[test]
fn an_unpublished_finding_is_false_only_if_it_is_excluded() {
    let score = published(vec![said(&["coulomb_friction"], Some("a"), &[])]).score(Some(&answer()), None);
    let besides: Vec<(&str, bool)> =
        score.besides.iter().map(|besides| (besides.name.0.as_str(), besides.contradicted_by.is_some())).collect();
    let expected = [("transmission_coupling", false), ("payload", true), ("torque_ripple", false)];
    assert_eq!(besides, expected);
}

#[test]
fn an_offset_and_coulomb_friction_are_asymmetric_friction() {
    let value = json!({"findings": [
        {"effect": "torque_offset", "joint": "a", "parameters": {"offset": {"value": -3.0, "ci95": [-4.0, -2.0]}}},
        {"effect": "coulomb_friction", "joint": "a", "parameters": {"level": {"value": 20.0, "ci95": [20.0, 20.0]}}},
    ]});
    let answer: Answer = serde_json::from_value(value).expect("it is a diagnosis");
    let published =
        published(vec![said(&["friction_asymmetry"], Some("a"), &[("positive", 17.5), ("negative", 25.0)])]);
    let score = published.score(Some(&answer), None);
    assert_eq!(score.said[0].fate, PublishedFate::SameTorque);
    let found: Vec<Option<f64>> = score.said[0].numbers.iter().map(|number| number.found).collect();
    assert_eq!(found, [Some(17.0), Some(23.0)]);
    assert!(score.besides.is_empty(), "{:?}", score.besides);
}

#[test]
fn without_an_answer_everything_is_missed() {
    let published = published(vec![said(&["spring"], Some("a"), &[("stiffness", 1.0)])]);
    let score = published.score(None, None);
    assert_eq!((score.verdict, score.said[0].fate), (None, PublishedFate::Missed));
    assert_eq!(published.terms(), [("spring".to_owned(), Some("a".to_owned()))]);
}
