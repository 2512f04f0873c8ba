//! Drag that grows with the square of the speed, or another power of it.

use super::prelude::*;
use super::viscous_friction::Power;

pub(super) const FAULT: Fault = Fault {
    name: "quadratic_drag",
    forms: &["power"],
    form_parameters: &["exponent"],
    may_have_onset: true,
    draw: |bare, at, random| {
        let coefficient = at.spread() * random.random_range(0.1..0.6);
        let exponent = *[1.7, 2.3, 2.7].choose(random).unwrap_or(&1.7);
        let drag = bare.with("coefficient", coefficient);
        if at.hard { drag.formed("power").with("exponent", exponent) } else { drag }
    },
    size: Size::Times(&["coefficient"]),
    read: |reader| {
        let exponent = reader.number_or("exponent", [2.0, 1.7][reader.form()?])?;
        let coefficient = reader.number("coefficient")?;
        reader.on_drive(Power { coefficient, exponent })
    },
    #[cfg(test)]
    example: |bare| bare.with("coefficient", 3.0),
    ..Fault::ON_A_JOINT
};
