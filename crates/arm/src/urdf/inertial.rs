//! The body of an `<inertial>` element, for programs that replace such elements in the text of a URDF.

use std::fmt::Display;

use nalgebra::{Matrix3, Vector3};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use crate::error::ArmError;
use crate::inertia::Inertia;
use crate::pose::Pose;

/// The attributes of an `<inertial>`; absent ones are zero.
#[derive(Default)]
struct Attributes {
    xyz: [f64; 3],
    rpy: [f64; 3],
    mass: [f64; 1],
    /// ixx, ixy, ixz, iyy, iyz, izz (kg m²).
    tensor: [f64; 6],
}

impl Inertia {
    /// The body of an `<inertial>` element in the link's frame, from the text of the element: the inverse of [`Self::to_urdf`]. Absent
    /// attributes count as zero, and nothing is checked, as [`Arm::from_urdf`](crate::Arm::from_urdf) does for a whole URDF.
    ///
    /// # Errors
    /// [`ArmError::Inertial`] if the text is no XML or an attribute is not a number.
    pub fn from_urdf(element: &str) -> Result<Self, ArmError> {
        let mut reader = Reader::from_str(element);
        let mut attributes = Attributes::default();
        let mut depth = 0;
        loop {
            match reader.read_event().map_err(unreadable)? {
                Event::Start(tag) => {
                    depth += 1;
                    if depth == 2 {
                        attributes.read(&tag)?;
                    }
                }
                Event::Empty(tag) if depth == 1 => attributes.read(&tag)?,
                Event::End(_) => depth -= 1,
                Event::Eof => return Ok(attributes.body()),
                _ => {}
            }
        }
    }
}

fn unreadable(reason: impl Display) -> ArmError {
    ArmError::Inertial { reason: reason.to_string() }
}

/// Fills `target` with the numbers of an attribute, as far as there are any.
fn fill(tag: &BytesStart<'_>, name: &str, target: &mut [f64]) -> Result<(), ArmError> {
    let Some(attribute) = tag.try_get_attribute(name).map_err(unreadable)? else {
        return Ok(());
    };
    let text = attribute.unescape_value().map_err(unreadable)?;
    for (target, word) in target.iter_mut().zip(text.split_whitespace()) {
        *target = word.parse().map_err(|_| unreadable(format!("{name}: \"{word}\" is not a number")))?;
    }
    Ok(())
}

impl Attributes {
    /// A tag inside the element.
    fn read(&mut self, tag: &BytesStart<'_>) -> Result<(), ArmError> {
        match tag.name().as_ref() {
            b"origin" => {
                fill(tag, "xyz", &mut self.xyz)?;
                fill(tag, "rpy", &mut self.rpy)
            }
            b"mass" => fill(tag, "value", &mut self.mass),
            b"inertia" => {
                let names = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];
                let mut both = names.into_iter().zip(self.tensor.chunks_mut(1));
                both.try_for_each(|(name, target)| fill(tag, name, target))
            }
            _ => Ok(()),
        }
    }

    fn body(&self) -> Inertia {
        let [mass] = self.mass;
        let [xx, xy, xz, yy, yz, zz] = self.tensor;
        let centred = Inertia { mass, com: Vector3::zeros(), tensor: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz) };
        centred.transformed(&Pose::from_xyz_rpy(self.xyz, self.rpy))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_element_that_was_written_is_read() {
        let body = Inertia {
            mass: 2.5,
            com: Vector3::new(0.1, -0.2, 0.3),
            tensor: Matrix3::new(0.3, 0.01, 0.02, 0.01, 0.4, 0.03, 0.02, 0.03, 0.5),
        };
        assert_eq!(Inertia::from_urdf(&body.to_urdf()).expect("it is one"), body);
        assert_eq!(Inertia::from_urdf("<inertial/>").expect("it is one"), Inertia::zero());
    }

    #[test]
    fn an_attribute_that_is_no_number_is_named() {
        let error = Inertia::from_urdf("<inertial><mass value=\"1\"/><inertia ixx=\"a\"/></inertial>");
        let error = error.expect_err("a letter").to_string();
        assert_eq!(error, "the <inertial> cannot be read: ixx: \"a\" is not a number");
    }
}
