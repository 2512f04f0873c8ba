//! The columns of one joint in a column map, with their units, scales and signs.

use serde::Deserialize;
use toml::Spanned;

use super::{Entry, Source, unknown_unit};
use crate::units::{self, Conversion};
use crate::{Quantity, RecordingError};

/// The keys of one joint.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawJoint {
    pub q: Spanned<String>,
    q_unit: Option<Spanned<String>>,
    q_scale: Option<Spanned<f64>>,
    q_offset: Option<Spanned<f64>>,
    qd: Option<Spanned<String>>,
    qd_unit: Option<Spanned<String>>,
    qd_scale: Option<Spanned<f64>>,
    qdd: Option<Spanned<String>>,
    qdd_unit: Option<Spanned<String>>,
    qdd_scale: Option<Spanned<f64>>,
    pub tau: Spanned<String>,
    tau_unit: Option<Spanned<String>>,
    tau_scale: Option<Spanned<f64>>,
    tau_sign: Option<Spanned<f64>>,
    sign: Option<Spanned<f64>>,
    gear: Option<Spanned<f64>>,
    q_secondary: Option<Spanned<String>>,
    q_secondary_unit: Option<Spanned<String>>,
    q_secondary_scale: Option<Spanned<f64>>,
    tau_current: Option<Spanned<String>>,
    tau_current_unit: Option<Spanned<String>>,
    tau_current_scale: Option<Spanned<f64>>,
    current: Option<Spanned<String>>,
    current_unit: Option<Spanned<String>>,
    temperature: Option<Spanned<String>>,
    temperature_unit: Option<Spanned<String>>,
}

/// A number that must be finite and not zero.
fn factor(source: &Source<'_>, value: Option<&Spanned<f64>>, key: &str) -> Result<f64, RecordingError> {
    match value {
        None => Ok(1.0),
        Some(value) if value.get_ref().is_finite() && *value.get_ref() != 0.0 => Ok(*value.get_ref()),
        Some(value) => {
            Err(source.error(value.span(), format!("{key} is {}; it must be finite and not zero", value.get_ref())))
        }
    }
}

fn sign(source: &Source<'_>, value: Option<&Spanned<f64>>, key: &str) -> Result<f64, RecordingError> {
    match value {
        Some(value) if value.get_ref().abs() != 1.0 => {
            Err(source.error(value.span(), format!("{key} is {}; it must be 1 or -1", value.get_ref())))
        }
        value => Ok(value.map_or(1.0, |value| *value.get_ref())),
    }
}

/// The columns of joint number `joint`.
pub fn entries(
    source: &Source<'_>,
    joint: usize,
    raw: &RawJoint,
    entries: &mut Vec<Entry>,
) -> Result<(), RecordingError> {
    let joint_sign = sign(source, raw.sign.as_ref(), "sign")?;
    let tau_sign = sign(source, raw.tau_sign.as_ref(), "tau_sign")?;
    let gear = factor(source, raw.gear.as_ref(), "gear")?;
    let q_offset = match &raw.q_offset {
        Some(value) if !value.get_ref().is_finite() => {
            return Err(source.error(value.span(), "q_offset must be finite (rad or m)"));
        }
        value => value.as_ref().map_or(0.0, |value| *value.get_ref()),
    };
    // Motor-side motion is divided by the gear ratio, motor-side torque multiplied by it; the second encoder is on the
    // link's side.
    let motion = joint_sign / gear;
    let torque = joint_sign * tau_sign * gear;
    let rows = [
        (Quantity::Position, "q", Some(&raw.q), &raw.q_unit, &raw.q_scale, motion, q_offset),
        (Quantity::Velocity, "qd", raw.qd.as_ref(), &raw.qd_unit, &raw.qd_scale, motion, 0.0),
        (Quantity::Acceleration, "qdd", raw.qdd.as_ref(), &raw.qdd_unit, &raw.qdd_scale, motion, 0.0),
        (Quantity::Torque, "tau", Some(&raw.tau), &raw.tau_unit, &raw.tau_scale, torque, 0.0),
        (
            Quantity::SecondaryPosition,
            "q_secondary",
            raw.q_secondary.as_ref(),
            &raw.q_secondary_unit,
            &raw.q_secondary_scale,
            joint_sign,
            q_offset,
        ),
        (
            Quantity::CurrentTorque,
            "tau_current",
            raw.tau_current.as_ref(),
            &raw.tau_current_unit,
            &raw.tau_current_scale,
            torque,
            0.0,
        ),
        (Quantity::Current, "current", raw.current.as_ref(), &raw.current_unit, &None, joint_sign * tau_sign, 0.0),
        (Quantity::Temperature, "temperature", raw.temperature.as_ref(), &raw.temperature_unit, &None, 1.0, 0.0),
    ];
    for (quantity, key, column, unit, scale, side, offset) in rows {
        let Some(column) = column else {
            if let Some(unit) = unit {
                return Err(source.error(unit.span(), format!("{key}_unit is given, but no column `{key}`")));
            }
            continue;
        };
        let conversion = match unit {
            None => Conversion::NONE,
            Some(unit) => units::of(quantity, unit.get_ref()).map_err(|known| unknown_unit(source, unit, &known))?,
        };
        if let (true, None, Some(unit)) = (conversion.needs_scale, scale, unit) {
            return Err(source.error(
                unit.span(),
                format!("a torque in \"{}\" needs {key}_scale, the N m (or N) that one unit makes", unit.get_ref()),
            ));
        }
        let scale = factor(source, scale.as_ref(), &format!("{key}_scale"))?;
        entries.push(Entry {
            header: column.get_ref().clone(),
            line: source.line(column.span()),
            quantity,
            joint,
            factor: conversion.factor * scale * side,
            offset: offset + conversion.offset,
        });
    }
    Ok(())
}
