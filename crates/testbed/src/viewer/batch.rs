//! The rows that go to Rerun together, by columns.

use arm::{Arm, Pose};
use rerun::{EntityPath, RecordingStream, RecordingStreamResult, Scalars, TimeColumn, Transform3D};

use super::joint_entity;
use crate::telemetry::Sample;

/// The timeline: time since the start of the run.
pub const TIMELINE: &str = "time";

/// The plotted quantities of one joint, by their place under the joint's entity.
pub const SCALARS: [&str; 7] = [
    "position/actual",
    "position/reference",
    "error",
    "torque/applied",
    "torque/feedback",
    "torque/learned",
    "torque/model",
];

/// The two arms under `world`.
pub const ARMS: [&str; 2] = ["actual", "reference"];

/// A table: the time of every row (s), and columns of equal length.
#[derive(Debug)]
pub struct Columns<T> {
    times: Vec<f64>,
    columns: Vec<Vec<T>>,
}

impl<T> Columns<T> {
    fn new(width: usize) -> Self {
        Self { times: Vec::new(), columns: (0..width).map(|_| Vec::new()).collect() }
    }

    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.times.len()
    }

    /// Adds a row; `row` has one entry per column.
    pub fn push(&mut self, time: f64, row: impl IntoIterator<Item = T>) {
        self.times.push(time);
        for (column, value) in self.columns.iter_mut().zip(row) {
            column.push(value);
        }
    }

    fn time_column(&self) -> TimeColumn {
        TimeColumn::new_duration_secs(TIMELINE, self.times.iter().copied())
    }
}

/// Some rows of a run.
#[derive(Debug)]
pub struct Batch {
    /// [`SCALARS`] of the first joint, then of the second, and so on.
    pub scalars: Columns<f64>,
    /// `base_from_link` of every link, for each of [`ARMS`].
    pub poses: [Columns<Pose>; 2],
    /// The variance of every joint.
    pub variance: Columns<f64>,
}

impl Batch {
    /// No rows yet.
    pub fn new(dof: usize) -> Self {
        Self {
            scalars: Columns::new(dof * SCALARS.len()),
            poses: [Columns::new(dof), Columns::new(dof)],
            variance: Columns::new(dof),
        }
    }

    /// Adds one step's scalars; the error is in thousandths (mrad or mm).
    pub fn push_scalars(&mut self, sample: &Sample<'_>) {
        let row = (0..sample.q.len()).flat_map(|i| {
            [
                sample.q[i],
                sample.q_ref[i],
                1e3 * (sample.q_ref[i] - sample.q[i]),
                sample.tau_applied[i],
                sample.tau_feedback[i],
                sample.tau_learned[i],
                sample.tau_rigid[i],
            ]
        });
        self.scalars.push(sample.time, row);
    }

    /// Logs all rows.
    pub fn send(&self, recording: &RecordingStream, arm: &Arm) -> RecordingStreamResult<()> {
        let time = self.scalars.time_column();
        let variance_time = self.variance.time_column();
        for (i, joint) in arm.joints().iter().enumerate() {
            let entity = joint_entity(&joint.name);
            for (quantity, name) in SCALARS.iter().enumerate() {
                let values = &self.scalars.columns[i * SCALARS.len() + quantity];
                send_scalars(recording, entity.join(&EntityPath::from(*name)), &time, values)?;
            }
            let entity = entity.join(&EntityPath::from("variance"));
            send_scalars(recording, entity, &variance_time, &self.variance.columns[i])?;
        }
        for (poses, arm) in self.poses.iter().zip(ARMS) {
            let time = poses.time_column();
            for (i, column) in poses.columns.iter().enumerate() {
                send_poses(recording, link_entity(arm, Some(i)), &time, column)?;
            }
        }
        Ok(())
    }
}

/// Logs a column of scalars.
pub fn send_scalars(
    recording: &RecordingStream,
    entity: EntityPath,
    time: &TimeColumn,
    values: &[f64],
) -> RecordingStreamResult<()> {
    if values.is_empty() {
        return Ok(());
    }
    let columns = Scalars::new(values.iter().copied()).columns_of_unit_batches()?;
    recording.send_columns(entity, [time.clone()], columns)
}

/// Logs a column of poses.
pub fn send_poses(
    recording: &RecordingStream,
    entity: EntityPath,
    time: &TimeColumn,
    poses: &[Pose],
) -> RecordingStreamResult<()> {
    if poses.is_empty() {
        return Ok(());
    }
    let columns = Transform3D::update_fields()
        .with_many_translation(poses.iter().map(translation))
        .with_many_mat3x3(poses.iter().map(|pose| matrix(pose, [1.0; 3])))
        .columns_of_unit_batches()?;
    recording.send_columns(entity, [time.clone()], columns)
}

/// The entity of a moving link (or of the base) of one of [`ARMS`].
pub fn link_entity(arm: &str, link: Option<usize>) -> EntityPath {
    let name = link.map_or_else(|| "base".to_owned(), |i| format!("link_{}", i + 1));
    EntityPath::from(format!("world/{arm}/{name}"))
}

/// A pose's translation, for Rerun.
pub fn translation(pose: &Pose) -> [f32; 3] {
    let t = &pose.translation;
    [t.x as f32, t.y as f32, t.z as f32]
}

/// A pose's rotation after scaling by `scale`, for Rerun: by columns.
pub fn matrix(pose: &Pose, scale: [f64; 3]) -> [[f32; 3]; 3] {
    let r = &pose.rotation;
    [0, 1, 2].map(|column| [0, 1, 2].map(|row| (r[(row, column)] * scale[column]) as f32))
}
