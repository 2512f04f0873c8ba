//! Recordings into CSV: a header `t`, `q_<joint>`, `qd_<joint>`, `tau_<joint>` and so on, then numbers.

use std::io::Write;
use std::path::Path;

use crate::{Quantity, Recording, RecordingError, write_whole};

impl Recording {
    /// Writes the recording to `path`, completely or not at all; numbers read back to the same bits.
    ///
    /// # Errors
    /// [`RecordingError::Write`] if the file cannot be written.
    pub fn write_csv(&self, path: &Path) -> Result<(), RecordingError> {
        let mut columns: Vec<(String, &[f64])> = vec![("t".into(), &self.time)];
        let signals = [
            (Quantity::Position, Some(&self.q)),
            (Quantity::Velocity, self.qd.as_ref()),
            (Quantity::Acceleration, self.qdd.as_ref()),
            (Quantity::Torque, Some(&self.tau)),
        ];
        for (quantity, signal) in signals {
            for (joint, values) in self.joints.iter().zip(signal.into_iter().flatten()) {
                columns.push((format!("{}{joint}", quantity.prefix()), values));
            }
        }
        let partial = [
            (Quantity::SecondaryPosition, &self.q_secondary),
            (Quantity::CurrentTorque, &self.tau_current),
            (Quantity::Current, &self.current),
            (Quantity::Temperature, &self.temperature),
        ];
        for (quantity, signal) in partial {
            for (joint, values) in self.joints.iter().zip(signal) {
                if let Some(values) = values {
                    columns.push((format!("{}{joint}", quantity.prefix()), values));
                }
            }
        }
        columns.extend(self.others.iter().map(|(name, values)| (name.clone(), values.as_slice())));
        write_whole(path, |file| write_columns(file, &columns))
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
