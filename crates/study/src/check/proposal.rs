//! Weighs suppositions on signs, order and zeros of the recordings by the evidence of all their torques.

use arm::Arm;
use diagnosis::{Agreement, Input, agreement, searched};
use effects::Effect;
use rayon::prelude::*;
use recording::RegularRecording;
use report::numbers::rounded;

use super::column_map::Change;
use super::fit::fit;
use super::smooth::Smooth;
use super::supposition::Supposition;
use super::{LEAST_INSTANTS, order};
use crate::turns;

/// The number of suppositions that are weighed.
const WEIGHED: usize = 8;
/// A supposition is weighed if it reduces the sum of the joints' log residuals in a recording by this much: the model is that of the
/// URDF, so that other inertial parameters may hide most of the reduction.
const WORTH_WEIGHING: f64 = 0.05;
/// A supposition on a joint whose torque is hardly explained, or on the joint before it, is also weighed if it increases the sum by less
/// than this: the model's part of such a torque may be small.
const NOT_CONTRADICTED: f64 = 0.5;
/// Recordings contradict each other on a supposition if it changes the sum by more than this, up in one and down in another.
const CONTRADICTS: f64 = 2.0;
/// The evidence from which a supposition is told (nats), and from which it is certain. Source: of 184 simulated cases with URDFs exact or
/// wrong by 3 to 30 %, whose recordings are as they should be, one has a supposition of more than 20 nats: 67, for the zero of a last joint
/// whose torque is explained without it. Of 430 perturbed recordings of 16 robots, nine in ten have more than 100.
const TOLD: f64 = 20.0;
const CERTAIN: f64 = 40.0;
/// The same for a torque that is nearly explained without the supposition.
const TOLD_WHERE_EXPLAINED: f64 = 100.0;
const CERTAIN_WHERE_EXPLAINED: f64 = 200.0;
/// The evidence that an effect outside the catalogue on one of the joints does not put into doubt (nats).
const OVERWHELMING: f64 = 500.0;
/// The least share of the variance of a joint's torque that is unexplained without a supposition, and by how many times a supposition
/// reduces it.
const UNEXPLAINED: f64 = 0.02;
const REDUCED: f64 = 3.0;
/// The evidence of one joint's torque with which the joint supports a supposition (nats).
const SUPPORTS: f64 = 15.0;
/// A supposition is the only one if the next one has less evidence by this much (nats).
const LEAD: f64 = 10.0;
/// A supposition that moves positions beyond the URDF's limits by this much more than they are is not certain (rad or m).
const BEYOND_LIMITS: f64 = 0.3;
/// The share of the variance of a joint's torque that may remain with a correct reading of the joint.
const EXPLAINED: f64 = 0.3;

/// What is supposed of recordings.
#[derive(Clone, Debug)]
pub struct Supposed {
    /// The joint, if it concerns one.
    pub joint: Option<String>,
    /// A description, with the remedy.
    pub text: String,
    /// The keys of a column map that correct it; empty if several suppositions are as likely.
    pub changes: Vec<Change>,
    /// Whether the recordings cannot be diagnosed as they were read.
    pub is_certain: bool,
    /// The recordings that it concerns.
    pub recordings: Vec<usize>,
}

/// A supposition with its evidence.
struct Weighed {
    supposition: Supposition,
    recordings: Vec<usize>,
    /// The evidence for it, in nats.
    nats: f64,
    /// That of each joint's torque.
    nats_of: Vec<f64>,
    with: Agreement,
}

/// What the torques of `recordings` tell about their signs, zeros and order; `None` if they are best explained as they are.
///
/// A supposition is found with the URDF's own model, and weighed with inertial parameters, friction and torque constants that differ
/// from the URDF as far as the evidence says. It is certain if it concerns a sign that friction shows, because friction never drives a
/// joint, or if several joints' torques show it, and if no effect of the catalogue explains the recordings as they are.
pub fn supposed(arm: &Arm, known: &[Effect], recordings: &[&RegularRecording]) -> Option<Supposed> {
    let mut scanned = scanned(arm, recordings);
    let is_worth = |one: &Scanned| one.gains.iter().any(|gain| *gain > WORTH_WEIGHING);
    if !scanned.iter().any(is_worth) {
        return None;
    }
    let weigh = |supposition: Supposition, of: &[usize], other: Option<&Agreement>| {
        let read: Vec<RegularRecording> = recordings
            .iter()
            .enumerate()
            .map(|(at, recording)| match of.contains(&at) {
                true => supposition.applied(arm, recording),
                false => (*recording).clone(),
            })
            .collect();
        // Recordings that are too short to be diagnosed are refused later.
        agreement(&supposition.arm(arm), &inputs(&read), known, other).ok()
    };
    let as_it_is = weigh(Supposition::AsItIs, &[], None)?;
    let (mut first, rest): (Vec<Scanned>, Vec<Scanned>) = scanned.drain(..).partition(is_worth);
    first.truncate(WEIGHED);
    let is_hardly_explained = |joint: usize| as_it_is.unexplained.get(joint).is_some_and(|share| *share > EXPLAINED);
    let concerns_such = |one: &Scanned| {
        let joint = one.supposition.joint();
        joint.is_some_and(|joint| is_hardly_explained(joint) || is_hardly_explained(joint + 1))
    };
    let more = rest
        .into_iter()
        .filter(|one| concerns_such(one) && one.gains.iter().sum::<f64>() > -NOT_CONTRADICTED * one.gains.len() as f64);
    let chosen: Vec<Scanned> = first.into_iter().chain(more.take(WEIGHED)).collect();
    let mut weighed: Vec<Weighed> = chosen
        .into_par_iter()
        .filter_map(|one| {
            let of = one.concerned();
            let with = weigh(one.supposition, &of, Some(&as_it_is))?;
            let pairs = as_it_is.misfit_of.iter().zip(&with.misfit_of);
            Some(Weighed {
                supposition: one.supposition,
                recordings: of,
                nats: as_it_is.misfit - with.misfit,
                nats_of: pairs.map(|(before, after)| before - after).collect(),
                with,
            })
        })
        .collect();
    weighed.sort_by(|a, b| b.nats.total_cmp(&a.nats));
    let judged = judged(arm, &as_it_is, &weighed)?;
    let nats = nats_beside_catalogue(arm, known, recordings, &judged, &as_it_is)?;
    // What the catalogue explains as well is a warning if it would be certain otherwise.
    let is_told = nats > if judged.is_shown { -TOLD } else { TOLD };
    is_told.then(|| judged.told(arm, &as_it_is, recordings, nats))
}

/// Recordings to be fitted.
fn inputs(recordings: &[RegularRecording]) -> Vec<Input<'_>> {
    let input = |recording| Input {
        name: "",
        recording,
        held_out: false,
        before: false,
    };
    recordings.iter().map(input).collect()
}

/// The evidence for the best supposition if the whole catalogue is searched with it and without it, in the recordings that it concerns:
/// springs, payloads and other effects may explain what looks like a wrong sign or zero. `None` if that cannot be computed.
fn nats_beside_catalogue(
    arm: &Arm,
    known: &[Effect],
    recordings: &[&RegularRecording],
    judged: &Judged<'_>,
    as_it_is: &Agreement,
) -> Option<f64> {
    let best = judged.best;
    let old: Vec<RegularRecording> = best.recordings.iter().map(|&at| recordings[at].clone()).collect();
    let new: Vec<RegularRecording> = old.iter().map(|one| best.supposition.applied(arm, one)).collect();
    let base = if best.recordings.len() < recordings.len() {
        // The base may hang otherwise in some of the recordings.
        let bases: Vec<Supposition> = [Supposition::AsItIs]
            .into_iter()
            .chain(Supposition::bases(arm))
            .collect();
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

/// A supposition with its gain in each recording.
struct Scanned {
    supposition: Supposition,
    /// By how much it reduces the sum of the joints' log residuals.
    gains: Vec<f64>,
}

impl Scanned {
    /// The recordings that it concerns: all, or those that agree with it if others contradict it.
    fn concerned(&self) -> Vec<usize> {
        let gains = || self.gains.iter();
        let is_contradicted = gains().any(|gain| *gain > CONTRADICTS) && gains().any(|gain| *gain < -CONTRADICTS);
        (0..self.gains.len())
            .filter(|&at| !is_contradicted || self.gains[at] > 0.0)
            .collect()
    }
}

/// All suppositions with their gains by the URDF's own model, the largest first.
fn scanned(arm: &Arm, recordings: &[&RegularRecording]) -> Vec<Scanned> {
    let mut all: Vec<Scanned> = Vec::new();
    for (at, recording) in recordings.iter().enumerate() {
        let Some(order) = order(arm, recording) else { continue };
        let smooth = Smooth::of(recording, &order);
        if smooth.len() <= LEAST_INSTANTS {
            continue;
        }
        let before = fit(arm, &smooth, Supposition::AsItIs).score();
        let gains: Vec<(Supposition, f64)> = Supposition::all(arm, &smooth.moves())
            .into_par_iter()
            .map(|supposition| (supposition, before - fit(arm, &smooth, supposition).score()))
            .collect();
        for (supposition, gain) in gains {
            match all.iter_mut().find(|known| known.supposition == supposition) {
                Some(known) => known.gains[at] = gain,
                None => {
                    let mut gains = vec![0.0; recordings.len()];
                    gains[at] = gain;
                    all.push(Scanned { supposition, gains });
                }
            }
        }
    }
    let better = |one: &Scanned| one.gains.iter().map(|gain| gain.max(0.0)).sum::<f64>();
    let sum = |one: &Scanned| one.gains.iter().sum::<f64>();
    all.sort_by(|a, b| better(b).total_cmp(&better(a)).then(sum(b).total_cmp(&sum(a))));
    all
}

/// The best supposition, with what is as likely.
struct Judged<'a> {
    best: &'a Weighed,
    rivals: Vec<&'a Weighed>,
    /// Whether the base may hang from a ceiling or a wall as well.
    may_be_base: bool,
    /// The joint whose torque shows it most.
    shown_at: usize,
    /// The number of joints whose torques show it.
    supporters: usize,
    /// Whether it is certain, as far as the model and friction tell.
    is_shown: bool,
}

/// The best of the suppositions `weighed`, which begin with the one of most evidence; `None` if it is not worth telling.
fn judged<'a>(arm: &Arm, as_it_is: &Agreement, weighed: &'a [Weighed]) -> Option<Judged<'a>> {
    let is_base = |one: &Weighed| matches!(one.supposition, Supposition::Gravity(_));
    let most = weighed.first()?.nats;
    let close: Vec<&Weighed> = weighed.iter().filter(|one| most - one.nats < LEAD).collect();
    // A base on a wall or on a ceiling is an effect that the diagnosis finds, not an error of the recording.
    let best = *close.iter().find(|one| !is_base(one))?;
    // Of the two signs that differ only in the attitude of the arm, that of the torque is proposed: it is a convention of the sensor.
    let is_torque = |one: &&&Weighed| Some(one.supposition) == best.supposition.as_sign_of_the_torque();
    let best = *close.iter().find(is_torque).unwrap_or(&best);
    let may_be_base = close.iter().any(|one| is_base(one));
    let is_rival = |one: &&&Weighed| one.supposition != best.supposition && !is_base(one);
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
    let is_explained = |&joint: &usize| best.with.unexplained[joint] < EXPLAINED;
    let of = best.supposition.joints(arm);
    let of_friction = best.supposition.is_of_a_sign_of_friction();
    let is_overwhelming = best.nats > OVERWHELMING;
    let is_seen = with < EXPLAINED && (is_clear || best.nats > TOLD_WHERE_EXPLAINED);
    if best.nats <= TOLD || !(of_friction || is_seen || is_overwhelming) {
        return None;
    }
    let contradicts = |joint: &&usize| !is_explained(joint) && best.nats_of[**joint] < -SUPPORTS;
    let is_shown = if of_friction {
        is_clear || best.nats > CERTAIN
    } else {
        let has_evidence = best.nats > if is_clear { CERTAIN } else { CERTAIN_WHERE_EXPLAINED };
        let is_contradicted = of.iter().filter(contradicts).count() > of.len() / 3;
        supporters > 1 && has_evidence && (is_overwhelming || !is_contradicted)
    };
    Some(Judged {
        best,
        rivals,
        may_be_base,
        shown_at,
        supporters,
        is_shown,
    })
}

impl Judged<'_> {
    /// What is told, if the supposition has the evidence `nats` beside the whole catalogue.
    fn told(&self, arm: &Arm, as_it_is: &Agreement, recordings: &[&RegularRecording], nats: f64) -> Supposed {
        let names: Vec<&str> = arm.joints().iter().map(|joint| joint.name.as_str()).collect();
        let best = self.best;
        let leaves_limits = best.recordings.iter().any(|&at| {
            let new = best.supposition.applied(arm, recordings[at]);
            turns::beyond_limits(arm, &new.q) > turns::beyond_limits(arm, &recordings[at].q) + BEYOND_LIMITS
        });
        let is_certain = self.is_shown && !self.may_be_base && nats > CERTAIN && !leaves_limits;
        let is_one = self
            .rivals
            .iter()
            .all(|other| other.supposition.as_sign_of_the_torque() == Some(best.supposition));
        let left = |agreement: &Agreement| {
            let share = agreement.unexplained[self.shown_at].min(1.0);
            format!("{} %", rounded(100.0 * share, 2))
        };
        let mut text = format!(
            "{}: with this correction, {} of the torque's variance at {} remains unexplained by the model, other inertial parameters \
             and friction; without it, {}",
            best.supposition.sentence(&names, is_certain && is_one),
            left(&best.with),
            names[self.shown_at],
            left(as_it_is)
        );
        let mut others: Vec<String> = self
            .rivals
            .iter()
            .filter_map(|next| next.supposition.words(&names))
            .collect();
        others.dedup();
        if !others.is_empty() {
            text += &format!(". As likely: {}", others.join(", or "));
        }
        if self.may_be_base {
            text += ". The base may also hang from a ceiling or a wall";
        } else if leaves_limits {
            text += ". The positions would lie farther beyond the URDF's limits with it, so that something else may be wrong";
        } else if !is_certain && self.supporters < 2 {
            text += ". No other joint's torque shows it, so that it may have another cause";
        } else if !is_certain {
            text += ". An effect that the model omits may be the cause, too";
        }
        // With the correct reading, the joints that it concerns are explained, unless they never were.
        let of = best.supposition.joints(arm);
        let remains = |&joint: &usize| best.with.unexplained[joint] > EXPLAINED.max(2.0 * as_it_is.unexplained[joint]);
        let is_whole = !of.iter().any(remains);
        if is_certain && !is_whole {
            text += ". Other columns may be wrong, too, because torques remain unexplained";
        }
        Supposed {
            joint: best.supposition.joint().map(|joint| names[joint].to_owned()),
            text,
            changes: if is_one && is_whole && !leaves_limits {
                best.supposition.changes(&names)
            } else {
                Vec::new()
            },
            is_certain,
            recordings: best.recordings.clone(),
        }
    }
}
