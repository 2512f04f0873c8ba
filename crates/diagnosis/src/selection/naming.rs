//! From columns and coefficients to effects with parameters in SI units.

mod onset;

pub use onset::is_anywhere;

use std::collections::BTreeMap;

use crate::data::statistics::NORMAL_95;
use crate::report::Parameter;
use crate::search::study::Study;
use crate::selection::bootstrap::Resampled;
use crate::thresholds::{OF_ARM, OF_FORM, SYSTEMATIC};
use arm::{Arm, Matrix3};
use effects::{Effect, Estimate, Kind, Law, Range, Scope, Size, Spec, Systematic, Term};

/// A named effect with its parameters.
#[derive(Clone, Debug)]
pub struct Named {
    /// The effect, for the corrected model.
    pub effect: Effect,
    /// The other joint on whose motion it depends.
    pub other: Option<String>,
    /// Its parameters with intervals.
    pub parameters: BTreeMap<&'static str, Parameter>,
}

/// The source of a candidate's parameters.
struct Reader<'a> {
    study: &'a Study,
    resampled: &'a Resampled,
    candidate: usize,
    kind: Kind,
    parameters: BTreeMap<&'static str, Parameter>,
}

impl Reader<'_> {
    /// The unit of a parameter.
    fn unit(&self, key: &str) -> &'static str {
        let joint = &self.study.data.arm.joints()[self.joint()];
        self.kind.spec().unit(key, joint.kind).unwrap_or_default()
    }

    /// The relative error of the URDF's links that the joint moves, according to the strengths of the background.
    fn links_wrong_by(&self) -> f64 {
        let strengths = &self.study.strengths;
        (self.joint()..strengths.links.len()).fold(0.0, |most: f64, link| most.max(strengths.of_link(link)))
    }
}

impl Estimate for Reader<'_> {
    fn arm(&self) -> &Arm {
        &self.study.data.arm
    }

    fn joint(&self) -> usize {
        self.study.candidates[self.candidate].joint.unwrap_or(0)
    }

    fn other(&self) -> Option<usize> {
        self.study.candidates[self.candidate].hypothesis.other
    }

    fn terms(&self) -> Vec<Term> {
        self.study.terms(self.candidate)
    }

    fn place(&self, k: usize) -> Option<usize> {
        let column = self.study.candidates[self.candidate].columns.get(k)?;
        self.resampled.column(*column)
    }

    fn on_joint(&self, law: &'static Law) -> Option<usize> {
        let terms = &self.study.table.terms;
        let is_it = |&column: &usize| terms[column].always().is(law) && terms[column].joint == Some(self.joint());
        self.resampled.columns.iter().position(is_it)
    }

    fn is_always_on_joint(&self, law: &'static Law) -> bool {
        let terms = &self.study.table.terms;
        let is_it = |&column: &usize| terms[column].is(law) && terms[column].joint == Some(self.joint());
        self.resampled.columns.iter().any(is_it)
    }

    fn size_place(&self, size: Size) -> Option<usize> {
        self.resampled.size(self.candidate, size)
    }

    fn shown(&self, k: usize) -> f64 {
        let table = &self.study.table;
        let Some(joint) = self.study.candidates[self.candidate].joint else {
            return 0.0;
        };
        let column = self.study.candidates[self.candidate].columns.get(k);
        let place = column.and_then(|&column| table.place[joint][column]);
        let Some(place) = place else { return 0.0 };
        let of_joint = &table.joints[joint];
        let rows = of_joint.x[place].iter().zip(&of_joint.moving);
        rows.filter(|(_, moving)| **moving).fold(0.0, |most: f64, (x, _)| most.max(x.abs()))
    }

    fn positions(&self) -> [f64; 2] {
        let (scales, joint) = (&self.study.data.scales, self.joint());
        let half = 0.5 * scales.range[joint];
        [scales.middle[joint] - half, scales.middle[joint] + half]
    }

    fn best(&self) -> &[f64] {
        &self.resampled.estimate
    }

    fn load_tensor(&self) -> Matrix3<f64> {
        self.study.load_tensor
    }

    fn note_within(&mut self, systematic: Systematic, key: &'static str, f: &dyn Fn(&[f64]) -> f64) -> f64 {
        let is_from_above = systematic == Systematic::FromAbove;
        let systematic = match systematic {
            Systematic::Usual => SYSTEMATIC,
            Systematic::OfForm => OF_FORM,
            Systematic::OfLinks => SYSTEMATIC + OF_ARM * self.links_wrong_by(),
            Systematic::OfArm | Systematic::FromAbove => OF_FORM + OF_ARM * self.links_wrong_by(),
        };
        // A mass is never known more accurately than the torque constants.
        let parameter = self.kind.spec().parameter(key);
        let accuracy = match (parameter, self.study.stated.gain) {
            (Some(parameter), Some(accuracy)) if parameter.quantity.scales_with_torque() => NORMAL_95 * accuracy,
            _ => 0.0,
        };
        let (value, [low, high]) = self.resampled.interval_within(systematic, f);
        let of_constants = accuracy * value.abs();
        let mut ci95 = [value - (value - low).hypot(of_constants), value + (high - value).hypot(of_constants)];
        if is_from_above {
            ci95[0] = 0.0;
        } else if let Some(parameter) = parameter {
            ci95 = within(parameter.range, value, ci95);
        }
        let unit = self.unit(key);
        self.parameters.insert(key, Parameter { value, ci95, unit });
        value
    }

    fn extend(&mut self, key: &'static str, to: f64) {
        if let Some(parameter) = self.parameters.get_mut(key) {
            let [low, high] = parameter.ci95;
            parameter.ci95 = [low.min(to), high.max(to)];
        }
    }

    fn onset(&mut self) -> Option<f64> {
        self.note_onset()
    }

    fn start(&mut self, start: f64, duration: f64) {
        self.note_start(start, duration);
    }
}

/// The effect of `candidate`, if its hypothesis has a name, and the effect that it brings along.
pub fn name(study: &Study, resampled: &Resampled, candidate: usize) -> Vec<Named> {
    let kind = study.candidates[candidate].hypothesis.kind;
    let mut reader = Reader { study, resampled, candidate, kind, parameters: BTreeMap::new() };
    let Some(named) = reader.read(kind) else {
        return Vec::new();
    };
    let brought = kind.spec().brings.and_then(Kind::named);
    let brought = brought.and_then(|kind| reader.read(kind));
    // An effect that is brought along must be clearly present.
    let is_clear = |named: &Named| {
        let main = named.effect.spec().main.first().and_then(|main| named.parameters.get(main));
        main.is_some_and(|main| main.ci95[0] > 0.0)
    };
    std::iter::once(named).chain(brought.filter(is_clear)).collect()
}

/// Whether the intervals of all main parameters contain the value without effect. One clear parameter is sufficient.
pub fn may_be_nothing(spec: &Spec, parameters: &BTreeMap<&'static str, Parameter>) -> bool {
    let sizes = spec.main.iter().filter_map(|main| parameters.get_key_value(main));
    let holds_nothing = |(key, size): (&&'static str, &Parameter)| {
        let nothing = spec.parameter(key).map_or(0.0, |parameter| parameter.neutral);
        size.ci95[0] <= nothing && nothing <= size.ci95[1]
    };
    sizes.clone().next().is_some() && sizes.into_iter().all(holds_nothing)
}

impl Reader<'_> {
    /// The effect of a kind with its parameters.
    fn read(&mut self, kind: Kind) -> Option<Named> {
        self.kind = kind;
        let spec = kind.spec();
        let effect = match spec.scope {
            Scope::Joint => Effect::of(spec).on(self.arm().joints()[self.joint()].name.clone()),
            Scope::Arm => Effect::of(spec),
        };
        let effect = (spec.read)(effect, self)?;
        Some(Named {
            other: effect.other().map(str::to_owned),
            effect,
            parameters: std::mem::take(&mut self.parameters),
        })
    }
}

/// The part of an interval that lies in a parameter's range. A `value` outside of the range is refused elsewhere, and stays in its interval.
fn within(range: Range, value: f64, [low, high]: [f64; 2]) -> [f64; 2] {
    [range.least().map_or(low, |least| low.max(least.min(value))), high]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Neither a duration nor a coefficient of friction can be negative; a constant torque can be.
    #[test]
    fn an_interval_ends_where_its_parameter_ends() {
        assert_eq!(within(Range::Positive, 1.0, [-2.0, 4.0]), [0.0, 4.0]);
        assert_eq!(within(Range::NotNegative, 1.0, [0.5, 1.5]), [0.5, 1.5]);
        assert_eq!(within(Range::AboveMinusOne, -0.5, [-1.5, 0.5]), [-1.0, 0.5]);
        assert_eq!(within(Range::Finite, 1.0, [-2.0, 4.0]), [-2.0, 4.0]);
        assert_eq!(within(Range::Positive, -1.0, [-2.0, 0.0]), [-1.0, 0.0]);
    }

    /// Every searched effect has a main parameter, so that its name is removed where the interval contains no effect.
    #[test]
    fn an_interval_that_holds_no_effect_is_seen_in_every_effect() {
        for spec in effects::CATALOGUE {
            let with = |half: f64| -> BTreeMap<&'static str, Parameter> {
                let size = |&key: &&'static str| {
                    let neutral = spec.parameter(key).map_or(0.0, |parameter| parameter.neutral);
                    let (value, unit) = (neutral + 1.0, "1");
                    let ci95 = [value - half, value + half];
                    (key, Parameter { value, ci95, unit })
                };
                spec.main.iter().map(size).collect()
            };
            assert!(may_be_nothing(spec, &with(1.1)), "{}", spec.name);
            assert!(!may_be_nothing(spec, &with(0.9)), "{}", spec.name);
        }
    }
}
