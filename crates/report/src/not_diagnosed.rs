//! Joints that are not diagnosed, in words.

use diagnosis::{NotDiagnosed, Report, Verdict, list};

/// The most joints that a sentence names.
const NAMED_JOINTS: usize = 4;

/// Whether the joint is not diagnosed, although it moves.
pub fn has(report: &Report, joint: &str) -> bool {
    let mut joints = report.not_diagnosed.iter().flat_map(|group| &group.joints);
    joints.any(|name| name == joint)
}

/// The reasons, one sentence or a few for each group of joints, with the remedy; `named` writes the name of a joint.
pub fn reasons(report: &Report, named: impl Fn(&str) -> String) -> Vec<String> {
    let groups = report.not_diagnosed.iter();
    let reason = |group: &NotDiagnosed| {
        let are = if group.joints.len() == 1 { "is" } else { "are" };
        let names: Vec<String> = group.joints.iter().map(|joint| named(joint)).collect();
        format!("{} {are} not diagnosed: {}.", list(&names), group.because)
    };
    groups.map(reason).collect()
}

/// The sentence before the verdict, which is about the other joints; `None` if there is no verdict on other joints.
pub fn before_verdict(report: &Report) -> Option<String> {
    let joints: Vec<String> = report.not_diagnosed.iter().flat_map(|group| group.joints.clone()).collect();
    let is_searched = !matches!(report.verdict, Verdict::NotEnoughData | Verdict::UnitsFirst);
    (is_searched && !joints.is_empty()).then(|| {
        let (names, were) = match joints.len() {
            1 => (joints[0].clone(), "was"),
            few if few <= NAMED_JOINTS => (list(&joints), "were"),
            many => (format!("{many} joints"), "were"),
        };
        format!("{names} {were} not diagnosed; everything else is about the other joints.")
    })
}
