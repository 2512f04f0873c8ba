//! Recordings as CSV: a header `t`, `q_<joint>`, `qd_<joint>`, `qdd_<joint>`, `tau_<joint>`, then numbers.

use std::io::Write;
use std::path::Path;

use crate::{Recording, RecordingError, Signal, write_whole};

impl Recording {
    /// Writes the recording to `path`, whole or not at all; numbers read back to the same bits.
    ///
    /// # Errors
    /// [`RecordingError::Write`] if the file cannot be written.
    pub fn write_csv(&self, path: &Path) -> Result<(), RecordingError> {
        let mut columns: Vec<(String, &[f64])> = vec![("t".into(), &self.time)];
        let signals = [
            ("q", Some(&self.q)),
            ("qd", self.qd.as_ref()),
            ("qdd", self.qdd.as_ref()),
            ("tau", Some(&self.tau)),
        ];
        for (prefix, signal) in signals {
            for (joint, values) in self.joints.iter().zip(signal.into_iter().flatten()) {
                columns.push((format!("{prefix}_{joint}"), values));
            }
        }
        columns.extend(
            self.others
                .iter()
                .map(|(name, values)| (name.clone(), values.as_slice())),
        );
        write_whole(path, |file| write_columns(file, &columns))
    }

    /// Reads a recording whose header names `t` and `q_<joint>`, `tau_<joint>` for the same joints;
    /// `qd_` and `qdd_` where there are any, other columns as they are.
    ///
    /// # Errors
    /// [`RecordingError`] with the line and the column, if the file cannot be read, a column is
    /// missing, or a value is not a finite number.
    pub fn read_csv(path: &Path) -> Result<Self, RecordingError> {
        let file = std::fs::File::open(path).map_err(|source| RecordingError::Read {
            path: path.to_owned(),
            source,
        })?;
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(file);
        let header_error = |reason: String| RecordingError::Header {
            path: path.to_owned(),
            reason,
        };
        let row_error = |line: u64, reason: String| RecordingError::Row {
            path: path.to_owned(),
            line,
            reason,
        };
        let headers = reader.headers().map_err(|e| header_error(e.to_string()))?.clone();
        let mut columns = vec![Vec::new(); headers.len()];
        for record in reader.records() {
            let record = record.map_err(|e| row_error(e.position().map_or(1, csv::Position::line), e.to_string()))?;
            let line = record.position().map_or(1, csv::Position::line);
            for ((text, name), column) in record.iter().zip(&headers).zip(&mut columns) {
                match text.parse::<f64>() {
                    Ok(value) if value.is_finite() => column.push(value),
                    _ => {
                        return Err(row_error(
                            line,
                            format!("column \"{name}\" is \"{text}\", not a finite number"),
                        ));
                    }
                }
            }
        }
        let mut columns: Vec<(String, Vec<f64>)> = headers.iter().map(str::to_owned).zip(columns).collect();
        let mut take = |name: &str| {
            let index = columns.iter().position(|(header, _)| header == name)?;
            Some(columns.remove(index).1)
        };
        let time = take("t").ok_or_else(|| header_error("there is no column \"t\" (time in s)".into()))?;
        let joints: Vec<String> = headers
            .iter()
            .filter_map(|header| header.strip_prefix("q_"))
            .map(str::to_owned)
            .collect();
        if joints.is_empty() {
            return Err(header_error(
                "there is no column \"q_<joint>\" (position in rad or m)".into(),
            ));
        }
        let mut signal = |prefix: &str| -> Result<Option<Signal>, RecordingError> {
            let found: Vec<Option<Vec<f64>>> = joints.iter().map(|joint| take(&format!("{prefix}_{joint}"))).collect();
            if found.iter().all(Option::is_none) {
                return Ok(None);
            }
            let missing = joints.iter().zip(&found).find(|(_, column)| column.is_none());
            match missing {
                Some((joint, _)) => Err(header_error(format!(
                    "there is no column \"{prefix}_{joint}\", though other joints have one"
                ))),
                None => Ok(Some(found.into_iter().flatten().collect())),
            }
        };
        let (q, qd, qdd) = (signal("q")?.unwrap_or_default(), signal("qd")?, signal("qdd")?);
        let tau = signal("tau")?
            .ok_or_else(|| header_error("there is no column \"tau_<joint>\" (torque in N m, or force in N)".into()))?;
        if time.is_empty() {
            return Err(header_error("there are no rows below the header".into()));
        }
        if let Some(k) = (1..time.len()).find(|&k| time[k] <= time[k - 1]) {
            let (before, after) = (time[k - 1], time[k]);
            return Err(row_error(
                k as u64 + 2,
                format!("time goes from {before} s to {after} s; it must increase"),
            ));
        }
        Ok(Self {
            joints,
            time,
            q,
            qd,
            qdd,
            tau,
            others: columns,
        })
    }
}

fn write_columns(file: &mut dyn Write, columns: &[(String, &[f64])]) -> std::io::Result<()> {
    let mut writer = csv::Writer::from_writer(file);
    writer.write_record(columns.iter().map(|(name, _)| name))?;
    let mut text = String::new();
    for row in 0..columns.first().map_or(0, |(_, values)| values.len()) {
        for (_, values) in columns {
            text.clear();
            // Rust writes the shortest digits that read back to the same number.
            let _ = std::fmt::Write::write_fmt(&mut text, format_args!("{}", values[row]));
            writer.write_field(&text)?;
        }
        writer.write_record(None::<&[u8]>)?;
    }
    writer.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording() -> Recording {
        Recording {
            joints: vec!["shoulder".into(), "elbow".into()],
            time: vec![0.0, 0.1, 0.2],
            q: vec![vec![0.1, 1.0 / 3.0, -1e-17], vec![1.0, 2.0, 3.0]],
            qd: Some(vec![vec![0.0; 3], vec![5e300; 3]]),
            qdd: None,
            tau: vec![vec![1.0, -2.0, 3.5], vec![0.0; 3]],
            others: vec![("temperature".into(), vec![20.0, 20.5, 21.0])],
        }
    }

    #[test]
    fn what_is_written_reads_back_to_the_same_bits() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("r.csv");
        recording().write_csv(&path).expect("it writes");
        assert_eq!(Recording::read_csv(&path).expect("it reads"), recording());
    }

    #[test]
    fn a_bad_file_is_refused_with_its_place() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("r.csv");
        let refusal = |text: &str| {
            std::fs::write(&path, text).expect("it writes");
            Recording::read_csv(&path).expect_err("it is refused").to_string()
        };
        assert!(refusal("t,q_a,tau_a\n0,1,2\n1,x,2\n").contains("r.csv:3: column \"q_a\" is \"x\""));
        assert!(refusal("t,q_a,tau_a\n0,1,NaN\n").contains("r.csv:2: column \"tau_a\""));
        assert!(refusal("t,q_a,tau_a\n0,1,2\n0,1,2\n").contains("r.csv:3: time goes from 0 s to 0 s"));
        assert!(refusal("t,q_a,q_b,tau_a\n0,1,2,3\n").contains("\"tau_b\""));
        assert!(refusal("q_a,tau_a\n0,1\n").contains("no column \"t\""));
        assert!(refusal("t,q_a\n0,1\n").contains("tau_<joint>"));
        assert!(refusal("t,q_a,tau_a\n").contains("no rows"));
        assert!(refusal("t,q_a,tau_a\n0,1\n").contains("r.csv:2"));
        std::fs::remove_file(&path).expect("it was there");
        assert!(
            Recording::read_csv(&path)
                .expect_err("it is gone")
                .to_string()
                .contains("cannot be read")
        );
    }
}
