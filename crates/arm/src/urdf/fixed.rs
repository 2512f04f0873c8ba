//! The bodies that a URDF fixes to a link.

use crate::inertia::Inertia;
use crate::model::FixedBody;

/// A link beyond a fixed joint.
pub(super) struct Attached {
    /// Its name in the URDF.
    pub name: String,
    /// Its place in the list of the link that carries it; `None` is the first link.
    pub carried_by: Option<usize>,
    /// Its own body, in the frame of the first link.
    pub inertia: Inertia,
}

/// The least part of a link's mass that is left when a body is taken off: less is rounding.
const LEAST_LEFT: f64 = 1e-9;

/// The bodies that could be taken off a link of mass `total` (kg): each of its fixed links with all that it carries, where some
/// mass is left and where no link beyond it is the same body.
pub(super) fn removable(attached: &[Attached], total: f64) -> Vec<FixedBody> {
    let mut list: Vec<FixedBody> =
        attached.iter().map(|link| FixedBody { name: link.name.clone(), inertia: link.inertia }).collect();
    for (place, link) in attached.iter().enumerate().rev() {
        if let Some(carrier) = link.carried_by {
            list[carrier].inertia = list[carrier].inertia.merged(&list[place].inertia);
        }
    }
    let is_alone = |place: usize| {
        let mut beyond = attached.iter().zip(&list).filter(|(link, _)| link.carried_by == Some(place));
        beyond.all(|(_, other)| other.inertia.mass < list[place].inertia.mass)
    };
    let is_removable = |place: &usize| {
        let mass = list[*place].inertia.mass;
        mass > 0.0 && mass < (1.0 - LEAST_LEFT) * total && is_alone(*place)
    };
    (0..list.len()).filter(is_removable).map(|place| list[place].clone()).collect()
}

#[cfg(test)]
mod tests {
    use crate::model::Arm;

    #[test]
    fn a_tool_and_what_it_carries_can_be_taken_off() {
        let inertial = |mass: f64| {
            format!(
                r#"<inertial><mass value="{mass}"/><inertia ixx=".1" ixy="0" ixz="0" iyy=".1" iyz="0" izz=".1"/></inertial>"#
            )
        };
        let text = format!(
            r#"<robot name="a"><link name="base"/>
<joint name="j" type="continuous"><parent link="base"/><child link="l"/><axis xyz="0 1 0"/></joint><link name="l">{}</link>
<joint name="f" type="fixed"><parent link="l"/><child link="flange"/></joint><link name="flange"/>
<joint name="h" type="fixed"><parent link="flange"/><child link="hand"/></joint><link name="hand">{}</link>
<joint name="c" type="fixed"><parent link="hand"/><child link="camera"/></joint><link name="camera">{}</link></robot>"#,
            inertial(2.0),
            inertial(0.5),
            inertial(0.1)
        );
        let arm = Arm::from_urdf_text(&text, "a.urdf").expect("it is an arm");
        let bodies: Vec<(&str, f64)> =
            arm.fixed_bodies().iter().map(|body| (body.name.as_str(), body.inertia.mass)).collect();
        // The flange has no mass of its own: it is the hand.
        assert_eq!(bodies, [("hand", 0.6), ("camera", 0.1)]);
    }
}
