//! The part of a URDF's text that is read, and errors of syntax with their place.

use std::ops::Range;
use std::path::Path;

use quick_xml::events::{BytesStart, Event};

use super::lines::{line_at, syntax_error};
use super::why;
use crate::error::ArmError;

/// The largest depth of nested elements. URDFs need no more, and a deeper one could overflow the parser's stack.
const DEEPEST: usize = 64;

/// The text of an XML file with a `<robot>` element.
pub(super) struct Text {
    /// The text without comments and without textures that name no file, which `urdf-rs` refuses. They are replaced by
    /// spaces, so that all other bytes keep their positions.
    pub(super) blanked: String,
    /// The position of the tag `<robot …>`, which declares namespaces.
    root: Range<usize>,
    /// The positions of the links, joints and other elements of the robot.
    elements: Vec<Range<usize>>,
}

impl Text {
    /// Reads `text`, the content of the file at `path`.
    ///
    /// # Errors
    /// [`ArmError::Syntax`] with the line, if it is not XML, another format, or xacro, parts of which would be
    /// ignored.
    pub(super) fn of(text: &str, path: &Path) -> Result<Self, ArmError> {
        let mut reader = quick_xml::Reader::from_str(text);
        let (mut blanks, mut elements): (Vec<Range<usize>>, Vec<Range<usize>>) = (Vec::new(), Vec::new());
        let mut depth: usize = 0;
        let (mut begun, mut texture) = (0, None);
        let mut root = None;
        loop {
            let from = reader.buffer_position() as usize;
            let event = reader.read_event().map_err(|error| {
                let line = line_at(text, reader.error_position() as usize);
                syntax_error(
                    path,
                    Some(line),
                    format!("is not well-formed XML: {error}; check it with xmllint or check_urdf"),
                )
            })?;
            let here = from..reader.buffer_position() as usize;
            match &event {
                Event::Start(tag) | Event::Empty(tag) => {
                    let is_empty = matches!(event, Event::Empty(_));
                    if root.is_none() {
                        root = Some(here.clone());
                        check_root(tag).map_err(|reason| syntax_error(path, Some(line_at(text, from)), reason))?;
                    }
                    if is_xacro(tag) {
                        let reason = "is xacro, not URDF; expand it first: xacro FILE > robot.urdf".into();
                        return Err(syntax_error(path, Some(line_at(text, from)), reason));
                    }
                    let no_file = tag.name().as_ref() == b"texture" && lacks_file(tag);
                    if depth == 1 {
                        begun = from;
                        if is_empty {
                            elements.push(here.clone());
                        }
                    }
                    match (no_file, is_empty) {
                        (true, true) => blanks.push(here),
                        (true, false) if texture.is_none() => texture = Some((depth, from)),
                        _ => {}
                    }
                    depth += usize::from(!is_empty);
                    if depth > DEEPEST {
                        let reason = format!("has elements in each other {DEEPEST} deep; is this a URDF?");
                        return Err(syntax_error(path, Some(line_at(text, from)), reason));
                    }
                }
                Event::End(_) => {
                    depth = depth.saturating_sub(1);
                    if depth == 1 {
                        elements.push(begun..here.end);
                    }
                    if let Some((_, start)) = texture.take_if(|(at, _)| *at == depth) {
                        blanks.push(start..here.end);
                    }
                }
                Event::Comment(_) => blanks.push(here),
                Event::Eof => break,
                _ => {}
            }
        }
        let Some(root) = root else {
            let reason = "is not a URDF: it has no <robot> element; give the robot's URDF".into();
            return Err(syntax_error(path, None, reason));
        };
        blanks.sort_by_key(|range| range.start);
        Ok(Self { blanked: blanked(text, &blanks), root, elements })
    }

    /// The parser's error with its place: the first element of the robot that does not parse by itself.
    pub(super) fn explain(&self, path: &Path, error: &urdf_rs::UrdfError) -> ArmError {
        let text = &self.blanked;
        for element in &self.elements {
            let own = &text[element.clone()];
            let alone = format!("{}{own}</robot>", &text[self.root.clone()]);
            if let Err(error) = urdf_rs::read_from_string(&alone) {
                let (offset, reason) = why::reason(own, &error);
                return syntax_error(path, Some(line_at(text, element.start + offset)), reason);
            }
        }
        if !text.contains("</robot>") {
            let last = line_at(text, text.trim_end().len());
            let reason = "the file ends before </robot>: it was cut; write or copy it again".into();
            return syntax_error(path, Some(last), reason);
        }
        syntax_error(path, None, format!("is not a URDF: {}; check it with check_urdf", why::plain(error)))
    }
}

/// Refuses a root element that is not that of a URDF; the error names the format.
fn check_root(tag: &BytesStart<'_>) -> Result<(), String> {
    let name = String::from_utf8_lossy(tag.name().as_ref()).into_owned();
    match name.as_str() {
        "robot" => Ok(()),
        "mujoco" | "mujocoinclude" => Err(
            "is MJCF, the format of MuJoCo, and not URDF; give the URDF that it was made from (manufacturers publish one \
             in their ROS description package)"
                .into(),
        ),
        "sdf" | "gazebo" | "world" => Err("is SDF, the format of Gazebo, and not URDF; give the URDF that it was made from \
                                           (manufacturers publish one in their ROS description package)"
            .into()),
        "COLLADA" => Err("is a COLLADA mesh, not a URDF; give the URDF that names this mesh".into()),
        _ => Err(format!(
            "is not a URDF: its first element is <{name}>, where a URDF has <robot>; give the robot's URDF"
        )),
    }
}

/// Whether the element must be expanded by xacro.
fn is_xacro(tag: &BytesStart<'_>) -> bool {
    let is_expression = |value: &[u8]| value.windows(2).any(|pair| pair == b"${" || pair == b"$(");
    tag.name().as_ref().starts_with(b"xacro:")
        || tag.attributes().with_checks(false).flatten().any(|attribute| is_expression(&attribute.value))
}

fn lacks_file(tag: &BytesStart<'_>) -> bool {
    tag.attributes().with_checks(false).flatten().all(|attribute| attribute.key.as_ref() != b"filename")
}

/// `text` with spaces in place of the sorted `ranges`; line breaks remain.
fn blanked(text: &str, ranges: &[Range<usize>]) -> String {
    let mut result = String::with_capacity(text.len());
    let mut at = 0;
    for range in ranges {
        // A comment within a texture has already been replaced with it.
        let start = range.start.max(at);
        if range.end <= at {
            continue;
        }
        result.push_str(&text[at..start]);
        result.extend(text[start..range.end].bytes().map(|byte| match byte {
            b'\n' => '\n',
            _ => ' ',
        }));
        at = range.end;
    }
    result.push_str(&text[at..]);
    result
}
