//! Arms for the tests and the benchmark of this crate.
#![allow(dead_code, clippy::unwrap_used, missing_docs)]

use arm::{Arm, Workspace};

/// The PUMA 560 with the published masses; the inertia tensor of its third link violates the triangle inequality.
const PUMA: &str = include_str!("../../../assets/puma560.urdf");

/// Seven skew axes, and inertia tensors with principal axes along none of them.
const SKEW: &str = r#"<robot name="skew7">
<link name="base"/>
<joint name="j1" type="continuous"><origin xyz="-0.035 -0.07 0.23" rpy="-1.283 0.108 -0.403"/><parent link="base"/><child link="l1"/><axis xyz="-0.884 0.015 -0.925"/></joint>
<link name="l1"><inertial><origin xyz="-0.012 0.052 0.019" rpy="-1.661 0.382 2.686"/><mass value="6"/><inertia ixx="0.09276" ixy="0.00928" ixz="-0.00528" iyy="0.07536" iyz="0.00382" izz="0.07632"/></inertial></link>
<joint name="j2" type="continuous"><origin xyz="0.015 -0.021 0.295" rpy="-1.36 1.075 -0.631"/><parent link="l1"/><child link="l2"/><axis xyz="-0.711 -0.764 -0.383"/></joint>
<link name="l2"><inertial><origin xyz="0.022 -0.02 0.082" rpy="-2.623 -1.321 -1.764"/><mass value="5"/><inertia ixx="0.09260" ixy="0.00926" ixz="-0.00470" iyy="0.06720" iyz="0.00417" izz="0.08330"/></inertial></link>
<joint name="j3" type="continuous"><origin xyz="0.036 -0.014 0.163" rpy="0.257 -0.14 -0.601"/><parent link="l2"/><child link="l3"/><axis xyz="0.589 0.398 -0.512"/></joint>
<link name="l3"><inertial><origin xyz="0.037 -0.034 0.147" rpy="-2.292 -0.246 1.543"/><mass value="4"/><inertia ixx="0.06640" ixy="0.00664" ixz="-0.00454" iyy="0.06480" iyz="0.00380" izz="0.07600"/></inertial></link>
<joint name="j4" type="continuous"><origin xyz="-0.07 -0.002 0.108" rpy="0.505 0.794 0.219"/><parent link="l3"/><child link="l4"/><axis xyz="0.751 -0.373 0.391"/></joint>
<link name="l4"><inertial><origin xyz="0.054 0.071 0.071" rpy="0.985 -1.318 1.209"/><mass value="3"/><inertia ixx="0.05028" ixy="0.00503" ixz="-0.00349" iyy="0.04992" iyz="0.00235" izz="0.04692"/></inertial></link>
<joint name="j5" type="continuous"><origin xyz="0.029 0.099 0.264" rpy="-0.646 -0.343 0.506"/><parent link="l4"/><child link="l5"/><axis xyz="-0.955 -0.077 -0.664"/></joint>
<link name="l5"><inertial><origin xyz="-0.059 -0.04 0.059" rpy="2.229 -1.258 -0.305"/><mass value="2"/><inertia ixx="0.02588" ixy="0.00259" ixz="-0.00175" iyy="0.02496" iyz="0.00181" izz="0.03628"/></inertial></link>
<joint name="j6" type="continuous"><origin xyz="0.01 0.077 0.264" rpy="1.092 -0.665 -0.254"/><parent link="l5"/><child link="l6"/><axis xyz="-0.282 0.768 0.915"/></joint>
<link name="l6"><inertial><origin xyz="-0.043 -0.002 0.088" rpy="-1.424 -1.488 -0.486"/><mass value="1"/><inertia ixx="0.01320" ixy="0.00132" ixz="-0.00094" iyy="0.01340" iyz="0.00069" izz="0.01386"/></inertial></link>
<joint name="j7" type="continuous"><origin xyz="-0.026 0.013 0.291" rpy="0.571 0.046 0.353"/><parent link="l6"/><child link="l7"/><axis xyz="0.352 -0.892 0.799"/></joint>
<link name="l7"><inertial><origin xyz="-0.017 -0.016 0.016" rpy="0.806 -1.313 -2.596"/><mass value="0.5"/><inertia ixx="0.00912" ixy="0.00091" ixz="-0.00067" iyy="0.00950" iyz="0.00046" izz="0.00919"/></inertial></link>
</robot>"#;

/// Prismatic and revolute joints in turns, with no axis along a coordinate axis.
const GANTRY: &str = r#"<robot name="gantry">
<link name="base"/>
<joint name="rail" type="prismatic"><origin xyz="0 0 1" rpy="0.3 0.2 0"/><parent link="base"/><child link="carriage"/><axis xyz="1 0.5 -0.2"/><limit lower="-9" upper="9" effort="0" velocity="0"/></joint>
<link name="carriage"><inertial><origin xyz="0.02 0 0.05" rpy="0.4 0 0"/><mass value="8"/><inertia ixx="0.06" ixy="0.01" ixz="0" iyy="0.05" iyz="0" izz="0.04"/></inertial></link>
<joint name="shoulder" type="continuous"><origin xyz="0 0.1 0" rpy="0 1 0.5"/><parent link="carriage"/><child link="upper"/><axis xyz="0 1 0.3"/></joint>
<link name="upper"><inertial><origin xyz="0.2 0 0.03" rpy="0 0.3 0.1"/><mass value="3"/><inertia ixx="0.01" ixy="0" ixz="0.002" iyy="0.05" iyz="0" izz="0.05"/></inertial></link>
<joint name="quill" type="prismatic"><origin xyz="0.4 0 0" rpy="0.1 0.2 0.3"/><parent link="upper"/><child link="tool"/><axis xyz="-0.3 0.1 1"/><limit lower="-9" upper="9" effort="0" velocity="0"/></joint>
<link name="tool"><inertial><origin xyz="0 0.01 0.1" rpy="0 0 0.7"/><mass value="1.2"/><inertia ixx="0.004" ixy="0" ixz="0" iyy="0.003" iyz="0.0005" izz="0.002"/></inertial></link>
<joint name="wrist" type="continuous"><origin xyz="0 0 0.2" rpy="1 0 0"/><parent link="tool"/><child link="hand"/><axis xyz="1 -1 0.5"/></joint>
<link name="hand"><inertial><origin xyz="0.03 0 0.04" rpy="0.5 0.5 0"/><mass value="0.7"/><inertia ixx="0.002" ixy="0" ixz="0" iyy="0.001" iyz="0" izz="0.0015"/></inertial></link>
</robot>"#;

/// One prismatic joint with the mass of the EMPS drive (Janot, Gautier and Brunot 2019).
const SLIDER: &str = r#"<robot name="slider">
<link name="base"/>
<joint name="rail" type="prismatic"><parent link="base"/><child link="carriage"/><axis xyz="1 0 0"/><limit lower="-9" upper="9" effort="0" velocity="0"/></joint>
<link name="carriage"><inertial><mass value="95"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
</robot>"#;

pub fn puma() -> Arm {
    read(PUMA)
}

pub fn skew() -> Arm {
    read(SKEW)
}

pub fn gantry() -> Arm {
    read(GANTRY)
}

pub fn slider() -> Arm {
    read(SLIDER)
}

pub fn read(urdf: &str) -> Arm {
    Arm::from_urdf_text(urdf, "test.urdf").unwrap()
}

/// The analytic plant: [`Arm::forward_dynamics`] with viscous friction and an additional torque per joint.
pub struct Reference<'a> {
    arm: &'a Arm,
    workspace: Workspace,
    /// Viscous friction, one value per joint.
    pub viscous: Vec<f64>,
}

impl<'a> Reference<'a> {
    pub fn new(arm: &'a Arm) -> Self {
        Self { arm, workspace: Workspace::new(arm), viscous: vec![0.0; arm.dof()] }
    }

    pub fn accelerations(&mut self, q: &[f64], qd: &[f64], tau: &[f64]) -> Vec<f64> {
        let mut qdd = vec![0.0; q.len()];
        let tau: Vec<f64> = (0..q.len()).map(|i| tau[i] - self.viscous[i] * qd[i]).collect();
        self.arm.forward_dynamics(&mut self.workspace, q, qd, &tau, &mut qdd);
        qdd
    }

    /// Advances by `time` (s) in `steps` steps of the classical Runge-Kutta method.
    pub fn run(&mut self, q: &mut [f64], qd: &mut [f64], tau: &[f64], time: f64, steps: usize) {
        let n = q.len();
        let h = time / steps as f64;
        for _ in 0..steps {
            let (mut dq, mut dqd) = (vec![0.0; n], vec![0.0; n]);
            let (mut kq, mut kqd) = (vec![0.0; n], vec![0.0; n]);
            for (c, weight) in [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
                let stage_q: Vec<f64> = (0..n).map(|i| q[i] + c * h * kq[i]).collect();
                let stage_qd: Vec<f64> = (0..n).map(|i| qd[i] + c * h * kqd[i]).collect();
                kqd = self.accelerations(&stage_q, &stage_qd, tau);
                kq = stage_qd;
                for i in 0..n {
                    dq[i] += h / 6.0 * weight * kq[i];
                    dqd[i] += h / 6.0 * weight * kqd[i];
                }
            }
            for i in 0..n {
                q[i] += dq[i];
                qd[i] += dqd[i];
            }
        }
    }
}

/// The largest difference between the entries of two vectors.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Pseudorandom numbers from −1 to 1, always the same.
pub struct Random(pub u64);

impl Random {
    pub fn vector(&mut self, n: usize, scale: f64) -> Vec<f64> {
        (0..n).map(|_| scale * self.next()).collect()
    }

    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}
