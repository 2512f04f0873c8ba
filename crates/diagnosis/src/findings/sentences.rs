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

/// A finding in one sentence.
pub fn of(finding: &Finding, fit: &BTreeMap<String, JointFit>) -> String {
    let value = |key: &str| -> String {
        finding.parameters.get(key).map_or_else(String::new, |p| {
            format!("{} {}", number(p.value), p.unit)
                .trim_end_matches(" 1")
                .to_owned()
        })
    };
    let scaled = |key: &str, factor: f64| -> String {
        let parameter = finding.parameters.get(key);
        parameter.map_or_else(String::new, |p| number(factor * p.value))
    };
    let what = match finding.effect {
        "viscous_friction" => format!("viscous friction of {}", value("coefficient")),
        "coulomb_friction" => format!("dry friction of {}", value("level")),
        "friction_asymmetry" => format!(
            "dry friction that depends on the direction, {} forwards and {} backwards",
            value("positive"),
            value("negative")
        ),
        "stribeck_friction" => format!(
            "dry friction that falls from {} to {} within about {}",
            value("breakaway"),
            value("coulomb"),
            value("velocity")
        ),
        "load_dependent_friction" => format!("dry friction of {} and {} of the load", value("coulomb"), value("gain")),
        "thermal_drift" => format!(
            "dry friction of {}, larger by a factor {} at first, fading within {}",
            value("coulomb"),
            value("amplitude"),
            value("time_constant")
        ),
        "quadratic_drag" => format!("a drag of {}", value("coefficient")),
        "rotor_inertia" => format!("a drive's inertia of {}", value("inertia")),
        "torque_scale" => format!("torque measured {} times too large", value("factor")),
        "torque_offset" => format!("a constant torque of {}", value("offset")),
        "torque_ripple" => format!(
            "a ripple of {} with {} periods a turn",
            value("amplitude"),
            value("periods")
        ),
        "torque_saturation" => format!("torque limited at {}", value("limit")),
        "actuation_delay" => format!("torque applied {} late", value("delay")),
        "joint_elasticity" => format!("a spring of {} between drive and link", value("stiffness")),
        "backlash" => format!("a gap of ± {}", value("halfgap")),
        "transmission_coupling" => format!(
            "a drive turned by {} too, with {} of friction and {} of inertia",
            finding.other.as_deref().unwrap_or("another joint"),
            value("viscous"),
            value("inertia")
        ),
        "payload" => format!("a payload of {} at the tool", value("mass")),
        "link_inertial_error" => format!(
            "a link whose mass and inertia are off by {} %",
            scaled("relative", 100.0)
        ),
        "inertial_scale" => format!("all masses and inertias {} times the model's", value("factor")),
        "gravity_misalignment" => format!("a base tilted by {}", value("angle")),
        "encoder_offset" => format!("an encoder off by {}", value("offset")),
        "spring" => format!("a spring-like torque of {} about {}", value("stiffness"), value("rest")),
        "external_contact" => format!(
            "a force of {} on the tool for {} from {}",
            value("force"),
            value("duration"),
            value("start")
        ),
        other => other.replace('_', " "),
    };
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
