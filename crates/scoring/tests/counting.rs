//! Which answers count as right, covered, not testable, refused and false, in made-up cases.

use scoring::{Answer, Fate, Score, Tried, Truth, score, true_terms, wrong_term};
use serde_json::{Value, json};

fn truth(injected: Value) -> Truth {
    let text = json!({"case": "case_000", "robot": "panda", "seed": 1, "concealed": injected,
        "background_friction": false, "torque_noise": [0.1, 0.2]});
    serde_json::from_value(text).expect("a truth")
}

fn answer(findings: Value, unexplained: Value, not_observable: Value) -> Answer {
    let fit = json!({"torque_std": 4.0, "held_out_nrmse_nominal": 0.4, "held_out_nrmse_augmented": 0.1, "held_out_nrmse_learned": 0.2});
    serde_json::from_value(json!({"findings": findings, "unexplained": unexplained,
        "not_observable": not_observable, "fit": {"a": fit, "b": fit}}))
    .expect("a diagnosis")
}

fn scored(injected: Value, answer: Answer) -> Score {
    score(&[Tried {
        truth: truth(injected),
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
        assert_eq!(score.injected.len(), 1);
        assert_eq!(score.injected[0].fate, fate);
        // The joint's own noise is 0.2 N m of 4 N m, because the joints of the ground truth are in the arm's order.
        let over = score.injected[0].over_noise.expect("the noise is known");
        assert!((over - 1.0).abs() < 1e-12, "{over}");
        let family = &score.families["backlash"];
        let asked = if fate == Fate::NotObservable { None } else { Some(f64::from(u8::from(fate == Fate::Found))) };
        let expected = if score.false_names.iter().any(|name| name.effect == "backlash") { Some(0.0) } else { asked };
        assert_eq!(family.f1, expected);
    }
}

/// An offset with dry friction equals friction that differs by direction: either name is right if it lists the other.
#[test]
fn an_equivalent_name_is_right() {
    let truth = |offset: f64| {
        json!([{"effect": "coulomb_friction", "joint": "a", "level": 1.0},
            {"effect": "torque_offset", "joint": "a", "offset": offset, "expressed_share": 0.05}])
    };
    let rival = json!([{"effect": "torque_offset", "joint": "a"}]);
    let named = |rivals: Value| answer(json!([finding("friction_asymmetry", "a", rivals)]), json!([]), json!([]));
    let score = scored(truth(0.5), named(rival.clone()));
    assert_eq!(score.injected[0].fate, Fate::SameMachine);
    assert_eq!((score.macro_f1, score.macro_f1_strict), (Some(1.0), Some(0.0)));
    assert!(score.false_names.is_empty());
    let from = |effect: usize, onset: f64| {
        let mut later = truth(0.5);
        later[effect]["onset"] = json!(onset);
        later
    };
    assert_eq!(scored(from(1, 30.0), named(rival.clone())).injected[0].fate, Fate::SameMachine);
    // Not equivalent: the other is not listed, the offset alone moves the joint, or it acts before the friction.
    for score in [
        scored(truth(0.5), named(json!([]))),
        scored(truth(1.5), named(rival.clone())),
        scored(from(0, 30.0), named(rival)),
    ] {
        assert!(score.injected[0].fate != Fate::SameMachine);
        assert_eq!((score.macro_f1, score.false_names.len()), (Some(0.0), 1));
    }
}

#[test]
fn effects_with_a_small_share_are_neither_required_nor_false() {
    let small = json!([{"effect": "spring", "joint": "a", "stiffness": 1.0, "expressed_share": 0.01}]);
    let found = answer(json!([finding("spring", "a", json!([]))]), json!([]), json!([]));
    let score = scored(small, found);
    assert_eq!((score.macro_f1, score.false_names.len()), (None, 0));
    assert_eq!(score.families["spring"].too_small_found, 1);
    assert_eq!(score.plain.found, 1);
}

#[test]
fn accompanying_effects_are_neither_right_nor_wrong() {
    let stribeck = json!([{"effect": "stribeck_friction", "joint": "a", "breakaway": 2.0, "coulomb": 1.0, "expressed_share": 0.1}]);
    let list = json!([
        finding("coulomb_friction", "a", json!([])),
        finding("viscous_friction", "a", json!([])),
        finding("torque_offset", "a", json!([]))
    ]);
    let score = scored(stribeck, answer(list, json!([]), json!([])));
    assert_eq!(score.baseline_false, 1);
    assert_eq!(score.false_names.len(), 1);
    assert_eq!(score.false_names[0].injected_there, ["stribeck_friction"]);
    assert_eq!(score.confusion["stribeck_friction"]["torque_offset"], 1);
    assert!(!score.confusion.contains_key("nothing there"));
    assert_eq!(score.calibration.bins[0].right.of, 1);
}

#[test]
fn parameter_errors_are_relative_to_the_truth() {
    let injected = json!([{"effect": "torque_scale", "joint": "a", "factor": 1.2, "expressed_share": 0.2},
        {"effect": "coulomb_friction", "joint": "b", "level": 2.0}]);
    let number = |value: f64, low: Option<f64>, high: f64| json!({"value": value, "ci95": [low, high]});
    let mut scale = finding("torque_scale", "a", json!([]));
    scale["parameters"] = json!({"factor": number(1.22, None, 1.3)});
    let mut level = finding("coulomb_friction", "b", json!([]));
    level["parameters"] = json!({"level": number(2.2, Some(2.1), 2.3)});
    let score = scored(injected, answer(json!([scale, level]), json!([]), json!([])));
    assert_eq!(score.sizes.len(), 2);
    let of = |effect: &str| score.sizes.iter().find(|sized| sized.effect == effect).expect("it is scored");
    assert!((of("torque_scale").error - 0.1).abs() < 1e-9 && of("torque_scale").covered);
    assert!((of("coulomb_friction").error - 0.1).abs() < 1e-9 && !of("coulomb_friction").covered);
    // An interval that is open at both ends contains no value.
    let mut open = finding("torque_scale", "a", json!([]));
    open["parameters"] = json!({"factor": {"value": 1.2, "ci95": [null, null]}});
    let injected = json!([{"effect": "torque_scale", "joint": "a", "factor": 1.2, "expressed_share": 0.2}]);
    let wide = scored(injected, answer(json!([open]), json!([]), json!([])));
    assert_eq!((wide.intervals.hits, wide.intervals.of), (0, 1));
    // Baseline effects are not in the required figures.
    assert_eq!((score.main_parameters.count, score.intervals.of), (1, 1));
}

#[test]
fn outside_the_catalogue_is_refused_on_its_joint_or_not() {
    let outside = || json!([{"effect": "dead_band_unknown", "joint": "a", "expressed_share": 0.2}]);
    let refused = scored(outside(), answer(json!([]), json!([{"joint": "a"}]), json!([])));
    assert_eq!((refused.outside_refused.hits, refused.outside_with_a_wrong_name.hits), (1, 0));
    assert_eq!(refused.over_true_terms.count, 0);
    let named = answer(json!([finding("spring", "b", json!([]))]), json!([{"joint": "b"}]), json!([]));
    let named = scored(outside(), named);
    assert_eq!((named.outside_refused.hits, named.outside_with_a_wrong_name.hits), (0, 1));
    assert_eq!(named.confusion["outside the catalogue"]["spring"], 1);
    let empty = scored(json!([]), answer(json!([]), json!([{"joint": "b"}]), json!([])));
    assert_eq!((empty.refused_without_cause.hits, empty.empty_with_a_false_name.of), (1, 1));
    assert_eq!(empty.over_true_terms.median, Some(1.0));
}

/// Without an answer, no effect is found, and an empty case is not free of false names. Strictly, an effect declared not
/// testable is not covered.
#[test]
fn no_answer_counts_as_missed() {
    let tried = |injected: Value, answer: Option<Answer>| Tried {
        truth: truth(injected),
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
fn a_wrong_term_is_neither_a_true_one_nor_a_part_of_one() {
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

/// A case whose URDF is wrong everywhere by `sigma`, with its answer.
fn tried(name: &str, injected: Value, sigma: f64, findings: Value) -> Tried {
    let answer = answer(findings, json!([]), json!([]));
    let mut truth = truth(injected);
    (truth.case, truth.urdf_sigma) = (name.to_owned(), Some(sigma));
    Tried {
        truth,
        joints: vec!["b".into(), "a".into()],
        true_terms: None,
        wrong_term: None,
        tracking_over_exact: None,
        tracking_over_exact_without_lag: None,
        again: None,
        answer: Some(answer),
    }
}

/// If the URDF is wrong everywhere, inertial parameters are a baseline effect, and the name counts for the wrong link.
#[test]
fn inertials_count_as_a_wrong_link() {
    let link = || json!([{"effect": "link_inertial_error", "joint": "a", "relative": 0.3, "expressed_share": 0.1}]);
    let arm = json!({"effect": "inertial_parameters", "joint": null, "share": 0.2, "probability": 0.9});
    let on = |joint: &str| json!([finding("inertial_parameters", joint, json!([]))]);
    let own = || json!([{"effect": "inertial_parameters", "joint": "a", "mass": 2.0, "expressed_share": 0.1}]);
    for (injected, sigma, findings, found, false_names) in [
        (own(), 0.1, on("a"), 1, 0),
        (own(), 0.0, on("a"), 1, 0),
        (own(), 0.0, on("b"), 0, 1),
        (link(), 0.1, on("a"), 1, 0),
        (link(), 0.1, json!([arm]), 1, 0),
        (link(), 0.1, on("b"), 0, 0),
        (json!([]), 0.1, on("b"), 0, 0),
        // If the URDF is exact, the name is false, except for a link whose parameters differ in other ways than by a common
        // factor.
        (json!([]), 0.0, on("b"), 0, 1),
        (link(), 0.0, on("a"), 0, 1),
        (
            json!([{"effect": "link_inertial_error", "joint": "a", "relative": 0.3, "form": "moved", "expressed_share": 0.1}]),
            0.0,
            on("a"),
            1,
            0,
        ),
    ] {
        let score = score(&[tried("case_000", injected, sigma, findings.clone())]);
        let counts = |score: &Score| (score.strict.right.hits, score.strict.false_names);
        assert_eq!(counts(&score), (found, false_names), "{sigma} {findings}");
        assert_eq!((score.plain.found, score.plain.false_in_all()), (found, false_names));
        assert_eq!(score.false_names.len(), false_names);
    }
}

/// A common factor of all inertials that is not larger than the error of each inertial is a part of the URDF's error.
#[test]
fn inertials_of_the_whole_arm_count_as_a_small_common_factor() {
    let scale =
        |factor: f64| json!([{"effect": "inertial_scale", "joint": null, "factor": factor, "expressed_share": 0.1}]);
    let arm = || json!([{"effect": "inertial_parameters", "joint": null, "share": 0.2, "probability": 0.9}]);
    let link = || json!([finding("inertial_parameters", "a", json!([]))]);
    for (factor, sigma, findings, found) in [
        (1.2, 0.1, arm(), 1),
        (0.8, 0.1, arm(), 1),
        (1.2, 0.1, link(), 0),
        (1.2, 0.03, arm(), 0),
        (1.2, 0.1, json!([]), 0),
    ] {
        let score = score(&[tried("case_000", scale(factor), sigma, findings)]);
        assert_eq!(score.strict.right.hits, found, "{factor} {sigma}");
        // The plain count has only the rule for wrong links.
        assert_eq!((score.plain.found, score.plain.false_in_all()), (0, 0));
    }
}

/// The small effects of real joints are neither required nor false. True parameters beside a wrong torque constant are in
/// the unit of the reported torque.
#[test]
fn minor_effects_are_not_scored() {
    let small = json!([
        {"effect": "stribeck_friction", "joint": "a", "coulomb": 0.0, "breakaway": 0.1, "velocity": 0.1, "minor": true},
        {"effect": "torque_offset", "joint": "b", "offset": 0.1, "minor": true},
        {"effect": "torque_scale", "joint": "a", "factor": 1.25, "minor": true},
        {"effect": "quadratic_drag", "joint": "a", "coefficient": 4.0, "expressed_share": 0.1}
    ]);
    let sized = |effect: &str, joint: &str, key: &str, value: f64| {
        let mut finding = finding(effect, joint, json!([]));
        finding["parameters"][key] = json!({"value": value, "ci95": [0.98 * value, 1.02 * value]});
        finding
    };
    let named = json!([
        sized("stribeck_friction", "a", "breakaway", 3.0),
        finding("coulomb_friction", "a", json!([])),
        finding("friction_asymmetry", "b", json!([])),
        finding("torque_scale", "a", json!([])),
        sized("quadratic_drag", "a", "coefficient", 5.0)
    ]);
    let scored = score(&[tried("case_000", small.clone(), 0.0, named)]);
    assert_eq!((scored.injected.len(), scored.false_names.len(), scored.baseline_false), (1, 0, 0));
    assert_eq!((scored.strict.macro_f1, scored.macro_f1), (Some(1.0), Some(1.0)));
    assert_eq!((scored.intervals.hits, scored.intervals.of), (1, 1));
    assert!(scored.sizes[0].error < 1e-12 && scored.sizes.len() == 1, "{:?}", scored.sizes);
    let case = tried("case_000", small.clone(), 0.0, json!([]));
    assert_eq!(true_terms(&case.truth), [("quadratic_drag".to_owned(), Some("a".to_owned()))]);
    assert!(wrong_term(&case.truth, 0).is_some_and(|wrong| wrong.instead_of.0 == "quadratic_drag"));
    // A case with only small effects is empty.
    let three: Vec<Value> = small.as_array().expect("a list")[..3].to_vec();
    let empty = score(&[tried("case_000", json!(three), 0.0, json!([]))]);
    assert_eq!((empty.empty, empty.plain.clean), (1, 1));
}

/// Strictly, an effect with a wrong size is not found, and one declared not testable is missed; URDFs are grouped by error.
#[test]
fn the_strict_figure_requires_sizes_and_is_grouped_by_urdf() {
    let drag = || json!([{"effect": "quadratic_drag", "joint": "a", "coefficient": 4.0, "expressed_share": 0.015}]);
    let named = |value: f64| {
        let mut finding = finding("quadratic_drag", "a", json!([]));
        finding["parameters"]["coefficient"] = json!({"value": value, "ci95": [0.9 * value, 1.1 * value]});
        finding
    };
    let score = score(&[
        tried("case_000", drag(), 0.0, json!([named(4.7)])),
        tried("case_001", drag(), 0.03, json!([named(4.9)])),
        tried("case_002", drag(), 0.1, json!([named(4.0), finding("spring", "b", json!([]))])),
        tried("case_003", drag(), 0.3, json!([finding("spring", "a", json!([]))])),
    ]);
    let groups: Vec<_> = score.by_urdf.iter().map(|group| (group.cases, group.strict.macro_f1)).collect();
    assert_eq!(groups, [(1, Some(1.0)), (2, Some(0.5)), (1, Some(0.0))]);
    let [exact, some, much] = [0, 1, 2].map(|k| &score.by_urdf[k].strict);
    assert_eq!((some.right.hits, some.right.of, some.wrong_size, some.false_names), (1, 2, 1, 1));
    assert_eq!((some.cases_with_a_false_name.hits, some.cases_with_a_false_name.of), (1, 2));
    assert_eq!((exact.intervals.hits, some.intervals.hits, some.intervals.of), (0, 1, 2));
    assert_eq!((much.right.of, much.false_names), (1, 1));
    // 2 × 2 of 4 asked, 2 right and 1 of another size.
    assert_eq!(score.strict.macro_f1, Some(4.0 / 7.0));
    assert_eq!(score.by_urdf[1].macro_f1, Some(1.0));
    assert_eq!(score.targets[0].figure, score.strict.macro_f1);
}
