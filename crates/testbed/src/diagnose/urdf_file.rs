//! The corrected model as a URDF: the user's own file, with what URDF can hold put in.

mod scan;
#[cfg(test)]
mod tests;

use std::ops::Range;

use anyhow::Context;
use arm::{Arm, Inertia};
use effects::arm::{InertialScale, LinkInertialError, Payload};
use effects::{Effect, InUrdf};
use torque::Corrected;

use self::scan::{JointPlaces, LinkPlaces, Places};

/// The text `urdf` of `arm` with the inertials that `effects` change, and with viscous and Coulomb friction as
/// `<dynamics damping friction>` in place of what was there. All else stays as it was, to the byte; a comment names the
/// effects that URDF cannot hold.
///
/// # Errors
/// If an effect does not fit the arm or the text is not the arm's.
pub fn corrected_urdf(urdf: &str, arm: &Arm, effects: &[Effect]) -> anyhow::Result<String> {
    edited(urdf, arm, effects, remark(effects)?)
}

/// As [`corrected_urdf`], but without a word about what was done to it: the URDF of an arm that is believed to be so.
///
/// # Errors
/// As [`corrected_urdf`].
pub fn changed_urdf(urdf: &str, arm: &Arm, effects: &[Effect]) -> anyhow::Result<String> {
    edited(urdf, arm, effects, String::new())
}

fn edited(urdf: &str, arm: &Arm, effects: &[Effect], remark: String) -> anyhow::Result<String> {
    Corrected::new(arm, effects)?;
    let places = Places::of(urdf).context("the URDF cannot be edited")?;
    let mut edits: Vec<(Range<usize>, String)> = Vec::new();
    for (link, factor, payloads) in changed_links(arm, effects) {
        let found = places
            .links
            .get(&link)
            .with_context(|| format!("the URDF has no link \"{link}\""))?;
        edits.push(found.edit(factor, &payloads));
    }
    for joint in arm.joints() {
        let of = |wanted: InUrdf| {
            let on_joint = effects.iter().filter(|effect| effect.joint() == Some(&joint.name));
            let found: Vec<f64> = on_joint
                .filter(|effect| effect.spec().in_urdf == wanted)
                .filter_map(|effect| effect.spec().main.first().map(|main| effect.number(main)))
                .collect();
            (!found.is_empty()).then(|| found.iter().sum::<f64>())
        };
        let (damping, friction) = (of(InUrdf::Damping), of(InUrdf::Friction));
        if damping.is_none() && friction.is_none() {
            continue;
        }
        let name = &joint.name;
        let found = places
            .joints
            .get(name)
            .with_context(|| format!("the URDF has no joint \"{name}\""))?;
        edits.push(found.edit(damping.unwrap_or(joint.damping), friction.unwrap_or(joint.friction)));
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

/// The URDF links whose inertials change: name, factor of mass and tensor, and what is welded to them.
fn changed_links(arm: &Arm, effects: &[Effect]) -> Vec<(String, f64, Vec<Inertia>)> {
    let tool = arm.tool_frame().name;
    let mut changed = Vec::new();
    for (j, joint) in arm.joints().iter().enumerate() {
        let factor: f64 = effects
            .iter()
            .map(|effect| {
                if effect.is(&InertialScale) {
                    effect.number("factor")
                } else if effect.is(&LinkInertialError) && effect.joint() == Some(&joint.name) {
                    1.0 + effect.number("relative")
                } else {
                    1.0
                }
            })
            .product();
        let welded = arm
            .frames()
            .iter()
            .filter(|frame| frame.link == Some(j))
            .map(|frame| &frame.name);
        for link in std::iter::once(&joint.link_name).chain(welded) {
            let payloads: Vec<Inertia> = if *link == tool { payloads(effects) } else { Vec::new() };
            if factor != 1.0 || !payloads.is_empty() {
                changed.push((link.clone(), factor, payloads));
            }
        }
    }
    changed
}

fn payloads(effects: &[Effect]) -> Vec<Inertia> {
    let payloads = effects.iter().filter(|effect| effect.is(&Payload) && is_held(effect));
    payloads.map(Payload::inertia).collect()
}

/// Whether a URDF says it.
fn is_held(effect: &Effect) -> bool {
    effect.spec().in_urdf != InUrdf::Nothing && effect.onset().is_none()
}

/// The comment that goes inside the robot.
fn remark(effects: &[Effect]) -> anyhow::Result<String> {
    let (held, left): (Vec<&Effect>, Vec<&Effect>) = effects.iter().partition(|effect| is_held(effect));
    let mut lines = vec![format!(
        "Corrected by testbed diagnose; {} effects are put in.",
        held.len()
    )];
    if !left.is_empty() {
        lines.push("What a URDF cannot hold (it is in the file that --model writes, which testbed reads):".into());
    }
    for effect in left {
        let table = toml::to_string(effect)?;
        let parameters: Vec<&str> = table.lines().skip(1).filter(|line| *line != "curve = []").collect();
        lines.push(format!("  {}: {}", effect.name(), parameters.join(", ")));
    }
    // Two hyphens end a comment.
    let text = lines.join("\n       ").replace("--", "- -");
    Ok(format!("\n  <!-- {text} -->"))
}

impl LinkPlaces {
    /// What takes the place of the link's inertial.
    fn edit(&self, factor: f64, payloads: &[Inertia]) -> (Range<usize>, String) {
        let mut body = self.inertia;
        body.mass *= factor;
        body.tensor *= factor;
        for payload in payloads {
            body = body.merged(payload);
        }
        let (c, i) = (body.com, body.tensor);
        let inertial = format!(
            "<inertial><origin xyz=\"{} {} {}\" rpy=\"0 0 0\"/><mass value=\"{}\"/><inertia ixx=\"{}\" ixy=\"{}\" ixz=\"{}\" \
             iyy=\"{}\" iyz=\"{}\" izz=\"{}\"/></inertial>",
            c.x,
            c.y,
            c.z,
            body.mass,
            i[(0, 0)],
            i[(0, 1)],
            i[(0, 2)],
            i[(1, 1)],
            i[(1, 2)],
            i[(2, 2)]
        );
        self.inertial.place(inertial, "link")
    }
}

impl JointPlaces {
    /// What takes the place of the joint's dynamics.
    fn edit(&self, damping: f64, friction: f64) -> (Range<usize>, String) {
        let dynamics = format!("<dynamics damping=\"{damping}\" friction=\"{friction}\"/>");
        self.dynamics.place(dynamics, "joint")
    }
}
