//! The figures of the paper: Um, Park and Park, tables I and II, mean squared torque errors in (N m)².

use crate::models::ModelKind;

/// Joints 1 to 6.
type Row = [f64; 6];

/// Table I: trained on task A, tested on task D.
const TABLE_1: [(ModelKind, Row); 4] = [
    (ModelKind::Gp, [21.854, 154.322, 60.601, 4.425e-5, 6.235e-4, 1.046e-4]),
    (ModelKind::RigidBody, [0.6232, 46.498, 1.223, 1.180e-6, 1.737e-5, 2.245e-10]),
    (ModelKind::Hybrid, [0.5926, 4.5408, 0.5539, 1.316e-6, 1.726e-5, 1.101e-4]),
    (ModelKind::IndependentJoint, [0.1399, 0.7928, 0.3730, 1.061e-5, 2.549e-5, 5.402e-20]),
];

/// Table II: trained on tasks A, B and C, tested on task D.
const TABLE_2: [(ModelKind, Row); 4] = [
    (ModelKind::Gp, [161.948, 54.812, 1.449, 4.257e-4, 5.360e-4, 4.563e-4]),
    (ModelKind::RigidBody, [0.6232, 46.498, 1.223, 1.180e-6, 1.737e-5, 2.245e-10]),
    (ModelKind::Hybrid, [0.3664, 16.897, 0.0381, 8.503e-6, 3.240e-5, 5.193e-7]),
    (ModelKind::IndependentJoint, [0.0893, 0.4076, 0.1068, 7.054e-7, 1.979e-5, 5.727e-24]),
];

/// The paper's row for `model` in its table `table` (1 or 2), if it has one.
pub fn row(table: usize, model: ModelKind) -> Option<Row> {
    let rows = if table == 1 { &TABLE_1 } else { &TABLE_2 };
    rows.iter().find(|(kind, _)| *kind == model).map(|(_, row)| *row)
}
