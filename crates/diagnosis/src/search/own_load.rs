//! Whether all recordings were made with the same load at the tip.
//!
//! If a tool was changed between recordings that move different joints, only the torques at rest contradict one arm for all of
//! them. Therefore inertial parameters, friction and offsets are fitted to rows in motion and at rest, with and without a load
//! that only some recordings have.

mod equations;

use std::ops::Range;

use rayon::prelude::*;

use self::equations::{LOAD, LoadEquations, Part, Solution, Variances, gains};
use crate::data::Data;
use crate::data::motion::Motions;
use crate::data::statistics::NORMAL_95;
use crate::regression::background::{Background, LoadPrior, Prior};
use crate::regression::bodies::PER_LINK;
use crate::regression::strengths::PriorStrengths;
use crate::regression::table::Table;
use crate::thresholds::{LEAST_LOAD, LEAST_OF_RECORDING, LEAST_OF_RESIDUAL, LOAD_SIZE};

/// The number of times that the variances of the joints are computed anew.
const REWEIGHTINGS: usize = 4;
/// The number of times that the time at which a load was put down is determined anew.
const SPLITS: usize = 3;

/// A load at the tip that only some of the recordings have.
pub struct OwnLoad {
    /// The recordings, in ascending order: at most half of all, or those from before it was put down on a common clock.
    pub recordings: Vec<usize>,
    /// The time at which it was put down within the last of them (s, the clock of the diagnosis); `None` if they have it to their ends.
    pub until: Option<f64>,
    /// Its mass, compared with the other recordings (kg), and its first moments in the last link's frame (kg m).
    pub load: [f64; LOAD],
    /// Their standard deviations.
    pub deviations: [f64; LOAD],
}

impl OwnLoad {
    /// The load that only some of the recordings have, if there is one; `table` has the columns of the background with this `prior`.
    pub fn found(data: &Data, table: &Table, prior: &Prior) -> Option<Self> {
        let (dof, recordings) = (data.motions.dof, data.motions.sources.len());
        if dof < 2 || recordings < 2 {
            return None;
        }
        let wide = PriorStrengths { links: vec![1.0; dof], ..PriorStrengths::none(dof) };
        let background = prior.at(&wide)?;
        let mut found = Self::within(data, table, &background, None)?;
        for _ in 0..SPLITS {
            let Some(until) = found.1 else { break };
            let Some(next) = Self::within(data, table, &background, Some(until)) else {
                break;
            };
            found = next;
        }
        Some(found.0)
    }

    /// The load, with the time at which it seems to be put down within a recording; with recordings that are divided at `split` (s), if
    /// it is known that they are.
    fn within(data: &Data, table: &Table, background: &Background, split: Option<f64>) -> Option<(Self, Option<f64>)> {
        let dof = data.motions.dof;
        let times = data.motions.row_times();
        let stretches: Vec<Range<usize>> = table
            .rows
            .iter()
            .flat_map(|rows| {
                let at = split
                    .map_or(rows.end, |split| rows.start + times[rows.clone()].partition_point(|time| *time < split));
                [rows.start..at, at..rows.end]
            })
            .filter(|rows| !rows.is_empty())
            .collect();
        let parts: Vec<Part> =
            (0..dof).into_par_iter().flat_map_iter(|joint| Part::of_joint(data, table, joint, &stretches)).collect();
        let mut variances = Variances::first(data);
        for _ in 0..REWEIGHTINGS {
            let same = LoadEquations::new(&parts, &variances, background, (dof, stretches.len()))?;
            variances = Variances::of(data, &parts, &same.alone());
        }
        let normal = LoadEquations::new(&parts, &variances, background, (dof, stretches.len()))?;
        let found = grown(&normal, &parts, &variances, stretches.len());
        if found.stretches.is_empty() || found.load[0].abs() < LEAST_LOAD.max(NORMAL_95 * found.deviations[0]) {
            return None;
        }
        let mut group = found.stretches.clone();
        let has_load = |recording: &usize| {
            let rows = &table.rows[*recording];
            let stretch = stretches.iter().position(|stretch| stretch.start == rows.start);
            !rows.is_empty() && stretch.is_some_and(|stretch| group.contains(&stretch))
        };
        let mut load = Self {
            recordings: (0..table.rows.len()).filter(has_load).collect(),
            until: None,
            load: std::array::from_fn(|k| found.load[k]),
            deviations: found.deviations,
        };
        let motions = &data.motions;
        let was_put_down = motions.one_clock && load.changed_once(motions) && !load.was_picked_up(motions);
        // The smaller group is the one that differs; of two halves, that with more mass, and of two sides of a time, that before it.
        let (size, all) = (group.len(), stretches.len());
        let is_of_the_others =
            if was_put_down { load.load[0] < 0.0 } else { 2 * size > all || 2 * size == all && load.load[0] < 0.0 };
        let mut sign = 1.0;
        if let Some(split) = split {
            let is_before = |stretch: &usize| times[stretches[*stretch].start] < split;
            if !(0..all).filter(is_before).all(|stretch| group.contains(&stretch)) {
                sign = -1.0;
                group = (0..all).filter(|stretch| !group.contains(stretch)).collect();
            }
            if !(0..all).all(|stretch| is_before(&stretch) == group.contains(&stretch)) || sign * load.load[0] < 0.0 {
                return None;
            }
            let begins_before = |recording: &usize| {
                let rows = &table.rows[*recording];
                !rows.is_empty() && times[rows.start] < split
            };
            load = Self {
                recordings: (0..table.rows.len()).filter(begins_before).collect(),
                until: Some(split),
                load: load.load.map(|parameter| sign * parameter),
                ..load
            };
        } else if is_of_the_others {
            sign = -1.0;
            load = load.of_the_others(table.rows.len());
        }
        let until = (split.is_some() || was_put_down)
            .then(|| {
                let mut gains = gains(data, table, &variances, &found);
                gains.iter_mut().for_each(|gain| *gain *= sign);
                put_down(table, &times, &gains)
            })
            .flatten();
        Some((load, until))
    }

    /// The same difference as a load of positive mass, which the other recordings have if this one has a negative mass. The links of a
    /// URDF are nearer to an arm without a load.
    pub fn of_more_mass(self, recordings: usize) -> Self {
        if self.load[0] > 0.0 { self } else { self.of_the_others(recordings) }
    }

    /// The same difference as a load of the other recordings.
    fn of_the_others(self, recordings: usize) -> Self {
        Self {
            recordings: (0..recordings).filter(|recording| !self.recordings.contains(recording)).collect(),
            until: None,
            load: self.load.map(|parameter| -parameter),
            ..self
        }
    }

    /// Whether the last recordings have more of it than the first ones: a load may have been picked up once.
    pub fn was_picked_up(&self, motions: &Motions) -> bool {
        self.changed_once(motions) && self.has_first(motions) != (self.load[0] > 0.0)
    }

    /// Whether the first recordings have it and the last ones do not, or the other way round.
    fn changed_once(&self, motions: &Motions) -> bool {
        let has: Vec<bool> = in_order(motions).iter().map(|recording| self.recordings.contains(recording)).collect();
        has.windows(2).filter(|pair| pair[0] != pair[1]).count() == 1
    }

    /// Whether the first recording in time has it.
    fn has_first(&self, motions: &Motions) -> bool {
        self.recordings.contains(&in_order(motions)[0])
    }

    /// Whether all recordings that have it are among those that are `fitted`, or all are held out.
    pub fn is_of(&self, fitted: &[bool], are_fitted: bool) -> bool {
        self.recordings.iter().all(|&recording| fitted[recording] == are_fitted)
    }

    /// The prior of its ten inertial parameters in a background. If only held-out recordings have it, no fit determines them: they are those
    /// that the search found, of a body that is small beside its distance from the last link's frame.
    pub fn prior(&self, fitted: &[bool]) -> LoadPrior {
        let reach = |k: usize| self.load[k].abs() + 2.0 * self.deviations[k];
        let deviations = std::array::from_fn(|k| if k < LOAD { reach(k) } else { reach(0) * LOAD_SIZE * LOAD_SIZE });
        let mut centre = [0.0; PER_LINK];
        if self.is_of(fitted, false) {
            let [mass, x, y, z] = self.load;
            let moments = [y * y + z * z, -x * y, x * x + z * z, -x * z, -y * z, x * x + y * y];
            centre[..LOAD].copy_from_slice(&self.load);
            for (parameter, moment) in centre[LOAD..].iter_mut().zip(moments) {
                *parameter = moment / mass;
            }
        }
        LoadPrior { centre, deviations }
    }
}

/// The time within a recording at which a load is put down (s), if it explains these `gains` on each row of its own; `None` if it is put
/// down between two recordings.
fn put_down(table: &Table, times: &[f64], gains: &[f64]) -> Option<f64> {
    let mut order: Vec<usize> = (0..times.len()).collect();
    order.sort_by(|&a, &b| times[a].total_cmp(&times[b]));
    let (mut sum, mut most, mut until) = (0.0, 0.0, None);
    for pair in order.windows(2) {
        sum += gains[pair[0]];
        if sum > most {
            (most, until) = (sum, Some([pair[0], pair[1]]));
        }
    }
    let [before, after] = until?;
    let recording = |row: usize| table.rows.iter().position(|rows| rows.contains(&row));
    (recording(before) == recording(after)).then(|| 0.5 * (times[before] + times[after]))
}

/// The recordings in the order of time.
fn in_order(motions: &Motions) -> Vec<usize> {
    let mut order: Vec<usize> = (0..motions.sources.len()).collect();
    let begins = |recording: &usize| {
        let mut chunks = motions.chunks.iter().filter(|chunk| chunk.recording == *recording);
        chunks.next().map_or(f64::INFINITY, |chunk| chunk.start)
    };
    order.sort_by(|a, b| begins(a).total_cmp(&begins(b)));
    order
}

/// The solution in which as many of the `stretches` have a load of their own as it explains.
fn grown(normal: &LoadEquations, parts: &[Part], variances: &Variances, stretches: usize) -> Solution {
    let mut now = normal.alone();
    while now.stretches.len() + 1 < stretches {
        let with = |stretch: usize| [now.stretches.as_slice(), &[stretch]].concat();
        let others = (0..stretches).filter(|stretch| !now.stretches.contains(stretch));
        let trials = others.filter_map(|stretch| Some((stretch, normal.with_load(&with(stretch))?)));
        let Some((stretch, next)) = trials.max_by(|(_, a), (_, b)| a.gain.total_cmp(&b.gain)) else {
            break;
        };
        let residual = |solution: &Solution, in_one: bool| -> f64 {
            let counted = parts.iter().filter(|part| !in_one || part.stretch == stretch);
            counted.map(|part| part.misfit(variances, solution)).sum()
        };
        let explains = |in_one: bool, least: f64| residual(&next, in_one) < (1.0 - least) * residual(&now, in_one);
        if !(explains(true, LEAST_OF_RECORDING) && explains(false, LEAST_OF_RESIDUAL)) {
            break;
        }
        now = next;
    }
    now
}
