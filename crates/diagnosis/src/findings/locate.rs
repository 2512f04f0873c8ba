//! The location of the nominal residual: for each joint, in time and by region of state.

use rayon::prelude::*;

use crate::data::Data;
use crate::data::statistics::rms;
use crate::regression::table::Table;
use crate::report::{Axis, Located, Region, TimeWindow};
use crate::thresholds::{
    LEAST_PAIRS, LEAST_WINDOW_ROWS, MOST_WINDOWS, OVER_NOISE, REGION_BINS, REGION_STANDS_OUT, SAME_LOAD, SAME_MOTION,
    WINDOW, WINDOW_STANDS_OUT,
};

/// Locates a residual (`[joint][row]`), and compares it with that of the `augmented` model.
pub fn locate(data: &Data, table: &Table, residual: &[Vec<f64>], augmented: &[Vec<f64>]) -> Vec<Located> {
    let states = states(data);
    (0..data.motions.dof)
        .into_par_iter()
        .filter_map(|joint| {
            let moving = &table.joints[joint].moving;
            on_joint(data, moving, &states[joint], joint, [&residual[joint], &augmented[joint]])
        })
        .collect()
}

/// q, q̇, load and time of one joint on all rows.
struct State {
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    load: Vec<f64>,
    time: Vec<f64>,
    recording: Vec<usize>,
}

fn states(data: &Data) -> Vec<State> {
    (0..data.motions.dof)
        .map(|joint| {
            let mut state = State {
                q: Vec::new(),
                qd: Vec::new(),
                qdd: Vec::new(),
                load: Vec::new(),
                time: Vec::new(),
                recording: Vec::new(),
            };
            for (chunk, rigid) in data.motions.chunks.iter().zip(&data.rigid) {
                for row in 0..chunk.rows() {
                    let tick = chunk.tick_of(row);
                    state.q.push(chunk.q[joint][tick]);
                    state.qd.push(chunk.qd[joint][tick]);
                    state.qdd.push(chunk.qdd[joint][tick]);
                    state.load.push(rigid.tau[joint][tick]);
                    state.time.push(chunk.time(tick));
                    state.recording.push(chunk.recording);
                }
            }
            state
        })
        .collect()
}

/// The root of the mean square; zero for no values.
fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
    rms(values).unwrap_or(0.0)
}

fn on_joint(
    data: &Data,
    moving: &[bool],
    state: &State,
    joint: usize,
    [nominal, augmented]: [&[f64]; 2],
) -> Option<Located> {
    let rows: Vec<usize> = (0..nominal.len()).filter(|&row| moving[row]).collect();
    if rows.is_empty() {
        return None;
    }
    let all = root_mean_square(rows.iter().map(|&row| nominal[row]));
    let floor = data.floor[joint].sqrt().max(1e-300);
    if all < OVER_NOISE * floor {
        return None;
    }
    let torque = data.scales.torque[joint].max(1e-300);
    let first = state.time.iter().copied().fold(f64::INFINITY, f64::min);
    let axes: [(Axis, Vec<f64>); 5] = [
        (Axis::NearReversal, state.qd.iter().map(|qd| qd.abs()).collect()),
        (Axis::Speed, state.qd.clone()),
        (Axis::Load, state.load.clone()),
        (Axis::Angle, state.q.clone()),
        (Axis::ElapsedTime, state.time.iter().map(|t| t - first).collect()),
    ];
    let mut regions = Vec::new();
    for (axis, values) in axes {
        let mut sorted: Vec<usize> = rows.clone();
        sorted.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
        // The region near a reversal is the slowest bin; the others are tried in turn.
        let bins = if axis == Axis::NearReversal { 0..1 } else { 0..REGION_BINS };
        let best = bins
            .map(|bin| &sorted[sorted.len() * bin / REGION_BINS..sorted.len() * (bin + 1) / REGION_BINS])
            .filter(|bin| !bin.is_empty())
            .map(|bin| (root_mean_square(bin.iter().map(|&row| nominal[row])), bin))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((residual, bin)) = best
            && residual > REGION_STANDS_OUT * all
        {
            regions.push(Region {
                axis,
                range: [values[bin[0]], values[bin[bin.len() - 1]]],
                residual: residual / torque,
                residual_augmented: root_mean_square(bin.iter().map(|&row| augmented[row])) / torque,
            });
        }
    }
    regions.sort_by(|a, b| b.residual.total_cmp(&a.residual));
    Some(Located {
        joint: data.arm.joints()[joint].name.clone(),
        over_noise: all / floor,
        repeatable: repeatable(data, state, joint, &rows, nominal),
        regions,
        time: windows(data, state, &rows, nominal, all),
    })
}

/// The three stretches of time with the largest residual.
fn windows(data: &Data, state: &State, rows: &[usize], nominal: &[f64], all: f64) -> Vec<TimeWindow> {
    let mut stretches: Vec<(f64, usize, [f64; 2])> = Vec::new();
    let mut from = 0;
    while from < rows.len() {
        let (recording, start) = (state.recording[rows[from]], state.time[rows[from]]);
        // A row at the end of a window belongs to the next window, so that rounding of its time does not matter.
        let inside = |&&row: &&usize| state.recording[row] == recording && state.time[row] - start < WINDOW - 1e-6;
        let length = rows[from..].iter().take_while(inside).count().max(1);
        let residual = root_mean_square(rows[from..from + length].iter().map(|&row| nominal[row]));
        // A stretch ends with its last row, because the recording may end before the window.
        let end = state.time[rows[from + length - 1]];
        if length >= LEAST_WINDOW_ROWS {
            stretches.push((residual, recording, [start, end]));
        }
        from += length;
    }
    stretches.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.2[0].total_cmp(&b.2[0])));
    let mut list: Vec<TimeWindow> = stretches
        .into_iter()
        .take_while(|(residual, ..)| *residual > WINDOW_STANDS_OUT * all)
        .take(MOST_WINDOWS)
        .map(|(_, recording, [start, end])| TimeWindow {
            recording: data.motions.sources[recording].name.clone(),
            start: data.motions.own_time(recording, start),
            end: data.motions.own_time(recording, end),
        })
        .collect();
    list.sort_by(|a, b| a.recording.cmp(&b.recording).then(a.start.total_cmp(&b.start)));
    list
}

/// The part of the residual that repeats where the joint's own state does, in another recording.
fn repeatable(data: &Data, state: &State, joint: usize, rows: &[usize], nominal: &[f64]) -> Option<f64> {
    let torque = data.scales.torque[joint];
    let acceleration = root_mean_square(rows.iter().map(|&row| state.qdd[row]));
    let cell = |row: usize| {
        let part = |value: f64, range: f64| (value / (SAME_MOTION * range).max(1e-12)).floor() as i64;
        (
            part(state.q[row], data.scales.range[joint]),
            part(state.qd[row], data.scales.speed[joint]),
            part(state.load[row], SAME_LOAD * torque),
            part(state.qdd[row], SAME_LOAD * acceleration),
        )
    };
    let mut cells: std::collections::BTreeMap<_, Vec<usize>> = std::collections::BTreeMap::new();
    for &row in rows {
        cells.entry(cell(row)).or_default().push(row);
    }
    let (mut product, mut power, mut pairs) = (0.0, 0.0, 0);
    for members in cells.values() {
        for (k, &a) in members.iter().enumerate() {
            for &b in &members[k + 1..] {
                if state.recording[a] != state.recording[b] {
                    product += nominal[a] * nominal[b];
                    power += 0.5 * (nominal[a].powi(2) + nominal[b].powi(2));
                    pairs += 1;
                }
            }
        }
    }
    (pairs >= LEAST_PAIRS && power > 0.0).then(|| (product / power).clamp(0.0, 1.0))
}
