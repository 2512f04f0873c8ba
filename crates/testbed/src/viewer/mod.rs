//! A run in Rerun: the arm in 3D and one plot per joint, in a file or in a viewer that may disappear during the run.
//!
//! Entities: `world/{actual,reference}/link_<i>`, and for every joint `joint/<name>/` with
//! `position/{actual,reference}`, `error`, `torque/{applied,feedback,learned,model}`, `variance`.

pub mod batch;
mod blueprint;
pub mod end;
mod file;
pub mod layout;
mod mesh;
pub mod shapes;
mod stream;
mod worker;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use arm::Arm;

use crate::telemetry::Sample;
use batch::Batch;
use stream::{Sent, Stream};

/// Time between two logged poses and two rows of scalars (s).
const POSE_PERIOD: f64 = 1.0 / 60.0;
const SCALAR_PERIOD: f64 = 1.0 / 100.0;
/// The number of rows of scalars in one batch of a file.
const FILE_ROWS: usize = 500;
/// Wall-clock time between two batches to a live viewer.
const LIVE_PERIOD: Duration = Duration::from_millis(100);

/// The destination of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Sink {
    /// An `.rrd` file, which needs no viewer.
    Save(PathBuf),
    /// A viewer that is started from the `PATH`, or one that already listens at the default port.
    Spawn,
    /// A viewer that listens at this address (`host:port` or a `rerun+http://` URL), by default at Rerun's own.
    Connect(Option<String>),
}

/// The connection of a run to a viewer or a file.
///
/// A remote viewer that is slow, has ended or never existed causes at most one warning and a bounded wait in
/// [`Self::finish`].
pub struct Viewer {
    stream: Stream,
    arm: Arm,
    workspace: arm::Workspace,
    batch: Batch,
    last_push: Instant,
    next_scalar: f64,
    next_pose: f64,
}

impl Viewer {
    /// Opens `sink` and sends the static scene and the layout; `title` names the recording, and meshes are searched from
    /// the folder of `urdf_path`.
    ///
    /// # Errors
    /// If the file cannot be created, no `rerun` is found, or the address is invalid. A viewer that does not answer is not
    /// an error, because it may be started later.
    pub fn open(sink: &Sink, title: &str, arm: &Arm, urdf_path: &Path) -> anyhow::Result<Self> {
        Ok(Self {
            stream: Stream::open(sink, title, arm, urdf_path)?,
            arm: arm.clone(),
            workspace: arm::Workspace::new(arm),
            batch: Batch::new(arm.dof()),
            last_push: Instant::now(),
            next_scalar: f64::NEG_INFINITY,
            next_pose: f64::NEG_INFINITY,
        })
    }

    /// Logs one control step. It must be called at every step; only steps at the rate of the display are kept.
    pub fn log(&mut self, sample: &Sample<'_>) {
        if !self.stream.is_alive() {
            return;
        }
        if let Some(variance) = sample.variance {
            self.batch.variance.push(sample.time, variance.iter().copied());
        }
        if is_due(sample.time, &mut self.next_pose, POSE_PERIOD) {
            self.push_poses(sample);
        }
        if is_due(sample.time, &mut self.next_scalar, SCALAR_PERIOD) {
            self.batch.push_scalars(sample);
            let is_full = if self.stream.is_live() {
                self.last_push.elapsed() >= LIVE_PERIOD
            } else {
                self.batch.scalars.len() >= FILE_ROWS
            };
            if is_full {
                self.push();
            }
        }
    }

    /// Sends the remaining rows and closes; waits at most a few seconds for a live viewer.
    ///
    /// # Errors
    /// If a file could not be written; it is then absent. A lost viewer is a warning.
    pub fn finish(mut self) -> anyhow::Result<()> {
        let rest = self.take_batch();
        self.stream.finish(rest)
    }

    fn push_poses(&mut self, sample: &Sample<'_>) {
        for (columns, q) in [(0, sample.q), (1, sample.q_ref)] {
            self.arm.forward_kinematics(&mut self.workspace, q);
            let poses = (0..self.arm.dof()).map(|link| *self.workspace.base_from_link(link));
            self.batch.poses[columns].push(sample.time, poses);
        }
    }

    fn take_batch(&mut self) -> Batch {
        std::mem::replace(&mut self.batch, Batch::new(self.arm.dof()))
    }

    fn push(&mut self) {
        let batch = self.take_batch();
        if let Sent::Busy(batch) = self.stream.send(batch) {
            self.batch = batch;
        }
        self.last_push = Instant::now();
    }
}

/// Whether `time` has reached `next`, which then moves on by whole periods.
fn is_due(time: f64, next: &mut f64, period: f64) -> bool {
    let slack = 1e-6;
    if time + slack < *next {
        return false;
    }
    *next = if time - *next < period { *next + period } else { time + period };
    true
}

/// The entity that holds everything of one joint.
pub fn joint_entity(name: &str) -> rerun::EntityPath {
    rerun::EntityPath::from(vec!["joint".into(), rerun::EntityPathPart::new(name)])
}

#[cfg(test)]
mod tests {
    use super::*;

    const URDF: &str = r#"<robot name="one"><link name="base"/><link name="rod"><inertial><mass value="1"/>
        <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
        <joint name="turn" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/></joint></robot>"#;

    fn viewer(path: &Path) -> Viewer {
        let arm = Arm::from_urdf_text(URDF, "one.urdf").expect("an arm");
        let sink = Sink::Save(path.to_owned());
        let mut viewer = Viewer::open(&sink, "a test", &arm, Path::new("one.urdf")).expect("a viewer");
        for k in 0..2000 {
            let q = [f64::from(k) * 1e-3];
            viewer.log(&Sample {
                time: f64::from(k) * 1e-3,
                q: &q,
                q_ref: &q,
                tau_rigid: &[0.0],
                tau_learned: &[0.0],
                tau_feedback: &[0.0],
                tau_applied: &[0.0],
                variance: (k % 20 == 0).then_some(&[0.1]),
            });
        }
        viewer
    }

    #[test]
    fn a_file_is_whole_or_absent() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("run.rrd");
        drop(viewer(&path));
        assert_eq!(folder.path().read_dir().expect("a folder").count(), 0);

        viewer(&path).finish().expect("a file");
        assert_eq!(folder.path().read_dir().expect("a folder").count(), 1);
        let bytes = std::fs::read(&path).expect("a file");
        assert!(bytes.starts_with(b"RRF2") && bytes.len() > 10_000);
    }

    #[test]
    fn a_file_that_cannot_be_created_is_an_error_at_once() {
        let folder = tempfile::tempdir().expect("a folder");
        let arm = Arm::from_urdf_text(URDF, "one.urdf").expect("an arm");
        let sink = Sink::Save(folder.path().join("run.rrd/below"));
        std::fs::write(folder.path().join("run.rrd"), "").expect("a file");
        assert!(Viewer::open(&sink, "a test", &arm, Path::new("one.urdf")).is_err());
    }

    #[test]
    fn rows_have_their_rate_for_any_control_period() {
        for (period, steps) in [(1e-3, 10_000), (0.75e-3, 13_334), (4e-3, 2500)] {
            let mut next = f64::NEG_INFINITY;
            let rows = (0..steps).filter(|&k| is_due(f64::from(k) * period, &mut next, SCALAR_PERIOD));
            let rows = rows.count();
            assert!((990..=1010).contains(&rows), "{rows} rows in 10 s at a period of {period} s");
        }
    }
}
