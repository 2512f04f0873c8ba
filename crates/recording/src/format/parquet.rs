//! Parquet files, with one column per quantity or with lists of values (LeRobot).

use std::fs::File;
use std::io::{BufReader, Error, ErrorKind, Read, Seek, SeekFrom};
use std::panic::AssertUnwindSafe;

use bytes::Bytes;
use parquet::basic::{Compression, ConvertedType, LogicalType, TimeUnit};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl, get_column_reader};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::metadata::{ColumnChunkMetaData, KeyValue, RowGroupMetaData};
use parquet::file::reader::{ChunkReader, FileReader, Length, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;
use serde::Deserialize;

use super::pages::Checked;
use super::thrift::has_endless_list;
use super::{Format, Options};
use crate::RecordingError;
use crate::input::{Input, most_expanded};
use crate::table::{Column, Table};

const NAME: &str = "Parquet";
const MAGIC: &[u8] = b"PAR1";
/// The number of values that are read together.
const BATCH: usize = 1 << 14;
/// The largest number of values of a file (1 GiB).
const MOST: usize = 1 << 27;

/// Parquet.
pub struct Parquet;

impl Format for Parquet {
    fn matches(&self, input: &Input) -> bool {
        input.head.starts_with(MAGIC)
    }

    fn read(&self, input: Input, _: &Options<'_>) -> Result<Table, RecordingError> {
        let file = input.to_file()?;
        // The library panics on some damaged pages; none of its objects is used afterwards.
        let read = std::panic::catch_unwind(AssertUnwindSafe(|| columns(file)));
        let read = read.unwrap_or_else(|_| Err("a page is damaged; write or copy the file again".to_owned()));
        let columns = read.map_err(|reason| input.error(NAME, reason))?;
        Ok(Table::of_columns(columns))
    }
}

fn damaged(error: ParquetError) -> String {
    format!("the file is damaged or cut ({error}); write or copy it again")
}

/// The number of times that the end of the file may be read again before that is an error.
const MOST_ENDS: usize = 100;

/// A file whose end cannot be read without end: the library skips a list of as many items as a damaged header says, also where the
/// file has ended.
struct Guarded(File);

/// Reads a [`Guarded`] file from a place on.
struct Reading {
    inner: BufReader<File>,
    ends: usize,
}

impl Read for Reading {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let read = self.inner.read(buffer)?;
        self.ends += usize::from(read == 0 && !buffer.is_empty());
        if self.ends > MOST_ENDS {
            return Err(Error::new(ErrorKind::UnexpectedEof, "the file ends within a header"));
        }
        Ok(read)
    }
}

impl Length for Guarded {
    fn len(&self) -> u64 {
        Length::len(&self.0)
    }
}

impl ChunkReader for Guarded {
    type T = Reading;

    fn get_read(&self, start: u64) -> Result<Reading, ParquetError> {
        let inner = self.0.get_read(start)?;
        Ok(Reading { inner, ends: 0 })
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes, ParquetError> {
        self.0.get_bytes(start, length)
    }
}

/// The values of a column so far.
enum Values {
    Numbers(Vec<f64>),
    /// Integers, as long as no value is missing.
    Integers(Vec<i64>),
    /// Times (ns since 1970), in units of this many ns.
    Nanos(Vec<i64>, i64),
}

/// A column of the file; a column of lists becomes several columns of the table.
struct Leaf {
    name: String,
    values: Values,
    /// The number of values per row, if it contains lists.
    width: Option<usize>,
}

/// The message at the end of a file of `size` bytes, before its length and the magic bytes.
fn footer(mut file: &File, size: u64) -> std::io::Result<Vec<u8>> {
    let mut end = [0; 8];
    file.seek(SeekFrom::End(-8))?;
    file.read_exact(&mut end)?;
    let length = u64::from(u32::from_le_bytes([end[0], end[1], end[2], end[3]])).min(size.saturating_sub(8));
    file.seek(SeekFrom::Start(size.saturating_sub(8 + length)))?;
    let mut footer = Vec::new();
    file.take(length).read_to_end(&mut footer)?;
    Ok(footer)
}

/// The columns of numbers.
fn columns(file: File) -> Result<Vec<(String, Column)>, String> {
    let size = file.metadata().map_or(0, |metadata| metadata.len());
    if footer(&file, size).is_ok_and(|footer| has_endless_list(&footer)) {
        return Err("its footer is damaged; write or copy it again".to_owned());
    }
    let reader = SerializedFileReader::new(Guarded(file)).map_err(damaged)?;
    // The library does not check the positions in the footer.
    let groups = reader.metadata().row_groups().iter();
    if !groups.flat_map(RowGroupMetaData::columns).all(|column| is_within(column, size)) {
        return Err("its footer is damaged; write or copy it again".to_owned());
    }
    let mut columns = reader.metadata().row_groups().iter().flat_map(RowGroupMetaData::columns);
    if columns.any(|column| matches!(column.compression(), Compression::BROTLI(_) | Compression::LZO)) {
        return Err("its compression (Brotli or LZO) is not read; write it with another, for example \
             to_parquet(\"run.parquet\", compression=\"zstd\")"
            .to_owned());
    }
    let file = reader.metadata().file_metadata();
    if file.num_rows() == 0 {
        return Err("the table has no rows; a motion takes at least two, and a fit thousands".to_owned());
    }
    let schema = file.schema_descr_ptr();
    let mut leaves: Vec<Option<Leaf>> = schema.columns().iter().map(|column| leaf(column)).collect();
    let durations = durations(file.key_value_metadata().map_or(&[], Vec::as_slice));
    for leaf in leaves.iter_mut().flatten() {
        let unit = durations.iter().find(|(name, _)| *name == leaf.name);
        if let (Values::Integers(_), Some((_, unit))) = (&leaf.values, unit) {
            leaf.values = Values::Nanos(Vec::new(), *unit);
        }
    }
    let mut room = MOST.min(usize::try_from(most_expanded(size) / 8).unwrap_or(MOST));
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group).map_err(damaged)?;
        for (index, leaf) in leaves.iter_mut().enumerate() {
            if let Some(leaf) = leaf {
                let pages = group.get_column_page_reader(index).map_err(damaged)?;
                let column = get_column_reader(schema.column(index), Box::new(Checked(pages)));
                read_leaf(column, schema.column(index).as_ref(), leaf, &mut room)?;
            }
        }
    }
    let mut columns = Vec::new();
    for leaf in leaves.into_iter().flatten() {
        let values = match leaf.values {
            Values::Numbers(values) => Column::Numbers(values),
            Values::Integers(values) => Column::Integers(values),
            Values::Nanos(values, _) => Column::Nanos(values),
        };
        match leaf.width {
            None => columns.push((leaf.name, values)),
            Some(width) => columns.extend((0..width).map(|index| {
                let rows = values.len() / width;
                let column = values.picked((0..rows).map(|row| row * width + index));
                (format!("{}[{index}]", leaf.name), column)
            })),
        }
    }
    if columns.is_empty() {
        return Err("there are no columns of numbers; give a recording with time, positions and torques".to_owned());
    }
    Ok(columns)
}

/// The columns that pandas wrote from time differences, with their unit (ns). Parquet has no type for them; pandas describes its
/// columns in the file's metadata.
fn durations(metadata: &[KeyValue]) -> Vec<(String, i64)> {
    let text = metadata.iter().find(|pair| pair.key == "pandas").and_then(|pair| pair.value.as_deref());
    let described: Option<Pandas> = text.and_then(|text| serde_json::from_str(text).ok());
    let unit = |kind: &str| {
        Some(match kind {
            "timedelta64[ns]" => 1,
            "timedelta64[us]" => 1_000,
            "timedelta64[ms]" => 1_000_000,
            "timedelta64[s]" => 1_000_000_000,
            _ => return None,
        })
    };
    let columns = described.map_or_else(Vec::new, |described| described.columns);
    let of = |column: PandasColumn| Some((column.name?, unit(&column.numpy_type?)?));
    columns.into_iter().filter_map(of).collect()
}

/// The part of pandas' description of a table that is used here.
#[derive(Deserialize)]
struct Pandas {
    columns: Vec<PandasColumn>,
}

#[derive(Deserialize)]
struct PandasColumn {
    name: Option<String>,
    numpy_type: Option<String>,
}

/// Whether the pages of a column are within a file of `size` bytes.
fn is_within(column: &ColumnChunkMetaData, size: u64) -> bool {
    let first = column.dictionary_page_offset().unwrap_or(column.data_page_offset());
    let from = u64::try_from(first.min(column.data_page_offset()));
    let length = u64::try_from(column.compressed_size());
    matches!((from, length), (Ok(from), Ok(length)) if from.checked_add(length).is_some_and(|end| end <= size))
}

/// An empty column, if its type is a number, a time, or a list of numbers.
fn leaf(column: &ColumnDescriptor) -> Option<Leaf> {
    use parquet::basic::Type;
    let unit = match (column.logical_type_ref(), column.converted_type()) {
        (Some(LogicalType::Timestamp(time)), _) => Some(match time.unit {
            TimeUnit::MILLIS => 1_000_000,
            TimeUnit::MICROS => 1_000,
            TimeUnit::NANOS => 1,
        }),
        (None, ConvertedType::TIMESTAMP_MILLIS) => Some(1_000_000),
        (None, ConvertedType::TIMESTAMP_MICROS) => Some(1_000),
        _ => None,
    };
    let values = match (column.physical_type(), unit) {
        (Type::INT64, Some(unit)) => Values::Nanos(Vec::new(), unit),
        (Type::INT96, _) => Values::Nanos(Vec::new(), 1),
        (Type::INT32 | Type::INT64 | Type::BOOLEAN, _) => Values::Integers(Vec::new()),
        (Type::FLOAT | Type::DOUBLE, _) => Values::Numbers(Vec::new()),
        _ => return None,
    };
    let parts = column.path().parts();
    let (name, width) = match column.max_rep_level() {
        0 => (parts.join("."), None),
        // The last two parts are the names of the list itself ("list.element").
        1 => (parts[..parts.len().saturating_sub(2).max(1)].join("."), Some(0)),
        _ => return None,
    };
    Some(Leaf { name, values, width })
}

fn read_leaf(
    column: ColumnReader,
    descriptor: &ColumnDescriptor,
    leaf: &mut Leaf,
    room: &mut usize,
) -> Result<(), String> {
    match column {
        ColumnReader::BoolColumnReader(reader) => {
            read_typed(reader, descriptor, leaf, room, |value| (f64::from(u8::from(*value)), i64::from(*value)))
        }
        ColumnReader::Int32ColumnReader(reader) => {
            read_typed(reader, descriptor, leaf, room, |value| (f64::from(*value), i64::from(*value)))
        }
        ColumnReader::Int64ColumnReader(reader) => {
            read_typed(reader, descriptor, leaf, room, |value| (*value as f64, *value))
        }
        ColumnReader::Int96ColumnReader(reader) => {
            read_typed(reader, descriptor, leaf, room, |value| (0.0, value.to_nanos()))
        }
        ColumnReader::FloatColumnReader(reader) => {
            read_typed(reader, descriptor, leaf, room, |value| (f64::from(*value), 0))
        }
        ColumnReader::DoubleColumnReader(reader) => read_typed(reader, descriptor, leaf, room, |value| (*value, 0)),
        ColumnReader::ByteArrayColumnReader(_) | ColumnReader::FixedLenByteArrayColumnReader(_) => Ok(()),
    }
}

/// Reads one row group of a column; `both` converts a value to a floating-point number and to an integer.
fn read_typed<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    descriptor: &ColumnDescriptor,
    leaf: &mut Leaf,
    room: &mut usize,
    both: impl Fn(&T::T) -> (f64, i64),
) -> Result<(), String> {
    loop {
        let (mut definitions, mut repetitions, mut values) = (Vec::new(), Vec::new(), Vec::new());
        let read = reader.read_records(BATCH, Some(&mut definitions), Some(&mut repetitions), &mut values);
        let (records, _, levels) = read.map_err(damaged)?;
        if records == 0 {
            return Ok(());
        }
        *room = room.checked_sub(levels).ok_or(
            "it has more values than a recording of its size (over 12 a byte); keep the columns of the recording alone",
        )?;
        if let Some(width) = &mut leaf.width {
            check_lists(&leaf.name, width, &repetitions)?;
        }
        let mut values = values.iter();
        let is_there =
            |level: usize| definitions.get(level).is_none_or(|definition| *definition == descriptor.max_def_level());
        for level in 0..levels {
            let value = is_there(level).then(|| values.next()).flatten();
            leaf.push(value.map(&both))?;
        }
    }
}

/// Checks that all lists have the same length.
fn check_lists(name: &str, width: &mut usize, repetitions: &[i16]) -> Result<(), String> {
    let mut starts = repetitions.iter().enumerate().filter(|(_, level)| **level == 0).map(|(at, _)| at);
    let mut from = starts.next().unwrap_or(0);
    for to in starts.chain([repetitions.len()]) {
        let length = to - from;
        if *width == 0 {
            *width = length;
        } else if *width != length {
            return Err(format!(
                "column \"{name}\" has lists of {width} and of {length} values; write as many in each row"
            ));
        }
        from = to;
    }
    Ok(())
}

impl Leaf {
    /// Adds a value, or that it is missing.
    fn push(&mut self, value: Option<(f64, i64)>) -> Result<(), String> {
        match (&mut self.values, value) {
            (Values::Numbers(values), value) => values.push(value.map_or(f64::NAN, |(number, _)| number)),
            (Values::Integers(values), Some((_, whole))) => values.push(whole),
            (Values::Integers(values), None) => {
                let mut numbers: Vec<f64> = values.iter().map(|value| *value as f64).collect();
                numbers.push(f64::NAN);
                self.values = Values::Numbers(numbers);
            }
            (Values::Nanos(values, unit), Some((_, whole))) => values.push(whole.saturating_mul(*unit)),
            (Values::Nanos(..), None) => {
                return Err(format!("column \"{}\" lacks a time somewhere; fill it or leave the row out", self.name));
            }
        }
        Ok(())
    }
}
