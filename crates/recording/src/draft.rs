//! A proposal of a column map for a file with unknown columns, guessed from their names.

/// The largest number of columns in the list.
const LISTED: usize = 12;
/// The words that identify a column of positions, velocities or torques, the most reliable first.
const POSITION: &[&str] = &["position", "pos", "angle", "theta", "q"];
const VELOCITY: &[&str] = &["velocity", "vel", "speed", "dq", "qd"];
const TORQUE: &[&str] = &["torque", "effort", "moment", "tau", "force"];
const CURRENT: &[&str] = &["current", "curr"];
/// Words of columns with commanded values, which were not measured.
const WANTED: &[&str] = &["target", "desired", "cmd", "command", "ref", "reference", "goal", "d"];

/// A proposal of a column map, if the names of `headers` suggest one; it is appended to an error.
pub fn map(headers: &[String]) -> String {
    draft(headers).map_or(String::new(), |map| {
        format!(
            ". A column map to begin with, guessed from the columns' names (check units and signs; save it as map.toml, and add \
             --map map.toml):\n{map}"
        )
    })
}

/// The list of columns, and the proposal.
pub fn of(headers: &[String]) -> String {
    let mut listed: Vec<String> = headers.iter().take(LISTED).map(|header| format!("\"{header}\"")).collect();
    if headers.len() > LISTED {
        listed.push(format!("and {} more", headers.len() - LISTED));
    }
    format!(". The columns are {}{}", listed.join(", "), map(headers))
}

/// A pattern of columns: its text with `{joint}`, and the joints that match.
struct Pattern {
    text: String,
    joints: Vec<String>,
    words: Vec<String>,
}

fn draft(headers: &[String]) -> Option<String> {
    let patterns = patterns(headers);
    let time = ["time", "t", "timestamp", "stamp", "sec", "seconds"];
    let time =
        time.iter().find_map(|word| headers.iter().find(|header| words(header).iter().any(|part| part == word)))?;
    let unit = ["ms", "us", "ns"].into_iter().find(|unit| words(time).iter().any(|word| word == unit));
    let of = |kinds: &[&str], joints: Option<&[String]>| {
        kinds.iter().find_map(|kind| {
            let mut found = patterns.iter().filter(|pattern| {
                pattern.words.iter().any(|word| word == kind || word.strip_suffix('s') == Some(*kind))
                    && !pattern.words.iter().any(|word| WANTED.contains(&word.as_str()))
                    && joints.is_none_or(|joints| pattern.joints == joints)
            });
            found.next()
        })
    };
    let position = of(POSITION, None)?;
    let torque = of(TORQUE, Some(&position.joints));
    let (tau, extra) = match torque {
        Some(pattern) => (pattern, ""),
        None => (
            of(CURRENT, Some(&position.joints))?,
            "tau_unit = \"A\"\ntau_scale = 1.0 # N m of one ampere, at the joint: replace it\n",
        ),
    };
    let quoted = |text: &str| toml::Value::String(text.to_owned()).to_string();
    let mut map = format!("[time]\ncolumn = {}\n", quoted(time));
    if let Some(unit) = unit {
        map += &format!("unit = \"{unit}\"\n");
    }
    map += &format!("[joints.\"{{joint}}\"]\nq = {}\n", quoted(&position.text));
    if let Some(velocity) = of(VELOCITY, Some(&position.joints)) {
        map += &format!("qd = {}\n", quoted(&velocity.text));
    }
    map += &format!("tau = {}\n{extra}", quoted(&tau.text));
    Some(map)
}

/// The words in a name, in lower case, without digits.
fn words(header: &str) -> Vec<String> {
    let parts = header.split(|letter: char| !letter.is_alphabetic());
    parts.filter(|part| !part.is_empty()).map(str::to_lowercase).collect()
}

/// The patterns of all headers, in their order, in which `{joint}` stands for a number, or for the name before or
/// after a known word.
fn patterns(headers: &[String]) -> Vec<Pattern> {
    let mut patterns: Vec<Pattern> = Vec::new();
    let kinds = || POSITION.iter().chain(VELOCITY).chain(TORQUE).chain(CURRENT);
    for header in headers {
        let mut parts: Vec<(String, String)> = Vec::new();
        let is_digit = |letter: char| letter.is_ascii_digit();
        if let Some(end) = header.rfind(is_digit) {
            let start = header[..=end].rfind(|letter: char| !is_digit(letter));
            let start = start.map_or(0, |at| at + header[at..].chars().next().map_or(1, char::len_utf8));
            parts
                .push((format!("{}{{joint}}{}", &header[..start], &header[end + 1..]), header[start..=end].to_owned()));
        }
        let lower = header.to_lowercase();
        if lower.len() == header.len() {
            for kind in kinds() {
                for between in ["_", ".", "/", " "] {
                    if let Some(joint) = lower.strip_prefix(&format!("{kind}{between}")) {
                        let cut = header.len() - joint.len();
                        parts.push((format!("{}{{joint}}", &header[..cut]), header[cut..].to_owned()));
                    }
                    if let Some(joint) = lower.strip_suffix(&format!("{between}{kind}")) {
                        parts.push((format!("{{joint}}{}", &header[joint.len()..]), header[..joint.len()].to_owned()));
                    }
                }
            }
        }
        for (text, joint) in parts.into_iter().filter(|(_, joint)| !joint.is_empty()) {
            match patterns.iter_mut().find(|pattern| pattern.text == text) {
                Some(pattern) => pattern.joints.push(joint),
                None => {
                    patterns.push(Pattern { words: words(&text.replace("{joint}", "")), joints: vec![joint], text });
                }
            }
        }
    }
    patterns
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::ColumnMap;

    fn drafted(names: &str) -> Option<String> {
        let headers: Vec<String> = names.split(',').map(str::to_owned).collect();
        let map = draft(&headers)?;
        // The proposal is a valid column map.
        let parsed = ColumnMap::parse(&map, Path::new("map.toml")).unwrap_or_else(|error| panic!("{error}: {map}"));
        parsed.plan(&headers, &[], Path::new("r")).unwrap_or_else(|error| panic!("{error}: {map}"));
        Some(map)
    }

    #[test]
    fn a_map_is_guessed_from_numbers_and_names() {
        let arrays = drafted("time,position[0],position[1],torque[0],torque[1]").expect("a map");
        assert_eq!(
            drafted("time,positions_1,torques_1").expect("a map"),
            "[time]\ncolumn = \"time\"\n[joints.\"{joint}\"]\nq = \"positions_{joint}\"\ntau = \"torques_{joint}\"\n"
        );
        assert_eq!(
            arrays,
            "[time]\ncolumn = \"time\"\n[joints.\"{joint}\"]\nq = \"position[{joint}]\"\ntau = \"torque[{joint}]\"\n"
        );
        let named = drafted("stamp_ms,shoulder_pos,elbow_pos,shoulder_vel,elbow_vel,shoulder_torque,elbow_torque");
        assert_eq!(
            named.expect("a map"),
            "[time]\ncolumn = \"stamp_ms\"\nunit = \"ms\"\n[joints.\"{joint}\"]\nq = \"{joint}_pos\"\nqd = \"{joint}_vel\"\n\
             tau = \"{joint}_torque\"\n"
        );
        let currents = drafted("timestamp,target_q_0,actual_q_0,actual_current_0").expect("a map");
        assert!(currents.contains("q = \"actual_q_{joint}\"") && currents.contains("tau_unit = \"A\""), "{currents}");
        for names in ["a,b", "time,position_a", "position_a,torque_a", "time,pos_a,torque_b"] {
            assert_eq!(drafted(names), None, "{names}");
        }
        assert!(of(&["a".to_owned(), "b".to_owned()]).ends_with("The columns are \"a\", \"b\""));
    }
}
