//! The catalogue of the effects that a rigid model omits: one file per effect, one line in [`CATALOGUE`].
//!
//! A file holds all that the program knows of an effect, behind the trait [`EffectKind`]: its [`Spec`] (name, parameters,
//! relations, words), the forms to try, the law of its columns, what physics allows, how its parameters are read from an
//! estimate, and how it is put into a [`Machine`]. The fit of a diagnosis and the feed-forward of a corrected model come
//! from the same file. [`spec`] gives what is known of a name.

pub mod arm;
mod catalogue;
mod compliance;
pub mod drive;
mod effect;
mod error;
mod estimate;
mod fitted;
mod form;
pub mod friction;
pub mod joint;
mod kind;
pub mod laws;
mod machine;
mod motion;
mod quantity;
pub mod sensor;
mod spec;
mod term;
#[cfg(test)]
mod test_support;
pub mod unmodelled;

pub use catalogue::{CATALOGUE, Kind, NAMES, UNMODELLED, spec};
pub use compliance::Behind;
pub use effect::{Effect, Value};
pub use error::EffectError;
pub use estimate::{Estimate, Systematic};
pub use fitted::{Fitted, UNIT};
pub use form::{Form, Grounds, SetsIn, Times, Turn};
pub use kind::{EffectKind, check};
pub use machine::{Circumstance, Contact, Dry, Machine, Place, Scaled, Smooth, Sprung, State, sign};
pub use motion::{Motion, Rigid, Scales};
pub use quantity::Quantity;
pub use spec::{Against, Experiment, InUrdf, ONSET, Parameter, Range, Scope, Shape, Spec, Unseen};
pub use term::{Carried, Column, Cone, Law, OtherForm, Size, Term};
