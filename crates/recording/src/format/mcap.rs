//! MCAP files (mcap.dev/spec) with joint states of ROS 2.

use std::collections::HashMap;
use std::io::{BufReader, Read, Seek, SeekFrom};

use super::{Format, Options};
use crate::bytes::Bytes;
use crate::input::{Input, most_expanded};
use crate::joint_state::{JointStates, TYPES};
use crate::location::Location;
use crate::table::Table;
use crate::{RecordingError, Warning};

const NAME: &str = "MCAP";
const MAGIC: &[u8] = b"\x89MCAP0\r\n";
/// The types of records that are read.
const SCHEMA: u8 = 3;
const CHANNEL: u8 = 4;
const MESSAGE: u8 = 5;
const CHUNK: u8 = 6;
const DATA_END: u8 = 15;

/// MCAP.
pub struct Mcap;

impl Format for Mcap {
    fn matches(&self, input: &Input) -> bool {
        input.head.starts_with(MAGIC)
    }

    fn read(&self, input: Input, options: &Options<'_>) -> Result<Table, RecordingError> {
        let mut states = JointStates::new(options.seconds);
        let found = read_into(&input, options, &mut states)?;
        if states.messages() == 0 {
            return Err(input.error(NAME, no_states(found.topics, options)));
        }
        let mut table = states.into_table(&input, NAME, options.topics)?;
        table.warnings.extend(found.warning);
        Ok(table)
    }
}

/// What a file of a bag holds beside its joint states.
pub struct Found {
    /// Its topics, with the type and the encoding of their messages.
    pub topics: Vec<String>,
    /// The warning that it is cut.
    pub warning: Option<Warning>,
}

/// A channel: its topic, whether it has joint states and is requested, and what it has.
struct Channel {
    topic: String,
    kind: String,
    is_wanted: bool,
}

struct Reader<'a> {
    options: &'a Options<'a>,
    states: &'a mut JointStates,
    schemas: HashMap<u16, String>,
    channels: HashMap<u16, Channel>,
    /// The number of bytes that may still be expanded.
    room: u64,
}

/// Reads the joint states of an MCAP file.
///
/// # Errors
/// [`RecordingError::Format`] if it is damaged.
pub fn read_into(input: &Input, options: &Options<'_>, states: &mut JointStates) -> Result<Found, RecordingError> {
    let mut file = input.to_file()?;
    let failed = |reason: std::io::Error| RecordingError::Read { path: input.path.clone(), reason };
    let size = file.seek(SeekFrom::End(0)).map_err(failed)?;
    let mut at = MAGIC.len() as u64;
    file.seek(SeekFrom::Start(at)).map_err(failed)?;
    let mut file = BufReader::new(file);
    let mut reader =
        Reader { options, states, schemas: HashMap::new(), channels: HashMap::new(), room: most_expanded(size) };
    let mut is_whole = false;
    while size - at >= 9 {
        let mut head = [0; 9];
        file.read_exact(&mut head).map_err(failed)?;
        let [kind, length @ ..] = head;
        let length = u64::from_le_bytes(length);
        at += 9;
        if kind == DATA_END {
            is_whole = true;
            break;
        }
        if length > size - at {
            break;
        }
        if [SCHEMA, CHANNEL, MESSAGE, CHUNK].contains(&kind) {
            let mut record = Vec::new();
            (&mut file).take(length).read_to_end(&mut record).map_err(failed)?;
            reader
                .record(kind, &record)
                .map_err(|reason| input.error(NAME, format!("the record at byte {}: {reason}", at - 9)))?;
        } else {
            let step = i64::try_from(length).map_err(|_| input.error(NAME, "a record is too long"))?;
            file.seek_relative(step).map_err(failed)?;
        }
        at += length;
    }
    let topics = reader.channels.values();
    let topics = topics.map(|channel| format!("{} ({})", channel.topic, channel.kind));
    let topics = topics.collect();
    let place = Location::Message(states.messages() + 1);
    let warning = (!is_whole).then_some(Warning::CutFile { line: place });
    Ok(Found { topics, warning })
}

/// The error that there are no joint states, with the existing topics.
pub fn no_states(mut topics: Vec<String>, options: &Options<'_>) -> String {
    topics.sort_unstable();
    topics.dedup();
    let more = if topics.len() > 8 { ", …" } else { "" };
    topics.truncate(8);
    let of = if options.topics.is_empty() { String::new() } else { format!(" in {}", options.topics.join(", ")) };
    if topics.is_empty() {
        return format!(
            "there are no whole messages{of}: was anything recorded, or was the file cut within its first chunk? A recorder \
             that is killed may leave such a file; record in smaller chunks"
        );
    }
    format!(
        "there are no messages sensor_msgs/msg/JointState in CDR, as ROS 2 writes them{of}; its topics are {}{more}; record the \
         joint states, convert other messages into these or into CSV, and check `topics` in the column map",
        topics.join(", ")
    )
}

impl Reader<'_> {
    fn record(&mut self, kind: u8, record: &[u8]) -> Result<(), String> {
        let taken = match kind {
            SCHEMA => self.schema(record),
            CHANNEL => self.channel(record),
            MESSAGE => return self.message(record),
            CHUNK => return self.chunk(record),
            _ => Some(()),
        };
        taken.ok_or_else(|| "it is damaged; copy the file again".to_owned())
    }

    fn schema(&mut self, record: &[u8]) -> Option<()> {
        let mut bytes = Bytes::new(record, false);
        let id = bytes.u16()?;
        self.schemas.insert(id, bytes.text()?.to_owned());
        Some(())
    }

    fn channel(&mut self, record: &[u8]) -> Option<()> {
        let mut bytes = Bytes::new(record, false);
        let (id, schema) = (bytes.u16()?, bytes.u16()?);
        let (topic, encoding) = (bytes.text()?, bytes.text()?);
        let schema = self.schemas.get(&schema).map_or("", String::as_str);
        let wanted = self.options.topics;
        let is_wanted = TYPES.contains(&schema)
            && encoding == "cdr"
            && (wanted.is_empty() || wanted.iter().any(|wanted| wanted == topic));
        let kind = match (schema, encoding) {
            (_, "cdr") => schema.to_owned(),
            ("", _) => format!("in {encoding}"),
            _ => format!("{schema} in {encoding}"),
        };
        let topic = topic.to_owned();
        self.channels.insert(id, Channel { topic, kind, is_wanted });
        Some(())
    }

    fn message(&mut self, record: &[u8]) -> Result<(), String> {
        let mut bytes = Bytes::new(record, false);
        let head = |bytes: &mut Bytes<'_>| Some((bytes.u16()?, bytes.u32()?, bytes.u64()?, bytes.u64()?));
        let (channel, _, logged, _) = head(&mut bytes).ok_or("a message is cut")?;
        match self.channels.get(&channel) {
            Some(channel) if channel.is_wanted => {
                let data = bytes.take(bytes.left()).unwrap_or_default();
                self.states.add(&channel.topic, logged.cast_signed(), data)
            }
            _ => Ok(()),
        }
    }

    fn chunk(&mut self, record: &[u8]) -> Result<(), String> {
        let mut bytes = Bytes::new(record, false);
        let head = |bytes: &mut Bytes<'_>| {
            bytes.take(16)?;
            let (size, checksum) = (bytes.u64()?, bytes.u32()?);
            let compression = bytes.text()?.to_owned();
            let length = usize::try_from(bytes.u64()?).ok()?;
            Some((size, checksum, compression, length))
        };
        let damaged = "the chunk is damaged; copy the file again";
        let (size, checksum, compression, length) = head(&mut bytes).ok_or(damaged)?;
        let data = bytes.take(length).ok_or(damaged)?;
        if !compression.is_empty() {
            self.room = self.room.checked_sub(size).ok_or(
                "the chunks expand to more than a hundred times the file's size, which no recording does; expand them before",
            )?;
        }
        let mut expanded = Vec::new();
        let source: Box<dyn Read> = match compression.as_str() {
            "" => Box::new(data),
            "lz4" => Box::new(lz4_flex::frame::FrameDecoder::new(data)),
            "zstd" => Box::new(zstd::stream::read::Decoder::new(data).map_err(|_| damaged)?),
            other => return Err(format!("compression \"{other}\" is not known; use zstd, lz4 or none")),
        };
        source.take(size).read_to_end(&mut expanded).map_err(|_| damaged)?;
        if checksum != 0 && crc32fast::hash(&expanded) != checksum {
            return Err(damaged.to_owned());
        }
        let mut records = Bytes::new(&expanded, false);
        while records.left() > 0 {
            let mut next = || {
                let kind = *records.take(1)?.first()?;
                let length = usize::try_from(records.u64()?).ok()?;
                Some((kind, records.take(length)?))
            };
            let (kind, record) = next().ok_or(damaged)?;
            if kind != CHUNK {
                self.record(kind, record)?;
            }
        }
        Ok(())
    }
}
