//! Outside the catalogue: a torque that drifts at random.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "random_walk_unknown",
    draw: |bare, at, random| {
        at.other_and_phase(random);
        bare.with("amplitude", at.spread() * random.random_range(0.1..0.3))
            .with("time_constant", random.random_range(1.0..8.0))
            .with("seed", f64::from(random.random::<u32>()))
    },
    read: |reader| {
        reader.on_link(Walk {
            amplitude: reader.number("amplitude")?,
            values: walk(reader.number_above("time_constant", 0.0)?, reader.number("seed")? as u64),
        })
    },
    #[cfg(test)]
    example: |bare| bare.with("amplitude", 2.0).with("time_constant", 1.0).with("seed", 3.0),
    ..Fault::OUTSIDE_THE_CATALOGUE
};

/// The duration of a walk, after which the torque is constant (s).
const LONGEST_WALK: f64 = 600.0;

/// A drifting torque: values every 0.01 s from time 0.
struct Walk {
    amplitude: f64,
    values: Vec<f64>,
}

impl LinkLaw for Walk {
    fn torque(&self, at: At<'_>, _: &mut f64, _: f64) -> f64 {
        let values = &self.values;
        let place = (100.0 * at.time).max(0.0);
        let before = (place as usize).min(values.len() - 2);
        let part = (place - before as f64).min(1.0);
        self.amplitude * (values[before] + part * (values[before + 1] - values[before]))
    }
}

/// A random torque with unit variance (Ornstein and Uhlenbeck 1930), smoothed over 0.05 s, every 0.01 s.
fn walk(time_constant: f64, seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    let keep = (-0.01 / time_constant).exp();
    let (mut x, smooth) = (normal(), 1.0 - (-0.01_f64 / 0.05).exp());
    let mut y = x;
    (0..(100.0 * LONGEST_WALK) as usize)
        .map(|_| {
            x = keep * x + (1.0 - keep * keep).sqrt() * normal();
            y += smooth * (x - y);
            y
        })
        .collect()
}
