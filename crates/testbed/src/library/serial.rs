//! A robot's URDF in which only the arm's joints move, so that no flags are needed to select the arm.

use std::collections::HashMap;

use anyhow::Context;
use arm::{Arm, FixedJoint};
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, Writer};

/// `urdf`, from which `arm` was made, with every joint that does not move in the arm fixed at its position. The rest is
/// unchanged; a URDF whose joints all move in the arm is unchanged byte for byte.
///
/// # Errors
/// If the text is no URDF.
pub fn serial_urdf(urdf: &str, arm: &Arm) -> anyhow::Result<String> {
    if arm.fixed_joints().is_empty() {
        return Ok(urdf.to_owned());
    }
    let fixed: HashMap<&str, &FixedJoint> =
        arm.fixed_joints().iter().map(|joint| (joint.name.as_str(), joint)).collect();
    let mut reader = Reader::from_str(urdf);
    let mut writer = Writer::new(Vec::new());
    let mut depth = 0;
    // Whether the joint being read already has its origin written.
    let mut is_placed = false;
    loop {
        let event = reader.read_event()?;
        match &event {
            Event::Start(tag) => {
                let joint = if depth == 1 { joint_of(tag, &fixed)? } else { None };
                match joint {
                    Some(joint) => {
                        writer.write_event(Event::Start(fixed_tag(tag)?))?;
                        is_placed = joint.position != 0.0;
                        if is_placed {
                            writer.write_event(Event::Empty(origin(joint)))?;
                        }
                    }
                    None => writer.write_event(event)?,
                }
                depth += 1;
            }
            Event::Empty(tag) if is_placed && depth == 2 && tag.name().as_ref() == b"origin" => {}
            Event::End(_) => {
                depth -= 1;
                is_placed &= depth > 1;
                writer.write_event(event)?;
            }
            Event::Eof => break,
            _ => writer.write_event(event)?,
        }
    }
    String::from_utf8(writer.into_inner()).context("the URDF is not UTF-8")
}

/// The joint that `tag` begins, if it is one of `fixed`.
fn joint_of<'a>(tag: &BytesStart<'_>, fixed: &HashMap<&str, &'a FixedJoint>) -> anyhow::Result<Option<&'a FixedJoint>> {
    if tag.name().as_ref() != b"joint" {
        return Ok(None);
    }
    let name = tag.try_get_attribute("name")?;
    let name = name.map(|name| name.unescape_value().map(std::borrow::Cow::into_owned)).transpose()?;
    Ok(name.and_then(|name| fixed.get(name.as_str()).copied()))
}

/// `tag` with the type `fixed`.
fn fixed_tag(tag: &BytesStart<'_>) -> anyhow::Result<BytesStart<'static>> {
    let mut result = BytesStart::new("joint");
    // A repeated attribute was refused when the URDF was read, and quick-xml's search for one takes the square of their number.
    for attribute in tag.attributes().with_checks(false) {
        let attribute = attribute?;
        if attribute.key.as_ref() != b"type" {
            result.push_attribute(attribute);
        }
    }
    result.push_attribute(("type", "fixed"));
    Ok(result.into_owned())
}

fn origin(joint: &FixedJoint) -> BytesStart<'static> {
    let (xyz, rpy) = joint.parent_from_child.xyz_rpy();
    let words = |[a, b, c]: [f64; 3]| format!("{a} {b} {c}");
    let mut origin = BytesStart::new("origin");
    origin.push_attribute(("xyz", words(xyz).as_str()));
    origin.push_attribute(("rpy", words(rpy).as_str()));
    origin
}

#[cfg(test)]
mod tests {
    use arm::{ChainOptions, Workspace};

    use super::*;

    /// A column that is turned, with an arm of two joints and a hook on a prismatic joint.
    const ROBOT: &str = r#"<robot name="r"><!-- kept --><link name="root"/>
<joint name="column" type="revolute"><parent link="root"/><child link="post"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<link name="post"/>
<joint name="a" type="continuous"><origin xyz="0 0 1"/><parent link="post"/><child link="upper"/><axis xyz="0 1 0"/></joint>
<link name="upper"><inertial><mass value="2"/><inertia ixx=".1" ixy="0" ixz="0" iyy=".1" iyz="0" izz=".1"/></inertial></link>
<joint name="slide" type="prismatic"><origin xyz=".1 0 0" rpy="0 .3 0"/><parent link="upper"/><child link="hook"/><axis xyz="1 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<link name="hook"><inertial><mass value="3"/><inertia ixx=".1" ixy="0" ixz="0" iyy=".1" iyz="0" izz=".1"/></inertial></link>
<joint name="b" type="continuous"><origin xyz="0 0 .5"/><parent link="upper"/><child link="lower"/><axis xyz="1 0 0"/></joint>
<link name="lower"><inertial><origin xyz=".1 .1 .2"/><mass value="1"/><inertia ixx=".1" ixy="0" ixz="0" iyy=".1" iyz="0" izz=".1"/></inertial></link>
</robot>"#;

    #[test]
    fn a_serial_urdf_is_the_same_arm_without_flags() {
        let options = ChainOptions {
            base: Some("post".into()),
            tip: Some("lower".into()),
            locks: vec![("slide".into(), 0.2), ("column".into(), 0.7)],
            ..ChainOptions::default()
        };
        let arm = Arm::from_urdf_chain(ROBOT, "r.urdf", &options).expect("it loads");
        let text = serial_urdf(ROBOT, &arm).expect("it is written");
        assert!(text.contains("<!-- kept -->"), "{text}");
        let serial = Arm::from_urdf_text(&text, "serial.urdf").expect("it loads");
        assert!(serial.fixed_joints().is_empty());
        let torque = |arm: &Arm| {
            let mut tau = [0.0; 2];
            arm.inverse_dynamics(&mut Workspace::new(arm), &[0.3, 0.4], &[1.0, -2.0], &[3.0, 4.0], &mut tau);
            tau
        };
        let (a, b) = (torque(&arm), torque(&serial));
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-9), "{a:?}, {b:?}");
        assert_eq!(serial_urdf(&text, &serial).expect("it is written"), text);
    }
}
