//! Robots for the tests.

use crate::robot::Robot;

/// The PUMA 560 with its drives' inertias.
pub(crate) fn puma() -> Robot {
    let urdf = include_str!("../../../assets/puma560.urdf");
    let robot = Robot::new(urdf, "puma560.urdf").expect("it is an arm");
    let rotors = [0.784, 2.325, 0.577, 0.191, 0.171, 0.194];
    robot.with_rotor_inertias(&rotors).expect("there are six")
}

/// The arm with seven axes.
pub(crate) fn seven_axis() -> Robot {
    let urdf = include_str!("../../../assets/seven_axis.urdf");
    Robot::new(urdf, "seven_axis.urdf").expect("it is an arm")
}
