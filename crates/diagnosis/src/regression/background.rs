//! The background of every fit: corrections of the URDF, of friction curves and of torque constants, under a prior.
//!
//! Inertial parameters: p(δπ_k) ∝ exp(−½ tr(S_k²) / ρ²), S_k the logarithm of the link's pseudo-inertia relative to the URDF's: the
//! affine-invariant metric of Lee, Wensing and Park (2020), free of coordinates and units, so that ρ = 0.1 reads "ten per cent of
//! each link's own mass, size and shape". It is expanded about the bodies of the last fit ([`Quadratic`]).

use std::sync::Arc;

use nalgebra::{Cholesky, DMatrix, DVector};

use effects::Term;
use effects::arm::INERTIAL_PARAMETER;
use effects::background::{FRICTION_CURVE, GAIN as GAIN_LAW, LAG, OFFSET, OWN_FRICTION, OWN_LOAD};

use crate::regression::bodies::{LeastBody, PER_LINK, Quadratic, physical, possible_part, prior_about};
use crate::regression::strengths::PriorStrengths;
use crate::thresholds::{FRICTION_PRIOR, GAIN_PRIOR, LAG_PRIOR, LEAST_LAGGING, NAMELESS_OFFSET};

/// The prior of the background at strength one: the first columns of a table.
#[derive(Clone, Debug, Default)]
pub struct Prior {
    /// The meaning of each column.
    terms: Vec<Term>,
    /// The inertial parameters of the URDF's links, ten per link.
    nominal: Vec<f64>,
    /// The least body about which each link may have.
    least: Vec<LeastBody>,
    /// The prior of each link's inertial parameters, about the bodies of the last fit.
    links: Vec<Quadratic>,
    /// The standard deviation of each column's coefficient that is not an inertial parameter, at strength one.
    deviations: Vec<f64>,
    /// What is known of a load that some recordings have of their own.
    own_load: Option<LoadPrior>,
    /// A new one whenever the prior changes, by which cached products are recognised.
    identity: Arc<()>,
}

/// The prior of the ten inertial parameters of a load that some recordings have of their own.
#[derive(Clone, Debug)]
pub struct LoadPrior {
    /// Their most probable values.
    pub centre: [f64; PER_LINK],
    /// Their standard deviations.
    pub deviations: [f64; PER_LINK],
}

/// The background at given strengths: its columns and their precision.
#[derive(Clone, Debug)]
pub struct Background {
    /// Columns of the table, in ascending order.
    pub columns: Vec<usize>,
    /// K, the precision of their coefficients about `centre`.
    pub precision: DMatrix<f64>,
    /// m, the coefficients about which the prior is centred.
    pub centre: DVector<f64>,
    /// ln det K.
    pub log_det: f64,
    /// The evidence that its strengths must bring (nats).
    pub cost: f64,
    /// Its strengths.
    pub strengths: PriorStrengths,
    /// Whether it is the lag of the torques alone, so that the model is taken as exact.
    pub is_lag_alone: bool,
}

impl Background {
    /// The same background in a table that has only `columns`, in ascending order, which contain its own.
    pub fn among(&self, columns: &[usize]) -> Self {
        let places = self.columns.iter().map(|&column| columns.partition_point(|&other| other < column));
        Self { columns: places.collect(), ..self.clone() }
    }
}

impl Prior {
    /// The prior for an arm with the inertial `parameters` (ten per link) and the `least` bodies about which the links may have. The
    /// torques of its joints have the standard deviations `torque` (N m or N), their speeds are up to `speed` (rad/s or m/s); `moved` are the training recordings that
    /// move each joint. `own_load` is what is known of a load that some
    /// recordings have of their own.
    pub fn new(
        parameters: &[f64],
        least: &[LeastBody],
        torque: &[f64],
        speed: &[f64],
        moved: &[Vec<usize>],
        own_load: Option<LoadPrior>,
    ) -> Self {
        let mut prior = Self { nominal: parameters.to_vec(), least: least.to_vec(), ..Self::default() };
        prior.set_bodies(&vec![0.0; parameters.len()]);
        for link in 0..prior.links.len() {
            for parameter in 0..PER_LINK {
                prior.push(Term::about(&INERTIAL_PARAMETER, link).of(parameter), 0.0);
            }
        }
        for (joint, recordings) in moved.iter().enumerate() {
            let level = FRICTION_PRIOR * torque[joint];
            if level <= 0.0 || speed[joint] <= 0.0 {
                continue;
            }
            let speed = speed[joint];
            prior.push(Term::on(&FRICTION_CURVE, joint), level);
            prior.push(Term::on(&FRICTION_CURVE, joint).form(1), level / (speed * speed));
            if recordings.len() > 1 {
                for &recording in recordings {
                    for (form, deviation) in [(0, level), (1, level / speed)] {
                        let term = Term::on(&OWN_FRICTION, joint).of(recording).form(form);
                        prior.push(term, deviation);
                    }
                }
            }
            prior.push(Term::on(&OFFSET, joint), level);
            prior.push(Term::on(&GAIN_LAW, joint), GAIN_PRIOR);
        }
        // On one or two joints, a lag may be a delay of their drives.
        if (0..moved.len()).filter(|&joint| torque[joint] > 0.0 && speed[joint] > 0.0).count() >= LEAST_LAGGING {
            prior.push(Term::about(&LAG, 0), LAG_PRIOR);
        }
        for (parameter, &deviation) in own_load.iter().flat_map(|load| load.deviations.iter().enumerate()) {
            prior.push(Term::about(&OWN_LOAD, moved.len() - 1).of(parameter), deviation);
        }
        prior.own_load = own_load;
        prior
    }

    /// Makes the prior quadratic about the bodies of a fit, which change the inertial parameters by `changes` (ten per link).
    pub fn set_bodies(&mut self, changes: &[f64]) {
        let links = self.nominal.chunks_exact(PER_LINK).zip(changes.chunks_exact(PER_LINK));
        self.links =
            links.zip(&self.least).map(|((nominal, change), &least)| prior_about(nominal, least, change)).collect();
        self.identity = Arc::default();
    }

    /// The physically possible bodies nearest to those that differ from the URDF's by `changes` (ten inertial parameters per link),
    /// as changes.
    pub fn possible(&self, changes: &[f64]) -> Vec<f64> {
        let links = self.nominal.chunks_exact(PER_LINK).zip(changes.chunks_exact(PER_LINK));
        let change = |((nominal, change), &least): ((&[f64], &[f64]), &LeastBody)| {
            let body = physical(nominal, least, change);
            (0..PER_LINK).map(|k| body[k] - nominal[k]).collect::<Vec<f64>>()
        };
        links.zip(&self.least).flat_map(change).collect()
    }

    /// The next bodies on the way from the physically possible bodies `from` to those of a fit, `to`, as changes of the URDF's inertial
    /// parameters (ten per link), and the largest step of a link in the metric of pseudo-inertias about `from`. If the
    /// fit's bodies are not possible, the step ends at the last possible ones before them.
    pub fn towards(&self, from: &[f64], to: &[f64]) -> (Vec<f64>, f64) {
        let step: Vec<f64> = to.iter().zip(from).map(|(to, from)| to - from).collect();
        let links =
            || self.nominal.chunks_exact(PER_LINK).zip(from.chunks_exact(PER_LINK)).zip(step.chunks_exact(PER_LINK));
        let part = links()
            .zip(&self.least)
            .map(|(((nominal, from), step), &least)| possible_part(nominal, least, from, step))
            .fold(1.0, f64::min);
        let lengths = self.links.iter().zip(step.chunks_exact(PER_LINK)).map(|(prior, step)| {
            let step = DVector::from_column_slice(step);
            (step.transpose() * &prior.precision * &step)[(0, 0)].max(0.0).sqrt()
        });
        let length = lengths.fold(0.0, f64::max);
        (from.iter().zip(&step).map(|(from, step)| from + part * step).collect(), length)
    }

    fn push(&mut self, term: Term, deviation: f64) {
        self.terms.push(term);
        self.deviations.push(deviation);
    }

    /// The same one as long as the prior is the same.
    pub fn identity(&self) -> &Arc<()> {
        &self.identity
    }

    /// The column of a joint's torque constant; `None` if the joint does not move.
    pub fn torque_constant(&self, joint: usize) -> Option<usize> {
        let constant = Term::on(&GAIN_LAW, joint);
        self.terms.iter().position(|term| *term == constant)
    }

    /// The terms of its columns, in the table's order.
    pub fn terms(&self) -> &[Term] {
        &self.terms
    }

    /// The variances of a link's ten inertial parameters at strength `rho`.
    pub fn variances(&self, link: usize, rho: f64) -> [f64; PER_LINK] {
        let inverse = self.links[link].precision.clone().try_inverse();
        std::array::from_fn(|k| inverse.as_ref().map_or(0.0, |inverse| rho * rho * inverse[(k, k)]))
    }

    /// The background at `strengths`; `None` if no column has a strength.
    pub fn at(&self, strengths: &PriorStrengths) -> Option<Background> {
        let strength = |column: usize| match self.terms[column] {
            term if term.is(&OWN_LOAD) => 1.0,
            term if term.is(&LAG) => f64::from(u8::from(strengths.lag)),
            term if term.is(&INERTIAL_PARAMETER) => strengths.of_link(term.of[0]),
            term if term.is(&GAIN_LAW) => {
                let is_left_out = |joint: usize| {
                    strengths.named_constants.contains(&joint) || strengths.impossible_constants.contains(&joint)
                };
                if term.joint.is_some_and(is_left_out) { 0.0 } else { strengths.gain }
            }
            term if term.is(&OFFSET) => {
                let is_named = term.joint.is_some_and(|joint| strengths.named_offsets.contains(&joint));
                let is_nameless = term.joint.is_some_and(|joint| strengths.nameless_offsets.contains(&joint));
                match (is_named, is_nameless) {
                    (true, _) => 0.0,
                    (false, true) => NAMELESS_OFFSET,
                    (false, false) => strengths.offset,
                }
            }
            term if term.is(&OWN_FRICTION) => strengths.own_friction(term.joint, term.of[1]),
            term => strengths.friction_of(term.joint),
        };
        let columns: Vec<usize> = (0..self.terms.len()).filter(|&column| strength(column) > 0.0).collect();
        if columns.is_empty() {
            return None;
        }
        let is_lag_alone = columns.iter().all(|&column| self.terms[column].is(&LAG));
        let entry = |&a: &usize, &b: &usize| {
            let (one, other) = (self.terms[a], self.terms[b]);
            let are_inertial = one.is(&INERTIAL_PARAMETER) && other.is(&INERTIAL_PARAMETER);
            if are_inertial && one.of[0] == other.of[0] {
                self.links[one.of[0]].precision[(one.of[1], other.of[1])] / strengths.of_link(one.of[0]).powi(2)
            } else if a == b {
                (strength(a) * self.deviations[a]).powi(-2)
            } else {
                0.0
            }
        };
        let precision = DMatrix::from_fn(columns.len(), columns.len(), |i, k| entry(&columns[i], &columns[k]));
        let centre = |&column: &usize| match self.terms[column] {
            term if term.is(&INERTIAL_PARAMETER) => self.links[term.of[0]].centre[term.of[1]],
            term if term.is(&OWN_LOAD) => self.own_load.as_ref().map_or(0.0, |load| load.centre[term.of[1]]),
            _ => 0.0,
        };
        let centre = DVector::from_iterator(columns.len(), columns.iter().map(centre));
        let factor = Cholesky::new(precision.clone())?;
        let log_det = 2.0 * factor.l_dirty().diagonal().iter().map(|d| d.ln()).sum::<f64>();
        Some(Background {
            columns,
            centre,
            precision,
            log_det,
            cost: strengths.cost(),
            strengths: strengths.clone(),
            is_lag_alone,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The prior of three links of 2 kg, of whose joints `moving` move.
    fn prior(moving: usize) -> Prior {
        let link = [2.0, 0.0, 0.0, 0.2, 0.1, 0.0, 0.1, 0.0, 0.0, 0.1];
        let speed: Vec<f64> = (0..3).map(|joint| f64::from(u8::from(joint < moving))).collect();
        let moved = [vec![0], vec![0], vec![0]];
        Prior::new(&link.repeat(3), &[LeastBody::default(); 3], &[1.0; 3], &speed, &moved, None)
    }

    #[test]
    fn a_lag_is_a_background_of_its_own_unless_few_joints_move() {
        let exact = PriorStrengths::none(3);
        assert!(prior(3).at(&exact).is_none());
        let late = PriorStrengths { lag: true, ..exact };
        let background = prior(3).at(&late).expect("there is a lag");
        assert_eq!((background.columns.len(), background.is_lag_alone), (1, true));
        assert!((background.precision[(0, 0)] * LAG_PRIOR.powi(2) - 1.0).abs() < 1e-12);
        assert!(prior(3).at(&late.without_lag()).is_none());
        assert!(prior(2).at(&late).is_none());
        let wrong = PriorStrengths { links: vec![0.1; 3], ..late };
        let background = prior(3).at(&wrong).expect("links differ");
        assert_eq!((background.columns.len(), background.is_lag_alone), (31, false));
    }
}
