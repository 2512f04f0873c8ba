//! Kinds of effects: those of the catalogue by name and in its order, then the unmodelled forms.

use std::cmp::Ordering;
use std::hash::{Hash, Hasher};
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

/// A kind of effect, named or unmodelled; kinds are ordered as in the catalogue.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    index: usize,
    spec: &'static Spec,
}

impl Kind {
    /// A spec as a kind.
    ///
    /// # Panics
    /// If neither [`CATALOGUE`] nor [`UNMODELLED`] contains it.
    pub fn of(spec: &'static Spec) -> Self {
        let kind = Self::all().find(|kind| kind.is(spec));
        kind.expect("every kind is in CATALOGUE or in UNMODELLED")
    }

    fn at(index: usize) -> Self {
        let spec = CATALOGUE.get(index).unwrap_or_else(|| &UNMODELLED[index - CATALOGUE.len()]);
        Self { index, spec }
    }

    /// The kind with this name.
    pub fn named(name: &str) -> Option<Self> {
        CATALOGUE.iter().position(|spec| spec.name == name).map(Self::at)
    }

    /// All kinds, those of the catalogue first.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..CATALOGUE.len() + UNMODELLED.len()).map(Self::at)
    }

    /// Everything that is known of it.
    pub fn spec(self) -> &'static Spec {
        self.spec
    }

    /// The name in the catalogue; `None` for an unmodelled form.
    pub fn name(self) -> Option<&'static str> {
        (self.index < CATALOGUE.len()).then(|| self.spec().name)
    }

    /// Whether it is this kind.
    pub fn is(self, spec: &'static Spec) -> bool {
        std::ptr::eq(self.spec, spec)
    }
}

impl Effect {
    /// Its kind.
    pub fn kind(&self) -> Kind {
        Kind::of(self.spec())
    }
}

impl PartialEq for Kind {
    fn eq(&self, other: &Self) -> bool {
        self.index == other.index
    }
}

impl Eq for Kind {}

impl PartialOrd for Kind {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Kind {
    fn cmp(&self, other: &Self) -> Ordering {
        self.index.cmp(&other.index)
    }
}

impl Hash for Kind {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.index.hash(state);
    }
}
