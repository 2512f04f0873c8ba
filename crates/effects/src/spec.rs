//! Everything that the program knows of an effect: name, parameters, relations, texts and functions. Each effect is one [`Spec`].

mod effect;
mod parameter;

use arm::JointKind;

use crate::estimate::Estimate;
use crate::fitted::Fitted;
use crate::form::{Form, Grounds, SetsIn};
use crate::machine::{JointIndices, Machine};
use crate::regressor::Regressor;
use crate::term::Term;

pub use effect::{Effect, Value};
pub use parameter::{ONSET, Parameter, Range, Shape};

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

/// How the detectable size of an effect that was not found is determined. Sizes are of its first main parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detectability {
    /// No detectable size is determined.
    Never,
    /// A torque limit: from the limits at which it was tried.
    Limit {
        /// Why it is not testable.
        because: &'static str,
        /// Why it was not found if no tried limit is detectable.
        if_none: &'static str,
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

/// The 95 % interval of a parameter by its key; `None` if it has none.
pub type Intervals<'a> = dyn Fn(&str) -> Option<[f64; 2]> + 'a;

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
    /// where the URDF is wrong everywhere; `None` for an effect without this test. One that changed needs less.
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
    /// The least ratio of its torque on one of its joints to what the model leaves unexplained there, on all training rows. With less, it may
    /// be a part of something that is not in the catalogue.
    pub least_over_error: Option<f64>,
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
    /// Whether it depends on another joint's motion.
    pub has_other: bool,
    /// The forms to try from the beginning; none if residuals suggest them later.
    pub forms: fn(&Grounds<'_>) -> Vec<Form>,
    /// How its onset within the recordings is searched, if it may have one.
    pub sets_in: Option<SetsIn>,
    /// Whether two candidates on one joint (and with the same other joint) are the same effect at different sizes, judged by
    /// their first columns.
    pub is_same: fn(&Term, &Term) -> bool,
    /// Whether its fitted coefficients are physically possible.
    pub is_possible: fn(&dyn Fitted) -> bool,
    /// Whether the 95 % intervals of its parameters, by key, allow a physically possible effect; the last argument is the
    /// relative standard deviation of the torque constants.
    pub is_certain: fn(&Effect, &Intervals<'_>, f64) -> bool,
    /// Whether the effects found beside it exclude it.
    pub is_contradicted: fn(&Effect, &[Effect]) -> bool,
    /// The level of its dry friction (N m or N), if it is a dry friction.
    pub dry_friction: fn(&Effect) -> Option<f64>,
    /// The effect, given on its joint, with the parameters of an estimate, each recorded with its interval; `None` if it cannot
    /// be read or has no name.
    pub read: fn(Effect, &mut dyn Estimate) -> Option<Effect>,
    /// The term of an effect that is a function of the commanded torque on the joint of an index, with the sizes of the effect;
    /// its coefficient is one.
    pub of_command: fn(&Effect, usize) -> Option<Term>,
    /// What is wrong with its parameters, apart from their ranges: the parameter, its value and the requirement.
    pub refuse: fn(&Effect) -> Option<(&'static str, f64, &'static str)>,
    /// The one effect that acts as two of them on one joint do together; `None` if they stay two.
    pub sum: fn(&Effect, &Effect) -> Option<Effect>,
    /// Whether two of them on one joint are the same effect, given twice.
    pub is_twin: fn(&Effect, &Effect) -> bool,
    /// Adds the effect to a machine.
    pub apply: fn(&Effect, JointIndices, &mut Machine),
    /// The power of the noise in the column of one of its terms, relative to that in the torque of a link with an inertia (kg m² or
    /// kg), if the noise of the recorded positions is white and passes a filter of half power at a frequency (Hz).
    pub noise_gain: fn(&Term, f64, f64) -> f64,
    /// The title of an effect with these parameters, where it differs from [`Self::title`].
    pub own_title: fn(&Effect) -> Option<&'static str>,
    /// The sentence of an effect with these parameters, where it differs from [`Self::sentence`].
    pub own_sentence: fn(&Effect) -> Option<&'static str>,
    /// What the recordings from before a change say of an effect that is new, as a phrase.
    pub before_it: fn(&Effect) -> &'static str,
    /// The region of state where it acts, in words, from its columns on a kind of joint.
    pub region: fn(&[Term], JointKind) -> Option<String>,
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
        least_over_error: None,
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
        has_other: false,
        forms: |_| Vec::new(),
        sets_in: None,
        is_same: |_, _| true,
        is_possible: |_| true,
        is_certain: |_, _, _| true,
        is_contradicted: |_, _| false,
        dry_friction: |_| None,
        read: |_, _| None,
        of_command: |_, _| None,
        refuse: |_| None,
        sum: |_, _| None,
        is_twin: |_, _| true,
        apply: |_, _, _| (),
        noise_gain: |_, _, _| 0.0,
        own_title: |_| None,
        own_sentence: |_| None,
        before_it: |_| "absent in the recordings from before",
        region: |_, _| None,
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
