//! The recording that a logger makes of a run: one row every few ticks, with noise, jittered stamps and lost rows.

use rand::Rng;
use rand_distr::{Distribution, StandardNormal};
use recording::Recording;

use crate::machine::Run;
use crate::motion::{LEAD_TICKS, Reference, TICK};
use crate::robot::Robot;

/// The largest deviation of a stamp, in standard deviations.
const MOST_JITTER: f64 = 3.5;
/// Standard deviation of the stamps, relative to the period.
const JITTER: f64 = 0.1;
/// The share of rows that are lost.
const LOST: f64 = 0.01;

/// The sensors and the logger of a case.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sensors {
    /// The number of ticks of 1 ms from row to row.
    pub ticks: usize,
    /// Whether stamps jitter by a tenth of the period.
    pub jitter: bool,
    /// Whether 1 % of the rows are lost.
    pub lost: bool,
    /// The encoders' step (rad or m).
    pub quantum: f64,
    /// Standard deviation of the noise on each torque (N m or N).
    pub noise: Vec<f64>,
    /// Time constant of that noise (s); 0: white.
    pub noise_time: f64,
    /// The steps in which torques are reported (N m or N); 0 or an empty list for none.
    pub torque_quantum: Vec<f64>,
    /// Whether time begins at each recording's own start.
    pub own_clocks: bool,
}

impl Sensors {
    /// The nominal period (s).
    pub(crate) fn period(&self) -> f64 {
        self.ticks as f64 * TICK
    }

    /// A torque rounded to the steps that joint `j` reports.
    fn quantised(&self, j: usize, tau: f64) -> f64 {
        match self.torque_quantum.get(j) {
            Some(&step) if step > 0.0 => (tau / step).round() * step,
            _ => tau,
        }
    }

    /// The recording of `run` along `reference`.
    pub(crate) fn record(&self, robot: &Robot, reference: &Reference, run: &Run, random: &mut impl Rng) -> Recording {
        let joints = robot.arm().joints();
        let n = joints.len();
        let mut recording = Recording {
            joints: joints.iter().map(|joint| joint.name.clone()).collect(),
            q: vec![Vec::new(); n],
            qd: Some(vec![Vec::new(); n]),
            tau: vec![Vec::new(); n],
            ..Recording::default()
        };
        let mut qd = vec![Vec::new(); n];
        // First-order coloured noise, with the same standard deviation as white noise and correlated rows.
        let kept = if self.noise_time > 0.0 { (-self.period() / self.noise_time).exp() } else { 0.0 };
        let fresh = (1.0 - kept * kept).sqrt();
        let mut noise = vec![0.0; n];
        let mut is_first = true;
        let zero = if self.own_clocks { reference.start } else { 0.0 };
        // The last tick ends the last interval and is not a row.
        for tick in (LEAD_TICKS..reference.ticks() - 1).step_by(self.ticks) {
            let mut normal = || -> f64 { StandardNormal.sample(random) };
            let late = normal().clamp(-MOST_JITTER, MOST_JITTER) * JITTER * self.period();
            for (noise, size) in noise.iter_mut().zip(&self.noise) {
                let drawn = size * normal();
                *noise = if is_first { drawn } else { kept * *noise + fresh * drawn };
            }
            is_first = false;
            let keep = random.random::<f64>() >= LOST;
            if self.lost && !keep {
                continue;
            }
            let time = reference.time(tick) - zero + if self.jitter { late } else { 0.0 };
            recording.time.push(rounded(time, 6));
            for j in 0..n {
                let at = tick * n + j;
                recording.q[j].push(rounded(run.q[at], 5));
                qd[j].push(rounded(run.qd[at], 4));
                recording.tau[j].push(significant(self.quantised(j, run.tau[at] + noise[j]), 5));
            }
        }
        recording.qd = Some(qd);
        recording
    }
}

/// Rounds to this number of decimals, as in a file.
fn rounded(value: f64, decimals: i32) -> f64 {
    let scale = 10_f64.powi(decimals);
    (value * scale).round() / scale
}

/// Rounds to this number of significant digits.
fn significant(value: f64, digits: i32) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    let decimals = digits - 1 - value.abs().log10().floor() as i32;
    if decimals >= 0 {
        rounded(value, decimals)
    } else {
        let scale = 10_f64.powi(-decimals);
        (value / scale).round() * scale
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::expressed_share::deviation;
    use crate::motion::excitation;
    use crate::test_robots::seven_axis;

    /// Rows, stamps and noise follow the settings; the positions are those of the run.
    #[test]
    fn a_logger_follows_its_settings() {
        let robot = seven_axis();
        let n = robot.arm().dof();
        let reference = excitation(&robot, 30.0, &mut ChaCha8Rng::seed_from_u64(4));
        let run = Run { q: reference.q.clone(), qd: reference.qd.clone(), tau: reference.ff.clone() };
        let clean = Sensors {
            ticks: 4,
            jitter: false,
            lost: false,
            quantum: 1e-5,
            noise: vec![0.5; n],
            noise_time: 0.0,
            torque_quantum: Vec::new(),
            own_clocks: false,
        };
        let record = |sensors: &Sensors| sensors.record(&robot, &reference, &run, &mut ChaCha8Rng::seed_from_u64(9));
        let recording = record(&clean);
        assert_eq!(recording.len(), 6250);
        assert_eq!((recording.time[0], recording.time[6249]), (30.0, 54.996));
        let noise: Vec<f64> =
            (0..6250).map(|row| recording.tau[2][row] - run.tau[(LEAD_TICKS + 4 * row) * n + 2]).collect();
        assert!((deviation(&noise) - 0.5).abs() < 0.02, "{}", deviation(&noise));
        assert!((recording.q[1][100] - run.q[(LEAD_TICKS + 400) * n + 1]).abs() <= 0.51e-5);

        // Coloured noise has the same size and correlated rows; torques are rounded to steps; a file's own clock
        // begins at zero.
        let real =
            record(&Sensors { noise_time: 0.02, torque_quantum: vec![0.125; n], own_clocks: true, ..clean.clone() });
        assert_eq!((real.time[0], real.time[6249]), (0.0, 24.996));
        let noise: Vec<f64> = (0..6250).map(|row| real.tau[2][row] - run.tau[(LEAD_TICKS + 4 * row) * n + 2]).collect();
        let lagged: f64 = noise.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / 6249.0;
        assert!((deviation(&noise) - 0.5).abs() < 0.06, "{}", deviation(&noise));
        assert!((lagged / 0.25 - (-0.2_f64).exp()).abs() < 0.15, "{lagged}");
        assert!(real.tau[2].iter().all(|tau| (tau / 0.125).fract() == 0.0));

        let rough = record(&Sensors { jitter: true, lost: true, ..clean });
        let lost = 6250 - rough.len();
        assert!((30..100).contains(&lost), "{lost}");
        assert!(rough.time.windows(2).all(|pair| pair[0] < pair[1]));
        let late: Vec<f64> = rough.time.iter().map(|time| time - (time / 0.004).round() * 0.004).collect();
        assert!((deviation(&late) - 4e-4).abs() < 2e-5, "{}", deviation(&late));
    }

    #[test]
    fn numbers_are_rounded_as_files_have_them() {
        assert_eq!(significant(123.456_789, 5), 123.46);
        assert_eq!(significant(-0.000_123_456_78, 5), -0.000_123_46);
        assert_eq!(significant(123_456.0, 5), 123_460.0);
        assert_eq!(significant(0.0, 5), 0.0);
        assert_eq!(rounded(0.123_456, 5), 0.123_46);
    }
}
