//! Physics outside the catalogue, drawn.

use std::f64::consts::TAU;

use rand::Rng;

use super::{Scales, sign};
use crate::truth::Injected;

impl Scales<'_> {
    /// What `bare` names, on joint `j`.
    pub(super) fn outside(&self, bare: Injected, j: usize, random: &mut impl Rng) -> Injected {
        let s = self.spreads[j];
        let home = self.robot.home()[j];
        let other = self.other(j, random);
        let form = |bare: Injected, random: &mut _, often: f64, form: &str| {
            if Rng::random_bool(random, often) {
                bare.formed(form)
            } else {
                bare
            }
        };
        let phase = random.random_range(0.0..TAU);
        match bare.effect.as_str() {
            "cross_coupling_unknown" => {
                let near = self.robot.arm().joints().iter().position(|joint| joint.name == other);
                let center = near.map_or(0.0, |o| self.robot.home()[o]) + random.random_range(-0.3..0.3);
                let bare = form(bare, random, 0.5, "step");
                let phase = if bare.form.is_some() { center } else { phase };
                bare.with("amplitude", s * random.random_range(0.2..0.5))
                    .with("other", other)
                    .with("rate", random.random_range(3.0..7.0))
                    .with("phase", phase)
            }
            "time_periodic_unknown" => form(bare, random, 0.5, "rounded square")
                .with("amplitude", s * random.random_range(0.15..0.5))
                .with("hz", random.random_range(0.6..3.5))
                .with("phase", phase),
            "dead_band_unknown" => form(bare, random, 0.5, "gaussian")
                .with("amplitude", s * random.random_range(0.1..0.4) * sign(random))
                .with("center", home + random.random_range(-0.1..0.1))
                .with("width", random.random_range(0.12..0.32)),
            "hysteresis_unknown" => form(bare, random, 0.5, "sharp")
                .with("amplitude", s * random.random_range(0.15..0.4))
                .with("scale", random.random_range(0.08..0.25))
                .with("shape", random.random_range(0.5..0.9)),
            "other_velocity_unknown" => {
                let bare = match random.random_range(0..3) {
                    0 => bare,
                    1 => bare.formed("square"),
                    _ => bare
                        .formed("saturating")
                        .with("velocity", random.random_range(0.1..0.3)),
                };
                bare.with("amplitude", s * random.random_range(0.15..0.5))
                    .with("other", other)
            }
            "history_unknown" => {
                let bare = match random.random_range(0..3) {
                    0 => bare,
                    1 => bare.formed("signed square"),
                    _ => bare.formed("position"),
                };
                bare.with("amplitude", s * random.random_range(0.3..1.0))
                    .with("time_constant", random.random_range(1.0..4.0))
            }
            "random_walk_unknown" => bare
                .with("amplitude", s * random.random_range(0.1..0.3))
                .with("time_constant", random.random_range(1.0..8.0))
                .with("seed", f64::from(random.random::<u32>())),
            _ => {
                let bare = form(bare, random, 0.5, "speed times position");
                let center = home + random.random_range(-0.3..0.3);
                let phase = if bare.form.is_some() { center } else { phase };
                bare.with("amplitude", s * random.random_range(0.2..0.6))
                    .with("rate", random.random_range(2.5..6.0))
                    .with("phase", phase)
            }
        }
    }
}
