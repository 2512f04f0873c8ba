//! What may be the cause: the catalogue's effects, and forms that have no name.

use crate::regression::columns::Scales;
use crate::regression::term::{Term, Times};

/// A kind of cause; the catalogue's first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Cause {
    /// `viscous_friction`
    Viscous,
    /// `coulomb_friction`
    Coulomb,
    /// `friction_asymmetry`
    Asymmetry,
    /// `stribeck_friction`
    Stribeck,
    /// `load_dependent_friction`
    LoadDependent,
    /// `thermal_drift`
    Thermal,
    /// `quadratic_drag`
    Drag,
    /// `rotor_inertia`
    RotorInertia,
    /// `torque_scale`
    TorqueScale,
    /// `torque_offset`
    TorqueOffset,
    /// `torque_ripple`
    Ripple,
    /// `torque_saturation`
    Saturation,
    /// `actuation_delay`
    Delay,
    /// `joint_elasticity`
    Elasticity,
    /// `backlash`
    Backlash,
    /// `transmission_coupling`, with the other joint
    Coupling(usize),
    /// `payload`
    Payload,
    /// `link_inertial_error`
    LinkError,
    /// `inertial_scale`
    InertialScale,
    /// `gravity_misalignment`
    Tilt,
    /// `encoder_offset`
    EncoderOffset,
    /// `spring`
    Spring,
    /// `external_contact`
    Contact,
    /// Without a name: any smooth function of the joint's own position.
    OwnPosition,
    /// Without a name: of another joint's position.
    OtherPosition(usize),
    /// Without a name: even or nonlinear in another joint's velocity.
    OtherSpeed(usize),
    /// Without a name: the motion's past.
    History,
    /// Without a name: position times velocity.
    Product,
    /// Without a name: a sinusoid in time.
    Periodic,
    /// Without a name: any slow function of time.
    Time,
}

impl Cause {
    /// Those of the catalogue that are on the whole arm.
    pub const ON_THE_ARM: [Self; 4] = [Self::Payload, Self::InertialScale, Self::Tilt, Self::Contact];

    /// Those of the catalogue that are on a joint; the other joint of a coupling does not matter here.
    pub const ON_A_JOINT: [Self; 19] = [
        Self::Viscous,
        Self::Coulomb,
        Self::Asymmetry,
        Self::Stribeck,
        Self::LoadDependent,
        Self::Thermal,
        Self::Drag,
        Self::RotorInertia,
        Self::TorqueScale,
        Self::TorqueOffset,
        Self::Ripple,
        Self::Saturation,
        Self::Delay,
        Self::Elasticity,
        Self::Backlash,
        Self::Coupling(0),
        Self::LinkError,
        Self::EncoderOffset,
        Self::Spring,
    ];

    /// The catalogue's name; `None` for what has none.
    pub fn name(self) -> Option<&'static str> {
        Some(match self {
            Self::Viscous => "viscous_friction",
            Self::Coulomb => "coulomb_friction",
            Self::Asymmetry => "friction_asymmetry",
            Self::Stribeck => "stribeck_friction",
            Self::LoadDependent => "load_dependent_friction",
            Self::Thermal => "thermal_drift",
            Self::Drag => "quadratic_drag",
            Self::RotorInertia => "rotor_inertia",
            Self::TorqueScale => "torque_scale",
            Self::TorqueOffset => "torque_offset",
            Self::Ripple => "torque_ripple",
            Self::Saturation => "torque_saturation",
            Self::Delay => "actuation_delay",
            Self::Elasticity => "joint_elasticity",
            Self::Backlash => "backlash",
            Self::Coupling(_) => "transmission_coupling",
            Self::Payload => "payload",
            Self::LinkError => "link_inertial_error",
            Self::InertialScale => "inertial_scale",
            Self::Tilt => "gravity_misalignment",
            Self::EncoderOffset => "encoder_offset",
            Self::Spring => "spring",
            Self::Contact => "external_contact",
            Self::OwnPosition
            | Self::OtherPosition(_)
            | Self::OtherSpeed(_)
            | Self::History
            | Self::Product
            | Self::Periodic
            | Self::Time => return None,
        })
    }

    /// Whether its coefficient must be one: it is simulated at its size, not scaled.
    pub fn is_unit(self) -> bool {
        matches!(self, Self::Saturation | Self::Delay | Self::Elasticity | Self::Backlash)
    }

    /// Whether it is the friction that every drive has.
    pub fn is_friction(self) -> bool {
        matches!(self, Self::Viscous | Self::Coulomb)
    }

    /// Whether a URDF ordinarily leaves it out: friction and the drives' inertia need less evidence.
    pub fn is_ordinary(self) -> bool {
        matches!(self, Self::Viscous | Self::Coulomb | Self::RotorInertia)
    }

    /// Whether it is ordinary, or a constant beside that.
    pub fn is_simple(self) -> bool {
        self.is_ordinary() || matches!(self, Self::Asymmetry | Self::TorqueOffset)
    }

    /// Whether it says that masses are not the model's.
    pub fn is_wrong_mass(self) -> bool {
        matches!(self, Self::LinkError | Self::InertialScale | Self::Payload)
    }

    /// The simpler cause that it is a form of.
    pub fn plain(self) -> Option<Self> {
        match self {
            Self::Asymmetry | Self::Stribeck | Self::LoadDependent | Self::Thermal => Some(Self::Coulomb),
            Self::Elasticity | Self::Backlash => Some(Self::RotorInertia),
            Self::Spring => Some(Self::TorqueOffset),
            _ => None,
        }
    }

    /// Whether there is but one form that it can have: it follows from rigid-body dynamics.
    pub fn is_certain_in_form(self) -> bool {
        matches!(
            self,
            Self::TorqueScale
                | Self::TorqueOffset
                | Self::Payload
                | Self::LinkError
                | Self::InertialScale
                | Self::Tilt
                | Self::EncoderOffset
        )
    }

    /// Whether it may be there in one recording alone.
    pub fn is_passing(self) -> bool {
        matches!(self, Self::Contact | Self::Thermal | Self::Time | Self::Periodic)
    }

    /// The evidence that it must bring beyond that of its coefficients (nats).
    fn prior(self) -> f64 {
        match self {
            Self::Viscous | Self::Coulomb => 2.0,
            Self::RotorInertia | Self::Payload => 4.0,
            Self::TorqueOffset => 10.0,
            Self::Elasticity | Self::Backlash | Self::Contact | Self::Thermal => 8.0,
            Self::OwnPosition
            | Self::OtherPosition(_)
            | Self::OtherSpeed(_)
            | Self::History
            | Self::Product
            | Self::Periodic
            | Self::Time => 9.0,
            _ => 6.0,
        }
    }
}

/// Whether a cause is a candidate on a joint, or (`None`) on the whole arm.
pub type MayBe<'a> = dyn Fn(Cause, Option<usize>) -> bool + 'a;

/// Some columns that come and go together.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// What it would be.
    pub cause: Cause,
    /// Where; `None` is the whole arm.
    pub joint: Option<usize>,
    /// Its columns, as indices into the table.
    pub columns: Vec<usize>,
    /// The evidence it must bring (nats).
    pub cost: f64,
    /// Whether it is a size tried in refining another.
    pub is_trial: bool,
}

/// Evidence that each coefficient must bring (nats).
pub const PER_COEFFICIENT: f64 = 2.5;

impl Candidate {
    /// A candidate with the usual cost.
    pub fn new(cause: Cause, joint: Option<usize>, columns: Vec<usize>) -> Self {
        let cost = cause.prior() + PER_COEFFICIENT * columns.len() as f64;
        Self {
            cause,
            joint,
            columns,
            cost,
            is_trial: false,
        }
    }
}

/// Two joints that turn one drive are no further apart in the chain: the drives of a wrist's axes pass through each other.
pub const FARTHEST_COUPLED: usize = 2;

/// The longest delay of a drive (s): no position loop bears more.
pub const LONGEST_DELAY: f64 = 0.03;

/// The shortest time constant of a drive that warms (s).
pub const FASTEST_WARMING: f64 = 8.0;

/// Damping ratios of a gap's ends to begin with: the link stays, or bounces.
pub const STOP_RATIOS: [f64; 2] = [1.0, 0.2];

/// Gaps to begin with, as shares of the range of the motion.
pub const GAPS: [f64; 7] = [0.0025, 0.004, 0.008, 0.014, 0.022, 0.035, 0.06];

/// The candidates known from the outset, with the terms of their columns; `span` is the time from the first recording
/// to the last (s), where one clock runs through them.
pub fn catalogue(scales: &Scales, span: Option<f64>, times: &[(f64, f64)]) -> Vec<(Cause, Option<usize>, Vec<Term>)> {
    let dof = scales.speed.len();
    let moves = |joint: usize| scales.speed[joint] > scales.rest[joint];
    let mut list = Vec::new();
    for joint in (0..dof).filter(|&joint| moves(joint)) {
        friction(&mut list, joint, scales.speed[joint], span);
        drive(&mut list, joint, scales);
        // A drive that two joints turn sits near both.
        for other in (joint.saturating_sub(FARTHEST_COUPLED)..joint).filter(|&other| moves(other)) {
            let pair = vec![Term::PairVelocity(joint, other), Term::PairAcceleration(joint, other)];
            list.push((Cause::Coupling(other), Some(joint), pair.clone()));
            for sense in [1.0, -1.0] {
                let mut terms = pair.clone();
                terms.push(Term::PairSign { joint, other, sense });
                list.push((Cause::Coupling(other), Some(joint), terms));
            }
        }
        nameless(&mut list, joint, scales, times);
        list.push((Cause::EncoderOffset, Some(joint), vec![Term::EncoderOffset(joint)]));
    }
    for link in 0..dof {
        list.push((Cause::LinkError, Some(link), vec![Term::Link(link)]));
    }
    list.push((Cause::Payload, None, (0..10).map(Term::Payload).collect()));
    list.push((Cause::Payload, None, (0..4).map(Term::Payload).collect()));
    list.push((Cause::InertialScale, None, vec![Term::Scale]));
    list.push((Cause::Tilt, None, vec![Term::Tilt(0), Term::Tilt(1)]));
    list
}

type List = Vec<(Cause, Option<usize>, Vec<Term>)>;

fn friction(list: &mut List, joint: usize, speed: f64, span: Option<f64>) {
    let mut add = |cause, terms| list.push((cause, Some(joint), terms));
    let sign = Term::Sign(joint);
    add(Cause::Viscous, vec![Term::Velocity(joint)]);
    add(Cause::Coulomb, vec![sign]);
    add(Cause::Asymmetry, vec![sign, Term::AbsSign(joint)]);
    for share in [0.05, 0.08, 0.12, 0.18, 0.27, 0.4] {
        for exponent in [1.0, 2.0] {
            let velocity = share * speed;
            let term = Term::Stribeck {
                joint,
                velocity,
                exponent,
            };
            add(Cause::Stribeck, vec![sign, term]);
        }
    }
    add(Cause::LoadDependent, vec![sign, Term::LoadSign(joint)]);
    for share in [0.15, 0.25, 0.4, 0.6, 1.0] {
        let time_constant = share * span.unwrap_or(0.0);
        // What fades faster is no warming of a drive.
        if time_constant < FASTEST_WARMING {
            continue;
        }
        let term = Term::Warm { joint, time_constant };
        add(Cause::Thermal, vec![sign, term]);
    }
    for exponent in [2.0, 1.6, 2.5] {
        add(Cause::Drag, vec![Term::Drag { joint, exponent }]);
    }
}

fn drive(list: &mut List, joint: usize, scales: &Scales) {
    let mut add = |cause, terms| list.push((cause, Some(joint), terms));
    add(Cause::RotorInertia, vec![Term::Acceleration(joint)]);
    add(Cause::TorqueScale, vec![Term::Rigid(joint)]);
    add(Cause::TorqueOffset, vec![Term::One(joint)]);
    let position = |power| Term::Position(joint, power);
    add(Cause::Spring, vec![Term::One(joint), position(1)]);
    add(
        Cause::Spring,
        vec![Term::One(joint), position(1), position(2), position(3)],
    );
    for delay in [0.002, 0.004, 0.006, 0.009, 0.013, 0.02, LONGEST_DELAY] {
        add(Cause::Delay, vec![Term::Late { joint, delay }]);
    }
    for share in GAPS {
        let gap = Term::Gap {
            joint,
            halfgap: share * scales.range[joint].min(1.5),
            stop: f64::INFINITY,
            ratio: 1.0,
        };
        add(Cause::Backlash, vec![gap, Term::Acceleration(joint)]);
    }
}

fn nameless(list: &mut List, joint: usize, scales: &Scales, times: &[(f64, f64)]) {
    let dof = scales.speed.len();
    let mut add = |cause, terms| list.push((cause, Some(joint), terms));
    let tents = |of: usize, count: usize, times: Times| -> Vec<Term> {
        let width = scales.range[of] / (count - 1) as f64;
        let lowest = scales.middle[of] - 0.5 * scales.range[of];
        (0..count)
            .map(|k| Term::Tent {
                joint,
                of,
                centre: lowest + width * k as f64,
                width,
                times,
            })
            .collect()
    };
    // A curve that rises throughout is a spring's; any other has no name.
    add(Cause::Spring, tents(joint, 12, Times::One));
    add(Cause::OwnPosition, tents(joint, 12, Times::One));
    for other in (0..dof).filter(|&o| o != joint && scales.speed[o] > scales.rest[o]) {
        add(Cause::OtherPosition(other), tents(other, 8, Times::One));
        let forms = (0..4).map(|form| Term::OtherSpeed(joint, other, form)).collect();
        add(Cause::OtherSpeed(other), forms);
    }
    for time in [0.1, 0.3, 1.0, 3.0] {
        let terms = vec![Term::Memory(joint, time, 0), Term::Memory(joint, time, 1)];
        add(Cause::History, terms);
    }
    for share in [0.02, 0.06, 0.15, 0.35] {
        add(Cause::History, vec![Term::Play(joint, share * scales.range[joint])]);
    }
    add(Cause::Product, (0..4).map(|form| Term::Product(joint, form)).collect());
    for times in [Times::Velocity, Times::Speed] {
        add(Cause::Product, tents(joint, 6, times));
    }
    let mut moments = Vec::new();
    for &(from, to) in times {
        let count = ((to - from) / 4.0).ceil().clamp(2.0, 12.0) as usize;
        let width = (to - from) / (count - 1) as f64;
        moments.extend((0..count).map(|k| Term::Moment {
            joint,
            centre: from + width * k as f64,
            width,
        }));
    }
    add(Cause::Time, moments);
}
