//! Finds the inertials of links and the dynamics of joints in the text of a URDF.

use std::collections::BTreeMap;
use std::ops::Range;

use anyhow::{Context, ensure};
use arm::Inertia;
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use super::SOURCE;

/// The place of an element, existing or to be inserted.
pub(super) enum ElementSpan {
    /// The element takes these bytes.
    At(Range<usize>),
    /// The element is to be inserted before this byte, at the end of its parent.
    Before(usize),
    /// The parent is one empty tag: its bytes, and its text without `/>`.
    Within(Range<usize>, String),
}

impl ElementSpan {
    /// The edit that inserts `element` there; `parent` is its parent's tag.
    pub(super) fn place(&self, element: String, parent: &str) -> (Range<usize>, String) {
        match self {
            Self::At(range) => (range.clone(), element),
            Self::Before(at) => (*at..*at, element),
            Self::Within(range, open) => (range.clone(), format!("{open}>{element}</{parent}>")),
        }
    }
}

/// A link.
pub(super) struct LinkPlaces {
    pub(super) inertial: ElementSpan,
    /// Its inertial, in the link's frame.
    pub(super) inertia: Inertia,
}

/// A joint.
pub(super) struct JointPlaces {
    pub(super) dynamics: ElementSpan,
    /// Whether an earlier diagnosis wrote it.
    pub(super) is_diagnosed: bool,
}

/// A whole URDF.
pub(super) struct Places {
    /// The byte after the robot's opening tag.
    pub(super) inside_robot: usize,
    /// The byte before its closing tag.
    pub(super) end_of_robot: usize,
    pub(super) links: BTreeMap<String, LinkPlaces>,
    pub(super) joints: BTreeMap<String, JointPlaces>,
    /// The transmissions, by the joint that each drives.
    pub(super) drives: BTreeMap<String, Drive>,
}

/// What a transmission states about its drive for Drake.
#[derive(Clone, Debug, Default)]
pub(super) struct Drive {
    /// Where `<drake:rotor_inertia>` is, and its value (kg m² at the motor).
    pub(super) rotor: Option<(Range<usize>, f64)>,
    /// `<drake:gear_ratio>`, 1 where there is none.
    pub(super) gear_ratio: Option<f64>,
}

impl Drive {
    /// The square of the gear ratio: the inertia at the joint over that at the motor.
    pub(super) fn reflection(&self) -> f64 {
        self.gear_ratio.unwrap_or(1.0).powi(2)
    }
}

/// The transmission being read.
#[derive(Default)]
struct Transmission {
    joint: Option<String>,
    drive: Drive,
}

impl Transmission {
    /// A tag at `depth` of the file.
    fn read(&mut self, depth: usize, tag: &BytesStart<'_>, here: Range<usize>) -> anyhow::Result<()> {
        let value = || -> anyhow::Result<f64> { number(&attribute(tag, "value")?.unwrap_or_default()) };
        match (depth, tag.name().as_ref()) {
            (3, b"joint") => self.joint = attribute(tag, "name")?,
            (4, b"drake:rotor_inertia") => {
                let value = value().context("<drake:rotor_inertia> has no value")?;
                self.drive.rotor = Some((here, value));
            }
            (4, b"drake:gear_ratio") => {
                self.drive.gear_ratio = Some(value().context("<drake:gear_ratio> has no value")?);
            }
            _ => {}
        }
        Ok(())
    }
}

/// The link or joint being read.
struct Open {
    is_link: bool,
    name: String,
    found: Option<Range<usize>>,
    /// The beginning of its inertial or dynamics, while inside it.
    begun: Option<usize>,
    /// Whether its dynamics were written by a diagnosis.
    is_diagnosed: bool,
}

fn number(text: &str) -> anyhow::Result<f64> {
    text.trim().parse().with_context(|| format!("\"{text}\" is not a number"))
}

fn attribute(tag: &BytesStart<'_>, name: &str) -> anyhow::Result<Option<String>> {
    let found = tag.try_get_attribute(name)?;
    Ok(found.map(|attribute| attribute.unescape_value().map(std::borrow::Cow::into_owned)).transpose()?)
}

impl Places {
    /// The places in `text`.
    pub(super) fn of(text: &str) -> anyhow::Result<Self> {
        let mut places = Self {
            inside_robot: 0,
            end_of_robot: 0,
            links: BTreeMap::new(),
            joints: BTreeMap::new(),
            drives: BTreeMap::new(),
        };
        let mut reader = Reader::from_str(text);
        let mut depth = 0;
        let mut open: Option<Open> = None;
        let mut transmission: Option<Transmission> = None;
        loop {
            let from = reader.buffer_position() as usize;
            let event = reader.read_event()?;
            let here = from..reader.buffer_position() as usize;
            match event {
                Event::Start(tag) => {
                    depth += 1;
                    if let Some(transmission) = &mut transmission {
                        transmission.read(depth, &tag, here.clone())?;
                    } else if depth == 2 && tag.name().as_ref() == b"transmission" {
                        transmission = Some(Transmission::default());
                    }
                    match depth {
                        1 => places.inside_robot = here.end,
                        2 => open = opened(&tag)?,
                        _ => begin(&mut open, depth, &tag, here)?,
                    }
                }
                Event::Empty(tag) if depth == 1 => {
                    let tag_text = text[here.clone()].trim_end_matches('>').trim_end_matches('/').trim_end();
                    if let Some(mut empty) = opened(&tag)? {
                        let place = ElementSpan::Within(here, tag_text.to_owned());
                        places.close(text, &mut empty, place)?;
                    }
                }
                Event::Empty(tag) => {
                    if let Some(transmission) = &mut transmission {
                        transmission.read(depth + 1, &tag, here.clone())?;
                    }
                    begin(&mut open, depth + 1, &tag, here.clone())?;
                    end(&mut open, depth + 1, here.end);
                }
                Event::End(_) => {
                    end(&mut open, depth, here.end);
                    if depth == 2
                        && let Some(Transmission { joint, drive }) = transmission.take()
                    {
                        places.drives.extend(joint.map(|joint| (joint, drive)));
                    }
                    if depth == 1 {
                        places.end_of_robot = here.start;
                    }
                    if depth == 2
                        && let Some(mut closed) = open.take()
                    {
                        let place = closed.found.take().map_or(ElementSpan::Before(here.start), ElementSpan::At);
                        places.close(text, &mut closed, place)?;
                    }
                    depth -= 1;
                }
                Event::Eof => break,
                _ => {}
            }
        }
        ensure!(places.inside_robot > 0, "it has no <robot> element");
        Ok(places)
    }

    /// The end of a link or joint of `text`.
    fn close(&mut self, text: &str, element: &mut Open, place: ElementSpan) -> anyhow::Result<()> {
        let name = std::mem::take(&mut element.name);
        if element.is_link {
            let inertia = match &place {
                ElementSpan::At(range) => {
                    Inertia::from_urdf(&text[range.clone()]).with_context(|| format!("link \"{name}\""))?
                }
                ElementSpan::Before(_) | ElementSpan::Within(..) => Inertia::zero(),
            };
            self.links.insert(name, LinkPlaces { inertial: place, inertia });
        } else {
            let is_diagnosed = element.is_diagnosed;
            self.joints.insert(name, JointPlaces { dynamics: place, is_diagnosed });
        }
        Ok(())
    }
}

/// A link or joint of the robot (others' are deeper in the file).
fn opened(tag: &BytesStart<'_>) -> anyhow::Result<Option<Open>> {
    let is_link = tag.name().as_ref() == b"link";
    if !is_link && tag.name().as_ref() != b"joint" {
        return Ok(None);
    }
    Ok(Some(Open {
        is_link,
        name: attribute(tag, "name")?.unwrap_or_default(),
        found: None,
        begun: None,
        is_diagnosed: false,
    }))
}

/// A tag at `depth` inside a link or joint.
fn begin(open: &mut Option<Open>, depth: usize, tag: &BytesStart<'_>, here: Range<usize>) -> anyhow::Result<()> {
    let Some(open) = open else { return Ok(()) };
    let wanted: &[u8] = if open.is_link { b"inertial" } else { b"dynamics" };
    if depth == 3 && tag.name().as_ref() == wanted && open.found.is_none() {
        open.begun = Some(here.start);
        let (key, value) = SOURCE;
        open.is_diagnosed = !open.is_link && attribute(tag, key)?.is_some_and(|found| found == value);
    }
    Ok(())
}

/// A tag at `depth` ends.
fn end(open: &mut Option<Open>, depth: usize, at: usize) {
    if let Some(open) = open
        && depth == 3
        && let Some(begun) = open.begun.take()
    {
        open.found = Some(begun..at);
    }
}
