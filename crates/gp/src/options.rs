//! Options of a fit.

/// The number of length scales that a fit chooses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LengthScales {
    /// One length for all inputs.
    #[default]
    Isotropic,
    /// One length per input.
    PerInput,
}

/// Options of a fit.
#[derive(Clone, Debug, PartialEq)]
pub struct FitOptions {
    /// Whether all inputs share one length scale, or each input has its own.
    pub lengths: LengthScales,
    /// The least noise variance as a share of amplitude². It is never below n ε for n samples, which is the least with the default
    /// of 0.
    pub min_relative_noise: f64,
    /// The number of starts of the search, at least 1: the best distinct points of a fixed grid.
    pub starts: usize,
    /// The largest number of L-BFGS iterations from each start. It is not used for one length scale without noise.
    pub max_iterations: u64,
    /// The largest number of inducing points, or `None` for an exact posterior. More samples than this are approximated by inducing
    /// points, which are selected one after the other where the remaining variance is largest (variational free energy, Titsias
    /// 2009; selection by Burt, Rasmussen and van der Wilk 2020). The cost is n m² in place of n³. [`Gp::conditioning`](crate::Gp::conditioning)
    /// returns the variance that the points leave out.
    pub inducing: Option<usize>,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self {
            lengths: LengthScales::Isotropic,
            min_relative_noise: 0.0,
            starts: 4,
            max_iterations: 100,
            inducing: None,
        }
    }
}
