//! Published values of a real robot, and the comparison of a blind diagnosis with them.

mod readings;

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use crate::answer::{Answer, Named, Rollout};
use crate::catalogue::{brings, parameters};
use crate::rules::{Name, is_declared_not_testable};
use crate::truth::Injected;
use readings::{Reading, readings};

/// The published knowledge of a robot that its URDF does not contain. It serves as the ground truth of a real robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Published {
    /// The robot: the name of its folder.
    pub robot: String,
    /// The published effects.
    pub said: Vec<PublishedEffect>,
    /// The effects that a publication excludes.
    pub denied: Vec<Denied>,
}

/// A published effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PublishedEffect {
    /// Names in the catalogue; if there are several, the publication leaves open which one is meant.
    pub effects: Vec<String>,
    /// The joint; `None` for the whole arm.
    pub joint: Option<String>,
    /// Its parameters, by the catalogue's names.
    pub parameters: BTreeMap<String, PublishedNumber>,
    /// The kind of evidence.
    pub evidence: Evidence,
    /// The source.
    pub place: String,
}

/// A published number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PublishedNumber {
    /// The value, in SI units at the joint.
    pub value: f64,
    /// The SI unit.
    pub unit: String,
}

/// The kind of evidence of a published effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Evidence {
    /// The publishers give the value, as a result of measurements on this machine or its type.
    Number,
    /// The value follows from a law that they give.
    Derived,
    /// A constant of a model that they use, without a statement that it was measured on this machine.
    Constant,
    /// The effect is stated, or almost certainly present, without a value.
    Statement,
}

/// Effects that are excluded by the publication: naming one is wrong.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Denied {
    /// Names of the catalogue.
    pub effects: Vec<String>,
    /// The joints; any joint if empty.
    pub joints: Vec<String>,
    /// The source.
    pub place: String,
}

/// The outcome of a published effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PublishedFate {
    /// Named, on its joint.
    Named,
    /// Named by an equivalent parameterisation: asymmetric friction is Coulomb friction with an offset, a friction curve
    /// contains Coulomb friction, a coupling acts on both of its joints.
    SameTorque,
    /// An alternative of a finding.
    Confusable,
    /// Not named, and declared not testable at its size; if the size is unknown, declared not testable.
    NotObservable,
    /// Not named, and its joint is unexplained.
    Unexplained,
    /// None of these.
    Missed,
}

/// A published effect with its outcome.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PublishedOutcome {
    /// The published effect.
    pub said: PublishedEffect,
    /// The outcome.
    pub fate: PublishedFate,
    /// The finding that agrees with it, or that has it as an alternative.
    pub named_as: Option<Name>,
    /// All findings that agree with it, in words.
    pub sentences: Vec<String>,
    /// Its parameters, with those of the finding.
    pub numbers: Vec<Compared>,
}

/// A published value with the estimate.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Compared {
    /// The parameter's name in the catalogue.
    pub parameter: String,
    /// The published value (SI).
    pub published: f64,
    /// The SI unit.
    pub unit: String,
    /// The estimate; `None` if the finding has no such parameter.
    pub found: Option<f64>,
    /// Its 95 % interval; `None` where it is open.
    pub ci95: [Option<f64>; 2],
    /// (found − published) over |published|.
    pub difference: Option<f64>,
    /// Whether the interval contains the published value.
    pub covered: bool,
}

/// A finding that is not published.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Besides {
    /// The finding.
    pub name: Name,
    /// The source that excludes it.
    pub contradicted_by: Option<String>,
    /// Whether it accompanies a published effect: Coulomb friction with a friction curve, a rotor inertia with a spring.
    pub comes_with: bool,
    /// Its share of the joint's torque.
    pub share: f64,
    /// Its stated probability.
    pub probability: Option<f64>,
    /// Its alternatives.
    pub confusable_with: Vec<Name>,
    /// The finding as a sentence.
    pub sentence: String,
}

/// Held-out errors of a joint (NRMSE).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HeldOutErrors {
    /// The error of the URDF's model.
    pub nominal: Option<f64>,
    /// The error with the findings.
    pub diagnosed: Option<f64>,
    /// The error with the published effects, fitted to the same recordings.
    pub said: Option<f64>,
    /// The error with a learned correction.
    pub learned: Option<f64>,
}

/// The comparison for one robot.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RobotScore {
    /// The robot.
    pub robot: String,
    /// The verdict; `None` without an answer.
    pub verdict: Option<String>,
    /// All published effects, in their order.
    pub said: Vec<PublishedOutcome>,
    /// Findings that are not published.
    pub besides: Vec<Besides>,
    /// Joints with an unexplained residual.
    pub unexplained: Vec<String>,
    /// Effects declared not testable, with their joints; without the whole arm.
    pub not_observable: BTreeMap<String, Vec<String>>,
    /// Held-out errors, by joint.
    pub held_out: BTreeMap<String, HeldOutErrors>,
    /// Distance of the simulated from the recorded motion, by joint; empty where it was not simulated.
    pub rollout: BTreeMap<String, Rollout>,
}

/// The parameters of an effect that may be published: the scored ones, and the rest position of a spring.
pub fn compared_parameters(effect: &str) -> Vec<&'static str> {
    let mut list = parameters(effect).to_vec();
    if effect == "spring" {
        list.push("rest");
    }
    list
}

impl Published {
    /// All published effects as names for `--only`, each once. Of several possible names, the first one is taken.
    pub fn terms(&self) -> Vec<Name> {
        let mut list = Vec::new();
        for said in &self.said {
            let name = said.effects.first().map(|effect| (effect.clone(), said.joint.clone()));
            if let Some(name) = name.filter(|name| !list.contains(name)) {
                list.push(name);
            }
        }
        list
    }

    /// The comparison with `answer`, the blind diagnosis. `with_published` is the fit of [`Self::terms`] alone. Without an
    /// answer, all published effects are missed.
    pub fn score(&self, answer: Option<&Answer>, with_published: Option<&Answer>) -> RobotScore {
        let nothing = Answer::default();
        let given = answer.unwrap_or(&nothing);
        let readings = readings(given);
        let said: Vec<PublishedOutcome> = self.said.iter().map(|said| outcome(said, given, &readings)).collect();
        let mut not_observable: BTreeMap<String, Vec<String>> = BTreeMap::new();
        for declared in &given.not_observable {
            if let Some(joint) = &declared.joint {
                not_observable.entry(declared.effect.clone()).or_default().push(joint.clone());
            }
        }
        let held_out = given.fit.iter().map(|(joint, fit)| {
            let said = with_published.and_then(|answer| answer.fit.get(joint));
            let errors = HeldOutErrors {
                nominal: fit.held_out_nrmse_nominal,
                diagnosed: fit.held_out_nrmse_augmented,
                said: said.and_then(|fit| fit.held_out_nrmse_augmented),
                learned: fit.held_out_nrmse_learned,
            };
            (joint.clone(), errors)
        });
        RobotScore {
            robot: self.robot.clone(),
            verdict: answer.map(|answer| answer.verdict.clone()),
            besides: self.besides(given, &readings),
            said,
            unexplained: given.unexplained.iter().map(|refused| refused.joint.clone()).collect(),
            not_observable,
            held_out: held_out.collect(),
            rollout: given.rollout.clone(),
        }
    }

    /// The findings that agree with no published effect, also under other names.
    fn besides(&self, answer: &Answer, readings: &[Reading]) -> Vec<Besides> {
        let is_said = |name: &Name| self.said.iter().any(|said| said.is(name));
        let known: BTreeSet<usize> = readings
            .iter()
            .filter(|reading| is_said(&reading.name))
            .flat_map(|reading| reading.of.iter().copied())
            .collect();
        let mut list = Vec::new();
        let findings = answer.findings.iter().enumerate();
        for (_, finding) in findings.filter(|(k, _)| !known.contains(k)) {
            let name = name_of(finding);
            let denied = self.denied.iter().find(|denied| denied.is(&name));
            let comes_with = self.said.iter().any(|said| {
                said.joint == name.1 && said.effects.iter().any(|effect| brings(effect).contains(&name.0.as_str()))
            });
            let rivals = finding.confusable_with.iter();
            list.push(Besides {
                contradicted_by: denied.map(|denied| denied.place.clone()),
                comes_with,
                share: finding.share,
                probability: finding.probability,
                confusable_with: rivals.map(|other| (other.effect.clone(), other.joint.clone())).collect(),
                sentence: finding.sentence.clone(),
                name,
            });
        }
        list
    }
}

impl PublishedEffect {
    /// Whether a finding agrees with a published effect.
    fn is(&self, (effect, joint): &Name) -> bool {
        *joint == self.joint && self.effects.contains(effect)
    }

    /// The published effect as an injected fault, to test whether it was declared not testable.
    fn injected(&self, effect: &str) -> Injected {
        let values = self.parameters.iter();
        Injected {
            effect: effect.to_owned(),
            joint: self.joint.clone(),
            parameters: values.map(|(key, number)| (key.clone(), number.value.into())).collect(),
            form: None,
            onset: None,
            minor: false,
            expressed_share: None,
        }
    }

    /// Whether each possible effect is declared not testable; if the size is unknown, it is sufficient that it is listed.
    fn is_not_testable(&self, answer: &Answer) -> bool {
        self.effects.iter().all(|effect| {
            if !self.parameters.is_empty() {
                return is_declared_not_testable(answer, &self.injected(effect));
            }
            let mut listed = answer.not_observable.iter();
            listed.any(|declared| declared.effect == *effect && declared.joint == self.joint)
        })
    }
}

impl Denied {
    fn is(&self, (effect, joint): &Name) -> bool {
        let there = joint.as_ref().is_some_and(|joint| self.joints.contains(joint));
        self.effects.contains(effect) && (self.joints.is_empty() || there)
    }
}

fn name_of(finding: &Named) -> Name {
    (finding.effect.clone(), finding.joint.clone())
}

fn outcome(said: &PublishedEffect, answer: &Answer, readings: &[Reading]) -> PublishedOutcome {
    let reading = readings.iter().find(|reading| said.is(&reading.name));
    let is_rival = |finding: &&Named| {
        let mut others = finding.confusable_with.iter();
        others.any(|other| said.is(&(other.effect.clone(), other.joint.clone())))
    };
    let rival = answer.findings.iter().find(is_rival);
    let refused = |joint: &String| answer.unexplained.iter().any(|refused| refused.joint == *joint);
    let (fate, named_as) = match (reading, rival) {
        (Some(reading), _) if reading.is_rewritten() => (PublishedFate::SameTorque, reading.first(answer)),
        (Some(reading), _) => (PublishedFate::Named, reading.first(answer)),
        (None, Some(finding)) => (PublishedFate::Confusable, Some(name_of(finding))),
        (None, None) if said.is_not_testable(answer) => (PublishedFate::NotObservable, None),
        (None, None) if said.joint.as_ref().is_some_and(refused) => (PublishedFate::Unexplained, None),
        (None, None) => (PublishedFate::Missed, None),
    };
    let numbers = reading.map_or_else(Vec::new, |reading| {
        let order = |effect: &String| compared_parameters(effect);
        let keys: Vec<&str> = said.effects.iter().flat_map(order).collect();
        let place = |key: &String| keys.iter().position(|other| other == key);
        let mut list: Vec<_> = said.parameters.iter().collect();
        list.sort_by_key(|(key, _)| place(key));
        list.into_iter().map(|(key, number)| compared(key, number, reading)).collect()
    });
    let of = |reading: &Reading| reading.of.clone();
    let all: BTreeSet<usize> = readings.iter().filter(|reading| said.is(&reading.name)).flat_map(of).collect();
    let sentences = all.iter().filter_map(|&k| Some(answer.findings.get(k)?.sentence.clone()));
    PublishedOutcome { said: said.clone(), fate, named_as, sentences: sentences.collect(), numbers }
}

fn compared(key: &str, number: &PublishedNumber, reading: &Reading) -> Compared {
    let found = reading.parameters.get(key);
    let value = found.and_then(|found| found.value);
    let ci95 = found.map_or([None; 2], |found| found.ci95);
    let published = number.value;
    Compared {
        parameter: key.to_owned(),
        published,
        unit: number.unit.clone(),
        found: value,
        ci95,
        difference: value.filter(|_| published != 0.0).map(|value| (value - published) / published.abs()),
        covered: value.is_some() && found.is_some_and(|found| found.holds(published)),
    }
}

#[cfg(test)]
mod tests;
