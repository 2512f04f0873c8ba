//! The disagreements with the published values, for the beginning of the report.

use report::block::{Block, text};
use report::numbers::percent_to_a_tenth as percent;
use scoring::{Evidence, PublishedFate};

use super::Tried;
use super::quantities::difference;

/// The relative difference above which a value is listed at the start.
const FAR: f64 = 0.2;

/// The effects that were missed, and the published values that differ much from the estimates, robot by robot.
pub fn blocks(robots: &[Tried]) -> Vec<Block> {
    let missed = each(robots, |tried| {
        let outcomes = tried.score.said.iter();
        let missed = outcomes.filter(|o| matches!(o.fate, PublishedFate::Missed | PublishedFate::Unexplained));
        missed
            .map(|outcome| {
                let said = &outcome.said;
                name(&said.effects, said.joint.as_deref())
            })
            .collect()
    });
    let far = each(robots, |tried| {
        let own = tried.score.said.iter().filter(|o| o.said.evidence != Evidence::Constant);
        let mut list = Vec::new();
        for outcome in own {
            let said = &outcome.said;
            for number in &outcome.numbers {
                if let Some(relative) = number.difference.filter(|relative| relative.abs() > FAR) {
                    let name = name(&said.effects, said.joint.as_deref());
                    list.push(format!("{name}, {} {}", number.parameter, difference(relative)));
                }
            }
        }
        list
    });
    let mut list = Vec::new();
    if !missed.is_empty() {
        list.push(text(format!(
            "**Missed.** {missed}. The notes under each robot give the reasons, as far as they are known."
        )));
    }
    if !far.is_empty() {
        list.push(text(format!("**Difference of more than {} from the published value.** {far}.", percent(FAR))));
    }
    list
}

/// `robot: a, b; robot: c`, of robots that have any.
fn each(robots: &[Tried], of: impl Fn(&Tried) -> Vec<String>) -> String {
    let lists = robots.iter().map(|tried| (&tried.robot.name, of(tried)));
    let words = lists.filter(|(_, list)| !list.is_empty());
    let words: Vec<String> = words.map(|(name, list)| format!("{name}: {}", list.join(", "))).collect();
    words.join("; ")
}

fn name(effects: &[String], joint: Option<&str>) -> String {
    let effects: Vec<String> = effects.iter().map(|effect| format!("`{effect}`")).collect();
    let joint = joint.map_or_else(String::new, |joint| format!(" on {joint}"));
    format!("{}{joint}", effects.join(" or "))
}
