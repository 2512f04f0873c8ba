//! Bags of ROS 2: a folder of files, and the files of the storage sqlite3.

use std::collections::HashMap;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use rusqlite::limits::Limit;
use rusqlite::{Connection, OpenFlags};

use super::mcap::{self, Found, no_states};
use super::{Format, Options};
use crate::RecordingError;
use crate::input::{Input, most_expanded};
use crate::joint_state::{JointStates, TYPES};
use crate::table::Table;

const NAME: &str = "rosbag2";
const SQLITE: &[u8] = b"SQLite format 3\0";
const ZSTD: &[u8] = &[0x28, 0xB5, 0x2F, 0xFD];

/// A bag's folder, or one of its files if it is a database.
pub struct Rosbag2;

impl Format for Rosbag2 {
    fn matches(&self, input: &Input) -> bool {
        input.is_folder() || input.head.starts_with(SQLITE)
    }

    fn read(&self, input: Input, options: &Options<'_>) -> Result<Table, RecordingError> {
        let mut states = JointStates::new(options.seconds);
        if !input.is_folder() {
            let found = database(&input, options, &mut states)?;
            if states.messages() == 0 {
                return Err(input.error(NAME, no_states(found.topics, options)));
            }
            return states.into_table(&input, NAME, options.topics);
        }
        let unreadable = |reason| RecordingError::Read { path: input.path.clone(), reason };
        let mut files = Vec::new();
        for entry in std::fs::read_dir(&input.path).map_err(unreadable)? {
            let path = entry.map_err(unreadable)?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            // The journal and the index of a database are not files of the bag.
            let is_part = [".db3", ".db3.zstd", ".mcap", ".mcap.zstd"].iter().any(|end| name.ends_with(end));
            if is_part && path.is_file() {
                refuse_outside(&input, &path)?;
                files.push(path);
            }
        }
        files.sort_by_key(|path| part_number(path));
        if files.is_empty() {
            return Err(input.error(NAME, no_bag(&input.path)));
        }
        let (mut topics, mut warnings) = (Vec::new(), Vec::new());
        for path in files {
            let part = Input::open(&path)?;
            states.begin_file();
            let found = match part.head.starts_with(SQLITE) {
                true => database(&part, options, &mut states)?,
                false => mcap::read_into(&part, options, &mut states)?,
            };
            topics.extend(found.topics);
            warnings.extend(found.warning);
        }
        // A part of a bag may have none.
        if states.messages() == 0 {
            return Err(input.error(NAME, no_states(topics, options)));
        }
        let mut table = states.into_table(&input, NAME, options.topics)?;
        table.warnings.extend(warnings);
        Ok(table)
    }
}

/// What a bag's files are sorted by: NAME_2.db3 comes before NAME_10.db3.
fn part_number(path: &Path) -> (String, u64, PathBuf) {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let stem = [".zstd", ".db3", ".mcap"].iter().fold(&*name, |name, end| name.strip_suffix(end).unwrap_or(name));
    let start = stem.trim_end_matches(|letter: char| letter.is_ascii_digit());
    let number = stem[start.len()..].parse().unwrap_or(0);
    (start.to_owned(), number, path.to_owned())
}

/// The remedy for a folder that is not a bag; it names a recording below the folder if there is one.
fn no_bag(folder: &Path) -> String {
    const DEPTH: usize = 4;
    /// The largest number of folders that are searched on each level.
    const FOLDERS: usize = 64;
    let mut level = vec![folder.to_owned()];
    for _ in 0..DEPTH {
        let mut entries: Vec<_> = level
            .iter()
            .filter_map(|folder| std::fs::read_dir(folder).ok())
            .flatten()
            .filter_map(|entry| Some(entry.ok()?.path()))
            .collect();
        entries.sort();
        let has_end = |path: &&PathBuf| {
            let name = path.to_string_lossy();
            [".parquet", ".db3", ".mcap", ".csv", ".npz", ".mat"].iter().any(|end| name.ends_with(end))
        };
        if let Some(first) = entries.iter().find(has_end) {
            return format!(
                "it is a folder without .db3 or .mcap files, and so no bag; give the recordings themselves, such as {}",
                first.display()
            );
        }
        level = entries.into_iter().filter(|path| path.is_dir() && !path.is_symlink()).take(FOLDERS).collect();
    }
    "it is a folder without .db3 or .mcap files, and so no bag; give a recording's file or a bag's folder".to_owned()
}

/// Refuses a link in the folder of a bag that leads out of the folder.
fn refuse_outside(input: &Input, path: &Path) -> Result<(), RecordingError> {
    let [folder, target] = [input.path.as_path(), path].map(std::fs::canonicalize);
    if matches!((folder, target), (Ok(folder), Ok(target)) if target.starts_with(&folder)) {
        return Ok(());
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    Err(input.error(NAME, format!("{name} is a link that leads out of the bag's folder; copy the file into it")))
}

/// Reads the joint states of a database.
fn database(input: &Input, options: &Options<'_>, states: &mut JointStates) -> Result<Found, RecordingError> {
    // An expanded file, or a pipe, has no path.
    let copy = if input.is_unchanged() {
        None
    } else {
        let failed = |reason| RecordingError::Read { path: input.path.clone(), reason };
        let mut copy = tempfile::NamedTempFile::new().map_err(failed)?;
        std::io::copy(&mut input.to_file()?, &mut copy).map_err(failed)?;
        copy.flush().map_err(failed)?;
        Some(copy)
    };
    let path = copy.as_ref().map_or(input.path.as_path(), tempfile::NamedTempFile::path);
    let size = std::fs::metadata(path).map_or(0, |metadata| metadata.len());
    match messages(path, most_expanded(size), options, states) {
        Ok(topics) => Ok(Found { topics, warning: None }),
        Err(Failure::Database(error)) => Err(input.error(
            NAME,
            format!("the database cannot be read ({error}); copy the bag again, with all files of its folder"),
        )),
        Err(Failure::Message(reason)) => Err(input.error(NAME, reason)),
    }
}

enum Failure {
    Database(rusqlite::Error),
    Message(String),
}

impl From<rusqlite::Error> for Failure {
    fn from(error: rusqlite::Error) -> Self {
        Self::Database(error)
    }
}

/// Reads the messages of all requested topics with joint states; returns all topics.
fn messages(path: &Path, most: u64, options: &Options<'_>, states: &mut JointStates) -> Result<Vec<String>, Failure> {
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let database = Connection::open_with_flags(path, flags)?;
    // Views and generated columns are computed by SQL, which may never end or produce gigabytes.
    database.set_limit(Limit::SQLITE_LIMIT_LENGTH, i32::try_from(most).unwrap_or(i32::MAX))?;
    database.pragma_update(None, "trusted_schema", false)?;
    for table in ["topics", "messages"] {
        let stored = "SELECT count(*) FROM sqlite_schema WHERE type = 'table' AND rootpage > 0 AND name = ?1";
        let made = "SELECT count(*) FROM pragma_table_xinfo(?1) WHERE hidden <> 0";
        let count = |query: &str| database.query_row(query, [table], |row| row.get::<_, i64>(0));
        if count(stored)? != 1 || count(made)? != 0 {
            return Err(Failure::Message(format!(
                "its table \"{table}\" is missing or computed; give a bag as ros2 bag wrote it"
            )));
        }
    }
    let mut query = database.prepare("SELECT id, name, type, serialization_format FROM topics ORDER BY name")?;
    let topics = query.query_map([], |row| {
        Ok((row.get::<_, i64>(0)?, row.get::<_, String>(1)?, row.get::<_, String>(2)?, row.get::<_, String>(3)?))
    })?;
    let topics = topics.collect::<Result<Vec<_>, _>>()?;
    let is_wanted = |(_, topic, kind, encoding): &&(i64, String, String, String)| {
        let is_chosen = options.topics.is_empty() || options.topics.contains(topic);
        TYPES.contains(&kind.as_str()) && encoding == "cdr" && is_chosen
    };
    let wanted: HashMap<i64, &str> =
        topics.iter().filter(is_wanted).map(|(id, topic, ..)| (*id, topic.as_str())).collect();
    // In the order in which they were recorded, all topics together.
    let mut query = database.prepare("SELECT topic_id, timestamp, data FROM messages")?;
    let mut room = most;
    let mut rows = query.query([])?;
    while let Some(row) = rows.next()? {
        if let Some(topic) = wanted.get(&row.get::<_, i64>(0)?) {
            let (logged, data) = (row.get::<_, i64>(1)?, row.get_ref(2)?);
            let data = data.as_blob().map_err(|_| Failure::Message(format!("a message of {topic} is no blob")))?;
            if data.starts_with(ZSTD) {
                // The compression mode "message".
                let expanded = expand(data, &mut room).map_err(Failure::Message)?;
                states.add(topic, logged, &expanded).map_err(Failure::Message)?;
            } else {
                states.add(topic, logged, data).map_err(Failure::Message)?;
            }
        }
    }
    drop(rows);
    let named = |(_, topic, kind, _)| format!("{topic} ({kind})");
    Ok(topics.into_iter().map(named).collect())
}

/// The expanded message; its size is subtracted from `room` (bytes).
fn expand(data: &[u8], room: &mut u64) -> Result<Vec<u8>, String> {
    let damaged = |_| "a compressed message is damaged; copy the bag again".to_owned();
    let mut expanded = Vec::new();
    let decoder = zstd::stream::read::Decoder::new(data).map_err(damaged)?;
    decoder.take(*room + 1).read_to_end(&mut expanded).map_err(damaged)?;
    *room = room.checked_sub(expanded.len() as u64).ok_or(
        "its messages expand to more than a hundred times its size, which no recording does; record without compression",
    )?;
    Ok(expanded)
}
