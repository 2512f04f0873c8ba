//! MATLAB's files of version 5 (`save -v7` and before), with one variable per quantity.

use std::io::Read;

use super::{Format, Options};
use crate::RecordingError;
use crate::arrays::{self, Array};
use crate::bytes::Bytes;
use crate::input::{Input, most_expanded};
use crate::table::{Column, Table};

const NAME: &str = ".mat";
/// The length of the header, and the position of its last four bytes: version and byte order.
const HEADER: usize = 128;
const VERSION: usize = 124;

/// Types of data elements.
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
/// Classes of arrays of numbers: double to uint64. Classes of structures and objects, which include tables and time
/// series.
const STRUCTURES: std::ops::RangeInclusive<u8> = 2..=3;
const NUMERIC: std::ops::RangeInclusive<u8> = 6..=15;

/// MATLAB, version 5.
pub struct Mat;

impl Format for Mat {
    fn matches(&self, input: &Input) -> bool {
        let marks = input.head.get(VERSION..HEADER);
        input.head.starts_with(b"MATLAB 5") || matches!(marks, Some([0, 1, b'I', b'M'] | [1, 0, b'M', b'I']))
    }

    fn read(&self, input: Input, _: &Options<'_>) -> Result<Table, RecordingError> {
        let data = input.to_bytes()?;
        let (arrays, structures) = read(&data).map_err(|reason| input.error(NAME, reason))?;
        if let ([], [structure, ..]) = (&arrays[..], &structures[..]) {
            let reason = format!(
                "it holds the structure or table \"{structure}\", which is not read; save its fields as variables: \
                 save(\"run.mat\", \"-struct\", \"{structure}\", \"-v7\") of a structure, save(\"run.mat\", \"t\", \"q\", \"tau\", \
                 \"-v7\") of arrays"
            );
            return Err(input.error(NAME, reason));
        }
        arrays::table(&input, NAME, &arrays)
    }
}

const DAMAGED: &str = "the file is damaged or cut; save or copy it again";

/// The variables that are real arrays of numbers with two dimensions, and the names of those that are structures or objects.
fn read(data: &[u8]) -> Result<(Vec<Array>, Vec<String>), String> {
    let big_endian = match data.get(VERSION + 2..HEADER) {
        Some(b"IM") => false,
        Some(b"MI") => true,
        _ => return Err(DAMAGED.to_owned()),
    };
    let mut room = most_expanded(data.len() as u64);
    let (mut arrays, mut structures) = (Vec::new(), Vec::new());
    let mut take = |found: Option<Variable>| match found {
        Some(Variable::Array(array)) => arrays.push(array),
        Some(Variable::Structure(name)) => structures.push(name),
        None => {}
    };
    let mut bytes = Bytes::new(&data[HEADER..], big_endian);
    while bytes.left() > 0 {
        let (kind, content) = element(&mut bytes, true).ok_or(DAMAGED)?;
        if kind != COMPRESSED {
            take(variable(kind, content, big_endian)?);
            continue;
        }
        let mut expanded = Vec::new();
        let mut decoder = flate2::read::ZlibDecoder::new(content).take(room + 1);
        decoder.read_to_end(&mut expanded).map_err(|_| DAMAGED)?;
        room = room.checked_sub(expanded.len() as u64).ok_or(
            "the variables expand to more than a hundred times the file's size, which no recording does; save them with -v6",
        )?;
        let (kind, content) = element(&mut Bytes::new(&expanded, big_endian), false).ok_or(DAMAGED)?;
        take(variable(kind, content, big_endian)?);
    }
    Ok((arrays, structures))
}

/// The next data element: its type and its bytes. Elements begin at multiples of eight bytes, except for compressed
/// ones.
fn element<'a>(bytes: &mut Bytes<'a>, is_outer: bool) -> Option<(u32, &'a [u8])> {
    let kind = bytes.u32()?;
    if kind >> 16 != 0 {
        // A small element contains its length beside its type, and its data in the next four bytes.
        let data = bytes.take(4)?;
        return Some((kind & 0xFFFF, data.get(..(kind >> 16) as usize)?));
    }
    let length = usize::try_from(bytes.u32()?).ok()?;
    let data = bytes.take(length)?;
    if !(is_outer && kind == COMPRESSED) && bytes.left() > 0 {
        bytes.align(8)?;
    }
    Some((kind, data))
}

/// A variable that is used, or the name of one that could be converted.
enum Variable {
    Array(Array),
    /// The name of a structure or an object.
    Structure(String),
}

/// A variable, if it is a two-dimensional array of real numbers, or a structure.
fn variable(kind: u32, content: &[u8], big_endian: bool) -> Result<Option<Variable>, String> {
    if kind != MATRIX {
        return Ok(None);
    }
    let mut bytes = Bytes::new(content, big_endian);
    let mut next = || element(&mut bytes, false).ok_or(DAMAGED);
    let ((_, flags), (_, sizes), (_, name)) = (next()?, next()?, next()?);
    let flags = Bytes::new(flags, big_endian).u32().ok_or(DAMAGED)?;
    let (class, is_complex) = ((flags & 0xFF) as u8, flags & 0x800 != 0);
    if STRUCTURES.contains(&class) {
        return Ok(Some(Variable::Structure(String::from_utf8_lossy(name).into_owned())));
    }
    let sizes = Bytes::new(sizes, big_endian).integers(4, true, sizes.len() / 4).ok_or(DAMAGED)?;
    let (&[rows, columns], false, true) = (&sizes[..], is_complex, NUMERIC.contains(&class)) else {
        return Ok(None);
    };
    let size = |size: i64| usize::try_from(size).map_err(|_| DAMAGED);
    let shape = (size(rows)?, size(columns)?);
    let count = shape.0.checked_mul(shape.1).ok_or(DAMAGED)?;
    let (kind, data) = next()?;
    let data = Bytes::new(data, big_endian);
    // Numbers are stored in the smallest type that represents them.
    let values = match kind {
        1 => data.integers(1, true, count).map(Column::Integers),
        2 => data.integers(1, false, count).map(Column::Integers),
        3 => data.integers(2, true, count).map(Column::Integers),
        4 => data.integers(2, false, count).map(Column::Integers),
        5 => data.integers(4, true, count).map(Column::Integers),
        6 => data.integers(4, false, count).map(Column::Integers),
        7 => data.numbers(4, count).map(Column::Numbers),
        9 => data.numbers(8, count).map(Column::Numbers),
        12 => data.integers(8, true, count).map(Column::Integers),
        13 => data.integers(8, false, count).map(Column::Integers),
        _ => None,
    };
    Ok(Some(Variable::Array(Array {
        name: String::from_utf8_lossy(name).into_owned(),
        shape,
        by_rows: false,
        values: values.ok_or(DAMAGED)?,
    })))
}
