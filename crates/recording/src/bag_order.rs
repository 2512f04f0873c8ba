//! The order of a bag's messages: a few that come late are used, and a clock that is set back is refused.

use std::collections::BTreeMap;

use crate::Warning;
use crate::table::Place;

/// A message that is earlier by more than this (ns) than one before it did not come late: the clock was set back.
const LATEST: i64 = 1_000_000_000;

/// The latest time of a joint in a topic (ns): by the stamps of the messages, and by the times at which those without a stamp
/// were logged, which are another clock.
#[derive(Debug, Default)]
pub struct Latest([Option<i64>; 2]);

impl Latest {
    /// How much earlier than an earlier message of its clock one at `time` is (ns); 0 if it is not.
    pub fn lateness(&mut self, time: i64, is_stamped: bool) -> i64 {
        let latest = self.0[usize::from(is_stamped)].get_or_insert(time);
        let late = latest.saturating_sub(time);
        *latest = time.max(*latest);
        late.max(0)
    }
}

/// The late messages of each topic.
#[derive(Debug, Default)]
pub struct Order(BTreeMap<String, Late>);

#[derive(Debug)]
struct Late {
    messages: u64,
    /// The number of the first.
    first: u64,
    /// The largest lateness (ns).
    largest: i64,
}

impl Order {
    /// Counts message `number` of the bag at `time` (ns) in `topic`, which is `late` (ns).
    ///
    /// # Errors
    /// If it is so late that the clock was set back.
    pub fn count(&mut self, late: i64, (number, time): (u64, i64), topic: &str) -> Result<(), String> {
        if late == 0 {
            return Ok(());
        }
        if late > LATEST {
            return Err(format!(
                "message {number} of joint states, in {topic}: time runs back by {:.3} s, to {:.3} s, within the same joints: was the \
                 clock set back? Cut the bag before this message, sort its messages by time, or leave the topic out (`topics` in a \
                 column map)",
                late as f64 * 1e-9,
                time as f64 * 1e-9
            ));
        }
        let counted = self.0.entry(topic.to_owned()).or_insert(Late {
            messages: 0,
            first: number,
            largest: 0,
        });
        counted.messages += 1;
        counted.largest = late.max(counted.largest);
        Ok(())
    }

    /// A warning about each topic with late messages.
    pub fn warnings(&self) -> Vec<Warning> {
        let warning = |(topic, late): (&String, &Late)| Warning::OutOfOrder {
            topic: topic.clone(),
            line: Place::Row(late.first),
            messages: late.messages,
            largest: late.largest as f64 * 1e-9,
        };
        self.0.iter().map(warning).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stamps_and_times_of_logging_are_two_clocks() {
        let mut latest = Latest::default();
        // Before a simulation begins, its messages have no stamp.
        let late = [
            (5000, false),
            (10, true),
            (30, true),
            (20, true),
            (5100, false),
            (31, true),
        ];
        assert_eq!(
            late.map(|(time, is_stamped)| latest.lateness(time, is_stamped)),
            [0, 0, 0, 10, 0, 0]
        );
    }
}
