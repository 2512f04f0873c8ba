//! The background's changes of the links' inertial parameters: named where they are large, exported as physically possible
//! bodies.

use std::collections::BTreeMap;

use arm::Inertia;
use effects::arm::{INERTIAL_PARAMETER, INERTIAL_PARAMETERS, PAYLOAD, body, link_effect};
use effects::{Effect, Regressor};

use crate::regression::bodies::{LeastBody, PER_LINK, physical};
use crate::report::{Confusable, Dependence, Finding, LinkInertials, Parameter, Unexplained};
use crate::search::candidate::Hypothesis;
use crate::search::study::LinearisationPoint;
use crate::selection::FinalFit;
use crate::selection::predict::errors_with;
use crate::selection::rivals::{allowance, probability};
use crate::selection::special_forms::{in_place_of_link, special_forms};
use crate::thresholds::{
    LEAST_SHARE_EVERYWHERE, LEAST_WRONG_EVERYWHERE, LINK_OVER_CONSTANTS, LINK_STANDS_OUT, LISTED_SHARE, OF_NEIGHBOUR,
    PARTLY, SYSTEMATIC, WRIST,
};

/// The links that differ from the URDF.
#[derive(Clone, Debug, Default)]
pub struct Inertials {
    /// One finding for most links (joint `None`), or one for each link that stands out.
    pub findings: Vec<Finding>,
    /// The bodies of all links for the corrected model; empty if no link differs.
    pub effects: Vec<Effect>,
    /// The links, by the joint before the link.
    pub links: BTreeMap<String, LinkInertials>,
}

/// Leaves out the findings of single links beside residuals that no effect explains: a part of such a residual resembles one wrong link
/// more often than one link among right ones is wrong. A residual that only lasts for some time counts if it is on a joint on which the link acts.
/// Returns a note on the links.
pub fn leave_out_single_links(
    findings: &mut Vec<(Finding, Option<usize>)>,
    unexplained: &[Unexplained],
) -> Option<String> {
    let is_time = |on: &Dependence| on.on == Regressor::Time;
    let lasts = |residual: &Unexplained| residual.time.is_empty() || !residual.depends_on.iter().all(is_time);
    let mut left_out = Vec::new();
    findings.retain(|(finding, _)| {
        let mut residuals = unexplained.iter();
        let beside = residuals.find(|residual| lasts(residual) || finding.share_by_joint.contains_key(&residual.joint));
        match (&finding.joint, beside) {
            (Some(link), Some(residual)) if finding.effect == INERTIAL_PARAMETERS.name => {
                left_out.push(format!("of the link after {link} (beside {})", residual.joint));
                false
            }
            _ => true,
        }
    });
    (!left_out.is_empty()).then(|| {
        format!(
            "other inertial parameters {} would explain a part of the torque, but are not named, because the residual there is unexplained",
            left_out.join(", and ")
        )
    })
}

/// Makes a payload beside a wrong link of the wrist (`joints` in order) as likely as that link alone: another error of the link than the prior
/// expects, such as a mirrored centre of mass, resembles a smaller one and a payload together.
pub fn doubt_payload(findings: &mut [(Finding, Option<usize>)], joints: &[String]) {
    let wrist = &joints[joints.len() - WRIST.min(joints.len() / 2)..];
    let is_link = |finding: &&Finding| finding.effect == INERTIAL_PARAMETERS.name && finding.change.is_none();
    let links: Vec<String> = findings
        .iter()
        .map(|(finding, _)| finding)
        .filter(is_link)
        .filter_map(|finding| finding.joint.clone())
        .filter(|joint| wrist.contains(joint))
        .collect();
    let is_payload = |finding: &Finding| finding.effect == PAYLOAD.name && finding.change.is_none();
    for (finding, _) in findings.iter_mut().filter(|(finding, _)| !links.is_empty() && is_payload(finding)) {
        finding.probability = finding.probability.map(|probability| probability.min(0.5));
        for joint in &links {
            let rival = Confusable { effect: INERTIAL_PARAMETERS.name, joint: Some(joint.clone()) };
            if !finding.confusable_with.contains(&rival) {
                finding.confusable_with.insert(0, rival);
            }
        }
    }
}

const KEYS: [&str; PER_LINK] = ["mass", "com_x", "com_y", "com_z", "ixx", "ixy", "iyy", "ixz", "iyz", "izz"];
const UNITS: [&str; PER_LINK] = ["kg", "m", "m", "m", "kg m²", "kg m²", "kg m²", "kg m²", "kg m²", "kg m²"];

fn numbers(body: &Inertia) -> [f64; PER_LINK] {
    let t = |a: usize, b: usize| body.tensor[(a, b)];
    let c = body.com;
    [body.mass, c.x, c.y, c.z, t(0, 0), t(0, 1), t(1, 1), t(0, 2), t(1, 2), t(2, 2)]
}

/// The inertial parameters of the links by the background of the final fit. If other bodies are requested, they are findings whatever
/// explains as much.
pub fn inertials(last: &FinalFit, are_requested: bool) -> Inertials {
    let FinalFit { study, judged, resampled, held, .. } = last;
    let (data, table, strengths) = (&study.data, &study.table, &study.strengths);
    let dof = data.arm.dof();
    if strengths.strongest() == 0.0 {
        return Inertials::default();
    }
    // The links with their scale errors, without payload, tilt and other effects.
    let nominal: Vec<f64> = LinearisationPoint::scaled(data, table, &judged.named.fit).inertial_parameters();
    let place = |link: usize, parameter: usize| {
        let is_it = |&column: &usize| {
            let term = table.terms[column];
            term.is(&INERTIAL_PARAMETER) && term.of == [link, parameter]
        };
        resampled.columns.iter().position(is_it)
    };
    let mut list = Inertials::default();
    let mut shares = vec![vec![0.0; dof]; dof];
    for link in 0..dof {
        let places: Vec<Option<usize>> = (0..PER_LINK).map(|parameter| place(link, parameter)).collect();
        let read = |draw: &[f64]| -> [f64; PER_LINK] {
            std::array::from_fn(|parameter| places[parameter].map_or(0.0, |place| draw[place]))
        };
        let of = &nominal[link * PER_LINK..(link + 1) * PER_LINK];
        let own = |draw: &[f64]| body(&physical(of, LeastBody::default(), &read(draw)));
        let estimate = own(&resampled.estimate);
        let name = data.arm.joints()[link].name.clone();
        list.effects.push(link_effect(name.clone(), &estimate));
        let columns: Vec<usize> = places.iter().flatten().map(|&place| resampled.columns[place]).collect();
        let values: Vec<f64> = places.iter().flatten().map(|&place| resampled.estimate[place]).collect();
        for (joint, share) in shares[link].iter_mut().enumerate() {
            let torque = table.torque(joint, &columns, &values);
            *share = data.share(joint, table.spread(joint, &data.fitted, &torque));
        }
        let prior = study.prior_variances(link);
        let determined = std::array::from_fn(|parameter| {
            let Some(place) = places[parameter] else { return 0.0 };
            let draws = resampled.draws.iter().map(|draw| draw[place] - resampled.estimate[place]);
            let variance = draws.map(|d| d * d).sum::<f64>() / resampled.draws.len() as f64;
            (1.0 - variance / prior[parameter].max(1e-300)).clamp(0.0, 1.0)
        });
        let parameters = (0..PER_LINK)
            .map(|k| {
                let (value, ci95) = resampled.interval_within(SYSTEMATIC, |draw| numbers(&own(draw))[k]);
                let unit = UNITS[k];
                (KEYS[k], Parameter { value, ci95, unit })
            })
            .collect();
        let share = shares[link].iter().copied().fold(0.0, f64::max);
        let nominal_mass = data.arm.joints()[link].inertia.mass;
        let link = LinkInertials { nominal_mass, parameters, determined, share };
        list.links.insert(name, link);
    }
    let (evidence, outside) = study.evidence_of_inertials(held.as_ref(), &judged.named);
    let is_unlikely = evidence < study.thresholds.least_evidence || outside.is_some_and(|outside| outside <= 0.0);
    if is_unlikely && !are_requested {
        return list;
    }
    let common = strengths.common();
    // The evidence has not selected that a placeholder is wrong.
    let is_selected = |link: usize| strengths.links[link] > LINK_STANDS_OUT * common;
    let is_evident = |link: usize| study.evidence_of_link(&judged.named, link)[0] >= study.thresholds.least_evidence;
    let apart: Vec<usize> = (0..dof)
        .filter(|&link| strengths.of_link(link) > LINK_STANDS_OUT * common && (is_selected(link) || is_evident(link)))
        .collect();
    let together: Vec<f64> = (0..dof)
        .map(|joint| {
            let columns = resampled.columns.iter().copied();
            let (columns, values): (Vec<usize>, Vec<f64>) = columns
                .zip(&resampled.estimate)
                .filter(|(column, _)| {
                    let term = table.terms[*column];
                    term.is(&INERTIAL_PARAMETER) && !apart.contains(&term.of[0])
                })
                .unzip();
            let torque = table.torque(joint, &columns, &values);
            data.share(joint, table.spread(joint, &data.fitted, &torque))
        })
        .collect();
    let by_joint = |shares: &[f64]| -> BTreeMap<String, f64> {
        let named = (0..dof).filter(|&joint| shares[joint] > LISTED_SHARE);
        named.map(|joint| (data.arm.joints()[joint].name.clone(), shares[joint])).collect()
    };
    let largest = |shares: &[f64]| shares.iter().copied().fold(0.0, f64::max);
    // If hardly anything is explained, the background compensates a model that does not fit.
    let explained: Vec<bool> = (0..dof)
        .map(|joint| errors_with(data, table, &judged.named.fit, joint).train_nrmse_augmented < PARTLY)
        .collect();
    let confusable = |(form, joint): (Hypothesis, Option<usize>)| Confusable {
        effect: form.name().unwrap_or_default(),
        joint: joint.map(|joint| data.arm.joints()[joint].name.clone()),
    };
    // The margin of a link over the best other link or effect (nats), and the links that explain nearly as much in its place, the
    // best first, then such effects. Torque constants that deviate a little are more ordinary than one wrong link among right ones: if
    // they explain as much, there is none.
    let instead = |link: usize| -> Option<(f64, Vec<Confusable>)> {
        let constants = study.in_torque_constants(&judged.named, Some(link));
        if constants < LINK_OVER_CONSTANTS {
            return None;
        }
        let [score, loss] = study.evidence_of_link(&judged.named, link);
        let mut others = study.in_other_links(&judged.named, link);
        others.sort_by(|(_, a), (_, b)| a[1].total_cmp(&b[1]));
        let forms = in_place_of_link(study, &judged.named, link);
        // Two neighbours explain nearly the same. How much less the other one explains depends on the prior, and a URDF whose link was given
        // in a wrong frame or with a wrong sign is not as the prior expects.
        let lost = others.iter().map(|(_, lost)| lost[0] - OF_NEIGHBOUR * loss);
        // Beside links that all differ, the same holds for one that differs more, unless its body is missing in the URDF.
        let is_one_of_all = common > 0.0 && strengths.least[link] == 0.0;
        let apart = if is_one_of_all { score - OF_NEIGHBOUR * evidence } else { score };
        let margin = lost.chain(forms.iter().map(|(beyond, _)| *beyond)).fold(apart.min(constants), f64::min);
        let nearly = others.iter().filter(|(_, lost)| lost[1] <= allowance(loss));
        let rivals = nearly.map(|&(other, _)| Confusable {
            effect: INERTIAL_PARAMETERS.name,
            joint: Some(data.arm.joints()[other].name.clone()),
        });
        let effects = forms.into_iter().map(|(_, form)| confusable(form));
        Some((margin, rivals.chain(effects).collect()))
    };
    // The margin and the alternatives of links that are all wrong: effects beside links that are less wrong.
    let everywhere = || -> Option<(f64, Vec<Confusable>)> {
        let constants = study.in_torque_constants(&judged.named, None);
        if constants < LINK_OVER_CONSTANTS {
            return None;
        }
        let (beyond, forms) = special_forms(study, &judged.named);
        let margin = evidence.min(constants).min(beyond);
        Some((margin, forms.into_iter().map(confusable).collect()))
    };
    let mut add = |joint: Option<usize>, shares: &[f64], parameters: BTreeMap<&'static str, Parameter>| {
        let is_everywhere = joint.is_none();
        // Beside unmodelled structure on a joint, the changes may be a part of that structure.
        let least = if is_everywhere { LEAST_SHARE_EVERYWHERE } else { study.thresholds.least_share };
        let stands_out = |at: usize| {
            let unnamed = judged.unmodelled.iter().map(|member| member.shares[at]);
            let least = least.max(study.thresholds.beside_unmodelled * unnamed.fold(0.0, f64::max));
            explained[at] && shares[at] >= least
        };
        if !are_requested && !(0..dof).any(stands_out) {
            return;
        }
        let weighed = if are_requested { Some((0.0, Vec::new())) } else { joint.map_or_else(everywhere, instead) };
        let Some((margin, confusable_with)) = weighed else { return };
        list.findings.push(Finding {
            joint: joint.map(|joint| data.arm.joints()[joint].name.clone()),
            parameters,
            probability: Some(probability(margin)),
            confusable_with,
            share: largest(shares),
            share_by_joint: by_joint(shares),
            ..Finding::of(list.effects[joint.unwrap_or(0)].clone())
        });
    };
    // A payload and the last link are one body, so that the remaining change of the link is not a second finding.
    let has_payload = judged.members.iter().any(|member| study.is_payload(member.candidate));
    for &link in apart.iter().filter(|&&link| !(has_payload && link + 1 == dof)) {
        let name = &data.arm.joints()[link].name;
        let parameters = list.links.get(name).map(|link| link.parameters.clone()).unwrap_or_default();
        add(Some(link), &shares[link], parameters);
    }
    if common >= LEAST_WRONG_EVERYWHERE || are_requested && common > 0.0 {
        let (low, high) = strengths.around_common();
        let relative = Parameter { value: common, ci95: [low, high], unit: "1" };
        add(None, &together, BTreeMap::from([("relative", relative)]));
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::TimeWindow;

    fn link(joint: Option<&str>, acts_on: &[&str]) -> Finding {
        let body = Inertia::zero();
        Finding {
            joint: joint.map(str::to_owned),
            share_by_joint: acts_on.iter().map(|&joint| (joint.to_owned(), 0.1)).collect(),
            ..Finding::of(link_effect("a".to_owned(), &body))
        }
    }

    fn residual(joint: &str, lasts: bool) -> Unexplained {
        let window = TimeWindow { recording: "r.csv".into(), start: 1.0, end: 2.0 };
        Unexplained {
            joint: joint.to_owned(),
            share: 0.1,
            depends_on: Vec::new(),
            time: if lasts { Vec::new() } else { vec![window] },
            next: String::new(),
        }
    }

    /// The whole arm keeps its name beside any residual, and a single link beside a short one on a joint that it does not act on.
    #[test]
    fn a_single_link_is_not_named_beside_a_residual_that_it_may_be_a_part_of() {
        let left = |residuals: &[Unexplained]| -> (Vec<Option<String>>, bool) {
            let findings = [link(None, &["a", "b", "c"]), link(Some("b"), &["a", "b"])];
            let mut findings: Vec<(Finding, Option<usize>)> = findings.map(|finding| (finding, None)).into();
            let note = leave_out_single_links(&mut findings, residuals);
            (findings.into_iter().map(|(finding, _)| finding.joint).collect(), note.is_some())
        };
        let both = vec![None, Some("b".to_owned())];
        assert_eq!(left(&[]), (both.clone(), false));
        assert_eq!(left(&[residual("c", false)]), (both, false));
        for residual in [residual("c", true), residual("a", false)] {
            assert_eq!(left(&[residual]), (vec![None], true));
        }
        // A transient depends on time and does not last; a residual that depends on something else does.
        let on = |regressor: Regressor| Unexplained { depends_on: vec![regressor.into()], ..residual("c", false) };
        assert_eq!(left(&[on(Regressor::Time)]), (vec![None, Some("b".to_owned())], false));
        assert_eq!(left(&[on(Regressor::OwnPosition)]), (vec![None], true));
    }

    /// A mirrored centre of mass of a wrist's link resembles another body of it and a payload together.
    #[test]
    fn a_payload_beside_a_wrong_link_of_the_wrist_is_doubtful() {
        let joints = ["a", "b", "c", "d"].map(str::to_owned);
        let payload = Finding { probability: Some(0.98), ..Finding::of(Effect::of(&PAYLOAD)) };
        for (link, expected) in [("c", 0.5), ("b", 0.98)] {
            let mut findings = vec![(payload.clone(), None), (self::link(Some(link), &[link]), None)];
            doubt_payload(&mut findings, &joints);
            assert_eq!(findings[0].0.probability, Some(expected), "{link}");
            let rivals = findings[0].0.confusable_with.iter().filter(|rival| rival.joint.as_deref() == Some(link));
            assert_eq!(rivals.count(), usize::from(link == "c"));
        }
    }
}
