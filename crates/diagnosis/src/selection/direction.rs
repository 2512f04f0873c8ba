//! Whether a constant torque in motion belongs to the torque sensor or to friction that depends on the direction.
//!
//! In one recording, no motion distinguishes the two. Between recordings, friction differs, because drives are warmer or colder: a
//! part of the friction then changes with its level, and the offset of a sensor does not. With the constants ĉ_r of the
//! recordings, their information H, and the Coulomb levels F_r, all from one fit, Q = min_a (a f − ĉ)ᵀ H (a f − ĉ) is compared for
//! f_r = F_r (friction) and f_r = 1 (sensor).

use std::cmp::Ordering;

use effects::Term;
use effects::background::OWN_FRICTION;
use effects::friction::{CoulombFriction, FrictionAsymmetry};
use effects::laws::{ABS_SIGN, ONE, SIGN};
use effects::sensor::TorqueOffset;
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
/// all of these names in the study; returns the new resamplings if a name changes.
pub fn decide(study: &mut Study, judged: &mut Judged) -> Option<Resampled> {
    let mut changed = false;
    for member in judged.named.set.clone() {
        let Some(joint) = names(study, member) else { continue };
        let Some((level, constant)) = level_and_constant(study, &judged.named, member, joint) else {
            continue;
        };
        let Some(nats) = evidence_for_friction(study, &judged.named, member, joint, level) else {
            continue;
        };
        let is_friction = study.candidates[member].hypothesis.is(&FrictionAsymmetry);
        let may_be = match nats.partial_cmp(&0.0) {
            // Friction does not drive a joint.
            Some(Ordering::Greater) => constant.abs() < level,
            _ => true,
        };
        if nats.abs() < DIRECTION_NATS || !may_be {
            continue;
        }
        study.directions.insert(joint, nats.abs());
        if is_friction != (nats > 0.0) {
            rename(study, judged, member, joint, nats);
            changed = true;
        }
    }
    changed.then(|| resample(study, &judged.named))
}

/// The Coulomb level and the constant torque of a joint in the fit (N m or N), if the two may be asymmetric friction.
fn level_and_constant(study: &Study, selected: &Selection, member: usize, joint: usize) -> Option<(f64, f64)> {
    let terms = &study.table.terms;
    let coefficient = |wanted: Term| {
        let column = terms.iter().position(|term| *term == wanted)?;
        let is_fitted = selected.fit.selected().contains(&column);
        is_fitted.then(|| selected.fit.coefficient(column))
    };
    let level = coefficient(Term::on(&SIGN, joint)).filter(|level| *level > 0.0)?;
    let constant = study.candidates[member].columns.iter().rev().copied().next()?;
    Some((level, selected.fit.coefficient(constant)))
}

/// The evidence for friction that depends on the direction, against an offset of the sensor (nats; negative: for the offset); `None`
/// if fewer than two recordings move the joint, or if friction is the same in all of them.
///
/// The variance of the constants about either law is unknown, because an offset may drift, too: it is at least that of the fit.
fn evidence_for_friction(study: &Study, selected: &Selection, member: usize, joint: usize, level: f64) -> Option<f64> {
    let recordings = moved(&study.motions, &study.scales).swap_remove(joint);
    if recordings.len() < 2 || study.strengths.friction <= 0.0 {
        return None;
    }
    let columns = selected.fit.selected();
    let constant = *study.candidates[member].columns.last()?;
    let others: Vec<usize> = columns.iter().copied().filter(|&column| column != constant).collect();
    let of = |recording: usize, form: usize| Term::on(&OWN_FRICTION, joint).of(recording).form(form);
    let more = recordings.iter().map(|&recording| of(recording, 2)).collect();
    let (products, fit) = study.fit_with(&others, more, &selected.fit.weights);
    let count = recordings.len();
    let constants = DVector::from_column_slice(&fit.coefficients[fit.coefficients.len() - count..]);
    let information = fit.information_of_last(count) * products.evidence_per_row(joint);
    // The terms of the background are the first of every table, so that their columns have the same indices in this fit.
    let own = |&recording: &usize| {
        let term = of(recording, 0);
        let column = study.table.terms.iter().position(|other| *other == term);
        column.map_or(0.0, |column| fit.coefficient(column))
    };
    let common = others
        .iter()
        .position(|&column| study.table.terms[column] == Term::on(&SIGN, joint));
    let level = common.map_or(level, |at| fit.coefficients[fit.background + at]);
    let levels = DVector::from_iterator(count, recordings.iter().map(|recording| level + own(recording)));
    let free = (count - 1) as f64;
    let misfit = |shape: &DVector<f64>| free + least(&information, &constants, shape);
    let (friction, sensor) = (misfit(&levels), misfit(&DVector::repeat(count, 1.0)));
    Some(0.5 * free * (sensor / friction).ln())
}

/// min over a of (a f − c)ᵀ H (a f − c).
fn least(information: &DMatrix<f64>, constants: &DVector<f64>, shape: &DVector<f64>) -> f64 {
    let weighted = information * shape;
    let square = shape.dot(&weighted);
    let all = constants.dot(&(information * constants));
    if square > 0.0 {
        (all - constants.dot(&weighted).powi(2) / square).max(0.0)
    } else {
        all
    }
}

/// Replaces the name of `member` by the other one.
fn rename(study: &mut Study, judged: &mut Judged, member: usize, joint: usize, nats: f64) {
    let [friction, offset, dry] = [
        (
            Hypothesis::of(&FrictionAsymmetry),
            vec![Term::on(&SIGN, joint), Term::on(&ABS_SIGN, joint)],
        ),
        (Hypothesis::of(&TorqueOffset), vec![Term::on(&ONE, joint)]),
        (Hypothesis::of(&CoulombFriction), vec![Term::on(&SIGN, joint)]),
    ]
    .map(|(hypothesis, terms)| study.add(hypothesis, Some(joint), terms));
    let mut set = judged.named.others(member);
    if nats > 0.0 {
        set.retain(|&c| study.candidates[c].columns != study.candidates[dry].columns);
        set.push(friction);
    } else {
        set.extend([dry, offset]);
    }
    keep_named_ones(study, &set);
    let products = study.training_products();
    let problem = study.problem(&products);
    let next = problem.choose(set, &judged.named.fit.weights);
    study.note("the constant torque of each recording decides", &judged.named, &next);
    judged.members = judge::describe(study, &problem, &next);
    judged.named = next;
}
