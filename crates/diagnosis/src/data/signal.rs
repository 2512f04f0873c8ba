//! One low-pass kernel for all signals, and its derivatives.

use std::f64::consts::PI;

use crate::lanes::dots_with;

/// The reach of the kernel to either side, in widths.
const REACH: f64 = 5.0;
/// The half-power frequency times the width: (1 + u) e^(−u) = 1/√2 at u = (2π f σ)² / 2.
const HALF_POWER: f64 = 1.4683 / (2.0 * PI);

/// The zero-phase low-pass K(x) = φ(x) (3 − x²) / 2, φ the standard normal density, of some width, and its first
/// two derivatives, sampled.
///
/// A kernel of fourth order: polynomials up to the third degree pass unchanged (Gasser and Müller 1979). Since the
/// derivatives are those of the *same* kernel, q, q̇, q̈ and τ are filtered alike.
#[derive(Clone, Debug)]
pub struct Kernel {
    /// Weights at −reach … reach.
    smooth: Vec<f64>,
    first: Vec<f64>,
    second: Vec<f64>,
    width: f64,
}

impl Kernel {
    /// The kernel with half its power at `cutoff` (Hz) for samples `period` (s) apart.
    pub fn new(cutoff: f64, period: f64) -> Self {
        let width = HALF_POWER / cutoff;
        let scale = width / period;
        let reach = (REACH * scale).ceil().max(2.0) as i64;
        let x: Vec<f64> = (-reach..=reach).map(|tick| tick as f64 / scale).collect();
        let density = |x: f64| (-0.5 * x * x).exp() / (2.0 * PI).sqrt();
        let mut smooth: Vec<f64> = x.iter().map(|&x| density(x) * (3.0 - x * x) / 2.0).collect();
        // Convolution reverses the kernel: the weights at +x are those of the derivative at −x.
        let mut first: Vec<f64> = x.iter().map(|&x| -density(x) * (x * x * x - 5.0 * x) / 2.0).collect();
        let mut second: Vec<f64> = x.iter().map(|&x| density(x) * (-x.powi(4) + 8.0 * x * x - 5.0) / 2.0).collect();
        // Makes the moments exact on the samples: 1 → 1, t → 1, t² / 2 → 1, and constants → 0.
        let time: Vec<f64> = (-reach..=reach).map(|tick| tick as f64 * period).collect();
        let moment =
            |weights: &[f64], power: i32| -> f64 { weights.iter().zip(&time).map(|(w, t)| w * t.powi(power)).sum() };
        let unit = moment(&smooth, 0);
        smooth.iter_mut().for_each(|w| *w /= unit);
        let slope = moment(&first, 1);
        first.iter_mut().for_each(|w| *w /= slope);
        let level = moment(&second, 0);
        for (w, s) in second.iter_mut().zip(&smooth) {
            *w -= level * s;
        }
        let curvature = moment(&second, 2) / 2.0;
        second.iter_mut().for_each(|w| *w /= curvature);
        Self { smooth, first, second, width }
    }

    /// The number of samples on either side that a filtered sample needs.
    pub fn reach(&self) -> usize {
        self.smooth.len() / 2
    }

    /// The width σ (s).
    pub fn width(&self) -> f64 {
        self.width
    }

    /// The smoothed signal at every `stride`-th sample, from the first one with all its neighbours.
    pub fn smooth(&self, signal: &[f64], stride: usize) -> Vec<f64> {
        apply(&self.smooth, signal, stride)
    }

    /// The first derivative of the smoothed signal (1/s), at the same samples.
    pub fn first(&self, signal: &[f64], stride: usize) -> Vec<f64> {
        apply(&self.first, signal, stride)
    }

    /// The second derivative of the smoothed signal (1/s²), at the same samples.
    pub fn second(&self, signal: &[f64], stride: usize) -> Vec<f64> {
        apply(&self.second, signal, stride)
    }

    /// The root mean square of the smoothed signal and of its second derivative, for white noise of unit strength.
    pub fn noise_gains(&self) -> (f64, f64) {
        let norm = |weights: &[f64]| weights.iter().map(|w| w * w).sum::<f64>().sqrt();
        (norm(&self.smooth), norm(&self.second))
    }

    /// The root mean square of the first derivative of the smoothed signal, for white noise of unit strength.
    pub fn first_noise_gain(&self) -> f64 {
        self.first.iter().map(|w| w * w).sum::<f64>().sqrt()
    }

    /// The gain for a sinusoid of `omega` (rad/s).
    pub fn gain(&self, omega: f64) -> f64 {
        let u = 0.5 * (omega * self.width).powi(2);
        (1.0 + u) * (-u).exp()
    }
}

/// The number of outputs that [`Kernel`]s give for `samples` inputs.
pub fn outputs(samples: usize, reach: usize, stride: usize) -> usize {
    if samples <= 2 * reach { 0 } else { (samples - 2 * reach - 1) / stride + 1 }
}

fn apply(weights: &[f64], signal: &[f64], stride: usize) -> Vec<f64> {
    let window = |k: usize| &signal[k * stride..k * stride + weights.len()];
    let count = outputs(signal.len(), weights.len() / 2, stride);
    let windows: Vec<&[f64]> = (0..count).map(window).collect();
    dots_with(weights, &windows)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cubic and its derivatives pass unchanged.
    #[test]
    fn cubics_pass() {
        for cutoff in [4.0, 10.0, 23.0] {
            let kernel = Kernel::new(cutoff, 0.01);
            let at = |k: usize| k as f64 * 0.01;
            let f = |t: f64| 1.0 - 2.0 * t + 3.0 * t * t - 4.0 * t * t * t;
            let signal: Vec<f64> = (0..200).map(|k| f(at(k))).collect();
            let (smooth, first, second) =
                (kernel.smooth(&signal, 3), kernel.first(&signal, 3), kernel.second(&signal, 3));
            for k in 0..smooth.len() {
                let t = at(3 * k + kernel.reach());
                assert!((smooth[k] - f(t)).abs() < 2e-3, "{cutoff} Hz: {} {}", smooth[k], f(t));
                let slope = -2.0 + 6.0 * t - 12.0 * t * t;
                assert!((first[k] - slope).abs() < 5e-2, "{cutoff} Hz: {} {slope}", first[k]);
                let curvature = 6.0 - 24.0 * t;
                assert!((second[k] - curvature).abs() < 0.2, "{cutoff} Hz: {} {curvature}", second[k]);
            }
        }
    }

    /// Half the power passes at the cut-off, and derivatives are those of what passes.
    #[test]
    fn half_the_power_passes_at_the_cutoff() {
        let (cutoff, period) = (10.0, 1e-3);
        let kernel = Kernel::new(cutoff, period);
        let omega = 2.0 * PI * cutoff;
        assert!((kernel.gain(omega) - 0.5_f64.sqrt()).abs() < 1e-3);
        let signal: Vec<f64> = (0..2000).map(|k| (omega * f64::from(k) * period).sin()).collect();
        let (smooth, second) = (kernel.smooth(&signal, 1), kernel.second(&signal, 1));
        let largest = smooth.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        assert!((largest - kernel.gain(omega)).abs() < 1e-3, "{largest}");
        for (s, c) in smooth.iter().zip(&second) {
            assert!((c + omega * omega * s).abs() < 1e-2 * omega * omega, "{c} {s}");
        }
    }
}
