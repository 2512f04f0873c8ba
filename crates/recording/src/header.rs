//! The meaning of a file's columns: by their names, or by a column map.

use crate::{Quantity, nearest};

/// One column of one joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// The column, from 0.
    pub index: usize,
    /// The column's header.
    pub header: String,
    /// The quantity in the column.
    pub quantity: Quantity,
    /// The index of the joint, from 0.
    pub joint: usize,
    /// The value in SI is factor × cell + offset.
    pub factor: f64,
    /// See `factor`.
    pub offset: f64,
}

/// The columns of the time.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeColumn {
    /// The column of the time stamps, from 0.
    pub index: usize,
    /// Its header.
    pub header: String,
    /// Seconds in the stamps' unit.
    pub factor: f64,
    /// The column of nanoseconds to add, if the stamps are whole seconds, and its header.
    pub nanos: Option<(usize, String)>,
    /// The column that numbers the runs of a file, if there is one, and its header.
    pub run: Option<(usize, String)>,
}

impl TimeColumn {
    /// A column of stamps in s.
    pub fn plain(index: usize, headers: &[String]) -> Self {
        Self { index, header: headers[index].clone(), factor: 1.0, nanos: None, run: None }
    }

    /// The indices of these columns.
    pub fn indices(&self) -> impl Iterator<Item = usize> + '_ {
        let more = self.nanos.iter().chain(&self.run).map(|(index, _)| *index);
        std::iter::once(self.index).chain(more)
    }
}

/// The plan of the columns to read.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The joints' names, in order.
    pub joints: Vec<String>,
    /// The columns of the time.
    pub time: TimeColumn,
    /// The joints' columns.
    pub channels: Vec<Channel>,
    /// The other columns, from 0, with their headers.
    pub others: Vec<(usize, String)>,
    /// The columns whose cells are the names of joints, from 0, with the expected names.
    pub names: Vec<(usize, String)>,
}

impl Plan {
    /// Makes all unused columns the other columns of the plan.
    pub fn new(headers: &[String], joints: Vec<String>, time: TimeColumn, channels: Vec<Channel>) -> Self {
        let used: Vec<usize> = time.indices().chain(channels.iter().map(|channel| channel.index)).collect();
        let others = (0..headers.len())
            .filter(|index| !used.contains(index))
            .map(|index| (index, headers[index].clone()))
            .collect();
        Self { joints, time, channels, others, names: Vec::new() }
    }
}

/// The reason why headers that are numbers are refused.
pub fn numbers(headers: &[String]) -> Option<String> {
    let is_number = |header: &String| header.replacen(',', ".", 1).parse::<f64>().is_ok();
    let numbers = headers.iter().filter(|header| is_number(header)).count();
    (numbers > 0 && 2 * numbers > headers.len()).then(|| {
        format!(
            "the first line holds numbers (\"{}\", ...), not the columns' names; put a header above it: t, q_<joint>, \
             tau_<joint>, ...",
            headers[0].chars().take(20).collect::<String>()
        )
    })
}

/// The first used header that occurs twice.
pub fn doubled<'a>(headers: &'a [String], plan: &Plan) -> Option<&'a str> {
    let used = plan.time.indices().chain(plan.channels.iter().map(|channel| channel.index));
    used.map(|index| headers[index].as_str()).find(|used| headers.iter().filter(|header| header == used).count() > 1)
}

/// That a column is there twice, before the message that another one is missing.
pub fn twice(headers: &[String]) -> String {
    let is_twice = |header: &&String| !header.is_empty() && headers.iter().filter(|other| other == header).count() > 1;
    let doubled = headers.iter().find(is_twice);
    doubled.map_or_else(String::new, |header| format!("column \"{header}\" is there twice (rename one), and "))
}

/// The plan for headers with testbed's own names; the error contains what is missing.
pub fn plan_by_names(headers: &[String]) -> Result<Plan, String> {
    let at = |name: &str| headers.iter().position(|header| header == name);
    let remedy = "name the columns so, or give a column map (--map)";
    let time = match at("t") {
        Some(index) => TimeColumn::plain(index, headers),
        None => seconds_and_nanos(headers).ok_or_else(|| {
            let is_time = |header: &&String| ["time", "stamp"].iter().any(|word| header.to_lowercase().contains(word));
            let hint = headers.iter().find(is_time).map_or(String::new(), |header| format!("is \"{header}\" meant? "));
            format!("there is no column \"t\" (time in s); {hint}{remedy}")
        })?,
    };
    let of = |prefix: &'static str| headers.iter().filter_map(move |header| header.strip_prefix(prefix));
    let joints: Vec<String> = of("q_").filter(|name| at(&format!("tau_{name}")).is_some()).map(str::to_owned).collect();
    if of("q_").next().is_none() {
        return Err(format!("there is no column \"q_<joint>\" (position in rad or m); {remedy}"));
    }
    if of("tau_").next().is_none() {
        return Err(format!("there is no column \"tau_<joint>\" (torque in N m, or force in N); {remedy}"));
    }
    // An additional quantity of a joint with positions: q_secondary_a, q_desired_a, tau_current_a.
    let more = |name: &str| {
        joints.iter().any(|joint| name.strip_suffix(joint.as_str()).is_some_and(|word| word.ends_with('_')))
    };
    for (prefix, partner) in [("q_", "tau_"), ("tau_", "q_")] {
        for name in of(prefix).filter(|name| !more(name)) {
            if at(&format!("{partner}{name}")).is_none() {
                let there: Vec<String> = of(partner).map(str::to_owned).collect();
                let hint = match nearest(name, &there) {
                    Some(other) if !joints.iter().any(|joint| joint == other) => {
                        format!("is \"{partner}{other}\" meant? ")
                    }
                    _ => String::new(),
                };
                return Err(format!(
                    "there is no column \"{partner}{name}\" beside \"{prefix}{name}\"; {hint}every joint needs both: add \
                     the one or take out the other"
                ));
            }
        }
    }
    let mut channels = Vec::new();
    let quantities = [
        (Quantity::Position, true),
        (Quantity::Velocity, true),
        (Quantity::Acceleration, true),
        (Quantity::Torque, true),
        (Quantity::SecondaryPosition, false),
        (Quantity::CurrentTorque, false),
        (Quantity::Current, false),
        (Quantity::Temperature, false),
    ];
    for (quantity, whole) in quantities {
        let before = channels.len();
        for (joint, name) in joints.iter().enumerate() {
            let header = format!("{}{name}", quantity.prefix());
            if let Some(index) = at(&header) {
                channels.push(Channel { index, header, quantity, joint, factor: 1.0, offset: 0.0 });
            }
        }
        let found = &channels[before..];
        if whole && !found.is_empty() && found.len() < joints.len() {
            let has = |joint: usize| found.iter().any(|channel| channel.joint == joint);
            let missing = (0..joints.len()).find(|&joint| !has(joint)).unwrap_or(0);
            return Err(format!(
                "there is no column \"{}{}\", though other joints have one; give it for all joints or for none",
                quantity.prefix(),
                joints[missing]
            ));
        }
    }
    Ok(Plan::new(headers, joints, time, channels))
}

/// The first two columns that form a stamp together: `sec` and `nanosec`, `stamp.secs` and `stamp.nsecs`, and so on.
fn seconds_and_nanos(headers: &[String]) -> Option<TimeColumn> {
    headers.iter().enumerate().find_map(|(index, header)| {
        let stem = header.strip_suffix("secs").or_else(|| header.strip_suffix("sec"))?;
        let nanos = ["nanosec", "nanosecs", "nsec", "nsecs"].iter().find_map(|word| {
            let name = format!("{stem}{word}");
            let nanos = headers.iter().position(|header| *header == name)?;
            Some((nanos, name))
        })?;
        Some(TimeColumn { nanos: Some(nanos), ..TimeColumn::plain(index, headers) })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(header: &str) -> Result<Plan, String> {
        plan_by_names(&header.split(',').map(str::to_owned).collect::<Vec<_>>())
    }

    #[test]
    fn a_joint_has_both_position_and_torque() {
        let plan = plan("t,q_a,q_secondary_a,tau_a,tau_current_a,q_desired_a,mode").expect("it is whole");
        assert_eq!(plan.joints, ["a"]);
        assert_eq!(plan.channels.len(), 4);
        let others: Vec<&str> = plan.others.iter().map(|(_, name)| name.as_str()).collect();
        assert_eq!(others, ["q_desired_a", "mode"]);
    }

    #[test]
    fn numbers_are_no_header() {
        let of = |header: &str| numbers(&header.split(';').map(str::to_owned).collect::<Vec<_>>());
        assert!(of("0;0.5;1e-3").is_some_and(|reason| reason.contains("\"0\"")));
        assert!(of("0,1;0,5;-1,0").is_some());
        assert!(of("t;q_a;1").is_none() && of("").is_none());
    }

    #[test]
    fn an_incomplete_set_is_refused_by_name() {
        let refusal = |header: &str| plan(header).expect_err("it is incomplete");
        assert!(refusal("t,q_a,q_b,tau_a").contains("no column \"tau_b\""));
        assert!(refusal("t,q_a,tau_a,tau_b").contains("no column \"q_b\""));
        assert!(refusal("t,q_elbow,q_b,tau_elbov,tau_b").contains("is \"tau_elbov\" meant?"));
        assert!(refusal("t,q_a,q_b,tau_a,tau_b,qd_a").contains("\"qd_b\""));
        assert!(refusal("q_a,tau_a").contains("no column \"t\""));
        assert!(refusal("t,q_a").contains("tau_<joint>"));
        assert!(refusal("t,tau_a").contains("q_<joint>"));
    }
}
