//! Archives of NumPy arrays (`numpy.savez`), with one array per quantity.

use std::io::Read;

use super::{Format, Options};
use crate::RecordingError;
use crate::arrays::{self, Array};
use crate::bytes::Bytes;
use crate::input::{Input, most_expanded};
use crate::table::{Column, Table};

const NAME: &str = ".npz";
const ZIP: &[u8] = b"PK\x03\x04";

/// NumPy's archives.
pub struct Npz;

impl Format for Npz {
    fn matches(&self, input: &Input) -> bool {
        input.head.starts_with(ZIP)
    }

    fn read(&self, input: Input, _: &Options<'_>) -> Result<Table, RecordingError> {
        let data = input.to_bytes()?;
        let arrays = read(&data).map_err(|reason| input.error(NAME, reason))?;
        arrays::table(&input, NAME, &arrays)
    }
}

/// The arrays that a recording consists of.
const WANTED: [&str; 4] = ["t", "q", "qd", "tau"];

/// The arrays of numbers in the archive.
fn read(data: &[u8]) -> Result<Vec<Array>, String> {
    let damaged = |error: rawzip::Error| format!("the archive is damaged or cut ({error}); copy it again");
    let archive = rawzip::ZipArchive::from_slice(data).map_err(damaged)?;
    let mut room = most_expanded(data.len() as u64);
    let mut arrays = Vec::new();
    let mut entries = archive.entries();
    while let Some(entry) = entries.next_entry().map_err(damaged)? {
        let path = String::from_utf8_lossy(entry.file_path().as_ref()).into_owned();
        let Some(name) = path.strip_suffix(".npy") else {
            continue;
        };
        let local = archive.get_entry(entry.wayfinder()).map_err(damaged)?;
        let content: Box<dyn Read> = match entry.compression_method() {
            rawzip::CompressionMethod::STORE => Box::new(local.data()),
            rawzip::CompressionMethod::DEFLATE => Box::new(flate2::bufread::DeflateDecoder::new(local.data())),
            other => {
                return Err(format!("{name} has the compression {other:?}; save it with numpy.savez"));
            }
        };
        let mut content = local.verifying_reader(content).take(room + 1);
        let mut expanded = Vec::new();
        let cut = |error: std::io::Error| format!("{name} is damaged ({error}); save or copy the archive again");
        content.read_to_end(&mut expanded).map_err(cut)?;
        room = room.checked_sub(expanded.len() as u64).ok_or(
            "the arrays expand to more than a hundred times the file's size, which no recording does; save them without compression",
        )?;
        arrays.extend(array(name, &expanded)?);
    }
    if arrays.is_empty() {
        return Err(
            "the archive has no .npy array of numbers: give a recording itself, or save one with numpy.savez (a spreadsheet: \
             as CSV)"
                .to_owned(),
        );
    }
    Ok(arrays)
}

/// An array in NumPy's format; `None` if its type or its number of dimensions is not that of columns of numbers.
fn array(name: &str, data: &[u8]) -> Result<Option<Array>, String> {
    let damaged = || format!("{name} is damaged or cut; save or copy the archive again");
    let mut bytes = Bytes::new(data, false);
    let header = header(&mut bytes).ok_or_else(damaged)?;
    let descr = between(header, "'descr':", ",").ok_or_else(damaged)?.trim_matches(['\'', ' ']);
    let by_rows = between(header, "'fortran_order':", ",").ok_or_else(damaged)? == "False";
    let shape = between(header, "'shape':", ")").ok_or_else(damaged)?;
    let sizes = shape.trim_matches(['(', ' ']).split(',').map(str::trim).filter(|size| !size.is_empty());
    let sizes: Vec<usize> = sizes.map(str::parse).collect::<Result<_, _>>().map_err(|_| damaged())?;
    let shape = match sizes[..] {
        [] => (1, 1),
        [rows] => (rows, 1),
        [rows, columns] => (rows, columns),
        _ => return Ok(None),
    };
    let count = shape.0.checked_mul(shape.1).ok_or_else(damaged)?;
    let Some(values) = values(descr, count, bytes)? else {
        // Other arrays may have any type.
        return if WANTED.contains(&name) {
            Err(format!(
                "the array {name} has the type {descr}, which is not read; save it as numbers: {name}.astype(float)"
            ))
        } else {
            Ok(None)
        };
    };
    Ok(Some(Array { name: name.to_owned(), shape, by_rows, values: values.ok_or_else(damaged)? }))
}

/// The text of the header, a Python dictionary.
fn header<'a>(bytes: &mut Bytes<'a>) -> Option<&'a str> {
    if bytes.take(6)? != b"\x93NUMPY" {
        return None;
    }
    let length = match bytes.take(2)? {
        [1, _] => usize::from(bytes.u16()?),
        _ => usize::try_from(bytes.u32()?).ok()?,
    };
    std::str::from_utf8(bytes.take(length)?).ok()
}

fn between<'a>(text: &'a str, start: &str, end: &str) -> Option<&'a str> {
    Some(text.split_once(start)?.1.split_once(end)?.0.trim())
}

/// `count` values of NumPy's type `descr`: the outer `None` for a type that is neither a number nor a time, the inner
/// one if the bytes end before.
fn values(descr: &str, count: usize, bytes: Bytes<'_>) -> Result<Option<Option<Column>>, String> {
    let (order, kind) = descr.split_at_checked(1).unwrap_or(("", descr));
    let bytes = bytes.rest(order == ">");
    if let Some(unit) = kind.strip_prefix("M8[").and_then(|unit| unit.strip_suffix(']')) {
        let nanos = match unit {
            "ns" => 1,
            "us" => 1_000,
            "ms" => 1_000_000,
            "s" => 1_000_000_000,
            _ => return Err(format!("times in {unit} are not known; save them in s or ns")),
        };
        let times = bytes.integers(8, true, count);
        let times = times.map(|times| times.into_iter().map(|time| time.saturating_mul(nanos)).collect());
        return Ok(Some(times.map(Column::Nanos)));
    }
    let size = kind.get(1..).and_then(|size| size.parse::<usize>().ok()).unwrap_or(0);
    Ok(match (kind.chars().next(), size) {
        (Some('f'), 2 | 4 | 8) => Some(bytes.numbers(size, count).map(Column::Numbers)),
        (Some('i'), 1 | 2 | 4 | 8) => Some(bytes.integers(size, true, count).map(Column::Integers)),
        (Some('u' | 'b'), 1 | 2 | 4 | 8) => Some(bytes.integers(size, false, count).map(Column::Integers)),
        _ => None,
    })
}
