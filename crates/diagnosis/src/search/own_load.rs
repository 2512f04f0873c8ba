//! Whether all recordings were made with the same load at the tip.
//!
//! If a tool was changed between recordings that move different joints, only the torques at rest contradict one arm for all of
//! them. Therefore inertial parameters, friction and offsets are fitted to rows in motion and at rest, with and without a load
//! that only some recordings have.

mod equations;

use rayon::prelude::*;

use self::equations::{LOAD, LoadEquations, Part, Solution, Variances};
use crate::data::Data;
use crate::data::motion::Motions;
use crate::data::statistics::NORMAL_95;
use crate::regression::background::Prior;
use crate::regression::bodies::PER_LINK;
use crate::regression::strengths::Strengths;
use crate::regression::table::Table;
use crate::thresholds::{LEAST_LOAD, LEAST_OF_RECORDING, LEAST_OF_RESIDUAL, LOAD_SIZE};

/// The number of times that the variances of the joints are computed anew.
const REWEIGHTINGS: usize = 4;

/// A load at the tip that only some of the recordings have.
pub struct OwnLoad {
    /// The recordings, at most half of all, in ascending order.
    pub recordings: Vec<usize>,
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
        let wide = Strengths {
            links: vec![1.0; dof],
            ..Strengths::none(dof)
        };
        let background = prior.at(&wide)?;
        let parts: Vec<Part> = (0..dof)
            .into_par_iter()
            .flat_map_iter(|joint| Part::of_joint(data, table, joint))
            .collect();
        let mut variances = Variances::first(data);
        for _ in 0..REWEIGHTINGS {
            let same = LoadEquations::new(&parts, &variances, &background, (dof, recordings))?;
            variances = Variances::of(data, &parts, &same.alone());
        }
        let normal = LoadEquations::new(&parts, &variances, &background, (dof, recordings))?;
        let found = grown(&normal, &parts, &variances, recordings);
        if found.recordings.is_empty() || found.load[0].abs() < LEAST_LOAD.max(NORMAL_95 * found.deviations[0]) {
            return None;
        }
        let mut group = found.recordings;
        group.sort_unstable();
        // The smaller group is the one that differs; of two halves, that with more mass.
        let differs = 2 * group.len() < recordings || 2 * group.len() == recordings && found.load[0] > 0.0;
        let sign = if differs { 1.0 } else { -1.0 };
        Some(Self {
            recordings: (0..recordings)
                .filter(|recording| group.contains(recording) == differs)
                .collect(),
            load: std::array::from_fn(|k| sign * found.load[k]),
            deviations: found.deviations,
        })
    }

    /// The same difference as a load of positive mass, which the other recordings have if this one has a negative mass. The links of a
    /// URDF are nearer to an arm without a load.
    pub fn of_more_mass(self, recordings: usize) -> Self {
        if self.load[0] > 0.0 {
            return self;
        }
        Self {
            recordings: (0..recordings)
                .filter(|recording| !self.recordings.contains(recording))
                .collect(),
            load: self.load.map(|parameter| -parameter),
            ..self
        }
    }

    /// Whether the last recordings have more of it than the first ones: a load may have been picked up once.
    pub fn was_picked_up(&self, motions: &Motions) -> bool {
        let sources = motions.sources.len();
        let mut order: Vec<usize> = (0..sources).collect();
        let begins = |recording: &usize| {
            let mut chunks = motions.chunks.iter().filter(|chunk| chunk.recording == *recording);
            chunks.next().map_or(f64::INFINITY, |chunk| chunk.start)
        };
        order.sort_by(|a, b| begins(a).total_cmp(&begins(b)));
        let has: Vec<bool> = order
            .iter()
            .map(|recording| self.recordings.contains(recording))
            .collect();
        let is_once = has.windows(2).filter(|pair| pair[0] != pair[1]).count() == 1;
        is_once && has.last() == Some(&(self.load[0] > 0.0))
    }

    /// Standard deviations for the ten inertial parameters of such a load in a background.
    pub fn prior(&self) -> [f64; PER_LINK] {
        let reach = |k: usize| self.load[k].abs() + 2.0 * self.deviations[k];
        std::array::from_fn(|k| {
            if k < LOAD {
                reach(k)
            } else {
                reach(0) * LOAD_SIZE * LOAD_SIZE
            }
        })
    }
}

/// The solution in which as many of the `recordings` have a load of their own as it explains.
fn grown(normal: &LoadEquations, parts: &[Part], variances: &Variances, recordings: usize) -> Solution {
    let mut now = normal.alone();
    while now.recordings.len() + 1 < recordings {
        let with = |recording: usize| [now.recordings.as_slice(), &[recording]].concat();
        let others = (0..recordings).filter(|recording| !now.recordings.contains(recording));
        let trials = others.filter_map(|recording| Some((recording, normal.with_load(&with(recording))?)));
        let Some((recording, next)) = trials.max_by(|(_, a), (_, b)| a.gain.total_cmp(&b.gain)) else {
            break;
        };
        let residual = |solution: &Solution, in_one: bool| -> f64 {
            let counted = parts.iter().filter(|part| !in_one || part.recording == recording);
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
