//! Payloads that only have a mass.
//!
//! On some arms, the tool's origin is where the axes of the wrist meet. A body whose centre of mass is there has no torque on the last
//! joints. What remains is a mass at the wrist, which a heavier link before it represents as well.

use crate::search::study::Study;
use crate::selection::bootstrap::Resampled;
use crate::selection::judge::Judged;
use crate::thresholds::SYSTEMATIC;

/// A payload beside wrong links whose mass is certain and whose first moments about the tool's origin may all be zero, if the last joints do
/// not feel a mass there.
pub fn without_moment(study: &Study, judged: &Judged, resampled: &Resampled) -> Option<usize> {
    let may_be_zero = |column: usize| {
        let place = resampled.columns.iter().position(|&known| known == column);
        place.is_none_or(|place| {
            let (_, [low, high]) = resampled.interval_within(SYSTEMATIC, |draw| draw[place]);
            low <= 0.0 && high >= 0.0
        })
    };
    let is_without_moment = |&c: &usize| {
        let candidate = &study.candidates[c];
        let (mass, moments) = (candidate.columns[0], candidate.columns.get(1..4));
        study.is_payload(c)
            && study.always_acts(c)
            && !may_be_zero(mass)
            && !study.are_felt_at_the_end(&[mass], &[1.0])
            && moments.is_some_and(|moments| moments.iter().all(|&column| may_be_zero(column)))
    };
    let is_wrong = study.strengths.common() > 0.0;
    judged.named.set.iter().copied().find(|c| is_wrong && is_without_moment(c))
}
