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
    /// All injected faults, including baseline friction.
    #[serde(rename = "concealed")]
    pub injected: Vec<Injected>,
    /// Standard deviation of the noise on each torque (N m or N), base to tip.
    pub torque_noise: Vec<f64>,
    /// The relative standard deviation of the errors of all inertials in the case's URDF; `None` if the URDF is exact apart
    /// from the injected faults.
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
    /// Its onset (s, on the recordings' clock); `None` if it always acts.
    #[serde(default)]
    pub onset: Option<f64>,
    /// The largest part of a joint's torque (in standard deviations, over the training recordings) that vanishes when the
    /// machine is simulated without it; `None` if the author of the case does not state it.
    #[serde(default)]
    pub expressed_share: Option<f64>,
    /// Whether it is one of the small effects of real joints, which are neither required nor false if they are named.
    #[serde(default)]
    pub minor: bool,
    /// The catalogue's parameters (SI), by name.
    #[serde(flatten)]
    pub parameters: BTreeMap<String, serde_json::Value>,
}

impl Truth {
    /// The effects that every machine of this kind has and its URDF omits. They are scored separately: plain friction, and
    /// the inertias of drives if the robot itself has them. Faults are injected on single joints, so that inertias on each
    /// of several joints belong to the robot.
    pub fn baseline(&self) -> &'static [&'static str] {
        let joints = self.torque_noise.len();
        let drives = self.injected.iter().filter(|injected| injected.effect == DRIVE_INERTIA && !injected.minor);
        if joints > 1 && drives.count() == joints { BASELINE_WITH_DRIVES } else { BASELINE }
    }

    /// Whether the URDF is wrong everywhere, so that inertials that differ from it are a baseline effect.
    pub fn has_a_wrong_urdf(&self) -> bool {
        self.urdf_sigma.is_some_and(|sigma| sigma > 0.0)
    }

    /// The injected faults without the small effects of real joints: those that are required, and baseline effects.
    pub fn of_note(&self) -> impl Iterator<Item = &Injected> {
        self.injected.iter().filter(|injected| !injected.minor)
    }

    /// The reported over the true torque of a joint, if the joint has a torque scale as a small effect; one otherwise. True
    /// parameters that are proportional to the torque are multiplied by it.
    pub fn torque_unit(&self, joint: Option<&str>) -> f64 {
        let on_it = |injected: &&Injected| {
            injected.minor && injected.name() == "torque_scale" && injected.joint.as_deref() == joint
        };
        let factor = |injected: &Injected| injected.parameters.get("factor").and_then(serde_json::Value::as_f64);
        self.injected.iter().filter(on_it).filter_map(factor).product()
    }
}

impl Injected {
    /// The catalogue's name, also for ground truths that were written under an older name.
    pub fn name(&self) -> &str {
        canonical(&self.effect)
    }

    /// Whether it is outside the catalogue.
    pub fn is_outside_the_catalogue(&self) -> bool {
        is_outside(&self.effect)
    }
}
