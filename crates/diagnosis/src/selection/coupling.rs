//! Couplings of two joints against a torque on one of them alone.
//!
//! A drive that turns with two joints has the same coefficients on both (action and reaction). If only one of them shows the torque, it
//! may depend on the other joint's motion for another reason, such as a cable or friction under a load that is not recorded.

use effects::{Against, Term};

use crate::search::problem::Selection;
use crate::search::study::Study;
use crate::selection::rivals::probability;
use crate::thresholds::SUREST;

/// A torque along the motion of another joint that acts on one joint only.
pub struct OnOneJoint {
    /// The joint that shows it.
    pub joint: usize,
    /// The joint whose motion it follows.
    pub other: usize,
    /// The evidence for a torque on both joints against the one on this joint (nats, with as many coefficients).
    pub margin: f64,
}

impl OnOneJoint {
    /// The best alternative of the coupling `member` of the fit `selected`; `None` for other effects.
    pub fn of(study: &Study, selected: &Selection, member: usize) -> Option<Self> {
        let candidate = &study.candidates[member];
        if candidate.hypothesis.spec().against != Against::OtherSpeed {
            return None;
        }
        let pair = [candidate.joint?, candidate.hypothesis.other?];
        let fit = &selected.fit;
        let columns: Vec<usize> = fit.selected().to_vec();
        let others: Vec<usize> = columns.iter().copied().filter(|column| !candidate.columns.contains(column)).collect();
        let both = study.fit_with(&columns, Vec::new(), &fit.weights).loss;
        let alone = |[joint, other]: [usize; 2]| {
            let terms = candidate.columns.iter().map(|&column| Term {
                joint: Some(joint),
                of: [joint, other],
                ..study.table.terms[column]
            });
            let margin = study.fit_with(&others, terms.collect(), &fit.weights).loss - both;
            Self { joint, other, margin }
        };
        let alternatives = [alone(pair), alone([pair[1], pair[0]])];
        alternatives.into_iter().min_by(|a, b| a.margin.total_cmp(&b.margin))
    }
}

/// That a torque on one joint alone explains about as much as a named coupling, as a note; `None` if both joints show each coupling.
pub fn note(study: &Study, selected: &Selection) -> Option<String> {
    let name = |joint: usize| study.data.arm.joints()[joint].name.as_str();
    let of = |&member: &usize| {
        let one = OnOneJoint::of(study, selected, member).filter(|one| probability(one.margin) < SUREST)?;
        let (shown, other) = (name(one.joint), name(one.other));
        Some(format!(
            "a torque on {shown} alone that depends on the motion of {other} explains about as much as a coupling of the two joints, \
             because the torque of {other} hardly shows it. A recording in which only {shown} moves would tell"
        ))
    };
    let notes: Vec<String> = selected.set.iter().filter_map(of).collect();
    (!notes.is_empty()).then(|| notes.join(". "))
}
