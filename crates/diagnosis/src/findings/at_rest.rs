//! Torques at rest that the model does not explain.

use std::ops::Range;

use crate::findings::sentences::relative_to_torque;
use crate::selection::FinalFit;
use crate::thresholds::{LEAST_AT_REST, LEAST_REST, MOST_IN_MOTION};
use crate::words::list;

/// A stretch of rows of one recording on which a joint rests and its torque is outside of what dry friction can hold.
struct Held {
    joint: usize,
    recording: usize,
    rows: Range<usize>,
    /// The largest distance from the friction's cone, as a part of the torque's standard deviation.
    share: f64,
}

/// A note on the longest stretch on which joints rest with a torque that neither the model nor their dry friction explains, although the
/// model explains their motion; `None` if there is none. Rows at rest are not fitted, because friction holds any torque there, so that no
/// contact is found on them.
pub fn note(last: &FinalFit) -> Option<String> {
    let data = &last.study.data;
    let times = data.motions.row_times();
    let contacts = last.contacts();
    let seconds = |rows: &Range<usize>| times[rows.end - 1] - times[rows.start];
    let overlaps = |rows: &Range<usize>, [from, to]: [f64; 2]| times[rows.start] <= to && from <= times[rows.end - 1];
    let mut stretches: Vec<Held> = held(last);
    stretches.retain(|held| {
        seconds(&held.rows) >= LEAST_REST && !contacts.iter().any(|&window| overlaps(&held.rows, window))
    });
    let longest = stretches.iter().max_by(|a, b| {
        let order = seconds(&a.rows).total_cmp(&seconds(&b.rows));
        order.then(b.rows.start.cmp(&a.rows.start)).then(b.joint.cmp(&a.joint))
    })?;
    // Joints that rest for most of that time with it.
    let together: Vec<&Held> = stretches
        .iter()
        .filter(|other| {
            let from = times[other.rows.start].max(times[longest.rows.start]);
            let to = times[other.rows.end - 1].min(times[longest.rows.end - 1]);
            other.recording == longest.recording && to - from > 0.5 * seconds(&longest.rows)
        })
        .collect();
    let mut names: Vec<&str> = together.iter().map(|held| data.arm.joints()[held.joint].name.as_str()).collect();
    names.dedup();
    let share = together.iter().map(|held| held.share).fold(0.0, f64::max);
    let source = &data.motions.sources[longest.recording];
    let at = |row: usize| format!("{:.1} s", data.motions.own_time(longest.recording, times[row]));
    let rests = if names.len() == 1 { "rests" } else { "rest" };
    Some(format!(
        "{}: {} {rests} between {} and {} with a torque that neither the model nor dry friction explains, up to {}: a force on the arm, \
         or a brake. Rows at rest are not fitted, so that no contact is found there",
        source.name,
        list(&names),
        at(longest.rows.start),
        at(longest.rows.end - 1),
        relative_to_torque(share),
    ))
}

/// All stretches, of the joints whose motion the model explains.
fn held(last: &FinalFit) -> Vec<Held> {
    let (data, table) = (&last.study.data, &last.study.table);
    let times = data.motions.row_times();
    let mut list = Vec::new();
    for joint in 0..data.motions.dof {
        let least = LEAST_AT_REST * data.scales.torque[joint];
        let moving = &table.joints[joint].moving;
        let squares = last.residual[joint].iter().zip(moving).filter(|(_, moving)| **moving);
        let (count, sum) = squares.fold((0_usize, 0.0), |(count, sum), (r, _)| (count + 1, sum + r * r));
        let is_explained = count > 0 && (sum / count as f64).sqrt() <= MOST_IN_MOTION * data.scales.torque[joint];
        // Dry friction that sets in later is in no cone.
        let has_new_friction = last.judged.named.set.iter().any(|&c| {
            let candidate = &last.study.candidates[c];
            let is_friction = candidate.joint == Some(joint) && candidate.hypothesis.spec().is_friction;
            is_friction && !last.study.always_acts(c)
        });
        if least <= 0.0 || !is_explained || has_new_friction {
            continue;
        }
        let mut open: Option<Held> = None;
        for row in data.resting_rows(joint) {
            let size = last.residual[joint][row].abs();
            let continues = open.as_ref().is_some_and(|held| {
                // The rows of two windows of a recording follow each other, and their times do not.
                let follows = held.rows.end == row && times[row] - times[row - 1] < LEAST_REST;
                follows && table.rows[held.recording].contains(&row) && size > least
            });
            if !continues {
                list.extend(open.take());
            }
            if size <= least {
                continue;
            }
            let share = size / data.scales.torque[joint];
            if let Some(held) = &mut open {
                held.rows.end = row + 1;
                held.share = held.share.max(share);
            } else {
                let recording = table.rows.iter().position(|rows| rows.contains(&row)).unwrap_or(0);
                open = Some(Held { joint, recording, rows: row..row + 1, share });
            }
        }
        list.extend(open);
    }
    list
}
