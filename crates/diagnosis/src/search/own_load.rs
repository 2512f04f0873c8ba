//! Whether all recordings were made with the same load at the tip.
//!
//! If a tool was changed between recordings that move different joints, only the torques at rest contradict one arm for all of
//! them. Therefore inertial parameters, friction and offsets are fitted to rows in motion and at rest, with and without a load
//! that only some recordings have.

use effects::Term;
use effects::arm::INERTIAL_PARAMETER;
use effects::laws::{SIGN, VELOCITY};
use nalgebra::{Cholesky, DMatrix, DVector};
use rayon::prelude::*;

use crate::data::Data;
use crate::data::motion::Motions;
use crate::data::statistics::NORMAL_95;
use crate::regression::background::{Background, Prior};
use crate::regression::bodies::PER_LINK;
use crate::regression::fit::evidence_rate;
use crate::regression::strengths::Strengths;
use crate::regression::table::Table;
use crate::thresholds::{
    LEAST_LOAD, LEAST_LOAD_ROWS, LEAST_OF_RECORDING, LEAST_OF_RESIDUAL, LOAD_FLOOR, LOAD_PRECISION, LOAD_SIZE,
};

/// The mass and the three first moments of a load, in the frame of the last link.
const LOAD: usize = 4;
/// Coulomb friction, viscous friction and offset of a joint.
const DRIVE: usize = 3;
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

    /// Whether it is in the last or in the first recordings only: the load may have changed once.
    pub fn changed_once(&self, motions: &Motions) -> bool {
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
        has.windows(2).filter(|pair| pair[0] != pair[1]).count() == 1
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

/// The inner products of one joint in one recording, over its rows in motion and those at rest, in pieces of evidence.
struct Part {
    joint: usize,
    recording: usize,
    /// The unknowns that act on the joint: inertial parameters, then its drive.
    unknowns: Vec<usize>,
    /// Inner products of their columns and the torque, which is last; `[in motion, at rest]`.
    products: [DMatrix<f64>; 2],
    evidence: [f64; 2],
}

impl Part {
    /// The parts of `joint`, one per recording.
    fn of_joint(data: &Data, table: &Table, joint: usize) -> Vec<Self> {
        let dof = data.motions.dof;
        let this = &table.joints[joint];
        let column = |term: &Term| {
            let number = table.terms.iter().position(|known| known == term)?;
            Some(&this.x[table.place[joint][number]?])
        };
        let inertial = |number: usize| Term::about(&INERTIAL_PARAMETER, number / PER_LINK).of(number % PER_LINK);
        let drive = [Term::on(&SIGN, joint), Term::on(&VELOCITY, joint)];
        let first = PER_LINK * dof + DRIVE * joint;
        let links = (0..PER_LINK * dof).map(|number| (number, column(&inertial(number))));
        let drive = (0..2).map(|k| (first + k, column(&drive[k])));
        let (unknowns, columns): (Vec<usize>, Vec<&Vec<f64>>) = links
            .chain(drive)
            .filter_map(|(unknown, column)| Some((unknown, column?)))
            .unzip();
        let friction = unknowns.iter().filter(|&&unknown| unknown >= first).count();
        let inertials = columns.len() - friction;

        let y = &this.y;
        let mut resting = vec![false; y.len()];
        for row in data.resting_rows(joint) {
            resting[row] = !this.moving[row];
        }
        let part = |recording: usize| {
            let weight = data.seconds[recording] * evidence_rate(data.motions.tempo[joint]);
            let products = |is_counted: &[bool], friction: usize| {
                let range = table.rows[recording].clone();
                let rows: Vec<usize> = range.filter(|&row| is_counted[row]).collect();
                let values = DMatrix::from_fn(rows.len(), columns.len() + 2, |i, k| match columns.get(k) {
                    Some(column) if k < inertials + friction => column[rows[i]],
                    // At rest, the sign of the velocity is noise.
                    Some(_) => 0.0,
                    None if k == columns.len() => 1.0,
                    None => y[rows[i]],
                });
                (weight * values.tr_mul(&values), weight * rows.len() as f64)
            };
            let (moving, rows_in_motion) = products(&this.moving, friction);
            let (at_rest, rows_at_rest) = products(&resting, 0);
            Self {
                joint,
                recording,
                unknowns: unknowns.iter().copied().chain([first + DRIVE - 1]).collect(),
                products: [moving, at_rest],
                evidence: [rows_in_motion, rows_at_rest],
            }
        };
        (0..table.rows.len()).map(part).collect()
    }

    /// The sums of squares of the residuals of `solution`, in motion and at rest.
    fn residuals(&self, solution: &Solution) -> [f64; 2] {
        let mut miss: Vec<f64> = self
            .unknowns
            .iter()
            .map(|&unknown| -solution.of(self, unknown))
            .collect();
        miss.push(1.0);
        let miss = DVector::from_vec(miss);
        [0, 1].map(|k| miss.dot(&(&self.products[k] * &miss)).max(0.0))
    }

    fn misfit(&self, variances: &Variances, solution: &Solution) -> f64 {
        let residuals = self.residuals(solution);
        (0..2).map(|k| residuals[k] / variances.0[self.joint][k]).sum()
    }
}

/// The variances of each joint's residual in motion and at rest, where friction may hold any torque up to its Coulomb level.
struct Variances(Vec<[f64; 2]>);

impl Variances {
    fn first(data: &Data) -> Self {
        let of = |torque: &f64| [torque.powi(2).max(f64::MIN_POSITIVE.sqrt()); 2];
        Self(data.scales.torque.iter().map(of).collect())
    }

    fn of(data: &Data, parts: &[Part], solution: &Solution) -> Self {
        let of = |joint: usize| {
            let of_joint = || parts.iter().filter(|part| part.joint == joint);
            let evidence: f64 = of_joint().map(|part| part.evidence[0]).sum();
            if evidence < LEAST_LOAD_ROWS || data.scales.torque[joint] <= 0.0 {
                // Its friction is unknown, and its torque says nothing about a load.
                return [f64::INFINITY; 2];
            }
            let squares: f64 = of_joint().map(|part| part.residuals(solution)[0]).sum();
            let moving = (squares / evidence).max((LOAD_FLOOR * data.scales.torque[joint]).powi(2));
            let level = solution.common[PER_LINK * data.motions.dof + DRIVE * joint];
            [moving, moving + level * level]
        };
        Self((0..data.motions.dof).map(of).collect())
    }
}

/// The normal equations of one arm for all recordings, and what a load in each recording adds to them.
struct LoadEquations {
    right: DVector<f64>,
    /// The unknowns without a load.
    common: DVector<f64>,
    /// One per recording: the products of the load with the other unknowns, with itself, and with the torque.
    loads: Vec<(DMatrix<f64>, DMatrix<f64>, DVector<f64>)>,
    /// N⁻¹ times the products of the load with the other unknowns.
    solved: Vec<DMatrix<f64>>,
    /// The first unknown of the last link.
    last: usize,
}

/// The unknowns, and the load with its recordings.
struct Solution {
    common: DVector<f64>,
    load: DVector<f64>,
    recordings: Vec<usize>,
    last: usize,
    /// The reduction of half the sum of squares by the load (nats).
    gain: f64,
    /// The standard deviations of the load's parameters.
    deviations: [f64; LOAD],
}

impl Solution {
    /// The value of `unknown` in the recording of `part`.
    fn of(&self, part: &Part, unknown: usize) -> f64 {
        let has_load = self.recordings.contains(&part.recording) && (self.last..self.last + LOAD).contains(&unknown);
        self.common[unknown] + if has_load { self.load[unknown - self.last] } else { 0.0 }
    }
}

impl LoadEquations {
    /// The equations for an arm of `dof` joints; `None` if they have no solution.
    fn new(
        parts: &[Part],
        variances: &Variances,
        background: &Background,
        (dof, recordings): (usize, usize),
    ) -> Option<Self> {
        let (inertials, size) = (PER_LINK * dof, (PER_LINK + DRIVE) * dof);
        let last = inertials - PER_LINK;
        let mut matrix = DMatrix::zeros(size, size);
        let mut right = DVector::zeros(size);
        let empty = || {
            (
                DMatrix::zeros(size, LOAD),
                DMatrix::zeros(LOAD, LOAD),
                DVector::zeros(LOAD),
            )
        };
        let mut loads: Vec<_> = (0..recordings).map(|_| empty()).collect();
        for part in parts {
            let [moving, resting] = variances.0[part.joint];
            let products = &part.products[0] / moving + &part.products[1] / resting;
            let torque = part.unknowns.len();
            let (cross, own, load) = &mut loads[part.recording];
            for (a, &i) in part.unknowns.iter().enumerate() {
                right[i] += products[(a, torque)];
                for (b, &k) in part.unknowns.iter().enumerate() {
                    matrix[(i, k)] += products[(a, b)];
                    if (last..last + LOAD).contains(&k) {
                        cross[(i, k - last)] += products[(a, b)];
                        if (last..last + LOAD).contains(&i) {
                            own[(i - last, k - last)] += products[(a, b)];
                        }
                    }
                }
                if (last..last + LOAD).contains(&i) {
                    load[i - last] += products[(a, torque)];
                }
            }
        }
        // The links' columns are the first of the background, in the order of the unknowns.
        for (a, &i) in background.columns.iter().enumerate() {
            for (b, &k) in background.columns.iter().enumerate() {
                if i < inertials && k < inertials {
                    matrix[(i, k)] += background.precision[(a, b)];
                }
            }
        }
        for unknown in 0..size {
            let value = matrix[(unknown, unknown)];
            matrix[(unknown, unknown)] += if value > 0.0 { 1e-9 * value } else { 1.0 };
        }
        let factor = Cholesky::new(matrix)?;
        let solved = loads.iter().map(|(cross, ..)| factor.solve(cross)).collect();
        Some(Self {
            common: factor.solve(&right),
            right,
            loads,
            solved,
            last,
        })
    }

    /// The solution with the same load in all recordings.
    fn alone(&self) -> Solution {
        Solution {
            common: self.common.clone(),
            load: DVector::zeros(LOAD),
            recordings: Vec::new(),
            last: self.last,
            gain: 0.0,
            deviations: [0.0; LOAD],
        }
    }

    /// The solution in which `recordings` have an additional load.
    fn with_load(&self, recordings: &[usize]) -> Option<Solution> {
        let mut own = DMatrix::identity(LOAD, LOAD) * LOAD_PRECISION;
        let mut right = DVector::zeros(LOAD);
        let mut solved = DMatrix::zeros(self.right.len(), LOAD);
        let mut cross = DMatrix::zeros(self.right.len(), LOAD);
        for &recording in recordings {
            let (with_others, with_itself, torque) = &self.loads[recording];
            cross += with_others;
            own += with_itself;
            right += torque;
            solved += &self.solved[recording];
        }
        right -= solved.tr_mul(&self.right);
        own -= cross.tr_mul(&solved);
        let inverse = Cholesky::new(own)?.inverse();
        let load = &inverse * &right;
        Some(Solution {
            common: &self.common - &solved * &load,
            gain: 0.5 * right.dot(&load),
            deviations: std::array::from_fn(|k| inverse[(k, k)].sqrt()),
            load,
            recordings: recordings.to_vec(),
            last: self.last,
        })
    }
}
