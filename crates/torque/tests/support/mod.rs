//! What the tests and benchmarks of torque models share: the PUMA 560 and the paper's motion.

use arm::Arm;
use torque::{RigidBody, Sample, Samples, TorqueModel};

/// The true arm.
pub fn puma560() -> Arm {
    Arm::from_urdf(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/puma560.urdf")).expect("the robot loads")
}

/// q, q̇ and q̈ at `time` (s): two sines per joint, as in equation 20 of the paper; `variant` changes the frequencies.
pub fn motion(time: f64, variant: usize) -> [Vec<f64>; 3] {
    let mut motion = [vec![0.0; 6], vec![0.0; 6], vec![0.0; 6]];
    for joint in 0..6 {
        let amplitude = 0.4 + 0.15 * joint as f64;
        for (amplitude, hertz) in
            [(amplitude, 0.22 - 0.02 * joint as f64), (amplitude / 3.0, 0.12 + 0.03 * joint as f64)]
        {
            let omega = std::f64::consts::TAU * (hertz + 0.06 * variant as f64);
            let (sin, cos) = (omega * time).sin_cos();
            motion[0][joint] += amplitude * sin;
            motion[1][joint] += amplitude * omega * cos;
            motion[2][joint] -= amplitude * omega * omega * sin;
        }
    }
    motion
}

/// `count` samples of the motion at 80 Hz, with the true torques.
pub fn samples(count: usize, variant: usize) -> Samples {
    samples_of(count, |time| motion(time, variant))
}

/// `count` samples of `motion`, a function of the time (s), at 80 Hz, with the true torques.
pub fn samples_of(count: usize, motion: impl Fn(f64) -> [Vec<f64>; 3]) -> Samples {
    let exact = RigidBody::new(puma560());
    let mut workspace = torque::Workspace::new(6);
    let mut prediction = torque::Prediction::new(6);
    let mut samples = Samples::new(6);
    for k in 0..count {
        let [q, qd, qdd] = motion(k as f64 / 80.0);
        exact.predict(&mut workspace, &q, &qd, &qdd, &mut prediction);
        let tau = &prediction.rigid;
        samples.push(Sample { q: &q, qd: &qd, qdd: &qdd, tau }).expect("the sizes fit");
    }
    samples
}
