//! Physics concealed in recordings, the sealed truth about it, and what a diagnosis of them is worth.

mod truth;

pub use truth::{Concealed, Truth};
