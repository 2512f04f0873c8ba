//! A value of the log marginal likelihood, amplitude profiled out.

/// A value of the likelihood.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Evaluation {
    pub(crate) samples: usize,
    /// yᵀ C⁻¹ y.
    pub(crate) quadratic: f64,
    /// log det C.
    pub(crate) log_determinant: f64,
    /// The penalty of an approximation, which makes the likelihood a lower bound, nats; 0 if C is exact.
    pub(crate) penalty: f64,
}

impl Evaluation {
    pub(crate) fn new(samples: usize, quadratic: f64, log_determinant: f64) -> Self {
        Self { samples, quadratic, log_determinant, penalty: 0.0 }
    }

    /// The evaluation for `all` samples, of which this is the evaluation for their n means: each sample occurs all / n times, and C has the
    /// noise of the means on its diagonal. The noise of a single sample is `rho`.
    ///
    /// With k = all / n, the matrix of all is ρ I + E (C - ρ / k I) Eᵀ with n columns of E, of k ones each.
    pub(crate) fn repeated(self, all: usize, rho: f64) -> Self {
        let (n, all_samples) = (self.samples as f64, all as f64);
        Self {
            samples: all,
            log_determinant: self.log_determinant + n * (all_samples / n).ln() + (all_samples - n) * rho.ln(),
            ..self
        }
    }

    /// The amplitude² that maximises the likelihood: yᵀ C⁻¹ y / n.
    pub(crate) fn best_amplitude_squared(&self) -> f64 {
        self.quadratic / self.samples as f64
    }

    /// Log marginal likelihood at a given amplitude², nats. Source: Rasmussen and Williams 2006, eq. 2.30, with K + σ² I = amplitude² C.
    pub(crate) fn log_likelihood(&self, amplitude_squared: f64) -> f64 {
        let n = self.samples as f64;
        -0.5 * (self.quadratic / amplitude_squared
            + self.log_determinant
            + n * (2.0 * std::f64::consts::PI * amplitude_squared).ln())
            - self.penalty
    }

    /// Log marginal likelihood at the best amplitude.
    pub(crate) fn profiled(&self) -> f64 {
        self.log_likelihood(self.best_amplitude_squared())
    }
}
