//! What is known of an effect before any recording: name, parameters, relations and texts.

use arm::JointKind;

use crate::quantity::Quantity;
use crate::regressor::Regressor;

/// The evidence that an effect must bring in addition to that of its coefficients (nats), unless its own file states
/// another. Source: first diagnosis.
const PRIOR: f64 = 6.0;
/// The evidence that an unmodelled form must bring in addition to that of its coefficients (nats). Source: first
/// diagnosis.
const UNMODELLED_PRIOR: f64 = 9.0;

/// The scope of an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// On one joint.
    Joint,
    /// On the whole arm.
    Arm,
}

/// What a URDF can hold of an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InUrdf {
    /// Nothing.
    Nothing,
    /// The joint's damping.
    Damping,
    /// The joint's friction.
    Friction,
    /// The masses and inertias of links.
    Inertials,
}

/// The quantity of the state that a figure of an effect has as its horizontal axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Against {
    /// The joint's position.
    Position,
    /// The joint's velocity.
    Speed,
    /// The joint's acceleration.
    Acceleration,
    /// Time.
    Time,
    /// Time; torques count along the motion.
    TimeAlong,
    /// The rigid model's torque.
    Load,
    /// Its absolute value; torques count along the motion.
    LoadAlong,
    /// The velocity of another joint.
    OtherSpeed,
    /// The torque that the effect predicts, where no single quantity describes it.
    Predicted,
}

/// What a parameter holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A number.
    Number,
    /// A list of this many numbers. A finding gives them separately, under these keys (not at all if there are none).
    List(usize, &'static [&'static str]),
    /// Points (x, y) in order of x.
    Points,
}

/// The values that a parameter may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Any finite value.
    Finite,
    /// Zero and above.
    NotNegative,
    /// Above zero.
    Positive,
    /// −1 and above.
    AtLeastMinusOne,
    /// Above −1.
    AboveMinusOne,
}

impl Range {
    /// Whether `value` is in it.
    pub fn contains(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Finite => true,
                Self::NotNegative => value >= 0.0,
                Self::Positive => value > 0.0,
                Self::AtLeastMinusOne => value >= -1.0,
                Self::AboveMinusOne => value > -1.0,
            }
    }

    /// The requirement on a value, in words.
    pub fn requirement(self) -> &'static str {
        match self {
            Self::Finite => "finite",
            Self::NotNegative => "finite and not negative",
            Self::Positive => "finite and positive",
            Self::AtLeastMinusOne => "finite and at least -1",
            Self::AboveMinusOne => "finite and above -1",
        }
    }
}

/// A parameter of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Its key in files and findings.
    pub key: &'static str,
    /// What it measures.
    pub quantity: Quantity,
    /// What it holds.
    pub shape: Shape,
    /// The values that each of its numbers may have.
    pub range: Range,
    /// The value if a file does not give one; `None` if a file must give it.
    pub default: Option<f64>,
    /// The value at which there is no effect.
    pub neutral: f64,
    /// A remark in files instead of the unit; an empty one leaves the unit out.
    pub remark: Option<&'static str>,
}

impl Parameter {
    /// A finite number that must be given and is neutral at zero.
    pub const fn new(key: &'static str, quantity: Quantity) -> Self {
        Self { key, quantity, shape: Shape::Number, range: Range::Finite, default: None, neutral: 0.0, remark: None }
    }

    /// This parameter, limited to `range`.
    pub const fn within(mut self, range: Range) -> Self {
        self.range = range;
        self
    }

    /// This parameter with a default.
    pub const fn or(mut self, default: f64) -> Self {
        self.default = Some(default);
        self
    }

    /// This parameter, which has no effect at the value `neutral`.
    pub const fn neutral_at(mut self, neutral: f64) -> Self {
        self.neutral = neutral;
        self
    }

    /// This parameter with a shape other than a number.
    pub const fn of(mut self, shape: Shape) -> Self {
        self.shape = shape;
        self
    }

    /// This parameter with a remark instead of its unit.
    pub const fn remarked(mut self, remark: &'static str) -> Self {
        self.remark = Some(remark);
        self
    }
}

/// How the detectable size of an effect that was not found is determined. Sizes are of its first main parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detectability {
    /// No detectable size is determined.
    Never,
    /// A torque limit, which is detectable below the largest torque.
    Limit {
        /// Why it is not testable.
        because: &'static str,
    },
    /// From the sizes at which it was tried.
    Sized {
        /// Why it is not testable.
        because: &'static str,
        /// Why it was not found if no tried size is detectable.
        if_none: &'static str,
        /// Whether small sizes are detectable, instead of large ones.
        is_seen_below: bool,
    },
    /// From the one coefficient that its torque is proportional to.
    Linear {
        /// Why it was not found if these recordings allow no form of it.
        if_no_form: Option<&'static str>,
        /// Whether its size is relative to the first coefficient, so that it has none without that.
        is_of_first: bool,
        /// Whether its size is relative to the joint's whole torque.
        is_of_all_torque: bool,
    },
    /// On the whole arm, from the coefficients of its first columns, the least detectable of which counts: one mass, or the
    /// components of a direction.
    OfArm {
        /// The number of these columns.
        columns: usize,
    },
}

impl Detectability {
    /// Proportional to a coefficient, with no further condition.
    pub const LINEAR: Self = Self::Linear { if_no_form: None, is_of_first: false, is_of_all_torque: false };
}

/// The experiment to make where no motion distinguishes an effect from another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Experiment {
    /// Of two effects that no motion distinguishes, the one with the higher rank gives the experiment.
    pub rank: u8,
    /// The experiment that distinguishes it from others.
    pub text: &'static str,
}

/// Everything that is known of an effect before any recording.
#[derive(Clone, Copy, Debug)]
pub struct Spec {
    /// The name in the catalogue; empty for an unmodelled form.
    pub name: &'static str,
    /// Its name in two or three words.
    pub title: &'static str,
    /// A description for readers who do not know it.
    pub meaning: &'static str,
    /// The recording to make to distinguish it from similar effects.
    pub distinguished_by: &'static str,
    /// The torque that it adds, or its meaning (for the documentation).
    pub formula: &'static str,
    /// A finding as a noun phrase: `{key}` is a parameter with its unit, `{key%}` the parameter in per cent, `{other}` the
    /// other joint.
    pub sentence: &'static str,
    /// Whether it acts on a joint or on the whole arm.
    pub scope: Scope,
    /// Its parameters, in the order of files.
    pub parameters: &'static [Parameter],
    /// The parameters that measure its size, the best first.
    pub main: &'static [&'static str],
    /// Whether it may begin within the recordings.
    pub may_set_in: bool,
    /// Whether the search also tries it as an effect that ended at a change. This is for effects of one sign, which no second effect can
    /// cancel, and for those that the background represents while they act. A friction that generalises a simpler one is not tried: the
    /// simpler one would remain.
    pub may_end: bool,
    /// Whether there may be two on one joint, or on the arm.
    pub may_repeat: bool,
    /// The simpler effect that it generalises.
    pub generalises: Option<&'static str>,
    /// The least part of the joint's torque (RMS over standard deviation) that it must explain beyond the simpler effect.
    pub least_beyond_simpler: f64,
    /// The effect that is fitted with it and named in addition.
    pub brings: Option<&'static str>,
    /// Effects that are not named on the same joint, or on the last joint beside an effect on the whole arm: they exclude each other, or
    /// are not told apart there. It is sufficient that one of two effects lists the other.
    pub excludes: &'static [&'static str],
    /// The evidence that it must bring in addition to that of its coefficients (nats).
    pub prior: f64,
    /// Whether it is a baseline effect: friction and rotor inertia, which most URDFs omit, need less evidence.
    pub is_baseline: bool,
    /// Whether it is a friction that every drive has.
    pub is_friction: bool,
    /// Whether it is a baseline effect or a constant.
    pub is_baseline_or_constant: bool,
    /// Whether its form is certain, because it follows from rigid-body dynamics.
    pub is_certain_in_form: bool,
    /// The evidence that it must bring beside the correction of all inertial parameters that is best without it (nats),
    /// where the URDF is wrong everywhere; `None` for an effect without this test.
    pub least_beside_inertials: Option<f64>,
    /// The largest deviation of its main parameter from that of no effect with which it is named where the URDF is wrong everywhere.
    pub most_beside_inertials: Option<f64>,
    /// Whether wrong masses may hide it, so that it may be larger than the torque to be explained. Baseline effects always may be.
    pub may_be_hidden: bool,
    /// Whether it may be present in one recording only.
    pub may_be_in_one_recording: bool,
    /// Whether residuals suggest its forms; they are suggested again when more is known.
    pub is_suggested: bool,
    /// Whether it may be a part of inertial parameters that differ from the URDF's.
    pub may_be_inertial: bool,
    /// The effect with the same torque if this one acts on all joints.
    pub same_on_all_joints: Option<&'static str>,
    /// The usual coefficients of its first column; others require more evidence.
    pub usual: Option<[f64; 2]>,
    /// Effects on its joint whose error of form resembles it, with the part of each that it must exceed.
    pub least_beside: &'static [(&'static str, f64)],
    /// It is named only if it is larger than this multiple of the structured residual of its joint, or for an effect on the whole arm, of
    /// one joint at least. `None` if it cannot be a part of such a residual.
    pub least_beside_residual: Option<f64>,
    /// Whether it is simulated at its size, so that its coefficient must be one: its torque depends on earlier motion.
    pub is_simulated: bool,
    /// Whether it means that masses differ from the model's.
    pub is_wrong_mass: bool,
    /// Whether the same effect of another joint may be named in its place, because it acts on the joints before its own, too.
    pub acts_before_its_joint: bool,
    /// Whether it acts on the link side of an elastic drive.
    pub is_beyond_the_drive: bool,
    /// What a URDF can hold of it.
    pub in_urdf: InUrdf,
    /// Whether its torque has many periods within the range of a motion, so that a figure needs narrow bins.
    pub is_periodic: bool,
    /// The state against which figures show it.
    pub against: Against,
    /// What an unattributed residual depends on, for an unmodelled form.
    pub depends_on: Option<Regressor>,
    /// How its detectable size is determined where it was not found.
    pub detectability: Detectability,
    /// Its place in the list of effects that are not testable.
    pub not_testable_turn: u8,
    /// The experiment to make where no motion distinguishes it from another effect.
    pub experiment: Option<Experiment>,
    /// Experiments that distinguish it from particular other effects; they precede [`Self::experiment`].
    pub experiments_against: &'static [(&'static str, &'static str)],
}

impl Spec {
    /// Whether it is friction of another form than a drive's dry and viscous friction, which hides or imitates it where that differs
    /// from recording to recording.
    pub fn is_form_of_friction(&self) -> bool {
        let acts_against_motion = matches!(self.against, Against::Speed | Against::LoadAlong | Against::TimeAlong);
        acts_against_motion && !self.is_friction
    }

    /// An effect of one joint without texts, parameters and relations: the defaults for the other fields of a spec.
    pub const EMPTY: Self = Self {
        name: "",
        title: "",
        meaning: "",
        distinguished_by: "",
        formula: "",
        sentence: "",
        scope: Scope::Joint,
        parameters: &[],
        main: &[],
        may_set_in: false,
        may_end: false,
        may_repeat: false,
        generalises: None,
        least_beyond_simpler: 0.0,
        brings: None,
        excludes: &[],
        prior: PRIOR,
        is_baseline: false,
        is_friction: false,
        is_baseline_or_constant: false,
        is_certain_in_form: false,
        least_beside_inertials: None,
        most_beside_inertials: None,
        may_be_hidden: false,
        may_be_in_one_recording: false,
        is_suggested: false,
        may_be_inertial: false,
        same_on_all_joints: None,
        usual: None,
        least_beside: &[],
        least_beside_residual: None,
        is_simulated: false,
        is_wrong_mass: false,
        acts_before_its_joint: false,
        is_beyond_the_drive: false,
        in_urdf: InUrdf::Nothing,
        is_periodic: false,
        against: Against::Predicted,
        depends_on: None,
        detectability: Detectability::Never,
        not_testable_turn: u8::MAX,
        experiment: None,
        experiments_against: &[],
    };

    /// [`Self::EMPTY`] for an unmodelled form.
    pub const UNMODELLED: Self = Self { prior: UNMODELLED_PRIOR, ..Self::EMPTY };

    /// The parameter `key`, which may be a part of a list.
    pub fn parameter(&self, key: &str) -> Option<&'static Parameter> {
        let is_part = |parameter: &&Parameter| match parameter.shape {
            Shape::List(_, parts) => parts.contains(&key),
            _ => false,
        };
        let own = self.parameters.iter().find(|parameter| parameter.key == key);
        own.or_else(|| self.parameters.iter().find(is_part))
            .or_else(|| (key == "onset" && self.may_set_in).then_some(&ONSET))
    }

    /// The SI unit of the parameter `key` at a joint of `kind`.
    pub fn unit(&self, key: &str, kind: JointKind) -> Option<&'static str> {
        Some(self.parameter(key)?.quantity.unit(kind))
    }
}

/// The onset of an effect, on the recordings' own clock.
pub static ONSET: Parameter = Parameter::new("onset", Quantity::Time);
