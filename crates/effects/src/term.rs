//! The columns of the joint fit: a law with a joint and sizes. Each law stands in the file of the effect that it is of.

use std::fmt;

use arm::Arm;

use crate::compliance::Behind;
use crate::signals::Signals;

/// A size that a column is not linear in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// A velocity, a time, a limit, a stiffness, a gap.
    Main,
    /// The damping beside a stiffness.
    Damping,
    /// What the ends of a gap give.
    Stop,
    /// How long a contact lasts.
    Duration,
    /// The periods of a ripple.
    Periods,
    /// The exponent of a drag; a form rather than a size, it has no interval.
    Exponent,
}

/// What a law is to dry friction: at rest it may hold any torque within its cone.
#[derive(Clone, Copy)]
pub enum Cone {
    /// The column is none of it.
    No,
    /// So much of the cone for a coefficient of one, of the term, the load (N m or N) and the time (s).
    Level(fn(&Term, f64, f64) -> f64),
    /// It shifts the middle of the cone.
    Middle,
}

/// An arm with what a fit found in it, as far as columns are not linear in that.
pub struct Carried {
    /// The arm.
    pub arm: Arm,
    /// How far the joints stand beyond their encoders (rad or m).
    pub offset: Vec<f64>,
    /// Ten inertial parameters on the tool.
    pub payload: [f64; 10],
    /// The turn of the base about x and y (rad).
    pub tilt: [f64; 2],
    /// What gravity, seen from the base, is beyond the model's (m/s²).
    pub gravity: [f64; 3],
}

/// What makes a term's column on a joint of a motion.
pub type Column = fn(&Term, usize, &Signals<'_>) -> Option<Vec<f64>>;

/// What makes another form of a term at a factor on its size, and whether it is another at all.
pub type OtherForm = fn(&Term, f64) -> (Term, bool);

/// One law: what a column is.
pub struct Law {
    /// Its name, for debugging.
    pub name: &'static str,
    /// The torque of a term on a joint (N m or N) for a coefficient of one; `None` if it has none there.
    pub column: Column,
    /// Whether it depends on the model along the motion, not on the motion and the torque alone.
    pub needs_model: bool,
    /// Whether the model's derivatives by position and velocity are needed.
    pub needs_derivatives: bool,
    /// What its sizes are, by their places in a term.
    pub sizes: &'static [(Size, usize)],
    /// A term with a size times a factor, where that is more than a product.
    pub varied: Option<fn(&Term, Size, f64) -> Term>,
    /// The other form that it may have, at a factor on its size; whether that is another one at all.
    pub other_form: Option<OtherForm>,
    /// Finer steps about what its sizes are, in turn.
    pub nudges: &'static [fn(&Term, f64) -> Term],
    /// Terms with compliant ends of the gap, for a link of an inertia (kg m² or kg).
    pub softened: fn(&Term, f64) -> Vec<Term>,
    /// Whether a term's sizes make sense.
    pub is_sound: fn(&Term) -> bool,
    /// What it is to dry friction.
    pub cone: Cone,
    /// The link's motion behind a joint that gives, simulated once for all joints.
    pub behind: Option<fn(&Term, &Signals<'_>) -> Behind>,
    /// Puts what a fit found into the arm about which columns are formed.
    pub carry: Option<fn(&Term, f64, &mut Carried)>,
    /// Whether it is made of the measured torque: a motion on paper has that only once it is known.
    pub is_of_torque: bool,
    /// Whether it cuts the torque, so that a motion on paper within the limit has nothing of it.
    pub cuts: bool,
}

impl Law {
    /// A law of nothing but a column, for the rest of a struct.
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
        behind: None,
        carry: None,
        is_of_torque: false,
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
    /// The joints, the link, the parameter or the axis that it is about.
    pub of: [usize; 2],
    /// Which of the law's forms.
    pub form: usize,
    /// Its sizes.
    pub sizes: [f64; 4],
    /// From when on it acts (s, on the recordings' own clock); `None`: always.
    pub from: Option<f64>,
}

impl PartialEq for Term {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.law, other.law)
            && self.joint == other.joint
            && self.of == other.of
            && self.form == other.form
            && self.sizes == other.sizes
            && self.from == other.from
    }
}

impl Term {
    /// A law that acts on one joint alone.
    pub const fn on(law: &'static Law, joint: usize) -> Self {
        Self {
            law,
            joint: Some(joint),
            of: [joint, 0],
            form: 0,
            sizes: [0.0; 4],
            from: None,
        }
    }

    /// A law that may act on all joints, about one of them, a link, a parameter or an axis.
    pub const fn about(law: &'static Law, about: usize) -> Self {
        Self {
            joint: None,
            ..Self::on(law, about)
        }
    }

    /// This term with another joint in it.
    pub const fn of(mut self, other: usize) -> Self {
        self.of[1] = other;
        self
    }

    /// This term in one of its forms.
    pub const fn form(mut self, form: usize) -> Self {
        self.form = form;
        self
    }

    /// This term with its first sizes.
    pub fn sized<const N: usize>(mut self, sizes: [f64; N]) -> Self {
        self.sizes[..N].copy_from_slice(&sizes);
        self
    }

    /// This term from a time on (s).
    pub fn since(mut self, from: f64) -> Self {
        self.from = Some(from);
        self
    }

    /// This term without an onset.
    pub fn always(mut self) -> Self {
        self.from = None;
        self
    }

    /// When it sets in (s); `None` if it always acts.
    pub fn onset(&self) -> Option<f64> {
        self.from
    }

    /// Whether it is of this law and always acts.
    pub fn is(&self, law: &'static Law) -> bool {
        self.from.is_none() && std::ptr::eq(self.law, law)
    }

    /// Whether it depends on the model along the motion, not on the motion and the torque alone.
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
        if let Some(from) = self.from {
            let before = |tick: &usize| motion.time(*tick) < from;
            (0..values.len()).take_while(before).for_each(|tick| values[tick] = 0.0);
        }
        Some(values)
    }

    /// This term with one size multiplied by `factor`.
    pub fn varied(&self, size: Size, factor: f64) -> Self {
        let mut term = *self;
        if self.from.is_some() {
            return term;
        }
        if let Some(varied) = self.law.varied {
            return varied(self, size, factor);
        }
        for &(_, place) in self.law.sizes.iter().filter(|(own, _)| *own == size) {
            term.sizes[place] *= factor;
        }
        term
    }
}
