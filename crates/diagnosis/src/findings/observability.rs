//! Effects that the recordings could not show, and the size from which they would have been seen.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::findings::report::NotObservable;
use crate::regression::fit::Products;
use crate::regression::term::Term;
use crate::search::candidate::{Candidate, Cause};
use crate::search::problem::Chosen;
use crate::search::study::Study;
use crate::selection::judge::{LEAST_EVIDENCE, LEAST_SHARE};

/// A linear effect is said to be hidden if it could be as large as this part of the joint's torque unseen.
const HIDDEN: f64 = 0.06;

/// Effects whose torque is in proportion to one parameter, and that parameter.
pub const LINEAR: [(Cause, &str); 7] = [
    (Cause::Drag, "coefficient"),
    (Cause::RotorInertia, "inertia"),
    (Cause::Thermal, "amplitude"),
    (Cause::LoadDependent, "gain"),
    (Cause::TorqueScale, "factor"),
    (Cause::Spring, "stiffness"),
    (Cause::EncoderOffset, "offset"),
];

/// How well a column shows on a joint.
pub struct Visibility {
    /// What it adds, at a coefficient of one, to the weighted sum of squares beside what was found.
    pub own: f64,
    /// Its standard deviation.
    pub spread: f64,
    /// Moving rows.
    pub count: f64,
    /// Pieces of evidence.
    pub evidence: f64,
    /// The standard deviation of the joint's torque (N m or N).
    pub torque: f64,
}

impl Visibility {
    /// The least coefficient that brings the evidence `needed` (nats) and the share that a name needs.
    pub fn least(&self, needed: f64) -> f64 {
        let count = self.count.max(1.0);
        let drop = count * ((2.0 * needed / self.evidence.max(1e-9)).exp() - 1.0);
        let by_evidence = (drop / self.own.max(1e-300)).sqrt();
        let by_share = LEAST_SHARE * self.torque / self.spread.max(1e-300);
        by_evidence.max(by_share)
    }
}

/// What could not be seen beside `chosen`.
pub fn unseen(study: &Study, products: &Products, chosen: &Chosen) -> Vec<NotObservable> {
    let dof = study.motions.dof;
    let mut list: Vec<NotObservable> = (0..dof)
        .into_par_iter()
        .flat_map_iter(|joint| on_joint(study, products, chosen, joint))
        .collect();
    for joint in 0..dof {
        if products.count[joint] > 0.0 {
            continue;
        }
        for effect in ["coulomb_friction", "viscous_friction", "rotor_inertia"] {
            list.push(NotObservable {
                effect,
                joint: Some(study.arm.joints()[joint].name.clone()),
                because: "the joint does not move in the training recordings".into(),
                would_be_seen_above: BTreeMap::new(),
                would_be_seen_below: BTreeMap::new(),
            });
        }
    }
    list
}

fn on_joint(study: &Study, products: &Products, chosen: &Chosen, joint: usize) -> Vec<NotObservable> {
    let name = &study.arm.joints()[joint].name;
    if products.count[joint] == 0.0 {
        return Vec::new();
    }
    let found: Vec<Cause> = chosen
        .set
        .iter()
        .map(|&c| &study.candidates[c])
        .filter(|candidate| candidate.joint == Some(joint))
        .map(|candidate| candidate.cause)
        .collect();
    let mut list = Vec::new();
    let mut add =
        |effect: Cause, because: String, above: Option<(&'static str, f64)>, below: Option<(&'static str, f64)>| {
            list.push(NotObservable {
                effect: effect.name().unwrap_or_default(),
                joint: Some(name.clone()),
                because,
                would_be_seen_above: above.into_iter().collect(),
                would_be_seen_below: below.into_iter().collect(),
            });
        };
    if !found.contains(&Cause::Saturation) {
        let largest = study
            .motions
            .chunks
            .iter()
            .filter(|chunk| study.fitted[chunk.recording])
            .flat_map(|chunk| &chunk.tau[joint])
            .fold(0.0_f64, |largest, tau| largest.max(tau.abs()));
        add(
            Cause::Saturation,
            "no torque limit was reached".into(),
            None,
            Some(("limit", largest)),
        );
    }
    for cause in [Cause::Backlash, Cause::Elasticity, Cause::Delay] {
        if found.contains(&cause) {
            continue;
        }
        // Sizes from the least to the most visible.
        let mut visible: Vec<(f64, bool)> = of(study, cause, joint)
            .map(|candidate| {
                (
                    size(study, candidate),
                    is_seen(study, products, chosen, candidate, joint),
                )
            })
            .collect();
        visible.sort_by(|a, b| a.0.total_cmp(&b.0));
        match cause {
            Cause::Elasticity => {
                // The stiffest that is seen, with all softer ones.
                let stiffest = visible.iter().take_while(|(_, seen)| *seen).last();
                let because = "a stiffer joint deflects less than these recordings show";
                add(
                    cause,
                    because.into(),
                    None,
                    stiffest.map(|&(size, _)| ("stiffness", size)),
                );
            }
            _ => {
                let key = if cause == Cause::Backlash { "halfgap" } else { "delay" };
                let least = visible.iter().rev().take_while(|(_, seen)| *seen).last();
                let because = match (cause, least) {
                    (Cause::Backlash, None) => "the joint's load does not turn, so that a gap is never crossed",
                    (Cause::Backlash, _) => "a smaller gap is crossed too quickly to be seen",
                    _ => "a shorter delay shifts the torque by less than its noise",
                };
                add(cause, because.into(), least.map(|&(size, _)| (key, size)), None);
            }
        }
    }
    for (cause, key) in LINEAR {
        if found.contains(&cause) {
            continue;
        }
        let Some(candidate) = of(study, cause, joint).next() else {
            if cause == Cause::Thermal {
                add(
                    cause,
                    "the recordings are shorter than a drive takes to warm".into(),
                    None,
                    None,
                );
            }
            continue;
        };
        let Some(&column) = candidate
            .columns
            .iter()
            .rev()
            .find(|c| !chosen.fit.columns.contains(*c))
        else {
            continue;
        };
        let visibility = Visibility {
            own: products.drop_of(&study.table, &chosen.fit, column),
            spread: spread(study, joint, column),
            count: products.count[joint],
            evidence: products.evidence[joint],
            torque: study.scales.torque[joint],
        };
        let least = visibility.least(needed(candidate));
        // A scale is told by the rigid torque alone, but it is a part of all of the joint's torque.
        let share = match cause {
            Cause::TorqueScale => least,
            _ => least * visibility.spread / visibility.torque.max(1e-300),
        };
        if share > HIDDEN {
            let because = "other effects found explain the same torque in these motions";
            // What warms is a part of the dry friction; without that it has no size.
            let size = match cause {
                Cause::Thermal => least / chosen.fit.coefficient(candidate.columns[0]).max(0.0),
                _ => least,
            };
            add(cause, because.into(), size.is_finite().then_some((key, size)), None);
        }
    }
    list
}

fn of(study: &Study, cause: Cause, joint: usize) -> impl Iterator<Item = &Candidate> {
    study
        .candidates
        .iter()
        .filter(move |candidate| candidate.cause == cause && candidate.joint == Some(joint))
}

fn size(study: &Study, candidate: &Candidate) -> f64 {
    match study.table.terms[candidate.columns[0]] {
        Term::Gap { halfgap, .. } => halfgap,
        Term::Elastic { stiffness, .. } => stiffness,
        Term::Late { delay, .. } => delay,
        _ => f64::NAN,
    }
}

/// The evidence that a name needs here (nats).
pub fn needed(candidate: &Candidate) -> f64 {
    candidate.cost.max(LEAST_EVIDENCE)
}

/// Whether an effect of unit coefficient would have been seen at its size.
fn is_seen(study: &Study, products: &Products, chosen: &Chosen, candidate: &Candidate, joint: usize) -> bool {
    let column = candidate.columns[0];
    let drop = products.drop_of(&study.table, &chosen.fit, column);
    let nats = 0.5 * products.evidence[joint] * (1.0 + drop / products.count[joint].max(1.0)).ln();
    let share = spread(study, joint, column) / study.scales.torque[joint].max(1e-300);
    nats > needed(candidate) && share > LEAST_SHARE
}

/// The standard deviation of a column on a joint's moving training rows.
fn spread(study: &Study, joint: usize, column: usize) -> f64 {
    let Some(place) = study.table.place[joint][column] else {
        return 0.0;
    };
    let x = &study.table.joints[joint].x[place];
    let rows = study.training_rows(joint);
    let n = rows.len().max(1) as f64;
    let mean = rows.iter().map(|&r| x[r]).sum::<f64>() / n;
    (rows.iter().map(|&r| (x[r] - mean).powi(2)).sum::<f64>() / n).sqrt()
}
