//! The forms that are tried of an effect.

use arm::{Arm, Workspace};
use nalgebra::DMatrix;

use crate::laws::{TENT, Times};
use crate::signals::Scales;
use crate::term::Term;

/// What is known of the recordings before any fit; forms are made from it.
pub struct Grounds<'a> {
    /// The arm.
    pub arm: &'a Arm,
    /// Typical and largest values of each joint.
    pub scales: &'a Scales,
    /// The time from the first recording to the last (s), if they share one clock.
    pub span: Option<f64>,
    /// First and last time of each stretch (s).
    pub times: &'a [(f64, f64)],
    /// Whether some recordings are from before a change.
    pub has_change: bool,
    /// The mean inertia that each joint moves alone (kg m² or kg).
    pub mass: &'a [f64],
    /// The largest measured torque of each joint in the training recordings (N m or N).
    pub largest: &'a [f64],
    /// The torque that each joint needs by the model, without the largest 0.1 % (N m or N).
    pub needed: &'a [f64],
    /// The standard deviation of the torque that accelerations need on each joint, with the inertia of its drive, over that of the
    /// measured torque.
    pub inertial: &'a [f64],
}

impl Grounds<'_> {
    /// The joints that move.
    pub fn moving(&self) -> impl Iterator<Item = usize> {
        (0..self.dof()).filter(|&joint| self.scales.moves(joint))
    }

    /// One form on each moving joint, with these columns.
    pub fn on_moving(&self, turn: Turn, columns: impl Fn(usize) -> Vec<Term>) -> Vec<Form> {
        self.moving().map(|joint| Form::on(turn, joint, columns(joint))).collect()
    }

    /// Pairs of moving joints: one that an effect acts on, and another on whose motion it depends.
    pub fn pairs(&self) -> impl Iterator<Item = (usize, usize)> {
        let others = |joint: usize| self.moving().filter(move |&other| other != joint);
        self.moving().flat_map(move |joint| others(joint).map(move |other| (joint, other)))
    }

    /// The arm's moments of inertia about the x and y axes of its base in the middle of the positions (kg m²).
    pub fn inertia_about_base(&self) -> [f64; 2] {
        let arm = self.arm.on_turning_base();
        let q: Vec<f64> = [0.0; 2].iter().chain(&self.scales.middle).copied().collect();
        let mut mass = DMatrix::zeros(q.len(), q.len());
        arm.mass_matrix(&mut Workspace::new(&arm), &q, &mut mass);
        [mass[(0, 0)], mass[(1, 1)]]
    }

    /// The number of joints.
    pub fn dof(&self) -> usize {
        self.scales.speed.len()
    }

    /// Tent functions over the range of joint `of`, acting on `joint`, each multiplied by `times`.
    pub fn tents(&self, joint: usize, of: usize, count: usize, times: Times) -> Vec<Term> {
        let width = self.scales.range[of] / (count - 1) as f64;
        let lowest = self.scales.middle[of] - 0.5 * self.scales.range[of];
        (0..count)
            .map(|k| {
                let tent = Term::on(&TENT, joint).of(of).form(times as usize);
                tent.sized([lowest + width * k as f64, width])
            })
            .collect()
    }
}

/// The order in which forms are tried and summed. Of forms that promise equal gains, the earlier one is tried. First come the
/// effects on joints, joint by joint; then links and the whole arm; last the effects that are simulated at sizes from the
/// recordings, again joint by joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Turn {
    /// Friction.
    Friction,
    /// Drives: rotors, torque measurement.
    Drive,
    /// Functions of the position.
    Position,
    /// Delays.
    Late,
    /// Couplings of two joints.
    Pair,
    /// Curves over the position.
    Curve,
    /// Functions of other joints.
    Others,
    /// Functions of past motion.
    Past,
    /// Encoder zeros.
    Zero,
    /// Errors of a link.
    Link,
    /// Errors of the whole arm.
    Arm,
    /// Simulated drives: a spring or a gap between drive and link.
    Compliance,
    /// Torque limits.
    Limit,
}

impl Turn {
    /// The group of turns that it belongs to.
    fn round(self) -> u8 {
        match self {
            Self::Link | Self::Arm => 1,
            Self::Compliance | Self::Limit => 2,
            _ => 0,
        }
    }

    /// The sort key of forms. Forms with equal keys stay in the catalogue's order.
    pub fn key(self, joint: Option<usize>, other: Option<usize>) -> (u8, Option<usize>, Self, Option<usize>) {
        // For errors of links and arm, the kind comes before the joint.
        let joint = if self.round() == 1 { None } else { joint };
        (self.round(), joint, self, other)
    }
}

/// One form: columns that are added and removed together.
#[derive(Clone, Debug)]
pub struct Form {
    /// Its turn.
    pub turn: Turn,
    /// The joint; `None` for the whole arm.
    pub joint: Option<usize>,
    /// The other joint whose motion it depends on.
    pub other: Option<usize>,
    /// Its columns.
    pub terms: Vec<Term>,
}

impl Form {
    /// A form on a joint.
    pub fn on(turn: Turn, joint: usize, terms: Vec<Term>) -> Self {
        Self { turn, joint: Some(joint), other: None, terms }
    }

    /// A form on the whole arm.
    pub fn of_arm(terms: Vec<Term>) -> Self {
        Self { turn: Turn::Arm, joint: None, other: None, terms }
    }

    /// This form with the motion of another joint in its terms.
    #[must_use]
    pub fn with(mut self, other: usize) -> Self {
        self.other = Some(other);
        self
    }
}

/// How an effect with an onset within the recordings is searched.
#[derive(Clone, Copy, Debug)]
pub struct SetsIn {
    /// Its place in the order of these searches and sums.
    pub turn: u8,
    /// The columns of each of its forms on a joint, without an onset (the joint is ignored for the whole arm).
    pub forms: fn(usize) -> Vec<Vec<Term>>,
    /// The number of columns of the first form with which the onset is searched.
    pub looked_for_with: usize,
}
