//! The findings of a diagnosis, and equivalent parameterisations of them.

use std::collections::BTreeMap;

use super::name_of;
use crate::answer::{Answer, Named, Number};
use crate::rules::Name;

/// A name equivalent to findings, with its parameters.
pub struct Reading {
    /// The effect and its joint.
    pub name: Name,
    /// Its parameters, as far as they follow from the findings.
    pub parameters: BTreeMap<String, Number>,
    /// The indices of the findings that it follows from.
    pub of: Vec<usize>,
    /// Whether the name differs from those of the findings.
    rewritten: bool,
}

impl Reading {
    /// Whether no finding has this name.
    pub fn is_rewritten(&self) -> bool {
        self.rewritten
    }

    /// The name of the first finding from which it follows.
    pub fn first(&self, answer: &Answer) -> Option<Name> {
        Some(name_of(answer.findings.get(*self.of.first()?)?))
    }
}

/// The findings, then the equivalent parameterisations.
pub fn readings(answer: &Answer) -> Vec<Reading> {
    let findings = || answer.findings.iter().enumerate();
    let mut list: Vec<Reading> = findings()
        .map(|(k, finding)| Reading {
            name: name_of(finding),
            parameters: finding.parameters.clone(),
            of: vec![k],
            rewritten: false,
        })
        .collect();
    for (k, finding) in findings() {
        let mut add = |effect: &str, joint: &Option<String>, parameters: BTreeMap<String, Number>, of: Vec<usize>| {
            list.push(Reading { name: (effect.to_owned(), joint.clone()), parameters, of, rewritten: true });
        };
        let joint = &finding.joint;
        let number = |key: &str| finding.parameters.get(key).copied();
        match finding.effect.as_str() {
            // F₊ forwards and F₋ backwards equal their mean against the motion and half their difference in both directions.
            "friction_asymmetry" => {
                if let (Some(positive), Some(negative)) = (number("positive"), number("negative")) {
                    let level = scaled(combined(positive, negative, 1.0), 0.5);
                    let offset = scaled(combined(positive, negative, -1.0), 0.5);
                    add("coulomb_friction", joint, one("level", level), vec![k]);
                    add("torque_offset", joint, one("offset", offset), vec![k]);
                }
            }
            "coulomb_friction" => {
                let is_offset = |(_, other): &(usize, &Named)| other.effect == "torque_offset" && other.joint == *joint;
                if let Some((at, other)) = findings().find(is_offset)
                    && let (Some(level), Some(offset)) = (number("level"), other.parameters.get("offset"))
                {
                    let mut both = one("positive", combined(level, *offset, 1.0));
                    both.extend(one("negative", combined(level, *offset, -1.0)));
                    add("friction_asymmetry", joint, both, vec![k, at]);
                }
            }
            "stribeck_friction" | "load_dependent_friction" | "thermal_drift" => {
                let level = number("coulomb").map_or_else(BTreeMap::new, |level| one("level", level));
                add("coulomb_friction", joint, level, vec![k]);
            }
            "transmission_coupling" => add(&finding.effect, &finding.other, finding.parameters.clone(), vec![k]),
            _ => {}
        }
    }
    list
}

fn one(key: &str, number: Number) -> BTreeMap<String, Number> {
    [(key.to_owned(), number)].into()
}

/// a + sign b; the interval is computed as if the two were independent.
fn combined(a: Number, b: Number, sign: f64) -> Number {
    let half = |number: Number| match number.ci95 {
        [Some(low), Some(high)] => Some(0.5 * (high - low)),
        _ => None,
    };
    let value = match (a.value, b.value) {
        (Some(a), Some(b)) => Some(a + sign * b),
        _ => None,
    };
    let ci95 = match (value, half(a), half(b)) {
        (Some(value), Some(a), Some(b)) => [Some(value - a.hypot(b)), Some(value + a.hypot(b))],
        _ => [None, None],
    };
    Number { value, ci95 }
}

fn scaled(number: Number, factor: f64) -> Number {
    Number {
        value: number.value.map(|value| factor * value),
        ci95: number.ci95.map(|bound| bound.map(|bound| factor * bound)),
    }
}
