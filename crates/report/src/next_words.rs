//! The next experiment in sentences, for the terminal and the page.

use diagnosis::{Confusable, NextExperiment};

use crate::words;

/// The largest number of pairs that are listed; further ones are counted.
const LISTED: usize = 6;

/// What the motion distinguishes, and which pairs of effects no motion distinguishes.
pub fn sentences(next: &NextExperiment) -> Vec<String> {
    let mut list = Vec::new();
    let distinguished = pairs(next.separates.iter().map(|pair| (&pair.finding, &pair.rival)));
    match next.duration {
        Some(duration) if !distinguished.is_empty() => list.push(format!(
            "a motion of {duration:.0} s within the joint limits should distinguish {}",
            listed(&distinguished)
        )),
        Some(duration) => {
            list.push(format!("a motion of {duration:.0} s within the joint limits makes {} testable", shown(next)));
        }
        None => list.push("no motion within the joint limits would give more information".to_owned()),
    }
    let mut advice: Vec<&str> = Vec::new();
    for undecided in &next.not_separated {
        if !advice.contains(&undecided.instead.as_str()) {
            advice.push(&undecided.instead);
        }
    }
    let no_motion = match next.duration {
        Some(_) => "that motion does not distinguish",
        None => "no motion within the joint limits distinguishes",
    };
    for instead in advice {
        let same = next.not_separated.iter().filter(|undecided| undecided.instead == instead);
        let pairs_left = pairs(same.map(|undecided| (&undecided.finding, &undecided.rival)));
        list.push(format!("{no_motion} {}; instead, {instead}", listed(&pairs_left)));
    }
    list
}

/// `A from B`, with the joints of one alternative counted together.
fn pairs<'a>(pairs: impl Iterator<Item = (&'a Confusable, &'a Confusable)>) -> Vec<String> {
    let mut groups: Vec<(&Confusable, &'static str, Vec<&Confusable>)> = Vec::new();
    for (finding, rival) in pairs {
        // An effect of the whole arm is not one of a joint.
        let is_same = |group: &&mut (&Confusable, &'static str, Vec<&Confusable>)| {
            group.0 == finding && group.1 == rival.effect && group.2[0].joint.is_some() == rival.joint.is_some()
        };
        match groups.iter_mut().find(is_same) {
            Some(group) => group.2.push(rival),
            None => groups.push((finding, rival.effect, vec![rival])),
        }
    }
    let said = groups.iter().map(|(finding, rival, places)| {
        let rival = words::wording(rival).name;
        let rival = match places.as_slice() {
            [one] if one.joint == finding.joint => rival.to_owned(),
            [one] => name(one),
            several => format!("{rival} on {} joints", several.len()),
        };
        format!("{} from {rival}", name(finding))
    });
    said.collect()
}

fn listed(pairs: &[String]) -> String {
    if pairs.len() <= LISTED {
        return words::list(pairs);
    }
    format!("{}, and {} more", pairs[..LISTED].join(", "), pairs.len() - LISTED)
}

fn shown(next: &NextExperiment) -> String {
    let mut names: Vec<String> = Vec::new();
    for shows in &next.shows {
        let name = words::wording(shows.effect).name.to_owned();
        if !names.contains(&name) {
            names.push(name);
        }
    }
    words::list(&names)
}

/// `viscous friction on joint2`.
pub fn name(what: &Confusable) -> String {
    let effect = words::wording(what.effect).name;
    match &what.joint {
        Some(joint) => format!("{effect} on {joint}"),
        None => effect.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use diagnosis::{NotSeparated, Obstacle, Separation};

    use super::*;

    #[test]
    fn what_a_motion_distinguishes_is_stated_once() {
        let on = |effect: &'static str, joint: Option<&str>| Confusable { effect, joint: joint.map(str::to_owned) };
        let undecided = |joint: &str| NotSeparated {
            finding: on("inertial_scale", None),
            rival: on("torque_scale", Some(joint)),
            best: 0.0,
            needed: 4.0,
            kind: Obstacle::SameTorque,
            because: String::new(),
            instead: "weigh it".into(),
        };
        let of_arm = NotSeparated { rival: on("torque_scale", None), ..undecided("a") };
        let next = NextExperiment {
            duration: Some(25.0),
            separates: vec![Separation {
                finding: on("viscous_friction", Some("a")),
                rival: on("quadratic_drag", Some("a")),
                before: 1.0,
                after: 20.0,
                needed: 4.0,
            }],
            not_separated: vec![undecided("a"), undecided("b"), of_arm],
            shows: Vec::new(),
            limits: Vec::new(),
        };
        let said = sentences(&next);
        assert_eq!(said.len(), 2);
        assert!(said[0].ends_with("should distinguish viscous friction on a from quadratic drag"), "{said:?}");
        assert!(
            said[1].contains("torque scale on 2 joints") && said[1].ends_with("from torque scale; instead, weigh it"),
            "{said:?}"
        );
    }
}
