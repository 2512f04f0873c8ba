//! The channels of a recording, listed once: the signals of the joints, then the other columns.

use crate::{Quantity, Recording, RegularRecording};

/// Which quantity of which joint a channel has; `None` for a column of unknown meaning.
type Meaning = Option<(Quantity, usize)>;

/// The channels of a recording of either type, shared or mutable.
macro_rules! channels {
    ($recording:ident, $iter:ident, $as_ref:ident $(, $mut:tt)?) => {{
        let of_all_joints = [
            (Quantity::Position, Some(&$($mut)? $recording.q)),
            (Quantity::Velocity, $recording.qd.$as_ref()),
            (Quantity::Acceleration, $recording.qdd.$as_ref()),
            (Quantity::Torque, Some(&$($mut)? $recording.tau)),
        ];
        let of_some_joints = [
            (Quantity::SecondaryPosition, &$($mut)? $recording.q_secondary),
            (Quantity::CurrentTorque, &$($mut)? $recording.tau_current),
            (Quantity::Current, &$($mut)? $recording.current),
            (Quantity::Temperature, &$($mut)? $recording.temperature),
        ];
        let of_all_joints = of_all_joints.into_iter().flat_map(|(quantity, signal)| {
            signal.into_iter().flatten().enumerate().map(move |(joint, values)| (Some((quantity, joint)), values))
        });
        let of_some_joints = of_some_joints.into_iter().flat_map(|(quantity, signal)| {
            let joints = signal.$iter().enumerate();
            joints.filter_map(move |(joint, values)| Some((Some((quantity, joint)), values.$as_ref()?)))
        });
        let others = $recording.others.$iter().map(|(_, values)| (None, values));
        of_all_joints.chain(of_some_joints).chain(others)
    }};
}

impl Recording {
    pub(crate) fn channels(&self) -> impl Iterator<Item = (Meaning, &Vec<f64>)> {
        channels!(self, iter, as_ref)
    }

    pub(crate) fn channels_mut(&mut self) -> impl Iterator<Item = (Meaning, &mut Vec<f64>)> {
        channels!(self, iter_mut, as_mut, mut)
    }
}

impl RegularRecording {
    pub(crate) fn channels_mut(&mut self) -> impl Iterator<Item = (Meaning, &mut Vec<f64>)> {
        channels!(self, iter_mut, as_mut, mut)
    }
}
