//! Effects that the final fit contradicts, or whose size or onset it leaves open.

use effects::background::OWN_FRICTION;
use effects::drive::{LATE, UNIT_LAG};
use effects::friction::{THERMAL_DRIFT, WARMING};
use effects::{Against, Effect, Term};
use torque::Corrected;

use crate::search::problem::Selection;
use crate::search::study::Study;
use crate::selection::bootstrap::Resampled;
use crate::selection::coupling::OnOneJoint;
use crate::selection::drive_or_body::may_be_a_body;
use crate::selection::judge::{self, Judged};
use crate::selection::naming::{Named, is_anywhere, may_be_nothing, name};
use crate::selection::payload::is_of_no_mass;
use crate::selection::predict::{errors_with, poor, structured};
use crate::selection::torque_constants;
use crate::selection::variation::is_variation;
use crate::thresholds::{AGAINST_BOTH, CHANGE_BESIDE_RESIDUAL, CLEAR_THOUGH_UNDETERMINED, LEAST_WITHIN_RECORDINGS};

/// Why an effect is removed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unclear {
    /// It is physically impossible, or other effects exclude it.
    Contradicted,
    /// Its onset may be anywhere.
    Onset,
    /// Its size may be zero, or is that of an error of the last link.
    Size,
    /// It may be a part of the residual of its joint.
    Residual,
    /// A lag of its joints' torques explains as much.
    Lag,
    /// Only one of its two joints shows it, and the other contradicts it.
    OneJoint,
    /// A body on the link may be the reason, as far as the joints before it show.
    Body,
    /// Recordings of one side of the change differ by as much.
    Variation,
    /// Friction of its own in each recording explains as much.
    OwnFriction,
    /// The torque constants of many joints deviate alike.
    Constants,
}

impl Unclear {
    /// The rule that removes the effect.
    pub fn rule(self) -> &'static str {
        match self {
            Self::Contradicted => "it contradicts other effects, or its own rows",
            Self::Onset => "its onset may be at most of the rows",
            Self::Size => "its interval contains the value without effect",
            Self::Residual => "it may be a part of what is unexplained on its joint",
            Self::Lag => "a lag of its joints' torques explains as much",
            Self::OneJoint => "a torque on one of its joints alone explains more",
            Self::Body => {
                "a body on its link explains as much, because the joints before it are not explained well enough"
            }
            Self::Variation => "recordings of one side of the change differ among themselves by as much",
            Self::OwnFriction => "another friction in each recording explains as much",
            Self::Constants => "the torque constants of many joints deviate alike, as with other masses",
        }
    }
}

/// The weakest effect that is unclear, and why.
pub fn unclear(study: &mut Study, judged: &Judged, resampled: &Resampled) -> Option<(usize, Unclear)> {
    let resampled = &resampled.evenly();
    let nothing = nothing(study, judged, resampled);
    let study = &*study;
    let names = |member: &judge::Member| name(study, resampled, member.candidate);
    let all = judged.members.iter().flat_map(names).map(|named| named.effect);
    let all: Vec<Effect> = all.collect();
    let accuracy = torque_constants::accuracy(study, &judged.named.set);
    let contradicted = |member: &judge::Member| {
        let named = name(study, resampled, member.candidate);
        // The correction of its sizes may make the effect impossible, for example by a negative level.
        let is_impossible =
            |named: &Named| Corrected::new(&study.data.arm, std::slice::from_ref(&named.effect)).is_err();
        // A torque constant that changed was wrong by as much before, so that its tolerance does not matter.
        let accuracy = if study.always_acts(member.candidate) { accuracy } else { 0.0 };
        // The intervals of its parameters, or the other effects, exclude it.
        let is_contradicted = |named: &Named| {
            let interval = |key: &str| named.parameters.get(key).map(|parameter| parameter.ci95);
            let (effect, spec) = (&named.effect, named.effect.spec());
            !(spec.is_certain)(effect, &interval, accuracy) || (spec.is_contradicted)(effect, &all)
        };
        named.iter().any(|named| is_impossible(named) || is_contradicted(named))
    };
    let row_times = study.data.motions.row_times();
    let rows = study.table.rows_of(|recording| study.data.fitted[recording]);
    let sets_in_anywhere = |member: &judge::Member| {
        if study.always_acts(member.candidate) {
            return false;
        }
        let acts_on = |&joint: &usize| member.shares[joint] > 0.0;
        let joints: Vec<usize> = (0..study.data.motions.dof).filter(acts_on).collect();
        let moves = |row: usize| joints.iter().any(|&joint| study.table.joints[joint].moving[row]);
        let times: Vec<f64> = rows.iter().filter(|&&row| moves(row)).map(|&row| row_times[row]).collect();
        let onset = |named: Named| named.parameters.get("onset").map(|parameter| parameter.ci95);
        let mut onsets = name(study, resampled, member.candidate).into_iter().filter_map(onset);
        onsets.any(|onset| is_anywhere(onset, &times))
    };
    let why = |member: &judge::Member| {
        if contradicted(member) {
            Some(Unclear::Contradicted)
        } else if sets_in_anywhere(member) {
            Some(Unclear::Onset)
        } else if nothing.contains(&member.candidate) {
            Some(Unclear::Size)
        } else if is_part_of_the_residual(study, judged, member) || is_below_error(study, judged, member) {
            Some(Unclear::Residual)
        } else if may_be_a_lag(study, judged, member) {
            Some(Unclear::Lag)
        } else if OnOneJoint::of(study, &judged.named, member.candidate).is_some_and(|one| one.margin < -AGAINST_BOTH) {
            Some(Unclear::OneJoint)
        } else if may_be_a_body(study, judged, member) {
            Some(Unclear::Body)
        } else if is_variation(study, judged, member) {
            Some(Unclear::Variation)
        } else if may_be_own_friction(study, judged, member) {
            Some(Unclear::OwnFriction)
        } else if torque_constants::is_one_of_many(study, &judged.named, member.candidate) {
            Some(Unclear::Constants)
        } else {
            None
        }
    };
    let unclear = judged.members.iter().filter_map(|member| Some((member, why(member)?)));
    let (weakest, why) = unclear.min_by(|a, b| a.0.evidence.total_cmp(&b.0.evidence))?;
    Some((weakest.candidate, why))
}

/// The members whose size may be zero. A member is not listed if its evidence against the background that fits best without it is large,
/// even if its size is undetermined. For example, wrong inertial parameters of the last links leave the mass of a payload undetermined
/// while its moments are clear, and a drift relative to a low level of friction is as uncertain as that level.
fn nothing(study: &mut Study, judged: &Judged, resampled: &Resampled) -> Vec<usize> {
    let may_be = |study: &Study, member: usize| {
        let named = name(study, resampled, member);
        let first = named.first();
        first.is_some_and(|named| may_be_nothing(named.effect.spec(), &named.parameters))
    };
    // Wrong links do not excuse a body without mass that is new: they are the same before it was there.
    let is_new_body = |study: &Study, member: usize| study.is_payload(member) && !study.always_acts(member);
    let mut list = judged.named.set.clone();
    list.retain(|&member| {
        study.is_payload(member) && is_of_no_mass(study, resampled, member)
            || may_be(study, member)
                && (is_new_body(study, member)
                    || study.evidence_beside_best_background(&judged.named, &[member]) < CLEAR_THOUGH_UNDETERMINED)
    });
    list
}

/// Whether the effect is hardly larger than the structured residual of its joint, and of a kind that may be a part of that residual, as every
/// change may be: what is unexplained may differ between the recordings from before and the others. For an effect on the whole arm, on
/// every joint.
fn is_part_of_the_residual(study: &Study, judged: &Judged, member: &judge::Member) -> bool {
    let candidate = &study.candidates[member.candidate];
    let of_change = study.changes(member.candidate).then_some(CHANGE_BESIDE_RESIDUAL);
    let of_kind = candidate.hypothesis.spec().least_beside_residual;
    let Some(factor) = of_kind.into_iter().chain(of_change).reduce(f64::max) else {
        return false;
    };
    let is_part = |joint: usize| {
        let fit = errors_with(&study.data, &study.table, &judged.named.fit, joint);
        // Unmodelled forms may represent parts of named effects. Therefore the residual of the named effects alone is compared.
        let has_forms = judged.unmodelled.iter().any(|form| form.is_on(joint));
        let residuals = structured(&fit)
            .into_iter()
            .chain(of_change.and(poor(&fit, 1.0)))
            .chain(has_forms.then(|| fit.error().max(fit.train_nrmse_augmented)));
        factor * residuals.fold(0.0, f64::max) > member.shares[joint]
    };
    match candidate.joint {
        Some(joint) => is_part(joint) || adds_nothing(study, judged, member, joint),
        None => (0..study.data.motions.dof).filter(|&joint| member.shares[joint] > 0.0).all(is_part),
    }
}

/// Whether the effect explains nothing in addition to the unmodelled forms of one column on `joint`, which are as simple as it is.
fn adds_nothing(study: &Study, judged: &Judged, member: &judge::Member, joint: usize) -> bool {
    let is_simple = |form: &&judge::Member| study.candidates[form.candidate].columns.len() == 1 && form.is_on(joint);
    let forms: Vec<usize> = judged.unmodelled.iter().filter(is_simple).map(|form| form.candidate).collect();
    if forms.is_empty() {
        return false;
    }
    let products = study.training_products();
    let problem = study.problem(&products);
    let with = problem.choose([&judged.named.set[..], &forms].concat(), &judged.named.fit.weights);
    problem.without(&with, member.candidate).score - with.score < study.thresholds.least_evidence
}

/// Whether an effect that is no change is small beside the training error of each of its joints, and of a kind that then often stands for
/// something that is not in the catalogue.
fn is_below_error(study: &Study, judged: &Judged, member: &judge::Member) -> bool {
    let candidate = &study.candidates[member.candidate];
    let Some(factor) = candidate.hypothesis.spec().least_over_error.filter(|_| !study.changes(member.candidate)) else {
        return false;
    };
    let is_below = |joint: usize| {
        let fit = errors_with(&study.data, &study.table, &judged.named.fit, joint);
        member.shares[joint] < factor * fit.train_nrmse_augmented
    };
    (0..study.data.motions.dof).filter(|&joint| member.shares[joint] > 0.0).all(is_below)
}

/// Whether the effect is a torque along the velocity of another joint, and a lag of the torques of its joints explains as much. Where
/// little accelerates, a lag of the torque of gravity is a torque along the velocities of all joints that the gravity depends on.
fn may_be_a_lag(study: &Study, judged: &Judged, member: &judge::Member) -> bool {
    let candidate = &study.candidates[member.candidate];
    if candidate.hypothesis.spec().against != Against::OtherSpeed {
        return false;
    }
    let Selection { fit, .. } = &judged.named;
    let columns = |keeps: &dyn Fn(usize) -> bool| -> Vec<usize> {
        let selected = fit.selected().iter().copied();
        selected.filter(|&column| keeps(column)).collect()
    };
    let joints = (0..study.data.motions.dof).filter(|&joint| member.shares[joint] > 0.0);
    let lags = joints.map(|joint| Term::on(&LATE, joint).sized([UNIT_LAG])).collect();
    let strengths = study.strengths.without_lag();
    let fitted = |columns: &[usize], more| study.table_and_fit_at(&strengths, columns, more, &fit.weights).1;
    let with = fitted(&columns(&|_| true), Vec::new());
    let lagging = fitted(&columns(&|column| !candidate.columns.contains(&column)), lags);
    lagging.loss <= with.loss
}

/// Whether the effect is friction that falls with time, and another level of friction in each recording explains as much: the friction of
/// a drive is never quite the same in two recordings, and of two or three levels one in two or six falls by chance.
fn may_be_own_friction(study: &Study, judged: &Judged, member: &judge::Member) -> bool {
    let candidate = &study.candidates[member.candidate];
    let (true, Some(joint)) = (candidate.hypothesis.is(&THERMAL_DRIFT), candidate.joint) else {
        return false;
    };
    let fit = &judged.named.fit;
    let is_warming = |column: usize| study.table.terms[column].is(&WARMING) && candidate.columns.contains(&column);
    let columns: Vec<usize> = fit.selected().iter().copied().filter(|&column| !is_warming(column)).collect();
    let moves = |&recording: &usize| study.data.fitted[recording] && study.table.joints[joint].count[recording] > 0;
    let mut recordings: Vec<usize> =
        (0..study.data.fitted.len()).filter(moves).map(|recording| study.data.motions.groups[recording]).collect();
    recordings.sort_unstable();
    recordings.dedup();
    let levels = recordings.into_iter().map(|recording| Term::on(&OWN_FRICTION, joint).of(recording)).collect();
    let with = study.fit_with(fit.selected(), Vec::new(), &fit.weights);
    let level = study.fit_with(&columns, levels, &fit.weights);
    level.loss - with.loss < LEAST_WITHIN_RECORDINGS
}
