//! A gap between the rotor of a drive and its link.

use super::joint_elasticity::elastic;
use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "backlash",
    forms: &["rounded"],
    more_parameters: &["rotor", "stiffness", "damping"],
    leaves: Leaves::Rotor,
    may_oscillate: true,
    similar_faults: Some(SimilarFaults::BetweenCommandAndLink),
    draw: |bare, at, random| {
        let own = at.rotor_inertia();
        let rotor = if own > 0.0 { own } else { at.link_inertia() * random.random_range(0.4..1.0) };
        let round = at.hard && random.random_bool(0.6);
        let bare = if round { bare.formed("rounded") } else { bare };
        let halfgaps = if at.hard { 0.002..0.008 } else { 0.004..0.014 };
        bare.with("halfgap", random.random_range(halfgaps)).with("rotor", rotor)
    },
    read: |reader| {
        let round = reader.form()? == 1;
        elastic(reader, |more_rotor| {
            Ok(Connection {
                stiffness: reader.has("stiffness").then(|| reader.number_above("stiffness", 0.0)).transpose()?,
                damping: reader.has("damping").then(|| reader.at_least_zero("damping")).transpose()?,
                halfgap: reader.at_least_zero("halfgap")?,
                more_rotor,
                hardening: f64::INFINITY,
                round,
            })
        })
    },
    #[cfg(test)]
    example: |bare| bare.with("halfgap", 0.01).with("rotor", 0.2),
    ..Fault::ON_A_JOINT
};
