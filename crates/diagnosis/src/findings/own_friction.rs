//! Friction that is not the same in all recordings.

use std::collections::BTreeSet;

use effects::Quantity;

use crate::selection::FinalFit;
use crate::thresholds::OTHER_FRICTION;

/// A note on the joints whose dry friction in one recording differs much from that in most others.
pub fn note(last: &FinalFit) -> Option<String> {
    let (study, fit) = (&last.study, &last.judged.named.fit);
    let mut differences = Vec::new();
    let joints: BTreeSet<usize> = study.strengths.varied.iter().map(|(joint, _)| *joint).collect();
    for joint in joints {
        let described = &study.data.arm.joints()[joint];
        for (recording, more) in study.own_levels(fit, joint) {
            if more.abs() > OTHER_FRICTION * study.data.scales.torque[joint] {
                let motions = &study.data.motions;
                let name = &motions.sources[recording].name;
                let with = match motions.groups.iter().filter(|&&group| group == recording).count() {
                    ..2 => String::new(),
                    count => format!(" and the next {}", count - 1),
                };
                let unit = Quantity::Torque.unit(described.kind);
                differences.push(format!("{}: {more:+.2} {unit} in {name}{with}", described.name));
            }
        }
    }
    (!differences.is_empty()).then(|| {
        format!(
            "dry friction is not the same in all recordings ({}). The sizes in the findings are those of most recordings. Find out what \
             differed between them: the temperature of the drives, or work on the arm",
            differences.join("; ")
        )
    })
}
