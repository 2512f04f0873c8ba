//! The alternatives of a finding in words.

use diagnosis::{Confusable, Finding};

use crate::words;

/// A finding's alternatives: `payload, or asymmetric friction on joint_2, or torque scale on joint_2 with one on joint_3`.
pub fn text(finding: &Finding) -> String {
    let one = |other: &Confusable| {
        let name = words::wording(other.effect).name;
        match &other.joint {
            Some(joint) if Some(joint) != finding.joint.as_ref() => format!("{name} on {joint}"),
            _ => name.to_owned(),
        }
    };
    // The same effect on every joint is one alternative of an effect of the whole arm, not one on each joint.
    let common = finding.as_effect.spec().same_on_all_joints;
    let (of_all, others): (Vec<_>, Vec<_>) =
        finding.confusable_with.iter().partition(|other| Some(other.effect) == common);
    let joints: Vec<&str> = of_all.iter().filter_map(|other| other.joint.as_deref()).collect();
    let together = match joints[..] {
        [_, _, ..] => {
            let name = words::wording(of_all[0].effect).name;
            vec![format!("{name} on {} together", words::list(&joints))]
        }
        _ => of_all.into_iter().map(one).collect(),
    };
    let pairs = finding.confusable_with_pairs.iter();
    let pairs = pairs.map(|[first, second]| format!("{} together with {}", one(first), one(second)));
    let alone = others.into_iter().map(one);
    together.into_iter().chain(alone).chain(pairs).collect::<Vec<_>>().join(", or ")
}

/// A finding's alternatives, with the experiment that distinguishes them from it.
pub fn with_experiment(finding: &Finding) -> String {
    let could_be = format!("could also be {}", text(finding));
    match words::experiments(finding).as_str() {
        "" => could_be,
        experiments => format!("{could_be}; experiment that distinguishes them: {experiments}"),
    }
}

/// Whether a finding has alternatives.
pub fn has_any(finding: &Finding) -> bool {
    !finding.confusable_with.is_empty() || !finding.confusable_with_pairs.is_empty()
}

#[cfg(test)]
mod tests {
    use effects::Effect;
    use effects::arm::INERTIAL_SCALE;

    use super::*;

    /// A common factor of all masses equals one of all torques; the torque constant of one joint does not.
    #[test]
    fn one_effect_on_every_joint_is_one_alternative() {
        let on = |effect, joint: &str| Confusable { effect, joint: Some(joint.to_owned()) };
        let mut finding = Finding::of(Effect::of(&INERTIAL_SCALE));
        finding.confusable_with = vec![on("torque_scale", "a")];
        assert_eq!(text(&finding), "torque scale on a");
        finding.confusable_with = vec![on("torque_scale", "a"), on("spring", "a"), on("torque_scale", "b")];
        assert_eq!(text(&finding), "torque scale on a and b together, or spring on a");
        finding.confusable_with.push(on("torque_scale", "c"));
        assert_eq!(text(&finding), "torque scale on a, b and c together, or spring on a");
    }
}
