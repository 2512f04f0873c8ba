//! Many short recordings, which are divided into groups.

use crate::support::{baseline_friction, recorded, regular, sentences, trio};
use diagnosis::{Diagnosis, Input, Options, diagnose};
use recording::RegularRecording;

/// The diagnosis of `count` training recordings of 3 s, and of one that is held out.
fn diagnosed(count: usize) -> Diagnosis {
    let make = |variant| regular(&recorded(&trio(), variant, 3.0, &|motion, tau| baseline_friction(motion, tau)));
    let recordings: Vec<RegularRecording> = (0..=count).map(make).collect();
    let names: Vec<String> = (0..=count).map(|number| format!("r{number}")).collect();
    let input = |(number, recording): (usize, _)| Input {
        name: names[number].as_str(),
        recording,
        held_out: number == count,
        before: false,
    };
    let inputs: Vec<Input<'_>> = recordings.iter().enumerate().map(input).collect();
    diagnose(&trio(), &inputs, &Options::default(), &|_| {}).expect("it can be diagnosed")
}

#[test]
fn many_recordings_are_diagnosed_as_few_are() {
    let diagnosis = diagnosed(60);
    let is_dry = |joint: &str| {
        let mut findings = diagnosis.report.findings.iter();
        findings.any(|finding| finding.effect == "coulomb_friction" && finding.joint.as_deref() == Some(joint))
    };
    for joint in trio().joints() {
        assert!(is_dry(&joint.name), "{}: {:?}", joint.name, sentences(&diagnosis));
    }
    assert!(diagnosis.report.unexplained.is_empty(), "{:?}", diagnosis.report.unexplained);
}
