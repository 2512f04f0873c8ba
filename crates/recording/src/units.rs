//! Units that a column map may name, as factors to SI.

use crate::Quantity;

/// A unit's names, and its factor to the SI unit.
type Unit = (&'static [&'static str], f64);

const DEGREE: f64 = std::f64::consts::PI / 180.0;
const TURN: f64 = std::f64::consts::TAU;

const TIME: &[Unit] = &[(&["s"], 1.0), (&["ms"], 1e-3), (&["us", "µs"], 1e-6), (&["ns"], 1e-9), (&["min"], 60.0)];
const POSITION: &[Unit] = &[
    (&["rad"], 1.0),
    (&["mrad"], 1e-3),
    (&["deg", "°"], DEGREE),
    (&["turn", "rev"], TURN),
    (&["m"], 1.0),
    (&["cm"], 1e-2),
    (&["mm"], 1e-3),
    (&["um", "µm"], 1e-6),
];
const VELOCITY: &[Unit] = &[
    (&["rad/s"], 1.0),
    (&["mrad/s"], 1e-3),
    (&["deg/s", "°/s"], DEGREE),
    (&["rpm", "1/min"], TURN / 60.0),
    (&["turn/s", "rev/s"], TURN),
    (&["m/s"], 1.0),
    (&["mm/s"], 1e-3),
];
const ACCELERATION: &[Unit] = &[
    (&["rad/s2", "rad/s^2", "rad/s²"], 1.0),
    (&["deg/s2", "deg/s^2", "deg/s²"], DEGREE),
    (&["m/s2", "m/s^2", "m/s²"], 1.0),
    (&["mm/s2", "mm/s^2", "mm/s²"], 1e-3),
];
const TORQUE: &[Unit] =
    &[(&["N m", "Nm", "N*m"], 1.0), (&["mN m", "mNm"], 1e-3), (&["kN m", "kNm"], 1e3), (&["N"], 1.0), (&["kN"], 1e3)];
/// Units of currents, which need a scale to become a torque (N m/A, or N m for the whole).
const CURRENT: &[Unit] = &[(&["A"], 1.0), (&["mA"], 1e-3)];
const SHARE: &[Unit] = &[(&["%"], 1e-2)];
const TEMPERATURE: &[Unit] = &[(&["C", "°C", "degC"], 1.0), (&["K"], 1.0)];

/// A unit as a conversion to SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conversion {
    /// SI value = factor × value + offset.
    pub factor: f64,
    /// See `factor`.
    pub offset: f64,
    /// Whether it requires a scale, because it is that of a current in place of a torque.
    pub needs_scale: bool,
}

impl Conversion {
    /// The conversion of a value in SI.
    pub const NONE: Self = Self { factor: 1.0, offset: 0.0, needs_scale: false };
}

fn find(units: &[Unit], name: &str) -> Option<f64> {
    let found = units.iter().find(|(names, _)| names.contains(&name));
    found.map(|(_, factor)| *factor)
}

fn names(tables: &[&[Unit]]) -> String {
    let all: Vec<&str> = tables.iter().flat_map(|units| units.iter()).map(|(names, _)| names[0]).collect();
    all.join(", ")
}

/// The factor of a unit of time; the error lists the known units.
pub fn time(name: &str) -> Result<f64, String> {
    find(TIME, name.trim()).ok_or_else(|| names(&[TIME]))
}

/// The conversion of the unit `name` of `quantity`; the error lists the known units.
pub fn of(quantity: Quantity, name: &str) -> Result<Conversion, String> {
    let name = name.trim();
    let (units, scaled): (&[Unit], &[&[Unit]]) = match quantity {
        Quantity::Position | Quantity::SecondaryPosition => (POSITION, &[]),
        Quantity::Velocity => (VELOCITY, &[]),
        Quantity::Acceleration => (ACCELERATION, &[]),
        Quantity::Torque | Quantity::CurrentTorque => (TORQUE, &[CURRENT, SHARE]),
        Quantity::Current => (CURRENT, &[]),
        Quantity::Temperature => (TEMPERATURE, &[]),
    };
    let offset = if quantity == Quantity::Temperature && name == "K" { -273.15 } else { 0.0 };
    if let Some(factor) = find(units, name) {
        return Ok(Conversion { factor, offset, needs_scale: false });
    }
    for other in scaled {
        if let Some(factor) = find(other, name) {
            return Ok(Conversion { factor, offset, needs_scale: true });
        }
    }
    let mut tables = vec![units];
    tables.extend(scaled);
    Err(names(&tables))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_convert_to_si() {
        let factor = |quantity, name| of(quantity, name).expect("it is known").factor;
        assert!((factor(Quantity::Position, "deg") * 180.0 - std::f64::consts::PI).abs() < 1e-15);
        assert!((factor(Quantity::Velocity, "rpm") * 60.0 - TURN).abs() < 1e-12);
        assert_eq!(factor(Quantity::Torque, "Nm"), 1.0);
        assert!(of(Quantity::Torque, "A").expect("it is known").needs_scale);
        assert_eq!(of(Quantity::Temperature, "K").expect("it is known").offset, -273.15);
        assert_eq!(time("us"), Ok(1e-6));
        assert!(of(Quantity::Position, "furlong").expect_err("it is not").contains("deg, turn"));
    }
}
