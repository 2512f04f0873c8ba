//! Friction that is not the same in the held-out recordings as in the training recordings.

use std::collections::BTreeMap;

use crate::report::HeldOutFriction;
use crate::selection::FinalFit;
use crate::selection::held_out_friction::{in_recordings, is_other};
use crate::thresholds::OF_OTHER_FRICTION;

/// The friction of joints in the held-out recordings over that in the training recordings, where they clearly differ.
pub struct OtherFriction {
    /// The factor by recording and joint.
    factors: BTreeMap<(usize, usize), f64>,
    /// The joint's held-out error without the difference over that with it, by joint.
    remaining: BTreeMap<usize, f64>,
}

impl OtherFriction {
    /// The friction with the final fit.
    pub fn new(last: &FinalFit) -> Self {
        let (problem, named) = (last.problem(), &last.judged.named);
        let (mut factors, mut remaining) = (BTreeMap::new(), BTreeMap::new());
        for joint in 0..last.study.data.motions.dof {
            let all = in_recordings(&last.study, &problem, (&named.set, &named.fit), &last.residual[joint], joint);
            let other =
                all.iter().filter(|friction| is_other(friction.factor) && friction.remaining < OF_OTHER_FRICTION);
            factors.extend(other.map(|friction| ((friction.recording, joint), friction.factor)));
            if !all.is_empty() && all.iter().all(|friction| factors.contains_key(&(friction.recording, joint))) {
                remaining.insert(joint, all.iter().map(|friction| friction.remaining).fold(0.0, f64::max));
            }
        }
        Self { factors, remaining }
    }

    /// The factor of the held-out error of `joint` that remains with the friction of the held-out recordings; one if that is the same.
    pub fn remaining(&self, joint: usize) -> f64 {
        self.remaining.get(&joint).copied().unwrap_or(1.0)
    }

    /// The differences as they are reported.
    pub fn reported(&self, last: &FinalFit) -> Vec<HeldOutFriction> {
        let data = &last.study.data;
        let of = |(&(recording, joint), &factor): (&(usize, usize), &f64)| HeldOutFriction {
            recording: data.motions.sources[recording].name.clone(),
            joint: data.arm.joints()[joint].name.clone(),
            factor,
        };
        self.factors.iter().map(of).collect()
    }
}
