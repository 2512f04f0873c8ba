//! The table that the messages `sensor_msgs/msg/JointState` of a bag make.

use std::collections::BTreeMap;

use crate::RecordingError;
use crate::Warning;
use crate::bag_course::{Course, Sample, Taken};
use crate::bag_order::{Order, not_set_back, set_back};
use crate::bag_windows::BagWindows;
use crate::cdr::{FIELDS, decode};
use crate::input::Input;
use crate::location::Location;
use crate::series::{Series, at};
use crate::table::{Column, Table};
use crate::warning::RUN_PAUSE;

/// The type's names: of ROS 2, and of an older form.
pub const TYPES: [&str; 2] = ["sensor_msgs/msg/JointState", "sensor_msgs/JointState"];
/// A topic is joined with another one if it covers this share of its time.
const COVERED: f64 = 0.9;

/// The joint states of a bag, by topic and joint.
#[derive(Debug, Default)]
pub struct JointStates {
    topics: BTreeMap<String, Vec<Joint>>,
    messages: u64,
    order: Order,
    /// The runs after the first one.
    runs: Vec<Run>,
    restarts: Vec<Warning>,
    /// The windows that are kept, if not everything is.
    windows: Option<BagWindows>,
}

#[derive(Debug)]
struct Joint {
    name: String,
    /// The two clocks of its messages: first that of the logger, for messages without a stamp, then that of the stamps.
    clocks: [Clock; 2],
}

#[derive(Debug, Default)]
struct Clock {
    course: Course,
    /// The number of the run.
    run: usize,
    fields: [Series; 3],
}

/// A joint whose values are all there.
#[derive(Debug)]
struct Read {
    name: String,
    fields: [Series; 3],
}

/// A run that begins when time begins again.
#[derive(Debug)]
struct Run {
    /// What is added to its stamps (ns).
    shift: i64,
    /// Its first time, with the shift (ns).
    start: i64,
}

impl Clock {
    /// Removes the last samples as far as they have one of these times, to which `shift` was added.
    fn remove(&mut self, times: &[i64], shift: i64) {
        for series in &mut self.fields {
            while series.last().is_some_and(|(time, _)| times.contains(&(time - shift))) {
                series.pop();
            }
        }
    }
}

/// What is added to the stamps of a run (ns).
fn shift(runs: &[Run], run: usize) -> i64 {
    run.checked_sub(1).map_or(0, |before| runs[before].shift)
}

impl JointStates {
    /// An empty collection of messages. Of bags that last longer than `seconds` (s), it keeps windows of that duration together.
    pub fn new(seconds: Option<f64>) -> Self {
        Self { windows: seconds.map(BagWindows::new), ..Self::default() }
    }

    /// The number of messages so far.
    pub fn messages(&self) -> u64 {
        self.messages
    }

    /// The next messages are in another file of the bag.
    pub fn begin_file(&mut self) {
        let joints = self.topics.values_mut().flatten();
        joints.flat_map(|joint| &mut joint.clocks).for_each(|clock| clock.course.begin_file());
    }

    /// Takes a message of `topic` that was logged at `logged` (ns).
    ///
    /// # Errors
    /// The reason why it is not a joint state, or cannot be put in the order of time.
    pub fn add(&mut self, topic: &str, logged: i64, data: &[u8]) -> Result<(), String> {
        self.messages += 1;
        let number = self.messages;
        let message =
            decode(data).map_err(|reason| format!("message {number} of joint states, in {topic}: {reason}"))?;
        let is_stamped = usize::from(message.stamp != 0);
        let time = if message.stamp == 0 { logged } else { message.stamp };
        if !self.topics.contains_key(topic) {
            self.topics.insert(topic.to_owned(), Vec::new());
        }
        let Some(joints) = self.topics.get_mut(topic) else {
            return Ok(());
        };
        let (mut late, mut wrong) = (None, None);
        let mut used: Vec<(usize, Sample)> = Vec::with_capacity(message.names.len());
        let mut restarted = Vec::new();
        for (index, name) in message.names.iter().enumerate() {
            let known = place(joints, (index, name));
            let values = message.fields.each_ref().map(|values| values.get(index).copied());
            let sample = Sample { number, time, values };
            let clock = &mut joints[known].clocks[is_stamped];
            if clock.course.latest().is_none() {
                clock.run = self.runs.len();
            }
            match clock.course.take(sample).map_err(|first| set_back(first, topic))? {
                Taken::Used(lateness) => {
                    late = late.max(lateness);
                    used.push((known, sample));
                }
                Taken::HeldBack => {}
                Taken::Decided(decided) => {
                    late = late.max(decided.late);
                    wrong = wrong.max(decided.wrong.map(|(first, count)| (count, first)));
                    clock.remove(&decided.removed, shift(&self.runs, clock.run));
                    restarted.extend(decided.restarts_after.map(|before| (known, before, decided.used[0])));
                    used.extend(decided.used.into_iter().map(|sample| (known, sample)));
                }
            }
        }
        if let Some(late) = late {
            self.order.count(late, topic);
        }
        if let Some((count, first)) = wrong {
            self.order.count_wrong((first, count), topic);
        }
        for (known, before, first) in restarted {
            self.restart(topic, (known, is_stamped), before, first);
        }
        self.keep(topic, is_stamped, &used)
    }

    /// Begins another run of a joint, after the time `before`, with its sample `first`.
    fn restart(&mut self, topic: &str, (joint, is_stamped): (usize, usize), before: i64, first: Sample) {
        let clocks = self.topics.values().flatten().map(|joint| &joint.clocks[is_stamped]);
        let end = |clock: &Clock| Some(clock.course.latest()?.saturating_add(shift(&self.runs, clock.run)));
        let latest = clocks.filter_map(end).max();
        let Some(joints) = self.topics.get_mut(topic) else {
            return;
        };
        let run = &mut joints[joint].clocks[is_stamped].run;
        if *run == self.runs.len() {
            let latest = latest.max(Some(before.saturating_add(shift(&self.runs, *run))));
            let start = latest.unwrap_or(before).saturating_add((RUN_PAUSE * 1e9) as i64);
            let shift = start.saturating_sub(first.time);
            self.runs.push(Run { shift, start });
            self.restarts.push(Warning::ClockRestart {
                line: Location::Message(first.number),
                before: before as f64 / 1e9,
                after: first.time as f64 / 1e9,
                placed: start as f64 / 1e9,
            });
        }
        *run = self.runs.len();
    }

    /// Keeps the samples of joints that lie in the windows.
    fn keep(&mut self, topic: &str, is_stamped: usize, used: &[(usize, Sample)]) -> Result<(), String> {
        // Samples of one time share the answer of the windows.
        let mut wanted = None;
        for (joint, sample) in used {
            let Some(joints) = self.topics.get_mut(topic) else {
                return Ok(());
            };
            let run = joints[*joint].clocks[is_stamped].run;
            let time = sample.time.saturating_add(shift(&self.runs, run));
            if is_stamped == 1 && self.runs.get(run).is_some_and(|next| time >= next.start) {
                return Err(not_set_back(sample.number, topic));
            }
            if let Some(windows) = self.windows.as_mut().filter(|_| wanted.is_none_or(|(at, _)| at != time)) {
                let topics = &mut self.topics;
                let give_up = |windows: &BagWindows| {
                    let clocks = topics.values_mut().flatten().flat_map(|joint| &mut joint.clocks);
                    for series in clocks.flat_map(|clock| &mut clock.fields) {
                        series.retain(|(time, _)| windows.takes(*time));
                    }
                };
                wanted = Some((time, windows.wants(time, give_up)));
            }
            if let Some((_, false)) = wanted {
                continue;
            }
            let Some(joints) = self.topics.get_mut(topic) else {
                return Ok(());
            };
            let fields = &mut joints[*joint].clocks[is_stamped].fields;
            for (series, value) in fields.iter_mut().zip(sample.values) {
                series.extend(value.map(|value| (time, value)));
            }
        }
        Ok(())
    }

    /// The joints of each topic with their values in order of time: of messages with a stamp or without one, whichever are more.
    fn read(&mut self) -> BTreeMap<String, Vec<Read>> {
        let mut read = BTreeMap::new();
        for (topic, joints) in std::mem::take(&mut self.topics) {
            let (mut wrong, mut unused) = (None, (0, 0));
            let mut of_topic = Vec::new();
            for Joint { name, mut clocks } in joints {
                for clock in &mut clocks {
                    let decided = clock.course.finish();
                    clock.remove(&decided.removed, shift(&self.runs, clock.run));
                    wrong = wrong.max(decided.wrong.map(|(first, count)| (count, first)));
                }
                let [unstamped, stamped] = clocks;
                let counts = [unstamped.course.messages, stamped.course.messages];
                let (fields, other) = match counts[1] >= counts[0] {
                    true => (stamped.fields, (counts[0], 0)),
                    false => (unstamped.fields, (counts[1], 1)),
                };
                unused = other.max(unused);
                of_topic.push(Read { name, fields });
            }
            for series in of_topic.iter_mut().flat_map(|joint| &mut joint.fields) {
                series.sort_by_key(|(time, _)| *time);
            }
            if let Some((count, first)) = wrong {
                self.order.count_wrong((first, count), &topic);
            }
            if let (messages @ 1.., which) = unused {
                let (with, those) =
                    [("without a stamp, or with the stamp 0,", "a stamp"), ("with a stamp", "none")][which];
                let what = match messages {
                    1 => format!("{topic}: 1 message {with} was left out, because most have {those}"),
                    _ => format!("{topic}: {messages} messages {with} were left out, because most have {those}"),
                };
                self.restarts.push(Warning::LeftOut { what });
            }
            read.insert(topic, of_topic);
        }
        read
    }

    /// The table of all joint states, with the columns `<topic>/<joint>/position` and so on, at the stamps of the
    /// joint with the most values. `chosen` topics are always joined, others if they add something.
    ///
    /// # Errors
    /// [`RecordingError::Format`] if there are none.
    pub fn into_table(
        mut self,
        input: &Input,
        format: &'static str,
        chosen: &[String],
    ) -> Result<Table, RecordingError> {
        let topics = self.read();
        let samples = |(_, joints): &(&String, &Vec<Read>)| {
            let count = joints.iter().map(|joint| joint.fields[0].len()).max();
            // The first of equal ones.
            (count.unwrap_or(0), std::cmp::Reverse(joints.len()))
        };
        let base = topics.iter().rev().max_by_key(samples);
        let base = base.map(|(topic, joints)| (topic.clone(), joints.iter().max_by_key(|joint| joint.fields[0].len())));
        let Some((base, Some(most))) = base.filter(|(_, joint)| joint.is_some_and(|joint| !joint.fields[0].is_empty()))
        else {
            return Err(input.error(format, "its joint states have no positions; record a topic that has them"));
        };
        let times: Vec<i64> = most.fields[0].iter().map(|(time, _)| *time).collect();
        let mut columns: Vec<(String, Vec<f64>)> = Vec::new();
        let mut warnings = self.order.warnings();
        warnings.append(&mut self.restarts);
        let mut keeps = vec![true; times.len()];
        for (topic, joints) in &topics {
            if *topic != base && !chosen.contains(topic) && adds_nothing(joints, &topics[&base]) {
                let what = format!("topic {topic} was left out: it adds nothing to {base}");
                warnings.push(Warning::LeftOut { what });
                continue;
            }
            for joint in joints {
                join(topic, joint, &times, &mut columns, &mut keeps, &mut warnings);
            }
        }
        let kept = |values: Vec<f64>| -> Vec<f64> {
            let kept = values.into_iter().zip(&keeps).filter(|(_, keeps)| **keeps);
            kept.map(|(value, _)| value).collect()
        };
        let stamps = times.iter().zip(&keeps).filter(|(_, keeps)| **keeps);
        let stamps: Vec<i64> = stamps.map(|(time, _)| *time).collect();
        let begins = |run: &Run| stamps.partition_point(|time| *time < run.start);
        let breaks: Vec<usize> = self.runs.iter().map(begins).collect();
        let stamps = Column::Nanos(stamps);
        let columns = columns.into_iter().map(|(name, values)| (name, Column::Numbers(kept(values))));
        let mut table = Table::of_columns(std::iter::once(("__time".to_owned(), stamps)).chain(columns).collect());
        table.warnings = warnings;
        table.breaks = breaks;
        table.left_out = self.windows.as_ref().map_or(0.0, BagWindows::left_out);
        Ok(table)
    }
}

/// The place in `joints` of the joint that has this index and name in a message; it is added if it is new.
fn place(joints: &mut Vec<Joint>, (index, name): (usize, &&str)) -> usize {
    // The order of the joints rarely changes.
    let known = match joints.get(index) {
        Some(joint) if joint.name == *name => Some(index),
        _ => joints.iter().position(|joint| joint.name == *name),
    };
    known.unwrap_or_else(|| {
        joints.push(Joint { name: (*name).to_owned(), clocks: Default::default() });
        joints.len() - 1
    })
}

/// Whether the base topic has positions and efforts of all `joints`, each of which lacks one or the other.
fn adds_nothing(joints: &[Read], base: &[Read]) -> bool {
    let has = |joint: &Read| !joint.fields[0].is_empty() && !joint.fields[2].is_empty();
    let in_base = |name: &str| base.iter().any(|joint| joint.name == name && has(joint));
    joints.iter().all(|joint| in_base(&joint.name) && !has(joint))
}

/// Adds the columns of a joint at `times`; rows without values are removed.
fn join(
    topic: &str,
    joint: &Read,
    times: &[i64],
    columns: &mut Vec<(String, Vec<f64>)>,
    keeps: &mut [bool],
    warnings: &mut Vec<Warning>,
) {
    let (mut interpolated, mut left_out) = (0, 0);
    for (field, series) in FIELDS.iter().zip(&joint.fields) {
        if series.is_empty() {
            continue;
        }
        let name = format!("{topic}/{}/{field}", joint.name);
        if series.len() == times.len() && series.iter().zip(times).all(|((a, _), b)| a == b) {
            columns.push((name, series.iter().map(|(_, value)| *value).collect()));
            continue;
        }
        let (values, between) = at(series, times);
        let found = values.iter().filter(|value| value.is_some()).count();
        if (found as f64) < COVERED * times.len() as f64 {
            let what = format!("{name} was left out: it has values in {found} of {} rows only", times.len());
            warnings.push(Warning::LeftOut { what });
            continue;
        }
        for (keep, value) in keeps.iter_mut().zip(&values) {
            *keep &= value.is_some();
        }
        (interpolated, left_out) = (between.max(interpolated), left_out.max(times.len() - found));
        columns.push((name, values.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect()));
    }
    if interpolated + left_out > 0 {
        warnings.push(Warning::Joined { what: format!("{} in {topic}", joint.name), interpolated, left_out });
    }
}
