//! The rigid model along the recorded motion: torques, and their derivatives with respect to possible errors.

use arm::{Arm, PARAMETERS_PER_LINK, Workspace};
use nalgebra::{DMatrix, Matrix6xX, Vector3};

use crate::data::motion::Chunk;

/// Signals on the ticks of one chunk; the first index is the joint.
#[derive(Clone, Debug, Default)]
pub struct Rigid {
    /// τ (N m or N).
    pub tau: Vec<Vec<f64>>,
    /// Each link's share of τ: `[joint][link]`.
    pub links: Vec<Vec<Vec<f64>>>,
    /// The last link's ten columns of the torque regressor, in the tool's frame: `[joint][parameter]`.
    pub payload: Vec<Vec<Vec<f64>>>,
    /// ∂τ/∂q: `[joint][by]`.
    pub by_position: Vec<Vec<Vec<f64>>>,
    /// ∂τ/∂q̇: `[joint][by]`.
    pub by_velocity: Vec<Vec<Vec<f64>>>,
    /// The mass matrix.
    pub mass: Vec<Vec<Vec<f64>>>,
    /// ∂τ/∂(turn of the base about its x, y axis).
    pub tilt: Vec<[Vec<f64>; 2]>,
    /// The torque of a gravity of 1 m/s² along x, y, z of the base.
    pub gravity: Vec<[Vec<f64>; 3]>,
    /// The torque of a unit force on the tool along x, y, z of the base.
    pub force: Vec<[Vec<f64>; 3]>,
    /// The part of τ that is due to inertial parameters other than the URDF's; empty if there are none.
    pub background: Vec<Vec<f64>>,
    /// The arm.
    arm: Option<Arm>,
    /// The true positions of the joints minus the encoders' (rad or m).
    offset: Vec<f64>,
}

impl Rigid {
    /// Evaluates `arm` along `chunk`, with joints that are `offset` (rad or m) beyond their encoders. The links' shares are
    /// those of links with the inertial parameters `nominal`.
    pub fn new(arm: &Arm, nominal: &[f64], offset: &[f64], chunk: &Chunk) -> Self {
        Self::with_derivatives(arm, nominal, offset, chunk, true)
    }

    /// Sets the background to the difference of the torque from that of `arm` for the same positions of the joints.
    pub fn set_background(&mut self, arm: &Arm, chunk: &Chunk) {
        let mut workspace = Workspace::new(arm);
        let at = |signal: &[Vec<f64>], tick: usize| -> Vec<f64> { signal.iter().map(|joint| joint[tick]).collect() };
        let mut tau = vec![0.0; arm.dof()];
        self.background = self.tau.clone();
        for tick in 0..chunk.ticks() {
            let mut q = at(&chunk.q, tick);
            q.iter_mut().zip(&self.offset).for_each(|(q, offset)| *q += offset);
            arm.inverse_dynamics(
                &mut workspace,
                &q,
                &at(&chunk.qd, tick),
                &at(&chunk.qdd, tick),
                &mut tau,
            );
            for (joint, tau) in tau.iter().enumerate() {
                self.background[joint][tick] -= tau;
            }
        }
    }

    /// Evaluates as [`Self::new`] does; without `derivatives`, ∂τ/∂q and ∂τ/∂q̇ stay zero.
    pub fn with_derivatives(arm: &Arm, nominal: &[f64], offset: &[f64], chunk: &Chunk, derivatives: bool) -> Self {
        let n = arm.dof();
        let ticks = chunk.ticks();
        let zeros = || vec![0.0; ticks];
        let square = || (0..n).map(|_| (0..n).map(|_| zeros()).collect()).collect();
        let mut rigid = Self {
            tau: (0..n).map(|_| zeros()).collect(),
            links: square(),
            payload: (0..n).map(|_| (0..10).map(|_| zeros()).collect()).collect(),
            by_position: square(),
            by_velocity: square(),
            mass: square(),
            tilt: (0..n).map(|_| [zeros(), zeros()]).collect(),
            gravity: (0..n).map(|_| [zeros(), zeros(), zeros()]).collect(),
            force: (0..n).map(|_| [zeros(), zeros(), zeros()]).collect(),
            background: Vec::new(),
            arm: Some(arm.clone()),
            offset: offset.to_vec(),
        };
        let mut workspace = Workspace::new(arm);
        let tool = arm.tool_frame();
        let gravity = *arm.gravity();
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let along = axes.map(|axis| arm.clone().with_gravity(axis));
        // Turning the base by a small angle about x turns gravity by the opposite angle in the base's frame.
        let turned = [Vector3::x(), Vector3::y()].map(|axis| -axis.cross(&gravity));
        let (mut q, mut qd, mut qdd) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        let (mut tau, mut pull) = (vec![0.0; n], vec![0.0; n]);
        let still = vec![0.0; n];
        let mut regressor = DMatrix::zeros(n, PARAMETERS_PER_LINK * n);
        let mut mass = DMatrix::zeros(n, n);
        let (mut by_position, mut by_velocity) = (DMatrix::zeros(n, n), DMatrix::zeros(n, n));
        let mut jacobian = Matrix6xX::zeros(n);
        let to_link = payload_to_link(arm);
        for tick in 0..ticks {
            for joint in 0..n {
                q[joint] = chunk.q[joint][tick] + offset[joint];
                qd[joint] = chunk.qd[joint][tick];
                qdd[joint] = chunk.qdd[joint][tick];
            }
            arm.inverse_dynamics(&mut workspace, &q, &qd, &qdd, &mut tau);
            for joint in 0..n {
                rigid.tau[joint][tick] = tau[joint];
            }
            arm.torque_regressor(&mut workspace, &q, &qd, &qdd, &mut regressor);
            for joint in 0..n {
                for link in joint..n {
                    let from = link * PARAMETERS_PER_LINK;
                    rigid.links[joint][link][tick] = (from..from + PARAMETERS_PER_LINK)
                        .map(|k| regressor[(joint, k)] * nominal[k])
                        .sum();
                }
                let last = (n - 1) * PARAMETERS_PER_LINK;
                for k in 0..10 {
                    rigid.payload[joint][k][tick] = (0..10).map(|l| regressor[(joint, last + l)] * to_link[l][k]).sum();
                }
            }
            if derivatives {
                arm.inverse_dynamics_derivatives(&mut workspace, &q, &qd, &qdd, &mut by_position, &mut by_velocity);
                for joint in 0..n {
                    for by in 0..n {
                        rigid.by_position[joint][by][tick] = by_position[(joint, by)];
                        rigid.by_velocity[joint][by][tick] = by_velocity[(joint, by)];
                    }
                }
            }
            arm.mass_matrix(&mut workspace, &q, &mut mass);
            for joint in 0..n {
                for by in 0..n {
                    rigid.mass[joint][by][tick] = mass[(joint, by)];
                }
            }
            for (axis, along) in along.iter().enumerate() {
                along.inverse_dynamics(&mut workspace, &q, &still, &still, &mut pull);
                for joint in 0..n {
                    rigid.gravity[joint][axis][tick] = pull[joint];
                }
            }
            // The torque is linear in gravity.
            for joint in 0..n {
                let [x, y, z] = [0, 1, 2].map(|axis: usize| rigid.gravity[joint][axis][tick]);
                for (axis, turned) in turned.iter().enumerate() {
                    rigid.tilt[joint][axis][tick] = turned.x * x + turned.y * y + turned.z * z;
                }
            }
            arm.forward_kinematics(&mut workspace, &q);
            arm.jacobian(&mut workspace, &q, &tool, &mut jacobian);
            for joint in 0..n {
                for axis in 0..3 {
                    // The Jacobian's linear rows come after its angular ones.
                    rigid.force[joint][axis][tick] = jacobian[(3 + axis, joint)];
                }
            }
        }
        rigid
    }

    /// The torque on each joint per unit of each inertial parameter of each link, on the rows of `chunk`:
    /// `[joint][10 link + parameter]`, empty for links before the joint.
    pub fn inertial_columns(&self, chunk: &Chunk) -> Vec<Vec<Vec<f64>>> {
        let Some(arm) = &self.arm else { return Vec::new() };
        let (n, ticks) = (arm.dof(), chunk.ticks());
        let mut workspace = Workspace::new(arm);
        let mut regressor = DMatrix::zeros(n, PARAMETERS_PER_LINK * n);
        let mut signals: Vec<Vec<Vec<f64>>> = (0..n)
            .map(|joint| {
                let acts = |k: usize| k / PARAMETERS_PER_LINK >= joint;
                (0..n * PARAMETERS_PER_LINK)
                    .map(|k| if acts(k) { vec![0.0; ticks] } else { Vec::new() })
                    .collect()
            })
            .collect();
        let at = |signal: &[Vec<f64>], tick: usize| -> Vec<f64> { signal.iter().map(|joint| joint[tick]).collect() };
        for tick in 0..ticks {
            let mut q = at(&chunk.q, tick);
            q.iter_mut().zip(&self.offset).for_each(|(q, offset)| *q += offset);
            let (qd, qdd) = (at(&chunk.qd, tick), at(&chunk.qdd, tick));
            arm.torque_regressor(&mut workspace, &q, &qd, &qdd, &mut regressor);
            for (joint, columns) in signals.iter_mut().enumerate() {
                for (k, column) in columns.iter_mut().enumerate().skip(joint * PARAMETERS_PER_LINK) {
                    column[tick] = regressor[(joint, k)];
                }
            }
        }
        for column in signals.iter_mut().flatten().filter(|column| !column.is_empty()) {
            *column = if column.iter().all(|&v| v == 0.0) {
                vec![0.0; chunk.rows()]
            } else {
                chunk.filter(column)
            };
        }
        signals
    }
}

/// The matrix from the ten parameters of a body in the tool's frame to those in the last link's: `[link's][tool's]`.
pub fn payload_to_link(arm: &Arm) -> [[f64; 10]; 10] {
    let pose = arm.tool_frame().link_from_frame;
    let (r, p) = (pose.rotation, pose.translation);
    let mut matrix = [[0.0; 10]; 10];
    for column in 0..10 {
        let mut unit = [0.0; 10];
        unit[column] = 1.0;
        let [m, hx, hy, hz, xx, xy, yy, xz, yz, zz] = unit;
        let h = Vector3::new(hx, hy, hz);
        let tensor = nalgebra::Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        let turned = r * h;
        let moved = turned + m * p;
        // I' = R I Rᵀ + (2 p·Rh + m p²) 1 − (p Rhᵀ + Rh pᵀ) − m p pᵀ: the parallel axis theorem about a point that
        // is not the centre of mass.
        let about = r * tensor * r.transpose() + nalgebra::Matrix3::identity() * (2.0 * p.dot(&turned) + m * p.dot(&p))
            - (p * turned.transpose() + turned * p.transpose())
            - m * p * p.transpose();
        let values = [
            m,
            moved.x,
            moved.y,
            moved.z,
            about[(0, 0)],
            about[(0, 1)],
            about[(1, 1)],
            about[(0, 2)],
            about[(1, 2)],
            about[(2, 2)],
        ];
        for (row, value) in values.into_iter().enumerate() {
            matrix[row][column] = value;
        }
    }
    matrix
}
