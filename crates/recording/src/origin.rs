//! The columns from which a recording was read, in the terms of a column map.

use crate::Quantity;
use crate::header::{Plan, TimeColumn};

/// The columns of a recording's file or arrays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Origin {
    /// The column of the time stamps.
    pub time: String,
    /// Seconds in the stamps' unit.
    pub time_factor: f64,
    /// The column of nanoseconds, if there is one.
    pub nanosec: Option<String>,
    /// The column that numbers the runs, if there is one.
    pub run: Option<String>,
    /// The joints' columns.
    pub columns: Vec<OriginColumn>,
}

/// A column of one joint.
#[derive(Clone, Debug, PartialEq)]
pub struct OriginColumn {
    /// The index of the joint in the recording, from 0.
    pub joint: usize,
    /// The quantity in the column.
    pub quantity: Quantity,
    /// Its header.
    pub header: String,
    /// The value in SI is factor × cell + offset.
    pub factor: f64,
    /// See `factor`.
    pub offset: f64,
}

impl Origin {
    /// The columns of `plan` for which `keeps` returns the index of a joint, given the index of the column in the
    /// plan.
    pub(crate) fn of(plan: &Plan, keeps: impl Fn(usize) -> Option<usize>) -> Self {
        let TimeColumn { header, factor, nanos, run, .. } = &plan.time;
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
