//! The robots of cases, and typical sizes of their quantities.

use std::path::Path;

use arm::{Arm, DMatrix, Workspace};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::error::FaultError;
use crate::truth::Injected;

/// The number of poses at which the mass matrix is evaluated.
const POSES: usize = 20;

/// A robot: the user's model, and the baseline drive inertias that the URDF omits.
#[derive(Clone, Debug)]
pub struct Robot {
    urdf: String,
    arm: Arm,
    rotors: Vec<f64>,
    home: Vec<f64>,
    /// For each joint, the means over poses of M_jj and of 1 / (M⁻¹)_jj, without rotors (kg m² or kg).
    inertias: Vec<(f64, f64)>,
    /// For each joint, the root mean square over poses of the gravity torque (N m or N).
    holding: Vec<f64>,
}

impl Robot {
    /// The robot of a URDF; `path` is its name in errors.
    ///
    /// # Errors
    /// [`FaultError::Arm`] if it is not a serial arm, [`FaultError::Plant`] if it cannot be simulated.
    pub fn new(urdf: impl Into<String>, path: impl AsRef<Path>) -> Result<Self, FaultError> {
        let urdf = urdf.into();
        let arm = Arm::from_urdf_text(&urdf, path)?;
        plant::Plant::new(&arm, &plant::PlantOptions::default())?;
        let home = arm.joints().iter().map(home).collect();
        let mut robot = Self {
            urdf,
            rotors: vec![0.0; arm.dof()],
            inertias: vec![(0.0, 0.0); arm.dof()],
            holding: vec![0.0; arm.dof()],
            home,
            arm,
        };
        robot.sample_poses();
        Ok(robot)
    }

    /// The robot with the baseline inertias of its drives at the joints (kg m² or kg), which its URDF omits.
    ///
    /// # Errors
    /// [`FaultError::Setting`] if there is not one non-negative number per joint.
    pub fn with_rotor_inertias(mut self, rotors: &[f64]) -> Result<Self, FaultError> {
        if rotors.len() != self.arm.dof() || rotors.iter().any(|&rotor| rotor.is_nan() || rotor < 0.0) {
            let reason = format!("give {} rotor inertias, none of them negative", self.arm.dof());
            return Err(FaultError::Setting(reason));
        }
        self.rotors = rotors.to_vec();
        Ok(self)
    }

    /// The robot with the inertias of its drives that its URDF states (kg m² or kg), one per joint.
    pub fn with_stated_rotor_inertias(mut self, stated: &[f64]) -> Self {
        self.arm = self.arm.with_rotor_inertias(stated);
        self
    }

    /// Its name.
    pub fn name(&self) -> &str {
        self.arm.name()
    }

    /// The text of the user's URDF.
    pub fn urdf(&self) -> &str {
        &self.urdf
    }

    /// The arm of that URDF.
    pub fn arm(&self) -> &Arm {
        &self.arm
    }

    /// The drives' baseline inertias (kg m² or kg), one per joint.
    pub fn rotor_inertias(&self) -> &[f64] {
        &self.rotors
    }

    /// Whether its drives have inertias that the URDF omits.
    pub fn has_rotors(&self) -> bool {
        self.rotors.iter().any(|&rotor| rotor > 0.0)
    }

    /// Whether an effect of a truth is one of the baseline drive inertias, which are a property of the robot itself.
    pub(crate) fn has_by_itself(&self, effect: &Injected) -> bool {
        let joints = self.arm.joints().iter().zip(&self.rotors);
        effect.effect == "rotor_inertia"
            && effect.expressed_share.is_none()
            && joints.into_iter().any(|(joint, &rotor)| {
                effect.joint.as_deref() == Some(&joint.name) && effect.number("inertia") == Some(rotor)
            })
    }

    /// The arm with its drives' inertias, those that the URDF states and those that it omits.
    pub(crate) fn driven(&self) -> Arm {
        let rotors: Vec<f64> = (0..self.rotors.len()).map(|j| self.rotor(j)).collect();
        self.arm.clone().with_rotor_inertias(&rotors)
    }

    /// The inertia of the drive of joint `j` (kg m² or kg).
    pub(crate) fn rotor(&self, j: usize) -> f64 {
        self.arm.joints()[j].rotor_inertia + self.rotors[j]
    }

    /// The centres of its motions (rad or m).
    pub(crate) fn home(&self) -> &[f64] {
        &self.home
    }

    /// The inertia that joint `j` moves, with its drive: the geometric mean of those with the other joints held and
    /// free.
    pub(crate) fn inertia(&self, j: usize) -> f64 {
        let (held, free) = self.inertias[j];
        (held * free).sqrt() + self.rotor(j)
    }

    /// The inertia that joint `j` moves while the other joints are held, without its drive (kg m² or kg).
    pub(crate) fn link_inertia(&self, j: usize) -> f64 {
        self.inertias[j].0
    }

    /// The gravity torque of joint `j` (N m or N, root mean square over poses).
    pub(crate) fn holding(&self, j: usize) -> f64 {
        self.holding[j]
    }

    /// The mass of all moving links (kg).
    pub(crate) fn mass(&self) -> f64 {
        self.arm.joints().iter().map(|joint| joint.inertia.mass).sum()
    }

    fn sample_poses(&mut self) {
        let n = self.arm.dof();
        let links = self.arm.clone().with_rotor_inertias(&vec![0.0; n]);
        let mut workspace = Workspace::new(&links);
        let mut random = ChaCha8Rng::seed_from_u64(0);
        let mut matrix = DMatrix::zeros(n, n);
        let mut gravity = vec![0.0; n];
        for _ in 0..POSES {
            let q: Vec<f64> = self.home.iter().map(|home| home + random.random_range(-0.5..0.5)).collect();
            links.mass_matrix(&mut workspace, &q, &mut matrix);
            let inverse = matrix.clone().try_inverse();
            links.gravity_torque(&mut workspace, &q, &mut gravity);
            for (holding, gravity) in self.holding.iter_mut().zip(&gravity) {
                *holding += gravity * gravity / POSES as f64;
            }
            for (j, (held, free)) in self.inertias.iter_mut().enumerate() {
                let alone = inverse.as_ref().map_or(matrix[(j, j)], |inverse| 1.0 / inverse[(j, j)]);
                *held += matrix[(j, j)] / POSES as f64;
                *free += alone.clamp(0.0, matrix[(j, j)]) / POSES as f64;
            }
        }
        for holding in &mut self.holding {
            *holding = holding.sqrt();
        }
    }
}

/// Whether there are at least two joints.
pub(crate) fn has_another_joint(robot: &Robot) -> bool {
    robot.arm().dof() > 1
}

/// Zero if the joint has enough room on both sides, otherwise the middle of its range.
fn home(joint: &arm::Joint) -> f64 {
    let (lower, upper) = (joint.limits.lower, joint.limits.upper);
    let room = 0.25 * (upper - lower);
    if room.is_infinite() || (lower + room <= 0.0 && upper - room >= 0.0) { 0.0 } else { 0.5 * (lower + upper) }
}
