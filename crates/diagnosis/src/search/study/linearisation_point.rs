//! The arm of a fit, about which columns are linearised: the remaining tilts, encoder offsets and payloads are small.

use arm::{Arm, Inertia, Matrix3, Vector3};
use effects::arm::{INERTIAL_PARAMETER, PAYLOAD_WITHOUT_MOMENTS, body, moments_by_first};
use effects::{Carried, Term};

use crate::data::Data;
use crate::data::motion::Chunk;
use crate::data::rigid::Rigid;
use crate::regression::bodies::{self, WITHOUT_MOMENTS};
use crate::regression::fit::Fit;
use crate::regression::table::Table;

/// An arm with the effects of a fit.
pub struct LinearisationPoint {
    /// The arm with payload, link errors, scale and base.
    pub arm: Arm,
    /// The true positions of the joints minus the encoders' (rad or m).
    pub offset: Vec<f64>,
    /// The arm without the background's changes of inertial parameters; `None` if there are none.
    pub bare: Option<Arm>,
    /// The derivatives of the moments of a payload that are not fitted, if the fit has such a payload ([`moments_by_first`]).
    pub moments: Option<[[f64; 6]; WITHOUT_MOMENTS]>,
    /// The terms that it contains at any time, with their coefficients.
    pub carried: Vec<(Term, f64)>,
}

impl LinearisationPoint {
    /// The arm of `data` with the links' scale errors of `fit`, and nothing else.
    pub fn scaled(data: &Data, table: &Table, fit: &Fit) -> Arm {
        collected(data, table, fit, f64::NEG_INFINITY).0.arm
    }

    /// The arm of `data` with the effects of `fit`, one for each stage between their onsets: the time at which the stage begins (s, the
    /// first one at −∞), and its arm. `load` is the tensor of a payload whose moments are not fitted. Torque constants, and other effects
    /// that depend on the joints' torques, thus also act on the torque of a payload that was picked up on the way.
    pub fn stages(data: &Data, table: &Table, fit: &Fit, load: &Matrix3<f64>) -> Vec<(f64, Self)> {
        let carried = |&column: &usize| table.terms[column].law.carry.is_some();
        let columns = fit.columns.iter().filter(|column| carried(column));
        let mut times: Vec<f64> = columns.filter_map(|&column| table.terms[column].acts.time()).collect();
        times.push(f64::NEG_INFINITY);
        times.sort_by(f64::total_cmp);
        times.dedup();
        let stage = |at: f64| (at, Self::with(data, table, fit, collected(data, table, fit, at), load));
        times.into_iter().map(stage).collect()
    }

    /// The arm of `data` with all effects of `fit`, as it is after the recordings; `load` as for [`Self::stages`].
    pub fn last(data: &Data, table: &Table, fit: &Fit, load: &Matrix3<f64>) -> Self {
        Self::with(data, table, fit, collected(data, table, fit, f64::INFINITY), load)
    }

    /// The rigid model along `chunk` of an arm with these stages; the links' shares are those of links with the inertial parameters
    /// `nominal`.
    pub fn along(stages: &[(f64, Self)], nominal: &[f64], chunk: &Chunk) -> Rigid {
        let ticks = chunk.ticks();
        let first = |(from, _): &(f64, Self)| (0..ticks).take_while(|&tick| chunk.time(tick) < *from).count();
        let starts: Vec<usize> = stages.iter().map(first).collect();
        let mut rigid: Option<Rigid> = None;
        for (k, (_, stage)) in stages.iter().enumerate() {
            let end = starts.get(k + 1).copied().unwrap_or(ticks);
            if starts[k] == end {
                continue;
            }
            let own = stage.rigid(nominal, chunk);
            match &mut rigid {
                Some(rigid) => rigid.replace_from(starts[k], own),
                None => rigid = Some(own),
            }
        }
        rigid.unwrap_or_default()
    }

    fn rigid(&self, nominal: &[f64], chunk: &Chunk) -> Rigid {
        let mut rigid = Rigid::new(&self.arm, nominal, &self.offset, chunk);
        if let Some(bare) = &self.bare {
            rigid.set_background(bare, chunk);
        }
        if let Some(moments) = &self.moments {
            rigid.add_payload_without_moments(moments);
        }
        rigid
    }

    fn with(
        data: &Data,
        table: &Table,
        fit: &Fit,
        (found, carried): (Carried, Vec<(Term, f64)>),
        load: &Matrix3<f64>,
    ) -> Self {
        let inertial = inertial_changes(data, table, fit);
        let Carried { mut arm, offset, payload, tilt: [x, y], gravity } = found;
        let tilt = Vector3::new(x, y, 0.0);
        let has_moments = payload[WITHOUT_MOMENTS..].iter().any(|&moment| moment != 0.0);
        let finish = |mut arm: Arm| {
            if payload[0] != 0.0 {
                let mut body = body(&payload);
                if !has_moments {
                    body.tensor = *load;
                }
                arm = arm.with_payload(&body);
            }
            if gravity != [0.0; 3] {
                let turned = arm.gravity() + Vector3::from(gravity);
                arm = arm.with_gravity(turned);
            }
            if tilt.norm() > 0.0 {
                arm = arm.with_turned_base(tilt, tilt.norm());
            }
            arm
        };
        let first = Vector3::new(payload[1], payload[2], payload[3]);
        let is_without = |(term, _): &(Term, f64)| term.always().is(&PAYLOAD_WITHOUT_MOMENTS);
        // Also where this stage has no such payload, because the signals of all stages are the same ones.
        let moments =
            carried.iter().any(is_without).then(|| moments_by_first(if has_moments { 0.0 } else { payload[0] }, first));
        let is_changed = inertial.iter().any(|&value| value != 0.0);
        let bare = is_changed.then(|| finish(arm.clone()));
        if is_changed {
            let nominal = arm.inertial_parameters();
            let links = nominal.chunks_exact(bodies::PER_LINK);
            let bodies: Vec<Inertia> = links
                .zip(inertial.chunks_exact(bodies::PER_LINK))
                .map(|(nominal, change)| body(&bodies::physical(nominal, bodies::LeastBody::default(), change)))
                .collect();
            arm = arm.with_inertias(&bodies);
        }
        Self { arm: finish(arm), offset, bare, moments, carried }
    }
}

/// The changes of the links' inertial parameters in the background of `fit`, ten per link.
pub fn inertial_changes(data: &Data, table: &Table, fit: &Fit) -> Vec<f64> {
    let mut changes = vec![0.0; bodies::PER_LINK * data.arm.dof()];
    for (&column, &value) in fit.columns.iter().zip(&fit.coefficients) {
        let term = table.terms[column];
        if term.is(&INERTIAL_PARAMETER) {
            changes[term.of[0] * bodies::PER_LINK + term.of[1]] = value;
        }
    }
    changes
}

/// Adds the effects of `fit` that act at the time `at` (s) to the arm; returns the terms that it contains at this time or at another,
/// with their coefficients. The columns of a term are zero while it does not act.
fn collected(data: &Data, table: &Table, fit: &Fit, at: f64) -> (Carried, Vec<(Term, f64)>) {
    let mut found = Carried {
        arm: data.arm.clone(),
        offset: vec![0.0; data.arm.dof()],
        payload: [0.0; 10],
        tilt: [0.0; 2],
        gravity: [0.0; 3],
    };
    let mut carried = Vec::new();
    for (&column, &value) in fit.columns.iter().zip(&fit.coefficients) {
        let term = table.terms[column];
        if let Some(carry) = term.law.carry {
            if term.acts.at(at) {
                carry(&term, value, &mut found);
            }
            carried.push((term, value));
        }
    }
    (found, carried)
}

#[cfg(test)]
mod tests {
    use arm::{Arm, Inertia};

    use super::*;
    use crate::data::signal::Kernel;

    /// A payload whose moments are not fitted has those of its mass and first moments, so that its columns are the derivatives of the
    /// torque with these moments.
    #[test]
    fn columns_of_a_payload_without_moments_are_derivatives() {
        let urdf = include_str!("../../../tests/support/trio.urdf");
        let arm = Arm::from_urdf_text(urdf, "trio.urdf").expect("it is an arm");
        let ticks = 20;
        let signal = |turn: f64| {
            let of =
                |joint: usize| (0..ticks).map(move |tick| (turn + joint as f64 + 0.3 * tick as f64).sin()).collect();
            (0..3).map(of).collect::<Vec<Vec<f64>>>()
        };
        let chunk = Chunk {
            recording: 0,
            group: 0,
            start: 0.0,
            period: 0.01,
            q: signal(0.0),
            qd: signal(1.0),
            qdd: signal(2.0),
            tau: signal(3.0),
            known: Vec::new(),
            kernel: Kernel::new(10.0, 0.01),
            stride: 1,
        };
        let values = [0.6, 0.05, -0.02, 0.1];
        let along = |values: [f64; 4], moments: Option<[[f64; 6]; 4]>| {
            let [mass, x, y, z] = values;
            let payload = Inertia { mass, com: Vector3::new(x, y, z) / mass, tensor: Matrix3::identity() * 1e-3 };
            let point = LinearisationPoint {
                arm: arm.clone().with_payload(&payload),
                offset: vec![0.0; 3],
                bare: None,
                moments,
                carried: Vec::new(),
            };
            point.rigid(&arm.inertial_parameters(), &chunk)
        };
        let moments = moments_by_first(values[0], Vector3::new(values[1], values[2], values[3]));
        let columns = along(values, Some(moments)).payload;
        for parameter in 0..4 {
            let moved = |by: f64| {
                let mut values = values;
                values[parameter] += by;
                along(values, None).tau
            };
            let (before, after) = (moved(-1e-5), moved(1e-5));
            for joint in 0..3 {
                for tick in 0..ticks {
                    let expected = (after[joint][tick] - before[joint][tick]) / 2e-5;
                    let found = columns[joint][10 + parameter][tick];
                    assert!((found - expected).abs() < 1e-6 * expected.abs().max(1.0), "{found} for {expected}");
                }
            }
        }
    }
}
