//! Tests of the whole, through the built program in a temporary folder.

mod inspect;
mod paper;
mod refusals;
mod runs;
mod support;
mod tidy;
