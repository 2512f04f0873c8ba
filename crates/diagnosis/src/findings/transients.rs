//! Transients in the held-out recordings: contacts that no training recording has.

use std::collections::BTreeMap;

use effects::Effect;
use effects::arm::ExternalContact;
use nalgebra::Vector3;

use crate::data::statistics::{median, rms};
use crate::regression::small::ForceFit;
use crate::report::{Finding, Parameter, Place, TimeWindow};
use crate::search::scan;
use crate::search::study::Study;
use crate::selection::judge::Judged;
use crate::thresholds::{
    ABOVE_USUAL, CONTACT_DURATION, CONTACT_START, LEAST_MOVING, LEAST_PUSHED, LEAST_STRETCHES, LEAST_TRANSIENT_ROWS,
    MOST_TRANSIENTS, ONE_FORCE, SEARCHED_TRANSIENTS, STRETCH_ROWS, TRANSIENT_PIECE, TRANSIENT_STRETCH,
};

/// The transients that were found.
#[derive(Clone, Debug, Default)]
pub struct Transients {
    /// Contacts: one force explains the joints' residuals.
    pub contact: Option<Finding>,
    /// Transients that no force on the tool explains: the joint, its share, the place in time.
    pub unexplained: BTreeMap<usize, (f64, Vec<TimeWindow>)>,
}

/// A transient that one force on the tool explains.
#[derive(Clone, Debug)]
struct Push {
    /// Start and end (s).
    window: [f64; 2],
    /// The index of its recording.
    source: usize,
    /// The force in the base's frame (N).
    force: Vector3<f64>,
    /// The part of the transient's power that the force explains.
    explained: f64,
}

/// Searches transients in the residuals of the named effects (`[joint][row]`) in the held-out recordings.
pub fn search(study: &Study, judged: &Judged, residual: &[Vec<f64>]) -> Transients {
    let mut transients = Transients::default();
    let held: Vec<bool> = study.data.fitted.iter().map(|fitted| !fitted).collect();
    if !held.contains(&true) {
        return transients;
    }
    let times = study.data.motions.row_times();
    let weights: Vec<f64> = (0..study.data.motions.dof)
        .map(|joint| {
            // The usual residual of a joint that was never fitted is unknown.
            if study.training_rows(joint).len() < LEAST_TRANSIENT_ROWS {
                return 0.0;
            }
            1.0 / usual(study, joint, residual)
                .powi(2)
                .max(study.floor[joint])
                .max(1e-300)
        })
        .collect();
    let windows = scan::contacts(
        &study.table,
        &times,
        residual,
        &weights,
        study.force(),
        &held,
        SEARCHED_TRANSIENTS,
    );
    let already = judged.named.set.iter().any(|&c| study.window(c).is_some());
    let mut pushes: Vec<Push> = Vec::new();
    for (from, to) in windows {
        let Some((recording, powers)) = power(study, &times, residual, &weights, (from, to)) else {
            continue;
        };
        let felt = powers.iter().filter(|power| power.sqrt() > ABOVE_USUAL).count();
        if felt < study.data.motions.dof.min(LEAST_PUSHED) {
            continue;
        }
        let name = study.data.motions.sources[recording].name.clone();
        let (force, explained) = force(study, &times, residual, &weights, (from, to));
        if explained > ONE_FORCE && !already {
            pushes.push(Push {
                window: [from, to],
                source: recording,
                force,
                explained,
            });
        } else {
            // The joint on which the transient exceeds the usual residual most.
            let window = (from, to);
            let at = (0..study.data.motions.dof)
                .map(|joint| (powers[joint], joint))
                .max_by(|a, b| a.0.total_cmp(&b.0));
            if let Some((_, joint)) = at {
                let rms = study.share(joint, joint_rms(study, &times, residual, joint, window));
                let entry = transients.unexplained.entry(joint).or_default();
                entry.0 = entry.0.max(rms);
                entry.1.push(TimeWindow {
                    recording: name,
                    start: study.data.motions.own_time(recording, from),
                    end: study.data.motions.own_time(recording, to),
                });
            }
        }
    }
    // Transients that recur are an error of the model and not contacts.
    if pushes.len()
        + transients
            .unexplained
            .values()
            .map(|entry| entry.1.len())
            .sum::<usize>()
        > MOST_TRANSIENTS
    {
        return Transients::default();
    }
    transients.contact = contact(study, residual, &pushes);
    for (_, windows) in transients.unexplained.values_mut() {
        windows.sort_by(|a, b| a.recording.cmp(&b.recording).then(a.start.total_cmp(&b.start)));
    }
    transients
}

/// The usual residual of a joint: the median over stretches of all moving rows, or that of a held-out recording alone where
/// it is larger. Friction or loads that differ in one recording raise all its residuals, and a transient must exceed these as
/// well.
fn usual(study: &Study, joint: usize, residual: &[Vec<f64>]) -> f64 {
    let moving = &study.table.joints[joint].moving;
    let mut all = Vec::new();
    let mut largest = 0.0_f64;
    for (recording, rows) in study.table.rows.iter().enumerate() {
        let length = ((TRANSIENT_STRETCH / study.data.seconds[recording]) as usize).max(STRETCH_ROWS);
        let mut stretches = Vec::new();
        let mut from = rows.start;
        while from < rows.end {
            let to = (from + length).min(rows.end);
            let values: Vec<f64> = (from..to)
                .filter(|&row| moving[row])
                .map(|row| residual[joint][row])
                .collect();
            if values.len() * 2 > length {
                stretches.extend(rms(values));
            }
            from = to;
        }
        all.extend_from_slice(&stretches);
        if !study.data.fitted[recording] && stretches.len() >= LEAST_STRETCHES {
            largest = largest.max(median(stretches));
        }
    }
    median(all).max(largest)
}

/// The moving rows of a window, joint by joint.
fn rows<'a>(
    study: &'a Study,
    times: &'a [f64],
    window: (f64, f64),
) -> impl Iterator<Item = (usize, usize, usize)> + 'a {
    let held = study
        .table
        .rows
        .iter()
        .enumerate()
        .filter(|(r, _)| !study.data.fitted[*r]);
    held.flat_map(move |(recording, rows)| {
        rows.clone()
            .filter(move |&row| times[row] >= window.0 && times[row] <= window.1)
            .flat_map(move |row| (0..study.data.motions.dof).map(move |joint| (recording, row, joint)))
    })
    .filter(|&(_, row, joint)| study.table.joints[joint].moving[row])
}

/// The recording of a window, and each joint's mean weighted power there.
fn power(
    study: &Study,
    times: &[f64],
    residual: &[Vec<f64>],
    weights: &[f64],
    window: (f64, f64),
) -> Option<(usize, Vec<f64>)> {
    let mut sums = vec![(0.0, 0.0); study.data.motions.dof];
    let mut at = None;
    for (recording, row, joint) in rows(study, times, window) {
        at = Some(recording);
        sums[joint].0 += weights[joint] * residual[joint][row].powi(2);
        sums[joint].1 += 1.0;
    }
    let recording = at?;
    let all = study.table.rows[recording].clone();
    let all = all
        .filter(|&row| times[row] >= window.0 && times[row] <= window.1)
        .count() as f64;
    // A joint that hardly moves in the window only stops or starts there, and its dry friction is undetermined.
    let powers = sums
        .iter()
        .map(|&(sum, moving)| if moving > LEAST_MOVING * all { sum / moving } else { 0.0 })
        .collect();
    Some((recording, powers))
}

fn joint_rms(study: &Study, times: &[f64], residual: &[Vec<f64>], joint: usize, window: (f64, f64)) -> f64 {
    let own = rows(study, times, window).filter(|&(_, _, at)| at == joint);
    rms(own.map(|(_, row, _)| residual[joint][row])).unwrap_or(0.0)
}

/// The force that explains a window best, fitted to every other piece, and the part of the power that it explains on the rest.
fn force(
    study: &Study,
    times: &[f64],
    residual: &[Vec<f64>],
    weights: &[f64],
    window: (f64, f64),
) -> (Vector3<f64>, f64) {
    let columns = study.force();
    let mut fit = ForceFit::default();
    for (_, row, joint) in rows(study, times, window) {
        let this = &study.table.joints[joint];
        let x = Vector3::from(
            columns.map(|column| study.table.place[joint][column].map_or(0.0, |place| this.x[place][row])),
        );
        let is_fitted = ((times[row] - window.0) / TRANSIENT_PIECE) as i64 % 2 == 0;
        fit.add(is_fitted, weights[joint], residual[joint][row], x);
    }
    let Some((force, [before, after])) = fit.solved() else {
        return (Vector3::zeros(), 0.0);
    };
    (force, if before > 0.0 { 1.0 - after / before } else { 0.0 })
}

/// All contacts as one finding, with the parameters of the strongest.
fn contact(study: &Study, residual: &[Vec<f64>], pushes: &[Push]) -> Option<Finding> {
    let strongest = pushes.iter().max_by(|a, b| a.force.norm().total_cmp(&b.force.norm()))?;
    let Push {
        window: [from, to],
        source,
        force,
        explained,
    } = strongest.clone();
    let same: Vec<[f64; 2]> = {
        let mut list: Vec<[f64; 2]> = pushes
            .iter()
            .filter(|push| push.source == source)
            .map(|push| push.window.map(|time| study.data.motions.own_time(source, time)))
            .collect();
        list.sort_by(|a, b| a[0].total_cmp(&b[0]));
        list
    };
    let exactly = |value: f64, half: f64, unit: &'static str| Parameter {
        value,
        ci95: [value - half, value + half],
        unit,
    };
    let spread = force.norm() * (1.0 - explained).max(0.0).sqrt();
    let times = study.data.motions.row_times();
    let share_by_joint: BTreeMap<String, f64> = (0..study.data.motions.dof)
        .map(|joint| {
            let rms = joint_rms(study, &times, residual, joint, (from, to));
            (study.data.arm.joints()[joint].name.clone(), study.share(joint, rms))
        })
        .collect();
    let effect = Effect::of(&ExternalContact)
        .with("start", from)
        .with("duration", to - from)
        .with("force", [force.x, force.y, force.z]);
    Some(Finding {
        parameters: BTreeMap::from([
            ("force", exactly(force.norm(), spread, "N")),
            ("start", exactly(from, CONTACT_START, "s")),
            ("duration", exactly(to - from, CONTACT_DURATION, "s")),
        ]),
        share: share_by_joint.values().copied().fold(0.0, f64::max),
        share_by_joint,
        held_out_gain: Some(1.0 - (1.0 - explained).max(0.0).sqrt()),
        place: Place {
            time: same,
            recording: Some(study.data.motions.sources[source].name.clone()),
            state: None,
        },
        ..Finding::of(effect)
    })
}
