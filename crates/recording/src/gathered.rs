//! Columns that were read, combined into a recording.

use crate::header::Plan;
use crate::location::Location;
use crate::origin::Origin;
use crate::{PartialSignal, Quantity, Recording, Signal, Warning, wraps};

/// The state of a channel while it is read.
#[derive(Clone, Debug, PartialEq)]
pub enum State {
    /// Nothing yet.
    New,
    /// Every row so far has a value.
    Values,
    /// No row so far has a value, although every row must have one.
    Missing {
        /// The first row.
        place: Location,
        /// The content of its cell.
        found: String,
    },
    /// The channel is optional, and a value is missing.
    LeftOut,
}

/// The columns of a plan: first the time (s), then the channels, then the other columns.
pub struct Gathered<'a> {
    /// The plan of the columns.
    pub plan: &'a Plan,
    /// Their values.
    pub columns: Vec<Vec<f64>>,
    /// The rows at which a run begins, except the first run.
    pub breaks: Vec<usize>,
    /// The state of each channel.
    pub states: Vec<State>,
    /// For each other column, whether all its cells are numbers.
    pub numeric: Vec<bool>,
    /// The warnings so far.
    pub warnings: Vec<Warning>,
    /// The second since 1970 from which the time is counted, if stamps are dates.
    pub epoch: Option<i64>,
    /// The time that was read and is not kept (s).
    pub left_out: f64,
}

impl Gathered<'_> {
    /// Makes the recording; joints without positions or torques are omitted.
    pub fn into_recording(mut self) -> Recording {
        let keeps = self.kept_joints();
        let origin = Origin::of(self.plan, |index| {
            let joint = self.plan.channels[index].joint;
            let is_here = keeps[joint] && self.states[index] != State::LeftOut;
            is_here.then(|| keeps[..joint].iter().filter(|keeps| **keeps).count())
        });
        let others: Vec<Vec<f64>> = self.columns.split_off(1 + self.plan.channels.len());
        let mut channels = self.columns.split_off(1);
        let time = self.columns.swap_remove(0);
        let mut signal = |quantity: Quantity| -> PartialSignal {
            let mut signal = vec![None; keeps.len()];
            for ((channel, state), values) in self.plan.channels.iter().zip(&self.states).zip(&mut channels) {
                if channel.quantity == quantity && *state != State::LeftOut {
                    signal[channel.joint] = Some(std::mem::take(values));
                }
            }
            let kept = signal.into_iter().zip(&keeps).filter(|(_, keeps)| **keeps);
            kept.map(|(values, _)| values).collect()
        };
        let mut partial = |quantity: Quantity| -> PartialSignal {
            let signal = signal(quantity);
            if signal.iter().all(Option::is_none) { Vec::new() } else { signal }
        };
        // Given for all joints or for none.
        let mut whole = |quantity: Quantity| -> Signal {
            let signal: Option<Signal> = partial(quantity).into_iter().collect();
            signal.unwrap_or_default()
        };
        let some = |signal: Signal| if signal.is_empty() { None } else { Some(signal) };
        let (q, tau) = (whole(Quantity::Position), whole(Quantity::Torque));
        let (qd, qdd) = (some(whole(Quantity::Velocity)), some(whole(Quantity::Acceleration)));
        if qd.is_none() {
            self.warnings.push(Warning::NoVelocity);
        }
        let q_secondary = partial(Quantity::SecondaryPosition);
        let tau_current = partial(Quantity::CurrentTorque);
        let (current, temperature) = (partial(Quantity::Current), partial(Quantity::Temperature));
        let joints = self.plan.joints.iter().zip(&keeps).filter(|(_, keeps)| **keeps);
        let others = self.plan.others.iter().zip(others).zip(self.numeric);
        let mut recording = Recording {
            joints: joints.map(|(joint, _)| joint.clone()).collect(),
            time,
            q,
            qd,
            qdd,
            tau,
            q_secondary,
            tau_current,
            current,
            temperature,
            others: others
                .filter(|(_, numeric)| *numeric)
                .map(|(((_, name), values), _)| (name.clone(), values))
                .collect(),
            breaks: self.breaks,
            warnings: self.warnings,
            epoch: self.epoch,
            left_out: self.left_out,
            origin: Some(origin),
        };
        wraps::unwrap(&mut recording);
        recording
    }

    /// Whether each joint has positions and torques; there is a warning for each that does not.
    fn kept_joints(&mut self) -> Vec<bool> {
        let mut keeps = vec![true; self.plan.joints.len()];
        for (channel, state) in self.plan.channels.iter().zip(&self.states) {
            if matches!(state, State::Missing { .. }) && keeps[channel.joint] {
                keeps[channel.joint] = false;
                self.warnings.push(Warning::JointLeftOut {
                    joint: self.plan.joints[channel.joint].clone(),
                    column: channel.header.clone(),
                });
            }
        }
        keeps
    }
}
