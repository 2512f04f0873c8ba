//! The experiment to make where no motion distinguishes two effects.

use effects::arm::{LINK_INERTIAL_ERROR, PAYLOAD};
use effects::sensor::TORQUE_SCALE;

use crate::report::{Confusable, NotSeparated, Obstacle};
use crate::thresholds::{ALIAS, NEARLY_NATS};

/// The confusion of `finding` with `rival`: the best motion for it brings the evidence `best` (nats), and `needed`
/// distinguishes them. `sure` is the evidence from which it is promised, unless it is `barred` for a reason.
pub fn not_separated(
    finding: Confusable,
    rival: Confusable,
    [best, needed]: [f64; 2],
    sure: f64,
    barred: Option<(Obstacle, &str)>,
) -> NotSeparated {
    let kind = if best.abs() < ALIAS.0.max(ALIAS.1 * needed) {
        Obstacle::SameTorque
    } else if let Some((reason, _)) = barred {
        reason
    } else if best < sure {
        Obstacle::OutOfReach
    } else {
        Obstacle::AnotherMotion
    };
    let because = match kind {
        Obstacle::SameTorque => "no motion that was tried gives evidence for one of the two".to_owned(),
        Obstacle::OutOfReach => format!(
            "the best motion within the joint limits gives {:.1} nats of evidence, and a reliable distinction needs {sure:.1}",
            best.max(0.0)
        ),
        Obstacle::Unexplained | Obstacle::NoPrediction => barred.map_or_else(String::new, |(_, why)| why.to_owned()),
        Obstacle::AnotherMotion => {
            "another motion distinguishes them; the proposed one serves the other pairs better".to_owned()
        }
    };
    let instead = match kind {
        Obstacle::AnotherMotion => {
            "record the proposed motion, diagnose again with its recording, and let a further motion be proposed"
        }
        Obstacle::Unexplained => "resolve the unexplained residual of the joint first",
        _ => instead(finding.effect, rival.effect),
    };
    let instead = instead.to_owned();
    NotSeparated { finding, rival, best, needed: sure, kind, because, instead }
}

/// Why the outcome of a motion for a pair is not predicted, as an obstacle and in a sentence.
pub fn barred(
    is_explained: bool,
    resembles_links: bool,
    is_already_distinguished: bool,
) -> Option<(Obstacle, &'static str)> {
    if !is_explained {
        let why = "the joint has an unexplained residual, so that the outcome of a motion cannot be predicted";
        return Some((Obstacle::Unexplained, why));
    }
    let why = if resembles_links {
        "the alternative resembles wrong links and torque constants, and which of them the motion shows is not known"
    } else if is_already_distinguished {
        "the prediction fails on these recordings: it says that they already distinguish the two, which they do not"
    } else {
        return None;
    };
    Some((Obstacle::NoPrediction, why))
}

/// Whether an alternative multiplies masses or torques, as wrong links and torque constants do. Source: beside these, 16 of 44 predictions
/// for torque scales in the place of rotor inertias came true in `prove`, seed 28113001, and 18 of the 23 others.
pub fn resembles_links(rival: &str) -> bool {
    effects::spec(rival).is_some_and(|spec| spec.is_wrong_mass || spec.name == TORQUE_SCALE.name)
}

/// The confusion of `finding` with `rival`, for which no motion is predicted. `last` is the last joint of the arm.
pub fn unpredicted(finding: Confusable, rival: Confusable, last: Option<&str>) -> NotSeparated {
    // A payload is a change of the last link, and a link that is wrong by a factor is a special case of a link that is wrong.
    let is_of_last = finding.effect == PAYLOAD.name && rival.joint.as_deref() == last;
    let is_special = finding.effect == LINK_INERTIAL_ERROR.name && finding.joint == rival.joint;
    let (kind, because) = if rival.joint.is_some() && (is_of_last || is_special) {
        let because = "the alternative contains the finding, with the same torque in every motion".to_owned();
        (Obstacle::SameTorque, because)
    } else {
        let of = match &rival.joint {
            Some(joint) => format!("the inertial parameters of the link after {joint}"),
            None => "all inertial parameters together".to_owned(),
        };
        let because = format!("the alternative is a correction of {of}, for which no motion is predicted");
        (Obstacle::NoPrediction, because)
    };
    let instead = instead(finding.effect, rival.effect).to_owned();
    NotSeparated { finding, rival, best: 0.0, needed: NEARLY_NATS, kind, because, instead }
}

/// The experiment that distinguishes two effects that no motion distinguishes.
fn instead(finding: &str, rival: &str) -> &'static str {
    let of_one = || {
        let specs = [finding, rival].map(effects::spec);
        let experiments = specs.iter().flatten().filter_map(|spec| spec.experiment);
        experiments.max_by_key(|experiment| experiment.rank).map(|experiment| experiment.text)
    };
    let of_kind = || effects::spec(finding).map(|spec| spec.distinguished_by).filter(|text| !text.is_empty());
    effects::experiment_against(finding, rival).or_else(of_one).or_else(of_kind).unwrap_or(
        "add a sensor (a torque sensor or an encoder on the link side of the gear), or attach a known load to the tool",
    )
}
