//! Rigid transformations between frames.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

/// The pose of frame b in frame a, written `a_from_b`: p_a = R p_b + t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// R, the axes of b in a (columns).
    pub rotation: Matrix3<f64>,
    /// t, the origin of b in a (m).
    pub translation: Vector3<f64>,
}

impl Pose {
    /// The identity.
    pub fn identity() -> Self {
        Self { rotation: Matrix3::identity(), translation: Vector3::zeros() }
    }

    /// The pose that URDF writes as `<origin xyz rpy>`: fixed-axis roll, pitch, yaw (rad), then xyz (m).
    pub fn from_xyz_rpy(xyz: [f64; 3], rpy: [f64; 3]) -> Self {
        Self {
            rotation: *Rotation3::from_euler_angles(rpy[0], rpy[1], rpy[2]).matrix(),
            translation: Vector3::from(xyz),
        }
    }

    /// The xyz (m) and the fixed-axis roll, pitch, yaw (rad) with which [`Self::from_xyz_rpy`] makes this pose.
    pub fn xyz_rpy(&self) -> ([f64; 3], [f64; 3]) {
        let (roll, pitch, yaw) = Rotation3::from_matrix_unchecked(self.rotation).euler_angles();
        (self.translation.into(), [roll, pitch, yaw])
    }

    /// The rotation as a unit quaternion: w, x, y, z.
    pub fn quaternion(&self) -> [f64; 4] {
        let rotation = Rotation3::from_matrix_unchecked(self.rotation);
        let quaternion = UnitQuaternion::from_rotation_matrix(&rotation);
        [quaternion.w, quaternion.i, quaternion.j, quaternion.k]
    }

    /// `a_from_c` from `a_from_b` (self) and `b_from_c`.
    pub fn compose(&self, b_from_c: &Pose) -> Pose {
        Pose {
            rotation: self.rotation * b_from_c.rotation,
            translation: self.rotation * b_from_c.translation + self.translation,
        }
    }

    /// `b_from_a`.
    pub fn inverse(&self) -> Pose {
        let rotation = self.rotation.transpose();
        Pose { rotation, translation: -(rotation * self.translation) }
    }

    /// The coordinates in a of a point that is given in b.
    pub fn transform_point(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * point + self.translation
    }
}

/// The matrix of v × (·).
pub(crate) fn cross_matrix(v: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::new(0.0, -v.z, v.y, v.z, 0.0, -v.x, -v.y, v.x, 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_go_round() {
        for rpy in [[0.1, -0.2, 3.0], [0.0, std::f64::consts::FRAC_PI_2, 0.4], [-3.0, 1.5, 0.0]] {
            let pose = Pose::from_xyz_rpy([1.0, 2.0, 3.0], rpy);
            let (xyz, rpy) = pose.xyz_rpy();
            let again = Pose::from_xyz_rpy(xyz, rpy);
            assert!((pose.rotation - again.rotation).norm() < 1e-7, "{rpy:?}");
            assert_eq!(pose.translation, again.translation);
            let [w, x, y, z] = pose.quaternion();
            let turned = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
            assert!((pose.rotation - turned.to_rotation_matrix().matrix()).norm() < 1e-12, "{rpy:?}");
        }
    }
}
