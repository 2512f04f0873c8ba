//! The corrected model as MJCF, the format of MuJoCo.

#[cfg(test)]
mod tests;

use arm::{Arm, Frame, Inertia, Joint, JointKind, Pose};
use effects::Effect;
use effects::arm::{GRAVITY_MISALIGNMENT, PAYLOAD, payload_body};
use effects::drive::TORQUE_SATURATION;
use effects::joint::SPRING;
use effects::sensor::ENCODER_OFFSET;
use quick_xml::Writer;
use quick_xml::events::{BytesEnd, BytesStart, BytesText, Event};
use torque::Corrected;

use crate::held::{self, Export, Held};
use validate::{LEAST_MASS, nearest_body};

/// `arm` with `effects` as MJCF: bodies, joints with damping, frictionloss, armature, linear springs and encoder offsets
/// (`ref`), the payload as a body of its own, and a motor on each joint. The frames of welded links are sites; shapes are
/// omitted.
///
/// # Errors
/// If an effect does not fit the arm.
pub fn mjcf(arm: &Arm, effects: &[Effect]) -> anyhow::Result<Export> {
    let always: Vec<Effect> = effects.iter().filter(|effect| effect.onset().is_none()).cloned().collect();
    // A body of negative mass, for a tool that is not mounted, is a part of the last link.
    let (apart, within): (Vec<Effect>, Vec<Effect>) =
        always.into_iter().partition(|effect| effect.is(&PAYLOAD) && is_body(&payload_body(effect)));
    let corrected = Corrected::new(arm, &within)?;
    let mut omitted = held::left_out(arm, effects, held_of)?;
    let model = Model {
        arm: corrected.arm(),
        corrected: &corrected,
        effects: &within,
        payloads: apart.iter().map(payload_body).collect(),
    };
    let text = model.write(&mut omitted, effects.len())?;
    Ok(Export { text, omitted })
}

/// The part of an effect that MJCF can hold.
fn held_of(effect: &Effect) -> Held {
    if effect.onset().is_some() {
        return Held::Nothing;
    }
    let is_straight = effect.is(&SPRING) && effect.points("curve").is_empty() && effect.number("stiffness") > 0.0;
    if is_straight || effect.is(&ENCODER_OFFSET) || effect.is(&GRAVITY_MISALIGNMENT) || effect.is(&TORQUE_SATURATION) {
        Held::Whole
    } else {
        held::in_common(effect)
    }
}

fn is_body(body: &Inertia) -> bool {
    body.mass > LEAST_MASS
}

struct Model<'a> {
    /// The arm with all effects that change bodies, gravity and rotors.
    arm: &'a Arm,
    corrected: &'a Corrected,
    effects: &'a [Effect],
    payloads: Vec<Inertia>,
}

type Xml = Writer<Vec<u8>>;

impl Model<'_> {
    fn write(&self, omitted: &mut Vec<String>, count: usize) -> anyhow::Result<String> {
        for joint in self.arm.joints() {
            if nearest_body(&joint.inertia).1 {
                omitted.push(format!(
                    "the inertia tensor of link \"{}\": no body has it, and MuJoCo refuses it; the nearest possible one is in it",
                    joint.link_name
                ));
            }
        }
        omitted.push("shapes and meshes of the links".into());
        let mut xml = Writer::new_with_indent(Vec::new(), b' ', 2);
        let mut lines = vec![format!(
            "Written by testbed diagnose: the URDF's arm with {count} effects. SI units at the joint; a motor's control is its torque \
             (N m) or force (N). Not in it (the TOML file of the corrected model has all effects):"
        )];
        lines.extend(omitted.iter().cloned());
        let comment = format!(" {} ", held::comment(&lines));
        xml.write_event(Event::Comment(BytesText::from_escaped(comment)))?;
        open(&mut xml, "mujoco", &[("model", self.arm.name().to_owned())])?;
        empty(&mut xml, "compiler", &[("angle", "radian".into())])?;
        let gravity = words(self.arm.gravity().as_slice());
        empty(&mut xml, "option", &[("gravity", gravity), ("integrator", "implicitfast".into())])?;
        open(&mut xml, "worldbody", &[])?;
        // MuJoCo's name of the fixed frame.
        let has_base = self.arm.base_link() != "world";
        if has_base {
            open(&mut xml, "body", &[("name", self.arm.base_link().to_owned())])?;
        }
        self.sites(&mut xml, None)?;
        for (j, joint) in self.arm.joints().iter().enumerate() {
            self.body(&mut xml, j, joint)?;
        }
        for _ in 0..self.arm.dof() + usize::from(has_base) {
            close(&mut xml, "body")?;
        }
        close(&mut xml, "worldbody")?;
        open(&mut xml, "actuator", &[])?;
        for joint in self.arm.joints() {
            let name = joint.name.clone();
            empty(&mut xml, "motor", &[("name", name.clone()), ("joint", name)])?;
        }
        close(&mut xml, "actuator")?;
        close(&mut xml, "mujoco")?;
        Ok(String::from_utf8(xml.into_inner())? + "\n")
    }

    /// A link without its closing tag, because the next link is inside it.
    fn body(&self, xml: &mut Xml, j: usize, joint: &Joint) -> anyhow::Result<()> {
        let mut attributes = vec![("name", joint.link_name.clone())];
        attributes.extend(placed(&joint.parent_from_joint));
        open(xml, "body", &attributes)?;
        inertial(xml, &nearest_body(&joint.inertia).0)?;
        empty(xml, "joint", &self.joint(j, joint))?;
        self.sites(xml, Some(j))?;
        if j + 1 == self.arm.dof() {
            let tool = self.arm.tool_frame().link_from_frame;
            for (k, payload) in self.payloads.iter().enumerate() {
                let name = if k == 0 { "payload".to_owned() } else { format!("payload_{}", k + 1) };
                let is_taken = self.arm.joints().iter().any(|joint| joint.link_name == name);
                let name = if is_taken { format!("{name}_at_tool") } else { name };
                let mut attributes = vec![("name", name)];
                attributes.extend(placed(&tool));
                open(xml, "body", &attributes)?;
                inertial(xml, &nearest_body(payload).0)?;
                close(xml, "body")?;
            }
        }
        Ok(())
    }

    fn joint(&self, j: usize, joint: &Joint) -> Vec<(&'static str, String)> {
        let kind = match joint.kind {
            JointKind::Revolute => "hinge",
            JointKind::Prismatic => "slide",
        };
        let mut attributes =
            vec![("name", joint.name.clone()), ("type", kind.to_owned()), ("axis", words(joint.axis.as_slice()))];
        // All positions in the file are those of the encoder: the true position minus `offset`.
        let offset = self.corrected.encoder_offsets()[j];
        let (lower, upper) = (joint.limits.lower - offset, joint.limits.upper - offset);
        let mut add = |key: &'static str, value: f64| {
            if value != 0.0 {
                attributes.push((key, value.to_string()));
            }
        };
        add("ref", -offset);
        let (damping, friction) = held::friction(joint, self.effects).unwrap_or((0.0, 0.0));
        add("damping", damping);
        add("frictionloss", friction);
        add("armature", joint.rotor_inertia);
        let (stiffness, rest) = self.spring(joint);
        add("stiffness", stiffness);
        add("springref", rest);
        if lower.is_finite() && upper.is_finite() {
            attributes.push(("range", words(&[lower, upper])));
        }
        let most = joint.limits.effort.min(self.corrected.torque_limits()[j]);
        if most.is_finite() {
            attributes.push(("actuatorfrcrange", words(&[-most, most])));
        }
        attributes
    }

    /// All linear springs of a joint as one: stiffness (N m/rad or N/m) and rest position (rad or m).
    fn spring(&self, joint: &Joint) -> (f64, f64) {
        let springs = self.effects.iter().filter(|effect| {
            effect.is(&SPRING) && effect.joint() == Some(joint.name.as_str()) && held_of(effect) == Held::Whole
        });
        let (mut stiffness, mut torque) = (0.0, 0.0);
        for spring in springs {
            stiffness += spring.number("stiffness");
            torque += spring.number("stiffness") * spring.number("rest");
        }
        (stiffness, if stiffness > 0.0 { torque / stiffness } else { 0.0 })
    }

    fn sites(&self, xml: &mut Xml, link: Option<usize>) -> anyhow::Result<()> {
        for Frame { name, link_from_frame, .. } in self.arm.frames().iter().filter(|frame| frame.link == link) {
            let mut attributes = vec![("name", name.clone())];
            attributes.extend(placed(link_from_frame));
            empty(xml, "site", &attributes)?;
        }
        Ok(())
    }
}

fn inertial(xml: &mut Xml, body: &Inertia) -> anyhow::Result<()> {
    let i = &body.tensor;
    let tensor = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].map(|at| i[at]);
    let attributes =
        [("pos", words(body.com.as_slice())), ("mass", body.mass.to_string()), ("fullinertia", words(&tensor))];
    empty(xml, "inertial", &attributes)
}

fn placed(pose: &Pose) -> [(&'static str, String); 2] {
    [("pos", words(pose.translation.as_slice())), ("quat", words(&pose.quaternion()))]
}

fn words(numbers: &[f64]) -> String {
    let words: Vec<String> = numbers.iter().map(f64::to_string).collect();
    words.join(" ")
}

fn tag<'a>(name: &'a str, attributes: &'a [(&'static str, String)]) -> BytesStart<'a> {
    let attributes = attributes.iter().map(|(key, value)| (*key, value.as_str()));
    BytesStart::new(name).with_attributes(attributes)
}

fn open(xml: &mut Xml, name: &str, attributes: &[(&'static str, String)]) -> anyhow::Result<()> {
    Ok(xml.write_event(Event::Start(tag(name, attributes)))?)
}

fn empty(xml: &mut Xml, name: &str, attributes: &[(&'static str, String)]) -> anyhow::Result<()> {
    Ok(xml.write_event(Event::Empty(tag(name, attributes)))?)
}

fn close(xml: &mut Xml, name: &str) -> anyhow::Result<()> {
    Ok(xml.write_event(Event::End(BytesEnd::new(name)))?)
}
