//! The diagnosis from end to end.

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
use crate::thresholds::{CUTOFF, Thresholds};
use crate::trace::Decision;

/// How to diagnose.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Half-power frequency of the low-pass filter (Hz); `None` lets the data decide.
    pub cutoff: Option<f64>,
    /// How far the URDF's masses, centres of mass and inertias may be off, as a part of each link's own (0.1: ten per cent);
    /// `None` lets the recordings decide.
    pub urdf_accuracy: Option<f64>,
    /// The relative standard deviation of each joint's torque constant; `None` if nobody knows.
    pub torque_accuracy: Option<f64>,
    /// Effects that the user has already: they are taken off, and not reported again.
    pub known: Vec<Effect>,
    /// Fit these effects and no others, whatever comes of them: nothing is searched for, no name is earned or lost. `None`
    /// searches the catalogue.
    pub only: Option<Vec<Wanted>>,
    /// Whether to propose the next experiment.
    pub next: bool,
    /// The most decisive thresholds, to see what hangs on them.
    pub thresholds: Thresholds,
}

/// A diagnosis and what its figures are drawn from.
#[derive(Clone, Debug)]
pub struct Diagnosis {
    /// What others read.
    pub report: Report,
    /// On the diagnosis' own grid.
    pub traces: Traces,
    /// The named effects that correct the torque model.
    pub effects: Vec<Effect>,
    /// The motion of the next experiment, if one was requested and gives more information.
    pub next: Option<Reference>,
    /// Remarks on the use of the recordings, in sentences.
    pub remarks: Vec<String>,
    /// What was tried, taken and dropped on the way, in order.
    pub trace: Vec<Decision>,
}

impl Diagnosis {
    /// The answer where recordings do not fit the robot `robot` as they were read: `doubts`, and no effect.
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

/// A step of a diagnosis, as it begins.
#[derive(Clone, Copy, Debug)]
pub struct Step<'a> {
    /// What is being done.
    pub doing: &'a str,
    /// The part of the computing time that has usually passed by then; a repeated search begins again with a smaller one.
    pub done: f64,
}

impl<'a> Step<'a> {
    /// The step of that name, after that part of the time.
    pub fn new(done: f64, doing: &'a str) -> Self {
        Self { doing, done }
    }
}

/// Diagnoses where and why `inputs` differ from `arm`. `progress` receives each step as it begins.
///
/// The result depends on the inputs and options alone, not on the number of threads.
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
        // Both filters' reach, and ten rows.
        let needed = (10.0 + 6.0) * 0.235 / cutoff.min(0.235 / recording.period);
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
