//! The columns of the joint fit: what each candidate adds to the torques, as functions of the motion.

/// What can set in halfway.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Onset {
    /// A constant.
    One,
    /// The position.
    Position,
    /// The rigid torque.
    Rigid,
    /// q̇ |q̇|.
    Drag,
    /// One of the ten inertial parameters at the tool; it acts on all joints.
    Payload(usize),
}

/// One column: the torque on one joint or several, for a coefficient of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Term {
    /// q̇ of joint j.
    Velocity(usize),
    /// sgn q̇ of joint j.
    Sign(usize),
    /// |sgn q̇|: one in motion, none at a reversal.
    AbsSign(usize),
    /// 1.
    One(usize),
    /// e^(−|q̇/velocity|^exponent) sgn q̇.
    Stribeck {
        /// The joint.
        joint: usize,
        /// rad/s.
        velocity: f64,
        /// 1 or 2.
        exponent: f64,
    },
    /// |τ rigid| sgn q̇.
    LoadSign(usize),
    /// e^(−t/time constant) sgn q̇.
    Warm {
        /// The joint.
        joint: usize,
        /// s.
        time_constant: f64,
    },
    /// |q̇|^exponent sgn q̇.
    Drag {
        /// The joint.
        joint: usize,
        /// About 2.
        exponent: f64,
    },
    /// q̈.
    Acceleration(usize),
    /// The rigid torque of joint j.
    Rigid(usize),
    /// q to a power.
    Position(usize, i32),
    /// sin or cos of periods × q.
    Ripple {
        /// The joint.
        joint: usize,
        /// rad a rad.
        periods: f64,
        /// cos instead of sin.
        cosine: bool,
    },
    /// What a torque limit cuts off the commanded torque: τ − clip τ.
    Excess {
        /// The joint.
        joint: usize,
        /// N m.
        limit: f64,
    },
    /// τ(t) − τ(t − delay), measured.
    Late {
        /// The joint.
        joint: usize,
        /// s.
        delay: f64,
    },
    /// The link's motion behind an elastic joint, unit coefficient.
    Elastic {
        /// The joint.
        joint: usize,
        /// N m/rad.
        stiffness: f64,
        /// N m s/rad.
        damping: f64,
    },
    /// The link's motion behind a gap, unit coefficient.
    Gap {
        /// The joint.
        joint: usize,
        /// rad.
        halfgap: f64,
        /// The stiffness of its ends, N m/rad; infinite: they stop the link at once.
        stop: f64,
        /// The damping ratio of its ends against the link: from 1 on it does not bounce.
        ratio: f64,
    },
    /// Each of two joints feels the other's q̇: a drive that both turn, and its reaction.
    PairVelocity(usize, usize),
    /// Each of two joints feels the other's q̈.
    PairAcceleration(usize, usize),
    /// Two joints share a drive's dry friction, sgn of the sum of their q̇, or of the difference.
    PairSign {
        /// One of them.
        joint: usize,
        /// The other.
        other: usize,
        /// 1 for the sum, −1 for the difference.
        sense: f64,
    },
    /// One of the ten inertial parameters at the tool.
    Payload(usize),
    /// The link's share of the rigid torque.
    Link(usize),
    /// ∂τ/∂q of one joint.
    EncoderOffset(usize),
    /// ∂τ/∂(turn of the base about x or y).
    Tilt(usize),
    /// The rigid torque of all joints, drives apart.
    Scale,
    /// A unit force on the tool along a base axis, between two times.
    Force {
        /// 0, 1, 2.
        axis: usize,
        /// s.
        from: f64,
        /// s.
        to: f64,
        /// Half a sine instead of constant.
        round: bool,
    },
    /// A tent on a joint's position.
    Tent {
        /// The joint that feels it.
        joint: usize,
        /// The joint whose position it depends on.
        of: usize,
        /// Its top (rad or m).
        centre: f64,
        /// Half its foot (rad or m).
        width: f64,
        /// What it is multiplied with.
        times: Times,
    },
    /// |q̇|, q̇², q̇ |q̇| of another joint.
    OtherSpeed(usize, usize, usize),
    /// A memory of q̇ (0) or sgn q̇ (1) that fades with a time constant (s).
    Memory(usize, f64, usize),
    /// How far a drag link of some play (rad) is from the middle of it, −1 to 1.
    Play(usize, f64),
    /// q q̇, q sgn q̇, q² sgn q̇, q̇ times another's position.
    Product(usize, usize),
    /// sin or cos of ω t.
    Wave {
        /// The joint.
        joint: usize,
        /// rad/s.
        omega: f64,
        /// cos instead of sin.
        cosine: bool,
    },
    /// A column that is nothing before a time.
    Since {
        /// The joint, of what acts on one.
        joint: usize,
        /// The column.
        what: Onset,
        /// s, on the recordings' own clock.
        from: f64,
    },
    /// A tent on time.
    Moment {
        /// The joint.
        joint: usize,
        /// Its top (s).
        centre: f64,
        /// Half its foot (s).
        width: f64,
    },
}

impl Onset {
    /// The same on `joint`, always acting.
    pub fn always(self, joint: usize) -> Term {
        match self {
            Self::One => Term::One(joint),
            Self::Position => Term::Position(joint, 1),
            Self::Rigid => Term::Rigid(joint),
            Self::Drag => Term::Drag { joint, exponent: 2.0 },
            Self::Payload(parameter) => Term::Payload(parameter),
        }
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

impl Term {
    /// When it sets in (s); `None` if it always acts.
    pub fn onset(self) -> Option<f64> {
        match self {
            Self::Since { from, .. } => Some(from),
            _ => None,
        }
    }

    /// The same term, always acting.
    pub fn always(self) -> Self {
        match self {
            Self::Since { joint, what, .. } => what.always(joint),
            _ => self,
        }
    }

    /// Whether it depends on the model along the motion, not on the motion and the torque alone.
    pub fn is_dynamic(self) -> bool {
        matches!(
            self,
            Self::LoadSign(_)
                | Self::Rigid(_)
                | Self::Since {
                    what: Onset::Rigid | Onset::Payload(_),
                    ..
                }
                | Self::Elastic { .. }
                | Self::Gap { .. }
                | Self::Payload(_)
                | Self::Link(_)
                | Self::EncoderOffset(_)
                | Self::Tilt(_)
                | Self::Scale
                | Self::Force { .. }
        )
    }

    /// The one joint it acts on; `None` if it may act on all.
    pub fn joint(self) -> Option<usize> {
        match self {
            Self::Velocity(joint)
            | Self::Sign(joint)
            | Self::AbsSign(joint)
            | Self::One(joint)
            | Self::Stribeck { joint, .. }
            | Self::LoadSign(joint)
            | Self::Warm { joint, .. }
            | Self::Drag { joint, .. }
            | Self::Acceleration(joint)
            | Self::Rigid(joint)
            | Self::Position(joint, _)
            | Self::Ripple { joint, .. }
            | Self::Excess { joint, .. }
            | Self::Late { joint, .. }
            | Self::Tent { joint, .. }
            | Self::OtherSpeed(joint, ..)
            | Self::Memory(joint, ..)
            | Self::Play(joint, _)
            | Self::Product(joint, _)
            | Self::Wave { joint, .. }
            | Self::Since {
                joint,
                what: Onset::One | Onset::Position | Onset::Rigid | Onset::Drag,
                ..
            }
            | Self::Moment { joint, .. } => Some(joint),
            Self::PairVelocity(..)
            | Self::PairAcceleration(..)
            | Self::PairSign { .. }
            | Self::Elastic { .. }
            | Self::Gap { .. }
            | Self::Payload(_)
            | Self::Link(_)
            | Self::EncoderOffset(_)
            | Self::Tilt(_)
            | Self::Scale
            | Self::Since {
                what: Onset::Payload(_),
                ..
            }
            | Self::Force { .. } => None,
        }
    }
}
