//! The diagnosis from beginning to end: one phase after the other.

use std::collections::BTreeMap;

use arm::Arm;
use effects::Effect;
use torque::Reference;

use crate::data::Data;
use crate::data::motion::Input;
use crate::error::DiagnosisError;
use crate::findings::conclusion::Conclusion;
use crate::findings::identified::identified;
use crate::findings::report::{Doubt, RecordingNames, Report, SCHEMA, Traces, Verdict};
use crate::search::hypothesis::Wanted;
use crate::search::study::Study;
use crate::selection::FinalFit;
use crate::thresholds::{CUTOFF, LARGEST_CUTOFF, LEAST_WIDTHS, Thresholds};
use crate::trace::Decision;

/// Options of a diagnosis.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// The half-power frequency of the low-pass filter (Hz); `None` derives it from the recordings.
    pub cutoff: Option<f64>,
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
    /// The diagnosis of recordings that contradict the URDF of `robot`: it contains the `doubts` and no effects.
    pub fn units_first(robot: &str, recordings: RecordingNames, doubts: Vec<Doubt>) -> Self {
        let report = Report {
            schema: SCHEMA,
            robot: robot.to_owned(),
            recordings,
            verdict: Verdict::UnitsFirst,
            doubts,
            findings: Vec::new(),
            unexplained: Vec::new(),
            not_observable: Vec::new(),
            not_enough_data: Vec::new(),
            located: Vec::new(),
            fit: BTreeMap::new(),
            changed: None,
            inertials: BTreeMap::new(),
            rollout: BTreeMap::new(),
            next_experiment: None,
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

/// Diagnoses where and why `inputs` differ from `arm`. `progress` receives each step as it begins.
///
/// The result depends on the inputs and options only, not on the number of threads.
///
/// # Errors
/// [`DiagnosisError`], if there is nothing to fit or a recording does not fit the arm.
pub fn diagnose(
    arm: &Arm,
    inputs: &[Input<'_>],
    options: &Options,
    progress: &dyn Fn(Step<'_>),
) -> Result<Diagnosis, DiagnosisError> {
    check(arm, inputs, options.cutoff.unwrap_or(CUTOFF))?;
    progress(Step::new(0.08, "filtering, rigid-body torques"));
    let data = Data::new(arm, inputs, options)?;
    let mut study = Study::new(data, options);
    let identified = identified(&study);
    let last = FinalFit::new(&mut study, options, progress)?;
    progress(Step::new(0.78, "alternatives of the findings"));
    let conclusion = Conclusion::new(&study, &last, &identified, inputs, options);
    let next = conclusion.next(&mut study, &last, (arm, options), progress)?;
    Ok(conclusion.diagnosis(arm, study, next))
}

fn check(arm: &Arm, inputs: &[Input<'_>], cutoff: f64) -> Result<(), DiagnosisError> {
    if inputs.iter().all(|input| input.held_out) {
        return Err(DiagnosisError::NoTraining);
    }
    let expected: Vec<String> = arm.joints().iter().map(|joint| joint.name.clone()).collect();
    for input in inputs {
        let recording = input.recording;
        if recording.joints != expected {
            return Err(DiagnosisError::Joints {
                recording: input.name.to_owned(),
                found: recording.joints.clone(),
                expected,
            });
        }
        let needed = LEAST_WIDTHS * LARGEST_CUTOFF / cutoff.min(LARGEST_CUTOFF / recording.period);
        let longest = recording.segments.iter().map(|s| s.ticks.len()).max().unwrap_or(0) as f64 * recording.period;
        if longest < needed {
            return Err(DiagnosisError::TooShort {
                recording: input.name.to_owned(),
                seconds: longest,
                cutoff,
                needed,
            });
        }
    }
    Ok(())
}
