//! Diagnoses of recordings that the tests make themselves, in one program, so that it is linked once.

mod agreement;
mod alike;
mod catalogue;
mod changed_drive;
mod changes;
mod constants;
mod direction;
mod drives;
mod filter;
mod friction;
mod gaps;
mod hidden;
mod hypothesis;
mod known;
mod loads;
mod many_recordings;
mod masses;
mod mounting;
mod next;
mod onsets;
mod rivals;
#[path = "../support/mod.rs"]
mod support;
mod thresholds;
mod torque_lag;
mod unnamed;
mod whole_arm;
