//! A drive that acts late.

use super::prelude::*;
use crate::part::LONGEST_DELAY;

pub(super) const FAULT: Fault = Fault {
    name: "actuation_delay",
    forms: &["first-order lag"],
    similar_faults: Some(SimilarFaults::BetweenCommandAndLink),
    draw: |bare, at, random| {
        let lags = at.hard && random.random_bool(0.3);
        let bare = if lags { bare.formed("first-order lag") } else { bare };
        let delays = if at.hard { 0.004..0.009 } else { 0.005..0.015 };
        bare.with("delay", random.random_range(delays))
    },
    read: |reader| {
        let (joint, delay) = (reader.joint()?, reader.at_least_zero("delay")?);
        if delay > LONGEST_DELAY {
            return Err(reader.fail(format!("its delay is above {LONGEST_DELAY} s")));
        }
        Ok(vec![Property::Delay(joint, delay, reader.form()? == 1).into()])
    },
    #[cfg(test)]
    example: |bare| bare.with("delay", 0.01),
    ..Fault::ON_A_JOINT
};
