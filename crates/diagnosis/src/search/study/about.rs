//! The arm of a fit, about which columns are linearised: the remaining tilts, encoder offsets and payloads are small.

use arm::{Arm, Inertia, Vector3};
use effects::arm::{INERTIAL_PARAMETER, body};
use effects::{Carried, Term};

use crate::data::Data;
use crate::regression::bodies;
use crate::regression::fit::Fit;
use crate::regression::table::Table;

/// An arm with the effects of a fit.
pub struct About {
    /// The arm with payload, link errors, scale and base.
    pub arm: Arm,
    /// The true positions of the joints minus the encoders' (rad or m).
    pub offset: Vec<f64>,
    /// The arm without the background's changes of inertial parameters; `None` if there are none.
    pub bare: Option<Arm>,
    /// The terms that it contains, with their coefficients.
    pub carried: Vec<(Term, f64)>,
}

impl About {
    /// The arm of `data` with the links' scale errors of `fit`, and nothing else.
    pub fn scaled(data: &Data, table: &Table, fit: &Fit) -> Arm {
        collected(data, table, fit, false).0.arm
    }

    /// The arm of `data` with the effects of `fit` that always act.
    pub fn new(data: &Data, table: &Table, fit: &Fit) -> Self {
        Self::with(data, table, fit, collected(data, table, fit, false))
    }

    /// The arm since the recordings from before, with all effects of `fit`; `None` if it is the same as before. Torque
    /// constants, and other effects that are proportional to the joints' torques, then also act on the torque of a new
    /// payload.
    pub fn since_before(data: &Data, table: &Table, fit: &Fit) -> Option<Self> {
        let (found, carried) = collected(data, table, fit, true);
        let sets_in = carried.iter().any(|(term, _)| term.onset().is_some());
        sets_in.then(|| Self::with(data, table, fit, (found, carried)))
    }

    fn with(data: &Data, table: &Table, fit: &Fit, (found, carried): (Carried, Vec<(Term, f64)>)) -> Self {
        let inertial = inertial_changes(data, table, fit);
        let Carried {
            mut arm,
            offset,
            payload,
            tilt: [x, y],
            gravity,
        } = found;
        let tilt = Vector3::new(x, y, 0.0);
        let finish = |mut arm: Arm| {
            if payload[0] != 0.0 {
                arm = arm.with_payload(&body(&payload));
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
        let is_changed = inertial.iter().any(|&value| value != 0.0);
        let bare = is_changed.then(|| finish(arm.clone()));
        if is_changed {
            let nominal = arm.inertial_parameters();
            let links = nominal.chunks_exact(bodies::PER_LINK);
            let bodies: Vec<Inertia> = links
                .zip(inertial.chunks_exact(bodies::PER_LINK))
                .map(|(nominal, change)| body(&bodies::physical(nominal, change)))
                .collect();
            arm = arm.with_inertias(&bodies);
        }
        Self {
            arm: finish(arm),
            offset,
            bare,
            carried,
        }
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

/// Adds the effects of `fit` to the arm, with those that are there since the recordings from before if `since_before`; returns the
/// terms that it then contains, with their coefficients.
fn collected(data: &Data, table: &Table, fit: &Fit, since_before: bool) -> (Carried, Vec<(Term, f64)>) {
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
        let acts = term.onset().is_none() || since_before && term.onset() == data.motions.changed_at;
        if let (Some(carry), true) = (term.law.carry, acts) {
            carry(&term, value, &mut found);
            carried.push((term, value));
        }
    }
    (found, carried)
}
