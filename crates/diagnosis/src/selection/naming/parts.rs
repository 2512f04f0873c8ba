//! Effects whose parameters are functions of several coefficients: a drive behind a spring, a body, a spring's curve.

use torque::Effect;

use super::{Named, Reader};
use crate::data::measure::inertia;
use crate::data::units::Units;
use crate::regression::term::Term;

/// The drive's inertia before a spring or a gap.
pub fn rotor(reader: &mut Reader<'_>, joint: &str, units: &Units) -> Option<Named> {
    let at = reader.at(|term| matches!(term, Term::Acceleration(_)))?;
    let (inertia, [low, _]) = reader.resampled.interval(|draw| draw[at]);
    if low <= 0.0 {
        return None;
    }
    reader.coefficient("inertia", units.inertia, Some(at), 1.0);
    Some(Named {
        effect: Effect::RotorInertia {
            joint: joint.to_owned(),
            inertia,
        },
        other: None,
        parameters: std::mem::take(&mut reader.parameters),
    })
}

pub fn payload(reader: &mut Reader<'_>) -> Effect {
    let places: Vec<Option<usize>> = (0..10).map(|k| reader.at(|t| t.always() == Term::Payload(k))).collect();
    let read = |draw: &[f64]| -> [f64; 10] {
        let mut parameters = [0.0; 10];
        for (value, place) in parameters.iter_mut().zip(&places) {
            *value = place.map_or(0.0, |place| draw[place]);
        }
        parameters
    };
    let mass = reader.note("mass", "kg", |draw| read(draw)[0]);
    let mut com = [0.0; 3];
    for (k, key) in ["com_x", "com_y", "com_z"].into_iter().enumerate() {
        com[k] = reader.note(key, "m", |draw| {
            let parameters = read(draw);
            parameters[1 + k] / parameters[0]
        });
    }
    // A tensor that no body has says that the recordings do not show it.
    let tensor = inertia(&read(&reader.resampled.estimate)).tensor;
    let possible = places[4].is_some() && tensor.symmetric_eigenvalues().iter().all(|&value| value >= 0.0);
    let inertia = if possible {
        [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)].map(|at| tensor[at])
    } else {
        [0.0; 6]
    };
    Effect::Payload {
        mass,
        com,
        inertia,
        onset: reader.onset(),
    }
}

/// A straight spring, or a curve through the places where its columns peak.
pub fn spring(reader: &mut Reader<'_>, index: usize, joint: String, units: &Units) -> Effect {
    let study = reader.study;
    let (low, high) = (
        study.scales.middle[index] - 0.5 * study.scales.range[index],
        study.scales.middle[index] + 0.5 * study.scales.range[index],
    );
    let columns = &study.candidates[reader.candidate].columns;
    let shape: Vec<(Term, Option<usize>)> = columns
        .iter()
        .map(|&column| (study.table.terms[column], reader.resampled.column(column)))
        .collect();
    let torque = |draw: &[f64], q: f64| -> f64 {
        shape
            .iter()
            .map(|&(term, place)| {
                let value = place.map_or(0.0, |place| draw[place]);
                match term.always() {
                    Term::One(_) => value,
                    Term::Position(_, power) => value * q.powi(power),
                    Term::Tent { centre, width, .. } => value * (1.0 - ((q - centre) / width).abs()).max(0.0),
                    _ => 0.0,
                }
            })
            .sum()
    };
    let slope = |draw: &[f64]| (torque(draw, high) - torque(draw, low)) / (high - low);
    let stiffness = reader.note("stiffness", units.stiffness, slope);
    let middle = 0.5 * (low + high);
    let rest = reader.note("rest", units.position, |draw| {
        middle - torque(draw, middle) / slope(draw)
    });
    let straight = shape.len() == 2;
    let points = 12;
    let curve = if straight {
        Vec::new()
    } else {
        (0..points)
            .map(|k| {
                let q = low + (high - low) * f64::from(k) / f64::from(points - 1);
                [q, torque(&reader.resampled.estimate, q)]
            })
            .collect()
    };
    Effect::Spring {
        joint,
        stiffness,
        rest,
        curve,
        onset: reader.onset(),
    }
}
