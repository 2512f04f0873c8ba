//! A spring between the rotor of a drive and its link.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "joint_elasticity",
    forms: &["hardening"],
    form_parameters: &["hardening_torque"],
    more_parameters: &["rotor"],
    leaves: Leaves::Rotor,
    similar_faults: Some(SimilarFaults::BetweenCommandAndLink),
    draw: |bare, at, random| {
        let (link, own) = (at.link_inertia(), at.rotor_inertia());
        let rotor = if own > 0.0 { own } else { link * random.random_range(0.5..1.2) };
        // Gearboxes are stiffer than is easily detectable; a draw that is not detectable is repeated.
        let frequency: f64 =
            if at.lifelike { TAU * log_uniform(5.0, 40.0, random) } else { random.random_range(18.0..45.0) };
        let stiffness = rotor.max(if own > 0.0 { link } else { 0.0 }) * frequency * frequency;
        let hardens = at.hard && random.random_bool(0.5);
        let elastic =
            bare.with("stiffness", stiffness).with("damping", 0.08 * (stiffness * rotor).sqrt()).with("rotor", rotor);
        if hardens { elastic.formed("hardening").with("hardening_torque", 6.0 * at.spread()) } else { elastic }
    },
    read: |reader| {
        let hardens = reader.form()? == 1;
        elastic(reader, |more_rotor| {
            Ok(Connection {
                stiffness: Some(reader.number_above("stiffness", 0.0)?),
                damping: Some(reader.at_least_zero("damping")?),
                halfgap: 0.0,
                more_rotor,
                hardening: if hardens { reader.number_above("hardening_torque", 0.0)? } else { f64::INFINITY },
                round: false,
            })
        })
    },
    #[cfg(test)]
    example: |bare| {
        bare.with("stiffness", 160.0).with("damping", 0.4).with("rotor", 0.2).with("hardening_torque", 20.0)
    },
    ..Fault::ON_A_JOINT
};

/// The connection between rotor and link, and the rotor, which moves with its link before the onset of the spring. The
/// connection receives the inertia that the rotor has in addition to the drive's known inertia (kg m²).
pub(super) fn elastic(
    reader: &Reader<'_>,
    connection: impl FnOnce(f64) -> Result<Connection, FaultError>,
) -> Result<Vec<Piece>, FaultError> {
    let joint = reader.joint()?;
    let own = reader.arm.joints()[joint].rotor_inertia;
    let rotor = reader.number_or("rotor", own)?;
    if rotor < own {
        return Err(reader.fail(format!("rotor is {rotor}; the drive alone has {own} kg m²")));
    }
    let more_rotor = rotor - own;
    Ok(vec![
        Property::Body(Body::Rotor(joint, more_rotor)).in_both_machines(),
        Property::Elastic(joint, connection(more_rotor)?).into(),
    ])
}
