//! Bodies in the place of a URDF's placeholders, as known effects.

use arm::Arm;
use effects::Effect;
use effects::arm::{INERTIAL_PARAMETERS, link_effect};

/// Bodies in the place of placeholders.
pub struct Replaced {
    /// The arm with these bodies, against which recordings are checked.
    pub arm: Arm,
    /// The bodies as effects.
    pub effects: Vec<Effect>,
    /// What was replaced.
    pub remark: String,
}

/// The bodies that are taken in the place of those whose moments of inertia are placeholders in the URDF of `arm`, on links that the `known`
/// effects do not give a body; `None` if there are none.
pub fn replaced(arm: &Arm, known: &[Effect]) -> Option<Replaced> {
    let is_open = |name: &str| {
        let gives_it = |effect: &Effect| effect.is(&INERTIAL_PARAMETERS) && effect.joint() == Some(name);
        !known.iter().any(gives_it)
    };
    let mut bodies = arm.bodies_for_placeholders();
    bodies.retain(|(link, _)| is_open(&arm.joints()[*link].name));
    let joint = |link: usize| &arm.joints()[link];
    let names: Vec<&str> = bodies.iter().map(|(link, _)| joint(*link).link_name.as_str()).collect();
    (!bodies.is_empty()).then(|| Replaced {
        arm: bodies.iter().fold(arm.clone(), |arm, (link, body)| arm.with_link_inertia(*link, *body)),
        effects: bodies.iter().map(|(link, body)| link_effect(&joint(*link).name, body)).collect(),
        remark: format!(
            "the moments of inertia of {} are one number, that of bodies too large for this arm: a diagnosis takes those of a rod of the link's \
             mass and length as known in their place, and writes them (--urdf, --model); correct <inertia>, or take the URDF as exact with \
             --urdf-accuracy 0",
            names.join(", ")
        ),
    })
}

#[cfg(test)]
mod tests {
    use arm::{ChainOptions, Inertia, Matrix3};

    use super::*;
    use crate::robot::named_robot;

    /// Moments of 1 kg m² on two links of the PUMA 560 are replaced, unless their bodies are known.
    #[test]
    fn a_placeholder_is_replaced_unless_the_body_is_known() {
        let robot = named_robot("puma560").expect("it comes with testbed");
        let arm = robot.arm(&ChainOptions::default()).expect("an arm");
        assert!(replaced(&arm, &[]).is_none());
        let wrong = [3, 4].into_iter().fold(arm, |arm, link| {
            let body = Inertia { tensor: Matrix3::identity(), ..arm.joints()[link].inertia };
            arm.with_link_inertia(link, body)
        });
        let Replaced { arm: right, effects, remark } = replaced(&wrong, &[]).expect("a placeholder");
        assert!(remark.contains(&wrong.joints()[3].link_name), "{remark}");
        let moment = right.joints()[3].inertia.tensor[(0, 0)];
        assert!((1e-4..0.1).contains(&moment) && right.joints()[2] == wrong.joints()[2], "{moment}");
        assert!(replaced(&wrong, &effects).is_none());
    }
}
