//! All thresholds that decide on names, in the order of the phases.
//!
//! A threshold without a source was selected on simulated cases with known ground truth. The number of iterations of a fit, guards
//! against rounding and the design of the filters do not decide on a name; they are beside their code. The physical limits of an effect
//! are in its file in `effects`. `docs/thresholds.md` lists all thresholds and is generated from these files.

mod data;
mod findings;
mod next;
mod regression;
mod search;
mod selection;
#[cfg(test)]
mod table;

pub use data::*;
pub use findings::*;
pub use next::*;
pub use regression::*;
pub use search::*;
pub use selection::*;

/// Defines [`Thresholds`] with its defaults, and its fields by name.
macro_rules! decisive {
    ($($(#[doc = $doc:literal])+ $name:ident: $value:literal,)+) => {
        /// The most decisive thresholds, which can be varied to see their influence.
        #[derive(Clone, Debug, PartialEq)]
        pub struct Thresholds {
            $($(#[doc = $doc])+ pub $name: f64,)+
        }

        impl Default for Thresholds {
            fn default() -> Self {
                Self { $($name: $value,)+ }
            }
        }

        impl Thresholds {
            /// The names of all of them, in the order of the phases.
            pub const NAMES: &[&str] = &[$(stringify!($name)),+];

            /// The threshold called `name`; `None` if there is none.
            pub fn named(&mut self, name: &str) -> Option<&mut f64> {
                match name {
                    $(stringify!($name) => Some(&mut self.$name),)+
                    _ => None,
                }
            }
        }
    };
}

decisive! {
    /// The residual that the best model may have, as a share of the standard deviation of the joint's torque.
    tolerance: 0.006,
    /// The evidence that each coefficient must bring (nats).
    per_coefficient: 2.5,
    /// The evidence that an onset must bring (nats), because it is searched at some hundred times.
    per_onset: 6.0,
    /// The standard deviation of the logarithm of a coefficient that should be one.
    unit_spread: 0.1,
    /// The part of its gain that an unmodelled form must keep on recordings that were left out.
    predicted: 0.05,
    /// The part of its gain that an unmodelled form must keep on held-out recordings.
    held_out: 0.2,
    /// The least share of a named effect in a joint's torque.
    least_share: 0.012,
    /// The evidence that a named effect must bring (nats).
    least_evidence: 20.0,
    /// The evidence that a named effect must bring beyond the simpler effect that it generalises (nats).
    least_beyond: 15.0,
    /// The part of a larger effect on the same joint that an effect must exceed: a smaller effect may be an error of the
    /// larger one's form.
    beside_a_larger: 0.1,
    /// The part of a larger effect of certain form on the same joint that an effect must exceed.
    beside_a_certain: 0.02,
    /// The least share of an unmodelled form in a joint's torque.
    least_unmodelled_share: 0.012,
    /// The evidence that an unmodelled form must bring (nats).
    least_unmodelled_evidence: 5.0,
    /// On a joint with unmodelled forms, the multiple of the largest of them that a named effect must exceed.
    beside_unmodelled: 1.5,
}
