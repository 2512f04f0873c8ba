//! Whether recordings of one side of a change differ among themselves as much as the two sides do.

use effects::{Acts, Term};
use nalgebra::{DMatrix, DVector};

use crate::data::statistics::rms;
use crate::regression::table::Table;
use crate::search::study::Study;
use crate::selection::judge::{Judged, Member};
use crate::thresholds::{BLOCKS_A_SIDE, CHANGE_OVER_VARIATION, USUAL_VARIATION};

/// The ridge against terms whose sizes are determined together only, relative to their own products.
const COLLINEAR: f64 = 1e-12;

/// A stretch of the recordings of one side.
struct Block {
    /// When it begins on the diagnosis' clock (s).
    start: f64,
    /// Whether it is after the change.
    is_after: bool,
}

/// Whether a change since the recordings from before is not clearly larger than the differences between recordings of the same side: a
/// one-way analysis of variance of the torques that the effect has in stretches of the recordings, fitted with a size of its own in each.
/// An effect whose joint moves in the recordings of one side only cannot be compared; it is not a variation.
pub fn is_variation(study: &Study, judged: &Judged, member: &Member) -> bool {
    let Some(changed_at) = study.data.motions.changed_at else {
        return false;
    };
    study.changes(member.candidate)
        && (is_usual(study, judged, member, changed_at)
            || over_variation(study, judged, member, &blocks(study, member, changed_at))
                .is_none_or(|ratio| ratio < CHANGE_OVER_VARIATION))
}

/// Whether the changes of a joint's friction, each and together, are within the usual difference between two recordings, where one side has only
/// one: its stretches do not show how much the friction differs from one recording to the next, with the temperature of the drive.
fn is_usual(study: &Study, judged: &Judged, member: &Member, changed_at: f64) -> bool {
    let candidate = &study.candidates[member.candidate];
    let Some(joint) = candidate.joint.filter(|_| candidate.hypothesis.spec().is_friction) else {
        return false;
    };
    let times = study.data.motions.row_times();
    let rows = study.table.moving_rows(joint, &study.data.fitted);
    let after = rows.iter().filter(|&&row| times[row] >= changed_at).count() as f64 / rows.len().max(1) as f64;
    // The sense of a change, and the part of the rows on which the effect acts.
    let acting = |member: &Member| match Acts::of(&study.terms(member.candidate)) {
        Acts::Always => (1.0, 1.0),
        Acts::Since(_) => (1.0, after),
        Acts::Until(_) => (-1.0, 1.0 - after),
    };
    let (mut sum, mut largest) = (0.0_f64, 0.0_f64);
    let mut constant = study.data.share(joint, known_friction(study, joint, &rows));
    for other in &judged.members {
        let this = &study.candidates[other.candidate];
        if this.joint != Some(joint) || !this.hypothesis.spec().is_friction {
            continue;
        }
        let (sense, part) = acting(other);
        // Over the rows on which it acts.
        let size = other.shares[joint] / part.sqrt().max(1e-9);
        if study.changes(other.candidate) {
            sum += sense * size;
            largest = largest.max(size);
        } else {
            constant += size;
        }
    }
    recordings_of_a_side(study, changed_at) < 2 && sum.abs().max(largest) < USUAL_VARIATION * constant
}

/// The root mean square of the known dry friction of a joint (N m or N).
fn known_friction(study: &Study, joint: usize, rows: &[usize]) -> f64 {
    rms(rows.iter().map(|&row| study.data.known_dry_at(joint, row)[0])).unwrap_or(0.0)
}

/// The number of training recordings of the side of a change that has fewer.
fn recordings_of_a_side(study: &Study, changed_at: f64) -> usize {
    let times = study.data.motions.row_times();
    let fitted = study.table.rows.iter().zip(&study.data.fitted);
    let starts = fitted.filter(|(rows, fitted)| **fitted && !rows.is_empty());
    let after: Vec<bool> = starts.map(|(rows, _)| times[rows.start] >= changed_at).collect();
    let count = |is_after: bool| after.iter().filter(|&&after| after == is_after).count();
    count(false).min(count(true))
}

/// The stretches of the training recordings in the order of time: halves of the motion in each recording, or several of them, at most
/// [`BLOCKS_A_SIDE`] on each side.
fn blocks(study: &Study, member: &Member, changed_at: f64) -> Vec<Block> {
    let (motions, table) = (&study.data.motions, &study.table);
    let times = motions.row_times();
    let on = (0..motions.dof).max_by(|&a, &b| member.shares[a].total_cmp(&member.shares[b]));
    let moving = on.map_or_else(Vec::new, |joint| table.moving_rows(joint, &study.data.fitted));
    let mut blocks = Vec::new();
    for is_after in [false, true] {
        let mut pieces: Vec<f64> = Vec::new();
        for rows in &table.rows {
            let of_recording: Vec<usize> = moving.iter().copied().filter(|row| rows.contains(row)).collect();
            let (Some(&first), Some(&middle)) = (of_recording.first(), of_recording.get(of_recording.len() / 2)) else {
                continue;
            };
            if (times[first] >= changed_at) == is_after {
                pieces.extend([times[first], times[middle]]);
            }
        }
        let count = pieces.len().min(BLOCKS_A_SIDE);
        blocks.extend((0..count).map(|block| Block { start: pieces[block * pieces.len() / count], is_after }));
    }
    blocks
}

/// The mean square of the change's torque over the one that the differences between stretches of the same side would give; `None` if the
/// effect has no torque on one side.
fn over_variation(study: &Study, judged: &Judged, member: &Member, blocks: &[Block]) -> Option<f64> {
    let fit = &judged.named.fit;
    let own = &study.candidates[member.candidate].columns;
    let changing = |column: usize| !study.table.terms[column].is_always();
    let (mut terms, mut kept): (Vec<Term>, Vec<usize>) = (Vec::new(), Vec::new());
    for &column in fit.selected() {
        if own.contains(&column) && changing(column) {
            terms.push(study.table.terms[column].always());
        } else {
            kept.push(column);
        }
    }
    // A size that acts always is fitted once.
    kept.retain(|&column| !terms.contains(&study.table.terms[column]));
    let acts = |block: usize| {
        if block == 0 { Acts::Always } else { Acts::Since(blocks[block].start) }
    };
    let more: Vec<Term> =
        (0..blocks.len()).flat_map(|block| terms.iter().map(move |term| Term { acts: acts(block), ..*term })).collect();
    let (table, fit) = study.table_and_fit_with(&kept, more, &fit.weights);
    let first = fit.background + kept.len();
    // The size of each term in each stretch: each column adds to those before it.
    let steps = &fit.coefficients[first..];
    let mut sizes = vec![vec![0.0; terms.len()]; blocks.len()];
    for block in 0..blocks.len() {
        for term in 0..terms.len() {
            let before = if block > 0 { sizes[block - 1][term] } else { 0.0 };
            sizes[block][term] = before + steps[block * terms.len() + term];
        }
    }
    Torques::new(study, &table, member, terms.len(), blocks).over_variation(&sizes, blocks)
}

/// The columns of an effect's terms on the rows in motion, over the torques' standard deviations: `[block][row][term]`.
struct Torques(Vec<Vec<Vec<f64>>>);

impl Torques {
    fn new(study: &Study, table: &Table, member: &Member, terms: usize, blocks: &[Block]) -> Self {
        // The columns of the first stretch act always.
        let first = table.terms.len() - terms * blocks.len();
        let times = study.data.motions.row_times();
        let mut all: Vec<Vec<Vec<f64>>> = blocks.iter().map(|_| Vec::new()).collect();
        for joint in (0..study.data.motions.dof).filter(|&joint| member.shares[joint] > 0.0) {
            let unit = study.data.scales.torque[joint];
            let columns: Vec<Vec<f64>> =
                (first..first + terms).map(|column| table.torque(joint, &[column], &[1.0])).collect();
            for row in table.moving_rows(joint, &study.data.fitted) {
                let block = blocks.iter().rposition(|block| block.start <= times[row]);
                all[block.unwrap_or(0)].push(columns.iter().map(|column| column[row] / unit).collect());
            }
        }
        Self(all)
    }

    /// See [`over_variation`]; `sizes` are those of the terms in each stretch.
    fn over_variation(&self, sizes: &[Vec<f64>], blocks: &[Block]) -> Option<f64> {
        let terms = sizes.first()?.len();
        let gram = |rows: &Vec<Vec<f64>>| {
            let mut gram = DMatrix::zeros(terms, terms);
            for row in rows {
                let row = DVector::from_column_slice(row);
                gram.ger(1.0, &row, &row, 1.0);
            }
            gram
        };
        let grams: Vec<DMatrix<f64>> = self.0.iter().map(gram).collect();
        let sizes: Vec<DVector<f64>> = sizes.iter().map(|sizes| DVector::from_column_slice(sizes)).collect();
        let side = |is_after: bool| (0..blocks.len()).filter(move |&block| blocks[block].is_after == is_after);
        // The sizes of a side are those whose torques are nearest to the torques of its stretches. Some terms have no torque, and the sizes
        // of others may be determined together only.
        let ridged = |gram: &DMatrix<f64>| {
            let mut gram = gram.clone();
            for term in 0..terms {
                let energy = gram[(term, term)];
                gram[(term, term)] += if energy > 0.0 { COLLINEAR * energy } else { 1.0 };
            }
            gram.cholesky()
        };
        let sides = [false, true].map(|is_after| {
            let zero = (DMatrix::zeros(terms, terms), DVector::zeros(terms));
            side(is_after)
                .fold(zero, |(gram, torque), block| (gram + &grams[block], torque + &grams[block] * &sizes[block]))
        });
        if sides.iter().any(|(gram, _)| gram.trace() <= 0.0) {
            return None;
        }
        let [before, after] = &sides;
        let means = [ridged(&before.0)?.solve(&before.1), ridged(&after.0)?.solve(&after.1)];
        let mut within = 0.0;
        for (block, gram) in grams.iter().enumerate() {
            let apart = &sizes[block] - &means[usize::from(blocks[block].is_after)];
            within += apart.dot(&(gram * &apart));
        }
        // The parallel sum of the two sides: what only one of them determines is no change.
        let change = &means[1] - &means[0];
        let change = (&before.0 * &change).dot(&ridged(&(&before.0 + &after.0))?.solve(&(&after.0 * &change)));
        // The number of stretches with equal torques that would be worth as much.
        let number = |is_after: bool| {
            let of_blocks = || side(is_after).map(|block| grams[block].trace());
            of_blocks().sum::<f64>().powi(2) / of_blocks().map(|energy| energy * energy).sum::<f64>()
        };
        let (before, after) = (number(false), number(true));
        let freedom = (before + after - 2.0).max(0.0);
        Some(change * freedom / within)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two stretches before and two after a change.
    fn four_blocks() -> Vec<Block> {
        let block = |block: i32| Block { start: f64::from(block), is_after: block >= 2 };
        (0..4).map(block).collect()
    }

    /// Two stretches before and two after a change, with one term whose torque is one on all rows.
    fn ratio(sizes: [f64; 4]) -> Option<f64> {
        let blocks = four_blocks();
        let torques = Torques(vec![vec![vec![1.0]; 10]; 4]);
        torques.over_variation(&sizes.map(|size| vec![size]), &blocks)
    }

    /// The F statistic of a one-way analysis of variance. `scipy.stats.f_oneway([1.0, 1.2], [2.0, 2.4])` gives 24.2 for the four sizes.
    #[test]
    fn it_is_the_statistic_of_an_analysis_of_variance() {
        let found = ratio([1.0, 1.2, 2.0, 2.4]).expect("both sides have torque");
        assert!((found - 24.2).abs() < 1e-9, "{found}");
    }

    /// Of two terms with equal torques, the sizes are determined together only; a third has no torque.
    #[test]
    fn what_the_stretches_do_not_determine_is_no_variation() {
        let blocks = four_blocks();
        let rows: Vec<Vec<Vec<f64>>> = (1..=4).map(|block| vec![vec![1.0, 1.0, 0.0]; 10 * block]).collect();
        let sums = [1.0, 1.2, 2.0, 2.4];
        let ratio = |apart: [f64; 4]| {
            let sizes: Vec<Vec<f64>> = (0..4).map(|k| vec![sums[k] + apart[k], -apart[k], apart[k]]).collect();
            Torques(rows.clone()).over_variation(&sizes, &blocks).expect("both sides have torque")
        };
        let together = ratio([0.0; 4]);
        let apart = ratio([30.0, -20.0, 50.0, 10.0]);
        assert!((apart / together - 1.0).abs() < 1e-4, "{apart}, not {together}");
    }

    /// Before the change, only the sum of two sizes is determined. They did not change.
    #[test]
    fn what_one_side_does_not_determine_is_no_change() {
        let blocks = four_blocks();
        let sum = vec![vec![1.0, 1.0]; 10];
        let each: Vec<Vec<f64>> = (0..10).map(|row| vec![f64::from(row % 2), f64::from(1 - row % 2)]).collect();
        let torques = Torques(vec![sum.clone(), sum, each.clone(), each]);
        let ratio = |before: [f64; 2]| {
            let sizes = [before, [0.9, 0.1], [1.1, 0.0], [0.9, 0.1]].map(|sizes| sizes.to_vec());
            torques.over_variation(&sizes, &blocks).expect("both sides have torque")
        };
        let found = [ratio([1.0, 0.1]), ratio([-4.0, 5.1])];
        assert!(found.iter().all(|ratio| *ratio < 10.0), "{found:?}");
    }

    #[test]
    fn a_side_without_torque_cannot_be_compared() {
        let blocks = [false, true].map(|is_after| Block { start: 0.0, is_after });
        let torques = Torques(vec![vec![vec![1.0]], vec![vec![0.0]]]);
        assert_eq!(torques.over_variation(&[vec![1.0], vec![2.0]], &blocks), None);
    }
}
