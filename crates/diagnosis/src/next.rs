//! The next experiment: the motion within the robot's limits that best distinguishes findings from their alternatives.
//!
//! A motion that has not been recorded is added to the recordings by prediction: the torque that it needs by the findings, the
//! columns of the findings and of their alternatives along it, and an error as large as the recordings'. The alternatives are
//! then fitted in the findings' place as in the recordings ([`crate::selection::rivals`]), with all other effects refitted.

use std::collections::BTreeSet;

use arm::Arm;
use effects::{Detectability, Effect};
use rayon::prelude::*;
use torque::Reference;

use crate::data::measure;
use crate::findings::conclusion::Conclusion;
use crate::findings::observability;
use crate::report::{Confusable, Finding, NextExperiment, NotObservable, NotSeparated, Separation, Shows, Unexplained};
use crate::selection::{FinalFit, rivals};
use crate::thresholds::{COUNTED, MORE_DETECTABLE, SURELY_RESOLVED, SURELY_RESOLVED_BESIDE, WEIGHT_OF_SIZES};

mod advice;
pub(crate) mod designs;
pub(crate) mod limits;
mod prospect;

use designs::{DURATION, Design, FINE};
use limits::Limits;
use prospect::{Outlook, Pair, Prospect};

/// The part of speed and room that the other joints use in some of the tried motions.
const ASIDE: [f64; 2] = [0.2, 0.5];

/// The next experiment.
#[derive(Clone, Debug)]
pub struct Next {
    /// The part of the report.
    pub report: NextExperiment,
    /// The motion; `None` if no motion gives more information.
    pub motion: Option<Reference>,
}

/// A confusion, with what is needed to predict it.
struct Confusion {
    finding: Confusable,
    rival: Confusable,
    pair: Pair,
    /// Whether the findings explain the joint, or the whole arm.
    is_explained: bool,
    joints: Vec<usize>,
}

/// An effect that is not testable and whose torque is proportional to its size.
struct Hidden<'a> {
    entry: &'a NotObservable,
    parameter: &'static str,
    before: Option<f64>,
    joint: usize,
    /// Its column, and its candidate; `None` for a torque limit.
    column: Option<(usize, usize)>,
    /// The largest torque of the joint in the training recordings (N m or N).
    largest: f64,
}

/// A tried motion.
struct Tried {
    design: Design,
    /// The parts of the allowed speed and room that it uses.
    parts: [f64; 2],
    motion: Reference,
    separations: Vec<[f64; 2]>,
    shows: Vec<Option<f64>>,
    worth: f64,
}

/// Proposes a motion for the confusions of the findings, and for the effects that are not testable yet. It predicts nothing for
/// joints that are not explained. `known` are the effects that are known in addition to the model `arm`.
///
/// # Errors
/// If the effects cannot be added to the model.
pub fn propose(
    last: &FinalFit,
    conclusion: &Conclusion,
    arm: &Arm,
    known: &[Effect],
) -> Result<Next, torque::TorqueError> {
    let unexplained = &conclusion.unexplained;
    let (confusions, unpredicted) = confusions(last, &conclusion.findings, unexplained);
    let hidden = visible(last, &conclusion.not_observable);
    let columns = confusions.iter().flat_map(|c| c.pair.instead.iter().flat_map(|(set, _)| set).chain(&c.pair.without));
    let columns = columns.copied().chain(hidden.iter().filter_map(|h| Some(h.column?.0)));
    let nothing = Next {
        report: NextExperiment {
            duration: None,
            separates: Vec::new(),
            not_separated: unpredicted.clone(),
            shows: Vec::new(),
            limits: Vec::new(),
        },
        motion: None,
    };
    let Some(prospect) = Prospect::new(last, columns.collect()) else {
        return Ok(nothing);
    };
    let effects: Vec<Effect> = known.iter().cloned().chain(conclusion.effects()).collect();
    let limits = Limits::new(&last.study.data, (arm, &effects), unexplained.is_empty())?;
    let has_background = last.products.has_background();
    let now = prospect.now();
    let before: Vec<[f64; 2]> = confusions.iter().map(|c| prospect.separation(&now, &c.pair)).collect();
    let attempt = |design: Design| -> Option<Tried> {
        let (motion, parts) = design.within(&limits)?;
        Some(tried(&prospect, &confusions, &hidden, (design, parts), motion))
    };
    let mut list: Vec<Tried> = designs::all().into_par_iter().filter_map(attempt).collect();
    if let Some(best) = best(&list) {
        let concerned: BTreeSet<usize> = confusions.iter().flat_map(|c| c.joints.iter().copied()).collect();
        if !concerned.is_empty() && concerned.len() < arm.dof() {
            let aside = ASIDE.map(|others| Design {
                only: concerned.iter().copied().collect(),
                others,
                ..list[best].design.clone()
            });
            let more: Vec<Tried> = aside.into_par_iter().filter_map(attempt).collect();
            list.extend(more);
        }
    }
    // A motion that exceeds the limits a little between two samples is scaled down and predicted again; it may no longer be
    // the best.
    while let Some(best) = best(&list) {
        let (design, parts) = (list[best].design.clone(), list[best].parts);
        match design.surely_within(&limits, parts) {
            Some((_, within)) if within == parts => {
                let mut next = described(has_background, &limits, &confusions, &hidden, &before, &list, best);
                next.report.not_separated.extend(unpredicted);
                return Ok(next);
            }
            Some((motion, within)) => {
                list[best] = tried(&prospect, &confusions, &hidden, (design, within), motion);
            }
            None => drop(list.remove(best)),
        }
    }
    Ok(nothing)
}

/// The first of the designs with the largest value.
fn best(list: &[Tried]) -> Option<usize> {
    (0..list.len()).max_by(|&a, &b| list[a].worth.total_cmp(&list[b].worth).then(b.cmp(&a)))
}

fn tried(
    prospect: &Prospect<'_>,
    confusions: &[Confusion],
    hidden: &[Hidden<'_>],
    (design, parts): (Design, [f64; 2]),
    motion: Reference,
) -> Tried {
    let outlook = prospect.with(&motion);
    let separations: Vec<[f64; 2]> = confusions.iter().map(|c| prospect.separation(&outlook, &c.pair)).collect();
    let shows = shows(prospect, &outlook, hidden);
    let apart = separations.iter().map(|[apart, needed]| (apart / needed).clamp(COUNTED.0, COUNTED.1).ln());
    let seen = hidden.iter().zip(&shows).map(|(hidden, after)| match (hidden.gain(*after), after) {
        (Some(gain), _) => gain.clamp(0.0, 2.0),
        // Detectable at no size before, and at some size now.
        (None, Some(_)) => 1.0,
        (None, None) => 0.0,
    });
    let worth = apart.sum::<f64>() + WEIGHT_OF_SIZES * seen.sum::<f64>();
    Tried { design, parts, motion, separations, shows, worth }
}

impl Hidden<'_> {
    /// The logarithm of the factor by which the detectable size becomes smaller (for a limit: larger).
    fn gain(&self, after: Option<f64>) -> Option<f64> {
        let ratio = (self.before? / after?).ln();
        Some(if self.column.is_some() { ratio } else { -ratio })
    }
}

/// The detectable sizes of the `hidden` effects.
fn shows(prospect: &Prospect<'_>, outlook: &Outlook, hidden: &[Hidden<'_>]) -> Vec<Option<f64>> {
    let wanted: Vec<(usize, usize)> = hidden.iter().filter_map(|h| Some((h.joint, h.column?.0))).collect();
    let mut seen = prospect.visibility(outlook, &wanted).into_iter();
    let size = |hidden: &Hidden<'_>| match hidden.column {
        // A limit shows where it removes as large a part of the torque.
        None => Some(hidden.before? * outlook.largest[hidden.joint] / hidden.largest),
        Some((column, candidate)) => {
            let candidate = &prospect.last.study.candidates[candidate];
            let least = observability::least(prospect.last, candidate, column, &seen.next()?);
            least.and_then(|least| least.size)
        }
    };
    hidden.iter().map(size).collect()
}

/// The alternatives of each finding, as sets of columns, and those without columns, for which nothing can be predicted. Findings
/// without columns (a contact, a second encoder) are omitted.
fn confusions(
    last: &FinalFit,
    findings: &[(Finding, Option<usize>)],
    unexplained: &[Unexplained],
) -> (Vec<Confusion>, Vec<NotSeparated>) {
    let (study, selected) = (&last.study, &last.judged.named);
    let columns_of = |set: &[usize]| -> Vec<usize> {
        let columns = set.iter().flat_map(|&c| study.candidates[c].columns.iter().copied());
        columns.collect::<BTreeSet<usize>>().into_iter().collect()
    };
    let index = |name: &str| study.data.arm.joints().iter().position(|joint| joint.name == name);
    let (mut list, mut unpredicted) = (Vec::new(), Vec::new());
    for (finding, member) in findings {
        let Some(member) = *member else { continue };
        let this = &study.candidates[member];
        let set = rivals::beside(study, selected, member);
        let alias = rivals::alias(study, selected, member, &set);
        let with = |added: &[usize]| columns_of(&[&set, added].concat());
        for rival in &finding.confusable_with {
            let joint = rival.joint.as_deref().and_then(index);
            let is_it = |c: &usize| {
                let other = &study.candidates[*c];
                let finer = this.columns.iter().all(|column| other.columns.contains(column));
                other.hypothesis.name() == Some(rival.effect) && !finer && (other.joint == joint)
            };
            let forms: Vec<usize> = (0..study.candidates.len()).filter(is_it).collect();
            let is_alias =
                alias.is_some_and(|(hypothesis, place)| hypothesis.name() == Some(rival.effect) && place == joint);
            let instead: Vec<(Vec<usize>, Vec<usize>)> = if is_alias {
                // In the finding's place, this alternative would be the finding itself.
                vec![(selected.fit.selected().to_vec(), Vec::new())]
            } else if this.hypothesis.spec().same_on_all_joints == Some(rival.effect) {
                let is_factor = |c: &usize| study.candidates[*c].hypothesis.name() == Some(rival.effect);
                let all: Vec<usize> = (0..study.candidates.len()).filter(is_factor).collect();
                vec![(with(&all), all)]
            } else {
                forms.iter().map(|&form| (with(&[form]), vec![form])).collect()
            };
            // Wrong inertial parameters have no columns of their own: they are in the background.
            if instead.is_empty() {
                unpredicted.push(advice::unpredicted(
                    Confusable { effect: finding.effect, joint: finding.joint.clone() },
                    rival.clone(),
                    study.data.arm.joints().last().map(|joint| &*joint.name),
                ));
                continue;
            }
            let pair = Pair { without: columns_of(&set), instead };
            list.push(Confusion {
                finding: Confusable { effect: finding.effect, joint: finding.joint.clone() },
                rival: rival.clone(),
                pair,
                is_explained: !unexplained.iter().any(|open| {
                    let on = |joint: &Option<String>| joint.as_ref().is_none_or(|joint| *joint == open.joint);
                    on(&finding.joint) || on(&rival.joint)
                }),
                joints: this.joint.into_iter().chain(joint).collect(),
            });
        }
    }
    (list, unpredicted)
}

/// The `hidden` effects whose size can be predicted without simulation: torque limits of which some would be seen now, and linear effects.
fn visible<'a>(last: &FinalFit, hidden: &'a [NotObservable]) -> Vec<Hidden<'a>> {
    let (study, selected) = (&last.study, &last.judged.named);
    let largest = measure::largest(&study.data.motions);
    let of = |entry: &'a NotObservable| {
        let name = entry.joint.as_deref()?;
        let joint = study.data.arm.joints().iter().position(|joint| joint.name == name)?;
        let spec = effects::spec(entry.effect)?;
        let largest = largest[joint];
        if matches!(spec.detectability, Detectability::Limit { .. }) {
            let (parameter, before) = entry.would_be_seen_below.iter().next()?;
            return Some(Hidden { entry, parameter, before: Some(*before), joint, column: None, largest });
        }
        if !matches!(spec.detectability, Detectability::Linear { .. }) {
            return None;
        }
        let parameter = *spec.main.first()?;
        let mut candidates = study.candidates.iter();
        let candidate = candidates.position(|candidate| {
            candidate.hypothesis.name() == Some(entry.effect) && candidate.joint == Some(joint)
        })?;
        let column = study.candidates[candidate].columns.iter().rev().find(|c| !selected.fit.columns.contains(c))?;
        Some(Hidden {
            entry,
            parameter,
            before: entry.would_be_seen_above.values().next().copied(),
            joint,
            column: Some((*column, candidate)),
            largest,
        })
    };
    hidden.iter().filter_map(of).collect()
}

/// The next experiment with the motion `best` of `list`. Beside a background, more evidence is needed for a promise.
fn described(
    has_background: bool,
    limits: &Limits,
    confusions: &[Confusion],
    hidden: &[Hidden<'_>],
    before: &[[f64; 2]],
    list: &[Tried],
    best: usize,
) -> Next {
    let selected = &list[best];
    let sure = if has_background { SURELY_RESOLVED_BESIDE } else { SURELY_RESOLVED };
    let (mut separates, mut not_separated) = (Vec::new(), Vec::new());
    for (k, confusion) in confusions.iter().enumerate() {
        let [after, needed] = selected.separations[k];
        let (finding, rival) = (confusion.finding.clone(), confusion.rival.clone());
        let barred = advice::barred(
            confusion.is_explained,
            has_background && advice::resembles_links(rival.effect),
            before[k][0] >= SURELY_RESOLVED * before[k][1].min(needed),
        );
        if after >= sure * needed && barred.is_none() {
            separates.push(Separation { finding, rival, before: before[k][0], after, needed: sure * needed });
            continue;
        }
        let all = list.iter().map(|tried| tried.separations[k]);
        let furthest = all.max_by(|a, b| (a[0] / a[1]).total_cmp(&(b[0] / b[1])));
        let furthest = furthest.unwrap_or([after, needed]);
        not_separated.push(advice::not_separated(finding, rival, furthest, sure * furthest[1], barred));
    }
    let shows: Vec<Shows> = hidden
        .iter()
        .zip(&selected.shows)
        .filter_map(|(hidden, after)| {
            let after = (*after)?;
            let is_better = hidden.gain(Some(after)).is_none_or(|gain| gain > -MORE_DETECTABLE.ln());
            is_better.then(|| Shows {
                effect: hidden.entry.effect,
                joint: hidden.entry.joint.clone(),
                parameter: hidden.parameter,
                before: hidden.before,
                after,
            })
        })
        .collect();
    let is_useful = !separates.is_empty() || !shows.is_empty();
    let needed = limits.needed(&selected.motion, DURATION, FINE);
    Next {
        motion: is_useful.then(|| selected.motion.clone()),
        report: NextExperiment {
            duration: is_useful.then_some(DURATION),
            separates,
            not_separated,
            shows,
            limits: if is_useful { needed } else { Vec::new() },
        },
    }
}
