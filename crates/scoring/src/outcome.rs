//! The outcome of each injected fault in a case.

use serde::{Deserialize, Serialize};

use crate::answer::{Answer, EffectOnJoint, Named};
use crate::intervals::quantile;
use crate::numbers::{ScoredNumber, sized};
use crate::rules::{
    Key, LEAST_SHARE, Name, counted_findings, found, found_or_confusable, is_baseline, is_declared_not_testable,
    same_machine,
};
use crate::tried::Tried;
use crate::truth::Injected;

/// The outcome of an injected fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fate {
    /// Named, on its joint.
    Found,
    /// Named by an equivalent name, with this one as an alternative.
    SameMachine,
    /// An alternative of a finding.
    Covered,
    /// Not named, and declared not testable at its size.
    NotObservable,
    /// Not named, and its joint is unexplained.
    Refused,
    /// Not named, for none of these reasons.
    Missed,
}

/// An injected fault that is not a baseline effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// The case.
    pub case: String,
    /// The catalogue's name.
    pub effect: String,
    /// The joint; `None` for the whole arm.
    pub joint: Option<String>,
    /// Its functional form, if it is not the textbook form.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub form: Option<String>,
    /// Its expressed share.
    pub share: Option<f64>,
    /// The standard deviation of its torque over that of the noise on one sample of its joint's torque; for the whole arm, with
    /// the median noise of the joints.
    pub over_noise: Option<f64>,
    /// Whether it is large enough to be required.
    pub counts: bool,
    /// The outcome.
    pub fate: Fate,
    /// The equivalent name by which it was found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub found_as: Option<Name>,
    /// False names on its joint or on the whole arm, the largest first.
    pub instead: Vec<Name>,
}

impl Fate {
    /// Whether the diagnosis names it, also by an equivalent name.
    pub fn is_found(self) -> bool {
        matches!(self, Self::Found | Self::SameMachine)
    }

    /// Whether the diagnosis names it or lists it as an alternative.
    pub fn is_covered(self) -> bool {
        self.is_found() || self == Self::Covered
    }
}

impl Outcome {
    /// Whether it is required and was not declared not testable.
    pub fn is_asked(&self) -> bool {
        self.counts && self.fate != Fate::NotObservable
    }
}

/// A finding that is neither injected, nor accompanying, nor a baseline effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FalseName {
    /// The case.
    pub case: String,
    /// The catalogue's name.
    pub effect: String,
    /// The joint; `None` for the whole arm.
    pub joint: Option<String>,
    /// Its stated share.
    pub share: f64,
    /// Its stated probability.
    pub probability: Option<f64>,
    /// The injected faults on its joint or on the whole arm.
    #[serde(rename = "concealed_there")]
    pub injected_there: Vec<String>,
    /// Whether an injected fault is one of its alternatives.
    pub admits_the_truth: bool,
}

/// A case with an unexplained joint, or that should have one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OutsideOutcome {
    /// The case.
    pub case: String,
    /// The faults outside the catalogue, with their joints.
    #[serde(rename = "concealed")]
    pub injected: Vec<Name>,
    /// Its largest expressed share.
    pub share: Option<f64>,
    /// Whether such a joint is unexplained.
    pub refused: bool,
    /// The unexplained joints.
    pub unexplained: Vec<String>,
    /// False names in the case.
    pub named: Vec<Name>,
}

/// The results of a case.
#[derive(Clone, Debug, Default)]
pub struct CaseOutcome {
    /// The injected faults of the catalogue that are not baseline effects.
    pub injected: Vec<Outcome>,
    /// The false names that are not baseline.
    pub false_names: Vec<FalseName>,
    /// Whether each baseline effect that is injected was found.
    pub baseline_found: Vec<bool>,
    /// Baseline names that are false.
    pub baseline_false: usize,
    /// Whether only baseline effects are injected.
    pub is_empty: bool,
    /// The fault outside the catalogue.
    pub outside: Option<OutsideOutcome>,
    /// An unexplained joint without a fault outside the catalogue.
    pub refused_without_cause: Option<OutsideOutcome>,
    /// The parameters of right findings.
    pub sizes: Vec<ScoredNumber>,
    /// Probabilities of findings that are not baseline, and whether they are right.
    pub said: Vec<(f64, bool)>,
    /// Probabilities of all findings, and whether they are right.
    pub said_of_all: Vec<(f64, bool)>,
    baseline: &'static [&'static str],
}

impl CaseOutcome {
    /// Whether a parameter belongs to a baseline effect.
    pub fn is_baseline(&self, sized: &ScoredNumber) -> bool {
        self.baseline.contains(&sized.effect.as_str())
    }
}

/// The results of a case. In a case without an answer, nothing is found.
pub fn outcomes(case: &Tried) -> CaseOutcome {
    let truth = &case.truth;
    let empty = Answer::default();
    let answer = &counted_findings(truth, case.answer.as_ref().unwrap_or(&empty));
    let key = Key::new(truth);
    let named = found(answer);
    let covered = found_or_confusable(answer);
    let baseline = |name: &Name| is_baseline(truth, &name.0);
    // The injected faults under the names that findings give them, if these are equivalent names.
    let other_names: Vec<(Name, Name)> = truth
        .of_note()
        .filter_map(|injected| {
            let (given, meant) = (same_machine(truth, injected)?, (injected.name().to_owned(), injected.joint.clone()));
            let finding = answer.findings.iter().find(|finding| name_of(finding) == given)?;
            let admits = |other: &EffectOnJoint| (&other.effect, &other.joint) == (&meant.0, &meant.1);
            (!named.contains(&meant) && finding.confusable_with.iter().any(admits)).then_some((meant, given))
        })
        .collect();
    let is_other_name = |name: &Name| other_names.iter().any(|(_, given)| given == name);
    let mut false_names: Vec<&Named> = answer
        .findings
        .iter()
        .filter(|f| {
            let name = name_of(f);
            !key.allows(&name) && !is_other_name(&name) && !is_baseline(truth, &f.effect)
        })
        .collect();
    false_names.sort_by(|a, b| b.share.total_cmp(&a.share));
    let unexplained: Vec<String> = answer.unexplained.iter().map(|left| left.joint.clone()).collect();
    let mut result = CaseOutcome { baseline: truth.baseline(), ..CaseOutcome::default() };
    result.is_empty = key.unknown.is_empty() && key.known.iter().all(baseline);
    result.baseline_found = key.known.iter().filter(|k| baseline(k)).map(|k| named.contains(k)).collect();
    result.baseline_false = named.iter().filter(|n| !key.allows(n) && baseline(n)).count();
    for name in key.known.iter().filter(|name| !baseline(name)) {
        // Of several faults with the same name, the largest one counts.
        let same = truth.of_note().filter(|c| c.name() == name.0 && c.joint == name.1);
        let Some(injected) = same.max_by(|a, b| share(a).total_cmp(&share(b))) else {
            continue;
        };
        let near = |other: &&&Named| other.joint == name.1 || other.joint.is_none() || name.1.is_none();
        let found_as = other_names.iter().find(|(meant, _)| meant == name);
        let found_as = found_as.map(|(_, given)| given.clone());
        let fate = if named.contains(name) {
            Fate::Found
        } else if found_as.is_some() {
            Fate::SameMachine
        } else if covered.contains(name) {
            Fate::Covered
        } else if is_declared_not_testable(answer, injected) {
            Fate::NotObservable
        } else if name.1.as_ref().is_some_and(|joint| unexplained.contains(joint)) {
            Fate::Refused
        } else {
            Fate::Missed
        };
        result.injected.push(Outcome {
            case: truth.case.clone(),
            effect: name.0.clone(),
            joint: name.1.clone(),
            form: injected.form.clone(),
            share: injected.expressed_share,
            over_noise: over_noise(case, answer, injected),
            counts: injected.expressed_share.is_none_or(|share| share >= LEAST_SHARE),
            fate,
            found_as,
            instead: false_names.iter().filter(near).map(|f| name_of(f)).collect(),
        });
    }
    for finding in &false_names {
        let there = truth.of_note().filter(|c| {
            let name = (c.name().to_owned(), c.joint.clone());
            !baseline(&name) && (c.joint == finding.joint || c.joint.is_none() || finding.joint.is_none())
        });
        let admits = |other: &EffectOnJoint| key.known.contains(&(other.effect.clone(), other.joint.clone()));
        result.false_names.push(FalseName {
            case: truth.case.clone(),
            effect: finding.effect.clone(),
            joint: finding.joint.clone(),
            share: finding.share,
            probability: finding.probability,
            injected_there: there.map(|c| c.name().to_owned()).collect(),
            admits_the_truth: finding.confusable_with.iter().any(admits),
        });
    }
    let verdict = OutsideOutcome {
        case: truth.case.clone(),
        injected: key.unknown.iter().cloned().collect(),
        share: truth
            .injected
            .iter()
            .filter(|c| c.is_outside_the_catalogue())
            .filter_map(|c| c.expressed_share)
            .reduce(f64::max),
        refused: key.unknown.iter().any(|(_, joint)| joint.as_ref().is_some_and(|j| unexplained.contains(j))),
        unexplained,
        named: false_names.iter().map(|f| name_of(f)).collect(),
    };
    if !key.unknown.is_empty() {
        result.outside = Some(verdict);
    } else if !verdict.unexplained.is_empty() {
        result.refused_without_cause = Some(verdict);
    }
    for finding in &answer.findings {
        let name = name_of(finding);
        if key.brought.contains(&name) {
            continue;
        }
        let right = key.known.contains(&name) || is_other_name(&name);
        if let Some(probability) = finding.probability {
            result.said_of_all.push((probability, right));
            if !baseline(&name) {
                result.said.push((probability, right));
            }
        }
        let same = truth.of_note().filter(|c| c.name() == name.0 && c.joint == name.1);
        // Of several faults with the same name, the one with the nearest size counts.
        let nearest = same.map(|injected| sized(truth, injected, finding)).min_by(|a, b| {
            let first = |list: &Vec<ScoredNumber>| list.first().map_or(f64::INFINITY, |sized| sized.error);
            first(a).total_cmp(&first(b))
        });
        result.sizes.extend(nearest.into_iter().flatten());
    }
    result
}

fn name_of(finding: &Named) -> Name {
    (finding.effect.clone(), finding.joint.clone())
}

fn share(injected: &Injected) -> f64 {
    injected.expressed_share.unwrap_or(0.0)
}

/// An effect's torque over the noise on one sample. The standard deviation of a joint's torque is a property of its recordings,
/// which every diagnosis reports.
fn over_noise(case: &Tried, answer: &Answer, injected: &Injected) -> Option<f64> {
    let noise_share = |joint: usize| -> Option<f64> {
        let spread = answer.fit.get(case.joints.get(joint)?)?.torque_std;
        let noise = *case.truth.torque_noise.get(joint)?;
        (spread > 0.0 && noise > 0.0).then(|| noise / spread)
    };
    let hidden = match &injected.joint {
        Some(name) => noise_share(case.joints.iter().position(|joint| joint == name)?)?,
        None => {
            let all: Vec<f64> = (0..case.joints.len()).filter_map(noise_share).collect();
            quantile(&all, 0.5)?
        }
    };
    Some(injected.expressed_share? / hidden)
}
