//! Gaussian-process regression with the squared-exponential kernel, exact, also where the kernel matrix is nearly singular.
//!
//! ```
//! use gp::{FitOptions, Gp, TrainingSet, Workspace};
//!
//! let inputs: Vec<f64> = (0..40).map(|i| 0.1 * f64::from(i)).collect();
//! let targets: Vec<f64> = inputs.iter().map(|x| x.sin()).collect();
//! let training = TrainingSet::new(1, &inputs, &targets)?;
//! let gp = Gp::fit(&training, &FitOptions::default())?;
//! assert!((gp.mean(&[1.234]) - 1.234_f64.sin()).abs() < 1e-4);
//! let (_, variance) = gp.mean_and_variance(&[50.0], &mut Workspace::default());
//! assert!(variance > 0.1);
//! println!("{}", gp.conditioning());
//! # Ok::<(), gp::GpError>(())
//! ```
//!
//! The kernel matrix of smooth, noise-free data has a numerical rank r far below its size n. A pivoted Cholesky
//! factorisation finds that rank; everything else then costs n r² operations instead of n³, and a mean r kernel values
//! instead of n. The result is exact: the factorisation stops only where the remaining part is negligible compared
//! with the noise, or with rounding. If r is not far below n, the matrix is factored in full.
//!
//! With [`FitOptions::inducing`], the factorisation stops at a given rank, because noisy data have no low rank. This
//! is an approximation whose likelihood is a lower bound of the exact one; [`Conditioning`] contains its largest
//! possible error.
//!
//! [`LagrangianGp`] is a regression of another kind: of the torques of all joints of an arm at once, by Gaussian processes of its
//! energies.

// Only the command line prints.
#![warn(clippy::print_stderr, clippy::print_stdout)]

mod algebra;
mod climb;
mod conditioning;
mod data;
mod dense;
mod descent;
mod error;
mod evaluation;
mod file;
mod kernel;
mod lagrangian;
mod likelihood;
mod line;
mod low_rank;
mod model;
mod options;
mod pivoted;
mod posterior;
mod range;
mod search;
mod starts;
mod wide;

pub use conditioning::Conditioning;
pub use data::{Hyperparameters, Lengths, TrainingSet};
pub use descent::Descent;
pub use error::GpError;
pub use lagrangian::{
    JointType, LagrangianConditioning, LagrangianGp, LagrangianOptions, LagrangianPrior, LagrangianRange,
    LagrangianWorkspace, TorqueSamples,
};
pub use model::{Gp, Workspace};
pub use options::{FitOptions, LengthScales};
pub use range::Range;
pub use wide::{Wide, on_widest, release_vectors};
