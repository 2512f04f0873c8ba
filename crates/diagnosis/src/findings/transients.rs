//! Transients in the held-out recordings: contacts that no training recording has.

use std::collections::BTreeMap;

use effects::Effect;
use effects::arm::EXTERNAL_CONTACT;
use nalgebra::Vector3;

use crate::data::Data;
use crate::data::statistics::{median, rms};
use crate::regression::small::ForceFit;
use crate::regression::table::Table;
use crate::report::{Finding, Parameter, Place, TimeWindow};
use crate::search::scan;
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
struct TransientForce {
    /// Start and end (s).
    window: [f64; 2],
    /// The index of its recording.
    source: usize,
    /// The force in the base's frame (N).
    force: Vector3<f64>,
    /// The part of the transient's power that the force explains.
    explained: f64,
    /// The mean weighted power of each joint's residual.
    powers: Vec<f64>,
}

/// The residuals of the named effects.
struct Residuals<'a> {
    data: &'a Data,
    table: &'a Table,
    /// The columns of a force on the tool that always acts.
    force: [usize; 3],
    /// `[joint][row]` (N m or N).
    residual: &'a [Vec<f64>],
    /// The times of the rows (s).
    times: Vec<f64>,
    /// The weights of the joints.
    weights: Vec<f64>,
    /// Whether each joint moves and does not rest within the length of the filter before and after the row: `[joint][row]`. When it starts
    /// or stops, the filter mixes dry friction in motion with that at rest, which holds any torque.
    settled: Vec<Vec<bool>>,
}

/// Searches transients in the residuals of the named effects (`[joint][row]`) in the held-out recordings. `force` are the columns of
/// a force on the tool that always acts. If a contact is named, no further contact is reported.
pub fn search(
    data: &Data,
    table: &Table,
    force: [usize; 3],
    residual: &[Vec<f64>],
    is_contact_named: bool,
) -> Transients {
    let mut transients = Transients::default();
    let held: Vec<bool> = data.fitted.iter().map(|fitted| !fitted).collect();
    if !held.contains(&true) {
        return transients;
    }
    let times = data.motions.row_times();
    let weights: Vec<f64> = (0..data.motions.dof)
        .map(|joint| {
            // The usual residual of a joint that was never fitted is unknown.
            if table.moving_rows(joint, &data.fitted).len() < LEAST_TRANSIENT_ROWS {
                return 0.0;
            }
            1.0 / usual(data, table, joint, residual).powi(2).max(data.floor[joint]).max(1e-300)
        })
        .collect();
    let windows = scan::contacts(table, &times, residual, &weights, force, &held, SEARCHED_TRANSIENTS);
    let settled = (0..data.motions.dof).map(|joint| settled(data, table, joint)).collect();
    let residuals = Residuals { data, table, force, residual, times, weights, settled };
    let mut forces: Vec<TransientForce> = Vec::new();
    let is_felt = |powers: &[f64]| {
        let felt = powers.iter().filter(|power| power.sqrt() > ABOVE_USUAL).count();
        felt >= data.motions.dof.min(LEAST_PUSHED)
    };
    let mut while_moving = 0;
    let mut without_force: Vec<(usize, [f64; 2])> = Vec::new();
    let mut unexplained = |residuals: &Residuals<'_>, source: usize, window: [f64; 2], powers: &[f64]| {
        // The joint on which the transient exceeds the usual residual most.
        let at = (0..data.motions.dof).max_by(|&a, &b| powers[a].total_cmp(&powers[b]));
        let Some(joint) = at else { return };
        let entry = transients.unexplained.entry(joint).or_default();
        entry.0 = entry.0.max(data.share(joint, residuals.rms(joint, window.into())));
        let [start, end] = window.map(|time| data.motions.own_time(source, time));
        entry.1.push(TimeWindow { recording: data.motions.sources[source].name.clone(), start, end });
    };
    for (from, to) in windows {
        let power = residuals.power((from, to), |_, _| true);
        while_moving += usize::from(power.is_some_and(|(_, powers)| is_felt(&powers)));
        // A joint that only starts or stops shows no transient.
        let settled = |joint: usize, row: usize| residuals.settled[joint][row];
        let Some((recording, powers)) = residuals.power((from, to), settled) else {
            continue;
        };
        if !is_felt(&powers) {
            continue;
        }
        let (force, explained) = residuals.force((from, to));
        let is_early = data.motions.is_at_a_beginning(recording, to);
        if explained > ONE_FORCE && !is_contact_named && !is_early {
            forces.push(TransientForce { window: [from, to], source: recording, force, explained, powers });
        } else {
            if explained <= ONE_FORCE {
                without_force.push((recording, [from, to]));
            }
            unexplained(&residuals, recording, [from, to], &powers);
        }
    }
    // A push beside a transient that no force explains is a part of that transient.
    let (parts, forces): (Vec<TransientForce>, Vec<TransientForce>) =
        forces.into_iter().partition(|push| is_part((push.source, push.window), &without_force));
    parts.iter().for_each(|push| unexplained(&residuals, push.source, push.window, &push.powers));
    // Transients that recur, also where joints start or stop, are an error of the model and not contacts.
    let apart = forces.len() + transients.unexplained.values().map(|entry| entry.1.len()).sum::<usize>();
    if while_moving.max(apart) > MOST_TRANSIENTS {
        return Transients::default();
    }
    transients.contact = residuals.contact(&forces);
    for (_, windows) in transients.unexplained.values_mut() {
        windows.sort_by(|a, b| a.recording.cmp(&b.recording).then(a.start.total_cmp(&b.start)));
    }
    transients
}

/// Whether a window is beside one of `others` in its recording: the time between them is shorter than either of them.
fn is_part((recording, window): (usize, [f64; 2]), others: &[(usize, [f64; 2])]) -> bool {
    let is_near = |other: &[f64; 2]| {
        let between = (other[0] - window[1]).max(window[0] - other[1]);
        between < (window[1] - window[0]).min(other[1] - other[0])
    };
    others.iter().any(|(of, other)| *of == recording && is_near(other))
}

/// The usual residual of a joint: the median over stretches of all moving rows, or that of a held-out recording alone where
/// it is larger. Friction or loads that differ in one recording raise all its residuals, and a transient must exceed these as
/// well.
fn usual(data: &Data, table: &Table, joint: usize, residual: &[Vec<f64>]) -> f64 {
    let moving = &table.joints[joint].moving;
    let mut all = Vec::new();
    let mut largest = 0.0_f64;
    for (recording, rows) in table.rows.iter().enumerate() {
        let length = ((TRANSIENT_STRETCH / data.seconds[recording]) as usize).max(STRETCH_ROWS);
        let mut stretches = Vec::new();
        let mut from = rows.start;
        while from < rows.end {
            let to = (from + length).min(rows.end);
            let values: Vec<f64> = (from..to).filter(|&row| moving[row]).map(|row| residual[joint][row]).collect();
            if values.len() * 2 > length {
                stretches.extend(rms(values));
            }
            from = to;
        }
        all.extend_from_slice(&stretches);
        if !data.fitted[recording] && stretches.len() >= LEAST_STRETCHES {
            largest = largest.max(median(stretches));
        }
    }
    median(all).max(largest)
}

/// The rows on which `joint` moves and does not rest within one period of the filter's cut-off before or after.
fn settled(data: &Data, table: &Table, joint: usize) -> Vec<bool> {
    let mut settled = table.joints[joint].moving.clone();
    for (recording, rows) in table.rows.iter().enumerate() {
        let edge = (1.0 / (data.motions.cutoff * data.seconds[recording])).round() as usize;
        leave_out_edges(&mut settled[rows.clone()], edge);
    }
    settled
}

/// Clears the rows with at most `edge` rows to a rest, which is longer than `edge` rows that are not `moving`. A reversal is no rest.
fn leave_out_edges(moving: &mut [bool], edge: usize) {
    let mut row = 0;
    while row < moving.len() {
        let length = moving[row..].iter().take_while(|moves| !**moves).count();
        if length > edge {
            let end = (row + length + edge).min(moving.len());
            moving[row.saturating_sub(edge)..end].fill(false);
            row = end;
        } else {
            row += length.max(1);
        }
    }
}

impl Residuals<'_> {
    /// The rows of a window, joint by joint, on which the joint moves, each with its recording.
    fn rows(&self, window: (f64, f64)) -> impl Iterator<Item = (usize, usize, usize)> {
        let held = self.table.rows.iter().enumerate();
        let held = held.filter(|(recording, _)| !self.data.fitted[*recording]);
        held.flat_map(move |(recording, rows)| {
            rows.clone()
                .filter(move |&row| self.times[row] >= window.0 && self.times[row] <= window.1)
                .flat_map(move |row| (0..self.data.motions.dof).map(move |joint| (recording, row, joint)))
        })
        .filter(|&(_, row, joint)| self.table.joints[joint].moving[row])
    }

    /// The recording of a window, and each joint's mean weighted power there, on the rows of a moving joint that count: a function of the joint
    /// and the row.
    fn power(&self, window: (f64, f64), counts: impl Fn(usize, usize) -> bool) -> Option<(usize, Vec<f64>)> {
        let mut sums = vec![(0.0, 0.0); self.data.motions.dof];
        let mut at = None;
        for (recording, row, joint) in self.rows(window).filter(|&(_, row, joint)| counts(joint, row)) {
            at = Some(recording);
            sums[joint].0 += self.weights[joint] * self.residual[joint][row].powi(2);
            sums[joint].1 += 1.0;
        }
        let recording = at?;
        let all = self.table.rows[recording].clone();
        let all = all.filter(|&row| self.times[row] >= window.0 && self.times[row] <= window.1).count() as f64;
        // A joint that hardly moves in the window only stops or starts there, and its dry friction is undetermined.
        let powers =
            sums.iter().map(|&(sum, moving)| if moving > LEAST_MOVING * all { sum / moving } else { 0.0 }).collect();
        Some((recording, powers))
    }

    /// The root of the mean square of a joint's residual in a window.
    fn rms(&self, joint: usize, window: (f64, f64)) -> f64 {
        let own = self.rows(window).filter(|&(_, _, at)| at == joint);
        rms(own.map(|(_, row, _)| self.residual[joint][row])).unwrap_or(0.0)
    }

    /// The force that explains a window best, fitted to every other piece, and the part of the power that it explains on the rest.
    fn force(&self, window: (f64, f64)) -> (Vector3<f64>, f64) {
        let mut fit = ForceFit::default();
        for (_, row, joint) in self.rows(window) {
            let this = &self.table.joints[joint];
            let value = |column: usize| self.table.place[joint][column].map_or(0.0, |place| this.x[place][row]);
            let x = Vector3::from(self.force.map(value));
            let is_fitted = ((self.times[row] - window.0) / TRANSIENT_PIECE) as i64 % 2 == 0;
            fit.add(is_fitted, self.weights[joint], self.residual[joint][row], x);
        }
        let Some((force, [before, after])) = fit.solved() else {
            return (Vector3::zeros(), 0.0);
        };
        (force, if before > 0.0 { 1.0 - after / before } else { 0.0 })
    }

    /// All contacts as one finding, with the parameters of the strongest.
    fn contact(&self, forces: &[TransientForce]) -> Option<Finding> {
        let data = self.data;
        let strongest = forces.iter().max_by(|a, b| a.force.norm().total_cmp(&b.force.norm()))?;
        let TransientForce { window: [from, to], source, force, explained, .. } = strongest.clone();
        let same: Vec<[f64; 2]> = {
            let mut list: Vec<[f64; 2]> = forces
                .iter()
                .filter(|push| push.source == source)
                .map(|push| push.window.map(|time| data.motions.own_time(source, time)))
                .collect();
            list.sort_by(|a, b| a[0].total_cmp(&b[0]));
            list
        };
        let exactly =
            |value: f64, half: f64, unit: &'static str| Parameter { value, ci95: [value - half, value + half], unit };
        let mut duration = exactly(to - from, CONTACT_DURATION, "s");
        duration.ci95[0] = duration.ci95[0].max(0.0);
        let spread = force.norm() * (1.0 - explained).max(0.0).sqrt();
        let share_by_joint: BTreeMap<String, f64> = (0..data.motions.dof)
            .map(|joint| {
                let rms = self.rms(joint, (from, to));
                (data.arm.joints()[joint].name.clone(), data.share(joint, rms))
            })
            .collect();
        let effect = Effect::of(&EXTERNAL_CONTACT)
            .with("start", from)
            .with("duration", to - from)
            .with("force", [force.x, force.y, force.z]);
        Some(Finding {
            parameters: BTreeMap::from([
                ("force", exactly(force.norm(), spread, "N")),
                ("start", exactly(data.motions.own_time(source, from), CONTACT_START, "s")),
                ("duration", duration),
            ]),
            share: share_by_joint.values().copied().fold(0.0, f64::max),
            share_by_joint,
            held_out_gain: Some(1.0 - (1.0 - explained).max(0.0).sqrt()),
            place: Place { time: same, recording: Some(data.motions.sources[source].name.clone()), state: None },
            ..Finding::of(effect)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_push_is_a_part_of_a_transient_beside_it_in_the_same_recording() {
        let push = (1, [1.0, 2.0]);
        for (other, expected) in [([2.2, 2.5], true), ([2.4, 2.6], false), ([-0.1, 0.6], true), ([3.1, 9.0], false)] {
            assert_eq!(is_part(push, &[(1, other)]), expected, "{other:?}");
            assert!(!is_part(push, &[(0, other)]), "another recording on the same clock");
        }
        assert!(!is_part(push, &[]));
    }

    #[test]
    fn rows_near_a_rest_are_not_settled_and_a_reversal_is_no_rest() {
        let rest = |length: usize| {
            let mut moving = vec![true; 12];
            moving[4..4 + length].fill(false);
            leave_out_edges(&mut moving, 2);
            moving.iter().map(|&moves| u8::from(moves)).collect::<Vec<u8>>()
        };
        assert_eq!(rest(0), [1; 12]);
        assert_eq!(rest(2), [1, 1, 1, 1, 0, 0, 1, 1, 1, 1, 1, 1]);
        assert_eq!(rest(3), [1, 1, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1]);
        assert_eq!(rest(8), [1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
    }
}
