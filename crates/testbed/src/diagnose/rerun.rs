//! The diagnosis in Rerun: the recorded motion, torques and residuals on a timeline, the named effects beside them.
//!
//! Entities: `world/actual/link_<i>` with `mismatch` (a ball, the redder the larger the residual), and for every joint
//! `joint/<name>/` with `torque/{measured,model,named}`, `residual/{before,after}` and `effect/<number>`.

mod layout;

use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail};
use arm::{Arm, Workspace};
use diagnosis::{Report, Trace, Traces};
use rerun::components::FillMode;
use rerun::{Color, Ellipsoids3D, EntityPath, RecordingStream, TextDocument, TimeColumn};

use crate::viewer::batch::{ARMS, TIMELINE, link_entity, send_poses, send_scalars};
use crate::viewer::end::End;
use crate::viewer::shapes::{self, reach};
use crate::viewer::{Sink, joint_entity};

/// Where the summary is logged to.
const SUMMARY: &str = "summary";
/// The most rows that one recording shows.
const MOST_ROWS: usize = 20_000;
/// The time between two poses (s), and the pause between two recordings whose times overlap.
const POSE_PERIOD: f64 = 1.0 / 30.0;
const PAUSE: f64 = 1.0;
/// The time that a viewer has for the whole diagnosis.
const PATIENCE: Duration = Duration::from_secs(20);

/// Shows the diagnosis in `sink`; meshes are searched from the folder of `urdf_path`.
///
/// # Errors
/// If a file cannot be written (it is then absent), or no viewer answers.
pub fn write(sink: &Sink, report: &Report, traces: &Traces, arm: &Arm, urdf_path: &Path) -> anyhow::Result<()> {
    let title = format!("diagnosis of {}", report.robot);
    let (end, _) = End::open(sink)?;
    let recording = end.record(&title, arm)?;
    let shown = Shown { recording: &recording, report, traces, arm };
    let result = shown.log(&title, urdf_path);
    match end {
        End::File(file) => {
            let result = result.and_then(|()| recording.flush_blocking().context("writing the recording"));
            drop(recording);
            let result = result.and_then(|()| file.finish());
            file.abandon();
            result
        }
        End::Remote(uri) => {
            let deadline = Instant::now() + PATIENCE;
            while result.is_ok() && recording.flush_with_timeout(Duration::from_millis(500)).is_err() {
                if Instant::now() > deadline {
                    // Dropping it would wait for the viewer.
                    std::mem::forget(recording);
                    bail!("no viewer answers at {uri}: the diagnosis is not shown");
                }
                std::thread::sleep(Duration::from_millis(20));
            }
            result
        }
    }
}

struct Shown<'a> {
    recording: &'a RecordingStream,
    report: &'a Report,
    traces: &'a Traces,
    arm: &'a Arm,
}

impl Shown<'_> {
    fn log(&self, title: &str, urdf_path: &Path) -> anyhow::Result<()> {
        self.recording.send_recording_name(title)?;
        shapes::log_scene(self.recording, self.arm, urdf_path, &ARMS[..1])?;
        let starts = self.starts();
        let summary = TextDocument::from_markdown(self.summary(&starts));
        self.recording.log_static(SUMMARY, &summary)?;
        layout::log_styles(self.recording, self.arm, self.report)?;
        layout::send(self.recording, self.arm, self.report, self.span(&starts))?;
        for (trace, start) in self.traces.recordings.iter().zip(starts) {
            self.log_signals(trace, start)?;
            self.log_motion(trace, start)?;
        }
        Ok(())
    }

    /// The time to add to each recording: zero if the recordings do not overlap; otherwise they follow each other.
    fn starts(&self) -> Vec<f64> {
        let ends = |trace: &Trace| Some([*trace.time.first()?, *trace.time.last()?]);
        let all: Vec<Option<[f64; 2]>> = self.traces.recordings.iter().map(ends).collect();
        let mut known: Vec<[f64; 2]> = all.iter().flatten().copied().collect();
        known.sort_by(|a, b| a[0].total_cmp(&b[0]));
        if known.windows(2).all(|pair| pair[0][1] < pair[1][0]) {
            return vec![0.0; all.len()];
        }
        let mut next = 0.0;
        let shift = |ends: Option<[f64; 2]>| {
            let Some([first, last]) = ends else { return 0.0 };
            let start = next - first;
            next += last - first + PAUSE;
            start
        };
        all.into_iter().map(shift).collect()
    }

    /// The time from the first row to the last, with a margin.
    fn span(&self, starts: &[f64]) -> [f64; 2] {
        let mut span = [f64::INFINITY, f64::NEG_INFINITY];
        for (trace, start) in self.traces.recordings.iter().zip(starts) {
            for time in trace.time.first().into_iter().chain(trace.time.last()) {
                span = [span[0].min(time + start), span[1].max(time + start)];
            }
        }
        let margin = 0.02 * (span[1] - span[0]);
        if margin.is_finite() { [span[0] - margin, span[1] + margin] } else { [0.0, 1.0] }
    }

    fn summary(&self, starts: &[f64]) -> String {
        let text = report::terminal::prose(self.report);
        let mut recordings = String::from("\n**Recordings on the timeline**\n");
        for (trace, start) in self.traces.recordings.iter().zip(starts) {
            let (Some(first), Some(last)) = (trace.time.first(), trace.time.last()) else {
                continue;
            };
            let held_out = if trace.held_out { " (held out)" } else { "" };
            recordings += &format!("- {:.1} to {:.1} s: `{}`{held_out}\n", first + start, last + start, trace.name);
        }
        text + &recordings
    }

    fn log_signals(&self, trace: &Trace, start: f64) -> anyhow::Result<()> {
        let step = trace.time.len().div_ceil(MOST_ROWS).max(1);
        // A gap after the last row, so that no line joins two recordings.
        let gap = trace.time.last().map(|last| last + start + 0.01 * PAUSE);
        let times = trace.time.iter().step_by(step).map(|time| time + start).chain(gap);
        let times: Vec<f64> = times.collect();
        let time = TimeColumn::new_duration_secs(TIMELINE, times.iter().copied());
        let send = |entity: EntityPath, values: &mut dyn Iterator<Item = f64>| {
            let mut values: Vec<f64> = values.step_by(step).collect();
            values.push(f64::NAN);
            if values.len() == times.len() { send_scalars(self.recording, entity, &time, &values) } else { Ok(()) }
        };
        for (i, joint) in self.arm.joints().iter().enumerate() {
            let entity = |part: &str| joint_entity(&joint.name).join(&EntityPath::from(part));
            let (Some(tau), Some(before), Some(after)) =
                (trace.tau.get(i), trace.residual.get(i), trace.residual_augmented.get(i))
            else {
                continue;
            };
            let less = |residual: &[f64]| tau.iter().zip(residual).map(|(t, r)| t - r).collect::<Vec<f64>>();
            send(entity("torque/measured"), &mut tau.iter().copied())?;
            send(entity("torque/model"), &mut less(before).into_iter())?;
            send(entity("torque/named"), &mut less(after).into_iter())?;
            send(entity("residual/before"), &mut before.iter().copied())?;
            send(entity("residual/after"), &mut after.iter().copied())?;
            for (number, effect) in trace.effects.iter().enumerate() {
                let Some(effect) = effect.get(i).filter(|effect| !effect.is_empty()) else {
                    continue;
                };
                send(entity(&layout::effect_entity(number)), &mut effect.iter().copied())?;
            }
        }
        Ok(())
    }

    /// The posture, and a ball on each joint in the colour of its residual.
    fn log_motion(&self, trace: &Trace, start: f64) -> anyhow::Result<()> {
        let dof = self.arm.dof();
        let rows = trace.q.iter().map(Vec::len).min().unwrap_or(0).min(trace.time.len());
        if trace.q.len() != dof || rows < 2 {
            return Ok(());
        }
        let period = (trace.time[rows - 1] - trace.time[0]) / (rows - 1) as f64;
        let step = ((POSE_PERIOD / period) as usize).max(rows.div_ceil(MOST_ROWS)).max(1);
        let picked: Vec<usize> = (0..rows).step_by(step).collect();
        let times = picked.iter().map(|&row| trace.time[row] + start);
        let time = TimeColumn::new_duration_secs(TIMELINE, times);
        let mut workspace = Workspace::new(self.arm);
        let mut poses = vec![Vec::with_capacity(picked.len()); dof];
        let mut q = vec![0.0; dof];
        for &row in &picked {
            for joint in 0..dof {
                q[joint] = trace.q[joint][row];
            }
            self.arm.forward_kinematics(&mut workspace, &q);
            for (link, column) in poses.iter_mut().enumerate() {
                column.push(*workspace.base_from_link(link));
            }
        }
        let radius = (0.062 * reach(self.arm)) as f32;
        for (joint, column) in poses.iter().enumerate() {
            let entity = link_entity(ARMS[0], Some(joint));
            send_poses(self.recording, entity.clone(), &time, column)?;
            let ball = entity.join(&"mismatch".into());
            let shape = Ellipsoids3D::from_radii([radius]).with_fill_mode(FillMode::Solid);
            self.recording.log_static(ball.clone(), &shape)?;
            let fit = self.report.fit.get(&self.arm.joints()[joint].name);
            let spread = fit.map_or(1.0, |fit| fit.torque_std).max(f64::MIN_POSITIVE);
            let residual = trace.residual.get(joint);
            let share = |row: &usize| residual.and_then(|r| r.get(*row)).map_or(0.0, |r| r.abs() / spread);
            let colours = picked.iter().map(|row| colour(share(row)));
            let columns = Ellipsoids3D::update_fields().with_colors(colours).columns_of_unit_batches()?;
            self.recording.send_columns(ball, [time.clone()], columns)?;
        }
        Ok(())
    }
}

/// Grey for a small residual, through amber to red for a residual as large as the torque's standard deviation.
fn colour(share: f64) -> Color {
    let stops = [(0.0, [150, 160, 172]), (0.3, [242, 166, 90]), (1.0, [214, 48, 38])];
    let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
    let upper = stops.iter().position(|(at, _)| share <= *at).unwrap_or(2).max(1);
    let ((from, low), (to, high)) = (stops[upper - 1], stops[upper]);
    let part = (share - from) / (to - from);
    let mix = |k: usize| (f64::from(low[k]) + part * (f64::from(high[k]) - f64::from(low[k]))).round() as u8;
    Color::from_rgb(mix(0), mix(1), mix(2))
}

/// The made-up diagnosis of the report's own tests.
#[cfg(test)]
#[path = "../../../report/tests/pages/made_up/mod.rs"]
mod made_up;

#[cfg(test)]
mod tests {
    use super::made_up::{self, Plot};
    use super::*;

    #[test]
    fn a_diagnosis_is_a_whole_file() {
        for (joints, plot) in [(6, Plot::Rich), (1, Plot::Rich), (3, Plot::TooShort)] {
            let folder = tempfile::tempdir().expect("a folder");
            let path = folder.path().join("diagnosis.rrd");
            let (report, traces, arm) = made_up::diagnosis(joints, plot);
            write(&Sink::Save(path.clone()), &report, &traces, &arm, Path::new("six.urdf")).expect("a file");
            let bytes = std::fs::read(&path).expect("a file");
            assert!(bytes.starts_with(b"RRF2") && bytes.len() > 10_000);
            assert_eq!(folder.path().read_dir().expect("a folder").count(), 1);
        }
    }

    #[test]
    fn recordings_on_one_another_follow_each_other() {
        let (report, mut traces, arm) = made_up::diagnosis(1, Plot::Clean);
        let (recording, _storage) = rerun::RecordingStreamBuilder::new("test").memory().expect("a recording");
        let starts = |traces: &Traces| {
            let recording = &recording;
            let arm = &arm;
            let report = &report;
            Shown { recording, report, traces, arm }.starts()
        };
        assert_eq!(starts(&traces), [0.0; 3]);
        for trace in &mut traces.recordings {
            let first = trace.time[0];
            trace.time.iter_mut().for_each(|time| *time -= first);
        }
        let shifted = starts(&traces);
        assert!(shifted[0] == 0.0 && shifted[1] > 20.0 && shifted[2] > 2.0 * shifted[1] - 1.0);
    }
}
