//! Findings in one sentence, and which experiment would tell more.

use std::collections::BTreeMap;

use crate::findings::report::{Finding, JointFit};

/// A number with three digits, without an exponent where it can be helped.
fn number(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 {
        "0".into()
    } else if (1e-3..1e4).contains(&magnitude) {
        let decimals = (2 - magnitude.log10().floor() as i32).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.2e}")
    }
}

/// The sentence of the finding's effect with its numbers.
fn filled(finding: &Finding) -> String {
    let mut parts = finding.as_effect.spec().sentence.split('{');
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (key, rest) = part.split_once('}').unwrap_or((part, ""));
        let number = |key: &str, factor: f64| finding.parameters.get(key).map(|p| (number(factor * p.value), p.unit));
        match (key, key.strip_suffix('%')) {
            ("other", _) => text.push_str(finding.other.as_deref().unwrap_or("another joint")),
            (_, Some(key)) => text.push_str(&number(key, 100.0).map_or_else(String::new, |(number, _)| number)),
            _ => match number(key, 1.0) {
                Some((number, "1")) => text.push_str(&number),
                Some((number, unit)) => text.push_str(&format!("{number} {unit}")),
                None => {}
            },
        }
        text.push_str(rest);
    }
    text
}

/// A finding in one sentence.
pub fn of(finding: &Finding, fit: &BTreeMap<String, JointFit>) -> String {
    let what = filled(finding);
    let what = match finding.parameters.get("onset") {
        Some(onset) => format!("{what} from {} s on", number(onset.value)),
        None => what,
    };
    let at = finding.joint.clone().or_else(|| {
        let largest = finding.share_by_joint.iter().max_by(|a, b| a.1.total_cmp(b.1));
        largest.map(|(joint, _)| joint.clone())
    });
    let held_out = at
        .and_then(|joint| fit.get(&joint).map(|fit| (joint, *fit)))
        .and_then(|(joint, fit)| {
            let (before, after) = (fit.held_out_nrmse_nominal?, fit.held_out_nrmse_augmented?);
            Some((joint, before, after))
        });
    let place = finding.joint.as_deref().unwrap_or("the whole arm");
    if let (false, Some(_), Some(between)) = (finding.corrects, &finding.joint, &finding.place.state) {
        let smaller = finding.held_out_gain.map_or_else(String::new, |gain| {
            format!(
                ", with which the difference of the two is {:.0} % smaller on held-out recordings",
                100.0 * gain
            )
        });
        return format!("{place}, {between}: {what}{smaller}");
    }
    let share = match finding.joint {
        Some(_) => format!("{:.0} % of its torque", 100.0 * finding.share),
        None => format!("up to {:.0} % of a joint's torque", 100.0 * finding.share),
    };
    let effect = match held_out {
        Some((joint, before, after)) if finding.joint.is_none() => {
            format!("; held-out error of {joint} {} → {}", number(before), number(after))
        }
        Some((_, before, after)) => format!("; held-out error {} → {}", number(before), number(after)),
        None => String::new(),
    };
    format!("{place}: {what}, {share}{effect}")
}

/// Which experiment would tell what lies behind structure that depends on `on`.
pub fn next_experiment(joint: &str, on: &str) -> String {
    if let Some(other) = on.strip_prefix("other_joint:") {
        return format!("move {joint} alone with {other} at rest, then {other} alone with {joint} at rest");
    }
    match on {
        "own_position" => {
            format!("sweep {joint} slowly through its whole range, both ways, with all others at rest, at two speeds")
        }
        "history" => format!(
            "repeat one motion of {joint} after pauses of different length and with reversals of different amplitude"
        ),
        "own_position_times_speed" => format!("sweep {joint} through its range at three constant speeds, both ways"),
        "time" => format!("repeat one and the same motion of {joint} every minute for ten minutes"),
        _ => format!("move {joint} alone at three constant speeds, both ways, twice"),
    }
}
