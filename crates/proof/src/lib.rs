//! Physics concealed in recordings, the sealed truth about it, and what a diagnosis of them is worth.
//!
//! A [`Robot`] is what its user believes. A [`Campaign`] decides which cases there are; [`conceal_case`] draws one, [`conceal_effects`]
//! takes what it is given: either drives the plant in a 1 kHz position loop with physics in it that the URDF leaves out, records what
//! encoders and drives report, and keeps the [`Truth`]. [`write_case`] puts the two in different places.

mod again;
mod answer;
mod calibration;
mod campaign;
mod case;
mod conceal;
mod controls;
mod draw;
mod error;
mod experiment;
mod intervals;
mod law;
mod machine;
mod motion;
mod outcome;
mod physics;
mod plain;
mod published;
mod robot;
mod rules;
mod score;
mod seal;
mod sensor;
mod share;
mod sizes;
mod summary;
mod targets;
#[cfg(test)]
mod test_robots;
mod tracking;
mod truth;

pub use again::record_again;
pub use answer::{Answer, Fit, Left, Named, Next, Number, Other, Refused, Rollout, Told, Unseen};
pub use calibration::{Bin, Calibration};
pub use campaign::{Campaign, CasePlan};
pub use case::write_case;
pub use conceal::{Concealment, RATES, Settings, conceal_case, conceal_effects};
pub use controls::{HeldOut, WrongTerm, true_terms, wrong_term};
pub use draw::FAMILIES;
pub use error::ProofError;
pub use experiment::{After, Again, Confusion, Experiments, InCase};
pub use intervals::{Counted, quantile, wilson};
pub use machine::{Inverse, LinkMotion, Seen, VelocityFilter};
pub use motion::{DURATION, PAUSE};
pub use outcome::{FalseName, Fate, Outcome, OutsideOutcome};
pub use physics::{EFFECTS, UNKNOWN, form_parameters, forms};
pub use plain::Plain;
pub use published::{
    Besides, Compared, Denied, Evidence, HeldOutErrors, Published, PublishedNumber, RobotScore, Said, SaidFate,
    SaidOutcome, compared_parameters,
};
pub use robot::Robot;
pub use rules::{LEAST_SHARE, Name};
pub use score::{Family, Score, Tried, score};
pub use seal::{Program, Seal, SealError, SealedCase, sha256, sha256_of};
pub use sizes::Sized;
pub use summary::{Curve, Errors, ParameterScore, SizeBin};
pub use targets::Target;
pub use tracking::{CaseMachine, Driven};
pub use truth::{Concealed, Truth};
