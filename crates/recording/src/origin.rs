//! The columns that a recording was read from, as a column map would have to name them.

use crate::Quantity;
use crate::header::{Plan, TimeColumn};

/// The columns of a recording's file or arrays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Origin {
    /// The column of the time stamps.
    pub time: String,
    /// Seconds in the stamps' unit.
    pub time_factor: f64,
    /// The column of nanoseconds beside it, where there is one.
    pub nanosec: Option<String>,
    /// The column that numbers the runs, where there is one.
    pub run: Option<String>,
    /// The joints' columns.
    pub columns: Vec<OriginColumn>,
}

/// A column of one joint.
#[derive(Clone, Debug, PartialEq)]
pub struct OriginColumn {
    /// The joint, from 0, among the recording's.
    pub joint: usize,
    /// What the column holds.
    pub quantity: Quantity,
    /// Its header.
    pub header: String,
    /// The value in SI is factor × cell + offset.
    pub factor: f64,
    /// See `factor`.
    pub offset: f64,
}

impl Origin {
    /// The columns of `plan` that were kept: those for which `keeps`, given the column's place in the plan, is a joint.
    pub(crate) fn of(plan: &Plan, keeps: impl Fn(usize) -> Option<usize>) -> Self {
        let TimeColumn {
            header,
            factor,
            nanos,
            run,
            ..
        } = &plan.time;
        let columns = plan.channels.iter().enumerate().filter_map(|(index, channel)| {
            Some(OriginColumn {
                joint: keeps(index)?,
                quantity: channel.quantity,
                header: channel.header.clone(),
                factor: channel.factor,
                offset: channel.offset,
            })
        });
        Self {
            time: header.clone(),
            time_factor: *factor,
            nanosec: nanos.as_ref().map(|(_, name)| name.clone()),
            run: run.as_ref().map(|(_, name)| name.clone()),
            columns: columns.collect(),
        }
    }
}
