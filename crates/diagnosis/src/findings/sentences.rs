//! A finding in one sentence, and the experiment that narrows down an unexplained residual.

use std::collections::BTreeMap;

use arm::{Arm, Placeholder};
use effects::arm::INERTIAL_PARAMETERS;
use effects::{Effect, Regressor};

use crate::data::Data;
use crate::report::{Change, Dependence, Finding, JointFit, Parameter, TimeWindow};
use crate::search::study::moved;
use crate::selection::naming::may_be_nothing;
use crate::thresholds::{ALIKE_SIZES, LEAST_BODY_RADIUS, LEAST_FOR_DYNAMICS, NEARLY_NO_MASS, SURE_CHANGE};
use crate::words::list;

/// A number with three significant digits, with an exponent only when it is very small or very large.
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

/// A note on constant torques that no finding names, by joint; `None` if there are none.
pub fn constant_torques(constants: &BTreeMap<String, Parameter>) -> Option<String> {
    if constants.is_empty() {
        return None;
    }
    let list: Vec<String> =
        constants.iter().map(|(joint, offset)| format!("{joint} {} {}", number(offset.value), offset.unit)).collect();
    Some(format!(
        "the corrected model adds constant torques that no finding names, because most joints have a small one, or because they \
         may be a part of an unexplained residual: {}. Their torque sensors may \
         have offsets, or the joints more friction in one direction. Record the arm at rest in several postures to \
         distinguish the two",
        list.join(", ")
    ))
}

/// How a sentence writes a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Written {
    /// The value with its unit.
    InUnit,
    /// A hundred times the value; the sentence adds the sign.
    Percent,
}

/// The finding's effect as a noun phrase with its parameters; `quantity` formats a parameter of this name.
pub fn described(finding: &Finding, quantity: &dyn Fn(&str, &Parameter, Written) -> String) -> String {
    if finding.as_effect.is(&INERTIAL_PARAMETERS) && finding.joint.is_none() {
        let relative = finding.parameters.get("relative");
        return format!(
            "masses, centres of mass and inertias of most links that differ from the URDF by about {} % of their size",
            relative.map_or_else(String::new, |relative| quantity("relative", relative, Written::Percent))
        );
    }
    let mut parts = finding.as_effect.sentence().split('{');
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (key, rest) = part.split_once('}').unwrap_or((part, ""));
        let value = |key: &str| finding.parameters.get(key);
        match (key, key.strip_suffix('%')) {
            ("other", _) => text.push_str(finding.other.as_deref().unwrap_or("another joint")),
            (_, Some(key)) => {
                text.push_str(&value(key).map_or_else(String::new, |p| quantity(key, p, Written::Percent)));
            }
            _ => text.push_str(&value(key).map_or_else(String::new, |p| quantity(key, p, Written::InUnit))),
        }
        text.push_str(rest);
    }
    if let Some(recording) = &finding.place.recording {
        text += &format!(", in {recording}");
    }
    let form_differs = had_other_form(&finding.as_effect);
    let mut text = match (finding.change, finding.parameters.get("onset")) {
        (Some(Change::Added), _) if form_differs => format!("{text}, of another form in the recordings from before"),
        (Some(Change::Added), _) => format!("{text}, {}", (finding.as_effect.spec().before_it)(&finding.as_effect)),
        (Some(Change::Increased), _) => format!("{text}, in addition to that in the recordings from before"),
        (Some(Change::Removed), _) => format!("{text}, in the recordings from before only"),
        (Some(Change::Reduced), _) => format!("{text} less than in the recordings from before"),
        (None, Some(onset)) => format!("{text} from {} on", quantity("onset", onset, Written::InUnit)),
        (None, None) => text,
    };
    if is_undetermined(finding) {
        text.push_str(", with a size that these recordings do not determine");
    }
    text
}

/// Whether the recordings do not determine the size of a finding: its interval contains the value without effect. The name may be
/// certain nevertheless.
pub fn is_undetermined(finding: &Finding) -> bool {
    may_be_nothing(finding.as_effect.spec(), &finding.parameters)
}

/// Whether an effect states a level of dry friction that was there before it changed.
fn had_other_form(effect: &Effect) -> bool {
    let generalises = effect.spec().generalises.is_some();
    generalises && (effect.spec().dry_friction)(effect).is_some_and(|level| level > 0.0)
}

/// A ratio of standard deviations in words; a ratio above one is not given as a percentage.
pub fn relative_to_torque(ratio: f64) -> String {
    if ratio >= 1.005 {
        format!("{} times the torque's standard deviation", number(ratio))
    } else {
        format!("{:.0} % of the torque's standard deviation", 100.0 * ratio)
    }
}

/// A note on joints that move only in the recordings from before, or only in the others; `None` if there are none.
pub fn not_compared(data: &Data) -> Option<String> {
    let motions = &data.motions;
    motions.changed_at?;
    let moved = moved(motions, &data.scales);
    let names = |is_before: bool| {
        let only_there =
            |list: &&Vec<usize>| !list.is_empty() && list.iter().all(|&at| motions.is_before(at) == is_before);
        let joints = data.arm.joints().iter().zip(&moved);
        let names: Vec<&str> =
            joints.filter(|(_, list)| only_there(list)).map(|(joint, _)| joint.name.as_str()).collect();
        names.join(", ")
    };
    let parts = [
        ("joints that move only in the recordings from before", names(true)),
        ("joints that do not move in the recordings from before", names(false)),
    ];
    let parts = parts.into_iter().filter(|(_, names)| !names.is_empty());
    let parts: Vec<String> = parts.map(|(which, names)| format!("{which}: {names}")).collect();
    (!parts.is_empty()).then(|| {
        format!("changes of the friction and the drives of some joints are not testable ({})", parts.join("; "))
    })
}

/// Notes on the links of whose body the URDF has a placeholder, if they have a `least` deviation.
pub fn placeholders(arm: &Arm, least: &[f64]) -> Vec<String> {
    let all = arm.placeholders(LEAST_BODY_RADIUS, NEARLY_NO_MASS);
    let (missing, without_centre): (Vec<Placeholder>, Vec<Placeholder>) = all
        .into_iter()
        .filter(|placeholder| least[placeholder.link] > 0.0)
        .partition(|placeholder| placeholder.mass > arm.joints()[placeholder.link].inertia.mass);
    let names = |of: &[Placeholder]| {
        let names: Vec<&str> = of.iter().map(|this| arm.joints()[this.link].link_name.as_str()).collect();
        list(&names)
    };
    let mut notes = Vec::new();
    if !without_centre.is_empty() {
        notes.push(format!(
            "the URDF has the centre of mass exactly at the joint on {}, which is a placeholder in most URDFs: it is taken as \
             unknown along the link, so that a payload may be undetermined; correct it; if it is true, write 1e-6 in the place of a 0",
            names(&without_centre)
        ));
    }
    if !missing.is_empty() {
        notes.push(format!(
            "the URDF gives no mass to {}: the body is taken as unknown, so that those of its neighbours and a payload may be undetermined; \
             correct it; if there is none, --urdf-accuracy 0 takes the URDF's masses as exact",
            names(&missing)
        ));
    }
    notes
}

/// The changes since the recordings from before, as noun phrases: the place and the effect. The same change on several joints is one
/// phrase, with all of its places in this `order` of the joints.
pub fn changes<'a>(findings: impl Iterator<Item = &'a Finding>, order: impl Fn(&str) -> Option<usize>) -> Vec<String> {
    let mut phrases: Vec<(String, Vec<&str>, f64)> = Vec::new();
    for finding in findings {
        let what = described(finding, &plain);
        let place = finding.joint.as_deref().unwrap_or("the whole arm");
        let probability = finding.probability.unwrap_or(1.0);
        match phrases.iter_mut().find(|(known, ..)| *known == what) {
            Some((_, places, least)) => {
                places.push(place);
                *least = least.min(probability);
            }
            None => phrases.push((what, vec![place], probability)),
        }
    }
    let phrase = |(what, mut places, least): (String, Vec<&str>, f64)| {
        places.sort_by_key(|place| order(place));
        let places = list(&places);
        if least < SURE_CHANGE {
            format!("{places}: {what} (probability {least:.2})")
        } else {
            format!("{places}: {what}")
        }
    };
    phrases.into_iter().map(phrase).collect()
}

/// A value with its unit; a percentage without its sign.
fn plain(_: &str, parameter: &Parameter, written: Written) -> String {
    match (written, parameter.unit) {
        (Written::Percent, _) => number(100.0 * parameter.value),
        (Written::InUnit, "1") => number(parameter.value),
        (Written::InUnit, unit) => format!("{} {unit}", number(parameter.value)),
    }
}

/// A finding in one sentence.
pub fn of(finding: &Finding, fit: &BTreeMap<String, JointFit>) -> String {
    let what = described(finding, &plain);
    let at = finding.joint.clone().or_else(|| {
        let largest = finding.share_by_joint.iter().max_by(|a, b| a.1.total_cmp(b.1));
        largest.map(|(joint, _)| joint.clone())
    });
    let held_out = at.and_then(|joint| fit.get(&joint).map(|fit| (joint, *fit))).and_then(|(joint, fit)| {
        let (before, after) = (fit.held_out_nrmse_nominal?, fit.held_out_nrmse_augmented?);
        Some((joint, before, after))
    });
    let place = finding.joint.as_deref().unwrap_or("the whole arm");
    if let (false, Some(_), Some(between)) = (finding.corrects, &finding.joint, &finding.place.state) {
        let smaller = finding.held_out_gain.map_or_else(String::new, |gain| {
            format!(
                ", with which the difference between the two sensors is {:.0} % smaller on held-out recordings",
                100.0 * gain
            )
        });
        return format!("{place}, {between}: {what}{smaller}");
    }
    let share = match finding.joint {
        Some(_) => relative_to_torque(finding.share),
        None => format!("up to {} of a joint", relative_to_torque(finding.share)),
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

/// That a known gap or spring between drive and link was not subtracted: it was not found, or not looked for because the cut-off
/// `is_low`.
pub fn not_subtracted(known: &Effect, is_low: bool) -> String {
    let what = format!("the known {} on {}", known.spec().title, known.joint().unwrap_or("the arm"));
    if is_low {
        format!(
            "{what} is not subtracted, because effects between drive and link are not looked for with a cut-off below {LEAST_FOR_DYNAMICS} Hz"
        )
    } else {
        format!("{what} is not found in these recordings. If it is there, the errors contain it")
    }
}

/// That a known effect was found with another size: the known value is outside the interval, and differs by more than [`ALIKE_SIZES`].
pub fn of_another_size(known: &Effect, found: &Finding) -> Option<String> {
    let key = *known.spec().main.first()?;
    let (stated, parameter) = (known.number(key), found.parameters.get(key)?);
    let [low, high] = parameter.ci95;
    let is_alike = (stated / parameter.value - 1.0).abs() < ALIKE_SIZES || (low..=high).contains(&stated);
    (!is_alike).then(|| {
        format!(
            "the known {} on {} has another size in these recordings: a {key} of {} {}, and not {}",
            known.spec().title,
            known.joint().unwrap_or("the arm"),
            number(parameter.value),
            parameter.unit,
            number(stated)
        )
    })
}

/// The experiment that shows which effect causes a residual that depends on `on`.
pub fn next_experiment(joint: &str, on: Option<&Dependence>) -> String {
    let other = on.and_then(|on| on.joint.as_deref()).unwrap_or("the other joint");
    match on.map(|on| on.on) {
        Some(Regressor::OtherJoint) => {
            format!("move {joint} alone with {other} at rest, then {other} alone with {joint} at rest")
        }
        Some(Regressor::OtherTorque) => format!(
            "move {other} while {joint} rests, with and without a known load: if the torque of {joint} differs from the model's by a constant \
             part of that of {other}, the channels are not separated, or the drives are coupled"
        ),
        Some(Regressor::OwnPosition) => format!(
            "sweep {joint} slowly over its whole range in both directions, with all other joints at rest, at two speeds"
        ),
        Some(Regressor::History) => format!(
            "repeat one motion of {joint} after pauses of different lengths and with reversals of different amplitudes"
        ),
        Some(Regressor::OwnPositionTimesSpeed) => {
            format!("sweep {joint} over its range at three constant speeds, in both directions")
        }
        Some(Regressor::Load) => format!(
            "repeat one motion of {joint} in several postures of the other joints, with and without a known load on the tool"
        ),
        Some(Regressor::Time) => format!("repeat one motion of {joint} every minute for ten minutes"),
        Some(Regressor::BaseMotion) => {
            "fix the base to stiff ground and repeat the motions, or measure the motion of the base".to_owned()
        }
        Some(Regressor::PositionScale) => {
            format!(
                "move {joint} by an angle or a distance that you measure, and compare it with the recorded positions"
            )
        }
        Some(Regressor::ToolPosition) => {
            "repeat the motions without hoses, cables, cords and balancers at the tool".to_owned()
        }
        Some(Regressor::ToolVelocity) => {
            "repeat the motions without hoses and flat parts at the tool, and at half the speed".to_owned()
        }
        Some(Regressor::OwnSpeed) | None => {
            format!("move {joint} alone at three constant speeds, in both directions, twice")
        }
    }
}

/// The experiment for a residual that lasts for a moment, the first time of which is `window`.
pub fn repeat_around(window: &TimeWindow) -> String {
    format!(
        "repeat the motion at {:.1} s of {}: a residual that does not return was an event, such as a knock or lost samples",
        window.start, window.recording
    )
}

/// The experiment for residuals of several joints that change with time.
pub const TOGETHER_IN_TIME: &str = "the residuals of several joints change with time, as with a load that changes or a base that moves: repeat \
    the motions without a load and with the base fixed, and then with the load; if they still change, repeat one motion every minute for ten \
    minutes";

/// The experiment for a residual that changes too quickly for the recordings, as where a link swings in a gap.
pub fn look_behind_the_drive(joint: &str) -> String {
    format!(
        "the residual of {joint} changes faster than the filtered recordings show: the link may swing in a gap or on a soft gear: record a second encoder on the link side, or move {joint} back and forth slowly at a constant load"
    )
}

/// The advice to diagnose again through a slower filter.
pub fn slower_filter(joints: &[&str], cutoff: f64, slower: f64) -> String {
    format!(
        "residuals of {} stay unexplained with a filter of {cutoff:.1} Hz. Impacts in a gear, which no model describes, would hide their \
         slower part: --cutoff {slower:.1} may show the cause; a name that is only found there is a supposition",
        joints.join(", ")
    )
}

/// The advice for a joint of which friction and drive inertia of any sign, in addition to the known effects, explain more than the catalogue.
pub fn without_known(joint: &str, error: f64, identified: f64) -> String {
    format!(
        "the known effects of {joint} may be larger than in these recordings: with friction and drive inertia that may be negative, the error \
         is {identified:.2}, and with effects of the catalogue {error:.2}; diagnose these recordings without the known effects of {joint}, and \
         compare the sizes"
    )
}

#[cfg(test)]
mod tests {
    use effects::sensor::TORQUE_SCALE;

    use super::*;

    #[test]
    fn the_same_change_on_several_joints_is_told_once() {
        let changed = |joint: &str, factor: f64| {
            let effect = Effect::of(&TORQUE_SCALE).on(joint).with("factor", factor);
            let parameter = Parameter { value: factor, ci95: [factor - 0.02, factor + 0.02], unit: "1" };
            Finding {
                change: Some(Change::Added),
                joint: Some(joint.to_owned()),
                parameters: [("factor", parameter)].into(),
                ..Finding::of(effect)
            }
        };
        let findings = [changed("d", 1.1), changed("b", 1.3), changed("a", 1.1), changed("c", 1.1)];
        let phrases = changes(findings.iter(), |joint| "abcd".find(joint));
        assert_eq!(phrases.len(), 2, "{phrases:?}");
        assert!(phrases[0].starts_with("a, c and d: a measured torque of 1.10 times"), "{phrases:?}");
        assert!(phrases[1].starts_with("b: a measured torque of 1.30 times"), "{phrases:?}");
    }
}
