//! CSV files that are written and read again, and files that are refused.

use std::path::PathBuf;

use super::*;
use crate::{Location, Warning};

fn recording() -> Recording {
    Recording {
        joints: vec!["shoulder".into(), "elbow".into()],
        time: vec![0.0, 0.1, 0.2],
        q: vec![vec![0.1, 1.0 / 3.0, -1e-17], vec![1.0, 2.0, 3.0]],
        qd: Some(vec![vec![0.0; 3], vec![5e8; 3]]),
        tau: vec![vec![1.0, -2.0, 3.5], vec![0.0; 3]],
        q_secondary: vec![None, Some(vec![1.0, 2.5, 3.0])],
        temperature: vec![Some(vec![20.0, 20.5, 21.0]); 2],
        others: vec![("mode".into(), vec![1.0, 1.0, 2.0])],
        ..Recording::default()
    }
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn write(folder: &tempfile::TempDir, text: &str) -> PathBuf {
    let path = folder.path().join("r.csv");
    std::fs::write(&path, text).expect("it writes");
    path
}

fn read(text: &str) -> Result<Recording, RecordingError> {
    let folder = folder();
    Recording::read(&write(&folder, text))
}

/// Without the names of the file's columns.
fn without_origin(recording: Recording) -> Recording {
    Recording { origin: None, ..recording }
}

fn refusal(text: &str) -> String {
    read(text).expect_err("it is refused").to_string()
}

#[test]
fn what_is_written_reads_back_to_the_same_bits() {
    let folder = folder();
    let path = folder.path().join("r.csv");
    recording().write_csv(&path).expect("it writes");
    let again = Recording::read(&path).expect("it reads");
    assert_eq!(without_origin(again), recording());
}

#[test]
fn a_bad_file_is_refused_with_its_place() {
    let text = refusal("t,q_a,tau_a\n0,1,2\n1,x,2\n2,1,2\n");
    assert!(text.contains("r.csv:3: column \"q_a\" is \"x\", not a finite number; delete the row"), "{text}");
    for bad in ["NaN", "", "inf", "-Infinity", "1e999", "1,5"] {
        let text = refusal(&format!("t;q_a;tau_a\n0;1;2\n1;1;{bad}\n2;1;2\n"));
        assert!(text.contains("r.csv:3: column \"tau_a\""), "{text}");
    }
    assert!(refusal("t,q_a,tau_a\n0,1,2\n1,1,2\n.5,1,2\n").contains("r.csv:4: time runs back, from 1 s to 0.5 s"));
    assert!(refusal("t,q_a,q_b,tau_a\n0,1,2,3\n").contains("r.csv:1: there is no column \"tau_b\""));
    assert!(refusal("t,q_a,tau_a\n").contains("no rows"));
    assert!(refusal("").contains("r.csv:1"));
    assert!(refusal("t,q_a,tau_a\n0,1,2\n").contains("one row"));
    assert!(refusal("t,q_a,tau_a\n0,1,2\n0,1,2\n").contains("r.csv:1: all 2 rows have the time 0 s"));
    assert!(refusal("t,q_a,tau_a\n0,1\n1,1,2\n2,1,2\n").contains("r.csv:2: the row has 2 cells, the header 3"));
    // Separators after the last cell, as spreadsheets write them, are no cells.
    assert!(!refusal("t,q_a,tau_a\n0,1,2,,\n1,1,2,\n.5,1,2\n").contains("cells"));
    assert!(refusal("t,q_a,tau_a,q_a\n").contains("two columns \"q_a\""));
    let gone = Recording::read(Path::new("/nowhere/r.csv")).expect_err("it is not there").to_string();
    assert!(gone.contains("/nowhere/r.csv: cannot be read"), "{gone}");
}

#[test]
fn what_spreadsheets_and_mistakes_make_of_a_file_is_refused_with_the_remedy() {
    let says = |text: &str, parts: &[&str]| {
        let found = refusal(text);
        assert!(!found.contains('\n') && found.len() < 400, "{found}");
        for part in parts {
            assert!(found.contains(part), "\"{part}\" is missing from: {found}");
        }
    };
    let comma = ["r.csv:2: column \"t\" is \"0,5\", a number with a decimal comma", "decimal point"];
    says("t;q_a;tau_a\n0,5;1,5;2,3\n1,5;1,5;2,3\n", &comma);
    says("t,q_a,tau_a\n\"0,5\",\"1,5\",\"2,3\"\n\"1,5\",\"1,5\",\"2,3\"\n", &comma);
    says("t,q_a,tau_a\n0,5,1,5,2,3\n1,5,1,5,2,3\n", &["r.csv:2", "6 cells", "decimal commas?"]);
    says("0,0.1,0.2\n1,0.1,0.2\n2,0.1,0.2\n", &["r.csv:1: the first line holds numbers", "put a header above it"]);
    says("0,0;0,1;0,2\n", &["r.csv:1: the first line holds numbers"]);
    says("", &["r.csv:1: the file is empty", "q_<joint>"]);
    says("\u{FEFF}\r\n", &["r.csv:1: the file is empty"]);
    says("<?xml version=\"1.0\"?>\n<robot/>", &["r.csv:1: this is XML (a URDF?), not CSV", "--robot"]);
    // Two files that were joined; the second one with a byte order mark.
    for mark in ["", "\u{FEFF}"] {
        says(
            &format!("t,q_a,tau_a\n0,1,2\n1,1,2\n{mark}t,q_a,tau_a\n0,1,2\n"),
            &["r.csv:4: the header is repeated here; delete the line"],
        );
    }
    says(
        "t,\"q_a\nerror: b\",\"tau_a\nerror: b\"\n0,1,2\n1,1,2\n",
        &["r.csv", "the name of the joint \"a\\nerror: b\" holds a line break", "rename its columns"],
    );
    says("t,q_a,tau_a\n0,1,2\n\0\n", &["r.csv:3: there is a zero byte", "UTF-8"]);
    says("t,q_a,tau_a\n0,1,2\n1,\"1,2\n2,1,2\n3,1,2\n", &["r.csv:3: a quotation mark is not closed"]);
    for far in ["1e308", "-1e308", "2e12"] {
        says(&format!("t,q_a,tau_a\n0,1,2\n1,{far},2\n2,1,2\n"), &["r.csv:3: column \"q_a\" is", "far beyond"]);
        says(&format!("t,q_a,tau_a\n0,1,2\n{far}000,1,2\n"), &["r.csv:3: column \"t\""]);
    }
    says("t,q_a,tau_a\n1e-300,1,2\n0,1,2\n1,1,2\n", &["r.csv:3: time runs back, from 1e-300 s"]);
    let folder = folder();
    let latin = write(&folder, "");
    std::fs::write(&latin, b"t,q_\xE9,tau_\xE9\n0,1,2\n1,1,2\n").expect("it writes");
    let found = Recording::read(&latin).expect_err("it is refused").to_string();
    assert!(found.contains("r.csv:1: cell 2 is not UTF-8"), "{found}");
    for order in [u16::to_le_bytes, u16::to_be_bytes] {
        let text = "\u{FEFF}t,q_a,tau_a\n0,1,2\n1,1,2\n";
        let bytes: Vec<u8> = text.encode_utf16().flat_map(order).collect();
        let path = write(&folder, "");
        std::fs::write(&path, bytes).expect("it writes");
        let found = Recording::read(&path).expect_err("it is refused").to_string();
        assert!(found.contains("r.csv:1: the text is UTF-16; save it as UTF-8"), "{found}");
    }
    let found = Recording::read(folder.path()).expect_err("it is refused").to_string();
    assert!(found.contains("it is a folder"), "{found}");
}

/// A clock that is set after the first message, and a glitch of the last one.
#[test]
fn rows_with_stray_stamps_are_left_out_or_refused() {
    let with = |stamp: &dyn Fn(usize) -> f64| -> String {
        let rows = (0..200).map(|row| format!("{},{},2\n", stamp(row), (0.1 * row as f64).sin()));
        format!("t,q_a,tau_a\n{}", rows.collect::<String>())
    };
    let glitch = |at: usize, to: f64| with(&|row| if row == at { to } else { 1.7e9 + 0.25 * row as f64 });
    for (at, first, line) in [(0, 0.25, 2), (199, 0.0, 201)] {
        let read = read(&glitch(at, if at == 0 { 0.0 } else { 9e9 })).expect("it reads");
        assert_eq!((read.len(), read.time[0], read.epoch), (199, first, Some(1_700_000_000)));
        let is_stray = |warning: &Warning| matches!(warning, Warning::StrayStamp { line: place, .. } if *place == Location::Line(line));
        assert!(read.warnings.iter().any(is_stray), "{:?}", read.warnings);
    }
    let within = with(&|row| if row == 120 { 1e14 } else { 0.25 * row as f64 });
    let found = refusal(&within);
    assert!(found.contains("r.csv:122: its time stamp of 100000000000000 s is between 29.75 s and 30.25 s"), "{found}");
    let halves = with(&|row| if row < 100 { row as f64 } else { 4e9 + row as f64 });
    assert!(refusal(&halves).contains("check the column of the time, its unit"), "{}", refusal(&halves));
}

#[test]
fn line_ends_marks_and_spaces_of_other_systems_just_work() {
    let plain = read("t,q_a,tau_a\n0,1,2\n1,1.5,2.5\n").expect("it reads");
    for other in [
        "t,q_a,tau_a\r\n0,1,2\r\n1,1.5,2.5\r\n",
        "\u{FEFF}t,q_a,tau_a\n0,1,2\n1,1.5,2.5\n",
        "\u{FEFF}\"t\";\"q_a\";\"tau_a\"\r\n0;1;2\r\n1;1.5;2.5\r\n",
        " t , q_a,tau_a \n 0, 1 ,2\n1,1.5 , 2.5\n",
        "t\tq_a\ttau_a\n0\t1\t2\n1\t1.5\t2.5\n",
    ] {
        assert_eq!(read(other).expect("it reads"), plain, "{other:?}");
    }
}

#[test]
fn a_file_cut_in_its_last_row_gives_what_is_whole() {
    let whole = "t,q_a,tau_a\n0,1,2.25\n1,1,2.25\n2,1,2.25\n";
    for cut in [1, 2, 4, 5, 6, 7] {
        let read = read(&whole[..whole.len() - cut]).expect("what is whole is used");
        // Without its newline alone, the last row is whole still.
        let rows = if cut == 1 { 3 } else { 2 };
        assert_eq!(read.len(), rows, "cut by {cut}");
        assert_eq!(read.warnings.contains(&Warning::CutFile { line: Location::Line(4) }), cut > 1, "cut by {cut}");
    }
    assert!(refusal("t,q_a,tau_a\n0,1,2\n1,x,2\n2,1,2").contains("r.csv:3"));
}

#[test]
fn a_duplicated_row_is_left_out() {
    let read = read("t,q_a,tau_a\n0,1,2\n1,1,2\n1,1,2\n2,1,2\n").expect("it reads");
    assert_eq!(read.time, [0.0, 1.0, 2.0]);
    let expected = Warning::Duplicates { rows: 1, line: Location::Line(4) };
    assert!(read.warnings.contains(&expected), "{:?}", read.warnings);
}

#[test]
fn rows_with_one_stamp_keep_their_order() {
    let read = read("t,q_a,tau_a\n0,1,2\n1,1,2\n1,2,2\n2,1,2\n").expect("it reads");
    assert_eq!((read.len(), &read.q[0][..]), (4, &[1.0, 1.0, 2.0, 1.0][..]));
    assert!(read.time.is_sorted_by(|a, b| a < b), "{:?}", read.time);
    let expected = Warning::EqualStamps { rows: 1, line: Location::Line(4) };
    assert!(read.warnings.contains(&expected), "{:?}", read.warnings);
    // The rows of two sources in turn are no recording.
    let pair = |k: usize| format!("{k},1,2\n{k},2,2\n");
    let text = refusal(&("t,q_a,tau_a\n".to_owned() + &(0..10).map(pair).collect::<String>()));
    assert!(text.contains("r.csv:3: 10 of 20 rows have the time of the row before"), "{text}");
}

#[test]
fn runs_end_to_end_in_one_file_are_distinguished() {
    let mut text = "t,q_a,tau_a\n".to_owned();
    for _ in 0..2 {
        for k in 0..100 {
            text += &format!("{},1,2\n", f64::from(k) * 0.01);
        }
    }
    let read = read(&text).expect("two runs");
    assert_eq!((read.len(), read.breaks.as_slice()), (200, &[100][..]));
    assert!(read.time.windows(2).all(|pair| pair[1] > pair[0]));
    let found = |warning: &Warning| matches!(warning, Warning::ClockRestart { line: Location::Line(102), .. });
    assert!(read.warnings.iter().any(found), "{:?}", read.warnings);
}

#[test]
fn a_column_that_is_not_needed_may_hold_anything() {
    let read = read("t,q_a,tau_a,mode,n\n0,1,2,3,RUN\n1,1,2,RUN,5\n2,1,2,,6\n").expect("it reads");
    assert!(read.others.is_empty());
    let left_out = |warning: &&Warning| matches!(warning, Warning::ColumnLeftOut { .. });
    assert_eq!(read.warnings.iter().filter(left_out).count(), 2);
}

#[test]
fn a_map_reads_anybodys_columns() {
    let folder = folder();
    let path = write(&folder, "stamp;pos;cur\n0;180;1\n10;90;2\n");
    let map = "[time]\ncolumn = \"stamp\"\nunit = \"ms\"\n[joints.a]\nq = \"pos\"\nq_unit = \"deg\"\nsign = -1\ntau = \"cur\"\n\
               tau_unit = \"A\"\ntau_scale = 12.5\n";
    let map = ColumnMap::parse(map, Path::new("m.toml")).expect("it is good");
    let read = Recording::read_with(&path, Some(&map)).expect("it reads");
    assert_eq!(read.time, [0.0, 0.01]);
    assert!((read.q[0][0] + std::f64::consts::PI).abs() < 1e-15);
    assert_eq!(read.tau[0], [-12.5, -25.0]);
}

#[test]
fn a_file_of_many_rows_is_read_as_means() {
    let folder = folder();
    let mut text = "t,q_a,tau_a,mode\n".to_owned();
    for row in 0..5000 {
        let t = f64::from(row) * 1e-3;
        let mode = if row == 4000 { "x" } else { "1" };
        text += &format!("{t},{},{},{mode}\n", t.sin(), t.cos());
    }
    let path = write(&folder, &text);
    let read = Recording::read_within(&path, None, (4 * 1000, None)).expect("it reads");
    assert_eq!(read.len(), 625);
    for (row, t) in read.time.iter().enumerate() {
        assert!((read.q[0][row] - t.sin()).abs() < 1e-5 && (read.tau[0][row] - t.cos()).abs() < 1e-5);
    }
    let thinned = |warning: &Warning| matches!(warning, Warning::Thinned { rows: 5000, kept: 625, .. });
    assert!(read.warnings.iter().any(thinned), "{:?}", read.warnings);
    assert!(read.others.is_empty());
    // A bad value is found wherever it stands.
    std::fs::write(&path, text.replace("4.9,", "4.9x,")).expect("it writes");
    let error = Recording::read_within(&path, None, (4 * 1000, None)).expect_err("it is refused");
    assert!(error.to_string().contains("r.csv:4902"), "{error}");
}

#[test]
fn a_value_that_is_not_needed_may_be_missing() {
    let with = |cell: &str| {
        read(&format!(
            "t,q_a,q_b,qd_a,qd_b,tau_a,tau_b,temperature_a\n0,1,2,3,4,5,6,7\n1,1,2,{cell},4,5,6,{cell}\n2,1,2,3,4,5,6,7\n"
        ))
        .expect("it reads")
    };
    for cell in ["nan", "", "NaN", "x"] {
        let read = with(cell);
        assert_eq!((read.len(), &read.qd, read.temperature.len()), (3, &None, 0));
        let found = |column: &str| {
            let line = Location::Line(3);
            let (column, found) = (column.to_owned(), cell.to_owned());
            read.warnings.contains(&Warning::ColumnLeftOut { column, line, found })
        };
        assert!(found("qd_a") && found("temperature_a"), "{:?}", read.warnings);
    }
}

#[test]
fn a_joint_without_any_torque_is_left_out() {
    let read = read("t,q_a,q_hand,tau_a,tau_hand\n0,1,2,5,nan\n1,1,2,5,\n2,1,2,5,NaN\n").expect("it reads");
    assert_eq!((&read.joints[..], read.q.len()), (&["a".to_owned()][..], 1));
    let found = |warning: &Warning| matches!(warning, Warning::JointLeftOut { joint, .. } if joint == "hand");
    assert!(read.warnings.iter().any(found), "{:?}", read.warnings);
    // Neither makes equal rows differ.
    let twice =
        "t,q_a,q_hand,qd_a,qd_hand,tau_a,tau_hand\n0,1,2,,0,5,nan\n1,1,2,3,0,5,nan\n1,1,2,3,0,5,nan\n2,1,2,3,0,5,nan\n";
    let twice = self::read(twice).expect("it reads");
    let same = |warning: &Warning| matches!(warning, Warning::Duplicates { .. });
    assert!(twice.warnings.iter().any(same), "{:?}", twice.warnings);
    // With a torque here and there, the rows without one are the mistake.
    let text = refusal("t,q_a,q_hand,tau_a,tau_hand\n0,1,2,5,nan\n1,1,2,5,3\n2,1,2,5,NaN\n");
    assert!(text.contains("r.csv:2: column \"tau_hand\" is \"nan\""), "{text}");
    let text = refusal("t,q_a,tau_a\n0,1,nan\n1,1,nan\n");
    assert!(text.contains("r.csv:2: column \"tau_a\""), "{text}");
}

#[test]
fn spaces_and_the_other_forms_of_time_are_read() {
    let plain = without_origin(read("t,q_a,tau_a\n0,1,2\n1,1.5,2.5\n").expect("it reads"));
    for other in [
        "t q_a tau_a\n0 1 2\n1 1.5 2.5\n",
        "  t   q_a  tau_a \r\n 0.0   1 2  \r\n  1 1.5 2.5\r\n",
        "secs,nsecs,q_a,tau_a\n0,0,1,2\n1,0,1.5,2.5\n",
    ] {
        let other_form = read(other).expect("it reads");
        assert_eq!(without_origin(other_form), plain, "{other:?}");
    }
    for stamps in [
        ["2024-03-01T12:00:00Z", "2024-03-01T12:00:01Z"],
        ["2024-03-01 23:59:59.5", "2024-03-02 00:00:00.5"],
        ["2024-03-01T12:00:00+01:00", "2024-03-01T11:00:01Z"],
    ] {
        let read = read(&format!("t,q_a,tau_a\n{},1,2\n{},1.5,2.5\n", stamps[0], stamps[1])).expect("it reads");
        assert_eq!(read.time[1] - read.time[0], 1.0, "{stamps:?}");
    }
    let bad = refusal("t,q_a,tau_a\nyesterday,1,2\n1,1.5,2.5\n");
    assert!(bad.contains("r.csv:2: column \"t\" is \"yesterday\"") && bad.contains("ISO 8601"), "{bad}");
    let named = refusal("stamp,q_a,tau_a\n0,1,2\n1,1.5,2.5\n");
    assert!(named.contains("is \"stamp\" meant?"), "{named}");
}

#[test]
fn comments_above_the_header_are_skipped() {
    let rows = "0,1,2\n0.1,1,2\n0.2,1,2\n";
    let plain = without_origin(read(&format!("t,q_a,tau_a\n{rows}")).expect("it reads"));
    for text in [
        format!("# by me\n# on a Tuesday\nt,q_a,tau_a\n{rows}"),
        // As numpy.savetxt writes it.
        format!("# t,q_a,tau_a\n{rows}"),
        format!("# t q_a tau_a\n{}", rows.replace(',', " ")),
    ] {
        assert_eq!(without_origin(read(&text).expect("it reads")), plain, "{text}");
    }
    let wrong = refusal("# by me\nt,q_a,tau_a\n0,1,2\n1,x,2\n2,1,2\n");
    assert!(wrong.contains("r.csv:4"), "{wrong}");
}

#[test]
fn a_doubled_column_and_a_date_of_another_form_are_named() {
    let doubled = refusal("t,q_a,q_b,tau_a,tau_a\n0,1,2,3,4\n1,1,2,3,4\n");
    assert!(doubled.contains("\"tau_a\" is there twice (rename one)"), "{doubled}");
    let date = refusal("t,q_a,tau_a\n03/01/2026 12:00:00,1,2\n03/01/2026 12:00:01,1,2\n");
    assert!(date.contains("ISO 8601") && !date.contains("delete the row"), "{date}");
}
