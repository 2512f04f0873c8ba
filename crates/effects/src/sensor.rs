//! What is wrong with a reading.

mod encoder_offset;
mod torque_offset;
mod torque_scale;

pub use encoder_offset::EncoderOffset;
pub use torque_offset::TorqueOffset;
pub use torque_scale::TorqueScale;

use crate::Experiment;

/// The experiment that distinguishes offset and scale of a torque where no motion does.
const KNOWN_LOAD: Experiment = Experiment {
    rank: 5,
    text: "read the torque at rest under a known load in two poses on opposite sides of the vertical: their sum shows the offset, their difference the scale",
};
