//! Motions and torques of an arm: the training data of a Lagrangian regression.

use serde::{Deserialize, Serialize};

use super::lanes::{LANES, Lanes};
use crate::error::GpError;

/// The type of a joint, which decides how energies depend on its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JointType {
    /// Energies depend on cosine and sine of the angle.
    Revolute,
    /// Energies depend on the position itself.
    Prismatic,
}

/// The torque of a joint, as a part of the largest one, below which it is taken for rounding.
const LEAST_UNIT: f64 = 1e-9;

/// Samples of motion and torque, validated once: at least one, finite, all joints in each.
#[derive(Clone, Debug, PartialEq)]
pub struct TorqueSamples {
    pub(crate) joints: Vec<JointType>,
    /// q, q̇, q̈ and τ, each row by row: samples × joints.
    pub(crate) values: [Vec<f64>; 4],
}

impl TorqueSamples {
    /// Takes q (rad or m), q̇, q̈ and torques (N m or N) of `joints`, each row by row (sample after sample).
    ///
    /// # Errors
    /// [`GpError::Empty`], [`GpError::Shape`], [`GpError::Input`] (columns are counted over q, q̇, q̈) and
    /// [`GpError::Target`].
    pub fn new(joints: &[JointType], [q, qd, qdd]: [&[f64]; 3], tau: &[f64]) -> Result<Self, GpError> {
        let dof = joints.len();
        let samples = tau.len().checked_div(dof).unwrap_or(0);
        if samples == 0 {
            return Err(GpError::Empty { samples, dim: 3 * dof });
        }
        for given in [q, qd, qdd, tau] {
            if given.len() != samples * dof {
                return Err(GpError::Shape { values: given.len(), samples, dim: dof });
            }
        }
        for (part, values) in [q, qd, qdd].into_iter().enumerate() {
            if let Some(at) = values.iter().position(|value| !value.is_finite()) {
                return Err(GpError::Input { row: at / dof, column: part * dof + at % dof, value: values[at] });
            }
        }
        if let Some(at) = tau.iter().position(|value| !value.is_finite()) {
            let value = tau[at];
            return Err(GpError::Target { row: at / dof, value });
        }
        Ok(Self { joints: joints.to_vec(), values: [q, qd, qdd, tau].map(<[f64]>::to_vec) })
    }

    /// The number of samples.
    pub fn len(&self) -> usize {
        self.values[3].len() / self.dof()
    }

    /// Never: there is at least one.
    pub fn is_empty(&self) -> bool {
        self.values[3].is_empty()
    }

    /// The number of joints.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// At most `count` samples, evenly distributed over the set.
    pub(crate) fn thinned(&self, count: usize) -> Self {
        let n = self.len();
        let count = count.min(n);
        self.rows((0..count).map(|t| t * n / count))
    }

    /// The samples with these indices.
    pub(crate) fn rows(&self, rows: impl Iterator<Item = usize> + Clone) -> Self {
        let dof = self.dof();
        let of = |values: &Vec<f64>| {
            let rows = rows.clone();
            rows.flat_map(|row| values[row * dof..(row + 1) * dof].iter().copied()).collect()
        };
        Self { joints: self.joints.clone(), values: self.values.each_ref().map(of) }
    }

    /// The unit of each joint's torque: their root mean square, but at least a small part of the largest one; `None` if all are zero.
    pub(crate) fn units(&self) -> Option<Vec<f64>> {
        let units: Vec<f64> = (0..self.dof()).map(|c| self.root_mean_square(3, c)).collect();
        let largest = units.iter().copied().fold(0.0, f64::max);
        let least = LEAST_UNIT * largest;
        (largest > 0.0).then(|| units.into_iter().map(|unit| unit.max(least)).collect())
    }

    /// The root mean square of the column of `part` (0 to 3: q, q̇, q̈, τ) of joint `c`.
    pub(crate) fn root_mean_square(&self, part: usize, c: usize) -> f64 {
        let column = self.values[part].iter().skip(c).step_by(self.dof());
        (column.map(|value| value * value).sum::<f64>() / self.len() as f64).sqrt()
    }

    /// The unit of each joint's position within energies: 1 for angles, the root mean square of a prismatic joint's position.
    pub(crate) fn scales(&self) -> Vec<f64> {
        let scale = |(c, joint): (usize, &JointType)| match joint {
            JointType::Revolute => 1.0,
            JointType::Prismatic => match self.root_mean_square(0, c) {
                scale if scale > 0.0 => scale,
                _ => 1.0,
            },
        };
        self.joints.iter().enumerate().map(scale).collect()
    }

    /// The motions in blocks.
    pub(crate) fn motions(&self, scales: &[f64]) -> Motions {
        let [q, qd, qdd, _] = &self.values;
        Motions::new(&self.joints, scales, [q, qd, qdd])
    }

    /// Torques divided by `units` (one a joint), in the order of [`Motions::entry`] of `motions`.
    pub(crate) fn targets(&self, motions: &Motions, units: &[f64]) -> Vec<f64> {
        let dof = self.dof();
        let mut targets = vec![0.0; self.values[3].len()];
        for (at, value) in self.values[3].iter().enumerate() {
            let (sample, joint) = (at / dof, at % dof);
            targets[motions.entry(sample, joint)] = value / units[joint];
        }
        targets
    }
}

/// Motions in blocks of [`LANES`] samples; the last block is padded with its first sample's values repeated.
#[derive(Clone, Debug)]
pub(crate) struct Motions {
    joints: Vec<JointType>,
    scales: Vec<f64>,
    len: usize,
    /// The values of each block and, in it, of each joint: (cos q, sin q) or (q / scale, 0), q̇ and q̈.
    values: Vec<[Lanes; 4]>,
}

impl Motions {
    pub(crate) fn new(joints: &[JointType], scales: &[f64], parts: [&[f64]; 3]) -> Self {
        let dof = joints.len();
        let len = parts[0].len() / dof;
        let mut motions = Self {
            joints: joints.to_vec(),
            scales: scales.to_vec(),
            len,
            values: vec![[Lanes::ZERO; 4]; len.div_ceil(LANES) * dof],
        };
        for block in 0..motions.blocks() {
            for lane in 0..LANES {
                let row = block * LANES + lane;
                let row = if row < len { row } else { block * LANES };
                let part = |part: usize| &parts[part][row * dof..(row + 1) * dof];
                motions.set(block, lane, part(0), part(1), part(2));
            }
        }
        motions
    }

    /// Writes one motion to one lane.
    pub(crate) fn set(&mut self, block: usize, lane: usize, q: &[f64], qd: &[f64], qdd: &[f64]) {
        let dof = self.joints.len();
        for c in 0..dof {
            let place = match self.joints[c] {
                JointType::Revolute => (q[c].cos(), q[c].sin()),
                JointType::Prismatic => (q[c] / self.scales[c], 0.0),
            };
            let entry = &mut self.values[block * dof + c];
            for (lanes, value) in entry.iter_mut().zip([place.0, place.1, qd[c], qdd[c]]) {
                lanes.0[lane] = value;
            }
        }
    }

    /// The motions with these indices.
    pub(crate) fn subset(&self, indices: &[usize]) -> Self {
        let dof = self.joints.len();
        let values = indices.iter().flat_map(|&sample| (0..dof).map(move |c| self.entry_values(sample, c)));
        Self::of_values(&self.joints, &self.scales, &values.collect::<Vec<_>>())
    }

    /// Of joint `c` in a sample: (cos q, sin q) or (q / scale, 0), q̇ and q̈.
    pub(crate) fn entry_values(&self, sample: usize, c: usize) -> [f64; 4] {
        self.values[sample / LANES * self.joints.len() + c].map(|lanes| lanes.0[sample % LANES])
    }

    /// Motions from the values of [`Motions::entry_values`], sample after sample.
    pub(crate) fn of_values(joints: &[JointType], scales: &[f64], values: &[[f64; 4]]) -> Self {
        let dof = joints.len();
        let all =
            Self { joints: joints.to_vec(), scales: scales.to_vec(), len: values.len() / dof, values: Vec::new() };
        let block = |at: usize| {
            let (block, c) = (at / dof, at % dof);
            std::array::from_fn(|part| {
                Lanes(std::array::from_fn(|lane| {
                    let sample = block * LANES + lane;
                    let sample = if sample < all.len { sample } else { block * LANES };
                    values[sample * dof + c][part]
                }))
            })
        };
        Self { values: (0..all.blocks() * dof).map(block).collect(), ..all }
    }

    pub(crate) fn joints(&self) -> &[JointType] {
        &self.joints
    }

    pub(crate) fn scales(&self) -> &[f64] {
        &self.scales
    }

    pub(crate) fn len(&self) -> usize {
        self.len
    }

    pub(crate) fn blocks(&self) -> usize {
        self.len.div_ceil(LANES)
    }

    /// The rows of joint `j` and of the samples of `block` in a covariance matrix: block after block, in a block joint after joint.
    #[inline(always)]
    pub(crate) fn entries(&self, block: usize, j: usize) -> std::ops::Range<usize> {
        let width = LANES.min(self.len - block * LANES);
        let start = block * LANES * self.joints.len() + j * width;
        start..start + width
    }

    /// The row of joint `j` of `sample`.
    #[inline(always)]
    pub(crate) fn entry(&self, sample: usize, j: usize) -> usize {
        self.entries(sample / LANES, j).start + sample % LANES
    }

    #[inline(always)]
    pub(crate) fn position(&self, block: usize, c: usize) -> (Lanes, Lanes) {
        let [x, y, ..] = self.values[block * self.joints.len() + c];
        (x, y)
    }

    #[inline(always)]
    pub(crate) fn velocity(&self, block: usize, c: usize) -> Lanes {
        self.values[block * self.joints.len() + c][2]
    }

    #[inline(always)]
    pub(crate) fn acceleration(&self, block: usize, c: usize) -> Lanes {
        self.values[block * self.joints.len() + c][3]
    }

    /// One motion in every lane: positions, velocities and accelerations.
    pub(crate) fn spread(&self, index: usize, to: &mut Spread) {
        let dof = self.joints.len();
        let (block, lane) = (index / LANES, index % LANES);
        for c in 0..dof {
            let [x, y, p, acc] = self.values[block * dof + c].map(|lanes| Lanes::splat(lanes.0[lane]));
            to.position[c] = (x, y);
            to.velocity[c] = p;
            to.acceleration[c] = acc;
        }
    }
}

/// One motion in every lane.
#[derive(Clone, Debug)]
pub(crate) struct Spread {
    pub(crate) position: Vec<(Lanes, Lanes)>,
    pub(crate) velocity: Vec<Lanes>,
    pub(crate) acceleration: Vec<Lanes>,
}

impl Spread {
    pub(crate) fn new(dof: usize) -> Self {
        Self {
            position: vec![(Lanes::ZERO, Lanes::ZERO); dof],
            velocity: vec![Lanes::ZERO; dof],
            acceleration: vec![Lanes::ZERO; dof],
        }
    }
}
