//! A look at the recordings through one filter, and a second look through a slower one where the first leaves residuals unexplained.
//!
//! What follows an impact in a gear, or the end of a spring, is faster than any model of it is right; the slower part of the same
//! torque is not. An effect that a quick filter hides in such a residual stands out with a slower one.

use arm::Arm;

use crate::data::Data;
use crate::data::input::Input;
use crate::data::statistics::median;
use crate::diagnose::check;
use crate::error::DiagnosisError;
use crate::findings::conclusion::Conclusion;
use crate::options::{Options, Step};
use crate::report::{Finding, Unexplained};
use crate::search::scope::Scope;
use crate::search::study::Study;
use crate::selection::FinalFit;
use crate::thresholds::{
    CERTAIN_ENOUGH, LEAST_CUTOFF_PERIODS, LEAST_FOR_DYNAMICS, OF_THE_UNEXPLAINED, SLOWER_FILTER, WORTH_SLOWING,
};

/// The final fit with one filter, and the conclusions.
pub struct Look {
    /// The final fit.
    pub last: FinalFit,
    /// The conclusions from it.
    pub conclusion: Conclusion,
}

impl Look {
    /// The look with the filter of `options`.
    ///
    /// # Errors
    /// [`DiagnosisError`], if there is nothing to fit.
    pub fn new(
        arm: &Arm,
        inputs: &[Input<'_>],
        options: &Options,
        progress: &dyn Fn(Step<'_>),
    ) -> Result<Self, DiagnosisError> {
        Self::within(arm, inputs, options, None, progress)
    }

    fn within(
        arm: &Arm,
        inputs: &[Input<'_>],
        options: &Options,
        after: Option<(&Self, Option<Scope>)>,
        progress: &dyn Fn(Step<'_>),
    ) -> Result<Self, DiagnosisError> {
        progress(Step::new(0.08, "filtering, rigid-body torques"));
        let data = Data::new(arm, inputs, options)?;
        let mut study = Study::new(data, options).with_own_load(options);
        if let Some((earlier, scope)) = after {
            study.trace.follow(&earlier.last.study.trace);
            study.scope = scope;
        }
        let last = FinalFit::new(study, options, progress)?;
        progress(Step::new(0.78, "alternatives of the findings"));
        let conclusion = Conclusion::new(&last, inputs, options);
        Ok(Self { last, conclusion })
    }

    /// This look, or one through a slower filter that names what this one leaves unexplained, if the user states neither a filter nor
    /// effects.
    ///
    /// # Errors
    /// [`DiagnosisError`], if there is nothing to fit.
    pub fn or_slower(
        self,
        arm: &Arm,
        inputs: &[Input<'_>],
        options: &Options,
        progress: &dyn Fn(Step<'_>),
    ) -> Result<Self, DiagnosisError> {
        let is_stated = options.cutoff.is_some() || options.only.is_some();
        let slower = self.slower();
        let before = self.last.study.data.motions.cutoff;
        let open = self.conclusion.unexplained.len();
        // What most joints have in common is not one effect that the filter hides.
        if is_stated
            || open == 0
            || 2 * open > arm.dof()
            || slower > WORTH_SLOWING * before
            || check(arm, inputs, slower).is_err()
        {
            return Ok(self);
        }
        let options = Options {
            cutoff: Some(slower),
            ..options.clone()
        };
        // First only what is new on the open joints. An effect on another joint may be a part of the explanation; it is believed if
        // nothing stays unexplained with it.
        for scope in [Some(self.scope()), None] {
            let is_free = scope.is_none();
            let mut second = Self::within(arm, inputs, &options, Some((&self, scope)), progress)?;
            if !second.outcome().explains_more_than(&self.outcome())
                || is_free && !second.conclusion.unexplained.is_empty()
            {
                continue;
            }
            let open: Vec<&str> = self.open().collect();
            second.last.study.data.motions.remarks.push(format!(
                "the filter's cut-off was lowered from {before:.1} Hz to {slower:.1} Hz: with {before:.1} Hz, residuals of {} stay \
                 unexplained (--cutoff {before:.1} shows them)",
                open.join(", ")
            ));
            return Ok(second);
        }
        Ok(self)
    }

    /// The slower cut-off (Hz): a part of this one, sufficient for delays, springs and gaps, and for the motion.
    fn slower(&self) -> f64 {
        let motions = &self.last.study.data.motions;
        let tempo = median(motions.tempo.iter().copied().filter(|&tempo| tempo > 0.0).collect());
        (SLOWER_FILTER * motions.cutoff)
            .max(LEAST_FOR_DYNAMICS)
            .max(LEAST_CUTOFF_PERIODS * tempo)
    }

    /// The joints whose residual is unexplained.
    fn open(&self) -> impl Iterator<Item = &str> {
        self.conclusion.unexplained.iter().map(|open| open.joint.as_str())
    }

    /// What another look may name.
    fn scope(&self) -> Scope {
        let joints = self.last.study.data.arm.joints().iter();
        let candidates = &self.last.study.candidates;
        let named = self.last.judged.named.set.iter().map(|&c| &candidates[c]);
        Scope {
            is_open: joints.map(|joint| self.open().any(|open| open == joint.name)).collect(),
            names: named.map(|candidate| (candidate.hypothesis, candidate.joint)).collect(),
        }
    }

    /// What this look names and leaves unexplained.
    fn outcome(&self) -> Outcome<'_> {
        Outcome {
            findings: self.conclusion.findings.iter().map(|(finding, _)| finding).collect(),
            unexplained: &self.conclusion.unexplained,
        }
    }
}

/// What a look names and leaves unexplained.
struct Outcome<'a> {
    findings: Vec<&'a Finding>,
    unexplained: &'a [Unexplained],
}

impl Outcome<'_> {
    fn is_open(&self, joint: &str) -> bool {
        self.unexplained.iter().any(|open| open.joint == joint)
    }

    /// Whether fewer residuals are unexplained than in `first`, and no others, and a name that `first` does not give is certain and
    /// large enough to be the reason.
    fn explains_more_than(&self, first: &Self) -> bool {
        let closed: Vec<&Unexplained> = first
            .unexplained
            .iter()
            .filter(|open| !self.is_open(&open.joint))
            .collect();
        let is_new = |finding: &Finding| {
            let is_same = |known: &&Finding| known.effect == finding.effect && known.joint == finding.joint;
            !first.findings.iter().any(is_same)
        };
        let is_certain = |finding: &Finding| {
            finding
                .probability
                .is_some_and(|probability| probability >= CERTAIN_ENOUGH)
        };
        let is_the_reason = |finding: &Finding| {
            let share = |joint: &str| finding.share_by_joint.get(joint).copied().unwrap_or(0.0);
            closed
                .iter()
                .any(|open| share(&open.joint) >= OF_THE_UNEXPLAINED * open.share)
        };
        self.unexplained.iter().all(|open| first.is_open(&open.joint))
            && self.findings.iter().any(|finding| {
                let is_baseline = finding.as_effect.spec().is_baseline;
                !is_baseline && is_new(finding) && is_certain(finding) && is_the_reason(finding)
            })
    }
}

#[cfg(test)]
mod tests {
    use effects::drive::Backlash;
    use effects::friction::CoulombFriction;
    use effects::{Effect, EffectKind};

    use super::*;

    fn named(kind: &'static dyn EffectKind, probability: f64, share: f64) -> Finding {
        Finding {
            probability: Some(probability),
            share_by_joint: [("elbow".to_owned(), share)].into(),
            ..Finding::of(Effect::of(kind).on("elbow".to_owned()))
        }
    }

    fn open(joint: &str) -> Unexplained {
        Unexplained {
            joint: joint.to_owned(),
            share: 0.4,
            depends_on: Vec::new(),
            time: Vec::new(),
            next: String::new(),
        }
    }

    fn is_taken(findings: &[Finding], unexplained: &[Unexplained]) -> bool {
        let first = [open("elbow"), open("wrist")];
        let friction = named(&CoulombFriction, 0.985, 0.1);
        let first = Outcome {
            findings: vec![&friction],
            unexplained: &first,
        };
        let second = Outcome {
            findings: findings.iter().collect(),
            unexplained,
        };
        second.explains_more_than(&first)
    }

    #[test]
    fn a_second_look_needs_a_new_name_that_is_the_reason() {
        assert!(is_taken(&[named(&Backlash, 0.985, 0.2)], &[open("wrist")]));
        assert!(
            !is_taken(&[], &[open("wrist")]),
            "without a name, the residual was only filtered"
        );
        assert!(
            !is_taken(&[named(&Backlash, 0.985, 0.02)], &[open("wrist")]),
            "too small"
        );
        assert!(
            !is_taken(&[named(&Backlash, 0.6, 0.2)], &[open("wrist")]),
            "not certain"
        );
        assert!(
            !is_taken(&[named(&CoulombFriction, 0.985, 0.2)], &[open("wrist")]),
            "known, and baseline"
        );
    }

    #[test]
    fn a_second_look_must_leave_less_unexplained() {
        let gap = [named(&Backlash, 0.985, 0.2)];
        assert!(!is_taken(&gap, &[open("elbow"), open("wrist")]), "as much");
        assert!(!is_taken(&gap, &[open("shoulder")]), "another joint");
        assert!(is_taken(&gap, &[]));
    }
}
