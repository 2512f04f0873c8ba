//! What may explain a residual: the catalogue's effects, and forms that have no name, each with its columns.

use effects::{EffectKind, Grounds, Kind, Spec, Term};

use crate::thresholds::Thresholds;

/// A kind of hypothesis, with the other joint whose motion it depends on; the catalogue's come first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Hypothesis {
    /// The effect, or the form without a name.
    pub kind: Kind,
    /// The other joint, of what depends on one.
    pub other: Option<usize>,
}

impl Hypothesis {
    /// A hypothesis that depends on no other joint.
    pub fn of(kind: &'static dyn EffectKind) -> Self {
        Self {
            kind: Kind::of(kind),
            other: None,
        }
    }

    /// Whether it is of this kind.
    pub fn is(self, kind: &'static dyn EffectKind) -> bool {
        self.kind.is(kind)
    }

    /// What is known of it before any recording.
    pub fn spec(self) -> &'static Spec {
        self.kind.spec()
    }

    /// The catalogue's name; `None` for what has none.
    pub fn name(self) -> Option<&'static str> {
        self.kind.name()
    }

    /// Whether its coefficient must be one: it is simulated at its size, not scaled.
    pub fn is_unit(self) -> bool {
        self.spec().is_simulated
    }

    /// Whether it is the friction that every drive has.
    pub fn is_friction(self) -> bool {
        self.spec().is_friction
    }

    /// Whether it is the inertia that every drive has.
    pub fn is_drive_inertia(self) -> bool {
        self.is_baseline() && !self.is_friction()
    }

    /// Whether a URDF usually omits it: friction and the drives' inertia need less evidence.
    pub fn is_baseline(self) -> bool {
        self.spec().is_baseline
    }

    /// Whether it is baseline, or a constant beside that.
    pub fn is_simple(self) -> bool {
        self.spec().is_simple
    }

    /// Whether it says that masses are not the model's.
    pub fn is_wrong_mass(self) -> bool {
        self.spec().is_wrong_mass
    }

    /// The simpler hypothesis that it is a form of.
    pub fn plain(self) -> Option<Self> {
        let kind = Kind::named(self.spec().plain?)?;
        Some(Self { kind, other: None })
    }

    /// Whether there is but one form that it can have: it follows from rigid-body dynamics.
    pub fn is_certain_in_form(self) -> bool {
        self.spec().is_certain_in_form
    }

    /// Whether it may be there in one recording alone.
    pub fn is_passing(self) -> bool {
        self.spec().is_passing
    }
}

/// Some columns that come and go together.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// What it would be.
    pub hypothesis: Hypothesis,
    /// Where; `None` is the whole arm.
    pub joint: Option<usize>,
    /// Its columns, as indices into the table.
    pub columns: Vec<usize>,
    /// The evidence it must bring (nats).
    pub cost: f64,
    /// Whether it is a size tried in refining another.
    pub is_trial: bool,
}

impl Candidate {
    /// A candidate with the usual cost.
    pub fn new(hypothesis: Hypothesis, joint: Option<usize>, columns: Vec<usize>, thresholds: &Thresholds) -> Self {
        let cost = hypothesis.spec().prior + thresholds.per_coefficient * columns.len() as f64;
        Self {
            hypothesis,
            joint,
            columns,
            cost,
            is_trial: false,
        }
    }
}

/// The candidates known from the outset, with the terms of their columns, in the order of their turns.
pub fn catalogue(grounds: &Grounds<'_>) -> Vec<(Hypothesis, Option<usize>, Vec<Term>)> {
    let of = |kind: Kind| kind.get().forms(grounds).into_iter().map(move |form| (kind, form));
    let mut forms: Vec<_> = Kind::all().flat_map(of).collect();
    forms.sort_by_key(|(_, form)| form.turn.key(form.joint, form.other));
    let candidate = |(kind, form): (Kind, effects::Form)| {
        let other = form.other;
        (Hypothesis { kind, other }, form.joint, form.terms)
    };
    forms.into_iter().map(candidate).collect()
}
