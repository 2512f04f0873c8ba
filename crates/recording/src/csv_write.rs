//! Recordings into CSV: a header `t`, `q_<joint>`, `qd_<joint>`, `tau_<joint>` and so on, then numbers.

use std::io::Write;
use std::path::Path;

use crate::{Recording, RecordingError, write_whole};

impl Recording {
    /// Writes the recording to `path`, completely or not at all; numbers read back to the same bits.
    ///
    /// # Errors
    /// [`RecordingError::Write`] if the file cannot be written.
    pub fn write_csv(&self, path: &Path) -> Result<(), RecordingError> {
        let mut columns: Vec<(String, &[f64])> = vec![("t".into(), &self.time)];
        columns.extend(self.channels().filter_map(|(meaning, values)| {
            let (quantity, joint) = meaning?;
            Some((format!("{}{}", quantity.prefix(), self.joints.get(joint)?), values.as_slice()))
        }));
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
