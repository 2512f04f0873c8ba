//! Random recordings with gaps, lost and repeated rows, jitter, runs, spikes and bad cells: each is read or refused,
//! and the result does not depend on the form of the file.
//!
//! They are drawn with a fixed seed; `PROPTEST_RNG_SEED=7 PROPTEST_CASES=10000` draws other and more recordings.

mod random_table;

use proptest::prelude::*;
use recording::{ColumnMap, Quality, Recording, RecordingError, RegularRecording};

use random_table::{Table, config, tables};

/// The result of reading a file and assigning it to its clock.
fn taken(bytes: &[u8], map: Option<&str>) -> Result<(Recording, RegularRecording), RecordingError> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("r.csv");
    std::fs::write(&path, bytes).expect("it is written");
    let map =
        map.map(|text| ColumnMap::parse(text, "map.toml".as_ref()).unwrap_or_else(|error| panic!("{error}: {text}")));
    let recording = Recording::read_with(&path, map.as_ref())?;
    let (regular, _) = recording.regular()?;
    Ok((recording, regular))
}

/// A recording without the properties of its file: the places of its warnings, and the columns.
fn content(recording: &Recording) -> Recording {
    Recording { warnings: Vec::new(), epoch: None, origin: None, ..recording.clone() }
}

/// Fails unless both have the same bits, or both are refused.
fn is_same(
    a: &Result<(Recording, RegularRecording), RecordingError>,
    b: &Result<(Recording, RegularRecording), RecordingError>,
) -> Result<(), TestCaseError> {
    match (a, b) {
        (Ok(a), Ok(b)) => {
            prop_assert_eq!(content(&a.0), content(&b.0));
            prop_assert_eq!(&a.1, &b.1);
        }
        (Err(_), Err(_)) => {}
        (a, b) => prop_assert!(false, "{:?} and {:?}", a.as_ref().err(), b.as_ref().err()),
    }
    Ok(())
}

/// Fails if two signals differ by more than rounding.
fn is_near(a: &[Vec<f64>], b: &[Vec<f64>], factor: f64, offset: f64) -> Result<(), TestCaseError> {
    for (a, b) in a.iter().zip(b) {
        prop_assert_eq!(a.len(), b.len());
        for (a, b) in a.iter().zip(b) {
            prop_assert!((a * factor + offset - b).abs() <= 1e-9 * (1.0 + b.abs()), "{} {}", a, b);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(config())]

    /// All values are finite, time increases, every tick is in one segment, and the quality can be computed.
    #[test]
    fn whatever_is_in_the_rows_is_read_or_refused(table in tables(true)) {
        match taken(&table.csv(), None) {
            Err(error) => {
                let text = error.to_string();
                prop_assert!(text.contains("r.csv") || text.contains("stamps") || text.contains("rows"), "{}", text);
            }
            Ok((recording, regular)) => {
                prop_assert!(recording.time.windows(2).all(|pair| pair[0] < pair[1]));
                prop_assert!(regular.period > 0.0 && regular.period.is_finite());
                let mut next = 0;
                for segment in &regular.segments {
                    prop_assert_eq!(segment.ticks.start, next);
                    prop_assert!(segment.ticks.end > next);
                    next = segment.ticks.end;
                }
                prop_assert_eq!(next, regular.len());
                prop_assert!(regular.times().collect::<Vec<_>>().windows(2).all(|pair| pair[0] < pair[1]));
                for signal in [&regular.q, &regular.tau].into_iter().chain(&regular.qd) {
                    prop_assert_eq!(signal.len(), table.joints.len());
                    prop_assert!(signal.iter().all(|values| values.len() == next && values.iter().all(|value| value.is_finite())));
                }
                // The sum of the absolute weights of an interpolation is at most twenty.
                for (recorded, on_ticks) in recording.q.iter().zip(&regular.q) {
                    let [low, high] = [f64::min, f64::max].map(|f| recorded.iter().copied().fold(recorded[0], f));
                    let room = 9.5 * (high - low) + 1e-9 * (1.0 + low.abs().max(high.abs()));
                    prop_assert!(on_ticks.iter().all(|q| (low - room..=high + room).contains(q)));
                }
                let quality = Quality::of(&recording, &regular);
                prop_assert!(quality.rate > 0.0 && quality.longest_gap >= 0.0 && quality.jitter_rms <= quality.jitter_max + 1e-12);
            }
        }
    }

    /// Line ends, byte order mark, separator, compression and spaces do not change the recording.
    #[test]
    fn the_form_of_the_file_changes_nothing(table in tables(true)) {
        let plain = table.csv();
        let text = String::from_utf8(plain.clone()).expect("it is text");
        let first = taken(&plain, None);
        is_same(&first, &taken(text.replace('\n', "\r\n").as_bytes(), None))?;
        is_same(&first, &taken(format!("\u{feff}{text}").as_bytes(), None))?;
        is_same(&first, &taken(text.replace(',', ";").as_bytes(), None))?;
        is_same(&first, &taken(text.replace(',', "\t").as_bytes(), None))?;
        let packed = zstd::encode_all(&plain[..], 1).expect("it is packed");
        is_same(&first, &taken(&packed, None))?;
    }

    #[test]
    fn the_order_of_the_columns_changes_nothing_but_the_joints_order(table in tables(true), by in 0..20_usize) {
        let first = taken(&table.csv(), None);
        let turned = taken(&table.with_turned_columns(by).csv(), None);
        if let (Ok(a), Ok(b)) = (&first, &turned) {
            prop_assert_eq!(&a.0.time, &b.0.time);
            prop_assert_eq!(&a.1.segments, &b.1.segments);
            for (joint, name) in a.1.joints.iter().enumerate() {
                let other = b.1.joints.iter().position(|other| other == name).expect("it is there");
                prop_assert_eq!(&a.1.q[joint], &b.1.q[other]);
                prop_assert_eq!(&a.1.tau[joint], &b.1.tau[other]);
            }
        }
        prop_assert_eq!(first.is_ok(), turned.is_ok());
    }

    #[test]
    fn names_of_joints_are_only_names(table in tables(true)) {
        let mut renamed = table.clone();
        renamed.joints = (0..table.joints.len()).map(|k| format!("glied {k}")).collect();
        let (first, second) = (taken(&table.csv(), None), taken(&renamed.csv(), None));
        let named = second.map(|(mut recording, mut regular)| {
            recording.joints.clone_from(&table.joints);
            regular.joints.clone_from(&table.joints);
            (recording, regular)
        });
        is_same(&first, &named)?;
    }

    /// A logger that writes every row twice, and one that writes each sample three times with new stamps.
    #[test]
    fn rows_that_are_there_twice_are_taken_once(table in tables(false)) {
        let mut doubled = table.clone();
        doubled.rows = table.rows.iter().flat_map(|row| [row.clone(), row.clone()]).collect();
        is_same(&taken(&table.csv(), None), &taken(&doubled.csv(), None))?;
    }

    #[test]
    fn a_written_recording_reads_back_to_the_same_bits(table in tables(false)) {
        if let Ok((recording, _)) = taken(&table.csv(), None) {
            let folder = tempfile::tempdir().expect("a folder");
            let path = folder.path().join("w.csv");
            recording.write_csv(&path).expect("it is written");
            // Runs are separated by pauses; the column that numbered them is removed.
            let again = Recording::read(&path).expect("it is read");
            prop_assert_eq!(Recording { breaks: again.breaks.clone(), ..content(&recording) }, content(&again));
        }
    }

    /// A mirrored arm: the opposite signs of positions and torques give the same recording with opposite signs.
    #[test]
    fn the_sign_changes_nothing_but_the_sign(table in tables(false)) {
        let mut mirrored = table.clone();
        for row in &mut mirrored.rows {
            for value in &mut row[1..] {
                *value = -*value;
            }
        }
        match (taken(&table.csv(), None), taken(&mirrored.csv(), None)) {
            (Ok((_, a)), Ok((_, b))) => {
                prop_assert_eq!(&a.segments, &b.segments);
                for (a, b) in a.q.iter().chain(&a.tau).zip(b.q.iter().chain(&b.tau)) {
                    prop_assert!(a.iter().zip(b).all(|(a, b)| *a == -b));
                }
            }
            (a, b) => prop_assert_eq!(a.is_ok(), b.is_ok()),
        }
    }

    /// Degrees, milliseconds and counts of a gear give the same motion through a column map.
    #[test]
    fn units_of_a_column_map_change_nothing(mut table in tables(false)) {
        // Seconds since 1970 would lose digits when multiplied.
        let start = table.rows[0][0];
        for row in &mut table.rows {
            row[0] -= start;
        }
        let mut other = table.clone();
        for row in &mut other.rows {
            row[0] *= 1000.0;
            for joint in 0..table.joints.len() {
                row[1 + joint] = (row[1 + joint] - 0.25).to_degrees() * -50.0;
                row[1 + table.joints.len() + joint] /= -50.0;
            }
        }
        let mut map = "[time]\ncolumn = \"t\"\nunit = \"ms\"\n".to_owned();
        for name in &table.joints {
            map += &format!(
                "[joints.{name}]\nq = \"q_{name}\"\nq_unit = \"deg\"\nq_offset = 0.25\ngear = 50\nsign = -1\ntau = \"tau_{name}\"\n"
            );
        }
        match (taken(&table.csv(), None), taken(&other.csv(), Some(&map))) {
            (Ok((_, a)), Ok((_, b))) => {
                prop_assert_eq!(a.len(), b.len());
                is_near(&a.q, &b.q, 1.0, 0.0)?;
                is_near(&a.tau, &b.tau, 1.0, 0.0)?;
                is_near(&[a.times().collect()], &[b.times().collect()], 1.0, 0.0)?;
            }
            (a, b) => prop_assert_eq!(a.is_ok(), b.is_ok()),
        }
    }

    /// A clock with another start gives the same clock.
    #[test]
    fn shifted_time_shifts_the_clock_and_nothing_else(table in tables(false), shift in -50_000..50_000_i32) {
        let shift = f64::from(shift) / 64.0;
        let mut later = table.clone();
        for row in &mut later.rows {
            row[0] += shift;
        }
        match (taken(&table.csv(), None), taken(&later.csv(), None)) {
            (Ok((one, a)), Ok((other, b))) => {
                prop_assert_eq!(a.len(), b.len());
                prop_assert_eq!(&a.present, &b.present);
                is_near(&a.q, &b.q, 1.0, 0.0)?;
                is_near(&a.tau, &b.tau, 1.0, 0.0)?;
                // Stamps that are dates are counted from a whole second.
                let epoch = |recording: &Recording| recording.epoch.unwrap_or(0) as f64;
                let own = shift - (epoch(&other) - epoch(&one));
                is_near(&[a.times().collect()], &[b.times().collect()], 1.0, own)?;
            }
            (a, b) => prop_assert_eq!(a.is_ok(), b.is_ok()),
        }
    }
}

/// The strategies produce both recordings that are read and recordings that are refused.
#[test]
fn most_tables_are_read_and_some_are_refused() {
    use proptest::strategy::ValueTree;
    let mut runner = proptest::test_runner::TestRunner::new(config());
    let mut count = |bad: bool| {
        let draw = |runner: &mut proptest::test_runner::TestRunner| -> Table {
            tables(bad).new_tree(runner).expect("it draws").current()
        };
        (0..100).filter(|_| taken(&draw(&mut runner).csv(), None).is_ok()).count()
    };
    let (clean, spoiled) = (count(false), count(true));
    assert!(clean >= 95 && (40..=90).contains(&spoiled), "{clean} and {spoiled} of 100");
}
