//! What the user asks of a diagnosis, and what the diagnosis reports while it runs.

use effects::Effect;

use crate::thresholds::Thresholds;

/// Options of a diagnosis.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// The half-power frequency of the low-pass filter (Hz); `None` derives it from the recordings.
    pub cutoff: Option<f64>,
    /// The lag of all recorded torques behind the positions (s), which is removed; negative if they are ahead. `None` estimates it from the
    /// recordings.
    pub torque_lag: Option<f64>,
    /// The relative error of the URDF's masses, centres of mass and inertias, as a part of each link's own (0.1: ten per
    /// cent); `None` estimates it from the recordings.
    pub urdf_accuracy: Option<f64>,
    /// The relative standard deviation of each joint's torque constant; `None` if it is unknown.
    pub torque_accuracy: Option<f64>,
    /// Effects that the user knows: they are part of the nominal model, and not reported again.
    pub known: Vec<Effect>,
    /// Fits these effects and no others: there is no search, and no effect is removed. `None` searches the catalogue.
    pub only: Option<Vec<Wanted>>,
    /// Whether to propose the next experiment.
    pub next: bool,
    /// The most decisive thresholds, which can be varied.
    pub thresholds: Thresholds,
}

impl Options {
    /// Whether the effect of this name (`None`: an unmodelled form) is a candidate on a joint or (`None`) on the whole arm: all
    /// are, unless particular effects are requested.
    pub(crate) fn may_be(&self, effect: Option<&str>, joint: Option<&String>) -> bool {
        self.only.as_ref().is_none_or(|wanted| {
            let is_wanted = |one: &Wanted| {
                let is_there = joint == one.joint.as_ref() || (joint.is_some() && joint == one.other.as_ref());
                effect == Some(&one.effect) && is_there
            };
            wanted.iter().any(is_wanted)
        })
    }
}

/// An effect to be fitted, by its name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    /// The catalogue's name.
    pub effect: String,
    /// The joint, or `None` for the whole arm.
    pub joint: Option<String>,
    /// The other joint of a coupling, if a particular one is requested.
    pub other: Option<String>,
    /// Whether it has an onset, which is searched; `None` if that is open.
    pub sets_in: Option<bool>,
}

/// A step of a diagnosis at its beginning.
#[derive(Clone, Copy, Debug)]
pub struct Step<'a> {
    /// A description of the step.
    pub doing: &'a str,
    /// The part of the computing time that has usually passed by then. It falls when the search is repeated.
    pub done: f64,
}

impl<'a> Step<'a> {
    /// The step with this description, at this part of the time.
    pub fn new(done: f64, doing: &'a str) -> Self {
        Self { doing, done }
    }
}
