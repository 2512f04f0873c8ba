//! The normal equations of one arm for all recordings, with and without a load that only some stretches of them have.

use std::ops::Range;

use effects::Term;
use effects::arm::INERTIAL_PARAMETER;
use effects::laws::{SIGN, VELOCITY};
use nalgebra::{Cholesky, DMatrix, DVector};

use crate::data::Data;
use crate::regression::background::Background;
use crate::regression::bodies::PER_LINK;
use crate::regression::fit::evidence_rate;
use crate::regression::table::Table;
use crate::thresholds::{LEAST_LOAD_ROWS, LOAD_FLOOR, LOAD_PRECISION, LOAD_SIZE};

/// The mass and the three first moments of a load, in the frame of the last link.
pub const LOAD: usize = 4;
/// Coulomb friction, viscous friction and offset of a joint.
const DRIVE: usize = 3;

/// The columns of one joint.
struct Columns<'a> {
    /// The unknowns that they belong to: inertial parameters, then friction.
    unknowns: Vec<usize>,
    columns: Vec<&'a Vec<f64>>,
    /// The number of inertial parameters.
    inertials: usize,
    /// The first unknown of the drive, whose last one is a constant torque.
    drive: usize,
    torque: &'a Vec<f64>,
    moving: &'a Vec<bool>,
    resting: Vec<bool>,
}

impl<'a> Columns<'a> {
    fn new(data: &Data, table: &'a Table, joint: usize) -> Self {
        let dof = data.motions.dof;
        let this = &table.joints[joint];
        let column = |term: &Term| {
            let number = table.terms.iter().position(|known| known == term)?;
            Some(&*this.x[table.place[joint][number]?])
        };
        let inertial = |number: usize| Term::about(&INERTIAL_PARAMETER, number / PER_LINK).of(number % PER_LINK);
        let friction = [Term::on(&SIGN, joint), Term::on(&VELOCITY, joint)];
        let drive = PER_LINK * dof + DRIVE * joint;
        let links = (0..PER_LINK * dof).map(|number| (number, column(&inertial(number))));
        let friction = (0..2).map(|k| (drive + k, column(&friction[k])));
        let (unknowns, columns): (Vec<usize>, Vec<&Vec<f64>>) =
            links.chain(friction).filter_map(|(unknown, column)| Some((unknown, column?))).unzip();
        let mut resting = vec![false; this.y.len()];
        for row in data.resting_rows(joint) {
            resting[row] = !this.moving[row];
        }
        Self {
            inertials: unknowns.iter().filter(|&&unknown| unknown < drive).count(),
            unknowns,
            columns,
            drive,
            torque: &this.y,
            moving: &this.moving,
            resting,
        }
    }

    /// By how much the load of `solution` reduces the square of the residual of `row`, over its variance.
    fn gain(&self, row: usize, variances: [f64; 2], solution: &Solution) -> f64 {
        let (used, variance) = match (self.moving[row], self.resting[row]) {
            (true, _) => (self.columns.len(), variances[0]),
            (_, true) => (self.inertials, variances[1]),
            _ => return 0.0,
        };
        let (mut residual, mut load) = (self.torque[row] - solution.common[self.drive + DRIVE - 1], 0.0);
        for (&unknown, column) in self.unknowns.iter().zip(&self.columns).take(used) {
            residual -= solution.common[unknown] * column[row];
            if (solution.last..solution.last + LOAD).contains(&unknown) {
                load += solution.load[unknown - solution.last] * column[row];
            }
        }
        (residual.powi(2) - (residual - load).powi(2)) / variance
    }
}

/// By how much the load of `solution` reduces the squares of the residuals on each row, if it acts there.
pub fn gains(data: &Data, table: &Table, variances: &Variances, solution: &Solution) -> Vec<f64> {
    let columns: Vec<Columns<'_>> = (0..data.motions.dof).map(|joint| Columns::new(data, table, joint)).collect();
    let of_row = |row: usize| -> f64 {
        let joints = columns.iter().zip(&variances.0);
        joints.map(|(joint, variances)| joint.gain(row, *variances, solution)).sum()
    };
    (0..table.len()).map(of_row).collect()
}

/// The inner products of one joint in one stretch of a recording, over its rows in motion and those at rest, in pieces of evidence.
pub struct Part {
    joint: usize,
    /// The stretch.
    pub stretch: usize,
    /// The unknowns that act on the joint: inertial parameters, then its drive.
    unknowns: Vec<usize>,
    /// Inner products of their columns and the torque, which is last; `[in motion, at rest]`.
    products: [DMatrix<f64>; 2],
    evidence: [f64; 2],
}

impl Part {
    /// The parts of `joint`, one for each of the `stretches` of rows.
    pub fn of_joint(data: &Data, table: &Table, joint: usize, stretches: &[Range<usize>]) -> Vec<Self> {
        let of_joint = Columns::new(data, table, joint);
        let Columns { unknowns, columns, inertials, drive, torque: y, .. } = &of_joint;
        let friction = columns.len() - inertials;
        let part = |stretch: usize| {
            let range = &stretches[stretch];
            let recording = table.rows.iter().position(|rows| rows.contains(&range.start));
            let recording = recording.unwrap_or_default();
            let weight = data.seconds[recording] * evidence_rate(data.motions.tempo[joint]);
            let products = |is_counted: &[bool], friction: usize| {
                let rows: Vec<usize> = range.clone().filter(|&row| is_counted[row]).collect();
                let values = DMatrix::from_fn(rows.len(), columns.len() + 2, |i, k| match columns.get(k) {
                    Some(column) if k < inertials + friction => column[rows[i]],
                    // At rest, the sign of the velocity is noise.
                    Some(_) => 0.0,
                    None if k == columns.len() => 1.0,
                    None => y[rows[i]],
                });
                (weight * values.tr_mul(&values), weight * rows.len() as f64)
            };
            let (moving, rows_in_motion) = products(of_joint.moving, friction);
            let (at_rest, rows_at_rest) = products(&of_joint.resting, 0);
            Self {
                joint,
                stretch,
                unknowns: unknowns.iter().copied().chain([drive + DRIVE - 1]).collect(),
                products: [moving, at_rest],
                evidence: [rows_in_motion, rows_at_rest],
            }
        };
        (0..stretches.len()).map(part).collect()
    }

    /// The sums of squares of the residuals of `solution`, in motion and at rest.
    fn residuals(&self, solution: &Solution) -> [f64; 2] {
        let mut miss: Vec<f64> = self.unknowns.iter().map(|&unknown| -solution.of(self, unknown)).collect();
        miss.push(1.0);
        let miss = DVector::from_vec(miss);
        [0, 1].map(|k| miss.dot(&(&self.products[k] * &miss)).max(0.0))
    }

    /// The sum of squares of its residuals, over their variances.
    pub fn misfit(&self, variances: &Variances, solution: &Solution) -> f64 {
        let residuals = self.residuals(solution);
        (0..2).map(|k| residuals[k] / variances.0[self.joint][k]).sum()
    }
}

/// The variances of each joint's residual in motion and at rest, where friction may hold any torque up to its Coulomb level.
pub struct Variances(Vec<[f64; 2]>);

impl Variances {
    /// Those of the measured torques.
    pub fn first(data: &Data) -> Self {
        let of = |torque: &f64| [torque.powi(2).max(f64::MIN_POSITIVE.sqrt()); 2];
        Self(data.scales.torque.iter().map(of).collect())
    }

    /// Those of the residuals of `solution`.
    pub fn of(data: &Data, parts: &[Part], solution: &Solution) -> Self {
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

/// The normal equations of one arm for all recordings, and what a load in each stretch adds to them.
pub struct LoadEquations {
    right: DVector<f64>,
    /// The unknowns without a load.
    common: DVector<f64>,
    /// One per stretch: the products of the load with the other unknowns, with itself, and with the torque.
    loads: Vec<(DMatrix<f64>, DMatrix<f64>, DVector<f64>)>,
    /// N⁻¹ times the products of the load with the other unknowns.
    solved: Vec<DMatrix<f64>>,
    /// The first unknown of the last link.
    last: usize,
}

/// The unknowns, and the load with its stretches.
pub struct Solution {
    common: DVector<f64>,
    /// Its mass (kg) and first moments (kg m).
    pub load: DVector<f64>,
    /// The stretches that have it.
    pub stretches: Vec<usize>,
    last: usize,
    /// The reduction of half the sum of squares by the load (nats).
    pub gain: f64,
    /// The standard deviations of the load's parameters.
    pub deviations: [f64; LOAD],
}

impl Solution {
    /// The value of `unknown` in the stretch of `part`.
    fn of(&self, part: &Part, unknown: usize) -> f64 {
        let has_load = self.stretches.contains(&part.stretch) && (self.last..self.last + LOAD).contains(&unknown);
        self.common[unknown] + if has_load { self.load[unknown - self.last] } else { 0.0 }
    }
}

/// The precision of `background` if the last link, whose columns begin with `last`, also holds a load of any size: the variances of the
/// two add up. `None` if they have no inverse.
fn beside_load(background: &Background, last: usize) -> Option<DMatrix<f64>> {
    let of_last = |&(_, &column): &(usize, &usize)| (last..last + PER_LINK).contains(&column);
    let (places, parameters): (Vec<usize>, Vec<usize>) =
        background.columns.iter().enumerate().filter(of_last).map(|(place, column)| (place, column - last)).unzip();
    let mut precision = background.precision.clone();
    let block = DMatrix::from_fn(places.len(), places.len(), |a, b| precision[(places[a], places[b])]);
    let mut covariance = block.try_inverse()?;
    for (k, parameter) in parameters.into_iter().enumerate() {
        let size = if parameter < LOAD { 1.0 } else { LOAD_SIZE * LOAD_SIZE };
        covariance[(k, k)] += size * size / LOAD_PRECISION;
    }
    let block = covariance.try_inverse()?;
    for (a, &row) in places.iter().enumerate() {
        for (b, &column) in places.iter().enumerate() {
            precision[(row, column)] = block[(a, b)];
        }
    }
    Some(precision)
}

impl LoadEquations {
    /// The equations for an arm of `dof` joints; `None` if they have no solution.
    pub fn new(
        parts: &[Part],
        variances: &Variances,
        background: &Background,
        (dof, stretches): (usize, usize),
    ) -> Option<Self> {
        let (inertials, size) = (PER_LINK * dof, (PER_LINK + DRIVE) * dof);
        let last = inertials - PER_LINK;
        let mut matrix = DMatrix::zeros(size, size);
        let mut right = DVector::zeros(size);
        let empty = || (DMatrix::zeros(size, LOAD), DMatrix::zeros(LOAD, LOAD), DVector::zeros(LOAD));
        let mut loads: Vec<_> = (0..stretches).map(|_| empty()).collect();
        for part in parts {
            let [moving, resting] = variances.0[part.joint];
            let products = &part.products[0] / moving + &part.products[1] / resting;
            let torque = part.unknowns.len();
            let (cross, own, load) = &mut loads[part.stretch];
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
        // The links' columns are the first of the background, in the order of the unknowns. All recordings may have a load, too.
        let precision = beside_load(background, last)?;
        for (a, &i) in background.columns.iter().enumerate() {
            for (b, &k) in background.columns.iter().enumerate() {
                if i < inertials && k < inertials {
                    matrix[(i, k)] += precision[(a, b)];
                }
            }
        }
        for unknown in 0..size {
            let value = matrix[(unknown, unknown)];
            matrix[(unknown, unknown)] += if value > 0.0 { 1e-9 * value } else { 1.0 };
        }
        let factor = Cholesky::new(matrix)?;
        let solved = loads.iter().map(|(cross, ..)| factor.solve(cross)).collect();
        Some(Self { common: factor.solve(&right), right, loads, solved, last })
    }

    /// The solution with the same load in all stretches.
    pub fn alone(&self) -> Solution {
        Solution {
            common: self.common.clone(),
            load: DVector::zeros(LOAD),
            stretches: Vec::new(),
            last: self.last,
            gain: 0.0,
            deviations: [0.0; LOAD],
        }
    }

    /// The solution in which `stretches` have an additional load.
    pub fn with_load(&self, stretches: &[usize]) -> Option<Solution> {
        let mut own = DMatrix::identity(LOAD, LOAD) * LOAD_PRECISION;
        let mut right = DVector::zeros(LOAD);
        let mut solved = DMatrix::zeros(self.right.len(), LOAD);
        let mut cross = DMatrix::zeros(self.right.len(), LOAD);
        for &stretch in stretches {
            let (with_others, with_itself, torque) = &self.loads[stretch];
            cross += with_others;
            own += with_itself;
            right += torque;
            solved += &self.solved[stretch];
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
            stretches: stretches.to_vec(),
            last: self.last,
        })
    }
}
