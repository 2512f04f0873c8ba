//! The corrected model as a URDF: the user's own file with the effects that a URDF can hold.

mod scan;
#[cfg(test)]
mod tests;

use std::collections::BTreeSet;
use std::ops::Range;

use anyhow::Context;
use arm::{Arm, Inertia};
use effects::arm::{INERTIAL_PARAMETERS, INERTIAL_SCALE, LINK_INERTIAL_ERROR, PAYLOAD, payload_body};
use effects::drive::ROTOR_INERTIA;
use effects::{Effect, InUrdf};
use torque::Corrected;

use self::scan::{ElementSpan, JointPlaces, LinkPlaces, Places};
use crate::held::{self, Export, Held};
use validate::nearest_body;

/// The attribute of a `<dynamics>` element whose friction a diagnosis found; other programs ignore it.
const SOURCE: (&str, &str) = ("source", "testbed");
/// The XML name space of Drake's extensions of URDF.
const DRAKE: &str = "xmlns:drake=\"http://drake.mit.edu\"";

/// The first words of the comment in a corrected URDF.
pub const CORRECTED: &str = "Corrected by testbed diagnose";

/// What to check if a corrected URDF is diagnosed with `known` effects that its inertials can hold; `None` if nothing may count twice.
pub fn may_count_twice(urdf: &str, known: &[Effect]) -> Option<String> {
    let is_held =
        |effect: &&Effect| effect.spec().in_urdf == InUrdf::Inertials && held::in_common(effect) == Held::Whole;
    let names: BTreeSet<&str> = known.iter().filter(is_held).map(Effect::name).collect();
    (urdf.contains(CORRECTED) && !names.is_empty()).then(|| {
        let names = Vec::from_iter(names).join(", ");
        format!(
            "this URDF was corrected by a diagnosis; if that put {names} into it, they count twice: give the URDF from before the correction, \
             or leave them out of --known"
        )
    })
}

/// The text `urdf` of `arm` with those of `effects` that it can hold: inertials, friction as `<dynamics damping friction>` in
/// place of the previous one, and drive inertias as Drake's `<drake:rotor_inertia>` (with a gear ratio of 1, because they are
/// reflected to the joint). Everything else is unchanged, byte for byte; a comment lists what a URDF cannot hold.
///
/// # Errors
/// If an effect does not fit the arm or the text is not the arm's.
pub fn corrected_urdf(urdf: &str, arm: &Arm, effects: &[Effect]) -> anyhow::Result<Export> {
    let places = Places::of(urdf).context("the URDF cannot be edited")?;
    // If the file has a transmission without rotor inertia, no second one is written.
    let is_described = |effect: &Effect| {
        let drive = effect.joint().and_then(|joint| places.drives.get(joint));
        drive.is_some_and(|drive| drive.rotor.is_none())
    };
    let mut omitted = held::left_out(arm, effects, |effect| match held::in_common(effect) {
        Held::Whole if effect.is(&ROTOR_INERTIA) && is_described(effect) => {
            Held::Without("the file has a transmission of this joint, which stays as it was")
        }
        held => held,
    })?;
    let whole = effects.iter().filter(|effect| held::in_common(effect) == Held::Whole).count();
    for changed in changed_links(arm, effects, &places)? {
        if changed.body.is_some_and(|body| changed.is_estimated && nearest_body(&body).1) {
            omitted.push(format!(
                "the inertia tensor of link \"{}\": no body has it, because the recordings do not determine it; the nearest possible one is in it",
                changed.link
            ));
        }
    }
    let mut lines = vec![format!("{CORRECTED}: {whole} of {} effects are in it.", effects.len())];
    if !omitted.is_empty() {
        lines.push("Not in it (the TOML file of the corrected model has all effects):".into());
        lines.extend(omitted.iter().map(|line| format!("  {line}")));
    }
    let remark = format!("\n  <!-- {} -->", held::comment(&lines));
    let text = edited(urdf, &places, arm, effects, remark)?;
    Ok(Export { text, omitted })
}

/// The corrected URDF of [`corrected_urdf`] without comments: the nominal model of an arm.
///
/// # Errors
/// Those of [`corrected_urdf`].
pub fn changed_urdf(urdf: &str, arm: &Arm, effects: &[Effect]) -> anyhow::Result<String> {
    let places = Places::of(urdf).context("the URDF cannot be edited")?;
    edited(urdf, &places, arm, effects, String::new())
}

/// The names of the joints whose `<dynamics>` a diagnosis wrote into `urdf`.
///
/// # Errors
/// If the text is not XML.
pub fn diagnosed_joints(urdf: &str) -> anyhow::Result<Vec<String>> {
    let places = Places::of(urdf)?;
    let ours = places.joints.into_iter().filter(|(_, joint)| joint.is_diagnosed);
    Ok(ours.map(|(name, _)| name).collect())
}

/// `urdf` without the marks of a diagnosis, so that its friction is a placeholder as in any other URDF.
pub fn with_unknown_friction(urdf: &str) -> String {
    let (key, value) = SOURCE;
    urdf.replace(&format!(" {key}=\"{value}\""), "")
}

/// The drive inertias that `urdf` states for Drake, by joint (kg m² at the joint).
///
/// # Errors
/// If the text is not XML, or a value is no number.
pub fn stated_drive_inertias(urdf: &str) -> anyhow::Result<Vec<(String, f64)>> {
    let places = Places::of(urdf)?;
    let stated = places.drives.into_iter().filter_map(|(joint, drive)| {
        let reflection = drive.reflection();
        let (_, rotor) = drive.rotor?;
        Some((joint, rotor * reflection))
    });
    Ok(stated.collect())
}

/// The drive inertias that `urdf` states for the joints of `arm`, zero where it states none (kg m² or kg at the joint).
///
/// # Errors
/// Those of [`stated_drive_inertias`].
pub fn stated_rotor_inertias(urdf: &str, arm: &Arm) -> anyhow::Result<Vec<f64>> {
    let stated = stated_drive_inertias(urdf)?;
    let of = |name: &str| stated.iter().find(|(joint, _)| joint == name).map_or(0.0, |(_, inertia)| *inertia);
    Ok(arm.joints().iter().map(|joint| of(&joint.name)).collect())
}

fn edited(urdf: &str, places: &Places, arm: &Arm, effects: &[Effect], remark: String) -> anyhow::Result<String> {
    Corrected::new(arm, effects)?;
    let mut edits: Vec<(Range<usize>, String)> = Vec::new();
    for Changed { link, body, is_estimated } in changed_links(arm, effects, places)? {
        let found = places.links.get(&link).with_context(|| format!("the URDF has no link \"{link}\""))?;
        let possible = |body: Inertia| match nearest_body(&body) {
            (nearest, true) if is_estimated => nearest,
            _ => body,
        };
        edits.extend(found.edit(body.map(possible)));
    }
    for joint in arm.joints() {
        let Some((damping, friction)) = held::friction(joint, effects) else {
            continue;
        };
        let name = &joint.name;
        let found = places.joints.get(name).with_context(|| format!("the URDF has no joint \"{name}\""))?;
        edits.push(found.edit(damping, friction));
    }
    for (joint, drive) in &places.drives {
        let inertia = drive_inertia(effects, joint);
        if let (Some((range, _)), true) = (&drive.rotor, inertia > 0.0) {
            let at_the_motor = inertia / drive.reflection();
            edits.push((range.clone(), format!("<drake:rotor_inertia value=\"{at_the_motor}\"/>")));
        }
    }
    let drives = drives(places, effects);
    if !drives.is_empty() {
        edits.push((places.end_of_robot..places.end_of_robot, drives));
        if !urdf[..places.inside_robot].contains("xmlns:drake") {
            let end_of_tag = places.inside_robot - 1;
            edits.push((end_of_tag..end_of_tag, format!(" {DRAKE}")));
        }
    }
    edits.push((places.inside_robot..places.inside_robot, remark));
    edits.sort_by_key(|(range, _)| range.start);
    let mut text = String::with_capacity(urdf.len() + 1000);
    let mut at = 0;
    for (range, replacement) in edits {
        text.push_str(&urdf[at..range.start]);
        text.push_str(&replacement);
        at = range.end;
    }
    text.push_str(&urdf[at..]);
    Ok(text)
}

/// A URDF link whose inertials change.
struct Changed {
    link: String,
    /// Its new body in its own frame; `None` for no body.
    body: Option<Inertia>,
    /// Whether the body is an estimate, which may be impossible where the recordings do not determine it, and not the URDF's times a
    /// factor, which stays as it is.
    is_estimated: bool,
}

/// The URDF links whose inertials change.
fn changed_links(arm: &Arm, effects: &[Effect], places: &Places) -> anyhow::Result<Vec<Changed>> {
    let always: Vec<Effect> = effects.iter().filter(|effect| effect.onset().is_none()).cloned().collect();
    let corrected = Corrected::new(arm, &always)?;
    let tool = arm.tool_frame().name;
    let mut changed = Vec::new();
    for (j, joint) in arm.joints().iter().enumerate() {
        let on_joint = |effect: &&Effect| effect.joint() == Some(&joint.name);
        let welded = arm.frames().iter().filter(|frame| frame.link == Some(j)).map(|frame| &frame.name);
        if always.iter().filter(on_joint).any(|effect| effect.is(&INERTIAL_PARAMETERS)) {
            // The recordings only determine the body of all welded links together, which is written to the first.
            changed.push(Changed {
                link: joint.link_name.clone(),
                body: Some(corrected.arm().joints()[j].inertia),
                is_estimated: true,
            });
            changed.extend(welded.map(|link| Changed { link: link.clone(), body: None, is_estimated: true }));
            continue;
        }
        let factor: f64 = always
            .iter()
            .map(|effect| {
                if effect.is(&INERTIAL_SCALE) {
                    effect.number("factor")
                } else if effect.is(&LINK_INERTIAL_ERROR) && on_joint(&effect) {
                    1.0 + effect.number("relative")
                } else {
                    1.0
                }
            })
            .product();
        for link in std::iter::once(&joint.link_name).chain(welded) {
            let payloads = always.iter().filter(|effect| effect.is(&PAYLOAD) && *link == tool);
            let payloads: Vec<Inertia> = payloads.map(payload_body).collect();
            if factor == 1.0 && payloads.is_empty() {
                continue;
            }
            let found = places.links.get(link);
            let found = found.with_context(|| format!("the URDF has no link \"{link}\""))?;
            let mut body = found.inertia;
            body.mass *= factor;
            body.tensor *= factor;
            changed.push(Changed {
                link: link.clone(),
                body: Some(payloads.iter().fold(body, |body, payload| body.merged(payload))),
                is_estimated: !payloads.is_empty(),
            });
        }
    }
    Ok(changed)
}

/// The drive inertia of `joint` by `effects` (kg m² at the joint).
fn drive_inertia(effects: &[Effect], joint: &str) -> f64 {
    let on_joint = |effect: &&Effect| effect.is(&ROTOR_INERTIA) && effect.joint() == Some(joint);
    effects.iter().filter(on_joint).map(|effect| effect.number("inertia")).sum()
}

/// A transmission for each joint with a drive inertia and without a transmission in the file.
fn drives(places: &Places, effects: &[Effect]) -> String {
    let mut text = String::new();
    let without = |joint: &&String| !places.drives.contains_key(*joint);
    for joint in places.joints.keys().filter(without) {
        let inertia = drive_inertia(effects, joint);
        if inertia > 0.0 {
            let name = quick_xml::escape::escape(joint);
            text.push_str(&format!(
                "  <transmission name=\"{name}_drive\"><type>transmission_interface/SimpleTransmission</type><joint \
                 name=\"{name}\"/><actuator name=\"{name}_drive\"><drake:rotor_inertia \
                 value=\"{inertia}\"/><drake:gear_ratio value=\"1\"/></actuator></transmission>\n"
            ));
        }
    }
    text
}

impl LinkPlaces {
    /// The edit that replaces the link's inertial; `None` if it has none and needs none.
    fn edit(&self, body: Option<Inertia>) -> Option<(Range<usize>, String)> {
        let Some(body) = body else {
            return match &self.inertial {
                ElementSpan::At(range) => Some((range.clone(), String::new())),
                _ => None,
            };
        };
        Some(self.inertial.place(body.to_urdf(), "link"))
    }
}

impl JointPlaces {
    /// The edit that replaces the joint's dynamics.
    fn edit(&self, damping: f64, friction: f64) -> (Range<usize>, String) {
        let (key, value) = SOURCE;
        let dynamics = format!("<dynamics damping=\"{damping}\" friction=\"{friction}\" {key}=\"{value}\"/>");
        self.dynamics.place(dynamics, "joint")
    }
}
