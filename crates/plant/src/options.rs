//! The integration of a plant, and the friction of its joints.

use arm::Arm;

use crate::error::PlantError;

/// The largest extrapolation order. Beyond it, rounding errors outweigh the gain of extrapolation.
pub const LARGEST_ORDER: usize = 8;

/// The integration step of a [`crate::Plant`], and the friction of its joints.
#[derive(Clone, Debug, PartialEq)]
pub struct PlantOptions {
    /// The duration of a step, in which the torque is constant (s).
    pub step: f64,
    /// Extrapolation order k: the results of 1, 2, … k rapier steps are extrapolated to a step of zero; 1 is rapier's
    /// plain step.
    pub order: usize,
    /// Viscous friction, one value per joint (N m s/rad or N s/m); empty for none.
    pub viscous: Vec<f64>,
    /// Dry (Coulomb) friction, one value per joint (N m or N), equal at rest and in motion; empty for none.
    pub coulomb: Vec<f64>,
}

impl Default for PlantOptions {
    /// A 1 ms step of order 3, without friction.
    fn default() -> Self {
        Self { step: 1e-3, order: 3, viscous: Vec::new(), coulomb: Vec::new() }
    }
}

impl PlantOptions {
    /// Refuses values that are impossible, or that do not fit `arm`.
    pub(crate) fn check(&self, arm: &Arm) -> Result<(), PlantError> {
        let step = self.step;
        if !(step.is_finite() && step > 0.0) {
            return Err(PlantError::Step { step });
        }
        if !(1..=LARGEST_ORDER).contains(&self.order) {
            return Err(PlantError::Order { order: self.order, largest: LARGEST_ORDER });
        }
        if !arm.gravity().iter().all(|g| g.is_finite()) {
            return Err(PlantError::Gravity);
        }
        let rotors: Vec<f64> = arm.joints().iter().map(|joint| joint.rotor_inertia).collect();
        check_values("the viscous friction", &self.viscous, arm)?;
        check_values("the dry friction", &self.coulomb, arm)?;
        check_values("the rotor inertia", &rotors, arm)
    }
}

fn check_values(what: &'static str, values: &[f64], arm: &Arm) -> Result<(), PlantError> {
    if values.is_empty() {
        return Ok(());
    }
    check_count(what, values, arm.dof())?;
    for (joint, &value) in arm.joints().iter().zip(values) {
        if !(value.is_finite() && value >= 0.0) {
            return Err(PlantError::Value { what, joint: joint.name.clone(), value });
        }
    }
    Ok(())
}

/// Refuses a list that does not have one value per joint.
pub(crate) fn check_count(what: &'static str, values: &[f64], expected: usize) -> Result<(), PlantError> {
    if values.len() == expected {
        return Ok(());
    }
    Err(PlantError::Count { what, expected, found: values.len() })
}

/// Weights of the polynomial extrapolation to a step of zero from steps of 1, 1/2, … 1/order.
///
/// Source: Aitken-Neville for the harmonic sequence (Hairer, Nørsett and Wanner 1993, II.9), as weights.
pub(crate) fn extrapolation_weights(order: usize) -> Vec<f64> {
    let weight =
        |j: usize| -> f64 { (1..=order).filter(|&i| i != j).map(|i| j as f64 / (j as f64 - i as f64)).product() };
    (1..=order).map(weight).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The weights reproduce a constant (their sum is 1) and remove the terms 1/n, … 1/nᵏ⁻¹.
    #[test]
    fn weights_remove_the_leading_errors() {
        for order in 1..=LARGEST_ORDER {
            let weights = extrapolation_weights(order);
            for power in 0..order {
                let moments = weights.iter().enumerate();
                let sum: f64 = moments.map(|(j, w)| w * ((j + 1) as f64).powi(-(power as i32))).sum();
                let expected = if power == 0 { 1.0 } else { 0.0 };
                assert!((sum - expected).abs() < 1e-10, "order {order}, power {power}: {sum}");
            }
        }
        assert_eq!(extrapolation_weights(3), [0.5, -4.0, 4.5]);
    }
}
