//! The data of the figures.

use effects::laws::ACCELERATION;
use rayon::prelude::*;

use crate::report::{Finding, Trace, Traces};
use crate::selection::FinalFit;

/// All signals on the rows, and the torques of the `findings`, each with its candidate.
pub fn traces(last: &FinalFit, findings: &[(Finding, Option<usize>)]) -> Traces {
    let (data, table) = (&last.study.data, &last.study.table);
    let dof = data.motions.dof;
    let torques: Vec<Vec<Vec<f64>>> = findings
        .par_iter()
        .map(|(finding, member)| {
            let Some(member) = *member else {
                return vec![Vec::new(); dof];
            };
            // A drive's inertia that is named with a spring or a gap has its own column.
            let candidate = &last.study.candidates[member];
            let is_brought = finding.as_effect.kind() != candidate.hypothesis.kind;
            let mut columns = candidate.columns.clone();
            columns.retain(|&column| {
                let accelerates = table.terms[column].is(&ACCELERATION);
                candidate.columns.len() == 1 || accelerates == is_brought
            });
            let values = last.judged.named.fit.values(&columns);
            (0..dof)
                .map(|joint| {
                    let acts = columns.iter().any(|&column| table.place[joint][column].is_some());
                    if acts { table.torque(joint, &columns, &values) } else { Vec::new() }
                })
                .collect()
        })
        .collect();
    let times = data.motions.row_times();
    let state = |pick: &dyn Fn(&crate::data::motion::Chunk, usize) -> f64| -> Vec<f64> {
        let chunks = data.motions.chunks.iter();
        chunks
            .flat_map(|chunk| (0..chunk.rows()).map(|row| pick(chunk, chunk.tick_of(row))).collect::<Vec<_>>())
            .collect()
    };
    let each = |pick: &dyn Fn(&crate::data::motion::Chunk, usize, usize) -> f64| -> Vec<Vec<f64>> {
        (0..dof).map(|joint| state(&|chunk, tick| pick(chunk, joint, tick))).collect()
    };
    let q = each(&|chunk, joint, tick| chunk.q[joint][tick]);
    let qd = each(&|chunk, joint, tick| chunk.qd[joint][tick]);
    let qdd = each(&|chunk, joint, tick| chunk.qdd[joint][tick]);
    let recordings = data
        .motions
        .sources
        .iter()
        .zip(&table.rows)
        .enumerate()
        .map(|(recording, (source, rows))| {
            let cut = |signals: &[Vec<f64>]| -> Vec<Vec<f64>> {
                signals
                    .iter()
                    .map(|signal| if signal.is_empty() { Vec::new() } else { signal[rows.clone()].to_vec() })
                    .collect()
            };
            Trace {
                name: source.name.clone(),
                held_out: source.held_out,
                time: times[rows.clone()].iter().map(|&time| data.motions.own_time(recording, time)).collect(),
                q: cut(&q),
                qd: cut(&qd),
                qdd: cut(&qdd),
                tau: cut(&data.measured),
                residual: cut(&data.nominal),
                residual_augmented: cut(&last.residual),
                residual_exported: cut(&last.exported),
                effects: torques.iter().map(|torque| cut(torque)).collect(),
                moving: table.joints.iter().map(|joint| joint.moving[rows.clone()].to_vec()).collect(),
            }
        })
        .collect();
    Traces { recordings }
}
