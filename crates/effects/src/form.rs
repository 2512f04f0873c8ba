//! The forms that are tried of an effect.

use crate::signals::Scales;
use crate::term::Term;

/// What the recordings say before anything is fitted, of which forms are made.
pub struct Grounds<'a> {
    /// What is slow and what is large, joint by joint.
    pub scales: &'a Scales,
    /// From the first recording to the last (s), where one clock runs through them.
    pub span: Option<f64>,
    /// First and last time of each stretch (s).
    pub times: &'a [(f64, f64)],
    /// The inertia that each joint alone moves, on average (kg m² or kg).
    pub mass: &'a [f64],
    /// The largest measured torque of each joint (N m or N).
    pub largest: &'a [f64],
    /// The torque that the model says each joint needs, but for the largest tenth of a per cent (N m or N).
    pub needed: &'a [f64],
    /// The standard deviation of the torque that accelerations need of each joint, over that of the measured one.
    pub inertial: &'a [f64],
}

impl Grounds<'_> {
    /// The joints that move.
    pub fn moving(&self) -> impl Iterator<Item = usize> {
        (0..self.dof()).filter(|&joint| self.scales.moves(joint))
    }

    /// Pairs of joints that move: one that may feel an effect, and another that it may depend on.
    pub fn pairs(&self) -> impl Iterator<Item = (usize, usize)> {
        let others = |joint: usize| self.moving().filter(move |&other| other != joint);
        self.moving()
            .flat_map(move |joint| others(joint).map(move |other| (joint, other)))
    }

    /// The number of joints.
    pub fn dof(&self) -> usize {
        self.scales.speed.len()
    }

    /// Tents over the range of joint `of`, felt by `joint`, each multiplied with what `times` says.
    pub fn tents(&self, joint: usize, of: usize, count: usize, times: Times) -> Vec<Term> {
        let width = self.scales.range[of] / (count - 1) as f64;
        let lowest = self.scales.middle[of] - 0.5 * self.scales.range[of];
        (0..count)
            .map(|k| {
                let tent = Term::on(&crate::laws::TENT, joint).of(of).form(times as usize);
                tent.sized([lowest + width * k as f64, width])
            })
            .collect()
    }
}

/// What a function of a position is multiplied with, of the joint that feels it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Times {
    /// One.
    One,
    /// q̇.
    Velocity,
    /// |q̇|.
    Speed,
}

/// When a form's turn comes. Of forms that promise the same the earlier is tried, and sums run in this order: first what is
/// on a joint, joint by joint; then the links and the arm; last what is simulated at a size that the recordings give, again
/// joint by joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Turn {
    /// Friction.
    Friction,
    /// What a drive has: its rotor, what is wrong with its torque.
    Drive,
    /// What depends on the position.
    Position,
    /// What comes late.
    Late,
    /// What couples two joints.
    Pair,
    /// A curve over the position.
    Curve,
    /// What depends on other joints.
    Others,
    /// What depends on the past.
    Past,
    /// Where a joint's zero is.
    Zero,
    /// What is wrong with a link.
    Link,
    /// What is wrong with the whole arm.
    Arm,
    /// What is simulated behind a drive.
    Behind,
    /// What cuts the torque.
    Limit,
}

impl Turn {
    /// The round of turns that it is in.
    fn round(self) -> u8 {
        match self {
            Self::Link | Self::Arm => 1,
            Self::Behind | Self::Limit => 2,
            _ => 0,
        }
    }

    /// What forms are sorted by: of forms with the same key the catalogue's order holds.
    pub fn key(self, joint: Option<usize>, other: Option<usize>) -> (u8, Option<usize>, Self, Option<usize>) {
        // Of what is wrong with links and arm, the kind comes before the joint.
        let joint = if self.round() == 1 { None } else { joint };
        (self.round(), joint, self, other)
    }
}

/// One form: columns that come and go together.
#[derive(Clone, Debug)]
pub struct Form {
    /// When its turn comes.
    pub turn: Turn,
    /// Where; `None` is the whole arm.
    pub joint: Option<usize>,
    /// The other joint whose motion it depends on.
    pub other: Option<usize>,
    /// Its columns.
    pub terms: Vec<Term>,
}

impl Form {
    /// A form on a joint.
    pub fn on(turn: Turn, joint: usize, terms: Vec<Term>) -> Self {
        Self {
            turn,
            joint: Some(joint),
            other: None,
            terms,
        }
    }

    /// A form on the whole arm.
    pub fn of_arm(terms: Vec<Term>) -> Self {
        Self {
            turn: Turn::Arm,
            joint: None,
            other: None,
            terms,
        }
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
    /// Its place among those that are looked for; sums run in this order.
    pub turn: u8,
    /// Its columns, always acting, on a joint (of the whole arm: any).
    pub terms: fn(usize) -> Vec<Term>,
    /// The number of columns with which the onset is searched.
    pub looked_for_with: usize,
    /// The numbers of columns of the candidates with an onset, one candidate for each.
    pub taken: &'static [usize],
}
