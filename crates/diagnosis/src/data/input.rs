//! A recording that is given to the diagnosis.

use recording::RegularRecording;

/// A recording to be diagnosed, with its name and role.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// The name that the user gave.
    pub name: &'a str,
    /// The recording on its regular clock, with the joints in the arm's order.
    pub recording: &'a RegularRecording,
    /// Whether it is held out: not to be fitted.
    pub held_out: bool,
    /// Whether it was made before a change of the robot (`--before`). Such recordings come first.
    pub before: bool,
}
