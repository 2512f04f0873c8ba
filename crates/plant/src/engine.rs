//! The rapier world that contains the arm's multibody.

use arm::{Arm, DMatrix, Inertia, JointKind, Matrix3, Vector3};
use rapier3d_f64::dynamics::{
    CCDSolver, GenericJointBuilder, ImpulseJointSet, IntegrationParameters, IslandManager, JointAxesMask,
    MassProperties, Multibody, MultibodyIndex, MultibodyJoint, MultibodyJointSet, RigidBodyBuilder, RigidBodySet,
    SoftBodySet,
};
use rapier3d_f64::geometry::{BroadPhaseBvh, ColliderSet, NarrowPhase};
use rapier3d_f64::math::{Matrix, Pose, Rotation, Vector};
use rapier3d_f64::pipeline::PhysicsPipeline;

use crate::bodies::simulable_inertias;
use crate::error::PlantError;

/// The stiffness of the spring that applies a joint's torque. It is a power of two, so small that the joint's position
/// vanishes in the rounding of the rest position −τ/K: the spring is a constant force with exactly the value τ.
const SPRING: f64 = 1.0 / (1_u64 << 60) as f64;

/// The step with which rapier is asked for accelerations (s). Its implicit terms are of the order step × friction /
/// inertia (friction / inertia is 1e5 in a light wrist), which this step makes smaller than rounding errors.
const INSTANT: f64 = 1e-24;

/// A rapier world with one fixed-base multibody.
pub(crate) struct Engine {
    gravity: Vector,
    parameters: IntegrationParameters,
    pipeline: PhysicsPipeline,
    islands: IslandManager,
    broad_phase: BroadPhaseBvh,
    narrow_phase: NarrowPhase,
    bodies: RigidBodySet,
    colliders: ColliderSet,
    impulse_joints: ImpulseJointSet,
    multibody_joints: MultibodyJointSet,
    soft_bodies: SoftBodySet,
    ccd_solver: CCDSolver,
    multibody: MultibodyIndex,
    /// Each joint at coordinate zero, with its present torque and lock.
    joints: Vec<MultibodyJoint>,
    /// The index of each joint among rapier's six axes: 0 is a translation, 3 a rotation.
    axes: Vec<usize>,
}

impl Engine {
    /// The multibody of `arm`, at q = 0 and at rest, with viscous friction (one value per joint, or none).
    pub(crate) fn new(arm: &Arm, viscous: &[f64]) -> Result<Self, PlantError> {
        let inertias = simulable_inertias(arm)?;
        let colliders = ColliderSet::new();
        let mut bodies = RigidBodySet::new();
        let mut multibody_joints = MultibodyJointSet::new();
        let mut parent = bodies.insert(RigidBodyBuilder::fixed());
        let base = parent;
        for (joint, inertia) in arm.joints().iter().zip(&inertias) {
            // An arm at rest in balance would fall asleep and then ignore its torques.
            let body =
                RigidBodyBuilder::dynamic().can_sleep(false).additional_mass_properties(mass_properties(inertia));
            let link = bodies.insert(body);
            let locked = match joint.kind {
                JointKind::Revolute => JointAxesMask::LOCKED_REVOLUTE_AXES,
                JointKind::Prismatic => JointAxesMask::LOCKED_PRISMATIC_AXES,
            };
            // rapier's joint moves about the x axis of its own frame.
            let link_from_axis = frame_with_x(&joint.axis);
            let parent_from_axis = joint.parent_from_joint.rotation * link_from_axis;
            let origin = vector(&joint.parent_from_joint.translation);
            let data = GenericJointBuilder::new(locked)
                .local_frame1(Pose::from_parts(origin, rotation(&parent_from_axis)))
                .local_frame2(Pose::from_parts(Vector::ZERO, rotation(&link_from_axis)))
                .build();
            multibody_joints.insert(parent, link, data, true);
            parent = link;
        }
        for (_, body) in bodies.iter_mut() {
            body.recompute_mass_properties_from_colliders(&colliders);
        }
        let link = multibody_joints.rigid_body_link(base);
        let multibody = link.expect("the base carries the first joint").multibody;

        let parameters = IntegrationParameters {
            // Nothing can collide.
            max_ccd_substeps: 0,
            ..IntegrationParameters::default()
        };
        let mut pipeline = PhysicsPipeline::new();
        pipeline.counters.disable();
        let mut engine = Self {
            gravity: vector(arm.gravity()),
            parameters,
            pipeline,
            islands: IslandManager::new(),
            broad_phase: BroadPhaseBvh::new(),
            narrow_phase: NarrowPhase::new(),
            bodies,
            colliders,
            impulse_joints: ImpulseJointSet::new(),
            multibody_joints,
            soft_bodies: SoftBodySet::new(),
            ccd_solver: CCDSolver::new(),
            multibody,
            joints: Vec::new(),
            axes: Vec::new(),
        };
        engine.finish(arm, viscous);
        Ok(engine)
    }

    /// Passes the joints' drives on to rapier.
    fn finish(&mut self, arm: &Arm, viscous: &[f64]) {
        let multibody = multibody_mut(&mut self.multibody_joints, self.multibody);
        // Until the first forward kinematics, the root still has six degrees of freedom.
        multibody.forward_kinematics(&self.bodies, true);
        // By default, rapier damps every angular axis by 0.1.
        multibody.damping_mut().fill(0.0);
        multibody.damping_mut().as_mut_slice()[..viscous.len()].copy_from_slice(viscous);
        for (armature, joint) in multibody.armature_mut().iter_mut().zip(arm.joints()) {
            *armature = joint.rotor_inertia;
        }
        self.joints = multibody.links().skip(1).map(|link| *link.joint()).collect();
        self.axes = arm
            .joints()
            .iter()
            .map(|joint| match joint.kind {
                JointKind::Prismatic => 0,
                JointKind::Revolute => 3,
            })
            .collect();
    }

    /// Sets the torque of joint `i` (N m or N) from the next [`Self::load`] on, and whether the joint is locked.
    pub(crate) fn drive(&mut self, i: usize, torque: f64, locked: bool) {
        self.joints[i].set_spring(self.axes[i], SPRING, torque / SPRING);
        self.joints[i].kinematic = locked;
    }

    /// Sets the state of the multibody. The motion from there on does not depend on earlier states.
    pub(crate) fn load(&mut self, q: &[f64], qd: &[f64]) {
        let multibody = multibody_mut(&mut self.multibody_joints, self.multibody);
        for ((link, joint), position) in multibody.links_mut().skip(1).zip(&self.joints).zip(q) {
            // The displacement starts from zero, so that the coordinate is exactly q.
            link.joint = *joint;
            link.joint.apply_displacement(std::slice::from_ref(position));
        }
        multibody.generalized_velocity_mut().as_mut_slice().copy_from_slice(qd);
    }

    /// Advances by `time` (s) in `substeps` rapier steps.
    pub(crate) fn run(&mut self, time: f64, substeps: usize) {
        self.parameters.dt = time;
        // Without contacts, solver iterations are substeps, and cost less than whole steps.
        self.parameters.num_solver_iterations = substeps;
        self.pipeline.step(
            self.gravity,
            &self.parameters,
            &mut self.islands,
            &mut self.broad_phase,
            &mut self.narrow_phase,
            &mut self.bodies,
            &mut self.colliders,
            &mut self.impulse_joints,
            &mut self.multibody_joints,
            &mut self.soft_bodies,
            &mut self.ccd_solver,
            &(),
            &(),
        );
    }

    /// Position (rad or m) and velocity (rad/s or m/s) of joint `i`.
    pub(crate) fn state(&self) -> impl Iterator<Item = (f64, f64)> {
        let multibody = &self.multibody_joints[self.multibody];
        let velocities = multibody.generalized_velocity();
        multibody
            .links()
            .skip(1)
            .zip(&self.axes)
            .enumerate()
            .map(move |(i, (link, &axis))| (link.joint().coords()[axis], velocities[i]))
    }

    /// The accelerations in a state under the present torques; M⁻¹ is then available from
    /// [`Self::inverse_mass_column`].
    pub(crate) fn probe(&mut self, q: &[f64], qd: &[f64], qdd: &mut [f64]) {
        self.load(q, qd);
        self.run(INSTANT, 1);
        let multibody = &self.multibody_joints[self.multibody];
        qdd.copy_from_slice(multibody.generalized_acceleration().as_slice());
    }

    /// Column `i` of M⁻¹ in the state of the last probe (rad/s² per N m, or the corresponding units).
    pub(crate) fn inverse_mass_column(&self, i: usize) -> DMatrix<f64> {
        let multibody = &self.multibody_joints[self.multibody];
        let mut column = DMatrix::zeros(self.axes.len(), 1);
        column[i] = 1.0;
        multibody.inv_augmented_mass().solve_mut(&mut column);
        column
    }
}

fn multibody_mut(joints: &mut MultibodyJointSet, index: MultibodyIndex) -> &mut Multibody {
    joints.get_multibody_mut_internal(index).expect("the multibody lives as long as its engine")
}

/// rapier's own constructor drops negative moments of a tensor; this one keeps the tensor unchanged.
fn mass_properties(inertia: &Inertia) -> MassProperties {
    let eigen = inertia.tensor.symmetric_eigen();
    let mut frame = eigen.eigenvectors;
    if frame.determinant() < 0.0 {
        frame.column_mut(0).neg_mut();
    }
    MassProperties::with_principal_inertia_frame(
        vector(&inertia.com),
        inertia.mass,
        vector(&eigen.eigenvalues),
        rotation(&frame),
    )
}

/// A right-handed frame whose x axis is the unit vector `axis`.
fn frame_with_x(axis: &Vector3<f64>) -> Matrix3<f64> {
    let across = Matrix3::identity().column(axis.iamin()).into_owned();
    let y = axis.cross(&across).normalize();
    Matrix3::from_columns(&[*axis, y, axis.cross(&y)])
}

fn vector(v: &Vector3<f64>) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

fn rotation(r: &Matrix3<f64>) -> Rotation {
    let [x, y, z] = [0, 1, 2].map(|j| Vector::new(r[(0, j)], r[(1, j)], r[(2, j)]));
    Rotation::from_mat3(&Matrix::from_cols(x, y, z)).normalize()
}
