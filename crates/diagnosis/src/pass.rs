//! A pass over the recordings through one filter, and a second pass through a slower one where the first leaves residuals unexplained.
//!
//! No model is right about the fast torque after an impact in a gear, or at the end of a spring. It hides the slower part of the same
//! torque, which a model does explain, and which stands out with a slower filter.

use std::collections::BTreeMap;

use arm::Arm;

use crate::data::Data;
use crate::data::input::{Input, check};
use crate::error::DiagnosisError;
use crate::findings::conclusion::Conclusion;
use crate::options::{Options, Step};
use crate::report::{Finding, Unexplained};
use crate::search::scope::Scope;
use crate::search::study::Study;
use crate::selection::FinalFit;
use crate::thresholds::{
    CERTAIN_ENOUGH, FALLS_TO, LEAST_CUTOFF_PERIODS, LEAST_FOR_DYNAMICS, OF_THE_UNEXPLAINED, SLOWER_FILTER,
    WORTH_SLOWING,
};
use crate::trace::{Action, Trace};

/// The final fit with one filter, and the conclusions.
pub struct Pass {
    /// The final fit.
    pub last: FinalFit,
    /// The conclusions from it.
    pub conclusion: Conclusion,
}

impl Pass {
    /// The pass with the filter of `options`.
    ///
    /// # Errors
    /// [`DiagnosisError`], if there is nothing to fit.
    pub fn new(
        arm: &Arm,
        inputs: &[Input<'_>],
        options: &Options,
        progress: &dyn Fn(Step<'_>),
    ) -> Result<Self, DiagnosisError> {
        Self::within(arm, inputs, options, (None, Trace::default()), progress)
    }

    /// A pass over recordings from which a lag of their torques was `removed`. It continues the trace of the pass that showed the lag.
    ///
    /// # Errors
    /// [`DiagnosisError`], if there is nothing to fit.
    pub fn again(
        arm: &Arm,
        inputs: &[Input<'_>],
        options: &Options,
        (trace, removed, rule): (Trace, String, &'static str),
        progress: &dyn Fn(Step<'_>),
    ) -> Result<Self, DiagnosisError> {
        trace.step([(Action::Lag, removed, None, rule, 0.0)]);
        Self::within(arm, inputs, options, (None, trace), progress)
    }

    /// A pass that may name what is in `scope` (`None`: everything) and continues a trace.
    fn within(
        arm: &Arm,
        inputs: &[Input<'_>],
        options: &Options,
        (scope, trace): (Option<Scope>, Trace),
        progress: &dyn Fn(Step<'_>),
    ) -> Result<Self, DiagnosisError> {
        progress(Step::new(0.08, "filtering, rigid-body torques"));
        let data = Data::new(arm, inputs, options)?;
        let mut study = Study::new(data, options).with_own_load(options);
        study.scope = scope;
        study.trace = trace;
        let last = FinalFit::new(study, options, progress)?;
        if !last.judged.named.score.is_finite() {
            return Err(DiagnosisError::NotFinite);
        }
        progress(Step::new(0.78, "alternatives of the findings"));
        let conclusion = Conclusion::new(&last, inputs, options);
        Ok(Self { last, conclusion })
    }

    /// This pass, or one through a slower filter that names what this one leaves unexplained, if the user states neither a filter nor
    /// effects.
    ///
    /// # Errors
    /// [`DiagnosisError`], if there is nothing to fit.
    pub fn or_slower(
        mut self,
        arm: &Arm,
        inputs: &[Input<'_>],
        options: &Options,
        progress: &dyn Fn(Step<'_>),
    ) -> Result<Self, DiagnosisError> {
        let is_stated = options.cutoff.is_some() || options.only.is_some();
        let slower = self.slower();
        let before = self.last.study.data.motions.cutoff;
        let open = self.conclusion.unexplained.len();
        // A residual on most joints has another cause than an effect that the filter hides.
        if is_stated
            || open == 0
            || 2 * open > arm.dof()
            || slower > WORTH_SLOWING * before
            || check(arm, inputs, slower).is_err()
        {
            return Ok(self);
        }
        let options = Options { cutoff: Some(slower), ..options.clone() };
        let again = |step: Step<'_>| {
            let doing = format!("slower filter: {}", step.doing);
            progress(Step::new(0.78 + 0.02 * step.done, &doing));
        };
        // First only what is new on the open joints. An effect on another joint may be a part of the explanation; it is believed if
        // nothing stays unexplained with it.
        for scope in [Some(self.scope()), None] {
            let is_free = scope.is_none();
            let trace = std::mem::take(&mut self.last.study.trace);
            note_filter(&trace, slower, "residuals stay unexplained");
            let mut second = Self::within(arm, inputs, &options, (scope, trace), &again)?;
            let explains = !is_free || second.conclusion.unexplained.is_empty();
            let reason = second.outcome().reason_beside(&self.outcome()).filter(|_| explains);
            if let Some(reason) = reason {
                second.last.study.data.motions.remarks.push(format!(
                    "the filter's cut-off was lowered from {before:.1} Hz to {slower:.1} Hz: with it, {reason} (--cutoff {before:.1} \
                     gives the result before)"
                ));
                return Ok(second);
            }
            self.last.study.trace = second.last.study.trace;
            note_filter(&self.last.study.trace, before, "the slower filter explains no more");
        }
        Ok(self)
    }

    /// The slower cut-off (Hz): a part of this one, sufficient for delays, springs and gaps, and for the motion.
    fn slower(&self) -> f64 {
        let motions = &self.last.study.data.motions;
        (SLOWER_FILTER * motions.cutoff).max(LEAST_FOR_DYNAMICS).max(LEAST_CUTOFF_PERIODS * motions.usual_tempo())
    }

    /// The joints whose residual is unexplained.
    fn open(&self) -> impl Iterator<Item = &str> {
        self.conclusion.unexplained.iter().map(|open| open.joint.as_str())
    }

    /// What another pass may name.
    fn scope(&self) -> Scope {
        let joints = self.last.study.data.arm.joints().iter();
        let candidates = &self.last.study.candidates;
        let named = self.last.judged.named.set.iter().map(|&c| &candidates[c]);
        Scope {
            is_open: joints.map(|joint| self.open().any(|open| open == joint.name)).collect(),
            names: named.map(|candidate| (candidate.hypothesis, candidate.joint)).collect(),
        }
    }

    /// What this pass names and leaves unexplained.
    fn outcome(&self) -> Outcome<'_> {
        Outcome {
            findings: self.conclusion.findings.iter().map(|(finding, _)| finding).collect(),
            unexplained: &self.conclusion.unexplained,
            errors: self.conclusion.fit.iter().map(|(joint, fit)| (joint.as_str(), fit.error())).collect(),
        }
    }
}

/// What a pass names and leaves unexplained.
struct Outcome<'a> {
    findings: Vec<&'a Finding>,
    unexplained: &'a [Unexplained],
    /// Each joint's error (NRMSE).
    errors: BTreeMap<&'a str, f64>,
}

impl Outcome<'_> {
    fn is_open(&self, joint: &str) -> bool {
        self.unexplained.iter().any(|open| open.joint == joint)
    }

    /// The new name that is the reason for residuals that `first` leaves unexplained and this pass does not, as a clause; `None` if there
    /// is none, or if this pass explains less elsewhere.
    ///
    /// The name must be certain, and as large as a part of the largest of these residuals. The errors of their joints must fall. No
    /// other joint may be unexplained, and the certain names of `first` on joints that it explains must stay.
    fn reason_beside(&self, first: &Self) -> Option<String> {
        let closed = || first.unexplained.iter().filter(|open| !self.is_open(&open.joint));
        let largest = closed().max_by(|a, b| a.share.total_cmp(&b.share))?;
        let share = |finding: &Finding| finding.share_by_joint.get(&largest.joint).copied().unwrap_or(0.0);
        let mut new = self.findings.iter().filter(|finding| is_certain(finding) && !first.names(finding));
        let reason = new.find(|finding| share(finding) >= OF_THE_UNEXPLAINED * largest.share)?;
        let is_elsewhere = |finding: &&&Finding| !finding.joint.as_ref().is_some_and(|joint| first.is_open(joint));
        let mut kept = first.findings.iter().filter(|finding| is_certain(finding)).filter(is_elsewhere);
        let others_are_open = self.unexplained.iter().any(|open| !first.is_open(&open.joint));
        // Elsewhere, the filter may have hidden the structure of the same error.
        let falls = |open: &Unexplained| {
            let error = |outcome: &Self| outcome.errors.get(open.joint.as_str()).copied();
            error(self).zip(error(first)).is_none_or(|(error, before)| error <= FALLS_TO * before)
        };
        if others_are_open || !closed().all(falls) || !kept.all(|finding| self.names(finding)) {
            return None;
        }
        let joints: Vec<&str> = closed().map(|open| open.joint.as_str()).collect();
        let (title, on) = (reason.as_effect.spec().title, reason.joint.as_deref());
        let on = on.map_or(String::new(), |joint| format!(" of {joint}"));
        Some(format!("{title}{on} explains residuals of {}", joints.join(", ")))
    }

    /// Whether a finding of the same name is among them.
    fn names(&self, finding: &Finding) -> bool {
        let mut findings = self.findings.iter();
        findings.any(|known| known.effect == finding.effect && known.joint == finding.joint)
    }
}

/// Whether a finding has a certain name, and is no baseline effect.
fn is_certain(finding: &Finding) -> bool {
    !finding.as_effect.spec().is_baseline
        && finding.probability.is_some_and(|probability| probability >= CERTAIN_ENOUGH)
}

/// Notes that the search goes on with the filter at `cutoff` (Hz).
fn note_filter(trace: &Trace, cutoff: f64, rule: &'static str) {
    trace.step([(Action::Filter, format!("{cutoff:.1} Hz"), None, rule, 0.0)]);
}

#[cfg(test)]
mod tests {
    use effects::drive::BACKLASH;
    use effects::friction::COULOMB_FRICTION;
    use effects::{Effect, Spec};

    use super::*;

    fn named(kind: &'static Spec, probability: f64, share: f64) -> Finding {
        Finding {
            probability: Some(probability),
            share_by_joint: [("elbow".to_owned(), share)].into(),
            ..Finding::of(Effect::of(kind).on("elbow".to_owned()))
        }
    }

    fn open(joint: &str) -> Unexplained {
        Unexplained {
            joint: joint.to_owned(),
            share: if joint == "elbow" { 0.4 } else { 0.2 },
            depends_on: Vec::new(),
            time: Vec::new(),
            next: String::new(),
        }
    }

    fn is_taken(findings: &[Finding], unexplained: &[Unexplained]) -> bool {
        is_taken_after(&[named(&COULOMB_FRICTION, 0.985, 0.1)], findings, unexplained)
    }

    fn is_taken_after(first: &[Finding], findings: &[Finding], unexplained: &[Unexplained]) -> bool {
        is_taken_at(0.1, first, findings, unexplained)
    }

    /// Whether a pass is taken in which the error of the elbow falls from 0.4 to `error`.
    fn is_taken_at(error: f64, first: &[Finding], findings: &[Finding], unexplained: &[Unexplained]) -> bool {
        let first = Outcome {
            findings: first.iter().collect(),
            unexplained: &[open("elbow"), open("wrist")],
            errors: [("elbow", 0.4)].into(),
        };
        let second = Outcome { findings: findings.iter().collect(), unexplained, errors: [("elbow", error)].into() };
        second.reason_beside(&first).is_some()
    }

    #[test]
    fn a_second_pass_must_reduce_the_errors() {
        let gap = [named(&BACKLASH, 0.985, 0.2)];
        assert!(is_taken_at(0.2, &[], &gap, &[open("wrist")]));
        assert!(!is_taken_at(0.39, &[], &gap, &[open("wrist")]), "only hidden");
    }

    #[test]
    fn a_second_pass_needs_a_new_name_that_is_the_reason() {
        assert!(is_taken(&[named(&BACKLASH, 0.985, 0.2)], &[open("wrist")]));
        assert!(!is_taken(&[], &[open("wrist")]), "without a name, the residual was only filtered");
        assert!(!is_taken(&[named(&BACKLASH, 0.985, 0.02)], &[open("wrist")]), "too small");
        assert!(!is_taken(&[named(&BACKLASH, 0.6, 0.2)], &[open("wrist")]), "not certain");
        assert!(!is_taken(&[named(&COULOMB_FRICTION, 0.985, 0.2)], &[open("wrist")]), "known, and baseline");
    }

    #[test]
    fn a_second_pass_must_leave_less_unexplained() {
        let gap = [named(&BACKLASH, 0.985, 0.2)];
        assert!(!is_taken(&gap, &[open("elbow"), open("wrist")]), "as much");
        assert!(!is_taken(&gap, &[open("shoulder")]), "another joint");
        assert!(is_taken(&gap, &[]));
    }

    #[test]
    fn a_second_pass_keeps_the_certain_names_of_explained_joints() {
        let gap = named(&BACKLASH, 0.985, 0.2);
        let on = |joint: &str| Finding { joint: Some(joint.to_owned()), ..gap.clone() };
        let both = [gap.clone(), on("shoulder")];
        assert!(is_taken_after(&[on("shoulder")], &both, &[]));
        assert!(!is_taken_after(&[on("shoulder")], std::slice::from_ref(&gap), &[]), "lost");
        assert!(is_taken_after(&[on("wrist")], &[gap], &[]), "of a joint that was unexplained");
    }

    #[test]
    fn the_note_says_what_explains_which_residuals() {
        let (gap, open) = (named(&BACKLASH, 0.985, 0.2), [open("elbow"), open("wrist")]);
        let of = |findings, unexplained| Outcome { findings, unexplained, errors: BTreeMap::new() };
        let reason = of(vec![&gap], &open[1..]).reason_beside(&of(Vec::new(), &open));
        assert_eq!(reason.as_deref(), Some("backlash of elbow explains residuals of elbow"));
    }
}
