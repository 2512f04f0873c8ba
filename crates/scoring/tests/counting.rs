//! What counts as right, covered, not observable, refused and false, on cases made by hand.

use scoring::{Answer, Fate, Score, Tried, Truth, score, true_terms, wrong_term};
use serde_json::{Value, json};

fn truth(concealed: Value) -> Truth {
    let text = json!({"case": "case_000", "robot": "panda", "seed": 1, "concealed": concealed,
        "background_friction": false, "torque_noise": [0.1, 0.2]});
    serde_json::from_value(text).expect("a truth")
}

fn answer(findings: Value, unexplained: Value, not_observable: Value) -> Answer {
    let fit = json!({"torque_std": 4.0, "held_out_nrmse_nominal": 0.4, "held_out_nrmse_augmented": 0.1, "held_out_nrmse_learned": 0.2});
    serde_json::from_value(json!({"findings": findings, "unexplained": unexplained,
        "not_observable": not_observable, "fit": {"a": fit, "b": fit}}))
    .expect("a diagnosis")
}

fn scored(concealed: Value, answer: Answer) -> Score {
    score(&[Tried {
        truth: truth(concealed),
        joints: vec!["b".into(), "a".into()],
        true_terms: Some(answer.clone()),
        wrong_term: None,
        tracking_over_exact: None,
        tracking_over_exact_without_lag: None,
        again: None,
        answer: Some(answer),
    }])
}

fn finding(effect: &str, joint: &str, rivals: Value) -> Value {
    json!({"effect": effect, "joint": joint, "probability": 0.9, "share": 0.1, "parameters": {}, "confusable_with": rivals})
}

fn backlash() -> Value {
    json!([{"effect": "backlash", "joint": "a", "halfgap": 0.001, "expressed_share": 0.05}])
}

#[test]
fn an_effect_is_found_covered_declared_unseen_refused_or_missed() {
    let rival = json!([{"effect": "backlash", "joint": "a"}]);
    let unseen = |above: Value| json!([{"effect": "backlash", "joint": "a", "would_be_seen_above": above}]);
    let refused = json!([{"joint": "a"}]);
    let none = || json!([]);
    for (findings, unexplained, not_observable, fate) in [
        (json!([finding("backlash", "a", none())]), none(), none(), Fate::Found),
        (json!([finding("spring", "a", rival)]), none(), none(), Fate::Covered),
        (none(), none(), unseen(json!({"halfgap": 0.002})), Fate::NotObservable),
        (none(), none(), unseen(json!({})), Fate::NotObservable),
        (none(), none(), unseen(json!({"halfgap": 0.0005})), Fate::Missed),
        (none(), refused, none(), Fate::Refused),
        (json!([finding("backlash", "b", none())]), none(), none(), Fate::Missed),
    ] {
        let score = scored(backlash(), answer(findings, unexplained, not_observable));
        assert_eq!(score.concealed.len(), 1);
        assert_eq!(score.concealed[0].fate, fate);
        // The joint's own noise, .2 N m of 4 N m: joints of the truth are in the arm's order.
        let over = score.concealed[0].over_noise.expect("the noise is known");
        assert!((over - 1.0).abs() < 1e-12, "{over}");
        let family = &score.families["backlash"];
        let asked = if fate == Fate::NotObservable {
            None
        } else {
            Some(f64::from(u8::from(fate == Fate::Found)))
        };
        let expected = if score.false_names.iter().any(|name| name.effect == "backlash") {
            Some(0.0)
        } else {
            asked
        };
        assert_eq!(family.f1, expected);
    }
}

/// An offset beside dry friction and friction that differs by direction are one machine: either name is right if it admits the other.
#[test]
fn another_name_of_the_same_machine_is_right() {
    let truth = |offset: f64| {
        json!([{"effect": "coulomb_friction", "joint": "a", "level": 1.0},
            {"effect": "torque_offset", "joint": "a", "offset": offset, "expressed_share": 0.05}])
    };
    let rival = json!([{"effect": "torque_offset", "joint": "a"}]);
    let named = |rivals: Value| {
        answer(
            json!([finding("friction_asymmetry", "a", rivals)]),
            json!([]),
            json!([]),
        )
    };
    let score = scored(truth(0.5), named(rival.clone()));
    assert_eq!(score.concealed[0].fate, Fate::SameMachine);
    assert_eq!((score.macro_f1, score.macro_f1_strict), (Some(1.0), Some(0.0)));
    assert!(score.false_names.is_empty());
    let from = |effect: usize, onset: f64| {
        let mut later = truth(0.5);
        later[effect]["onset"] = json!(onset);
        later
    };
    assert_eq!(
        scored(from(1, 30.0), named(rival.clone())).concealed[0].fate,
        Fate::SameMachine
    );
    // One that is not admitted, would push by itself, or is there before the friction is another machine.
    for score in [
        scored(truth(0.5), named(json!([]))),
        scored(truth(1.5), named(rival.clone())),
        scored(from(0, 30.0), named(rival)),
    ] {
        assert!(score.concealed[0].fate != Fate::SameMachine);
        assert_eq!((score.macro_f1, score.false_names.len()), (Some(0.0), 1));
    }
}

#[test]
fn small_effects_are_not_asked_for_and_not_false() {
    let small = json!([{"effect": "spring", "joint": "a", "stiffness": 1.0, "expressed_share": 0.01}]);
    let found = answer(json!([finding("spring", "a", json!([]))]), json!([]), json!([]));
    let score = scored(small, found);
    assert_eq!((score.macro_f1, score.false_names.len()), (None, 0));
    assert_eq!(score.families["spring"].too_small_found, 1);
    assert_eq!(score.plain.found, 1);
}

#[test]
fn what_is_brought_is_neither_right_nor_wrong_and_the_rest_is_false() {
    let stribeck = json!([{"effect": "stribeck_friction", "joint": "a", "breakaway": 2.0, "coulomb": 1.0, "expressed_share": 0.1}]);
    let list = json!([
        finding("coulomb_friction", "a", json!([])),
        finding("viscous_friction", "a", json!([])),
        finding("torque_offset", "a", json!([]))
    ]);
    let score = scored(stribeck, answer(list, json!([]), json!([])));
    assert_eq!(score.ordinary_false, 1);
    assert_eq!(score.false_names.len(), 1);
    assert_eq!(score.false_names[0].concealed_there, ["stribeck_friction"]);
    assert_eq!(score.confusion["stribeck_friction"]["torque_offset"], 1);
    assert!(!score.confusion.contains_key("nothing there"));
    assert_eq!(score.calibration.bins[0].right.of, 1);
}

#[test]
fn numbers_are_compared_in_parts_of_the_truth() {
    let concealed = json!([{"effect": "torque_scale", "joint": "a", "factor": 1.2, "expressed_share": 0.2},
        {"effect": "coulomb_friction", "joint": "b", "level": 2.0}]);
    let number = |value: f64, low: Option<f64>, high: f64| json!({"value": value, "ci95": [low, high]});
    let mut scale = finding("torque_scale", "a", json!([]));
    scale["parameters"] = json!({"factor": number(1.22, None, 1.3)});
    let mut level = finding("coulomb_friction", "b", json!([]));
    level["parameters"] = json!({"level": number(2.2, Some(2.1), 2.3)});
    let score = scored(concealed, answer(json!([scale, level]), json!([]), json!([])));
    assert_eq!(score.sizes.len(), 2);
    let of = |effect: &str| {
        score
            .sizes
            .iter()
            .find(|sized| sized.effect == effect)
            .expect("it is scored")
    };
    assert!((of("torque_scale").error - 0.1).abs() < 1e-9 && of("torque_scale").covered);
    assert!((of("coulomb_friction").error - 0.1).abs() < 1e-9 && !of("coulomb_friction").covered);
    // An interval that is open at both ends holds nothing.
    let mut open = finding("torque_scale", "a", json!([]));
    open["parameters"] = json!({"factor": {"value": 1.2, "ci95": [null, null]}});
    let concealed = json!([{"effect": "torque_scale", "joint": "a", "factor": 1.2, "expressed_share": 0.2}]);
    let wide = scored(concealed, answer(json!([open]), json!([]), json!([])));
    assert_eq!((wide.intervals.hits, wide.intervals.of), (0, 1));
    // What is ordinary is not among the figures asked for.
    assert_eq!((score.main_parameters.count, score.intervals.of), (1, 1));
}

#[test]
fn outside_the_catalogue_is_refused_on_its_joint_or_not() {
    let outside = || json!([{"effect": "dead_band_unknown", "joint": "a", "expressed_share": 0.2}]);
    let refused = scored(outside(), answer(json!([]), json!([{"joint": "a"}]), json!([])));
    assert_eq!(
        (refused.outside_refused.hits, refused.outside_with_a_wrong_name.hits),
        (1, 0)
    );
    assert_eq!(refused.over_true_terms.count, 0);
    let named = answer(
        json!([finding("spring", "b", json!([]))]),
        json!([{"joint": "b"}]),
        json!([]),
    );
    let named = scored(outside(), named);
    assert_eq!(
        (named.outside_refused.hits, named.outside_with_a_wrong_name.hits),
        (0, 1)
    );
    assert_eq!(named.confusion["outside the catalogue"]["spring"], 1);
    let empty = scored(json!([]), answer(json!([]), json!([{"joint": "b"}]), json!([])));
    assert_eq!(
        (empty.refused_without_cause.hits, empty.empty_with_a_false_name.of),
        (1, 1)
    );
    assert_eq!(empty.over_true_terms.median, Some(1.0));
}

/// No answer is no merit: nothing is found, and no empty case is clean for it. What is declared not observable is not covered, strictly.
#[test]
fn no_answer_and_no_claim_are_no_merit() {
    let tried = |concealed: Value, answer: Option<Answer>| Tried {
        truth: truth(concealed),
        joints: vec!["b".into(), "a".into()],
        answer,
        true_terms: None,
        wrong_term: None,
        tracking_over_exact: None,
        tracking_over_exact_without_lag: None,
        again: None,
    };
    let silent = score(&[tried(json!([]), None), tried(backlash(), None)]);
    assert_eq!((silent.empty, silent.empty_with_a_false_name.of), (1, 0));
    assert_eq!((silent.refused_without_cause.of, silent.macro_f1), (0, Some(0.0)));
    assert_eq!(silent.unanswered.len(), 2);
    let unseen = json!([{"effect": "backlash", "joint": "a", "would_be_seen_above": {}}]);
    let declared = score(&[tried(backlash(), Some(answer(json!([]), json!([]), unseen)))]);
    assert_eq!((declared.covered.of, declared.covered_strict.of), (0, 1));
    assert_eq!(declared.covered_strict.hits, 0);
}

#[test]
fn a_wrong_term_is_none_of_the_true_ones_nor_a_part_of_them() {
    let truth = truth(json!([{"effect": "coulomb_friction", "joint": "a", "level": 2.0},
        {"effect": "load_dependent_friction", "joint": "a", "gain": 0.1, "expressed_share": 0.1},
        {"effect": "spring", "joint": "a", "stiffness": 3.0, "expressed_share": 0.3},
        {"effect": "dead_band_unknown", "joint": "b", "expressed_share": 0.4}]));
    assert_eq!(true_terms(&truth).len(), 3);
    for number in 0..20 {
        let wrong = wrong_term(&truth, number).expect("something is concealed");
        assert_eq!(wrong.instead_of.0, "spring");
        assert_eq!(wrong.terms.len(), 3);
        assert!(!["spring", "load_dependent_friction", "coulomb_friction"].contains(&wrong.wrong.0.as_str()));
        assert_eq!(wrong.wrong.1.as_deref(), Some("a"));
    }
}
