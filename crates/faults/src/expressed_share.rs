//! The share of the torque that is due to an effect: runs with and without it, compared below 20 Hz.

/// Half-power frequency of the filter of the comparison, for both passes together (Hz).
const CUTOFF: f64 = 20.0;

/// The torques of training runs (N m or N), filtered: `[joint][tick]`, run after run.
pub(crate) type Torques = Vec<Vec<f64>>;

/// The torques `tau[tick × dof + joint]` at ticks of `period` (s), filtered to below 20 Hz, without the first `skip`
/// ticks; and the largest share, over the joints, of the torque above that frequency.
pub(crate) fn low_passed(tau: &[f64], dof: usize, period: f64, skip: usize) -> (Torques, f64) {
    let mut above: f64 = 0.0;
    let joints = (0..dof).map(|j| {
        let raw: Vec<f64> = tau.iter().skip(j).step_by(dof).copied().collect();
        let mut low = raw.clone();
        Biquad::low_pass(CUTOFF * period).filter_both_ways(&mut low);
        let rest: Vec<f64> = raw.iter().zip(&low).map(|(raw, low)| raw - low).skip(skip).collect();
        low.drain(..skip);
        above = above.max(deviation(&rest) / deviation(&low).max(f64::MIN_POSITIVE));
        low
    });
    (joints.collect(), above)
}

/// The largest share of a joint's torque that vanishes without the effect: the standard deviation of the difference (its
/// root mean square for a `constant` torque) over the standard deviation of the torque with the effect.
pub(crate) fn share(with: &[Torques], without: &[Torques], constant: bool) -> f64 {
    let dof = with.first().map_or(0, Vec::len);
    let of = |j: usize| {
        let all = |torques: &[Torques]| -> Vec<f64> { torques.iter().flat_map(|run| run[j].iter().copied()).collect() };
        let (with, without) = (all(with), all(without));
        let difference: Vec<f64> = with.iter().zip(&without).map(|(a, b)| a - b).collect();
        let size = if constant {
            (difference.iter().map(|d| d * d).sum::<f64>() / difference.len().max(1) as f64).sqrt()
        } else {
            deviation(&difference)
        };
        size / deviation(&with).max(f64::MIN_POSITIVE)
    };
    (0..dof).map(of).fold(0.0, f64::max)
}

/// The standard deviation.
pub(crate) fn deviation(values: &[f64]) -> f64 {
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / n).sqrt()
}

/// A second-order Butterworth low-pass filter.
struct Biquad {
    b: [f64; 3],
    a: [f64; 2],
}

impl Biquad {
    /// Half power at `frequency`, in cycles a sample (bilinear transform, prewarped).
    fn low_pass(frequency: f64) -> Self {
        let k = (std::f64::consts::PI * frequency).tan();
        let norm = 1.0 / (1.0 + std::f64::consts::SQRT_2 * k + k * k);
        let b = k * k * norm;
        Self {
            b: [b, 2.0 * b, b],
            a: [2.0 * (k * k - 1.0) * norm, (1.0 - std::f64::consts::SQRT_2 * k + k * k) * norm],
        }
    }

    /// Filters forwards and backwards, so that there is no phase shift; it starts at rest at the first and at the last
    /// value.
    fn filter_both_ways(&self, values: &mut [f64]) {
        self.pass(values.iter_mut());
        self.pass(values.iter_mut().rev());
    }

    fn pass<'a>(&self, values: impl Iterator<Item = &'a mut f64>) {
        let mut past: Option<[f64; 4]> = None;
        for value in values {
            let [x1, x2, y1, y2] = past.unwrap_or([*value; 4]);
            let y = self.b[0] * *value + self.b[1] * x1 + self.b[2] * x2 - self.a[0] * y1 - self.a[1] * y2;
            past = Some([*value, x1, y, y1]);
            *value = y;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Low frequencies pass without delay, high ones are removed.
    #[test]
    fn low_frequencies_pass() {
        let wave = |hertz: f64| -> Vec<f64> {
            (0..4000).map(|k| (std::f64::consts::TAU * hertz * f64::from(k) * 1e-3).sin()).collect()
        };
        let (slow, fast) = (wave(1.0), wave(200.0));
        let (low, above) = low_passed(&slow, 1, 1e-3, 0);
        let middle = 1000..3000;
        assert!(middle.clone().all(|k| (low[0][k] - slow[k]).abs() < 1e-3) && above < 0.01);
        assert!(low_passed(&fast, 1, 1e-3, 0).1 > 10.0);
    }

    #[test]
    fn a_share_is_that_of_the_joint_where_it_is_largest() {
        let with = vec![vec![vec![1.0, -1.0, 1.0, -1.0], vec![2.0, -2.0, 2.0, -2.0]]];
        let without = vec![vec![vec![0.5, -0.5, 0.5, -0.5], vec![2.0, -2.0, 2.0, -2.0]]];
        assert_eq!(share(&with, &without, false), 0.5);
        let shifted = vec![vec![vec![3.0, 1.0, 3.0, 1.0], vec![2.0, -2.0, 2.0, -2.0]]];
        assert_eq!(share(&shifted, &with, false), 0.0);
        assert_eq!(share(&shifted, &with, true), 2.0);
    }
}
