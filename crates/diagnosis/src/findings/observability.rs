//! Effects that are not testable with the recordings, and the size from which they are detectable.

use std::collections::BTreeMap;

use effects::arm::PAYLOAD;
use effects::{Detectability, Effect, Kind};
use rayon::prelude::*;

use crate::regression::fit::Products;
use crate::report::NotObservable;
use crate::search::candidate::Candidate;
use crate::search::physics::is_beyond_physics;
use crate::search::problem::Selection;
use crate::selection::FinalFit;
use crate::selection::of_noise::noise;
use crate::thresholds::{BEYOND, FEW_JOINTS, HIDDEN, SURELY_SEEN};

/// Why an effect is not testable whose torque others resemble.
const EXPLAINED: &str = "the effects found explain the same torque in these motions";

/// The detectability of a column on a joint.
pub struct Visibility {
    /// The amount that it adds, at a coefficient of one, to the weighted sum of squares in addition to the findings.
    pub own: f64,
    /// Its standard deviation.
    pub spread: f64,
    /// The number of moving rows.
    pub count: f64,
    /// The number of independent pieces of evidence.
    pub evidence: f64,
    /// The standard deviation of the joint's torque (N m or N).
    pub torque: f64,
    /// The least share of a named effect.
    pub least_share: f64,
}

impl Visibility {
    /// The least coefficient with the evidence `needed` (nats) and the least share of a named effect.
    pub fn least(&self, needed: f64) -> f64 {
        let count = self.count.max(1.0);
        let drop = count * ((2.0 * needed / self.evidence.max(1e-9)).exp() - 1.0);
        let by_evidence = (drop / self.own.max(1e-300)).sqrt();
        let by_share = self.least_share * self.torque / self.spread.max(1e-300);
        by_evidence.max(by_share)
    }
}

/// The least detectable size of a linear effect.
pub struct DetectableSize {
    /// Its share of the joint's torque.
    pub share: f64,
    /// The size; `None` if no robot can have it.
    pub size: Option<f64>,
}

/// The least detectable size of `candidate`, whose `column` is as visible as `visibility` tells. `None` if its size is not a coefficient.
pub fn least(last: &FinalFit, candidate: &Candidate, column: usize, visibility: &Visibility) -> Option<DetectableSize> {
    let Detectability::Linear { is_of_first, is_of_all_torque, .. } = candidate.hypothesis.spec().detectability else {
        return None;
    };
    let least = visibility.least(needed(last, candidate));
    let share = if is_of_all_torque { least } else { least * visibility.spread / visibility.torque.max(1e-300) };
    let (study, fit) = (&last.study, &last.judged.named.fit);
    let size = if is_of_first { least / fit.coefficient(candidate.columns[0]).max(0.0) } else { least };
    let is_beyond = share > BEYOND
        || is_beyond_a_factor(candidate, size)
        || is_beyond_physics(least, column, candidate, &study.table, fit, &study.data.arm);
    let size = Some(size).filter(|size| !is_beyond && size.is_finite());
    Some(DetectableSize { share, size })
}

/// Whether the main parameter of `candidate` is a factor, and `size` so far from one that the factor may be zero.
fn is_beyond_a_factor(candidate: &Candidate, size: f64) -> bool {
    let spec = candidate.hypothesis.spec();
    let main = spec.parameters.iter().find(|parameter| spec.main.first() == Some(&parameter.key));
    main.is_some_and(|main| main.neutral == 1.0) && size >= 1.0
}

/// The effects that are not testable in addition to those of the final fit.
pub fn not_testable(last: &FinalFit) -> Vec<NotObservable> {
    let (data, products) = (&last.study.data, &last.products);
    let dof = data.motions.dof;
    let mut list: Vec<NotObservable> =
        (0..dof).into_par_iter().flat_map_iter(|joint| on_joint(last, joint)).chain(on_arm(last)).collect();
    for joint in 0..dof {
        if products.count[joint] > 0.0 {
            continue;
        }
        // A channel without torque has no scale.
        let name = &data.arm.joints()[joint].name;
        let because = if data.not_diagnosed.iter().any(|group| group.joints.contains(name)) {
            "the joint is not diagnosed"
        } else if data.scales.torque[joint] == 0.0 {
            "the recordings hold no torque of the joint"
        } else {
            "the joint does not move in the training recordings"
        };
        for kind in in_turn().filter(|kind| kind.spec().is_baseline) {
            list.push(NotObservable {
                effect: kind.spec().name,
                joint: Some(data.arm.joints()[joint].name.clone()),
                because: because.into(),
                would_be_seen_above: BTreeMap::new(),
                would_be_seen_below: BTreeMap::new(),
            });
        }
    }
    list
}

/// The effects on the whole arm whose torque wrong links, or the findings, resemble: a tool, a tilted base, a common factor.
fn on_arm(last: &FinalFit) -> Vec<NotObservable> {
    let (study, selected) = (&last.study, &last.judged.named);
    let backgrounds = study.with_stronger_links(selected);
    let mut list = Vec::new();
    for kind in in_turn() {
        let Detectability::OfArm { columns } = kind.spec().detectability else {
            continue;
        };
        let is_found = selected.set.iter().any(|&c| study.candidates[c].hypothesis.kind == kind);
        let always = |&c: &usize| study.candidates[c].hypothesis.kind == kind && study.always_acts(c);
        let forms: Vec<&Candidate> = (0..study.candidates.len()).filter(always).map(|c| &study.candidates[c]).collect();
        let (Some(&key), Some(candidate), false) = (kind.spec().main.first(), forms.first(), is_found) else {
            continue;
        };
        let needed = forms.iter().map(|form| needed(last, form)).fold(f64::INFINITY, f64::min);
        let least = |&column: &usize| {
            // Links that are wrong by more would explain a part of it, and cost evidence themselves.
            let beside = |(products, other): &(Products, Selection)| {
                let evidence = products.evidence_of(&study.table, &other.fit, column);
                let cost = other.score - selected.score;
                ((needed - cost).max(0.0) / evidence.max(1e-300)).sqrt()
            };
            let size = backgrounds.iter().map(beside).fold(0.0, f64::max);
            let share = |joint| study.data.share(joint, size * spread(last, joint, column));
            (size, (0..study.data.motions.dof).map(share).fold(0.0, f64::max), column)
        };
        let hardest = candidate.columns.iter().take(columns).map(least);
        let Some((size, share, column)) = hardest.max_by(|a, b| a.0.total_cmp(&b.0)) else {
            continue;
        };
        if share <= HIDDEN {
            continue;
        }
        let (table, arm) = (&study.table, &study.data.arm);
        // A payload that the last joints do not feel is a part of a link, and one on a short arm is a part of all links.
        let is_payload = forms.iter().any(|form| form.hypothesis.is(&PAYLOAD));
        let may_be_links = study.data.arm.dof() <= FEW_JOINTS || !study.are_felt_at_the_end(&[column], &[1.0]);
        let is_beyond = share > BEYOND
            || is_beyond_a_factor(candidate, size)
            || is_payload && may_be_links && study.stated.links != Some(0.0)
            || is_beyond_physics(size, column, candidate, table, &selected.fit, arm);
        list.push(NotObservable {
            effect: kind.spec().name,
            joint: None,
            because: EXPLAINED.to_owned(),
            would_be_seen_above: (!is_beyond).then_some((key, size)).into_iter().collect(),
            would_be_seen_below: BTreeMap::new(),
        });
    }
    list
}

fn on_joint(last: &FinalFit, joint: usize) -> Vec<NotObservable> {
    let (study, products, selected) = (&last.study, &last.products, &last.judged.named);
    let name = &study.data.arm.joints()[joint].name;
    if products.count[joint] == 0.0 {
        return Vec::new();
    }
    let found: Vec<Kind> = selected
        .set
        .iter()
        .map(|&c| &study.candidates[c])
        .filter(|candidate| candidate.joint == Some(joint))
        .map(|candidate| candidate.hypothesis.kind)
        .collect();
    let mut list = Vec::new();
    for kind in in_turn().filter(|kind| !found.contains(kind)) {
        let Some(&key) = kind.spec().main.first() else { continue };
        let mut add = |because: &str, above: Option<f64>, below: Option<f64>| {
            list.push(NotObservable {
                effect: kind.spec().name,
                joint: Some(name.clone()),
                because: because.to_owned(),
                would_be_seen_above: above.map(|size| (key, size)).into_iter().collect(),
                would_be_seen_below: below.map(|size| (key, size)).into_iter().collect(),
            });
        };
        let excludes = |a: Kind, b: Kind| a.spec().excludes.contains(&b.spec().name);
        let is_excluded = found.iter().any(|&other| excludes(kind, other) || excludes(other, kind));
        match kind.spec().detectability {
            Detectability::Sized { .. } if is_excluded => add(EXPLAINED, None, None),
            Detectability::Never | Detectability::OfArm { .. } => {}
            of_sizes @ (Detectability::Limit { because, if_none } | Detectability::Sized { because, if_none, .. }) => {
                let is_seen_below = !matches!(of_sizes, Detectability::Sized { is_seen_below: false, .. });
                let may_be_named = |size: f64| {
                    let effect = Effect::of(kind.spec()).with(key, size);
                    (kind.spec().is_certain)(&effect, &|_| None, 0.0)
                };
                // Sizes in ascending order.
                let mut sizes: Vec<(f64, bool)> = of(&study.candidates, kind, joint)
                    .map(|candidate| {
                        let size = study.table.terms[candidate.columns[0]].sizes[0];
                        (size, is_seen(last, candidate, joint))
                    })
                    .collect();
                sizes.sort_by(|a, b| a.0.total_cmp(&b.0));
                if is_seen_below {
                    // The largest detectable size for which all smaller ones are detectable.
                    let last = sizes.iter().take_while(|(_, seen)| *seen).last();
                    let because = if last.is_none() { if_none } else { because };
                    add(because, None, last.map(|&(size, _)| size));
                } else {
                    if let Some(unnamed) = sizes.iter().position(|&(size, _)| !may_be_named(size)) {
                        // The last size that is named is no size from which on an effect is named.
                        sizes.truncate(unnamed.saturating_sub(1));
                    }
                    let least = sizes.iter().rev().take_while(|(_, seen)| *seen).last();
                    let because = if least.is_none() { if_none } else { because };
                    add(because, least.map(|&(size, _)| size), None);
                }
            }
            Detectability::Linear { if_no_form, .. } => {
                let Some(candidate) = of(&study.candidates, kind, joint).next() else {
                    if let Some(because) = if_no_form {
                        add(because, None, None);
                    }
                    continue;
                };
                let is_new = |column: &&usize| !selected.fit.columns.contains(*column);
                let Some(&column) = candidate.columns.iter().rev().find(is_new) else {
                    continue;
                };
                let visibility = Visibility {
                    own: products.drop_of(&study.table, &selected.fit, column),
                    spread: spread(last, joint, column),
                    count: products.count[joint],
                    evidence: products.evidence[joint],
                    torque: study.data.scales.torque[joint],
                    least_share: study.thresholds.least_share,
                };
                if let Some(least) = least(last, candidate, column, &visibility).filter(|least| least.share > HIDDEN) {
                    add(EXPLAINED, least.size, None);
                }
            }
        }
    }
    list
}

/// The kinds of effects in the order of `not_observable`.
fn in_turn() -> impl Iterator<Item = Kind> {
    let mut kinds: Vec<Kind> = Kind::all().filter(|kind| kind.name().is_some()).collect();
    kinds.sort_by_key(|kind| kind.spec().not_testable_turn);
    kinds.into_iter()
}

fn of(candidates: &[Candidate], kind: Kind, joint: usize) -> impl Iterator<Item = &Candidate> {
    let is_it = move |candidate: &&Candidate| candidate.hypothesis.kind == kind && candidate.joint == Some(joint);
    candidates.iter().filter(is_it)
}

/// The evidence that a name needs here (nats); more where links are wrong and resemble it.
fn needed(last: &FinalFit, candidate: &Candidate) -> f64 {
    let is_wrong = last.study.strengths.common() > 0.0;
    let beside_inertials = candidate.hypothesis.spec().least_beside_inertials.filter(|_| is_wrong);
    let least = candidate.cost.max(last.study.thresholds.least_evidence);
    least.max(beside_inertials.unwrap_or(0.0))
}

/// Whether an effect with a coefficient of one would surely have been detected at its size. Its torque is simulated along the recorded motion,
/// and a real one differs from it, so that a part of it must suffice.
fn is_seen(last: &FinalFit, candidate: &Candidate, joint: usize) -> bool {
    let (study, products) = (&last.study, &last.products);
    let column = candidate.columns[0];
    let fit = &last.judged.named.fit;
    // The noise in a simulated column takes as much from the fit as it adds to the column.
    let noise = noise(study, candidate, joint);
    let count = products.count[joint].max(1.0);
    let drop = products.drop_of(&study.table, fit, column) - 2.0 * noise * count * fit.weights[joint];
    let drop = SURELY_SEEN * SURELY_SEEN * drop.max(0.0);
    let nats = 0.5 * products.evidence[joint] * (1.0 + drop / count).ln();
    let torque = SURELY_SEEN * (spread(last, joint, column).powi(2) - noise).max(0.0).sqrt();
    let share = study.data.share(joint, torque);
    nats > needed(last, candidate) && share > study.thresholds.least_share
}

/// The standard deviation of a column on a joint's moving training rows.
fn spread(last: &FinalFit, joint: usize, column: usize) -> f64 {
    let table = &last.study.table;
    table.place[joint][column]
        .map_or(0.0, |place| table.spread(joint, &last.study.data.fitted, &table.joints[joint].x[place]))
}
