//! The rules of the score: right names, accompanying effects, baseline effects, effects that are not testable.

use std::collections::BTreeSet;

use crate::answer::{Answer, NotTestable};
use crate::catalogue::{ALL_INERTIALS, INERTIALS, LINK_INERTIAL, brings, is_dry_friction, neutral};
use crate::numbers::truth_value;
use crate::truth::{Injected, Truth};

/// An effect's name and its joint; `None` is the whole arm.
pub type Name = (String, Option<String>);

/// The expressed share below which an effect is not required.
pub const LEAST_SHARE: f64 = 0.015;

/// A common factor of all inertials is a part of the URDF's error if it is within this many standard deviations of that
/// error.
const WITHIN_THE_URDF: f64 = 3.0;

/// Whether it is a baseline effect of the machine, which is scored separately.
pub fn is_baseline(truth: &Truth, effect: &str) -> bool {
    truth.baseline().contains(&effect)
}

/// The equivalent name of the fault `injected`, which no recording distinguishes from its own; `None` if there is none. Dry
/// friction that depends on the direction is the sum of a level and a constant, ½ (F₊ + F₋) sgn q̇ + ½ (F₊ − F₋), in motion
/// and, as its two limits, at rest.
pub fn same_machine(truth: &Truth, injected: &Injected) -> Option<Name> {
    let other = match injected.name() {
        "torque_offset" => "friction_asymmetry",
        "friction_asymmetry" => "torque_offset",
        _ => return None,
    };
    let number = |of: &Injected, key: &str| of.parameters.get(key).and_then(serde_json::Value::as_f64);
    // Another kind of friction on the joint makes the two names distinguishable. An onset of the constant does not, if the
    // level acts by then.
    let beside: Vec<&Injected> = truth
        .of_note()
        .filter(|c| c.joint == injected.joint && is_dry_friction(c.name()) && c.name() != injected.name())
        .collect();
    let is_plain = injected.form.is_none();
    let same = match (injected.name(), beside.as_slice()) {
        ("friction_asymmetry", []) => is_plain,
        // A constant larger than the level would move the joint by itself.
        ("torque_offset", [friction]) => {
            let (offset, level) = (number(injected, "offset")?, number(friction, "level")?);
            let start = |of: &Injected| of.onset.unwrap_or(f64::NEG_INFINITY);
            is_plain
                && friction.name() == "coulomb_friction"
                && friction.form.is_none()
                && offset.abs() < level
                && start(friction) <= start(injected)
        }
        _ => false,
    };
    same.then(|| (other.to_owned(), injected.joint.clone()))
}

/// The names that are right in a case.
#[derive(Clone, Debug, Default)]
pub struct Key {
    /// Injected faults in the catalogue.
    pub known: BTreeSet<Name>,
    /// Injected faults outside the catalogue.
    pub unknown: BTreeSet<Name>,
    /// Effects that accompany an injected fault, and the small effects of real joints. Naming them is neither right nor
    /// wrong.
    pub brought: BTreeSet<Name>,
}

impl Key {
    /// The names that are right in the case of `truth`.
    pub fn new(truth: &Truth) -> Self {
        let (mut known, mut unknown) = (BTreeSet::new(), BTreeSet::new());
        for injected in truth.of_note() {
            let set = if injected.is_outside_the_catalogue() { &mut unknown } else { &mut known };
            set.insert((injected.name().to_owned(), injected.joint.clone()));
        }
        let small: BTreeSet<Name> = truth
            .injected
            .iter()
            .filter(|injected| injected.minor)
            .flat_map(|injected| {
                // Asymmetric friction has the same torque in motion.
                let also = (injected.name() == "torque_offset").then_some("friction_asymmetry");
                let names = also.into_iter().chain([injected.name()]);
                names.map(|name| (name.to_owned(), injected.joint.clone()))
            })
            .collect();
        let mut brought: BTreeSet<Name> = known
            .iter()
            .chain(&small)
            .flat_map(|(effect, joint)| brings(effect).iter().map(|with| ((*with).to_owned(), joint.clone())))
            .collect();
        brought.extend(small);
        let brought = brought.difference(&known).cloned().collect();
        Self { known, unknown, brought }
    }

    /// Whether a finding is right or accompanies a right one; otherwise it is false.
    pub fn allows(&self, name: &Name) -> bool {
        self.known.contains(name) || self.brought.contains(name)
    }
}

/// The names that a diagnosis gives.
pub fn found(answer: &Answer) -> BTreeSet<Name> {
    answer.findings.iter().map(|f| (f.effect.clone(), f.joint.clone())).collect()
}

/// The names and the alternatives that a diagnosis gives.
pub fn found_or_confusable(answer: &Answer) -> BTreeSet<Name> {
    let rivals = answer.findings.iter().flat_map(|f| &f.confusable_with);
    let mut set = found(answer);
    set.extend(rivals.map(|rival| (rival.effect.clone(), rival.joint.clone())));
    set
}

/// The findings of `answer` as they are counted: `inertial_parameters` is counted as each wrong link of its joint (of any
/// joint, if it is on the whole arm) that is not named separately. If the URDF is wrong everywhere, the parameters of such
/// a link differ in other ways as well, and `inertial_parameters` is a baseline effect. If the URDF is exact, the name is
/// right for a link whose parameters differ in other ways, and false otherwise. On the whole arm, it is also counted as a
/// common factor of all inertials that is not larger than the URDF's error. Injected by its own name, it is counted by that name.
pub fn counted_findings(truth: &Truth, answer: &Answer) -> Answer {
    counted(truth, answer, true)
}

/// The findings as of [`counted_findings`], except that a common factor of all inertials is required by its own name.
pub fn plainly_counted_findings(truth: &Truth, answer: &Answer) -> Answer {
    counted(truth, answer, false)
}

fn counted(truth: &Truth, answer: &Answer, factor_too: bool) -> Answer {
    let mut counted = answer.clone();
    let names = found(answer);
    let (general, mut findings): (Vec<_>, Vec<_>) =
        counted.findings.into_iter().partition(|finding| finding.effect == INERTIALS);
    let wrong_everywhere = truth.has_a_wrong_urdf();
    let mut taken: BTreeSet<Name> = BTreeSet::new();
    for finding in general {
        let is_it = |injected: &Injected| injected.name() == INERTIALS && injected.joint == finding.joint;
        if truth.of_note().any(is_it) {
            findings.push(finding);
            continue;
        }
        let is_meant = |injected: &&Injected| match injected.name() {
            LINK_INERTIAL => {
                (wrong_everywhere || injected.form.is_some())
                    && (finding.joint.is_none() || finding.joint == injected.joint)
            }
            ALL_INERTIALS => factor_too && finding.joint.is_none() && is_of_the_urdf(truth, injected),
            _ => false,
        };
        let mut is_counted = false;
        for injected in truth.of_note().filter(is_meant) {
            is_counted = true;
            let name = (injected.name().to_owned(), injected.joint.clone());
            if !names.contains(&name) && taken.insert(name.clone()) {
                let mut finding = finding.clone();
                (finding.effect, finding.joint) = name;
                // The parameters of the two effects are not comparable.
                finding.parameters.clear();
                findings.push(finding);
            }
        }
        if !is_counted && !wrong_everywhere {
            findings.push(finding);
        }
    }
    counted.findings = findings;
    counted
}

/// Whether a common factor of all inertials is within the error of each inertial in the URDF, so that no recording
/// distinguishes it from that error.
fn is_of_the_urdf(truth: &Truth, scale: &Injected) -> bool {
    let factor = truth_value(scale, "factor").unwrap_or(1.0);
    truth.urdf_sigma.is_some_and(|sigma| factor.ln().abs() <= WITHIN_THE_URDF * sigma)
}

/// Whether a diagnosis declares an effect of this size not testable with these recordings.
pub fn is_declared_not_testable(answer: &Answer, injected: &Injected) -> bool {
    answer
        .not_observable
        .iter()
        .filter(|declared| declared.effect == injected.name() && declared.joint == injected.joint)
        .any(|declared| hides(declared, injected))
}

fn hides(declared: &NotTestable, injected: &Injected) -> bool {
    let (above, below) = (&declared.would_be_seen_above, &declared.would_be_seen_below);
    if above.is_empty() && below.is_empty() {
        return true;
    }
    let size = |key: &String| truth_value(injected, key).map(|value| (value - neutral(injected.name())).abs());
    let under = |(key, bound): (&String, &Option<f64>)| match (size(key), bound) {
        (Some(size), Some(bound)) => size < *bound,
        _ => false,
    };
    let over = |(key, bound): (&String, &Option<f64>)| match (size(key), bound) {
        (Some(size), Some(bound)) => size > *bound,
        _ => false,
    };
    above.iter().any(under) || below.iter().any(over)
}
