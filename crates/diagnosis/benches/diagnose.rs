//! The time of a diagnosis of seven joints with four recordings at 250 Hz: of 25 s each, and ten times as long.

#[path = "../tests/support/mod.rs"]
mod support;

use std::f64::consts::TAU;
use std::fmt::Write;

use arm::Arm;
use diagnosis::{Input, Options, diagnose};
use divan::Bencher;
use recording::RegularRecording;
use support::{Motion, recorded, regular};

/// An arm of seven joints that alternately turn and bend.
fn seven() -> Arm {
    let mut text = "<robot name=\"seven\"><link name=\"link0\"/>".to_owned();
    for joint in 1..=7 {
        let size = 4.5 - 0.5 * f64::from(joint);
        let turn = if joint % 2 == 1 { 0.0 } else { TAU / 4.0 * if joint % 4 == 0 { 1.0 } else { -1.0 } };
        let _ = write!(
            text,
            "<link name=\"link{joint}\"><inertial><origin xyz=\"0.01 {} 0.05\"/><mass value=\"{size}\"/>\
             <inertia ixx=\"{i}\" ixy=\"0\" ixz=\"0\" iyy=\"{i}\" iyz=\"0\" izz=\"{i}\"/></inertial></link>\
             <joint name=\"joint{joint}\" type=\"revolute\"><origin xyz=\"0 {} 0.1\" rpy=\"{turn} 0 0\"/>\
             <parent link=\"link{}\"/><child link=\"link{joint}\"/><axis xyz=\"0 0 1\"/>\
             <limit lower=\"-3\" upper=\"3\" effort=\"300\" velocity=\"5\"/></joint>",
            0.02 * size,
            0.04 * f64::from(joint),
            joint - 1,
            i = 0.012 * size,
        );
    }
    Arm::from_urdf_text(&(text + "</robot>"), "seven.urdf").expect("it is an arm")
}

/// Friction on every joint and a spring on the second.
fn injected(motion: &mut Motion, tau: &mut [f64]) {
    for (tau, speed) in tau.iter_mut().zip(&motion.qd) {
        *tau += 1.2 * speed.signum() + 0.7 * speed;
    }
    tau[1] += 20.0 * (motion.q[1] - 0.2);
}

fn bench(bencher: Bencher, seconds: f64) {
    let arm = seven();
    let recordings: Vec<RegularRecording> =
        (0..4).map(|variant| regular(&recorded(&arm, variant, seconds, &injected))).collect();
    let inputs: Vec<Input<'_>> = ["a", "b", "c", "d"]
        .into_iter()
        .zip(&recordings)
        .map(|(name, recording)| Input { name, recording, held_out: name == "d", before: false })
        .collect();
    bencher.bench_local(|| {
        let diagnosis = diagnose(&arm, &inputs, &Options::default(), &|_| {}).expect("it is diagnosed");
        assert!(diagnosis.report.findings.iter().any(|finding| finding.effect == "spring"));
        diagnosis
    });
}

#[divan::bench(sample_count = 5, sample_size = 1)]
fn four_recordings_of_25_s(bencher: Bencher) {
    bench(bencher, 25.0);
}

#[divan::bench(sample_count = 1, sample_size = 1)]
fn four_recordings_of_250_s(bencher: Bencher) {
    bench(bencher, 250.0);
}

fn main() {
    divan::main();
}
