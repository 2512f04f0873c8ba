//! A spring parallel to the joint, such as cables, hoses and balancers.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "spring",
    forms: &["gas spring", "hardening", "knee"],
    may_have_onset: true,
    draw: |bare, at, random| {
        let bend = *["gas spring", "hardening", "knee"].choose(random).unwrap_or(&"knee");
        let spring = bare
            .with("stiffness", at.spread() * random.random_range(0.3..1.5))
            .with("rest", at.home() + random.random_range(-0.4..0.4));
        if at.hard { spring.formed(bend) } else { spring }
    },
    size: Size::Times(&["stiffness"]),
    read: |reader| {
        let points = reader.curve()?;
        if !points.is_empty() {
            return reader.on_link(Curve(points));
        }
        reader.on_link(Spring {
            stiffness: reader.number("stiffness")?,
            rest: reader.number("rest")?,
            bend: [Bend::Straight, Bend::Gas, Bend::Hardening, Bend::Knee][reader.form()?],
        })
    },
    #[cfg(test)]
    example: |bare| bare.with("stiffness", 10.0).with("rest", 0.2),
    ..Fault::ON_A_JOINT
};

struct Spring {
    stiffness: f64,
    rest: f64,
    bend: Bend,
}

/// The characteristic of a spring.
#[derive(Clone, Copy)]
enum Bend {
    /// Linear.
    Straight,
    /// Softer away from its rest position, as a gas spring on a crank: x becomes 0.45 tanh(x/0.45).
    Gas,
    /// Stiffer away from its rest position: x (1 + 0.6 x²).
    Hardening,
    /// Two stiffnesses: 0.25 tanh(x/0.25) + 0.5 x.
    Knee,
}

impl LinkLaw for Spring {
    fn torque(&self, at: At<'_>, _: &mut f64, _: f64) -> f64 {
        let x = at.position() - self.rest;
        self.stiffness
            * match self.bend {
                Bend::Straight => x,
                Bend::Gas => 0.45 * (x / 0.45).tanh(),
                Bend::Hardening => x * (1.0 + 0.6 * x * x),
                Bend::Knee => 0.25 * (x / 0.25).tanh() + 0.5 * x,
            }
    }
}

/// Through points (position, torque) in increasing order of position; constant outside.
struct Curve(Vec<[f64; 2]>);

impl LinkLaw for Curve {
    fn torque(&self, at: At<'_>, _: &mut f64, _: f64) -> f64 {
        let (points, x) = (&self.0, at.position());
        let after = points.partition_point(|point| point[0] <= x);
        match (after.checked_sub(1).map(|before| points[before]), points.get(after)) {
            (Some([x0, y0]), Some([x1, y1])) => y0 + (y1 - y0) * (x - x0) / (x1 - x0),
            (Some([_, y]), None) | (None, Some(&[_, y])) => y,
            (None, None) => 0.0,
        }
    }
}
