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
    /// The residual that the best model may have, as a share of the standard deviation of the joint's torque. Source:
    /// its form from a prototype in Python, where it was 0.01: beside correlated residuals, the BIC alone accepts effects that only
    /// fit the residual, and a floor prevents that; the value from the first diagnosis.
    tolerance: 0.006,
    /// The evidence that each coefficient must bring (nats). Source: first diagnosis; the BIC (Schwarz 1978) has ½ ln
    /// N, which is 2.5 for 148 independent samples.
    per_coefficient: 2.5,
    /// The evidence that an onset must bring (nats), because it is searched at some hundred times. Source: the
    /// logarithm of these times (ln 400 is 6.0); selected on `prove`, seeds 7 and 2026.
    per_onset: 6.0,
    /// The standard deviation of the logarithm of a coefficient that should be one. Source: first diagnosis.
    unit_spread: 0.1,
    /// The part of its gain that an unmodelled form must keep on recordings that were left out. Source: first
    /// diagnosis.
    predicted: 0.05,
    /// The part of its gain that an unmodelled form must keep on held-out recordings. Source: first diagnosis.
    held_out: 0.2,
    /// The least share of a named effect in a joint's torque. Source: first diagnosis; no effect of the open cases is
    /// below 0.015.
    least_share: 0.012,
    /// The evidence that a named effect must bring (nats). Source: 25 in the first diagnosis; 20 since the version that
    /// was developed on 48 simulated cases of 19 arms made with MuJoCo, with URDFs exact or wrong by 3 to 30 %.
    least_evidence: 20.0,
    /// The evidence that a named effect must bring beyond the simpler effect that it generalises (nats). Source: first
    /// diagnosis.
    least_beyond: 15.0,
    /// The part of a larger effect on the same joint that an effect must exceed: a smaller effect may be an error of
    /// the larger one's form. Source: first diagnosis.
    beside_a_larger: 0.1,
    /// The part of a larger effect of certain form on the same joint that an effect must exceed; a share above one counts as one. Source:
    /// a ripple of 22 % of the torque beside a tilted base, which 0.05 excluded; an offset of 9 % beside a scale of all inertias with a
    /// share of 4.6.
    beside_a_certain: 0.02,
    /// The least share of an unmodelled form in a joint's torque. Source: first diagnosis.
    least_unmodelled_share: 0.012,
    /// The evidence that an unmodelled form must bring (nats). Source: first diagnosis.
    least_unmodelled_evidence: 5.0,
    /// On a joint with unmodelled forms, the multiple of the largest of them that a named effect must exceed. Source:
    /// first diagnosis.
    beside_unmodelled: 1.5,
}
