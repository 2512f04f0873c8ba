//! What is said about the order of a bag's messages.

use std::collections::BTreeMap;

use crate::Warning;
use crate::location::Location;

/// A message that is earlier than one before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Late {
    /// Its number in the bag.
    number: u64,
    /// Its time, and how much earlier it is than one before it (ns).
    time: i64,
    late: i64,
}

impl Late {
    /// Message `number` at `time` (ns), after one at `latest`.
    pub fn new(number: u64, time: i64, latest: i64) -> Self {
        let late = latest.saturating_sub(time);
        Self { number, time, late }
    }
}

/// The late messages of each topic, and those with a wrong stamp.
#[derive(Debug, Default)]
pub struct Order {
    late: BTreeMap<String, Counted>,
    wrong: BTreeMap<String, (u64, u64)>,
}

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
        let counted = self.late.entry(topic.to_owned()).or_insert(Counted { messages: 0, first: number, largest: 0 });
        counted.messages += 1;
        counted.largest = late.max(counted.largest);
    }

    /// Counts messages of `topic` with a wrong stamp, of which the first has this number.
    pub fn count_wrong(&mut self, (first, messages): (u64, u64), topic: &str) {
        let (least, all) = self.wrong.entry(topic.to_owned()).or_insert((first, 0));
        *least = first.min(*least);
        *all += messages;
    }

    /// A warning about each topic with such messages.
    pub fn warnings(&self) -> Vec<Warning> {
        let late = |(topic, late): (&String, &Counted)| Warning::OutOfOrder {
            topic: topic.clone(),
            line: Location::Message(late.first),
            messages: late.messages,
            largest: late.largest as f64 * 1e-9,
        };
        let wrong = |(topic, (first, messages)): (&String, &(u64, u64))| Warning::WrongStamps {
            topic: topic.clone(),
            line: Location::Message(*first),
            messages: *messages,
        };
        let late = self.late.iter().map(late);
        late.chain(self.wrong.iter().map(wrong)).collect()
    }
}

/// The error that the clock of `topic` was set back before a message.
pub fn set_back(Late { number, time, late }: Late, topic: &str) -> String {
    format!(
        "message {number} of joint states, in {topic}: time runs back by {:.3} s, to {:.3} s, within the same joints, and goes on from \
         there: was the clock set back? Cut the bag here, sort the messages by time, or leave the topic out (`topics` in a column map)",
        late as f64 * 1e-9,
        time as f64 * 1e-9
    )
}

/// The error that time began again in other joint states than those of `topic`.
pub fn not_set_back(number: u64, topic: &str) -> String {
    format!(
        "message {number} of joint states, in {topic}: time began again in other joint states before, but not in these: were they \
         stamped by two clocks? Cut the bag there, or leave a topic out (`topics` in a column map)"
    )
}
