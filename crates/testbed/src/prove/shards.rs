//! Parts of a campaign that different machines compute: each is a Parquet file, and all together are one proof.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, bail, ensure};
use faults::Program;
use parquet::basic::Compression;
use parquet::data_type::{ByteArray, ByteArrayType};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::record::Field;
use parquet::schema::parser::parse_message_type;
use serde::{Deserialize, Serialize};

use super::rows::Row;
use crate::cli::Shard;

/// The `schema` of a part.
const SCHEMA: &str = "testbed.shard/1";
/// The key of the label in the metadata of a file.
const KEY: &str = "testbed.shard";

/// The label of a part, in the metadata of its file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Label {
    /// `testbed.shard/1`.
    pub schema: String,
    /// The part.
    pub shard: Shard,
    /// The program that was sealed.
    pub program: Program,
    /// The origin of all cases.
    pub source: String,
    /// The command that repeats the whole proof.
    pub command: String,
    /// The seal of this part.
    pub sealed: String,
}

impl Label {
    /// The label of a part.
    pub fn new(shard: Shard, program: Program, [source, command]: [String; 2], sealed: String) -> Self {
        Self { schema: SCHEMA.to_owned(), shard, program, source, command, sealed }
    }
}

/// A column: its name, whether its cells may be empty, and their content.
type Column = (&'static str, bool, fn(&Row) -> anyhow::Result<Option<String>>);
const COLUMNS: [Column; 11] = [
    ("case", false, |row| Ok(Some(row.case.clone()))),
    ("joints", false, |row| Ok(Some(serde_json::to_string(&row.joints)?))),
    ("files", false, |row| Ok(Some(serde_json::to_string(&row.files)?))),
    ("truth", false, |row| Ok(Some(row.truth.clone()))),
    ("diagnosis", true, |row| Ok(row.diagnosis.clone())),
    ("error", true, |row| Ok(row.error.clone())),
    ("true_terms", true, |row| Ok(row.true_terms.clone())),
    ("wrong_term", true, |row| Ok(row.wrong_term.clone())),
    ("tracking", true, |row| Ok(row.tracking.clone())),
    ("again", true, |row| Ok(row.again.clone())),
    ("again_error", true, |row| Ok(row.again_error.clone())),
];

/// Writes a part, completely or not at all.
///
/// # Errors
/// If it cannot be written.
pub fn write(path: &Path, label: &Label, rows: &[Row]) -> anyhow::Result<()> {
    let fields: String = COLUMNS
        .iter()
        .map(|(name, optional, _)| {
            let repetition = if *optional { "OPTIONAL" } else { "REQUIRED" };
            format!("{repetition} BYTE_ARRAY {name} (UTF8); ")
        })
        .collect();
    let schema = Arc::new(parse_message_type(&format!("message case {{ {fields}}}"))?);
    let label = KeyValue::new(KEY.to_owned(), serde_json::to_string(label)?);
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_dictionary_enabled(false)
        .set_statistics_enabled(EnabledStatistics::None)
        .set_created_by(concat!("testbed ", env!("CARGO_PKG_VERSION")).to_owned())
        .set_key_value_metadata(Some(vec![label]))
        .build();
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, schema, Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    for (_, optional, of) in COLUMNS {
        let cells: Vec<Option<String>> = rows.iter().map(of).collect::<anyhow::Result<_>>()?;
        let levels: Vec<i16> = cells.iter().map(|cell| i16::from(cell.is_some())).collect();
        let values: Vec<ByteArray> = cells.iter().flatten().map(|cell| ByteArray::from(cell.as_str())).collect();
        let mut column = group.next_column()?.context("a column too few")?;
        let levels = optional.then_some(levels.as_slice());
        column.typed::<ByteArrayType>().write_batch(&values, levels, None)?;
        column.close()?;
    }
    group.close()?;
    writer.close()?;
    recording::write_whole(path, |file| file.write_all(&bytes))?;
    Ok(())
}

/// Reads a part.
///
/// # Errors
/// If the file is not a part of a proof, or is damaged.
pub fn read(path: &Path) -> anyhow::Result<(Label, Vec<Row>)> {
    let place = || path.display().to_string();
    let reader = SerializedFileReader::new(std::fs::File::open(path).with_context(place)?).with_context(place)?;
    let pairs = reader.metadata().file_metadata().key_value_metadata();
    let label = pairs.and_then(|pairs| pairs.iter().find(|pair| pair.key == KEY)?.value.clone());
    let Some(label) = label else {
        bail!("{}: is no part of a proof; give files that --shard wrote", path.display());
    };
    let label: Label = serde_json::from_str(&label).with_context(place)?;
    ensure!(label.schema == SCHEMA, "{}: its schema is \"{}\"", path.display(), label.schema);
    let mut rows = Vec::new();
    for row in reader.get_row_iter(None).with_context(place)? {
        let row = row.with_context(place)?;
        let mut cells: BTreeMap<&str, String> = BTreeMap::new();
        for (name, field) in row.get_column_iter() {
            if let Field::Str(text) = field {
                cells.insert(name, text.clone());
            }
        }
        let mut take = |name: &str| cells.remove(name);
        let needed = |cell: Option<String>| cell.with_context(|| format!("{}: a cell is missing", path.display()));
        rows.push(Row {
            case: needed(take("case"))?,
            joints: serde_json::from_str(&needed(take("joints"))?).with_context(place)?,
            files: serde_json::from_str(&needed(take("files"))?).with_context(place)?,
            truth: needed(take("truth"))?,
            diagnosis: take("diagnosis"),
            error: take("error"),
            true_terms: take("true_terms"),
            wrong_term: take("wrong_term"),
            tracking: take("tracking"),
            again: take("again"),
            again_error: take("again_error"),
        });
    }
    Ok((label, rows))
}

/// All parts in `folder`, in the order of the cases.
///
/// # Errors
/// If a part is missing, damaged or given twice, or the parts belong to different programs or campaigns.
pub fn merge(folder: &Path) -> anyhow::Result<(Label, Vec<Row>)> {
    let entries = std::fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    let mut files: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "parquet"));
    files.sort();
    let mut all = Vec::new();
    let mut first: Option<(PathBuf, Label)> = None;
    let mut there: BTreeMap<usize, PathBuf> = BTreeMap::new();
    for path in files {
        let (label, rows) = read(&path)?;
        if let Some((other, known)) = &first {
            let same = |label: &Label| (label.program.clone(), label.source.clone(), label.shard.of);
            ensure!(
                same(known) == same(&label),
                "{} and {} are not of one program and one campaign",
                other.display(),
                path.display()
            );
        }
        if let Some(twin) = there.insert(label.shard.number, path.clone()) {
            bail!("{} and {} are the same part", twin.display(), path.display());
        }
        first.get_or_insert((path, label));
        all.extend(rows);
    }
    let Some((_, label)) = first else {
        bail!("{}: has no part of a proof (shard-k-of-n.parquet)", folder.display());
    };
    let missing: Vec<String> =
        (1..=label.shard.of).filter(|number| !there.contains_key(number)).map(|n| n.to_string()).collect();
    ensure!(
        missing.is_empty(),
        "{}: parts {} of {} are missing; run them again (--shard k/n goes on where it stopped)",
        folder.display(),
        missing.join(","),
        label.shard.of
    );
    all.sort_by(|a, b| a.case.cmp(&b.case));
    Ok((label, all))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(number: usize) -> Row {
        Row {
            case: format!("case_{number:03}"),
            joints: vec!["a".into(), "b".into()],
            files: [("robot.urdf".to_owned(), "00".to_owned())].into(),
            truth: "{}".into(),
            diagnosis: (number != 1).then(|| format!("{{\"findings\": [], \"µ\": {number}}}")),
            error: (number == 1).then(|| "it failed".into()),
            true_terms: None,
            wrong_term: None,
            tracking: (number == 2).then(|| "{}".into()),
            again: None,
            again_error: (number == 2).then(|| "lost".into()),
        }
    }

    fn label(number: usize, of: usize) -> Label {
        let program = Program { version: "1".into(), sha256: "00".into() };
        let words = ["4 cases drawn from seed 7".to_owned(), "testbed prove".to_owned()];
        Label::new(Shard { number, of }, program, words, "11".into())
    }

    #[test]
    fn parts_are_read_as_written_and_merged() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |number: usize| folder.path().join(format!("shard-{number}-of-2.parquet"));
        write(&path(2), &label(2, 2), &[row(1), row(3)]).expect("it writes");
        let error = merge(folder.path()).expect_err("one is missing").to_string();
        assert!(error.contains("parts 1 of 2 are missing"), "{error}");
        write(&path(1), &label(1, 2), &[row(0), row(2)]).expect("it writes");
        let (whole, rows) = merge(folder.path()).expect("both are there");
        assert_eq!(whole.source, "4 cases drawn from seed 7");
        assert_eq!(rows, [row(0), row(1), row(2), row(3)]);
        std::fs::copy(path(1), folder.path().join("copy.parquet")).expect("it copies");
        assert!(merge(folder.path()).is_err());
        std::fs::remove_file(folder.path().join("copy.parquet")).expect("it is there");
        std::fs::write(path(2), "PAR1 but not really").expect("it writes");
        assert!(merge(folder.path()).is_err());
    }
}
