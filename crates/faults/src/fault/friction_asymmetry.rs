//! Dry friction that is larger in one direction than in the other.

use super::coulomb_friction::Level;
use super::prelude::*;

/// The largest asymmetry, half the difference between the directions over their mean.
const MOST_PART: f64 = 0.5;

pub(super) const FAULT: Fault = Fault {
    name: "friction_asymmetry",
    leaves: Leaves::DryFriction,
    may_have_onset: true,
    draw: |bare, at, random| {
        let (coulomb, _) = at.dry_friction(random);
        let coulomb = coulomb.max(at.spread() * random.random_range(0.1..0.3));
        let half = coulomb * random.random_range(0.15..MOST_PART) * sign(random);
        bare.with("positive", coulomb + half).with("negative", coulomb - half)
    },
    size: Size::Changed(|injected, factor| {
        let [positive, negative] = ["positive", "negative"].map(|name| injected.number(name).unwrap_or(0.0));
        let mean = 0.5 * (positive + negative);
        let half = factor * (positive - mean);
        // A larger difference comes with more friction, because no bearing has ten times as much friction forwards as
        // backwards.
        let mean = mean.max(half.abs() / MOST_PART);
        vec![("positive", json!(mean + half)), ("negative", json!(mean - half))]
    }),
    read: |reader| {
        let joint = reader.joint()?;
        let (positive, negative) = (reader.at_least_zero("positive")?, reader.at_least_zero("negative")?);
        let tilt = Tilt(0.5 * (positive - negative));
        Ok(vec![Level(0.5 * (positive + negative)).below_a_curve(joint), Property::Dry(joint, Box::new(tilt)).into()])
    },
    #[cfg(test)]
    example: |bare| bare.with("positive", 2.0).with("negative", 1.0),
    ..Fault::ON_A_JOINT
};

/// The level is larger by this in the positive direction and smaller in the negative one (N m or N).
struct Tilt(f64);

impl DryLaw for Tilt {
    fn add_to(&self, sum: &mut DrySum, _: &DryAt) {
        sum.bias += self.0;
    }
}
