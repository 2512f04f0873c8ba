//! Physics concealed in recordings, the sealed truth about it, and what a diagnosis of them is worth.

mod answer;
mod calibration;
mod controls;
mod intervals;
mod outcome;
mod plain;
mod rules;
mod score;
mod seal;
mod sizes;
mod summary;
mod targets;
mod truth;

pub use answer::{Answer, Fit, Named, Number, Other, Refused, Unseen};
pub use calibration::{Bin, Calibration};
pub use controls::{HeldOut, WrongTerm, true_terms, wrong_term};
pub use intervals::{Counted, quantile, wilson};
pub use outcome::{FalseName, Fate, Outcome, OutsideOutcome};
pub use plain::Plain;
pub use rules::{LEAST_SHARE, Name};
pub use score::{Family, Score, Tried, score};
pub use seal::{Program, Seal, SealError, SealedCase, sha256, sha256_of};
pub use sizes::Sized;
pub use summary::{Curve, Errors, ParameterScore, SizeBin};
pub use targets::Target;
pub use truth::{Concealed, Truth};
