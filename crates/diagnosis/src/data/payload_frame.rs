//! The parameters of a body on the tool in the frame of the last link.

use arm::Arm;
use nalgebra::Vector3;

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
