//! The success of the proposed experiments: confusions before and after.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use crate::answer::{Answer, EffectOnJoint};
use crate::intervals::Counted;
use crate::rules::{Key, Name, counted_findings, found, is_declared_not_testable};
use crate::tried::{Again, Tried};

/// The outcome of a confusion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum After {
    /// The injected effect is named, and the other is neither named nor an alternative.
    Resolved,
    /// The injected effect is named, and the other is still an alternative.
    StillConfused,
    /// The other is named, and the injected effect is not.
    WrongNamed,
    /// Neither is named.
    NeitherNamed,
    /// There is no second diagnosis.
    NoAnswer,
}

/// A finding of a first diagnosis and one of its alternatives, where one of the two is injected.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Confusion {
    /// The case.
    pub case: String,
    /// The finding.
    pub finding: Name,
    /// The alternative.
    pub rival: Name,
    /// Whether the alternative is the injected effect.
    pub rival_is_true: bool,
    /// Whether a motion was proposed for it.
    pub proposed: bool,
    /// The diagnosis' reason for proposing none, without numbers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub because: Option<String>,
    /// The outcome; `None` if the case was not examined.
    pub after: Option<After>,
}

impl Confusion {
    /// The two effects, in the order of their names.
    fn pair(&self) -> [String; 2] {
        let mut pair = [self.finding.0.clone(), self.rival.0.clone()];
        pair.sort();
        pair
    }
}

/// A name in a case.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct InCase {
    /// The case.
    pub case: String,
    /// The name.
    pub name: Name,
}

/// The proposed experiments of a campaign.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Experiments {
    /// Cases diagnosed again.
    pub cases: usize,
    /// All confusions of the first diagnoses in which one effect is injected.
    pub confusions: Vec<Confusion>,
    /// Confusions resolved, of those for which a motion was proposed and recorded.
    pub resolved: Counted,
    /// Confusions resolved, of those without a proposed motion in the same cases.
    pub resolved_unasked: Counted,
    /// Confusions resolved, of all in the same cases, with or without a proposed motion. This figure does not depend on
    /// which confusions the diagnosis selects.
    pub resolved_of_all: Counted,
    /// The most frequent pair of effects in `resolved`, in the order of their names.
    pub most_frequent: Option<[String; 2]>,
    /// `resolved` without this pair.
    pub resolved_of_rarer: Counted,
    /// Effects that the first diagnosis declared not testable and the second names.
    pub unseen_named: Counted,
    /// Injected, and named only in the second diagnosis.
    pub gained: Vec<InCase>,
    /// Injected, and named only in the first diagnosis.
    pub lost: Vec<InCase>,
    /// Named falsely only in the second diagnosis.
    pub false_added: Vec<InCase>,
    /// Named falsely only in the first diagnosis.
    pub false_dropped: Vec<InCase>,
}

/// Compares first and second diagnoses.
pub fn experiments(cases: &[Tried]) -> Experiments {
    let mut all = Experiments::default();
    let mut unseen = Vec::new();
    for case in cases {
        let Some(first) = case.answer.as_ref().map(|first| counted_findings(&case.truth, first)) else {
            continue;
        };
        let first = &first;
        let key = Key::new(&case.truth);
        let second = match &case.again {
            Some(Again::Answer(second)) => Some(counted_findings(&case.truth, second)),
            _ => None,
        };
        let second = second.as_ref();
        all.cases += usize::from(case.again.is_some());
        for mut confusion in confusions(&case.truth.case, first, &key) {
            confusion.after = case.again.as_ref().map(|_| after(&confusion, second, &key));
            all.confusions.push(confusion);
        }
        let Some(second) = second else { continue };
        let (before, now) = (found(first), found(second));
        for injected in case.truth.of_note() {
            let name = (injected.name().to_owned(), injected.joint.clone());
            if !before.contains(&name) && is_declared_not_testable(first, injected) {
                unseen.push(now.contains(&name));
            }
        }
        let list = |names: &mut dyn Iterator<Item = &Name>| -> Vec<InCase> {
            let in_case = |name: &Name| InCase { case: case.truth.case.clone(), name: name.clone() };
            names.map(in_case).collect()
        };
        let is_true = |name: &&Name| key.known.contains(*name);
        let is_false = |name: &&Name| !key.allows(name);
        all.gained.extend(list(&mut now.difference(&before).filter(is_true)));
        all.lost.extend(list(&mut before.difference(&now).filter(is_true)));
        all.false_added.extend(list(&mut now.difference(&before).filter(is_false)));
        all.false_dropped.extend(list(&mut before.difference(&now).filter(is_false)));
    }
    let mut pairs: BTreeMap<[String; 2], usize> = BTreeMap::new();
    for confusion in all.confusions.iter().filter(|c| c.proposed && c.after.is_some()) {
        *pairs.entry(confusion.pair()).or_default() += 1;
    }
    // Of equally frequent pairs, the first one counts.
    all.most_frequent = pairs.into_iter().rev().max_by_key(|&(_, count)| count).map(|(pair, _)| pair);
    let resolved = |counts: &dyn Fn(&Confusion) -> bool| {
        let made = all.confusions.iter().filter(|confusion| counts(confusion));
        Counted::of(made.filter_map(|confusion| Some(confusion.after? == After::Resolved)))
    };
    let is_frequent = |c: &Confusion| all.most_frequent.as_ref() == Some(&c.pair());
    let counted = [
        resolved(&|c| c.proposed),
        resolved(&|c| !c.proposed),
        resolved(&|_| true),
        resolved(&|c| c.proposed && !is_frequent(c)),
    ];
    [all.resolved, all.resolved_unasked, all.resolved_of_all, all.resolved_of_rarer] = counted;
    all.unseen_named = Counted::of(unseen);
    all
}

fn named(other: &EffectOnJoint) -> Name {
    (other.effect.clone(), other.joint.clone())
}

/// The confusions of a first diagnosis.
fn confusions(case: &str, first: &Answer, key: &Key) -> Vec<Confusion> {
    let next = first.next_experiment.clone().unwrap_or_default();
    let proposed: BTreeSet<(Name, Name)> =
        next.separates.iter().map(|pair| (named(&pair.finding), named(&pair.rival))).collect();
    let mut list: Vec<Confusion> = Vec::new();
    for finding in &first.findings {
        let name = (finding.effect.clone(), finding.joint.clone());
        for other in &finding.confusable_with {
            let rival = named(other);
            let (finding_is_true, rival_is_true) = (key.known.contains(&name), key.known.contains(&rival));
            // Two contacts have the same name.
            let is_known = |known: &Confusion| known.finding == name && known.rival == rival;
            if (!finding_is_true && !rival_is_true) || list.iter().any(is_known) {
                continue;
            }
            let is_it =
                |pair: &&crate::answer::NotSeparated| named(&pair.finding) == name && named(&pair.rival) == rival;
            let left = next.not_separated.iter().find(is_it);
            list.push(Confusion {
                case: case.to_owned(),
                proposed: proposed.contains(&(name.clone(), rival.clone())),
                because: left.map(|left| left.kind.clone()),
                finding: name.clone(),
                rival,
                rival_is_true: !finding_is_true,
                after: None,
            });
        }
    }
    list
}

fn after(confusion: &Confusion, second: Option<&Answer>, key: &Key) -> After {
    let Some(second) = second else { return After::NoAnswer };
    let (truth, other) = if confusion.rival_is_true {
        (&confusion.rival, &confusion.finding)
    } else {
        (&confusion.finding, &confusion.rival)
    };
    let names = found(second);
    // If both are injected, both must be named. An effect that accompanies an injected one is not wrong.
    let is_wrong = names.contains(other) && !key.allows(other);
    if !names.contains(truth) {
        return if is_wrong { After::WrongNamed } else { After::NeitherNamed };
    }
    let is = |finding: &&crate::answer::Named, name: &Name| (&finding.effect, &finding.joint) == (&name.0, &name.1);
    let own = second.findings.iter().find(|finding| is(finding, truth));
    let still = own.is_some_and(|own| own.confusable_with.iter().any(|rival| named(rival) == *other));
    let lacks = key.known.contains(other) && !names.contains(other);
    if still || is_wrong || lacks { After::StillConfused } else { After::Resolved }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::truth::Truth;

    fn truth(effects: &str) -> Truth {
        let text = format!(
            r#"{{"case": "case_000", "robot": "r", "seed": 1, "background_friction": false, "torque_noise": [], "concealed": {effects}}}"#
        );
        serde_json::from_str(&text).expect("a truth")
    }

    fn answer(text: &str) -> Answer {
        serde_json::from_str(text).expect("an answer")
    }

    fn tried(second: Option<&str>) -> Tried {
        Tried {
            truth: truth(r#"[{"effect": "viscous_friction", "joint": "a", "coefficient": 1.0}]"#),
            joints: vec!["a".into()],
            answer: Some(answer(
                r#"{"findings": [{"effect": "quadratic_drag", "joint": "a", "confusable_with": [
                    {"effect": "viscous_friction", "joint": "a"}, {"effect": "spring", "joint": "a"}]}],
                   "next_experiment": {"separates": [{"finding": {"effect": "quadratic_drag", "joint": "a"},
                     "rival": {"effect": "viscous_friction", "joint": "a"}}], "not_separated": []}}"#,
            )),
            true_terms: None,
            tracking_over_exact: None,
            tracking_over_exact_without_lag: None,
            wrong_term: None,
            again: second.map(|text| Again::Answer(Box::new(answer(text)))),
        }
    }

    /// A confusion is resolved only if the injected effect is named, the other is not, and neither is an alternative of the
    /// other.
    #[test]
    fn a_confusion_is_resolved_if_only_the_injected_effect_is_named() {
        let viscous =
            |rivals: &str| format!(r#"{{"effect": "viscous_friction", "joint": "a", "confusable_with": [{rivals}]}}"#);
        let drag = r#"{"effect": "quadratic_drag", "joint": "a"}"#;
        let cases = [
            (viscous(""), After::Resolved),
            (viscous(drag), After::StillConfused),
            (format!("{}, {drag}", viscous("")), After::StillConfused),
            (drag.to_owned(), After::WrongNamed),
            (String::new(), After::NeitherNamed),
        ];
        for (findings, expected) in cases {
            let result = experiments(&[tried(Some(&format!(r#"{{"findings": [{findings}]}}"#)))]);
            // Neither the spring nor the drag is injected, so that there is one confusion.
            assert_eq!(result.confusions.len(), 1);
            assert_eq!(result.confusions[0].after, Some(expected), "{findings}");
            assert!(result.confusions[0].proposed && result.confusions[0].rival_is_true);
            let hits = usize::from(expected == After::Resolved);
            assert_eq!((result.resolved.hits, result.resolved.of), (hits, 1));
        }
    }

    /// The figures of all confusions, and of those without the most frequent pair, are given in addition.
    #[test]
    fn figures_are_also_given_without_the_most_frequent_pair() {
        let mut case = tried(Some(r#"{"findings": [{"effect": "viscous_friction", "joint": "a"}]}"#));
        let of = |extra: &str| {
            answer(&format!(
                r#"{{"findings": [{{"effect": "quadratic_drag", "joint": "a", "confusable_with": [{{"effect": "viscous_friction", "joint": "a"}}]}}{extra}],
                   "next_experiment": {{"separates": [{{"finding": {{"effect": "quadratic_drag", "joint": "a"}},
                     "rival": {{"effect": "viscous_friction", "joint": "a"}}}}], "not_separated": []}}}}"#
            ))
        };
        // One more confusion, for which no motion is proposed: an offset that the second diagnosis does not name.
        let offset = truth(r#"[{"effect": "torque_offset", "joint": "a", "offset": 1.0}]"#);
        case.truth.injected.extend(offset.injected);
        case.answer = Some(of(
            r#", {"effect": "torque_offset", "joint": "a", "confusable_with": [{"effect": "spring", "joint": "a"}]}"#,
        ));
        let result = experiments(&[case]);
        let counts = |counted: Counted| (counted.hits, counted.of);
        assert_eq!((counts(result.resolved), counts(result.resolved_unasked)), ((1, 1), (0, 1)));
        assert_eq!(counts(result.resolved_of_all), (1, 2));
        assert_eq!(result.most_frequent, Some(["quadratic_drag".to_owned(), "viscous_friction".to_owned()]));
        assert_eq!(counts(result.resolved_of_rarer), (0, 0));
    }

    /// Names that are gained and lost are listed.
    #[test]
    fn names_gained_and_lost_are_listed() {
        let result = experiments(&[tried(Some(r#"{"findings": [{"effect": "spring", "joint": "a"}]}"#))]);
        let name = |effect: &str| InCase { case: "case_000".into(), name: (effect.into(), Some("a".into())) };
        assert_eq!(result.false_added, [name("spring")]);
        assert_eq!(result.false_dropped, [name("quadratic_drag")]);
        assert!(result.gained.is_empty() && result.lost.is_empty());
        let untried = experiments(&[tried(None)]);
        assert_eq!((untried.cases, untried.resolved.of, untried.confusions.len()), (0, 0, 1));
    }
}
