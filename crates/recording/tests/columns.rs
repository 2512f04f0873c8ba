//! Columns in memory are read as those of a file.

use recording::{Column, Recording};

/// 200 rows of one joint, with a row written twice.
fn columns() -> Vec<(String, Column)> {
    let time: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(if k == 50 { 49 } else { k })).collect();
    let q: Vec<f64> = time.iter().map(|t| t.sin()).collect();
    let tau: Vec<f64> = time.iter().map(|t| 3.0 * t.cos()).collect();
    vec![
        ("t".to_owned(), Column::Numbers(time)),
        ("q_a".to_owned(), Column::Numbers(q)),
        ("tau_a".to_owned(), Column::Numbers(tau)),
        ("mode".to_owned(), Column::Integers(vec![7; 200])),
    ]
}

#[test]
fn the_columns_are_those_of_the_same_csv() {
    let mut text = "t,q_a,tau_a,mode\n".to_owned();
    let given = columns();
    for row in 0..200 {
        let cell = |column: &Column| match column {
            Column::Numbers(values) => values[row].to_string(),
            Column::Integers(values) | Column::Nanos(values) => values[row].to_string(),
        };
        let cells: Vec<String> = given.iter().map(|(_, column)| cell(column)).collect();
        text.push_str(&format!("{}\n", cells.join(",")));
    }
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("same.csv");
    std::fs::write(&path, text).expect("it is written");
    let read = Recording::read(&path).expect("the file is good");
    let taken = Recording::of_columns("same", given, None).expect("the columns are good");
    assert!(read.len() < 200 && !taken.warnings.is_empty());
    assert_eq!(read.warnings.len(), taken.warnings.len());
    // Places apart, which are lines in a file and rows in memory.
    let without = |recording: Recording| Recording { warnings: Vec::new(), origin: None, ..recording };
    assert_eq!(without(read), without(taken));
}

#[test]
fn what_is_wrong_with_columns_has_their_name() {
    let refusal = |columns| Recording::of_columns("given", columns, None).expect_err("it is refused").to_string();
    let mut short = columns();
    short[2].1 = Column::Numbers(vec![0.0; 20]);
    let message = refusal(short);
    assert!(message.contains("given") && message.contains("\"tau_a\" has 20 values"), "{message}");
    let mut missing = columns();
    missing[2].1 = Column::Numbers([vec![1.0; 120], vec![f64::NAN], vec![1.0; 79]].concat());
    let message = refusal(missing);
    assert!(message.contains("tau_a") && message.contains("NaN"), "{message}");
    let mut lacking = columns();
    lacking.remove(0);
    assert!(refusal(lacking).contains("no column \"t\""));
}
