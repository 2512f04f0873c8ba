//! The search for the likeliest prior: a grid of starts on few samples, the best ones climbed from there, then more samples.

use super::LagrangianOptions;
use super::likelihood::{Objective, split};
use super::prior::LagrangianPrior;
use super::samples::TorqueSamples;
use crate::climb::climb;
use crate::conditioning::floor;
use crate::error::GpError;
use crate::starts::Bounds;

/// Torques the starts are tried and climbed on: 50 samples of six joints.
const FEW: usize = 300;

/// ŵ and û of the starts.
const SHARES: [f64; 2] = [0.5, 0.1];

/// Kinetic prior of the starts, as multiples of those that make each joint's torque.
const KINETIC: [f64; 2] = [1.0, 0.2];

/// Relative noises of the starts.
const NOISES: [f64; 3] = [1e-10, 1e-6, 1e-2];

/// Friction of the starts, as a part of each joint's torque.
const FRICTION: f64 = 0.1;

/// The widest range of a logarithm about its start.
const RANGE: f64 = 16.0;

/// Floors of ρ, in units of n ε: covariances are sums of hundreds of products, which round several times.
pub(crate) const FLOOR: f64 = 4.0;

/// The likeliest prior and relative noises.
pub(crate) fn search(
    samples: &TorqueSamples,
    scales: &[f64],
    units: &[f64],
    options: &LagrangianOptions,
) -> Result<(LagrangianPrior, Vec<f64>), GpError> {
    let dof = samples.dof();
    let few = samples.thinned(FEW.div_ceil(dof).max(8));
    let more = samples.thinned(options.search_samples);
    let least = FLOOR * floor(more.len().max(few.len()) * dof);
    let centre = start(samples, units, 0.5, 1.0);
    let prior = centre.to_free();
    let ranges = prior.iter().map(|middle| (middle - RANGE, middle + RANGE));
    let bounds = Bounds::of_logs(ranges.chain((0..dof).map(|_| (least.ln(), 1e2_f64.ln()))));
    let on_few = Objective::new(&few, scales, units, &bounds);
    let mut grid = Vec::new();
    for share in SHARES {
        for kinetic in KINETIC {
            for noise in NOISES {
                let mut at = start(samples, units, share, kinetic).to_free();
                at.extend((0..dof).map(|_| noise.max(2.0 * least).ln()));
                let free = bounds.free_from_log(&at);
                grid.push((on_few.value(&free), free));
            }
        }
    }
    // A stable sort: equal values keep the order of the grid.
    grid.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut best = (f64::NEG_INFINITY, grid[0].1.clone());
    for (_, free) in grid.iter().take(options.starts) {
        let found = climb(&on_few, free, options.max_iterations)?;
        if found.0 > best.0 {
            best = found;
        }
    }
    if more.len() > few.len() {
        let on_more = Objective::new(&more, scales, units, &bounds);
        best = climb(&on_more, &best.1, options.max_iterations)?;
    }
    if best.0 == f64::NEG_INFINITY {
        return Err(GpError::Likelihood("it is not finite at any start".to_owned()));
    }
    Ok(split(&bounds.log_from_free(&best.1), dof))
}

/// Energies that make torques of the size of each joint's `units` along the motions: of link i those of joint i.
fn start(samples: &TorqueSamples, units: &[f64], share: f64, kinetic: f64) -> LagrangianPrior {
    let dof = samples.dof();
    let size = |c: usize| samples.root_mean_square(2, c) + samples.root_mean_square(1, c).powi(2);
    let largest = (0..dof).map(size).fold(0.0, f64::max);
    let size = |c: usize| match size(c).max(1e-3 * largest) {
        size if size > 0.0 => size,
        _ => 1.0,
    };
    let speed = |c: usize| match samples.root_mean_square(1, c) {
        speed if speed > 0.0 => speed,
        _ => 1.0,
    };
    let sigma = |i: usize| (0..=i).map(move |c| kinetic * units[i] / size(c));
    LagrangianPrior {
        kinetic: (0..dof).flat_map(sigma).collect(),
        potential: units.iter().map(|unit| unit * unit).collect(),
        kinetic_share: vec![share; dof],
        potential_share: vec![share; dof],
        viscous: (0..dof).map(|c| (FRICTION * units[c] / speed(c)).powi(2)).collect(),
        coulomb: units.iter().map(|unit| (FRICTION * unit).powi(2)).collect(),
    }
}
