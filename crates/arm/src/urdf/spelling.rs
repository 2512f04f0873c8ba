//! Misspelt elements and attributes of a URDF. Unknown ones are ignored, so that a misspelt `<inertial>` would be a link
//! without mass.

use std::path::Path;

use quick_xml::events::{BytesStart, Event};

use super::lines::{line_at, syntax_error};
use crate::error::ArmError;

/// An element that decides on the dynamics, with the names in it that do.
pub(super) struct Element {
    pub(super) name: &'static str,
    pub(super) children: &'static [&'static str],
    pub(super) attributes: &'static [&'static str],
}

const fn element(
    name: &'static str,
    children: &'static [&'static str],
    attributes: &'static [&'static str],
) -> Element {
    Element { name, children, attributes }
}

/// The elements that decide on the dynamics. Each is looked at in the place that URDF gives it only, so that a `<joint>`
/// of a `<transmission>` is not.
const ELEMENTS: [Element; 13] = [
    element("robot", &["link", "joint"], &[]),
    element("link", &["inertial"], &["name"]),
    element("inertial", &["origin", "mass", "inertia"], &[]),
    element("mass", &[], &["value"]),
    element("inertia", &[], &["ixx", "ixy", "ixz", "iyy", "iyz", "izz"]),
    element("origin", &[], &["xyz", "rpy"]),
    element("joint", &["origin", "parent", "child", "axis", "limit", "dynamics", "mimic"], &["name", "type"]),
    element("parent", &[], &["link"]),
    element("child", &[], &["link"]),
    element("axis", &[], &["xyz"]),
    element("limit", &[], &["lower", "upper", "effort", "velocity"]),
    element("dynamics", &[], &["damping", "friction"]),
    element("mimic", &[], &["joint", "multiplier", "offset"]),
];

/// The types of joints that URDF has.
const TYPES: [&str; 7] = ["revolute", "continuous", "prismatic", "fixed", "floating", "planar", "spherical"];

/// The element `name`, if it decides on the dynamics.
pub(super) fn known(name: &str) -> Option<&'static Element> {
    ELEMENTS.iter().find(|element| element.name == name)
}

/// Refuses an unknown element or attribute whose name is nearly one that decides on the dynamics, and an unknown type of joint.
/// All other unknown names are extensions, which are ignored.
///
/// # Errors
/// [`ArmError::Syntax`] with the line and the name that is probably meant.
pub(super) fn check(text: &str, path: &Path) -> Result<(), ArmError> {
    let mut reader = quick_xml::Reader::from_str(text);
    // The elements around the place, each with its words in an error; `None` is an extension.
    let mut around: Vec<Option<(&Element, String)>> = Vec::new();
    loop {
        let from = reader.buffer_position() as usize;
        // What is no XML has been refused before.
        let Ok(event) = reader.read_event() else { return Ok(()) };
        match &event {
            Event::Start(tag) | Event::Empty(tag) => {
                let here = enter(tag, &around).map_err(|reason| {
                    let position = from + text[from..].find('<').unwrap_or(0);
                    syntax_error(path, Some(line_at(text, position)), reason)
                })?;
                if matches!(event, Event::Start(_)) {
                    around.push(here);
                }
            }
            Event::End(_) => {
                around.pop();
            }
            Event::Eof => return Ok(()),
            _ => {}
        }
    }
}

/// The element that `tag` begins, with its words in an error. The error is the reason why it is refused.
fn enter(
    tag: &BytesStart<'_>,
    around: &[Option<(&'static Element, String)>],
) -> Result<Option<(&'static Element, String)>, String> {
    let name = String::from_utf8_lossy(tag.name().as_ref()).into_owned();
    let given: Vec<(String, String)> = attributes(tag);
    let own_name = given.iter().find(|(key, _)| key == "name").map(|(_, value)| value);
    match around.last() {
        None => {
            check_name("robot", own_name)?;
            return Ok(known(&name).map(|element| (element, "the robot".to_owned())));
        }
        Some(None) => return Ok(None),
        Some(Some((parent, words))) if !parent.children.contains(&name.as_str()) => {
            return match nearest(&name, parent.children.iter().copied()) {
                Some(meant) => Err(format!("{words} has an unknown element <{name}>; did you mean <{meant}>?")),
                None => Ok(None),
            };
        }
        Some(Some(_)) => {}
    }
    let Some(element) = known(&name) else { return Ok(None) };
    check_name(&name, own_name)?;
    let words = match (own_name, around.last()) {
        (Some(own), _) if matches!(name.as_str(), "link" | "joint") => format!("{name} \"{own}\""),
        (_, Some(Some((_, outer)))) if around.len() > 1 => format!("<{name}> of {}", owner(outer)),
        _ => format!("<{name}>"),
    };
    for (key, _) in &given {
        if element.attributes.contains(&key.as_str()) {
            continue;
        }
        let absent = element.attributes.iter().copied();
        let absent = absent.filter(|known| given.iter().all(|(key, _)| key != known));
        if let Some(meant) = nearest(key, absent) {
            return Err(format!("{words} has an unknown attribute {key}; did you mean {meant}?"));
        }
    }
    let kind = given.iter().find(|(key, _)| name == "joint" && key == "type");
    if let Some((_, kind)) = kind.filter(|(_, kind)| !TYPES.contains(&kind.as_str())) {
        let remedy = nearest(kind, TYPES.into_iter()).map_or_else(
            || "an arm has joints that are revolute, continuous, prismatic or fixed".to_owned(),
            |meant| format!("did you mean \"{meant}\"?"),
        );
        return Err(format!("type=\"{kind}\" of {words} is not a joint type; {remedy}"));
    }
    Ok(Some((element, words)))
}

/// Refuses a name with line breaks or other control characters, which could look like a line of the program's own text.
fn check_name(tag: &str, name: Option<&String>) -> Result<(), String> {
    let Some(name) = name else { return Ok(()) };
    match quick_xml::escape::unescape(name) {
        Ok(read) if read.contains(char::is_control) => Err(format!(
            "{tag} \"{name}\" has a line break or another control character in its name; give it a name without"
        )),
        _ => Ok(()),
    }
}

/// The link or joint in the words of one of its elements.
fn owner(words: &str) -> &str {
    words.rsplit("> of ").next().unwrap_or(words)
}

/// The attributes of a tag, with their values as they are written.
pub(super) fn attributes(tag: &BytesStart<'_>) -> Vec<(String, String)> {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    tag.attributes()
        .with_checks(false)
        .flatten()
        .map(|attribute| (text(attribute.key.as_ref()), text(&attribute.value)))
        .collect()
}

/// The word among `known` that `word` is a misspelling of: with at most two letters that are wrong, missing, too many or
/// exchanged, or one in words of up to four letters.
pub(super) fn nearest<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    // A namespace marks an extension.
    if word.contains(':') {
        return None;
    }
    let distance = |known: &str| strsim::damerau_levenshtein(&word.to_lowercase(), known);
    let near = known.map(|known| (distance(known), known));
    near.filter(|(distance, known)| *distance <= if known.len() > 4 { 2 } else { 1 })
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, known)| known)
}
