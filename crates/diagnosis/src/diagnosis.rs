//! The result of a diagnosis: the report, and what is beside it.

use std::collections::BTreeMap;

use effects::Effect;
use torque::Reference;

use crate::report::{Doubt, RecordingNames, Report, SCHEMA, Traces, Verdict};
use crate::trace::Decision;

/// A diagnosis, and the data of its figures.
#[derive(Clone, Debug)]
pub struct Diagnosis {
    /// The report.
    pub report: Report,
    /// The signals on the diagnosis' own grid.
    pub traces: Traces,
    /// The named effects that correct the torque model.
    pub effects: Vec<Effect>,
    /// The motion of the next experiment, if one was requested and gives more information.
    pub next: Option<Reference>,
    /// Notes on the use of the recordings, in sentences.
    pub remarks: Vec<String>,
    /// Every decision of the search, in order.
    pub trace: Vec<Decision>,
}

impl Diagnosis {
    /// This diagnosis, with what contradicts the URDF in the recordings and does not prevent a diagnosis.
    pub fn with_warnings(mut self, warnings: Vec<Doubt>) -> Self {
        self.report.warnings = warnings;
        self
    }

    /// The diagnosis of recordings that contradict the URDF of `robot`: it contains the `doubts` and no effects.
    pub fn units_first(robot: &str, recordings: RecordingNames, doubts: Vec<Doubt>) -> Self {
        let report = Report {
            schema: SCHEMA,
            robot: robot.to_owned(),
            recordings,
            cutoff: None,
            torque_lag: None,
            own_torque_lags: BTreeMap::new(),
            verdict: Verdict::UnitsFirst,
            doubts,
            warnings: Vec::new(),
            findings: Vec::new(),
            unexplained: Vec::new(),
            not_diagnosed: Vec::new(),
            not_observable: Vec::new(),
            not_enough_data: Vec::new(),
            located: Vec::new(),
            fit: BTreeMap::new(),
            changed: None,
            different_load: None,
            held_out_friction: Vec::new(),
            inertials: BTreeMap::new(),
            constant_torques: BTreeMap::new(),
            rollout: BTreeMap::new(),
            next_experiment: None,
            is_requested: false,
        };
        Self {
            report,
            traces: Traces::default(),
            effects: Vec::new(),
            next: None,
            remarks: Vec::new(),
            trace: Vec::new(),
        }
    }
}
