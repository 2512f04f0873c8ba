//! Whether a constant torque in motion belongs to the torque sensor or to friction that depends on the direction.
//!
//! In one recording, no motion distinguishes the two. Between recordings, friction differs, because drives are warmer or colder: a
//! part of the friction then changes with its level, and the offset of a sensor does not. With the constants ĉ_r of the
//! recordings, their information H, and the Coulomb levels F_r, all from one fit, Q = min_a (a f − ĉ)ᵀ H (a f − ĉ) is compared for
//! f_r = F_r (friction) and f_r = 1 (sensor).

use effects::Term;
use effects::background::{OWN_CONSTANT, OWN_FRICTION};
use effects::friction::{COULOMB_FRICTION, FRICTION_ASYMMETRY};
use effects::laws::{ABS_SIGN, ONE, SIGN};
use effects::sensor::TORQUE_OFFSET;
use nalgebra::{DMatrix, DVector};

use crate::search::candidate::Hypothesis;
use crate::search::problem::Selection;
use crate::search::study::{Study, moved};
use crate::selection::bootstrap::{Resampled, resample};
use crate::selection::constant_torques::names;
use crate::selection::judge::{self, Judged};
use crate::selection::torque_constants::keep_named_ones;
use crate::thresholds::DIRECTION_NATS;

/// Renames the constant torques of the final fit that the differences between recordings call otherwise, and stores the evidence for
/// these names, and for those of asymmetric friction that are confirmed, in the study; returns the new resamplings if a name changes.
pub fn decide(study: &mut Study, judged: &mut Judged) -> Option<Resampled> {
    let mut changed = false;
    for member in judged.named.set.clone() {
        let Some(joint) = names(study, member) else { continue };
        let Some(constants) = Constants::new(study, &judged.named, member, joint) else {
            continue;
        };
        let nats = constants.evidence_for_friction();
        // Friction opposes the motion in each direction: the constant is smaller than the level.
        if nats.abs() < DIRECTION_NATS || nats > 0.0 && !constants.oppose_the_motion() {
            continue;
        }
        let is_friction = study.candidates[member].hypothesis.is(&FRICTION_ASYMMETRY);
        if is_friction == (nats > 0.0) {
            // An offset that keeps its name was not in doubt.
            if is_friction {
                study.directions.insert(joint, nats);
            }
        } else if rename(study, judged, member, joint, nats > 0.0) {
            study.directions.insert(joint, nats.abs());
            changed = true;
        }
    }
    changed.then(|| resample(study, &judged.named))
}

/// The constant torques of a joint in the training recordings that move it.
struct Constants {
    /// One per recording (N m or N).
    values: DVector<f64>,
    /// Their information.
    information: DMatrix<f64>,
    /// The Coulomb levels of the recordings (N m or N).
    levels: DVector<f64>,
}

impl Constants {
    /// Those in the place of the constant that `member` names on `joint`; `None` if fewer than two recordings move the joint, if
    /// friction is the same in all of them, or if the joint has no dry friction.
    fn new(study: &Study, selected: &Selection, member: usize, joint: usize) -> Option<Self> {
        let mut recordings = moved(&study.data.motions, &study.data.scales).swap_remove(joint);
        let stretches = &study.table.joints[joint].stretches;
        recordings.retain(|&recording| stretches.iter().any(|stretch| stretch.recording == recording));
        if recordings.len() < 2 || study.strengths.between_recordings(joint) <= 0.0 {
            return None;
        }
        let terms = &study.table.terms;
        let constant = study.candidates[member].columns.last().copied()?;
        let mut columns = selected.fit.selected().to_vec();
        columns.retain(|&column| column != constant);
        let common = columns.iter().position(|&column| terms[column] == Term::on(&SIGN, joint))?;
        let own_constant = |&recording: &usize| Term::on(&OWN_CONSTANT, joint).of(recording);
        let more = recordings.iter().map(own_constant).collect();
        let fit = study.fit_with(&columns, more, &selected.fit.weights);
        let count = recordings.len();
        let common = fit.coefficients[fit.background + common];
        // The terms of the background are the first of every table, so that their columns have the same indices in this fit.
        let level = |&recording: &usize| {
            let own = Term::on(&OWN_FRICTION, joint).of(recording);
            let column = terms.iter().position(|term| *term == own);
            common + column.map_or(0.0, |column| fit.coefficient(column))
        };
        Some(Self {
            values: DVector::from_column_slice(&fit.coefficients[fit.coefficients.len() - count..]),
            information: fit.information_of_last(count),
            levels: DVector::from_iterator(count, recordings.iter().map(level)),
        })
    }

    /// Whether the constants and the levels together are friction in both directions of all recordings.
    fn oppose_the_motion(&self) -> bool {
        self.values.iter().zip(&self.levels).all(|(constant, level)| constant.abs() < *level)
    }

    /// The evidence for friction that depends on the direction, against an offset of the sensor (nats; negative: for the offset).
    ///
    /// The variance of the constants about either law is unknown, because an offset may drift, too: it is at least that of the fit.
    fn evidence_for_friction(&self) -> f64 {
        let free = (self.values.len() - 1) as f64;
        let misfit = |shape: &DVector<f64>| free + self.misfit(shape);
        let sensor = misfit(&DVector::repeat(self.values.len(), 1.0));
        0.5 * free * (sensor / misfit(&self.levels)).ln()
    }

    /// min over a of (a f − c)ᵀ H (a f − c).
    fn misfit(&self, shape: &DVector<f64>) -> f64 {
        let weighted = &self.information * shape;
        let square = shape.dot(&weighted);
        let all = self.values.dot(&(&self.information * &self.values));
        if square > 0.0 { (all - self.values.dot(&weighted).powi(2) / square).max(0.0) } else { all }
    }
}

/// Replaces the name of `member` by asymmetric friction, or by an offset; returns whether that name is allowed.
fn rename(study: &mut Study, judged: &mut Judged, member: usize, joint: usize, is_friction: bool) -> bool {
    let [friction, offset, dry] = [
        (Hypothesis::of(&FRICTION_ASYMMETRY), vec![Term::on(&SIGN, joint), Term::on(&ABS_SIGN, joint)]),
        (Hypothesis::of(&TORQUE_OFFSET), vec![Term::on(&ONE, joint)]),
        (Hypothesis::of(&COULOMB_FRICTION), vec![Term::on(&SIGN, joint)]),
    ]
    .map(|(hypothesis, terms)| study.add(hypothesis, Some(joint), terms));
    let new = if is_friction { friction } else { offset };
    let mut set = judged.named.others(member);
    if is_friction {
        set.retain(|&c| c != dry);
    }
    let products = study.training_products();
    let problem = study.problem(&products);
    if !study.allowed().contains(&new) || set.iter().any(|&c| problem.exclude(c, new)) {
        return false;
    }
    // Another friction of the joint may state the Coulomb level.
    let level = study.candidates[dry].columns[0];
    let states_the_level = |&c: &usize| study.candidates[c].columns.contains(&level);
    if !is_friction && !set.iter().any(states_the_level) {
        set.push(dry);
    }
    set.push(new);
    keep_named_ones(study, &set);
    let products = study.training_products();
    let problem = study.problem(&products);
    let next = problem.choose(set, &judged.named.fit.weights);
    study.note("the constant torques of the recordings decide", &judged.named, &next);
    judged.members = judge::describe(&problem, &next);
    judged.named = next;
    true
}
