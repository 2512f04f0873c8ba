//! A reference from a recording: its positions, smoothed, with their derivatives.

use std::path::Path;

use anyhow::{Context, ensure};
use arm::Arm;
use diagnosis::{Kernel, LARGEST_CUTOFF};
use recording::{Recording, RegularRecording};
use study::named;
use torque::{Motion, Trajectory};

/// The indices of the joints of `arm`, in its order, among those of `recording`.
///
/// # Errors
/// If the recording lacks one.
pub fn columns(recording: &Recording, arm: &Arm) -> anyhow::Result<Vec<usize>> {
    let column = |joint: &arm::Joint| {
        let index = recording.joints.iter().position(|name| *name == joint.name);
        index.with_context(|| {
            format!(
                "it has no column \"q_{}\"; give a recording of the scenario's robot, or name its columns as the URDF names the joints",
                joint.name
            )
        })
    };
    arm.joints().iter().map(column).collect()
}

/// The distance between points of the reference, in periods of the cut-off.
const POINT: f64 = 0.1;
/// The longest gap that is filled, in periods of the cut-off.
const GAP: f64 = 0.5;
/// A step across a gap is a jump if it is larger than this multiple of the largest step elsewhere.
const JUMP: f64 = 2.0;
/// The least duration of a recording, in periods of the cut-off: the filter needs 2.34 of them.
const LEAST_PERIODS: f64 = 3.0;

/// The motion of the recording at `path`, with the joints of `arm` in its order, and what is doubtful about it. Positions pass a zero-phase low-pass filter with half
/// its power at `cutoff` (Hz); velocities and accelerations are the derivatives of the filtered positions. The filter takes a moment from
/// both ends of the recording.
///
/// # Errors
/// If the recording cannot be read, lacks a joint, has a long gap, or is too short for the filter.
pub fn trajectory(path: &Path, arm: &Arm, cutoff: f64) -> anyhow::Result<(Trajectory, Vec<String>)> {
    let recording = named::read(path, None, Some(arm))?;
    let (regular, warnings) = recording.regular()?;
    let doubts =
        recording.warnings.iter().chain(&warnings).map(|doubt| format!("{}: {doubt}", path.display())).collect();
    let of_file = || path.display().to_string();
    let columns = columns(&recording, arm).with_context(of_file)?;
    let positions = joined(&regular, &columns, GAP / cutoff).with_context(of_file)?;
    let (rate, most) = (1.0 / regular.period, LARGEST_CUTOFF / regular.period);
    ensure!(
        cutoff <= most,
        "{}: it has {rate:.1} rows a second, which allows a reference.cutoff of at most {most:.2} Hz, but it is {cutoff} Hz",
        path.display()
    );
    let seconds = regular.period * positions[0].len() as f64;
    ensure!(
        cutoff * seconds >= LEAST_PERIODS,
        "{}: it has {seconds:.3} s, but a filter of {cutoff} Hz needs {:.3} s; give a longer recording, or a higher reference.cutoff",
        path.display(),
        LEAST_PERIODS / cutoff
    );
    let kernel = Kernel::new(cutoff, regular.period);
    // Closer points would make the acceleration between them sensitive to the rounding of the filter's derivatives.
    let stride = (POINT / cutoff / regular.period).round().max(1.0) as usize;
    let filter = |q: &Vec<f64>| [kernel.smooth(q, stride), kernel.first(q, stride), kernel.second(q, stride)];
    let filtered: Vec<[Vec<f64>; 3]> = positions.iter().map(filter).collect();
    let point = |tick: usize| {
        let of = |order: usize| filtered.iter().map(|joint| joint[order][tick]).collect();
        Motion { q: of(0), qd: of(1), qdd: of(2) }
    };
    let points = (0..filtered[0][0].len()).map(point).collect();
    Ok((Trajectory::new(stride as f64 * regular.period, points).with_context(of_file)?, doubts))
}

/// The positions of the joints in these columns (rad or m), without gaps: short ones, of at most `most` (s), are filled along a line.
///
/// # Errors
/// If there is a longer gap, or a jump.
fn joined(regular: &RegularRecording, columns: &[usize], most: f64) -> anyhow::Result<Vec<Vec<f64>>> {
    let of_joint = |&column: &usize| {
        let q = &regular.q[column];
        let steps = regular.segments.iter().flat_map(|segment| q[segment.ticks.clone()].windows(2));
        let largest = steps.map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        let mut positions: Vec<f64> = Vec::with_capacity(q.len());
        for segment in &regular.segments {
            let ticks = segment.ticks.clone();
            if let Some(&before) = positions.last() {
                let end = regular.time(ticks.start - 1);
                let gap = segment.start - end;
                let (count, step) = ((gap / regular.period).round().max(1.0), q[ticks.start] - before);
                ensure!(
                    gap <= most && step.abs() <= JUMP * count * largest,
                    "its positions are not continuous from {end:.3} s to {:.3} s (a gap, a jump, or another run); give the rows on one \
                     side of that",
                    segment.start
                );
                positions.extend((1..count as usize).map(|k| before + step * k as f64 / count));
            }
            positions.extend_from_slice(&q[ticks]);
        }
        Ok(positions)
    };
    columns.iter().map(of_joint).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;
    use std::fmt::Write;

    use super::super::Scenario;

    /// The position of every joint of the recording (rad).
    fn position(time: f64) -> f64 {
        0.2 + 0.5 * (TAU * 0.7 * time).sin()
    }

    /// A scenario with the [reference] table `table`, beside a recording of the PUMA 560 with these `rows` of 4 ms.
    fn loaded(rows: impl Iterator<Item = usize>, table: &str) -> anyhow::Result<Scenario> {
        let folder = tempfile::tempdir()?;
        let mut text = String::from("t");
        (1..=6).for_each(|joint| _ = write!(text, ",q_joint{joint}"));
        (1..=6).for_each(|joint| _ = write!(text, ",tau_joint{joint}"));
        for row in rows {
            let time = 0.004 * row as f64;
            _ = write!(text, "\n{time}{}{}", format!(",{}", position(time)).repeat(6), ",0".repeat(6));
        }
        std::fs::write(folder.path().join("motion.csv"), text + "\n")?;
        let file = folder.path().join("follow.toml");
        std::fs::write(&file, format!("robot = \"puma560\"\nduration = 4.0\n[reference]\n{table}\n"))?;
        Scenario::load(&file.display().to_string())
    }

    #[test]
    fn a_recorded_motion_is_followed_with_its_derivatives() {
        let scenario = loaded(0..1100, "file = \"motion.csv\"").expect("it is a scenario");
        let mut motion = torque::Motion::new(6);
        scenario.reference.at(0.0, &mut motion);
        // The filter needs a moment of the recording before the motion begins.
        let begins = ((motion.q[0] - 0.2) / 0.5).asin() / (TAU * 0.7);
        assert!((0.05..0.2).contains(&begins), "{begins}");
        for time in [0.0, 0.0013, 1.0, 2.4567, 4.0] {
            scenario.reference.at(time, &mut motion);
            let angle = TAU * 0.7 * (time + begins);
            for joint in [0, 5] {
                assert!((motion.q[joint] - position(time + begins)).abs() < 1e-4);
                assert!((motion.qd[joint] - 0.5 * TAU * 0.7 * angle.cos()).abs() < 1e-3);
                assert!((motion.qdd[joint] + 0.5 * (TAU * 0.7).powi(2) * angle.sin()).abs() < 1e-2);
            }
        }
    }

    /// A centre moves the whole motion, and a fade lets it begin and end at rest there.
    #[test]
    fn a_recorded_motion_can_be_moved_and_faded() {
        let table = "file = \"motion.csv\"\ncutoff = 5.0\ncentre = 1.0\nfade = 1.0";
        let scenario = loaded(0..1200, table).expect("it is a scenario");
        let mut motion = torque::Motion::new(6);
        for time in [0.0, 4.0] {
            scenario.reference.at(time, &mut motion);
            assert_eq!((motion.q[3], motion.qd[3]), (1.0, 0.0));
        }
    }

    /// As where a logger was busy for 44 ms, less than half a period of the cut-off.
    #[test]
    fn a_short_gap_is_filled() {
        let scenario = loaded((0..500).chain(510..1100), "file = \"motion.csv\"").expect("it is a scenario");
        let (mut motion, mut whole) = (torque::Motion::new(6), torque::Motion::new(6));
        let without = loaded(0..1100, "file = \"motion.csv\"").expect("it is a scenario");
        for time in [1.5, 1.9, 2.5, 4.0] {
            scenario.reference.at(time, &mut motion);
            without.reference.at(time, &mut whole);
            assert!((motion.q[0] - whole.q[0]).abs() < 2e-3, "{time}: {} {}", motion.q[0], whole.q[0]);
        }
    }

    #[test]
    fn what_cannot_be_followed_is_refused_with_a_remedy() {
        let refused = |rows: Vec<usize>, table: &str| match loaded(rows.into_iter(), table) {
            Ok(_) => panic!("{table} is a scenario"),
            Err(error) => format!("{error:#}"),
        };
        let whole = || (0..1100).collect();
        let file = "file = \"motion.csv\"";
        for (rows, table, expected) in [
            (whole(), "cutoff = 5.0", "reference.file, which is not given"),
            (whole(), "file = \"other.csv\"", "other.csv"),
            (whole(), "file = \"motion.csv\"\ncutoff = 100.0", "reference.cutoff of at most 58.75 Hz"),
            (whole(), "file = \"motion.csv\"\ncutoff = -1.0", "give more than 0"),
            ((0..500).collect(), file, "give a duration of at most that"),
            ((0..20).collect(), file, "give a longer recording"),
            ((0..500).chain(900..1500).collect(), file, "not continuous from 1.996 s to 3.600 s"),
        ] {
            let error = refused(rows, table);
            assert!(error.contains(expected) && error.contains("follow.toml:"), "{table}: {error}");
        }
    }
}
