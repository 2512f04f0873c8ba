//! What would tell where no motion does.

use super::report::{Left, Untold};
use crate::findings::report::Confusable;

/// Less than this (nats), or than this part of what tells, is nothing: the two are one torque.
const ALIAS: (f64, f64) = (1.0, 0.1);

/// The confusion of `finding` with `rival`, which the best motion for it sets `best` apart (nats), where `needed` would tell.
/// `sure` is the distance from which it is promised, unless it is `barred` for a reason.
pub fn untold(
    finding: Confusable,
    rival: Confusable,
    [best, needed]: [f64; 2],
    sure: f64,
    barred: Option<Left>,
) -> Untold {
    let kind = if best.abs() < ALIAS.0.max(ALIAS.1 * needed) {
        Left::SameTorque
    } else if let Some(reason) = barred {
        reason
    } else if best < sure {
        Left::OutOfReach
    } else {
        Left::AnotherMotion
    };
    let because = match kind {
        Left::SameTorque => "the two are the same torque in every motion tried".to_owned(),
        Left::OutOfReach => format!(
            "no motion tried within the limits sets them further apart than {:.1} nats, and {sure:.1} would be sure to tell",
            best.max(0.0)
        ),
        Left::Unexplained => {
            "something without a name is left there, so that what a motion would tell cannot be foretold".to_owned()
        }
        Left::NotForetold => {
            "by this prediction the recordings tell the two apart already, and they do not: what a motion would tell cannot be foretold"
                .to_owned()
        }
        Left::AnotherMotion => {
            "another motion would tell, but this one serves the others better: propose again after it".to_owned()
        }
    };
    let instead = match kind {
        Left::AnotherMotion => "run the motion, diagnose with its recording, and propose again",
        Left::Unexplained => "find first what is unexplained there",
        _ => instead(finding.effect, rival.effect),
    };
    let instead = instead.to_owned();
    Untold {
        finding,
        rival,
        best,
        needed,
        kind,
        because,
        instead,
    }
}

/// The experiment that tells two effects apart which no motion does.
fn instead(finding: &str, rival: &str) -> &'static str {
    let is = |a: &str, b: &str| (finding == a && rival == b) || (finding == b && rival == a);
    let has = |a: &str| finding == a || rival == a;
    if has("friction_asymmetry") && (has("torque_offset") || has("spring")) {
        return "read the drive's torque with its brake closed and no current: an offset of the reading stays, friction does not";
    }
    if is("inertial_scale", "torque_scale") || (has("torque_scale") && has("link_inertial_error")) {
        return "put a body of known mass on the tool and record the same motion: a wrong scale of the torque changes its weight, \
                wrong masses of the links do not";
    }
    if has("payload") {
        return "take off what the tool carries and record the same motion: what is left is not a payload";
    }
    if has("rotor_inertia") {
        return "put a body of known inertia on the tool: a drive's inertia does not change with the pose and the load, a link's does; \
                or take the drive's from its data sheet (--known)";
    }
    if has("gravity_misalignment") {
        return "put a level on the base: what is left then is not a tilt";
    }
    if has("encoder_offset") {
        return "drive the joint to a mechanical reference, or measure its angle: an encoder's offset shows there";
    }
    if has("torque_offset") || has("torque_scale") {
        return "read the torque under a known load at rest, once on either side of upright: offset and scale show there";
    }
    if has("backlash") || has("joint_elasticity") || has("actuation_delay") {
        return "record a second encoder behind the gear: it sees a gap or a spring, and no delay";
    }
    if has("thermal_drift") {
        return "record the same motion on the cold and on the warm drive, on one clock";
    }
    if has("external_contact") {
        return "record the same motion again with nothing in the arm's way";
    }
    "another sensor: a torque sensor or an encoder behind the gear, or a known load on the tool"
}
