//! Candidates that may explain a residual: effects of the catalogue and unmodelled forms, each with its columns.

use effects::arm::contact_window;
use effects::{Grounds, Kind, Spec, Term};

use crate::regression::table::Table;
use crate::thresholds::Thresholds;

/// A kind of hypothesis, with the other joint on whose motion it depends; those of the catalogue come first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Hypothesis {
    /// The effect, or the unmodelled form.
    pub kind: Kind,
    /// The other joint, if it depends on one.
    pub other: Option<usize>,
}

impl Hypothesis {
    /// A hypothesis that depends on no other joint.
    pub fn of(kind: &'static Spec) -> Self {
        Self { kind: Kind::of(kind), other: None }
    }

    /// Whether it is of this kind.
    pub fn is(self, kind: &'static Spec) -> bool {
        self.kind.is(kind)
    }

    /// Its [`Spec`]: what is known before any recording.
    pub fn spec(self) -> &'static Spec {
        self.kind.spec()
    }

    /// The name in the catalogue; `None` for an unmodelled form.
    pub fn name(self) -> Option<&'static str> {
        self.kind.name()
    }

    /// Whether it is the inertia of the drive's rotor.
    pub fn is_drive_inertia(self) -> bool {
        self.spec().is_baseline && !self.spec().is_friction
    }

    /// Whether it is Coulomb or viscous friction, which most joints have.
    pub fn is_plain_friction(self) -> bool {
        self.spec().is_baseline && self.spec().is_friction
    }

    /// Whether it is `other` or contains it: friction of another form, such as Stribeck friction, contains a level of Coulomb friction.
    pub fn contains(self, other: Self) -> bool {
        self == other || self.generalises() == Some(other)
    }

    /// The simpler hypothesis that it generalises.
    pub fn generalises(self) -> Option<Self> {
        let kind = Kind::named(self.spec().generalises?)?;
        Some(Self { kind, other: None })
    }
}

/// Columns that are added and removed together.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Its hypothesis.
    pub hypothesis: Hypothesis,
    /// The joint; `None` for the whole arm.
    pub joint: Option<usize>,
    /// Its columns, as indices into the table.
    pub columns: Vec<usize>,
    /// The evidence it must bring (nats).
    pub cost: f64,
    /// Whether it is a trial size during refinement.
    pub is_trial: bool,
}

impl Candidate {
    /// A candidate with the usual evidence required.
    pub fn new(hypothesis: Hypothesis, joint: Option<usize>, columns: Vec<usize>, thresholds: &Thresholds) -> Self {
        let cost = hypothesis.spec().prior + thresholds.per_coefficient * columns.len() as f64;
        Self { hypothesis, joint, columns, cost, is_trial: false }
    }

    /// The terms of its columns.
    pub fn terms(&self, table: &Table) -> Vec<Term> {
        self.columns.iter().map(|&column| table.terms[column]).collect()
    }

    /// The start and the end of its contact (s), if it is one.
    pub fn window(&self, table: &Table) -> Option<[f64; 2]> {
        contact_window(&table.terms[*self.columns.first()?])
    }
}

/// The candidates known from the beginning, with the terms of their columns, in the order of their turns.
pub fn catalogue(grounds: &Grounds<'_>) -> Vec<(Hypothesis, Option<usize>, Vec<Term>)> {
    let of = |kind: Kind| (kind.spec().forms)(grounds).into_iter().map(move |form| (kind, form));
    let mut forms: Vec<_> = Kind::all().flat_map(of).collect();
    forms.sort_by_key(|(_, form)| form.turn.key(form.joint, form.other));
    let candidate = |(kind, form): (Kind, effects::Form)| {
        let other = form.other;
        (Hypothesis { kind, other }, form.joint, form.terms)
    };
    forms.into_iter().map(candidate).collect()
}
