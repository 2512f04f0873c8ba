//! Column maps of known systems, which are chosen by the header.

use std::path::Path;
use std::sync::LazyLock;

use crate::column_map::template::capture;
use crate::draft;
use crate::header::Plan;
use crate::{ColumnMap, Quantity, RecordingError, Warning};

/// A ready map: its file in `assets/maps` and its text.
macro_rules! ready {
    ($name:literal) => {
        ($name, include_str!(concat!("../maps/", $name, ".toml")))
    };
}

/// The ready maps; the first one whose columns are present is used.
const MAPS: &[(&str, &str)] = &[
    ready!("ur_rtde"),
    ready!("libfranka"),
    ready!("joint_state"),
    ready!("rostopic_echo"),
    ready!("ros2_topic_echo"),
    ready!("lerobot"),
    ready!("arrays"),
];

static READY: LazyLock<Vec<ColumnMap>> = LazyLock::new(|| {
    let parse = |(name, text): &(&str, &str)| {
        let path = format!("assets/maps/{name}.toml");
        ColumnMap::parse(text, Path::new(&path)).expect("a test parses every ready map")
    };
    MAPS.iter().map(parse).collect()
});

/// The ready map for a file with these headers and topics.
pub fn of(headers: &[String], topics: &[String]) -> Option<ColumnMap> {
    let has = |name: &str| headers.iter().any(|header| header == name);
    // Columns that testbed itself writes need no map.
    if has("t") && headers.iter().any(|header| header.starts_with("q_")) {
        return None;
    }
    let is_there = |pattern: &String| has(pattern) || headers.iter().any(|header| capture(pattern, header).is_some());
    let known = |map: &&ColumnMap| {
        let system = map.system.as_ref();
        system.is_some_and(|system| system.known_by.iter().all(is_there))
    };
    READY.iter().find(known).map(|map| map.with_topics(topics))
}

/// The plan of a ready map for a file with these headers, whose first row has the cells `first`, and a warning that
/// names the system.
///
/// # Errors
/// The missing columns, and the remedy.
pub fn plan(
    map: &ColumnMap,
    headers: &[String],
    first: &[String],
    file: &Path,
    has_lines: bool,
) -> Result<(Plan, Warning), RecordingError> {
    let Some(system) = &map.system else {
        return Err(RecordingError::Header {
            path: file.to_owned(),
            has_lines,
            reason: "there is no system of that name".to_owned(),
        });
    };
    let mut plan = map.plan(headers, first, file).map_err(|error| match error {
        RecordingError::Map { reason, .. } => RecordingError::Header {
            path: file.to_owned(),
            has_lines,
            reason: if reason.contains("--map") {
                reason
            } else {
                format!(
                    "the columns look like those of {}, but {reason}; {}{}",
                    system.name,
                    system.remedy,
                    draft::map(headers)
                )
            },
        },
        other => other,
    })?;
    // Text columns of the system itself, such as a frame's name, are not reported.
    let is_text = |index: usize| first.get(index).is_some_and(|cell| cell.trim().parse::<f64>().is_err());
    plan.others.retain(|(index, _)| !is_text(*index));
    let example = |quantity: Quantity| {
        let channel = plan.channels.iter().find(|channel| channel.quantity == quantity);
        channel.map_or("", |channel| channel.header.as_str())
    };
    let note = Warning::System {
        system: system.name.clone(),
        columns: format!(
            "time \"{}\", position \"{}\", torque \"{}\", and so on",
            plan.time.header,
            example(Quantity::Position),
            example(Quantity::Torque)
        ),
        numbered: plan.joints.iter().all(|joint| joint.parse::<usize>().is_ok()),
    };
    Ok((plan, note))
}
