//! Faults drawn at random: their joint and their onset. The file of each fault draws its size and form.

use rand::Rng;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;

use crate::fault::{EligibleJoints, Fault, Leaves, coulomb_friction, viscous_friction};
use crate::site::Scales;
use crate::truth::Injected;

/// The smallest ratio of the torque of the bodies to the whole torque on a loaded joint.
const LOADED: f64 = 0.5;
/// The probability of an onset for faults that may have one.
const ONSET: f64 = 0.12;

/// Baseline friction of every joint: Coulomb level and viscous coefficient.
pub(crate) fn baseline_friction(spreads: &[f64], random: &mut ChaCha8Rng) -> Vec<(f64, f64)> {
    let of = |s: &f64| {
        let level = coulomb_friction::level(*s, random);
        (level, viscous_friction::coefficient(*s, random))
    };
    spreads.iter().map(of).collect()
}

impl Scales<'_> {
    /// Draws `fault` on a joint that is not `used`, with size and form.
    pub(crate) fn draw(&self, fault: &Fault, used: &[usize], random: &mut ChaCha8Rng) -> Injected {
        let n = self.robot.arm().dof();
        let free = |j: &usize| !used.contains(j);
        let mut joints: Vec<usize> = (0..n).filter(free).collect();
        let fits = |j: usize| match fault.joints {
            EligibleJoints::AnyJoint | EligibleJoints::WholeArm => true,
            EligibleJoints::OuterJoints => j > 0,
            EligibleJoints::InnerJoints => (1..n.saturating_sub(1)).contains(&j),
            EligibleJoints::LoadedJoints => self.loads[j] >= LOADED * self.spreads[j],
        };
        if joints.iter().any(|&j| fits(j)) {
            joints.retain(|&j| fits(j));
        }
        let joint = joints.choose(random).copied().unwrap_or_else(|| random.random_range(0..n));
        let name = self.robot.arm().joints()[joint].name.as_str();
        let bare = Injected::new(fault.name, (fault.joints != EligibleJoints::WholeArm).then_some(name));
        let mut drawn = (fault.draw)(bare, &self.site(joint), random);
        let begins_late = random.random_bool(ONSET);
        if begins_late && fault.may_have_onset && drawn.leaves() != Leaves::Tool {
            let (from, to) = self.span;
            drawn.onset = Some(from + (to - from) * random.random_range(0.3..0.7));
        }
        drawn
    }
}
