//! Writes small bags of joint states, of one joint each message.

use std::path::Path;

use rusqlite::{Connection, params};

/// The stamp of the first message (s).
const EPOCH: f64 = 1_700_000_000.0;

/// A message to be written.
#[derive(Clone, Debug)]
pub struct Message {
    topic: &'static str,
    joint: &'static str,
    stamp: i64,
    /// The time of logging.
    logged: i64,
    /// Positions, velocities and efforts.
    fields: [Vec<f64>; 3],
}

/// Position and effort at a time (s).
pub fn motion(t: f64) -> [f64; 2] {
    [(0.5 * t).sin(), (0.3 * t).cos()]
}

fn message(topic: &'static str, stamp: f64, fields: [Vec<f64>; 3]) -> Message {
    let joint = "elbow";
    let stamp = EPOCH as i64 * 1_000_000_000 + (stamp * 1e9).round() as i64;
    Message { topic, joint, stamp, logged: stamp, fields }
}

/// Position and effort at `t` (s), stamped `stamp` (s).
pub fn state(t: f64, stamp: f64) -> Message {
    let [q, tau] = motion(t);
    message("/joints", stamp, [vec![q], Vec::new(), vec![tau]])
}

/// The position at `t` (s) in a topic of its own.
pub fn positions(t: f64) -> Message {
    message("/positions", t, [vec![motion(t)[0]], Vec::new(), Vec::new()])
}

/// The effort at `t` (s) in a topic of its own.
pub fn efforts(t: f64) -> Message {
    message("/torques", t, [Vec::new(), Vec::new(), vec![motion(t)[1]]])
}

impl Message {
    /// The message without a stamp.
    pub fn unstamped(self) -> Self {
        Self { stamp: 0, ..self }
    }

    /// The message with the stamp of a simulation, which begins at 0 s.
    pub fn simulated(self) -> Self {
        let stamp = self.stamp - EPOCH as i64 * 1_000_000_000;
        Self { stamp, ..self }
    }

    /// The message of another joint.
    pub fn of(self, joint: &'static str) -> Self {
        Self { joint, ..self }
    }

    /// In CDR, little endian.
    fn cdr(&self) -> Vec<u8> {
        fn text(body: &mut Vec<u8>, text: &str) {
            pad(body, 4);
            body.extend((text.len() as u32 + 1).to_le_bytes());
            body.extend(text.bytes());
            body.push(0);
        }
        fn pad(body: &mut Vec<u8>, size: usize) {
            body.resize(body.len().next_multiple_of(size), 0);
        }
        let mut body = Vec::new();
        body.extend(((self.stamp / 1_000_000_000) as u32).to_le_bytes());
        body.extend(((self.stamp % 1_000_000_000) as u32).to_le_bytes());
        text(&mut body, "base");
        pad(&mut body, 4);
        body.extend(1_u32.to_le_bytes());
        text(&mut body, self.joint);
        for values in &self.fields {
            pad(&mut body, 4);
            body.extend((values.len() as u32).to_le_bytes());
            if !values.is_empty() {
                pad(&mut body, 8);
            }
            values.iter().for_each(|value| body.extend(value.to_le_bytes()));
        }
        [&[0, 1, 0, 0], &body[..]].concat()
    }
}

/// The topics of `messages`, in their order.
fn topics(messages: &[Message]) -> Vec<&'static str> {
    let mut topics = Vec::new();
    for message in messages {
        if !topics.contains(&message.topic) {
            topics.push(message.topic);
        }
    }
    topics
}

fn number(topics: &[&str], message: &Message) -> u16 {
    let at = topics.iter().position(|topic| *topic == message.topic);
    at.expect("a topic") as u16 + 1
}

/// Writes an MCAP file without chunks.
pub fn write_mcap(path: &Path, messages: &[Message]) {
    let text = |text: &str| [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat();
    let mut file = b"\x89MCAP0\r\n".to_vec();
    let mut record = |kind: u8, body: &[&[u8]]| {
        let body = body.concat();
        file.push(kind);
        file.extend((body.len() as u64).to_le_bytes());
        file.extend(body);
    };
    let one = 1_u16.to_le_bytes();
    record(3, &[&one, &text("sensor_msgs/msg/JointState"), &text("ros2msg"), &text("")]);
    let topics = topics(messages);
    for (topic, id) in topics.iter().zip(1_u16..) {
        record(4, &[&id.to_le_bytes(), &one, &text(topic), &text("cdr"), &[0; 4]]);
    }
    for message in messages {
        let logged = message.logged.to_le_bytes();
        let channel = number(&topics, message).to_le_bytes();
        record(5, &[&channel, &[0; 4], &logged, &logged, &message.cdr()]);
    }
    record(15, &[&[0; 4]]);
    std::fs::write(path, file).expect("it is written");
}

/// Writes a database of rosbag2.
pub fn write_database(path: &Path, messages: &[Message]) {
    let mut database = Connection::open(path).expect("a database");
    let tables = "CREATE TABLE topics (id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);
        CREATE TABLE messages (id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);";
    database.execute_batch(tables).expect("it is written");
    let all = database.transaction().expect("a transaction");
    let topics = topics(messages);
    for (topic, id) in topics.iter().zip(1_u16..) {
        let row = params![id, topic, "sensor_msgs/msg/JointState", "cdr"];
        all.execute("INSERT INTO topics VALUES (?1, ?2, ?3, ?4)", row).expect("it is written");
    }
    let insert = "INSERT INTO messages (topic_id, timestamp, data) VALUES (?1, ?2, ?3)";
    let mut insert = all.prepare(insert).expect("it is prepared");
    for message in messages {
        let row = params![number(&topics, message), message.logged, message.cdr()];
        insert.execute(row).expect("it is written");
    }
    drop(insert);
    all.commit().expect("it is written");
}
