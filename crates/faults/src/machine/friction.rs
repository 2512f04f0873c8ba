//! Dry friction of all joints at once, by an implicit method: the torque that stops a joint within a tick, bounded by
//! its level.

use arm::{Arm, DMatrix, Workspace};

use super::Machine;
use crate::motion::TICK;

/// The number of ticks between evaluations of the mass matrix.
const REFRESH: usize = 4;
/// The largest number of sweeps, and the change of velocity (rad/s or m/s) below which they end.
const SWEEPS: usize = 50;
const TOLERANCE: f64 = 1e-10;

impl Machine<'_> {
    /// The friction with each joint's dry friction multiplied by a factor, which may differ between recordings.
    pub(crate) fn with_friction(mut self, factors: &[f64]) -> Self {
        self.parts.friction = factors.to_vec();
        self
    }
}

/// Friction torques found by projected Gauss-Seidel sweeps (Jourdan, Alart and Jean 1998) on the velocities at the tick's end.
///
/// The plant can locate stops and breakaways within its steps. With plain steps, this would double the computing time,
/// and the difference would be below the sensors' resolution.
pub(super) struct Friction {
    /// M⁻¹ (rad/s² per N m, and so on).
    response: DMatrix<f64>,
    age: usize,
    /// The friction torques (N m or N).
    pub(super) torques: Vec<f64>,
    bias: Vec<f64>,
}

impl Friction {
    pub(super) fn new(dof: usize) -> Self {
        Self { response: DMatrix::zeros(dof, dof), age: REFRESH, torques: vec![0.0; dof], bias: vec![0.0; dof] }
    }

    /// Resets the mass matrix after a change of the arm.
    pub(super) fn reset(&mut self) {
        self.age = REFRESH;
    }

    /// Computes [`Self::torques`] for a tick from `q`, `qd` under the torques `net`, each bounded by `levels`.
    pub(super) fn solve(
        &mut self,
        arm: &Arm,
        scratch: &mut Workspace,
        [q, qd]: [&[f64]; 2],
        net: &[f64],
        levels: &[f64],
    ) {
        let n = q.len();
        if self.age >= REFRESH {
            arm.mass_matrix(scratch, q, &mut self.response);
            if let Some(factor) = self.response.clone().cholesky() {
                self.response = factor.inverse();
            }
            self.age = 0;
        }
        self.age += 1;
        arm.bias_torque(scratch, q, qd, &mut self.bias);
        let drive = DMatrix::from_fn(n, 1, |i, _| net[i] - self.bias[i] + self.torques[i].clamp(-levels[i], levels[i]));
        let accelerations = &self.response * drive;
        let mut v: Vec<f64> = qd.iter().zip(accelerations.iter()).map(|(v, a)| v + TICK * a).collect();
        for (torque, level) in self.torques.iter_mut().zip(levels) {
            *torque = torque.clamp(-level, *level);
        }
        for _ in 0..SWEEPS {
            let mut largest: f64 = 0.0;
            for i in 0..n {
                if levels[i] == 0.0 {
                    continue;
                }
                let wanted = self.torques[i] - v[i] / (TICK * self.response[(i, i)]);
                let change = wanted.clamp(-levels[i], levels[i]) - self.torques[i];
                if change == 0.0 {
                    continue;
                }
                self.torques[i] += change;
                for (k, v) in v.iter_mut().enumerate() {
                    *v += TICK * self.response[(k, i)] * change;
                }
                largest = largest.max(TICK * self.response[(i, i)] * change.abs());
            }
            if largest < TOLERANCE {
                break;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_robots::seven_axis;

    /// Joints under a torque below their friction stop and remain at rest; others slide against their full friction.
    #[test]
    fn friction_stops_joints_below_its_level() {
        let robot = seven_axis();
        let arm = robot.arm();
        let n = arm.dof();
        let mut scratch = Workspace::new(arm);
        let q: Vec<f64> = (0..n).map(|j| 0.3 - 0.1 * j as f64).collect();
        let mut gravity = vec![0.0; n];
        arm.gravity_torque(&mut scratch, &q, &mut gravity);
        let mut friction = Friction::new(n);
        let levels = vec![1.0; n];
        let pushes = [0.5, -0.9, 0.2, 1.5, -2.0, 0.1, 0.0];
        let net: Vec<f64> = gravity.iter().zip(pushes).map(|(g, push)| g + push).collect();
        friction.solve(arm, &mut scratch, [&q, &vec![0.0; n]], &net, &levels);
        let total: Vec<f64> = net.iter().zip(&friction.torques).map(|(net, f)| net + f).collect();
        let mut qdd = vec![0.0; n];
        arm.forward_dynamics(&mut scratch, &q, &vec![0.0; n], &total, &mut qdd);
        for j in 0..n {
            let (f, a) = (friction.torques[j], qdd[j]);
            if f.abs() < 1.0 - 1e-9 {
                assert!(a.abs() < 1e-4, "{j}: {a}");
            } else {
                assert!(f * a <= 0.0, "{j}: {f} {a}");
            }
        }
        assert!(friction.torques[3] < -0.9 && friction.torques[4] > 0.9, "{:?}", friction.torques);
    }
}
