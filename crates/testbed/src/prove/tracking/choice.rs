//! The selection of the cases to track, from the campaign's plan and before anything is simulated.

use std::collections::BTreeSet;

use faults::{CasePlan, Robot};

use super::TASK;
use crate::scenario::Scenario;

/// The largest number of tracked cases, and of those with an effect outside the catalogue.
const MOST: usize = 12;
const OUTSIDE: usize = 2;
/// The effect that acts only in a window of a recording, and not while the task is tracked.
const PASSES: &str = "external_contact";

/// The numbers of the cases that are tracked, of those on the task's robot with an injected fault: each case, in their
/// order, that adds an effect family to the preceding ones, including two with an effect outside the catalogue; if these
/// are fewer than a dozen, the first of the other cases complete the list.
///
/// # Errors
/// If the task's scenario cannot be read.
pub fn chosen(plans: &[CasePlan], robots: &[Robot]) -> anyhow::Result<BTreeSet<usize>> {
    Ok(chosen_on(plans, robots, Scenario::built_in(TASK)?.arm.name()))
}

fn chosen_on(plans: &[CasePlan], robots: &[Robot], name: &str) -> BTreeSet<usize> {
    let acts = |plan: &&CasePlan| plan.effects.iter().any(|effect| effect != PASSES);
    let mine = || plans.iter().filter(|plan| plan.robot(robots).name() == name).filter(acts);
    let is_outside = |plan: &CasePlan| plan.effects.iter().any(|effect| faults::is_outside(effect));
    let mut seen: BTreeSet<&str> = BTreeSet::from([PASSES]);
    let mut taken = BTreeSet::new();
    for outside in [true, false] {
        let most = if outside { OUTSIDE } else { MOST };
        for plan in mine().filter(|plan| is_outside(plan) == outside) {
            let is_new = plan.effects.iter().any(|effect| !seen.contains(effect.as_str()));
            if taken.len() < most && is_new {
                seen.extend(plan.effects.iter().map(String::as_str));
                taken.insert(plan.index);
            }
        }
    }
    for plan in mine().filter(|plan| !is_outside(plan)) {
        if taken.len() < MOST {
            taken.insert(plan.index);
        }
    }
    taken
}

#[cfg(test)]
mod tests {
    use faults::Campaign;

    use super::*;

    #[test]
    fn a_dozen_cases_of_different_families_is_selected_from_the_plan() {
        let robots =
            crate::conceal::robots(&[], &crate::cli::ChainArgs::default()).expect("they come with the program");
        let campaign = |cases: usize| Campaign { seed: 3, cases, lifelike: true, urdf_error: None };
        let plans = campaign(200).plans();
        let taken = chosen(&plans, &robots).expect("the task comes with the program");
        assert_eq!(taken.len(), MOST);
        let plan = |number: &usize| &plans[*number];
        assert!(taken.iter().all(|number| plan(number).robot(&robots).name() == "puma560"));
        let outside = |number: &&usize| plan(number).effects.iter().any(|name| faults::is_outside(name));
        assert_eq!(taken.iter().filter(outside).count(), OUTSIDE);
        let families: BTreeSet<&String> = taken.iter().flat_map(|number| &plan(number).effects).collect();
        assert!(families.len() >= MOST, "{families:?}");
        assert!(chosen_on(&plans, &robots, "another").is_empty());
        let few = campaign(6).plans();
        assert!(chosen_on(&few, &robots, "puma560").len() <= 3);
    }
}
