//! The score of a campaign: its figures and their targets.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::calibration::Calibration;
use crate::controls::HeldOut;
use crate::experiments::Experiments;
use crate::intervals::Counted;
use crate::numbers::ScoredNumber;
use crate::outcome::{FalseName, Outcome, OutsideOutcome};
use crate::plain::Plain;
use crate::strict::{Strict, UrdfError, UrdfGroup};
use crate::summary::{Curve, Errors, ParameterScore};

/// The score of all cases. Everything is counted in names: an effect on a joint.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Score {
    /// The number of cases.
    pub cases: usize,
    /// Cases without an answer. Nothing counts as found in them. They are excluded from shares of given names, from errors
    /// and from intervals.
    pub unanswered: Vec<String>,
    /// Cases with only baseline effects.
    pub empty: usize,
    /// The targets, and whether they are reached.
    pub targets: Vec<Target>,
    /// The strict figures.
    pub strict: Strict,
    /// The strict figures by the error of the URDF; groups without a case are omitted.
    pub by_urdf: Vec<UrdfGroup>,
    /// The figures by family, for effects that are not baseline effects and have an expressed share above
    /// [`crate::LEAST_SHARE`].
    pub families: BTreeMap<String, Family>,
    /// F1 of each family, averaged over the families that are injected.
    pub macro_f1: Option<f64>,
    /// Macro F1 if effects declared not testable count as missed, and equivalent names as false.
    pub macro_f1_strict: Option<f64>,
    /// Baseline effects found: friction and drive inertia.
    #[serde(rename = "ordinary")]
    pub baseline: Counted,
    /// Baseline effects named where they are not injected.
    #[serde(rename = "ordinary_false")]
    pub baseline_false: usize,
    /// Cases with only baseline effects in which another effect is named, of those with an answer.
    pub empty_with_a_false_name: Counted,
    /// Cases with an effect outside the catalogue that is refused on its joint.
    pub outside_refused: Counted,
    /// Cases with an effect outside the catalogue in which a false name is given on any joint, of those with an answer.
    pub outside_with_a_wrong_name: Counted,
    /// Cases with no effect outside the catalogue in which a joint is declared unexplained, of those with an answer.
    pub refused_without_cause: Counted,
    /// Injected effects that are a finding or an alternative of a finding.
    pub covered: Counted,
    /// Injected effects that are a finding or an alternative, if effects declared not testable count as not covered.
    pub covered_strict: Counted,
    /// Detection against the effect's size.
    pub detection: Vec<Curve>,
    /// Errors of the parameters of effects found, by effect and parameter.
    pub parameters: Vec<ParameterScore>,
    /// Relative errors of the main parameters of all effects that are not baseline effects.
    pub main_parameters: Errors,
    /// Intervals that contain the true value, of all scored parameters of these effects.
    pub intervals: Counted,
    /// The prediction error on the held-out recording over that of the true terms, case by case.
    pub over_true_terms: Errors,
    /// The prediction error on the held-out recording over that of the true terms, joint by joint.
    pub over_true_terms_by_joint: Errors,
    /// The tracking error with the diagnosed effects over that with the exact model, of the cases in which a task was
    /// tracked.
    pub tracking_over_exact: Errors,
    /// The ratio of these tracking errors in a loop without the lag of the velocity filter.
    pub tracking_over_exact_without_lag: Errors,
    /// The confusion matrix: injected effects (rows) against the names given (columns).
    pub confusion: BTreeMap<String, BTreeMap<String, usize>>,
    /// Stated probability against outcome, of findings that are not baseline effects.
    pub calibration: Calibration,
    /// Stated probability against outcome, of all findings.
    pub calibration_of_all: Calibration,
    /// The count of the open cases' own script, without any of the distinctions above.
    pub plain: Plain,
    /// Every injected effect that is not a baseline effect, with its outcome.
    #[serde(rename = "concealed")]
    pub injected: Vec<Outcome>,
    /// Every false name that is not a baseline effect.
    pub false_names: Vec<FalseName>,
    /// Every case with an effect outside the catalogue.
    pub outside: Vec<OutsideOutcome>,
    /// Joints declared unexplained in cases with no effect outside the catalogue.
    pub refusals_without_cause: Vec<OutsideOutcome>,
    /// Every scored number.
    pub sizes: Vec<ScoredNumber>,
    /// The controls, case by case.
    pub held_out: Vec<HeldOut>,
    /// The experiments that were proposed.
    pub experiments: Experiments,
}

/// The effects of one name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Family {
    /// Injected with an expressed share from which an effect is required.
    #[serde(rename = "concealed")]
    pub injected: usize,
    /// Required effects that are found, by this name or an equivalent one.
    pub found: usize,
    /// Required effects that are found by an equivalent name.
    pub same_machine: usize,
    /// Required effects that are found or are an alternative of a finding.
    pub covered: usize,
    /// Required effects that are not found and are declared not testable at their size.
    pub not_observable: usize,
    /// Required effects that are not found while their joint is refused.
    pub refused: usize,
    /// Injected with a smaller share, and therefore not required.
    pub too_small: usize,
    /// Effects with a smaller share that are found.
    pub too_small_found: usize,
    /// Named where they are not injected.
    pub false_names: usize,
    /// F1 = 2 found / (required + found + false). Effects declared not testable are not required.
    pub f1: Option<f64>,
    /// F1 if effects declared not testable are required as well, and an equivalent name is false.
    pub f1_strict: Option<f64>,
}

impl Family {
    /// The number of required effects that are not declared not testable.
    pub fn asked(&self) -> usize {
        self.injected - self.not_observable
    }
}

/// The identifier of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Figure {
    /// F1 averaged over the families, counted strictly.
    Strict,
    /// Cases with a false name, of all cases.
    FalseCases,
    /// F1 averaged over the families.
    MacroF1,
    /// Cases with a false name, of those with only baseline effects.
    EmptyCases,
    /// Effects outside the catalogue that are refused on the right joint.
    OutsideRefused,
    /// Cases with an effect outside the catalogue and a wrong name.
    OutsideNamed,
    /// Relative errors of the main parameters.
    ParameterErrors,
    /// Intervals that contain the true value.
    Intervals,
    /// Injected effects that are named or are an alternative of a finding.
    Covered,
    /// Held-out errors over those with the true terms.
    HeldOut,
    /// Tracking errors over those with the exact model.
    Tracking,
    /// Confusions that the proposed experiment resolved.
    Confusions,
}

/// A figure with its target.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Target {
    /// The figure.
    #[serde(skip)]
    pub id: Figure,
    /// The cases that it counts, by the error of their URDFs; `None` for all cases.
    #[serde(skip)]
    pub group: Option<UrdfError>,
    /// The label.
    pub what: String,
    /// The value; `None` if there was nothing to count.
    pub figure: Option<f64>,
    /// The smallest value that meets it.
    pub at_least: Option<f64>,
    /// The largest value that meets it.
    pub at_most: Option<f64>,
    /// The counts, if the figure is a share.
    pub counted: Option<Counted>,
    /// The number of items.
    pub of: usize,
    /// Whether it is reached; `None` if there was nothing to count, or too little for a target with two ends, or if there is no
    /// target.
    pub reached: Option<bool>,
}
