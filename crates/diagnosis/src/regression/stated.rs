//! The strengths of the background that the user states.

use crate::options::Options;
use crate::regression::strengths::PriorStrengths;
use crate::thresholds::GAIN_PRIOR;

/// Strengths that the user states, so that they are not selected by evidence.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stated {
    /// ρ of all links.
    pub links: Option<f64>,
    /// The standard deviation of the torque constants.
    pub gain: Option<f64>,
    /// Whether no form of friction is in the background.
    pub is_friction_plain: bool,
    /// Whether the lag of all torques is known.
    pub is_lag_known: bool,
}

impl Stated {
    /// The strengths as far as the user states them.
    pub fn of(options: &Options) -> Self {
        Self {
            links: options.urdf_accuracy,
            gain: options.torque_accuracy,
            is_friction_plain: false,
            // A hypothesis is fitted to the recordings as they are.
            is_lag_known: options.torque_lag.is_some() || options.only.is_some(),
        }
    }

    /// The strengths at the beginning of the search.
    pub fn first(self, links: usize) -> PriorStrengths {
        PriorStrengths {
            links: vec![self.links.unwrap_or(0.0); links],
            gain: self.gain.map_or(0.0, |gain| gain / GAIN_PRIOR),
            ..PriorStrengths::none(links)
        }
    }

    /// The relative standard deviation of the torque constants.
    pub fn torque_accuracy(self) -> f64 {
        self.gain.unwrap_or(GAIN_PRIOR)
    }

    /// `strengths` with less of one part each, as far as they agree with those stated.
    pub fn weaker(self, strengths: &PriorStrengths) -> impl Iterator<Item = PriorStrengths> {
        let weaker = strengths.weaker().into_iter();
        weaker.filter(move |strengths| self.allows(strengths))
    }

    /// Whether strengths agree with those stated.
    pub fn allows(self, strengths: &PriorStrengths) -> bool {
        let first = self.first(strengths.links.len());
        (self.links.is_none() || strengths.links == first.links)
            && (self.gain.is_none() || strengths.gain == first.gain)
            && (!self.is_friction_plain || strengths.friction == 0.0 && strengths.varied.is_empty())
            && (!self.is_lag_known || !strengths.lag)
    }
}
