//! Dry friction of a cold drive, which decreases while the drive warms up.

use super::coulomb_friction::Level;
use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "thermal_drift",
    forms: &["hyperbolic", "stretched"],
    leaves: Leaves::DryFriction,
    draw: |bare, at, random| {
        let (coulomb, form) = at.dry_friction(random);
        let bare = match form {
            0 => bare,
            1 => bare.formed("hyperbolic"),
            _ => bare.formed("stretched"),
        };
        bare.with("coulomb", coulomb)
            .with("amplitude", random.random_range(0.3..1.2))
            .with("time_constant", random.random_range(20.0..60.0))
    },
    size: Size::Changed(|injected, factor| {
        let amplitude = injected.number("amplitude").unwrap_or(0.0);
        vec![("amplitude", json!((factor * amplitude).min(2.0)))]
    }),
    read: |reader| {
        let joint = reader.joint()?;
        let warming = Warming {
            amplitude: reader.number("amplitude")?,
            time_constant: reader.number_above("time_constant", 0.0)?,
            start: reader.number_or("start", 0.0)?,
            cooling: [Cooling::Exponential, Cooling::Hyperbolic, Cooling::Stretched][reader.form()?],
        };
        Ok(vec![
            Level(reader.at_least_zero("coulomb")?).below_a_curve(joint),
            Property::Dry(joint, Box::new(warming)).into(),
        ])
    },
    #[cfg(test)]
    example: |bare| bare.with("coulomb", 1.0).with("amplitude", 1.0).with("time_constant", 30.0),
    ..Fault::ON_A_JOINT
};

/// Multiplies the other parts by (1 + amplitude × cooling).
struct Warming {
    amplitude: f64,
    time_constant: f64,
    /// The time at which it began to warm up (s).
    start: f64,
    cooling: Cooling,
}

/// The decrease from 1 at the start to 0.
#[derive(Clone, Copy)]
enum Cooling {
    /// e^(−t/T).
    Exponential,
    /// 1 / (1 + t/T).
    Hyperbolic,
    /// e^(−(t/T)^0.7).
    Stretched,
}

impl DryLaw for Warming {
    fn add_to(&self, sum: &mut DrySum, at: &DryAt) {
        let x = ((at.time - self.start) / self.time_constant).max(0.0);
        let left = match self.cooling {
            Cooling::Exponential => (-x).exp(),
            Cooling::Hyperbolic => 1.0 / (1.0 + x),
            Cooling::Stretched => (-x.powf(0.7)).exp(),
        };
        sum.factor *= 1.0 + self.amplitude * left;
    }
}
