//! Kinds of effects: those of the catalogue by name and in its order, then the unmodelled forms.

use std::sync::LazyLock;

use crate::spec::{Effect, Spec};
use crate::{CATALOGUE, UNMODELLED};

/// The names of the catalogue, in its order.
pub static NAMES: LazyLock<Vec<&'static str>> = LazyLock::new(|| CATALOGUE.iter().map(|spec| spec.name).collect());

/// The spec of the effect `name`; `None` if the catalogue has no such effect.
pub fn spec(name: &str) -> Option<&'static Spec> {
    Kind::named(name).map(Kind::spec)
}

/// The experiment that distinguishes two effects of the catalogue, if there is one for this pair.
pub fn experiment_against(one: &str, other: &str) -> Option<&'static str> {
    let of = |this: &str, other: &str| {
        let all = spec(this)?.experiments_against;
        all.iter().find(|(name, _)| *name == other).map(|(_, text)| *text)
    };
    of(one, other).or_else(|| of(other, one))
}

/// A kind of effect, named or unmodelled: its place in the catalogue, by which kinds are ordered. The unmodelled forms follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Kind(usize);

impl Kind {
    /// A spec as a kind.
    ///
    /// # Panics
    /// If neither [`CATALOGUE`] nor [`UNMODELLED`] contains it.
    pub fn of(spec: &'static Spec) -> Self {
        let kind = Self::all().find(|kind| kind.is(spec));
        kind.expect("every kind is in CATALOGUE or in UNMODELLED")
    }

    /// The kind with this name.
    pub fn named(name: &str) -> Option<Self> {
        CATALOGUE.iter().position(|spec| spec.name == name).map(Self)
    }

    /// All kinds, those of the catalogue first.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..CATALOGUE.len() + UNMODELLED.len()).map(Self)
    }

    /// Everything that is known of it.
    pub fn spec(self) -> &'static Spec {
        CATALOGUE.get(self.0).unwrap_or_else(|| &UNMODELLED[self.0 - CATALOGUE.len()])
    }

    /// The name in the catalogue; `None` for an unmodelled form.
    pub fn name(self) -> Option<&'static str> {
        (self.0 < CATALOGUE.len()).then(|| self.spec().name)
    }

    /// Whether it is this kind.
    pub fn is(self, spec: &'static Spec) -> bool {
        std::ptr::eq(self.spec(), spec)
    }
}

impl Effect {
    /// Its kind.
    pub fn kind(&self) -> Kind {
        Kind::of(self.spec())
    }
}
