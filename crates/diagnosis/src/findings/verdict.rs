//! Unexplained residuals, and the verdict.

use std::collections::BTreeMap;

use arm::Arm;
use effects::{Effect, Quantity, Regressor};

use crate::data::motion::Motions;
use crate::data::statistics::rms;
use crate::findings::held_out_friction::OtherFriction;
use crate::findings::sentences;
use crate::findings::transients::Transients;
use crate::report::{Dependence, Finding, JointFit, Located, TimeWindow, Unexplained, Verdict};
use crate::selection::FinalFit;
use crate::selection::predict::{autocorrelation, poor, structured, swinging};
use crate::thresholds::{
    LEAST_CUTOFF_PERIODS, LEAST_FOR_DYNAMICS, LEAST_MOTION, LEAST_WITH_COMMON_CAUSE, NOISY_REST, PARTLY, REMEMBERS,
    REST, STRUCTURED, STRUCTURED_ABOVE_NOISE, STRUCTURED_IN_TRAINING, WITHOUT_KNOWN, WORTH_SLOWING,
};

/// The structured residuals on each joint that no effect in the catalogue explains, at most as large as the joint's whole error in
/// `fit`; `located` are the places of the nominal residual.
pub fn unexplained(
    last: &FinalFit,
    fit: &BTreeMap<String, JointFit>,
    transients: &Transients,
    located: &[Located],
) -> Vec<Unexplained> {
    let FinalFit { study, judged, .. } = last;
    let mut by_joint: BTreeMap<usize, (f64, Vec<(f64, Dependence)>)> = BTreeMap::new();
    for member in &judged.unmodelled {
        let candidate = &study.candidates[member.candidate];
        let Some(on) = candidate.hypothesis.spec().depends_on else {
            continue;
        };
        let other = candidate.hypothesis.other;
        let on = Dependence { on, joint: other.map(|other| study.data.arm.joints()[other].name.clone()) };
        // A form of a joint is that joint's, also where it acts on others.
        let is_large =
            |&joint: &usize| member.is_on(joint) && member.shares[joint] >= study.thresholds.least_unmodelled_share;
        let of_arm = (0..member.shares.len()).filter(|joint| candidate.joint.is_none() && is_large(joint));
        for joint in candidate.joint.into_iter().chain(of_arm) {
            let share = if candidate.joint.is_some() { member.share() } else { member.shares[joint] };
            let entry = by_joint.entry(joint).or_default();
            entry.0 = entry.0.hypot(share);
            if !entry.1.iter().any(|(_, known)| *known == on) {
                entry.1.push((share, on.clone()));
            }
        }
    }
    // Forms that compensate each other are larger together than what they explain.
    for (&joint, (share, _)) in &mut by_joint {
        if let Some(fit) = fit.get(&study.data.arm.joints()[joint].name) {
            *share = share.min(fit.error().max(fit.train_nrmse_augmented));
        }
    }
    let mut in_transients = transients.unexplained.clone();
    for (&joint, (share, _)) in &transients.unexplained {
        let entry = by_joint.entry(joint).or_default();
        if !entry.1.iter().any(|(_, known)| known.on == Regressor::Time) {
            entry.0 = entry.0.max(*share);
            entry.1.push((*share, Regressor::Time.into()));
        }
    }
    by_joint
        .into_iter()
        .map(|(joint, (share, mut on))| {
            on.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            let name = study.data.arm.joints()[joint].name.clone();
            let transients = in_transients.remove(&joint).map(|(_, windows)| windows);
            let is_transient = transients.is_some();
            let time: Vec<TimeWindow> = transients.unwrap_or_else(|| {
                located
                    .iter()
                    .find(|located| located.joint == name && on.iter().any(|(_, on)| on.on == Regressor::Time))
                    .map_or(Vec::new(), |located: &Located| located.time.clone())
            });
            let depends_on: Vec<Dependence> = on.into_iter().map(|(_, on)| on).collect();
            let event = is_transient.then(|| time.first()).flatten().filter(|_| depends_on.len() == 1);
            Unexplained {
                next: event
                    .map_or_else(|| sentences::next_experiment(&name, depends_on.first()), sentences::repeat_around),
                joint: name,
                share,
                depends_on,
                time,
            }
        })
        .collect()
}

/// Adds the joints that are poorly predicted with the findings, not only because the friction of the held-out recordings differs.
pub fn poorly_predicted(
    last: &FinalFit,
    fit: &BTreeMap<String, JointFit>,
    other_friction: &OtherFriction,
    has_findings: bool,
    unexplained: &mut Vec<Unexplained>,
) {
    let study = &last.study;
    for (joint, name) in study.data.arm.joints().iter().map(|joint| &joint.name).enumerate() {
        let Some(this) = fit.get(name) else { continue };
        let error = this.error();
        let is_known = unexplained.iter().any(|residual| residual.joint == *name);
        // Without findings, a torque that looks like noise is no torque of the model either.
        let is_unrelated = !has_findings && error >= PARTLY;
        let is_poor = is_unrelated || poor(this, other_friction.remaining(joint)).is_some();
        let in_training = structured_in_training(last, joint);
        if is_known {
            continue;
        }
        let is_regular = is_poor || structured(this).is_some() || in_training.is_some();
        let (depends_on, next) = if is_regular {
            (Vec::new(), sentences::next_experiment(name, None))
        } else if swinging(this).is_some() {
            (vec![Regressor::History.into()], sentences::look_behind_the_drive(name))
        } else {
            continue;
        };
        unexplained.push(Unexplained {
            joint: name.clone(),
            share: error.max(in_training.unwrap_or(0.0)),
            depends_on,
            next,
            time: Vec::new(),
        });
    }
}

/// Adds the joints with effects that are `known`, of which full identification in addition to them explains clearly more: its friction may have
/// any sign. A known friction that is larger than that of the recordings has no other name.
pub fn known_too_large(
    last: &FinalFit,
    fit: &BTreeMap<String, JointFit>,
    known: &[Effect],
    unexplained: &mut Vec<Unexplained>,
) {
    let joints = last.study.data.arm.joints().iter().zip(&last.identified);
    for (joint, identified) in joints {
        let (Some(this), Some(identified)) = (fit.get(&joint.name), *identified) else {
            continue;
        };
        let error = this.error();
        let is_here = known.iter().any(|effect| effect.joint() == Some(&*joint.name));
        let is_open = unexplained.iter().any(|residual| residual.joint == joint.name);
        let explains_more = error >= STRUCTURED
            && error * this.torque_std >= STRUCTURED_ABOVE_NOISE * this.noise
            && identified <= WITHOUT_KNOWN * error;
        if is_here && explains_more && !is_open {
            unexplained.push(Unexplained {
                joint: joint.name.clone(),
                share: error,
                depends_on: vec![Regressor::OwnSpeed.into()],
                next: sentences::without_known(&joint.name, error, identified),
                time: Vec::new(),
            });
        }
    }
}

/// Gives residuals of several joints that change with time one experiment: they have a cause in common.
pub fn with_common_cause(unexplained: &mut [Unexplained]) {
    let changes = |open: &Unexplained| open.depends_on.first() == Some(&Regressor::Time.into());
    if unexplained.iter().filter(|open| changes(open)).count() >= LEAST_WITH_COMMON_CAUSE {
        for open in unexplained.iter_mut().filter(|open| changes(open)) {
            sentences::TOGETHER_IN_TIME.clone_into(&mut open.next);
        }
    }
}

/// Asks for a training recording of joints that none moves.
pub fn ask_for_motion(last: &FinalFit, unexplained: &mut [Unexplained]) {
    for open in unexplained.iter_mut().filter(|open| !moves_in_training(last, open)) {
        open.next = format!("add a training recording in which {} moves", open.joint);
    }
}

/// Whether a training recording moves the joint of a residual. The residual of a joint at rest is that of its dry friction or its brake, which
/// hold any torque.
pub fn moves_in_training(last: &FinalFit, open: &Unexplained) -> bool {
    let study = &last.study;
    let joints = study.data.arm.joints().iter().enumerate();
    joints
        .filter(|(_, described)| described.name == open.joint)
        .any(|(joint, _)| !study.table.moving_rows(joint, &study.data.fitted).is_empty())
}

/// The error of a joint (NRMSE) on the training recordings, if it is large and structured. Rows in which a named contact acts do not
/// count: contacts are short, and no model of them is exact.
fn structured_in_training(last: &FinalFit, joint: usize) -> Option<f64> {
    let (data, table, residual) = (&last.study.data, &last.study.table, &last.residual[joint]);
    let contacts = last.contacts();
    let times = data.motions.row_times();
    let mut counts = vec![false; residual.len()];
    for row in table.moving_rows(joint, &data.fitted) {
        counts[row] = contacts.iter().all(|[from, to]| times[row] < *from || times[row] > *to);
    }
    let rms = rms((0..residual.len()).filter(|&row| counts[row]).map(|row| residual[row]))?;
    let is_structured = data.share(joint, rms) >= STRUCTURED_IN_TRAINING
        && rms >= STRUCTURED_ABOVE_NOISE * data.noise[joint].sqrt()
        && autocorrelation(data, table, residual, &counts) > REMEMBERS;
    is_structured.then(|| data.share(joint, rms))
}

/// Keeps the residuals on joints whose error a diagnosis with findings would not call explained, and transients, for recordings
/// without findings.
pub fn beyond_limits(
    arm: &Arm,
    fit: &BTreeMap<String, JointFit>,
    transients: &Transients,
    unexplained: &mut Vec<Unexplained>,
) {
    let joints = arm.joints();
    unexplained.retain(|open| {
        let is_small = fit.get(&open.joint).is_some_and(|fit| fit.error() < STRUCTURED);
        !is_small || transients.unexplained.keys().any(|&joint| joints[joint].name == open.joint)
    });
}

/// Adds the place where the residual that is `located` is largest to the entries without one.
pub fn with_places(located: &[Located], unexplained: &mut [Unexplained]) {
    for open in unexplained.iter_mut().filter(|open| open.depends_on.is_empty()) {
        let Some(place) = located.iter().find(|located| located.joint == open.joint) else {
            continue;
        };
        for region in &place.regions {
            let on = Dependence::from(region.axis.regressor());
            if !open.depends_on.contains(&on) {
                open.depends_on.push(on);
            }
        }
        if let Some(first) = open.depends_on.first() {
            open.next = sentences::next_experiment(&open.joint, Some(first));
        }
        open.time.clone_from(&place.time);
    }
}

/// The advice to diagnose again through a slower filter, if residuals stay `unexplained` on some joints only and the motion allows one. A
/// residual on most joints has another cause than one that the filter hides.
pub fn slower_filter(motions: &Motions, unexplained: &[Unexplained]) -> Option<String> {
    let slower = LEAST_FOR_DYNAMICS.max(LEAST_CUTOFF_PERIODS * motions.usual_tempo());
    let is_some = !unexplained.is_empty() && 2 * unexplained.len() <= motions.dof;
    let joints: Vec<&str> = unexplained.iter().map(|open| open.joint.as_str()).collect();
    let is_useful = is_some && slower <= WORTH_SLOWING * motions.cutoff;
    is_useful.then(|| sentences::slower_filter(&joints, motions.cutoff, slower))
}

/// The reasons why the recordings are not sufficient for a diagnosis; empty if they are.
pub fn not_enough(last: &FinalFit) -> Vec<String> {
    let (data, table, products) = (&last.study.data, &last.study.table, &last.products);
    let seconds = |joint: usize| -> f64 {
        let counts = table.joints[joint].count.iter().zip(&data.seconds).zip(&data.fitted);
        counts.filter(|(_, fitted)| **fitted).map(|((count, seconds), _)| *count as f64 * seconds).sum()
    };
    let longest = (0..data.motions.dof).map(seconds).fold(0.0, f64::max);
    // A joint slower than the noise of its positions counts as resting.
    let hidden = (0..data.motions.dof)
        .filter(|&joint| data.scales.rest[joint] > NOISY_REST * REST * data.scales.speed[joint])
        .max_by(|&a, &b| data.scales.speed[a].total_cmp(&data.scales.speed[b]));
    let hidden = hidden.map_or_else(String::new, |joint| {
        let joint_of_arm = &data.arm.joints()[joint];
        format!(
            ". Motion of {} below {:.2} {} does not count, because the noise or the steps of the positions hide it: move faster, or record finer positions",
            joint_of_arm.name,
            data.scales.rest[joint],
            Quantity::Speed.unit(joint_of_arm.kind)
        )
    });
    let all: f64 = (table.rows.iter().zip(&data.seconds).zip(&data.fitted))
        .filter(|(_, fitted)| **fitted)
        .map(|((rows, seconds), _)| rows.len() as f64 * seconds)
        .sum();
    let mut reasons = Vec::new();
    if all < LEAST_MOTION {
        reasons.push(format!(
            "the training recordings are {all:.1} s long without the filter's ends; a diagnosis needs at least {LEAST_MOTION:.0} s of motion and several reversals of each joint"
        ));
    } else if data.scales.torque.iter().all(|&torque| torque <= 0.0) {
        reasons.push("no joint has a torque that can be diagnosed".to_owned());
    } else if products.count.iter().all(|&count| count == 0.0) {
        reasons.push(format!("no joint moves in the training recordings{hidden}"));
    } else if longest < LEAST_MOTION {
        reasons.push(format!(
            "the training recordings contain {longest:.1} s of motion; a diagnosis needs at least {LEAST_MOTION:.0} s and several reversals of each joint{hidden}"
        ));
    }
    reasons
}

/// The verdict.
pub fn verdict(findings: &[Finding], unexplained: &[Unexplained], not_enough: &[String]) -> Verdict {
    match (!findings.iter().any(Finding::acts_today), unexplained.is_empty()) {
        _ if !not_enough.is_empty() => Verdict::NotEnoughData,
        (true, true) => Verdict::NoMismatch,
        (true, false) => Verdict::Unexplained,
        (false, true) => Verdict::Explained,
        (false, false) => Verdict::PartlyExplained,
    }
}
