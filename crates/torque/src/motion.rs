//! The motion of an arm at one time.

/// Position, velocity and acceleration of every joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// rad or m.
    pub q: Vec<f64>,
    /// rad/s or m/s.
    pub qd: Vec<f64>,
    /// rad/s² or m/s².
    pub qdd: Vec<f64>,
}

impl Motion {
    /// At rest at position zero.
    pub fn new(dof: usize) -> Self {
        Self { q: vec![0.0; dof], qd: vec![0.0; dof], qdd: vec![0.0; dof] }
    }
}
