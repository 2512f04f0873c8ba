//! The order of a bag's messages: a few that come late are used, and a clock that is set back is refused.

use std::collections::BTreeMap;

use crate::Warning;
use crate::table::Place;

/// A message that is earlier by more than this (ns) than one before it did not come late: the clock was set back.
const LATEST: i64 = 1_000_000_000;
/// Nor did so many messages of a joint one after the other, if more follow.
const MOST_LATE: u64 = 10;

/// A message, by its number in the bag.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Late {
    number: u64,
    /// Its time, and how much earlier it is than one before it (ns).
    time: i64,
    late: i64,
}

/// The latest time of a joint in a topic (ns): by the stamps of the messages, and by the times at which those without a stamp
/// were logged, which are another clock.
#[derive(Debug, Default)]
pub struct Latest([Option<i64>; 2], Option<(Late, u64)>);

impl Latest {
    /// Takes message `number` at `time` (ns): how late it is, if it is earlier than one before it.
    ///
    /// # Errors
    /// The message from which on the clock was set back.
    pub fn lateness(&mut self, (number, time): (u64, i64), is_stamped: bool) -> Result<Option<Late>, Late> {
        let latest = self.0[usize::from(is_stamped)].get_or_insert(time);
        let late = latest.saturating_sub(time);
        *latest = time.max(*latest);
        if late <= 0 {
            self.1 = None;
            return Ok(None);
        }
        let message = Late { number, time, late };
        let (first, count) = self.1.get_or_insert((message, 0));
        *count += 1;
        if late > LATEST {
            return Err(message);
        }
        if *count > MOST_LATE {
            return Err(*first);
        }
        Ok(Some(message))
    }
}

/// The late messages of each topic.
#[derive(Debug, Default)]
pub struct Order(BTreeMap<String, Counted>);

#[derive(Debug)]
struct Counted {
    messages: u64,
    /// The number of the first.
    first: u64,
    /// The largest lateness (ns).
    largest: i64,
}

impl Order {
    /// Counts a late message of `topic`.
    pub fn count(&mut self, Late { number, late, .. }: Late, topic: &str) {
        let counted = self.0.entry(topic.to_owned()).or_insert(Counted {
            messages: 0,
            first: number,
            largest: 0,
        });
        counted.messages += 1;
        counted.largest = late.max(counted.largest);
    }

    /// A warning about each topic with late messages.
    pub fn warnings(&self) -> Vec<Warning> {
        let warning = |(topic, late): (&String, &Counted)| Warning::OutOfOrder {
            topic: topic.clone(),
            line: Place::Row(late.first),
            messages: late.messages,
            largest: late.largest as f64 * 1e-9,
        };
        self.0.iter().map(warning).collect()
    }
}

/// The error that the clock of `topic` was set back before a message.
pub fn set_back(Late { number, time, late }: Late, topic: &str) -> String {
    format!(
        "message {number} of joint states, in {topic}: time runs back by {:.3} s, to {:.3} s, within the same joints: was the clock \
         set back, or is a message before it stamped too late? Cut the bag here or leave that message out, sort the messages by \
         time, or leave the topic out (`topics` in a column map)",
        late as f64 * 1e-9,
        time as f64 * 1e-9
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stamps_and_times_of_logging_are_two_clocks() {
        let mut latest = Latest::default();
        // Before a simulation begins, its messages have no stamp.
        let messages = [
            (5000, false),
            (10, true),
            (30, true),
            (20, true),
            (5100, false),
            (31, true),
        ];
        let late = messages.map(|(time, is_stamped)| {
            let late = latest.lateness((1, time), is_stamped).expect("it is late at most");
            late.map_or(0, |late| late.late)
        });
        assert_eq!(late, [0, 0, 0, 10, 0, 0]);
    }
}
