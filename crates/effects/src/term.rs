//! The columns of the joint fit: a law with a joint and sizes. Each law is in the file of its effect.

use std::fmt;

use arm::Arm;

use crate::compliance::LinkSide;
use crate::signals::Signals;

/// A size on which a column depends nonlinearly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// A velocity, a time, a limit, a stiffness, a gap.
    Main,
    /// The damping beside a stiffness.
    Damping,
    /// The stiffness of a gap's ends.
    Stop,
    /// The duration of a contact.
    Duration,
    /// The number of periods of a ripple.
    Periods,
    /// The exponent of a drag. It is a form rather than a size, and has no interval.
    Exponent,
}

/// How a law takes part in dry friction: at rest, dry friction may hold any torque within its cone.
#[derive(Clone, Copy)]
pub enum Cone {
    /// The column is no dry friction.
    No,
    /// The level of the cone for a coefficient of one, as a function of the term, the load (N m or N) and the time (s).
    Level(fn(&Term, f64, f64) -> f64),
    /// It shifts the middle of the cone.
    Middle,
}

/// The arm about which columns are linearised: the model with those results of a fit on which columns depend nonlinearly.
pub struct Carried {
    /// The arm.
    pub arm: Arm,
    /// The true positions of the joints minus the encoders' (rad or m).
    pub offset: Vec<f64>,
    /// Ten inertial parameters of a body on the tool.
    pub payload: [f64; 10],
    /// The turn of the base about x and y (rad).
    pub tilt: [f64; 2],
    /// The difference of gravity from the model's, in the base's frame (m/s²).
    pub gravity: [f64; 3],
}

/// The function that computes a term's column on a joint of a motion.
pub type Column = fn(&Term, usize, &Signals<'_>) -> Option<Vec<f64>>;

/// The function that gives another form of a term, with its size multiplied by a factor, and whether the form differs.
pub type OtherForm = fn(&Term, f64) -> (Term, bool);

/// A law: the definition of a column.
pub struct Law {
    /// Its name, for debugging.
    pub name: &'static str,
    /// The torque of a term on a joint (N m or N) for a coefficient of one; `None` if it has none there.
    pub column: Column,
    /// Whether it depends on the model along the motion, and not only on motion and torque.
    pub needs_model: bool,
    /// Whether the model's derivatives by position and velocity are needed.
    pub needs_derivatives: bool,
    /// The meaning of its sizes, by their index in a term.
    pub sizes: &'static [(Size, usize)],
    /// A term with one size multiplied by a factor, where that changes more than this size.
    pub varied: Option<fn(&Term, Size, f64) -> Term>,
    /// The other form that a term may have, with its size multiplied by a factor, and whether that form differs.
    pub other_form: Option<OtherForm>,
    /// Small steps of its sizes for refinement.
    pub nudges: &'static [fn(&Term, f64) -> Term],
    /// Terms with compliant ends of a gap, for a link of an inertia (kg m² or kg).
    pub softened: fn(&Term, f64) -> Vec<Term>,
    /// Whether the sizes of a term are meaningful.
    pub is_sound: fn(&Term) -> bool,
    /// How it takes part in dry friction.
    pub cone: Cone,
    /// The link's motion behind a compliant joint, simulated once for all joints.
    pub link_side: Option<fn(&Term, &Signals<'_>) -> LinkSide>,
    /// Whether this compliance is that of the base, so that its torque depends on the whole arm, and not on that of a joint.
    pub is_of_base: bool,
    /// Adds what a fit found to the arm about which columns are evaluated.
    pub carry: Option<fn(&Term, f64, &mut Carried)>,
    /// Whether it is computed from the measured torque, which is not known for a planned motion.
    pub uses_measured_torque: bool,
    /// Whether it limits the torque, so that it is zero in a planned motion within the limit.
    pub cuts: bool,
}

impl Law {
    /// A law that has only a column: the defaults for the other fields.
    pub const PLAIN: Self = Self {
        name: "",
        column: |_, _, _| None,
        needs_model: false,
        needs_derivatives: false,
        sizes: &[],
        varied: None,
        other_form: None,
        nudges: &[],
        softened: |_, _| Vec::new(),
        is_sound: |_| true,
        cone: Cone::No,
        link_side: None,
        is_of_base: false,
        carry: None,
        uses_measured_torque: false,
        cuts: false,
    };
}

impl fmt::Debug for Law {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name)
    }
}

/// One column: the torque of a law on one joint or several, for a coefficient of one.
#[derive(Clone, Copy, Debug)]
pub struct Term {
    /// The law.
    pub law: &'static Law,
    /// The one joint it acts on; `None` if it may act on all.
    pub joint: Option<usize>,
    /// Indices of the joints, the link, the parameter or the axis.
    pub of: [usize; 2],
    /// The index of the law's form.
    pub form: usize,
    /// Its sizes.
    pub sizes: [f64; 4],
    /// When it acts.
    pub acts: Acts,
}

/// When a term acts, on the recordings' own clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Acts {
    /// At all times.
    Always,
    /// From an onset on (s).
    Since(f64),
    /// Before a time (s): in the recordings from before a change.
    Until(f64),
}

impl Acts {
    /// When an effect with these terms acts: as the first one that does not always act.
    pub fn of<'a>(terms: impl IntoIterator<Item = &'a Term>) -> Self {
        let mut all = terms.into_iter().map(|term| term.acts);
        all.find(|acts| *acts != Self::Always).unwrap_or(Self::Always)
    }

    /// Whether both always act, both begin, or both end; the times may differ.
    pub fn is_like(self, other: Self) -> bool {
        std::mem::discriminant(&self) == std::mem::discriminant(&other)
    }

    /// The time at which it begins or ends (s); `None` if it always acts.
    pub fn time(self) -> Option<f64> {
        match self {
            Self::Since(time) | Self::Until(time) => Some(time),
            Self::Always => None,
        }
    }

    /// Whether it acts at `time` (s).
    pub fn at(self, time: f64) -> bool {
        match self {
            Self::Always => true,
            Self::Since(from) => from <= time,
            Self::Until(end) => time < end,
        }
    }
}

impl PartialEq for Term {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.law, other.law)
            && self.joint == other.joint
            && self.of == other.of
            && self.form == other.form
            && self.sizes == other.sizes
            && self.acts == other.acts
    }
}

impl Term {
    /// A term of a law that acts on one joint only.
    pub const fn on(law: &'static Law, joint: usize) -> Self {
        Self { law, joint: Some(joint), of: [joint, 0], form: 0, sizes: [0.0; 4], acts: Acts::Always }
    }

    /// A term of a law that may act on all joints, with the index of a joint, a link, a parameter or an axis.
    pub const fn about(law: &'static Law, about: usize) -> Self {
        Self { joint: None, ..Self::on(law, about) }
    }

    /// This term with another joint.
    pub const fn of(mut self, other: usize) -> Self {
        self.of[1] = other;
        self
    }

    /// This term in another form.
    pub const fn form(mut self, form: usize) -> Self {
        self.form = form;
        self
    }

    /// This term with its first sizes.
    pub fn sized<const N: usize>(mut self, sizes: [f64; N]) -> Self {
        self.sizes[..N].copy_from_slice(&sizes);
        self
    }

    /// This term with an onset (s).
    pub fn since(mut self, from: f64) -> Self {
        self.acts = Acts::Since(from);
        self
    }

    /// This term before a time (s), and not after it.
    pub fn until(mut self, end: f64) -> Self {
        self.acts = Acts::Until(end);
        self
    }

    /// This term at all times.
    pub fn always(mut self) -> Self {
        self.acts = Acts::Always;
        self
    }

    /// Whether it acts at all times.
    pub fn is_always(&self) -> bool {
        self.acts == Acts::Always
    }

    /// Its onset (s); `None` if it has none.
    pub fn onset(&self) -> Option<f64> {
        match self.acts {
            Acts::Since(from) => Some(from),
            Acts::Always | Acts::Until(_) => None,
        }
    }

    /// Whether it is of this law and always acts.
    pub fn is(&self, law: &'static Law) -> bool {
        self.is_always() && std::ptr::eq(self.law, law)
    }

    /// Whether it depends on the model along the motion, and not only on motion and torque.
    pub fn is_dynamic(&self) -> bool {
        self.law.needs_model
    }

    /// The one joint it acts on; `None` if it may act on all.
    pub fn joint(&self) -> Option<usize> {
        self.joint
    }

    /// The torque on `joint` at the ticks of a motion (N m or N); `None` if it has none there.
    pub fn column(&self, joint: usize, motion: &Signals<'_>) -> Option<Vec<f64>> {
        if self.joint.is_some_and(|only| only != joint) {
            return None;
        }
        let mut values = (self.law.column)(self, joint, motion)?;
        if !self.is_always() {
            let acts = |tick: usize| self.acts.at(motion.time(tick));
            let silent = (0..values.len()).filter(|&tick| !acts(tick));
            silent.for_each(|tick| values[tick] = 0.0);
        }
        Some(values)
    }

    /// This term with one size multiplied by `factor`.
    pub fn varied(&self, size: Size, factor: f64) -> Self {
        let mut term = *self;
        if let Some(varied) = self.law.varied {
            return varied(self, size, factor);
        }
        for &(_, place) in self.law.sizes.iter().filter(|(own, _)| *own == size) {
            term.sizes[place] *= factor;
        }
        term
    }
}
