//! Texts for the names of the catalogue.

use std::cmp::Ordering;
use std::collections::BTreeSet;

use arm::JointKind;
pub use diagnosis::list;
use diagnosis::statistics::rms;
use diagnosis::{
    Change, Confusable, Dependence, Finding, JointFit, NotObservable, Parameter, Report, Verdict, Written,
};
use effects::Regressor;

use crate::{not_diagnosed, numbers};

/// The verdict states the largest held-out error with the effects found if it is at least this (over the torque's standard
/// deviation).
const STATED_ERROR: f64 = 0.1;
/// With a larger error than this (over the torque's standard deviation), the model is not said to explain the recordings, although the
/// error looks like noise.
const NOISY: f64 = 0.5;
/// Most of the mismatch is said to be unexplained if at least this error remains (over the torque's standard deviation).
const STATED_REST: f64 = 0.2;

/// The texts of an effect.
pub struct Wording {
    /// Its title in two or three words.
    pub name: &'static str,
    /// Its meaning, for readers who do not know it.
    pub meaning: &'static str,
    /// The experiment that distinguishes it from similar effects.
    distinguished_by: &'static str,
    /// The parameters that measure its size, the best first.
    pub main: &'static [&'static str],
}

/// The title of a finding's effect. Friction that only the motor's current shows is between motor and torque sensor.
pub fn effect(finding: &Finding) -> String {
    let effect = &finding.as_effect;
    let name = effect.title();
    if finding.is_motor_side() {
        format!("motor-side {name}")
    } else {
        let change = match finding.change {
            // The title says what is missing.
            Some(Change::Added) if name != finding.as_effect.spec().title => "",
            Some(Change::Added) => " (new)",
            Some(Change::Increased) => " (increase)",
            Some(Change::Removed) => " (before)",
            Some(Change::Reduced) => " (decrease)",
            None => "",
        };
        format!("{name}{change}")
    }
}

/// Whether a finding is between two sensors of its joint, so that its torque is not a part of the measured one.
pub fn is_between_sensors(finding: &Finding) -> bool {
    !finding.corrects && finding.joint.is_some() && finding.place.state.is_some()
}

/// A finding's share of the torque; a spring between two encoders has none.
pub fn share(finding: &Finding) -> Option<f64> {
    (finding.is_motor_side() || !is_between_sensors(finding)).then_some(finding.share)
}

/// A finding's effect with its parameters, as a noun phrase; for a finding between two sensors, with its place.
pub fn described(finding: &Finding) -> String {
    // A parameter has as many digits as its interval supports, as in the table.
    let quantity = |name: &str, parameter: &Parameter, written: Written| {
        let (text, _) = numbers::value_and_interval(name, parameter);
        match written {
            Written::Percent => match text.strip_suffix(" %") {
                Some(percent) => percent.to_owned(),
                None => numbers::quantity(100.0 * parameter.value, "1"),
            },
            Written::InUnit => text,
        }
    };
    let text = diagnosis::described(finding, &quantity);
    match &finding.place.state {
        Some(place) if !finding.corrects => format!("{text}, {place}"),
        _ => text,
    }
}

/// The texts of a catalogue name; an unknown name is its own title.
pub fn wording(effect: &'static str) -> Wording {
    match effects::spec(effect) {
        Some(spec) => Wording {
            name: spec.title,
            meaning: spec.meaning,
            distinguished_by: spec.distinguished_by,
            main: spec.main,
        },
        None => Wording { name: effect, meaning: "", distinguished_by: "", main: &[] },
    }
}

/// The experiments that distinguish a finding from its alternatives: that for the pair, where there is one, and else that for the
/// effect.
pub fn experiments(finding: &Finding) -> String {
    let for_effect = wording(finding.effect).distinguished_by;
    let for_pair = |other: &Confusable| effects::experiment_against(finding.effect, other.effect).unwrap_or(for_effect);
    let of_pairs = (!finding.confusable_with_pairs.is_empty()).then_some(for_effect);
    let mut list: Vec<&str> = Vec::new();
    for text in finding.confusable_with.iter().map(for_pair).chain(of_pairs) {
        if !text.is_empty() && !list.contains(&text) {
            list.push(text);
        }
    }
    list.join("; ")
}

/// A parameter's name in words.
pub fn parameter(name: &str) -> String {
    match (name, name.strip_prefix("com_")) {
        (_, Some(axis)) => format!("centre of mass, {axis}"),
        ("halfgap", _) => "half the gap".to_owned(),
        _ => name.replace('_', " "),
    }
}

/// `start` with a capital.
pub fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().collect::<String>() + letters.as_str())
}

/// The joint, or the whole arm.
pub fn joint(joint: Option<&str>) -> &str {
    joint.unwrap_or("whole arm")
}

/// What predicts a residual, in words.
pub fn dependence(dependence: &Dependence) -> String {
    match dependence.on {
        Regressor::OwnPosition => "the joint's position".into(),
        Regressor::OwnSpeed => "the joint's velocity".into(),
        Regressor::Time => "time".into(),
        Regressor::History => "the joint's past motion (hysteresis)".into(),
        Regressor::Load => "the load torque".into(),
        Regressor::OwnPositionTimesSpeed => "the product of the joint's position and velocity".into(),
        Regressor::PositionScale => "the scale of the joint's recorded position".into(),
        Regressor::BaseMotion => "the torque of the arm on its base".into(),
        Regressor::ToolPosition => "the arm's posture, as a force on the tool".into(),
        Regressor::ToolVelocity => "the tool's velocity".into(),
        Regressor::OtherJoint => format!("the motion of {}", other(dependence)),
        Regressor::OtherTorque => format!("the torque of {} (crosstalk between channels?)", other(dependence)),
    }
}

/// The other joint that a residual depends on.
fn other(dependence: &Dependence) -> &str {
    dependence.joint.as_deref().unwrap_or("another joint")
}

/// The joint on which a finding is largest: its own, or the one with the largest share.
pub fn shows_on(finding: &Finding) -> Option<&str> {
    finding.joint.as_deref().or_else(|| {
        let shares = finding.share_by_joint.iter();
        let largest = shares.max_by(|(_, a), (_, b)| a.total_cmp(b));
        largest.map(|(joint, _)| joint.as_str())
    })
}

/// The changes since the recordings from before (`--before`) in a sentence, which comes before everything else; nothing if a
/// load that only some recordings have is the only one.
pub fn changed(report: &Report) -> Option<String> {
    let text = match report.changed.as_deref()? {
        [] if report.different_load.is_some() => return None,
        [] if report.verdict == Verdict::NotEnoughData => return None,
        [] => no_change(report),
        list => format!("Changed since the recordings from before: {}.", list.join("; ")),
    };
    Some(text)
}

/// That nothing has changed, as far as it would show.
fn no_change(report: &Report) -> String {
    let hidden = match report.unexplained.len() {
        0 => String::new(),
        1 => format!(" The unexplained residual on {} may hide one.", open_joints(report)),
        _ => format!(" The unexplained residuals on {} may hide one.", open_joints(report)),
    };
    format!("Since the recordings from before, no change was found.{hidden}")
}

/// The joints with an unexplained residual, or their number if there are more than three.
fn open_joints(report: &Report) -> String {
    let open: Vec<String> = report.unexplained.iter().map(|open| open.joint.clone()).collect();
    if open.len() > 3 { format!("{} joints", open.len()) } else { list(&open) }
}

/// Whether most of the mismatch is unexplained.
pub fn is_mostly_unexplained(report: &Report) -> bool {
    match report.verdict {
        Verdict::Unexplained => true,
        Verdict::PartlyExplained => remaining(report).is_some(),
        _ => false,
    }
}

/// The verdict in one sentence or two. When most of the mismatch remains unexplained, the first sentence says so. A sentence on joints
/// that were not diagnosed comes before it.
pub fn verdict(report: &Report) -> String {
    let others = of_diagnosed(report);
    not_diagnosed::before_verdict(report).map_or_else(|| others.clone(), |joints| format!("{joints} {others}"))
}

fn of_diagnosed(report: &Report) -> String {
    // What is in the recordings from before only is no error of the model.
    let found: Vec<&Finding> = report.findings.iter().filter(|finding| finding.acts_today()).collect();
    let effects = count(found.len(), "effect");
    let joints: BTreeSet<_> = found.iter().filter_map(|f| f.joint.as_deref()).collect();
    let has_whole_arm = found.iter().any(|finding| finding.joint.is_none());
    let mut on = Vec::new();
    if !joints.is_empty() {
        on.push(match joints.len() {
            1 => joints.iter().map(|joint| (*joint).to_owned()).collect(),
            several => format!("{several} joints"),
        });
    }
    if has_whole_arm {
        on.push("the whole arm".to_owned());
    }
    let on = list(&on);
    let open = open_joints(report);
    let is_validated = !report.recordings.held_out.is_empty();
    match report.verdict {
        Verdict::NoMismatch if found.is_empty() => {
            format!("The model {}: no unmodelled effect is detectable in them.", explains(report))
        }
        Verdict::NoMismatch => format!("The model explains the recordings, apart from {effects} on {on}."),
        Verdict::Explained if is_validated => {
            format!("The model omits {effects} on {on}. With these effects, the model {}.", explains(report))
        }
        Verdict::Explained => format!(
            "The model omits {effects} on {on}. With these effects, the model fits the training recordings; the fit is \
             not validated, because no recording is held out."
        ),
        Verdict::PartlyExplained => {
            let open = if open.is_empty() {
                "The effects account for a part of the mismatch only.".to_owned()
            } else {
                format!("An unmodelled residual remains on {open}.")
            };
            match remaining(report) {
                Some(errors) => {
                    let [before, after] = errors.map(numbers::nrmse);
                    let change = match errors[0].total_cmp(&errors[1]) {
                        _ if before == after => format!("remains {after}"),
                        Ordering::Less => format!("rises from {before} to {after}"),
                        _ => format!("only falls from {before} to {after}"),
                    };
                    format!(
                        "Most of the mismatch is unexplained: with {effects} on {on}, the RMS torque error over the joints \
                         {change} times the torque's standard deviation. {open}"
                    )
                }
                None => format!("The model omits {effects} on {on}. {open}"),
            }
        }
        Verdict::Unexplained if open.is_empty() => {
            "The mismatch between model and recordings is unexplained: no effect in the catalogue accounts for it."
                .into()
        }
        Verdict::Unexplained => {
            format!("The mismatch on {open} is unexplained: no effect in the catalogue accounts for it.")
        }
        Verdict::NotEnoughData => "The recordings do not contain enough data for a diagnosis.".into(),
        Verdict::UnitsFirst => {
            "Units, signs, order or zeros first: no effect was searched, because the recordings do not fit \
                                the robot as they were read. If they are right, --as-read searches nevertheless."
                .into()
        }
    }
}

/// `explains the recordings`, with the largest error on the held-out recordings unless it is small. A large error that looks like noise
/// is not explained.
fn explains(report: &Report) -> String {
    let has_other_friction = |joint: &str| report.held_out_friction.iter().any(|other| other.joint == joint);
    match largest_error(report) {
        None => "explains the recordings".to_owned(),
        Some((joint, error)) if has_other_friction(joint) => format!(
            "explains the training recordings; with their friction, the error on the held-out ones is {} times the torque's standard \
             deviation ({joint})",
            numbers::nrmse(error)
        ),
        Some((joint, error)) if error >= NOISY => format!(
            "leaves a residual that looks like noise, of {} times the torque's standard deviation ({joint})",
            numbers::nrmse(error)
        ),
        Some((joint, error)) => format!(
            "explains the recordings to within {} times the torque's standard deviation ({joint})",
            numbers::nrmse(error)
        ),
    }
}

/// The joint with the largest error on the held-out recordings with the effects found, if the error is large enough to be
/// stated.
fn largest_error(report: &Report) -> Option<(&str, f64)> {
    let errors = report.fit.iter();
    let errors = errors.filter_map(|(joint, fit)| Some((joint.as_str(), fit.held_out_nrmse_augmented?)));
    let largest = errors.max_by(|a, b| a.1.total_cmp(&b.1))?;
    (largest.1 >= STATED_ERROR).then_some(largest)
}

/// The RMS over the joints of the relative torque error, nominal and with the effects found, where more than half of it
/// and a considerable error remains; on held-out recordings where there are any. Joints that no training recording moves do not count: no
/// effect is searched on them.
fn remaining(report: &Report) -> Option<[f64; 2]> {
    let is_fitted = |fit: &&JointFit| fit.train_nrmse_nominal > 0.0;
    let over_joints = |pick: &dyn Fn(&JointFit) -> f64| rms(report.fit.values().filter(is_fitted).map(pick));
    let before = over_joints(&|fit| fit.held_out_nrmse_nominal.unwrap_or(fit.train_nrmse_nominal))?;
    let after = over_joints(&|fit| fit.held_out_nrmse_augmented.unwrap_or(fit.train_nrmse_augmented))?;
    (before.is_finite() && after > (0.5 * before).max(STATED_REST)).then_some([before, after])
}

/// `1 effect`, `3 effects`.
pub fn count(number: usize, what: &str) -> String {
    let ending = if number == 1 { "" } else { "s" };
    format!("{number} {what}{ending}")
}

/// The sizes from which an effect on a joint of `kind` is detectable, with the units of its parameters: `half the gap above 2 mrad`.
pub fn detectable_sizes(entry: &NotObservable, kind: JointKind) -> String {
    let above = entry.would_be_seen_above.iter().map(|size| ("above", size));
    let below = entry.would_be_seen_below.iter().map(|size| ("below", size));
    let sizes = above.chain(below).map(|(side, (name, size))| {
        let unit = effects::spec(entry.effect).and_then(|spec| spec.unit(name, kind));
        let size = numbers::round_quantity(*size, unit.filter(|unit| *unit != "1").unwrap_or_default());
        match name.strip_suffix("factor") {
            // The size of a factor is its distance from one.
            Some(_) => format!("{} off by more than {size}", parameter(name)),
            None => format!("{} {side} {size}", parameter(name)),
        }
    });
    sizes.collect::<Vec<_>>().join(", ")
}
