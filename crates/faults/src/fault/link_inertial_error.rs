//! A link whose mass and inertia differ from the URDF's by a factor; or whose centre of mass and extent differ as
//! well.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "link_inertial_error",
    forms: &["moved"],
    form_parameters: &["shift", "stretch"],
    joints: EligibleJoints::OuterJoints,
    draw: |bare, at, random| {
        let part = random.random_range(if at.hard { 0.08..0.4 } else { 0.12..0.4 });
        let bare = bare.with("relative", part * sign(random));
        if !(at.hard || at.lifelike) || random.random_bool(0.5) {
            return bare;
        }
        let mut shift = || random.random_range(-0.03..0.03);
        let shift = [shift(), shift(), shift()];
        let mut stretch = || log_uniform(0.8, 1.25, random);
        let stretch = [stretch(), stretch(), stretch()];
        bare.formed("moved").with("shift", json!(shift)).with("stretch", json!(stretch))
    },
    read: |reader| {
        let (joint, factor) = (reader.joint()?, 1.0 + reader.number_above("relative", -1.0)?);
        if reader.form()? == 0 {
            return Ok(vec![Body::changed(move |arm| arm.with_scaled_link(joint, factor))]);
        }
        let (shift, stretch) = (reader.numbers("shift")?, reader.numbers("stretch")?);
        if stretch.iter().any(|&stretch| stretch <= 0.0) {
            return Err(reader.fail(format!("stretch is {stretch:?}; give three factors above 0")));
        }
        Ok(vec![Body::changed(move |arm| {
            let body = moved(&arm.joints()[joint].inertia, factor, shift, stretch);
            arm.with_link_inertia(joint, body)
        })])
    },
    #[cfg(test)]
    example: |bare| {
        bare.with("relative", 0.3).with("shift", json!([0.02, -0.01, 0.03])).with("stretch", json!([1.2, 0.9, 1.1]))
    },
    ..Fault::ON_A_JOINT
};
