//! The ground truth of a case, as far as it is scored.
//!
//! The files are written by the author of the case, here by the crate `faults`. This crate reads them with types of its own, as
//! it reads diagnoses. The two crates therefore do not depend on each other, and cases of other authors are scored in the same
//! way.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::catalogue::{BASELINE, BASELINE_WITH_DRIVES, DRIVE_INERTIA, canonical, is_outside};

/// The faults that a machine has and its URDF does not have; fields that are not scored are not read.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Truth {
    /// The case's name, that of its folder.
    pub case: String,
    /// Everything that was injected, baseline friction among it.
    pub concealed: Vec<Injected>,
    /// Standard deviation of the noise on each torque (N m or N), base to tip.
    pub torque_noise: Vec<f64>,
    /// How wrong the inertials of the case's URDF are everywhere, about relative; `None` where nobody said: exact but for what is injected.
    #[serde(default)]
    pub urdf_sigma: Option<f64>,
}

/// One injected fault.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Injected {
    /// The catalogue's name; outside the catalogue a name that ends in `_unknown`.
    pub effect: String,
    /// The URDF joint's name; `None` for the whole arm.
    pub joint: Option<String>,
    /// The functional form, if it is not the textbook form.
    #[serde(default)]
    pub form: Option<String>,
    /// When it sets in (s, on the recordings' clock), where it is not there from the start.
    #[serde(default)]
    pub onset: Option<f64>,
    /// The largest part of a joint's torque (in standard deviations, over the training recordings) that vanishes when the machine is run
    /// without it; `None` where nobody said.
    #[serde(default)]
    pub expressed_share: Option<f64>,
    /// Whether it is one of the small effects of real joints: neither required, nor false when named.
    #[serde(default)]
    pub minor: bool,
    /// The catalogue's parameters (SI), by name.
    #[serde(flatten)]
    pub parameters: BTreeMap<String, serde_json::Value>,
}

impl Truth {
    /// The effects that every machine like this one has and its URDF leaves out, so that they are scored apart: plain friction, and the
    /// drives' inertias where the robot comes with them. Faults are injected on a joint: inertia on every one of several joints is the
    /// robot's own.
    pub fn baseline(&self) -> &'static [&'static str] {
        let joints = self.torque_noise.len();
        let drives = self
            .concealed
            .iter()
            .filter(|injected| injected.effect == DRIVE_INERTIA && !injected.minor);
        if joints > 1 && drives.count() == joints {
            BASELINE_WITH_DRIVES
        } else {
            BASELINE
        }
    }

    /// Whether the URDF is wrong everywhere: inertials that differ from it are baseline then.
    pub fn has_a_wrong_urdf(&self) -> bool {
        self.urdf_sigma.is_some_and(|sigma| sigma > 0.0)
    }

    /// What is injected and required, or baseline: all but the small things of real joints.
    pub fn of_note(&self) -> impl Iterator<Item = &Injected> {
        self.concealed.iter().filter(|injected| !injected.minor)
    }

    /// Reported over true torque of a joint, where that is one of its small things: what is weighed there is in the recorded torque's unit.
    pub fn torque_unit(&self, joint: Option<&str>) -> f64 {
        let on_it = |injected: &&Injected| {
            injected.minor && injected.name() == "torque_scale" && injected.joint.as_deref() == joint
        };
        let factor = |injected: &Injected| injected.parameters.get("factor").and_then(serde_json::Value::as_f64);
        self.concealed.iter().filter(on_it).filter_map(factor).product()
    }
}

impl Injected {
    /// The catalogue's name, also of truths that were written under another.
    pub fn name(&self) -> &str {
        canonical(&self.effect)
    }

    /// Whether no name of the catalogue fits it.
    pub fn is_outside_the_catalogue(&self) -> bool {
        is_outside(&self.effect)
    }
}
