//! The made-up arm, its motion and its torques.

use std::f64::consts::FRAC_PI_2;
use std::fmt::Write;

use arm::Arm;
use diagnosis::Trace;
use diagnosis::statistics::rms;

const NAMES: [&str; 7] = [
    "shoulder_pan_joint",
    "shoulder_lift_joint",
    "elbow_joint",
    "wrist_1_joint",
    "wrist_2_joint",
    "wrist_3_joint",
    "<b>tool & swivel</b>",
];

/// An arm of `joints` joints, with links in the proportions of a common six-axis arm.
pub fn arm(joints: usize) -> Arm {
    let origins = ["0 0 .18", "0 .14 0", "0 -.12 .61", "0 0 .57", "0 .11 0", "0 0 .12", "0 .1 0"];
    let axes = ["0 0 1", "0 1 0", "0 1 0", "0 1 0", "0 0 1", "0 1 0", "0 0 1"];
    let mut urdf = String::from("<robot name=\"six & one\"><link name=\"l0\"/>");
    urdf = urdf.replace('&', "&amp;");
    for i in 0..joints {
        let name = NAMES[i].replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        let mass = 9.0 / (i + 1) as f64;
        let _ = write!(
            urdf,
            "<link name=\"l{0}\"><inertial><origin xyz=\"0 0 .1\"/><mass value=\"{mass}\"/>\
             <inertia ixx=\".1\" iyy=\".1\" izz=\".1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\
             <joint name=\"{name}\" type=\"revolute\"><parent link=\"l{i}\"/><child link=\"l{0}\"/>\
             <origin xyz=\"{1}\"/><axis xyz=\"{2}\"/>\
             <limit lower=\"-3\" upper=\"3\" effort=\"150\" velocity=\"3\"/></joint>",
            i + 1,
            origins[i],
            axes[i]
        );
    }
    urdf.push_str("</robot>");
    Arm::from_urdf_text(&urdf, "six.urdf").expect("an arm")
}

/// Pseudo-random numbers.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        let mut sum = -3.0;
        for _ in 0..6 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            sum += (self.0 >> 11) as f64 / (1_u64 << 53) as f64;
        }
        sum
    }
}

/// An effect's name, its joint, its parameters, and its torque at (time, joint, q, q̇, q̈, nominal torque).
type Torque = fn(f64, usize, &[f64], &[f64], &[f64], f64) -> f64;
pub type Row = (&'static str, Option<usize>, &'static [(&'static str, f64, f64, &'static str)], Torque);

pub const EFFECTS: [Row; 8] = [
    ("spring", Some(1), &[("stiffness", 62.0, 3.1, "N m/rad"), ("rest", -1.66, 0.02, "rad")], |_, _, q, _, _, _| {
        62.0 * (q[1] + 1.66)
    }),
    ("coulomb_friction", Some(0), &[("level", 9.3, 0.25, "N m")], |_, _, _, v, _, _| 9.3 * (v[0] / 0.01).tanh()),
    ("viscous_friction", Some(0), &[("coefficient", 4.2, 0.4, "N m s/rad")], |_, _, _, v, _, _| 4.2 * v[0]),
    (
        "payload",
        None,
        &[("mass", 1.42, 0.06, "kg"), ("com_x", 0.012, 0.004, "m"), ("com_z", 0.083, 0.011, "m")],
        |_, j, q, _, _, _| [0.0, 14.0, 9.0, 3.0, 1.0, 0.2, 0.0][j] * (q.iter().skip(1).take(j).sum::<f64>()).sin(),
    ),
    (
        "torque_ripple",
        Some(2),
        &[("amplitude", 3.4, 0.2, "N m"), ("periods", 18.0, 0.05, ""), ("phase", 0.4, 0.1, "rad")],
        |_, _, q, _, _, _| 3.4 * (18.0 * q[2] + 0.4).sin(),
    ),
    ("rotor_inertia", Some(3), &[("inertia", 0.31, 0.015, "kg m²")], |_, _, _, _, a, _| 0.31 * a[3]),
    (
        "load_dependent_friction",
        Some(2),
        &[("coulomb", 2.0, 0.3, "N m"), ("gain", 0.11, 0.02, "")],
        |_, _, _, v, _, load| (2.0 + 0.11 * load.abs()) * (v[2] / 0.01).tanh(),
    ),
    (
        "external_contact",
        None,
        &[("start", 11.2, 0.05, "s"), ("duration", 1.6, 0.1, "s"), ("force", 38.0, 4.0, "N")],
        |t, j, _, _, _, _| {
            if (11.2..12.8).contains(&t) { [6.0, 14.0, 9.0, 2.0, 1.0, 0.0, 0.0][j] } else { 0.0 }
        },
    ),
];

/// Whether an effect acts on the joint: whole-arm effects act on some of the joints, other effects on their own joint.
pub fn acts(row: &Row, joint: usize, joints: usize) -> bool {
    row.1.map_or((1..5).contains(&joint) && joints > 1, |own| own == joint)
}

pub fn trace(name: &str, start: f64, held_out: bool, joints: usize, found: &[Row], rich: bool) -> Trace {
    let rows = 1500;
    let time: Vec<f64> = (0..rows).map(|k| start + k as f64 * 0.016).collect();
    let zeros = || vec![vec![0.0; rows]; joints];
    let mut trace = Trace {
        name: name.into(),
        held_out,
        q: zeros(),
        qd: zeros(),
        qdd: zeros(),
        tau: zeros(),
        residual: zeros(),
        residual_augmented: zeros(),
        residual_exported: zeros(),
        moving: vec![vec![true; rows]; joints],
        effects: vec![vec![Vec::new(); joints]; found.len()],
        time,
    };
    let mut noise = Noise(7 + start.to_bits());
    for (f, row) in found.iter().enumerate() {
        for joint in (0..joints).filter(|&joint| acts(row, joint, joints)) {
            trace.effects[f][joint] = vec![0.0; rows];
        }
    }
    for k in 0..rows {
        let t = trace.time[k];
        let rests = rich && (k / 150) % 7 == 3;
        let wave = |j: usize, d: usize| -> f64 {
            let turns: [(f64, f64); 3] = [(0.8, 0.9), (0.35, 2.3), (0.1, 5.1)];
            turns
                .iter()
                .map(|(size, speed)| {
                    let w = speed * (1.0 + 0.13 * j as f64);
                    size * w.powi(d as i32) * (w * t + j as f64 + d as f64 * FRAC_PI_2).sin()
                })
                .sum()
        };
        let [q, v, a]: [Vec<f64>; 3] = std::array::from_fn(|d| {
            (0..joints)
                .map(|j| if rests && d > 0 { 0.0 } else { wave(j, d) + if d == 0 && j == 1 { -0.9 } else { 0.0 } })
                .collect()
        });
        for j in 0..joints {
            let size = 60.0 / (1 + j * j) as f64;
            let nominal = size * (q[j.min(1)] + 0.3).sin() + 0.1 * size * a[j];
            let unnamed = if rich && j == 4 { 0.25 * size * (3.0 * wave(4, 0)).sin() } else { 0.0 };
            let left = 0.03 * size * noise.next() + unnamed;
            let mut named = 0.0;
            for (f, row) in found.iter().enumerate().filter(|(_, row)| acts(row, j, joints)) {
                let torque = (row.3)(t, j, &q, &v, &a, nominal);
                trace.effects[f][j][k] = torque;
                named += torque;
            }
            (trace.q[j][k], trace.qd[j][k], trace.qdd[j][k]) = (q[j], v[j], a[j]);
            trace.tau[j][k] = nominal + named + left;
            trace.residual[j][k] = named + left;
            trace.residual_augmented[j][k] = left;
            trace.residual_exported[j][k] = left;
            trace.moving[j][k] = v[j].abs() > 0.02;
        }
    }
    trace
}

/// The standard deviation.
pub fn spread(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    rms(values.iter().map(|value| value - mean)).unwrap_or_default()
}
