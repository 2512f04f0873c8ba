//! Why an element of a URDF does not parse, in words, with its place.

use quick_xml::events::Event;

use super::spelling::{attributes, known};

/// The elements of shapes, whose attributes are read, too.
const SHAPES: [&str; 6] = ["box", "cylinder", "capsule", "sphere", "mesh", "color"];

/// The attributes that are one number.
const NUMBERS: [&str; 17] = [
    "value",
    "ixx",
    "ixy",
    "ixz",
    "iyy",
    "iyz",
    "izz",
    "lower",
    "upper",
    "effort",
    "velocity",
    "damping",
    "friction",
    "multiplier",
    "offset",
    "radius",
    "length",
];

/// The attributes that are three numbers.
const VECTORS: [&str; 4] = ["xyz", "rpy", "size", "scale"];

/// An element within the text, with its position.
struct Tag {
    position: usize,
    name: String,
    attributes: Vec<(String, String)>,
}

/// Where in `text`, a link or joint, `error` comes from (bytes), and the reason with the remedy.
pub(super) fn reason(text: &str, error: &urdf_rs::UrdfError) -> (usize, String) {
    let tags = tags(text);
    for tag in &tags {
        for (key, value) in &tag.attributes {
            if let Some(reason) = wrong_numbers(key, value) {
                return (tag.position, reason);
            }
        }
    }
    let said = plain(error);
    let missing = said.strip_prefix("missing field `").and_then(|rest| rest.strip_suffix('`'));
    if let Some(missing) = missing
        && let Some(found) = tags.iter().find_map(|tag| lacks(tag, &tags, missing))
    {
        return found;
    }
    let opening = text.split('>').next().unwrap_or_default();
    (0, format!("{opening}>: {said}; correct the element"))
}

/// The parser's message without the name of its error type.
pub(super) fn plain(error: &urdf_rs::UrdfError) -> String {
    let text = error.to_string();
    text.strip_prefix("custom: ").unwrap_or(&text).to_owned()
}

/// The elements that are read.
fn tags(text: &str) -> Vec<Tag> {
    let mut reader = quick_xml::Reader::from_str(text);
    let mut list = Vec::new();
    loop {
        let from = reader.buffer_position() as usize;
        match reader.read_event() {
            Ok(Event::Start(tag) | Event::Empty(tag)) => {
                let name = String::from_utf8_lossy(tag.name().as_ref()).into_owned();
                if known(&name).is_some() || SHAPES.contains(&name.as_str()) {
                    list.push(Tag { position: from, attributes: attributes(&tag), name });
                }
            }
            Ok(Event::Eof) | Err(_) => return list,
            Ok(_) => {}
        }
    }
}

/// What is wrong with an attribute that must be one, three or four numbers.
fn wrong_numbers(key: &str, value: &str) -> Option<String> {
    let needed = match key {
        "rgba" => 4,
        _ if VECTORS.contains(&key) => 3,
        _ if NUMBERS.contains(&key) => 1,
        _ => return None,
    };
    let words: Vec<&str> = value.split_whitespace().collect();
    if let Some(word) = words.iter().find(|word| word.parse::<f64>().is_err()) {
        let of = if words.len() > 1 { format!("{word} in {key}=\"{value}\"") } else { format!("{key}=\"{value}\"") };
        return Some(format!("{of} is not a number; give one in SI units"));
    }
    (words.len() != needed).then(|| {
        let plural = if needed == 1 { "" } else { "s" };
        let found = match words.len() {
            0 => "none".to_owned(),
            found => format!("{} ({})", counted(found), words.join(" ")),
        };
        let needed = counted(needed);
        format!("{key} needs {needed} number{plural}, and has {found}; give {needed} in SI units")
    })
}

fn counted(number: usize) -> String {
    let words = ["no", "one", "two", "three", "four", "five", "six"];
    words.get(number).map_or_else(|| number.to_string(), |word| (*word).to_owned())
}

/// The position of `tag` and the error, if it lacks the attribute or the element `missing`. `tags` are all there are in the same
/// link or joint.
fn lacks(tag: &Tag, tags: &[Tag], missing: &str) -> Option<(usize, String)> {
    let element = known(&tag.name)?;
    let name = &tag.name;
    if element.attributes.contains(&missing) && tag.attributes.iter().all(|(key, _)| key != missing) {
        return Some((tag.position, format!("<{name}> has no attribute {missing}; add it")));
    }
    if element.children.contains(&missing) && tags.iter().all(|other| other.name != missing) {
        let own_name = tag.attributes.iter().find(|(key, _)| key == "name");
        let words = own_name.map_or_else(|| format!("<{name}>"), |(_, own)| format!("{name} \"{own}\""));
        return Some((tag.position, format!("{words} has no element <{missing}>; add it")));
    }
    None
}
