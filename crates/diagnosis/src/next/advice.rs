//! What would tell where no motion does.

use effects::Spec;

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
    let specs = [finding, rival].map(effects::spec);
    let against = |spec: Option<&'static Spec>, other: &str| {
        let all = spec?.experiments_against;
        all.iter().find(|(name, _)| *name == other).map(|(_, text)| *text)
    };
    let of_two = against(specs[0], rival).or_else(|| against(specs[1], finding));
    let of_one = || {
        let experiments = specs.iter().flatten().filter_map(|spec| spec.experiment);
        experiments
            .max_by_key(|experiment| experiment.rank)
            .map(|experiment| experiment.text)
    };
    of_two
        .or_else(of_one)
        .unwrap_or("another sensor: a torque sensor or an encoder behind the gear, or a known load on the tool")
}
