//! A diagnosis in its own thread, while the calling thread receives its messages and checks for Ctrl-C.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;

use anyhow::Context;
use arm::ChainOptions;
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use recording::Column;
use study::effect_file::EffectFile;
use study::inputs::{Given, Recordings};
use study::notes::Notes;
use study::urdf_friction::UrdfFriction;
use study::{Diagnosed, Known, Listener, Request, Step, mjcf_file, urdf_file};

use crate::error::{JointwiseError, in_python, raised};

/// The interval between two checks for Ctrl-C.
const LISTENING: Duration = Duration::from_millis(50);

/// A column of a recording: numbers, whole numbers, or times (ns since 1970).
#[derive(FromPyObject)]
pub enum GivenColumn<'py> {
    Times((PyReadonlyArray1<'py, i64>, bool)),
    Integers(PyReadonlyArray1<'py, i64>),
    Numbers(PyReadonlyArray1<'py, f64>),
}

/// A recording: the path of a file, or a name and columns.
#[derive(FromPyObject)]
pub enum GivenRecording<'py> {
    Columns(String, Vec<(String, GivenColumn<'py>)>),
    #[pyo3(transparent)]
    File(PathBuf),
}

fn given(recording: GivenRecording<'_>) -> PyResult<Given> {
    let (name, columns) = match recording {
        GivenRecording::File(path) => return Ok(Given::File(path)),
        GivenRecording::Columns(name, columns) => (name, columns),
    };
    let copied = columns.into_iter().map(|(header, column)| {
        let column = match column {
            GivenColumn::Times((times, _)) => Column::Nanos(times.as_slice()?.to_vec()),
            GivenColumn::Integers(numbers) => Column::Integers(numbers.as_slice()?.to_vec()),
            GivenColumn::Numbers(numbers) => Column::Numbers(numbers.as_slice()?.to_vec()),
        };
        Ok((header, column))
    });
    let columns = copied.collect::<PyResult<_>>()?;
    Ok(Given::Columns { name, columns })
}

fn all_given(recordings: Vec<GivenRecording<'_>>) -> PyResult<Vec<Given>> {
    recordings.into_iter().map(given).collect()
}

/// A message of the thread of the diagnosis.
enum Message {
    Doing(String),
    /// A note, and whether it is a warning.
    Note(String, bool),
}

/// The panic payload that ends a diagnosis whose caller was interrupted.
struct Abandoned;

struct Channel {
    sender: Sender<Message>,
    is_abandoned: Arc<AtomicBool>,
}

impl Channel {
    fn send(&self, message: Message) {
        if self.is_abandoned.load(Ordering::Relaxed) || self.sender.send(message).is_err() {
            // The caller was interrupted: this unwinds to the end of the thread without printing a message.
            std::panic::resume_unwind(Box::new(Abandoned));
        }
    }
}

impl Listener for Channel {
    fn doing(&self, step: Step<'_>) {
        self.send(Message::Doing(step.doing.to_owned()));
    }

    fn note(&self, text: &str) {
        self.send(Message::Note(in_python(text), false));
    }

    fn recordings(&self, notes: &Notes) {
        for note in notes.iter() {
            self.send(Message::Note(in_python(&format!("{}: {}", note.file, note.text)), note.weight == "warning"));
        }
    }
}

/// A complete diagnosis.
#[pyclass(frozen, module = "jointwise._core")]
pub struct Outcome {
    study: Diagnosed,
}

#[pymethods]
impl Outcome {
    /// The report as `testbed diagnose --json` writes it, without the newline at the end.
    fn json(&self) -> PyResult<String> {
        let json = serde_json::to_string_pretty(&self.study.diagnosis.report);
        json.map_err(|error| JointwiseError::new_err(error.to_string()))
    }

    /// The report as the terminal shows it.
    fn text(&self, everything: bool) -> String {
        let report = &self.study.diagnosis.report;
        if everything {
            report::terminal::complete(report, &self.study.arm)
        } else {
            report::terminal::diagnosis(report)
        }
    }

    /// The report as an HTML page.
    fn page(&self, py: Python<'_>) -> String {
        let Diagnosed { arm, diagnosis, .. } = &self.study;
        py.detach(|| report::page(&diagnosis.report, &diagnosis.traces, arm))
    }

    /// The corrected model as TOML.
    fn toml(&self) -> PyResult<String> {
        self.searched()?;
        let file = EffectFile { robot: Some(self.study.arm.name().to_owned()), effects: self.study.effects.clone() };
        file.to_text().map_err(|error| raised(&error))
    }

    /// The corrected model as URDF, and what it cannot hold.
    fn urdf(&self) -> PyResult<(String, Vec<String>)> {
        self.searched()?;
        let Diagnosed { robot, arm, effects, .. } = &self.study;
        let export = urdf_file::corrected_urdf(&robot.text, arm, effects).map_err(|error| raised(&error))?;
        Ok((export.text, export.omitted))
    }

    /// The corrected model as MJCF, and what it cannot hold.
    fn mjcf(&self) -> PyResult<(String, Vec<String>)> {
        self.searched()?;
        let export = mjcf_file::mjcf(&self.study.arm, &self.study.effects).map_err(|error| raised(&error))?;
        Ok((export.text, export.omitted))
    }
}

impl Outcome {
    /// Refuses a diagnosis without a corrected model, because units must be corrected first.
    fn searched(&self) -> PyResult<()> {
        if !self.study.diagnosis.report.doubts.is_empty() {
            let text = "there is no corrected model, because no effect was searched: see `doubts`, and correct the recordings' units, \
                        signs, order or zeros first";
            return Err(JointwiseError::new_err(text));
        }
        Ok(())
    }
}

/// An outcome or an exception, and the notes (each with whether it is a warning).
type Answer = (Option<Outcome>, Option<PyErr>, Vec<(String, bool)>);

/// Diagnoses: the outcome or the exception, and the notes (each with whether it is a warning).
#[pyfunction]
#[pyo3(signature = (
    urdf, before, train, held_out, *, base, tip, locks, column_map, known_file, known_text, only, urdf_friction, cutoff,
    torque_lag, urdf_accuracy, torque_accuracy, as_read, torques_only, next_experiment, threads, progress
))]
#[expect(clippy::too_many_arguments, reason = "the Python function gives them by name")]
pub fn diagnose(
    py: Python<'_>,
    urdf: String,
    before: Vec<GivenRecording<'_>>,
    train: Vec<GivenRecording<'_>>,
    held_out: Vec<GivenRecording<'_>>,
    base: Option<String>,
    tip: Option<String>,
    locks: Vec<(String, f64)>,
    column_map: Option<PathBuf>,
    known_file: Option<PathBuf>,
    known_text: Option<String>,
    only: Option<String>,
    urdf_friction: &str,
    cutoff: Option<f64>,
    torque_lag: Option<f64>,
    urdf_accuracy: Option<f64>,
    torque_accuracy: Option<f64>,
    as_read: bool,
    torques_only: bool,
    next_experiment: bool,
    threads: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<Answer> {
    let urdf_friction = match urdf_friction {
        "diagnosed" => UrdfFriction::Diagnosed,
        "known" => UrdfFriction::Known,
        "ignored" => UrdfFriction::Ignored,
        other => {
            return Err(JointwiseError::new_err(format!(
                "urdf_friction is \"{other}\"; give one of diagnosed, known, ignored"
            )));
        }
    };
    let request = Request {
        robot: urdf,
        chain: ChainOptions { base, tip, locks, recorded: Vec::new() },
        recordings: Recordings {
            before: all_given(before)?,
            train: all_given(train)?,
            held_out: all_given(held_out)?,
            map: column_map,
        },
        known: known_file.map(Known::File).or(known_text.map(Known::Text)),
        only,
        urdf_friction,
        cutoff,
        torque_lag,
        urdf_accuracy,
        torque_accuracy,
        as_read,
        torques_only,
        next: next_experiment,
    };
    let (sender, receiver) = channel();
    let is_abandoned = Arc::new(AtomicBool::new(false));
    let channel = Channel { sender, is_abandoned: Arc::clone(&is_abandoned) };
    let run = move || {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.context("starting threads")?.install(|| request.run(&channel))
    };
    let worker = std::thread::Builder::new().name("jointwise".to_owned()).spawn(run)?;
    let notes = listen(py, receiver, progress.as_ref()).inspect_err(|_| is_abandoned.store(true, Ordering::Relaxed))?;
    match py.detach(|| worker.join()) {
        Ok(Ok(study)) => Ok((Some(Outcome { study }), None, notes)),
        Ok(Err(error)) => Ok((None, Some(raised(&error)), notes)),
        // A panic is a bug; its message is passed on.
        Err(panic) => std::panic::resume_unwind(panic),
    }
}

/// The notes of a diagnosis, after its end.
///
/// # Errors
/// The exception of Ctrl-C, or of `progress`.
fn listen(
    py: Python<'_>,
    mut receiver: Receiver<Message>,
    progress: Option<&Py<PyAny>>,
) -> PyResult<Vec<(String, bool)>> {
    let mut notes = Vec::new();
    loop {
        py.check_signals()?;
        let (back, message) = py.detach(move || {
            let message = receiver.recv_timeout(LISTENING);
            (receiver, message)
        });
        receiver = back;
        match message {
            Ok(Message::Note(text, is_warning)) => notes.push((text, is_warning)),
            Ok(Message::Doing(what)) => {
                if let Some(progress) = progress {
                    progress.call1(py, (what,))?;
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Ok(notes),
        }
    }
}
