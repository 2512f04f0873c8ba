//! The predictions and the residuals of the models for every recording, row by row, as CSV or Parquet.

use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use anyhow::{Context, bail};
use arm::Arm;
use diagnosis::{Trace, Traces};
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use crate::cli::RESIDUALS_CREATOR;

/// The format, by the ending of the file's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Numbers as text that reads back to the same bits.
    Csv,
    /// Doubles, compressed by Snappy.
    Parquet,
}

impl Kind {
    /// The format of the file `path`.
    ///
    /// # Errors
    /// If it ends otherwise than in `.csv` or `.parquet`.
    pub fn of(path: &Path) -> anyhow::Result<Self> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        match ending.as_deref() {
            Some("csv") => Ok(Self::Csv),
            Some("parquet") => Ok(Self::Parquet),
            _ => bail!(
                "--residuals {}: the ending of the file's name chooses the format; end it in .csv or .parquet",
                path.display()
            ),
        }
    }
}

/// The values of one column in one recording.
enum Values<'a> {
    /// One text, in every row.
    Text(&'a str),
    /// One truth value, in every row.
    Same(bool),
    /// One a row.
    Each(&'a [bool]),
    /// One a row.
    Numbers(Vec<f64>),
}

/// All columns of one recording, in order: their headers and values.
fn columns<'a>(trace: &'a Trace, joints: &[&str]) -> Vec<(String, Values<'a>)> {
    let mut list = vec![
        ("recording".to_owned(), Values::Text(&trace.name)),
        ("held_out".to_owned(), Values::Same(trace.held_out)),
        ("t".to_owned(), Values::Numbers(trace.time.clone())),
    ];
    // A prediction is the measured torque minus the residual.
    let predicted = |residual: &[Vec<f64>], joint: usize| {
        let pairs = trace.tau[joint].iter().zip(&residual[joint]);
        pairs.map(|(tau, left)| tau - left).collect()
    };
    type Signal<'a> = (&'static str, &'a dyn Fn(usize) -> Vec<f64>);
    let signals: [Signal<'_>; 4] = [
        ("measured", &|joint| trace.tau[joint].clone()),
        ("nominal", &|joint| predicted(&trace.residual, joint)),
        ("corrected", &|joint| predicted(&trace.residual_exported, joint)),
        ("residual", &|joint| trace.residual_exported[joint].clone()),
    ];
    for (signal, of) in signals {
        for (joint, name) in joints.iter().enumerate() {
            list.push((format!("{signal}_{name}"), Values::Numbers(of(joint))));
        }
    }
    for (moving, name) in trace.moving.iter().zip(joints) {
        list.push((format!("moving_{name}"), Values::Each(moving)));
    }
    list
}

/// Writes all recordings of `traces` to `path`, one after the other, completely or not at all. The format follows from the ending.
///
/// # Errors
/// If the ending is that of another format, or the file cannot be written.
pub fn write(path: &Path, arm: &Arm, traces: &Traces) -> anyhow::Result<()> {
    let joints: Vec<&str> = arm.joints().iter().map(|joint| joint.name.as_str()).collect();
    match Kind::of(path)? {
        Kind::Csv => recording::write_whole(path, |file| write_csv(file, &joints, traces))?,
        Kind::Parquet => {
            let bytes = parquet(&joints, traces).with_context(|| path.display().to_string())?;
            recording::write_whole(path, |file| file.write_all(&bytes))?;
        }
    }
    Ok(())
}

fn write_csv(file: &mut dyn Write, joints: &[&str], traces: &Traces) -> std::io::Result<()> {
    let mut writer = csv::Writer::from_writer(file);
    for (number, trace) in traces.recordings.iter().enumerate() {
        let columns = columns(trace, joints);
        if number == 0 {
            writer.write_record(columns.iter().map(|(name, _)| name))?;
        }
        for row in 0..trace.time.len() {
            for (_, values) in &columns {
                match values {
                    Values::Text(text) => writer.write_field(text)?,
                    Values::Same(value) => writer.write_field(value.to_string())?,
                    Values::Each(values) => writer.write_field(values[row].to_string())?,
                    // Rust writes the shortest digits that read back to the same number.
                    Values::Numbers(values) => writer.write_field(values[row].to_string())?,
                }
            }
            writer.write_record(None::<&[u8]>)?;
        }
    }
    writer.flush()
}

/// A Parquet file with one row group per recording.
fn parquet(joints: &[&str], traces: &Traces) -> anyhow::Result<Vec<u8>> {
    let Some(first) = traces.recordings.first() else {
        bail!("there is no recording");
    };
    let field = |(name, values): &(String, Values<'_>)| -> anyhow::Result<Arc<Type>> {
        let (physical, logical) = match values {
            Values::Text(_) => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
            Values::Same(_) | Values::Each(_) => (Physical::BOOLEAN, None),
            Values::Numbers(_) => (Physical::DOUBLE, None),
        };
        let field = Type::primitive_type_builder(name, physical)
            .with_repetition(Repetition::REQUIRED)
            .with_logical_type(logical);
        Ok(Arc::new(field.build()?))
    };
    let fields = columns(first, joints).iter().map(field).collect::<anyhow::Result<Vec<_>>>()?;
    let schema = Type::group_type_builder("residuals").with_fields(fields).build()?;
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_created_by(format!("{RESIDUALS_CREATOR} {}", env!("CARGO_PKG_VERSION")))
        .build();
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, Arc::new(schema), Arc::new(properties))?;
    for trace in &traces.recordings {
        let rows = trace.time.len();
        let mut group = writer.next_row_group()?;
        for (_, values) in columns(trace, joints) {
            let mut column = group.next_column()?.context("a column too few")?;
            match values {
                Values::Text(text) => {
                    let texts = vec![ByteArray::from(text); rows];
                    column.typed::<ByteArrayType>().write_batch(&texts, None, None)?;
                }
                Values::Same(value) => {
                    column.typed::<BoolType>().write_batch(&vec![value; rows], None, None)?;
                }
                Values::Each(values) => {
                    column.typed::<BoolType>().write_batch(values, None, None)?;
                }
                Values::Numbers(values) => {
                    column.typed::<DoubleType>().write_batch(&values, None, None)?;
                }
            }
            column.close()?;
        }
        group.close()?;
    }
    writer.close()?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;

    use super::*;

    fn traces() -> (Arm, Traces) {
        let arm = Arm::from_urdf_text(include_str!("../../../../assets/puma560.urdf"), "puma560.urdf").expect("an arm");
        let trace = |name: &str, held_out: bool, start: f64| {
            let rows = 3;
            let signal = |scale: f64| -> Vec<Vec<f64>> {
                let of =
                    |joint: usize| (0..rows).map(|row| scale * (1.0 + joint as f64) / (3.0 + f64::from(row))).collect();
                (0..arm.dof()).map(of).collect()
            };
            Trace {
                name: name.into(),
                held_out,
                time: (0..rows).map(|row| start + 0.1 * f64::from(row)).collect(),
                tau: signal(9.0),
                residual: signal(2.0),
                residual_augmented: signal(0.25),
                residual_exported: signal(0.5),
                moving: vec![vec![true, false, true]; arm.dof()],
                ..Trace::default()
            }
        };
        let recordings = vec![trace("a, b.csv", false, 0.0), trace("c.csv", true, 1.7e9)];
        (arm.clone(), Traces { recordings })
    }

    /// Both files hold the same cells, to the last bit, and the corrected model is the one that is exported.
    #[test]
    fn csv_and_parquet_hold_the_same() {
        let (arm, traces) = traces();
        let folder = tempfile::tempdir().expect("a folder");
        let [csv, parquet] = ["r.csv", "r.PARQUET"].map(|name| folder.path().join(name));
        write(&csv, &arm, &traces).expect("it writes");
        write(&parquet, &arm, &traces).expect("it writes");
        let mut text = csv::Reader::from_path(&csv).expect("it reads");
        let header: Vec<String> = text.headers().expect("a header").iter().map(str::to_owned).collect();
        assert_eq!(header.len(), 3 + 5 * 6);
        assert_eq!(&header[..4], ["recording", "held_out", "t", "measured_joint1"]);
        assert_eq!(header[32], "moving_joint6");
        let rows: Vec<Vec<String>> =
            text.records().map(|row| row.expect("a row").iter().map(str::to_owned).collect()).collect();
        assert_eq!(rows.len(), 6);
        assert_eq!(&rows[3][..2], ["c.csv", "true"]);
        let cell = |row: usize, name: &str| -> f64 {
            let column = header.iter().position(|column| column == name).expect("a column");
            rows[row][column].parse().expect("a number")
        };
        assert_eq!(cell(4, "t"), 1.7e9 + 0.1);
        assert_eq!(cell(1, "nominal_joint2"), 18.0 / 4.0 - 4.0 / 4.0);
        assert_eq!(cell(1, "corrected_joint2"), 18.0 / 4.0 - 1.0 / 4.0);
        assert_eq!(cell(1, "residual_joint2"), 1.0 / 4.0);
        let file = std::fs::File::open(&parquet).expect("it is there");
        let reader = SerializedFileReader::new(file).expect("it is Parquet");
        assert_eq!(reader.num_row_groups(), 2);
        for (row, cells) in reader.get_row_iter(None).expect("rows").zip(&rows) {
            let row = row.expect("a row");
            let names: Vec<&String> = row.get_column_iter().map(|(name, _)| name).collect();
            assert_eq!(names, header.iter().collect::<Vec<_>>());
            for ((_, field), cell) in row.get_column_iter().zip(cells) {
                match field {
                    Field::Str(text) => assert_eq!(text, cell),
                    Field::Bool(value) => assert_eq!(value.to_string(), *cell),
                    Field::Double(value) => assert_eq!(*value, cell.parse::<f64>().expect("a number")),
                    other => panic!("{other:?}"),
                }
            }
        }
    }

    #[test]
    fn another_ending_is_refused_with_the_remedy() {
        let error = Kind::of(Path::new("r.xlsx")).expect_err("unknown").to_string();
        assert!(error.contains("r.xlsx") && error.contains(".csv or .parquet"), "{error}");
        assert_eq!(Kind::of(Path::new("a.b.CSV")).expect("known"), Kind::Csv);
    }
}
