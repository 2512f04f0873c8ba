//! Weighs corrections of the columns (signs, order and zeros) by the evidence of all torques, and proposes the best.

use arm::Arm;
use diagnosis::{Agreement, Input, agreement, searched};
use effects::Effect;
use rayon::prelude::*;
use recording::RegularRecording;
use report::numbers::rounded;

use super::column_map::Change;
use super::correction::Correction;
use super::fit::fit;
use super::order;
use super::smooth::Smooth;
use super::thresholds::{
    BEYOND_LIMITS, CERTAIN, CERTAIN_WHERE_EXPLAINED, CONTRADICTS, HARDLY_REDUCED, LEAD, LEAST_INSTANTS, MAY_REMAIN,
    NOT_CONTRADICTED, ONE_CONTRADICTS_IN, OVERWHELMING, REDUCED, REPORTED, REPORTED_WHERE_EXPLAINED, SUPPORTS,
    UNEXPLAINED, WEIGHED, WORTH_WEIGHING,
};
use super::turns;

/// A correction of the recordings' columns that is proposed.
#[derive(Clone, Debug)]
pub struct Proposal {
    /// The joint, if it concerns one.
    pub joint: Option<String>,
    /// A description, with the remedy.
    pub text: String,
    /// The keys of a column map that correct it; empty if several corrections are as likely.
    pub changes: Vec<Change>,
    /// Whether the recordings cannot be diagnosed as they were read.
    pub is_certain: bool,
    /// The recordings that it concerns.
    pub recordings: Vec<usize>,
}

/// A correction with its evidence.
struct Weighed {
    correction: Correction,
    recordings: Vec<usize>,
    /// The evidence for it, in nats.
    nats: f64,
    /// That of each joint's torque.
    nats_of: Vec<f64>,
    with: Agreement,
}

/// The correction of signs, zeros and order that the torques of `recordings` show; `None` if they are best explained as they are.
///
/// A correction is found with the URDF's own model, and weighed with inertial parameters, friction and torque constants that differ
/// from the URDF as far as the evidence says. It is certain if it concerns a sign that friction shows, because friction never drives a
/// joint, or if several joints' torques show it, and if no effect of the catalogue explains the recordings as they are.
pub fn proposal(arm: &Arm, known: &[Effect], recordings: &[&RegularRecording]) -> Option<Proposal> {
    let mut scanned = scanned(arm, recordings);
    let is_worth = |one: &Scanned| one.gains.iter().any(|gain| *gain > WORTH_WEIGHING);
    if !scanned.iter().any(is_worth) {
        return None;
    }
    let weigh = |correction: Correction, of: &[usize], other: Option<&Agreement>| {
        let read: Vec<RegularRecording> = recordings
            .iter()
            .enumerate()
            .map(|(at, recording)| match of.contains(&at) {
                true => correction.applied(arm, recording),
                false => (*recording).clone(),
            })
            .collect();
        // Recordings that are too short to be diagnosed are refused later.
        agreement(&correction.arm(arm), &inputs(&read), known, other).ok()
    };
    let as_it_is = weigh(Correction::AsItIs, &[], None)?;
    let (mut first, rest): (Vec<Scanned>, Vec<Scanned>) = scanned.drain(..).partition(is_worth);
    first.truncate(WEIGHED);
    let is_hardly_explained = |joint: usize| as_it_is.unexplained.get(joint).is_some_and(|share| *share > MAY_REMAIN);
    let concerns_such = |one: &Scanned| {
        let joint = one.correction.joint();
        joint.is_some_and(|joint| is_hardly_explained(joint) || is_hardly_explained(joint + 1))
    };
    let more = rest
        .into_iter()
        .filter(|one| concerns_such(one) && one.gains.iter().sum::<f64>() > -NOT_CONTRADICTED * one.gains.len() as f64);
    let selected: Vec<Scanned> = first.into_iter().chain(more.take(WEIGHED)).collect();
    let mut weighed: Vec<Weighed> = selected
        .into_par_iter()
        .filter_map(|one| {
            let of = one.concerned();
            let with = weigh(one.correction, &of, Some(&as_it_is))?;
            let pairs = as_it_is.misfit_of.iter().zip(&with.misfit_of);
            Some(Weighed {
                correction: one.correction,
                recordings: of,
                nats: as_it_is.misfit - with.misfit,
                nats_of: pairs.map(|(before, after)| before - after).collect(),
                with,
            })
        })
        .collect();
    weighed.sort_by(|a, b| b.nats.total_cmp(&a.nats));
    let found = best_of(arm, &as_it_is, &weighed)?;
    let nats = nats_beside_catalogue(arm, known, recordings, &found, &as_it_is)?;
    // What the catalogue explains as well is a warning if it would be certain otherwise.
    let is_reported = nats > if found.is_shown { -REPORTED } else { REPORTED };
    is_reported.then(|| found.proposal(arm, &as_it_is, recordings, nats))
}

/// Recordings to be fitted.
fn inputs(recordings: &[RegularRecording]) -> Vec<Input<'_>> {
    let input = |recording| Input { name: "", recording, held_out: false, before: false };
    recordings.iter().map(input).collect()
}

/// The evidence for the best correction if the whole catalogue is searched with it and without it, in the recordings that it concerns:
/// springs, payloads and other effects may explain what looks like a wrong sign or zero. `None` if that cannot be computed.
fn nats_beside_catalogue(
    arm: &Arm,
    known: &[Effect],
    recordings: &[&RegularRecording],
    found: &Best<'_>,
    as_it_is: &Agreement,
) -> Option<f64> {
    let best = found.best;
    let old: Vec<RegularRecording> = best.recordings.iter().map(|&at| recordings[at].clone()).collect();
    let new: Vec<RegularRecording> = old.iter().map(|one| best.correction.applied(arm, one)).collect();
    let base = if best.recordings.len() < recordings.len() {
        // The base may hang otherwise in some of the recordings.
        let bases: Vec<Correction> = [Correction::AsItIs].into_iter().chain(Correction::bases(arm)).collect();
        let misfits: Vec<(f64, Arm)> = bases
            .into_par_iter()
            .map(|base| {
                let arm = base.arm(arm);
                let found = agreement(&arm, &inputs(&old), known, Some(as_it_is));
                (found.map_or(f64::INFINITY, |found| found.misfit), arm)
            })
            .collect();
        misfits.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))?.1
    } else {
        arm.clone()
    };
    let (without, with) = rayon::join(
        || searched(&base, &inputs(&old), known, as_it_is),
        || searched(arm, &inputs(&new), known, as_it_is),
    );
    Some(without.ok()? - with.ok()?)
}

/// A correction with its gain in each recording.
struct Scanned {
    correction: Correction,
    /// By how much it reduces the sum of the joints' log residuals.
    gains: Vec<f64>,
}

impl Scanned {
    /// The recordings that it concerns: all, or those that agree with it if others contradict it.
    fn concerned(&self) -> Vec<usize> {
        let gains = || self.gains.iter();
        let is_contradicted = gains().any(|gain| *gain > CONTRADICTS) && gains().any(|gain| *gain < -CONTRADICTS);
        (0..self.gains.len()).filter(|&at| !is_contradicted || self.gains[at] > 0.0).collect()
    }
}

/// All corrections with their gains by the URDF's own model, the largest first.
fn scanned(arm: &Arm, recordings: &[&RegularRecording]) -> Vec<Scanned> {
    let mut all: Vec<Scanned> = Vec::new();
    for (at, recording) in recordings.iter().enumerate() {
        let Some(order) = order(arm, recording) else { continue };
        let smooth = Smooth::of(recording, &order);
        if smooth.len() <= LEAST_INSTANTS {
            continue;
        }
        let before = fit(arm, &smooth, Correction::AsItIs).score();
        let gains: Vec<(Correction, f64)> = Correction::all(arm, &smooth.moves())
            .into_par_iter()
            .map(|correction| (correction, before - fit(arm, &smooth, correction).score()))
            .collect();
        for (correction, gain) in gains {
            match all.iter_mut().find(|known| known.correction == correction) {
                Some(known) => known.gains[at] = gain,
                None => {
                    let mut gains = vec![0.0; recordings.len()];
                    gains[at] = gain;
                    all.push(Scanned { correction, gains });
                }
            }
        }
    }
    let better = |one: &Scanned| one.gains.iter().map(|gain| gain.max(0.0)).sum::<f64>();
    let sum = |one: &Scanned| one.gains.iter().sum::<f64>();
    all.sort_by(|a, b| better(b).total_cmp(&better(a)).then(sum(b).total_cmp(&sum(a))));
    all
}

/// The best correction, with what is as likely.
struct Best<'a> {
    best: &'a Weighed,
    rivals: Vec<&'a Weighed>,
    /// Whether the base may hang from a ceiling or a wall as well.
    may_be_base: bool,
    /// The joint whose torque shows it most.
    shown_at: usize,
    /// The number of joints whose torques show it.
    supporters: usize,
    /// Whether it is certain by the model and friction alone.
    is_shown: bool,
}

/// The best of the corrections `weighed`, which begin with the one of most evidence; `None` if it has too little evidence to be reported.
fn best_of<'a>(arm: &Arm, as_it_is: &Agreement, weighed: &'a [Weighed]) -> Option<Best<'a>> {
    let is_base = |one: &Weighed| matches!(one.correction, Correction::Gravity(_));
    let most = weighed.first()?.nats;
    let close: Vec<&Weighed> = weighed.iter().filter(|one| most - one.nats < LEAD).collect();
    // A base on a wall or on a ceiling is an effect that the diagnosis finds, not an error of the recording.
    let best = *close.iter().find(|one| !is_base(one))?;
    // Of the two signs that differ only in the attitude of the arm, that of the torque is proposed: it is a convention of the sensor.
    let is_torque = |one: &&&Weighed| Some(one.correction) == best.correction.as_sign_of_the_torque();
    let best = *close.iter().find(is_torque).unwrap_or(&best);
    let may_be_base = close.iter().any(|one| is_base(one));
    let is_rival = |one: &&&Weighed| one.correction != best.correction && !is_base(one);
    let rivals: Vec<&Weighed> = close.iter().filter(is_rival).copied().collect();
    let supports = |&joint: &usize| best.nats_of[joint] > SUPPORTS;
    let supporters = (0..arm.dof()).filter(supports).count();
    let reduction = |joint: usize| as_it_is.unexplained[joint] / best.with.unexplained[joint].max(f64::MIN_POSITIVE);
    let shown_at = (0..arm.dof())
        .filter(supports)
        .max_by(|&a, &b| reduction(a).total_cmp(&reduction(b)))
        .or_else(|| (0..arm.dof()).max_by(|&a, &b| best.nats_of[a].total_cmp(&best.nats_of[b])))?;
    let (without, with) = (as_it_is.unexplained[shown_at], best.with.unexplained[shown_at]);
    let is_clear = without > UNEXPLAINED && without > REDUCED * with;
    let is_explained = |&joint: &usize| best.with.unexplained[joint] < MAY_REMAIN;
    let of = best.correction.joints(arm);
    let of_friction = best.correction.is_of_a_sign_of_friction();
    let is_overwhelming = best.nats > OVERWHELMING;
    let is_seen = with < MAY_REMAIN && (is_clear || best.nats > REPORTED_WHERE_EXPLAINED);
    if best.nats <= REPORTED || !(of_friction || is_seen || is_overwhelming) {
        return None;
    }
    let contradicts = |joint: &&usize| !is_explained(joint) && best.nats_of[**joint] < -SUPPORTS;
    let is_shown = if of_friction {
        is_clear || best.nats > CERTAIN
    } else {
        let has_evidence = best.nats > if is_clear { CERTAIN } else { CERTAIN_WHERE_EXPLAINED };
        let is_contradicted = of.iter().filter(contradicts).count() > of.len() / ONE_CONTRADICTS_IN;
        let is_reduced = without > HARDLY_REDUCED * with;
        supporters > 1 && has_evidence && is_reduced && (is_overwhelming || !is_contradicted)
    };
    Some(Best { best, rivals, may_be_base, shown_at, supporters, is_shown })
}

impl Best<'_> {
    /// The proposal, if the correction has the evidence `nats` beside the whole catalogue.
    fn proposal(&self, arm: &Arm, as_it_is: &Agreement, recordings: &[&RegularRecording], nats: f64) -> Proposal {
        let names: Vec<&str> = arm.joints().iter().map(|joint| joint.name.as_str()).collect();
        let best = self.best;
        let leaves_limits = best.recordings.iter().any(|&at| {
            let new = best.correction.applied(arm, recordings[at]);
            turns::beyond_limits(arm, &new.q) > turns::beyond_limits(arm, &recordings[at].q) + BEYOND_LIMITS
        });
        let is_certain = self.is_shown && !self.may_be_base && nats > CERTAIN && !leaves_limits;
        let is_one = self.rivals.iter().all(|other| other.correction.as_sign_of_the_torque() == Some(best.correction));
        let unexplained = |agreement: &Agreement| {
            let share = agreement.unexplained[self.shown_at].min(1.0);
            format!("{} %", rounded(100.0 * share, 2))
        };
        let mut text = format!(
            "{}: with this correction, {} of the torque's variance at {} remains unexplained by the model, other inertial parameters \
             and friction; without it, {}",
            best.correction.sentence(&names, is_certain && is_one),
            unexplained(&best.with),
            names[self.shown_at],
            unexplained(as_it_is)
        );
        let mut others: Vec<String> = self.rivals.iter().filter_map(|next| next.correction.words(&names)).collect();
        others.dedup();
        if !others.is_empty() {
            text += &format!(". As likely: {}", others.join(", or "));
        }
        if self.may_be_base {
            text += ". The base may also hang from a ceiling or a wall";
        } else if leaves_limits {
            text += ". With it, positions would lie beyond the URDF's limits, or farther beyond them, so that something else may be wrong";
        } else if !is_certain && self.supporters < 2 {
            text += ". No other joint's torque shows it, so that it may have another cause";
        } else if !is_certain {
            text += ". An effect that the model omits may be the cause, too";
        }
        // With the correct reading, the joints that it concerns are explained, unless they never were.
        let of = best.correction.joints(arm);
        let remains = |&joint: &usize| best.with.unexplained[joint] > MAY_REMAIN.max(2.0 * as_it_is.unexplained[joint]);
        let is_whole = !of.iter().any(remains);
        if is_certain && !is_whole {
            text += ". Other columns may be wrong, too, because torques remain unexplained";
        }
        Proposal {
            joint: best.correction.joint().map(|joint| names[joint].to_owned()),
            text,
            changes: if is_one && is_whole && !leaves_limits { best.correction.changes(&names) } else { Vec::new() },
            is_certain,
            recordings: best.recordings.clone(),
        }
    }
}
