//! The course of a joint's time in a bag: a few messages that come late are used, a few with a stamp far from all others are left
//! out, a simulation that starts again begins another run, and a clock that is set back is refused.
//!
//! Only the following messages show which of two times is wrong. Messages far behind the one before are therefore held back, and
//! messages far ahead of it are doubted, until there are more of them than a few.

use crate::bag_order::Late;
use crate::series::Values;

const SECOND: i64 = 1_000_000_000;
/// The largest delay of a message that comes late (ns). A larger step back is a wrong stamp or a clock that was set back. After a
/// step ahead of more than this, either the messages before it or those after it may be right.
const LATEST: i64 = SECOND;
/// The largest number of consecutive messages of a joint that come late or have a wrong stamp.
const FEW: usize = 10;
/// A step in time that is longer than any pause of a bag (ns). Of the messages on its two sides, the fewer have wrong stamps.
const FAR: i64 = 86_400 * SECOND;
/// The smallest number of messages of a run.
const RUN_MESSAGES: usize = 50;
/// How far from the first time of a run another one may begin, as a share of its duration.
const RESTART_SHARE: f64 = 0.01;

/// The values of a joint in a message.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// The number of the message in the bag.
    pub number: u64,
    /// Its time (ns).
    pub time: i64,
    /// Position, velocity and effort.
    pub values: Values,
}

/// What becomes of a sample.
#[derive(Debug, PartialEq)]
pub enum Taken {
    /// It is used; how late it is, if it is.
    Used(Option<Late>),
    /// The following samples decide whether it is used.
    HeldBack,
    /// More than this sample is decided.
    Decided(Box<Decided>),
}

/// What is decided about several samples.
#[derive(Debug, Default, PartialEq)]
pub struct Decided {
    /// The times of samples that were used and have a wrong stamp. They are the last ones that were used.
    pub removed: Vec<i64>,
    /// The messages with a wrong stamp: the number of the first, and how many there are.
    pub wrong: Option<(u64, u64)>,
    /// The samples that are used, in order.
    pub used: Vec<Sample>,
    /// How late the last of them is.
    pub late: Option<Late>,
    /// The last time before the run that begins with these samples.
    pub restarts_after: Option<i64>,
}

/// Samples after a step ahead, or at a beginning, as long as there are few.
#[derive(Debug)]
struct Doubted {
    /// The latest time before the step; none at a beginning.
    before: Option<i64>,
    /// The number of the first message, and all times.
    number: u64,
    times: Vec<i64>,
}

/// The course of time of one joint in one topic.
#[derive(Debug, Default)]
pub struct Course {
    /// The number of messages that are used, in all and in this run.
    pub messages: usize,
    in_run: usize,
    /// The latest time; of this stretch.
    latest: Option<i64>,
    /// The first time of this stretch, and the first and the last one of each other stretch of the run. A bag's file is a
    /// stretch, because files may be read in another order.
    start: i64,
    stretches: Vec<(i64, i64)>,
    /// The beginning of the stretch that follows this one.
    ceiling: Option<i64>,
    is_new_file: bool,
    /// The first of the messages that came late one after the other, and their number.
    late: Option<(Late, usize)>,
    doubted: Option<Doubted>,
    held_back: Vec<Sample>,
}

impl Course {
    /// The next messages are in another file of the bag.
    pub fn begin_file(&mut self) {
        self.is_new_file = true;
    }

    /// The latest time of this run.
    pub fn latest(&self) -> Option<i64> {
        let others = self.stretches.iter().map(|(_, end)| *end);
        others.chain(self.latest).max()
    }

    /// The first time of this run.
    fn first(&self) -> i64 {
        let others = self.stretches.iter().map(|(start, _)| *start);
        others.fold(self.start, i64::min)
    }

    /// Takes the next sample.
    ///
    /// # Errors
    /// The message from which on the clock was set back.
    pub fn take(&mut self, sample: Sample) -> Result<Taken, Late> {
        let Sample { number, time, .. } = sample;
        let Some(latest) = self.latest else {
            self.begin(sample);
            return Ok(Taken::Used(None));
        };
        if std::mem::take(&mut self.is_new_file) && self.held_back.is_empty() {
            let mut decided = self.give_up_far();
            let latest = self.latest.unwrap_or(latest);
            if !self.is_within(time) {
                self.stretches.push((self.start, latest));
                self.begin(sample);
                if decided.wrong.is_none() {
                    return Ok(Taken::Used(None));
                }
                decided.used.push(sample);
                return Ok(Taken::Decided(Box::new(decided)));
            }
            if decided.wrong.is_some() {
                return Err(Late::new(number, time, latest));
            }
        }
        let is_beyond = self.ceiling.is_some_and(|ceiling| time - ceiling > LATEST);
        let goes_on_early = !self.held_back.is_empty() && time < latest;
        if latest.saturating_sub(time) > LATEST || is_beyond || goes_on_early {
            return self.take_early(sample, latest);
        }
        let is_start = |doubted: &Doubted| doubted.before.is_none();
        let step = time.saturating_sub(latest);
        if step > FAR && self.doubted.as_ref().is_some_and(is_start) {
            // The few messages of the beginning are a day or more before all others.
            let mut decided = self.give_up_doubted();
            self.begin(sample);
            decided.used.push(sample);
            return Ok(Taken::Decided(Box::new(decided)));
        }
        let mut decided = Decided::default();
        decided.count(&self.held_back);
        self.held_back.clear();
        decided.late = self.lateness(sample, latest)?;
        if step > LATEST && self.doubted.as_ref().is_none_or(is_start) {
            self.doubt(Some(latest), number);
        }
        self.use_at(time);
        if decided.wrong.is_none() {
            return Ok(Taken::Used(decided.late));
        }
        decided.used.push(sample);
        Ok(Taken::Decided(Box::new(decided)))
    }

    /// Takes a sample far before the one before it.
    fn take_early(&mut self, sample: Sample, latest: i64) -> Result<Taken, Late> {
        let before = self.doubted.as_ref().and_then(|doubted| doubted.before);
        if let Some(before) = before.filter(|before| before.saturating_sub(sample.time) <= LATEST) {
            // It goes on where the step ahead was.
            let mut decided = self.give_up_doubted();
            decided.count(&self.held_back);
            self.held_back.clear();
            self.latest = Some(before);
            decided.late = self.lateness(sample, before)?;
            if sample.time.saturating_sub(before) > LATEST {
                self.doubt(Some(before), sample.number);
            }
            self.use_at(sample.time);
            decided.used.push(sample);
            return Ok(Taken::Decided(Box::new(decided)));
        }
        self.held_back.push(sample);
        if self.held_back.len() <= FEW {
            return Ok(Taken::HeldBack);
        }
        let used = std::mem::take(&mut self.held_back);
        let first = used[0];
        let mut decided = Decided::default();
        if self.doubted.as_ref().is_some_and(|doubted| doubted.before.is_none()) {
            decided = self.give_up_doubted();
        } else if self.may_restart(first.time) {
            decided.restarts_after = self.latest();
            self.stretches.clear();
            self.in_run = 0;
        } else {
            return Err(Late::new(first.number, first.time, self.latest().unwrap_or(latest)));
        }
        self.begin(first);
        for sample in &used[1..] {
            self.use_at(sample.time);
        }
        decided.used = used;
        Ok(Taken::Decided(Box::new(decided)))
    }

    /// What is left at the end: samples that were held back, or that are alone far ahead.
    pub fn finish(&mut self) -> Decided {
        let mut decided = self.give_up_far();
        decided.count(&self.held_back);
        self.held_back.clear();
        decided
    }

    /// Gives up the last samples if they are alone far ahead, at the end of a file or of the bag.
    fn give_up_far(&mut self) -> Decided {
        let Some(doubted) = &self.doubted else {
            return Decided::default();
        };
        let Some(before) = doubted.before else {
            return Decided::default();
        };
        if !doubted.times.iter().all(|time| time.saturating_sub(before) > FAR) {
            return Decided::default();
        }
        self.latest = Some(before);
        self.give_up_doubted()
    }

    /// Begins a stretch.
    fn begin(&mut self, Sample { number, time, .. }: Sample) {
        self.start = time;
        self.latest = Some(time);
        self.late = None;
        let later = self.stretches.iter().map(|(start, _)| *start);
        self.ceiling = later.filter(|start| *start > time).min();
        self.doubt(None, number);
        self.use_at(time);
    }

    fn doubt(&mut self, before: Option<i64>, number: u64) {
        let times = Vec::new();
        self.doubted = Some(Doubted { before, number, times });
    }

    /// Counts a sample that is used.
    fn use_at(&mut self, time: i64) {
        self.messages += 1;
        self.in_run += 1;
        self.latest = self.latest.max(Some(time));
        if let Some(doubted) = &mut self.doubted {
            doubted.times.push(time);
            if doubted.times.len() > FEW {
                self.doubted = None;
            }
        }
    }

    fn give_up_doubted(&mut self) -> Decided {
        let Some(doubted) = self.doubted.take() else {
            return Decided::default();
        };
        self.messages -= doubted.times.len();
        self.in_run -= doubted.times.len();
        Decided {
            wrong: Some((doubted.number, doubted.times.len() as u64)),
            removed: doubted.times,
            ..Decided::default()
        }
    }

    /// How late a sample is, if it is late.
    ///
    /// # Errors
    /// The first of too many one after the other.
    fn lateness(&mut self, Sample { number, time, .. }: Sample, latest: i64) -> Result<Option<Late>, Late> {
        if time >= latest {
            self.late = None;
            return Ok(None);
        }
        let message = Late::new(number, time, latest);
        let (first, count) = self.late.get_or_insert((message, 0));
        *count += 1;
        if *count > FEW { Err(*first) } else { Ok(Some(message)) }
    }

    /// Whether a time lies within a stretch of this run, or so shortly before one that the stretch would be run into.
    fn is_within(&self, time: i64) -> bool {
        let own = self.latest.map(|latest| (self.start, latest));
        let mut all = self.stretches.iter().copied().chain(own);
        all.any(|(start, end)| start.saturating_sub(time) <= LATEST && end.saturating_sub(time) > LATEST)
    }

    /// Whether a run may begin at a time: that of the first of this run, or before it.
    fn may_restart(&self, time: i64) -> bool {
        let first = self.first();
        let duration = self.latest().map_or(0, |latest| latest.saturating_sub(first));
        self.in_run >= RUN_MESSAGES && time.saturating_sub(first) as f64 <= RESTART_SHARE * duration as f64
    }
}

impl Decided {
    /// Counts samples with a wrong stamp.
    fn count(&mut self, samples: &[Sample]) {
        if let Some(first) = samples.first() {
            let (_, count) = self.wrong.get_or_insert((first.number, 0));
            *count += samples.len() as u64;
        }
    }
}

#[cfg(test)]
#[path = "bag_course_tests.rs"]
mod tests;
