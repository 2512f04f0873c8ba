//! Formats that are recognised but not read, with the format to convert them into.

use super::{Format, Options};
use crate::RecordingError;
use crate::input::Input;
use crate::table::Table;

/// The first bytes of a format, its name, and the remedy.
const KNOWN: &[(&[u8], &str, &str)] = &[
    (
        b"MATLAB 7.3",
        ".mat",
        "version 7.3 (HDF5) is not read; save it again from MATLAB: save(\"run.mat\", \"t\", \"q\", \"tau\", \"-v7\"); or from Python: \
         scipy.io.savemat(\"run.mat\", {\"t\": t, \"q\": q, \"tau\": tau})",
    ),
    (b"\x89HDF\r\n", "HDF5", "it is not read; save its arrays with numpy.savez, or its table as Parquet or CSV"),
    (
        b"#ROSBAG",
        "a bag of ROS 1",
        "it is not read; convert it into a bag of ROS 2: pip install rosbags, then rosbags-convert --src run.bag --dst run",
    ),
    (
        b"ARROW1",
        "Feather (Arrow)",
        "it is not read; save the table as Parquet: pandas.read_feather(\"run.feather\").to_parquet(\"run.parquet\")",
    ),
    (b"\xfd7zXZ\0", "xz", "it is not read; expand it: xz -d FILE"),
    (b"BZh", "bzip2", "it is not read; expand it: bzip2 -d FILE"),
    (b"\x93NUMPY", ".npy", "a single array has no names for its columns; save t, q and tau with numpy.savez"),
];

/// The format that is recognised but not read.
pub struct Unread;

/// Whether a file with this beginning is a .mat file of version 4: the type of its first variable (four decimal digits), its rows and
/// columns, whether it is complex, and the length of its name with the zero byte at the end.
fn is_mat_4(head: &[u8]) -> bool {
    let word = |at: usize| {
        let bytes = head.get(4 * at..4 * at + 4)?;
        Some(u32::from_le_bytes(bytes.try_into().ok()?))
    };
    let (Some(kind), Some(rows), Some(columns), Some(complex), Some(length)) =
        (word(0), word(1), word(2), word(3), word(4))
    else {
        return false;
    };
    let name = usize::try_from(length).ok().and_then(|length| head.get(20..20 + length));
    let is_name = |name: &[u8]| {
        let (end, letters) = name.split_last().unwrap_or((&1, &[]));
        *end == 0
            && !letters.is_empty()
            && letters.iter().all(|letter| letter.is_ascii_alphanumeric() || *letter == b'_')
    };
    kind < 60 && rows > 0 && columns > 0 && complex < 2 && name.is_some_and(is_name)
}

/// The name and the remedy of a format with this beginning.
fn known(head: &[u8]) -> Option<(&'static str, &'static str)> {
    let known = KNOWN.iter().find(|(mark, _, _)| head.starts_with(mark));
    if let Some((_, name, remedy)) = known {
        return Some((name, remedy));
    }
    if is_mat_4(head) {
        let remedy = "version 4 is not read; save it again from MATLAB: save(\"run.mat\", \"t\", \"q\", \"tau\", \"-v7\"); or from \
                      Python: scipy.io.savemat(\"run.mat\", {\"t\": t, \"q\": q, \"tau\": tau})";
        return Some((".mat", remedy));
    }
    // A pickle begins with its protocol, 2 to 5. JSON has no signature: an object begins with a name, an array with a value.
    if let [0x80, 2..=5, ..] = head {
        let remedy = "it is not read, because to open one is to run it; save the table as Parquet or CSV";
        return Some(("a Python pickle", remedy));
    }
    let mut text = head.iter().filter(|letter| !letter.is_ascii_whitespace());
    let is_json =
        matches!((text.next(), text.next()), (Some(b'{'), Some(b'"' | b'}')) | (Some(b'['), Some(b'{' | b'[')));
    let remedy = "it is not read; save the table as Parquet or CSV: pandas.read_json(\"run.json\").to_csv(\"run.csv\", \
                  index=False), with lines=True for one object a line";
    is_json.then_some(("JSON", remedy))
}

impl Format for Unread {
    fn matches(&self, input: &Input) -> bool {
        known(&input.head).is_some()
    }

    fn read(&self, input: Input, _: &Options<'_>) -> Result<Table, RecordingError> {
        let (name, remedy) = known(&input.head).unwrap_or(("a format", "it is not read"));
        Err(input.error(name, remedy))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compressed_files_are_called_by_their_format() {
        let name = |head: &[u8]| known(head).map(|(name, _)| name);
        assert_eq!(name(b"\xfd7zXZ\0\x00\x04"), Some("xz"));
        assert_eq!(name(b"BZh91AY&SY"), Some("bzip2"));
        assert_eq!(name(b"t,q_a,tau_a"), None);
    }
}
