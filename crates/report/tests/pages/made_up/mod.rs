//! A made-up diagnosis to try page, table and viewer on (the program's viewer tests take it from here): an arm of one to seven joints, moved by sines.

mod motion;

use std::collections::BTreeMap;

use arm::Arm;
use diagnosis::statistics::rms;
use diagnosis::{
    Axis, Confusable, Dependence, Finding, JointFit, JointRollout, Located, NotObservable, Parameter, Place,
    RecordingNames, Region, Report, TimeWindow, Trace, Traces, Unexplained, Verdict,
};
use effects::{Effect, Regressor};

use motion::{EFFECTS, Row, acts, arm, spread, trace};

/// How much the made-up diagnosis finds.
#[derive(Clone, Copy, PartialEq)]
pub enum Plot {
    /// Nothing.
    Clean,
    /// An effect on each joint, one of the whole arm, and an unmodelled residual.
    Rich,
    /// Too little data.
    TooShort,
}

fn parameter(value: f64, half: f64, unit: &'static str) -> Parameter {
    Parameter { value, ci95: [value - half, value + half], unit }
}

/// The report, what its figures are drawn from, and the arm.
pub fn diagnosis(joints: usize, plot: Plot) -> (Report, Traces, Arm) {
    let arm = arm(joints);
    let name = |joint: usize| arm.joints()[joint].name.clone();
    let rich = plot == Plot::Rich;
    let found: Vec<Row> =
        EFFECTS.into_iter().filter(|row| rich && row.1.map_or(joints > 1, |joint| joint < joints)).collect();
    let traces = Traces {
        recordings: vec![
            trace("recordings/a_sines.csv", 0.0, false, joints, &found, rich),
            trace("recordings/b_pick & place.csv", 30.0, false, joints, &found, rich),
            trace("recordings/c_held_out.csv", 60.0, true, joints, &found, rich),
        ],
    };
    let findings = found.iter().enumerate().map(|(f, row)| {
        let shares: BTreeMap<String, f64> = (0..joints)
            .filter(|&joint| acts(row, joint, joints))
            .map(|joint| {
                (
                    name(joint),
                    spread(&traces.recordings[0].effects[f][joint]) / spread(&traces.recordings[0].tau[joint]),
                )
            })
            .collect();
        let joint = row.1.map(name);
        let (main, value, ..) = row.2[0];
        let mut as_effect = Effect::of(effects::spec(row.0).expect("a name of the catalogue"));
        for &(key, value, ..) in row.2 {
            as_effect = as_effect.with(key, value);
        }
        Finding {
            effect: row.0,
            joint: joint.clone(),
            other: None,
            parameters: row.2.iter().map(|&(key, value, half, unit)| (key, parameter(value, half, unit))).collect(),
            probability: Some(0.999 - 0.03 * f as f64),
            share: shares.values().copied().fold(0.0, f64::max),
            share_by_joint: shares,
            held_out_gain: Some(0.6 / (1.0 + f as f64)),
            confusable_with_pairs: Vec::new(),
            confusable_with: match row.0 {
                "spring" => vec![Confusable { effect: "payload", joint: None }],
                "coulomb_friction" => vec![Confusable { effect: "friction_asymmetry", joint: joint.clone() }],
                _ => Vec::new(),
            },
            place: Place {
                time: if row.0 == "external_contact" { vec![[11.2, 12.8]] } else { Vec::new() },
                recording: None,
                state: (row.0 == "coulomb_friction").then(|| "within 0.05 rad/s of a reversal".into()),
            },
            since_before: false,
            change: None,
            sensor: None,
            sentence: format!(
                "{}: {} of {main} {value}; held-out error 0.94 → 0.12.",
                joint.as_deref().unwrap_or("The whole arm"),
                row.0.replace('_', " ")
            ),
            corrects: true,
            as_effect,
        }
    });
    let mut findings: Vec<Finding> = findings.collect();
    findings.sort_by(|a, b| b.share.total_cmp(&a.share));
    let order: Vec<usize> =
        findings.iter().map(|finding| found.iter().position(|row| row.0 == finding.effect).expect("a row")).collect();
    let mut traces = traces;
    for trace in &mut traces.recordings {
        trace.effects = order.iter().map(|&f| trace.effects[f].clone()).collect();
    }
    let fit = (0..joints).map(|j| (name(j), fit(&traces, j, plot))).collect();
    let report = Report {
        schema: "testbed.diagnosis/1",
        robot: arm.name().into(),
        recordings: RecordingNames {
            before: Vec::new(),
            train: traces.recordings[..2].iter().map(|trace| trace.name.clone()).collect(),
            held_out: vec![traces.recordings[2].name.clone()],
            used_in_part: Vec::new(),
        },
        next_experiment: None,
        is_requested: false,
        cutoff: Some(12.0),
        torque_lag: None,
        own_torque_lags: BTreeMap::new(),
        verdict: match plot {
            Plot::Clean => Verdict::NoMismatch,
            Plot::Rich => Verdict::PartlyExplained,
            Plot::TooShort => Verdict::NotEnoughData,
        },
        doubts: Vec::new(),
        warnings: Vec::new(),
        findings,
        unexplained: (rich && joints > 4)
            .then(|| Unexplained {
                joint: name(4),
                share: 0.17,
                depends_on: vec![
                    Regressor::OwnPosition.into(),
                    Dependence { on: Regressor::OtherJoint, joint: Some(name(0)) },
                ],
                time: Vec::new(),
                next: "Sweep this joint alone, slowly, over its range in both directions, twice.".into(),
            })
            .into_iter()
            .collect(),
        not_diagnosed: Vec::new(),
        not_observable: not_observable(&arm),
        not_enough_data: if plot == Plot::TooShort {
            vec![
                "1.9 s in motion; a diagnosis needs about 10 s a joint".into(),
                "no joint reverses more than twice".into(),
            ]
        } else {
            Vec::new()
        },
        located: (0..joints.min(5))
            .filter(|_| rich)
            .map(|j| Located {
                joint: name(j),
                over_noise: 31.0 / (1 + j) as f64,
                repeatable: (j != 2).then_some(0.97 - 0.05 * j as f64),
                regions: vec![
                    Region { axis: Axis::Angle, range: [-1.9, -0.8], residual: 0.71, residual_augmented: 0.05 },
                    Region { axis: Axis::NearReversal, range: [0.0, 0.05], residual: 0.42, residual_augmented: 0.08 },
                ],
                time: vec![TimeWindow { recording: "recordings/a_sines.csv".into(), start: 11.2, end: 12.8 }],
            })
            .collect(),
        fit,
        changed: None,
        different_load: None,
        held_out_friction: Vec::new(),
        inertials: BTreeMap::new(),
        constant_torques: BTreeMap::new(),
        rollout: (0..joints)
            .map(|j| {
                (
                    name(j),
                    JointRollout {
                        nominal_rms_rad: if rich { 0.021 } else { 0.0011 },
                        augmented_rms_rad: 0.0009 + 1e-4 * j as f64,
                    },
                )
            })
            .collect(),
    };
    (report, traces, arm)
}

fn fit(traces: &Traces, j: usize, plot: Plot) -> JointFit {
    let [train, held_out] = [0, 2].map(|i| &traces.recordings[i]);
    let nrmse = |trace: &Trace, residual: &[Vec<f64>]| {
        rms(residual[j].iter().copied()).unwrap_or_default() / spread(&trace.tau[j])
    };
    let some = |value: f64| (plot != Plot::TooShort).then_some(value);
    JointFit {
        torque_std: spread(&train.tau[j]),
        noise: 0.004 * spread(&train.tau[j]),
        held_out_nrmse_nominal: some(nrmse(held_out, &held_out.residual)),
        held_out_nrmse_augmented: some(nrmse(held_out, &held_out.residual_augmented)),
        held_out_nrmse_exported: None,
        held_out_nrmse_identified: None,
        held_out_nrmse_learned: some(1.6 * nrmse(held_out, &held_out.residual_augmented)),
        held_out_nrmse_resting: (plot == Plot::Rich).then_some(0.21),
        held_out_nrmse_resting_nominal: (plot == Plot::Rich).then_some(0.9),
        train_nrmse_nominal: nrmse(train, &train.residual),
        train_nrmse_augmented: nrmse(train, &train.residual_augmented),
        residual_autocorrelation: 0.12,
        residual_autocorrelation_nominal: 0.97,
    }
}

fn not_observable(arm: &Arm) -> Vec<NotObservable> {
    let mut unseen = Vec::new();
    for (j, joint) in arm.joints().iter().enumerate() {
        for (effect, key, size, because) in [
            ("backlash", "halfgap", 0.0003, "gravity loads the gear throughout"),
            ("torque_saturation", "limit", 120.0, "the torque stays below its limit"),
            ("thermal_drift", "time_constant", 400.0, "the recordings are short against a drive's warming"),
        ] {
            unseen.push(NotObservable {
                effect,
                joint: Some(joint.name.clone()),
                because: because.into(),
                would_be_seen_above: BTreeMap::from([(key, size * (1.0 + j as f64))]),
                would_be_seen_below: BTreeMap::new(),
            });
        }
    }
    unseen.push(NotObservable {
        effect: "gravity_misalignment",
        joint: None,
        because: "the arm keeps near one posture".into(),
        would_be_seen_above: BTreeMap::from([("angle", 0.021)]),
        would_be_seen_below: BTreeMap::new(),
    });
    unseen
}
