//! The true arm as a rapier multibody, driven by joint torques.
//!
//! rapier's accelerations equal those of the analytic forward dynamics ([`arm::Arm::forward_dynamics`]) to 6e-15, but
//! its integration step is of first order: at 1 ms its error would be visible beside that of a good model. Therefore a
//! [`Plant`] extrapolates: it runs a step as 1, 2, … k rapier steps from the same state and combines the results so
//! that the leading errors cancel (Aitken-Neville). Errors on the PUMA 560 at 1 ms, relative to Runge-Kutta
//! integration of the analytic dynamics:
//!
//! | order k | 1 s of free motion (rad) | with 0.5 kg m² rotors (rad) | 10 s of computed torque, model +20 % (rad) | stick and slip with rotors, 2 s (rad) | one step (µs) |
//! |---|---|---|---|---|---|
//! | 1 (plain) | 9.8e-2 | 3.5e-3 | 3.5e-4 | 1e-3 | 6 |
//! | 2 | 1.0e-3 | 5.6e-6 | 1.3e-6 | 6e-7 | 16 |
//! | 3 | 2.7e-7 | 9.7e-9 | 7.0e-10 | 5e-10 | 30 |
//! | 4 | 7.7e-9 | 7.9e-12 | 8.2e-13 | 2e-13 | 48 |
//!
//! In the third column, the error of the model itself costs 5e-2 rad. Energy drifts by 9e-6 J of 68 J in 10 s of free
//! motion at order 3. Dry friction is not smooth, so that a step is divided where a joint stops or breaks away: each
//! such event costs about five trial steps, and each step with a stuck joint two additional rapier steps.
//!
//! There are no contacts and no joint limits. The same inputs give bit-identical results.
//!
//! ```
//! use arm::Arm;
//! use plant::{Plant, PlantOptions};
//!
//! let arm = Arm::from_urdf("../../assets/puma560.urdf")?;
//! let mut plant = Plant::new(&arm, &PlantOptions::default())?;
//! plant.set_state(&[0.0, -1.0, 1.0, 0.0, 0.5, 0.0], &[0.0; 6])?;
//! for _ in 0..100 {
//!     plant.step(&[0.0; 6])?;
//! }
//! assert!((plant.time() - 0.1).abs() < 1e-9 && plant.qd()[1] != 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

// Only the command line prints.
#![warn(clippy::print_stderr, clippy::print_stdout)]

mod bodies;
mod complementarity;
mod engine;
mod error;
mod friction;
mod options;
mod plant;

pub use error::PlantError;
pub use options::{LARGEST_ORDER, PlantOptions};
pub use plant::Plant;

#[cfg(test)]
mod test_arms;
#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
