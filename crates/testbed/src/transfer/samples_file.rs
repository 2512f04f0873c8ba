//! The samples of tasks as CSV, on which the models are trained and tested.

use std::fmt::Write;
use std::path::Path;

use anyhow::Context;
use torque::{Prediction, RigidBody, Samples, TorqueModel, Workspace};

use crate::output;
use crate::scenario::Scenario;

/// Writes `samples`, one set per task, to files with `names` in `folder`: positions, velocities, accelerations,
/// torques and the torques of the nominal rigid body, joint by joint.
///
/// # Errors
/// If a file cannot be written.
pub fn write(folder: &Path, scenario: &Scenario, names: &[String], samples: &[Samples]) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder).with_context(|| format!("{}: the folder cannot be made", folder.display()))?;
    let model = RigidBody::new(scenario.nominal_arm());
    let dof = model.dof();
    let mut workspace = Workspace::new(dof);
    let mut rigid = Prediction::new(dof);
    for (name, samples) in names.iter().zip(samples) {
        let columns = ["q", "qd", "qdd", "tau", "rigid"];
        let header = columns.iter().flat_map(|column| (1..=dof).map(move |joint| format!("{column}_{joint}")));
        let mut text = header.collect::<Vec<_>>().join(",");
        text.push('\n');
        for sample in samples.iter() {
            model.predict(&mut workspace, sample.q, sample.qd, sample.qdd, &mut rigid);
            let values = [sample.q, sample.qd, sample.qdd, sample.tau, &rigid.rigid].concat();
            for (index, value) in values.iter().enumerate() {
                let comma = if index == 0 { "" } else { "," };
                write!(text, "{comma}{value:?}")?;
            }
            text.push('\n');
        }
        output::write_text(&folder.join(format!("{name}.csv")), &text)?;
    }
    Ok(())
}
