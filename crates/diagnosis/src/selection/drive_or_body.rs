//! The inertia of a drive against that of a body on its link.
//!
//! Both have the same torque on the joint itself. A body also has one on the joints before it, a drive has none. The body here has inertia
//! about the joint's axis alone; any real one has more torque on the joints before.

use effects::Term;
use effects::arm::INERTIAL_PARAMETER;

use crate::regression::bodies::WITHOUT_MOMENTS;
use crate::search::study::Study;
use crate::selection::judge::{Judged, Member};
use crate::selection::predict::errors_with;
use crate::thresholds::{CHANGE_BESIDE_RESIDUAL, POOR, ROUNDING};

/// Whether the effect is a drive's inertia that changed, and a body with that inertia on its link would have a torque on each joint before it
/// that is less than the joint's error, which is that of a joint that is not explained. Then nothing says that it is the drive's. The first
/// joint has no joint before it.
pub fn may_be_a_body(study: &Study, judged: &Judged, member: &Member) -> bool {
    let candidate = &study.candidates[member.candidate];
    let (Some(joint), true) = (candidate.joint, candidate.hypothesis.is_drive_inertia()) else {
        return false;
    };
    // About a perpendicular axis, only rounding remains of it, so that such a joint tells nothing.
    let of = |before: usize| Some((before, share_of_body(study, judged, member, joint, before)?));
    let shares = || (0..joint).filter_map(of).filter(|(_, share)| *share > ROUNDING);
    let error = |before: usize| errors_with(&study.data, &study.table, &judged.named.fit, before).train_nrmse_augmented;
    let hides = |(before, share)| {
        let error = error(before);
        error >= POOR && share < CHANGE_BESIDE_RESIDUAL * error
    };
    study.changes(member.candidate) && shares().next().is_some() && shares().all(hides)
}

/// The torque on the joint `before` of a body on the link behind `joint` that has the inertia of the effect about the joint's axis,
/// over the standard deviation of the measured one; `None` if it has no column there.
fn share_of_body(study: &Study, judged: &Judged, member: &Member, joint: usize, before: usize) -> Option<f64> {
    let table = &study.table;
    let column = *study.candidates[member.candidate].columns.first()?;
    let inertia = judged.named.fit.coefficient(column);
    let axis = study.data.arm.joints()[joint].axis;
    // Those of Ixx, Ixy, Iyy, Ixz, Iyz, Izz.
    let pairs = [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)];
    let (mut columns, mut values) = (Vec::new(), Vec::new());
    for (k, (a, b)) in pairs.into_iter().enumerate() {
        let term = Term::about(&INERTIAL_PARAMETER, joint).of(WITHOUT_MOMENTS + k);
        columns.push(table.terms.iter().position(|known| *known == term)?);
        values.push(inertia * axis[a] * axis[b]);
    }
    columns.iter().any(|&column| table.place[before][column].is_some()).then_some(())?;
    let mut torque = table.torque(before, &columns, &values);
    // It acts when the effect does.
    let own = table.torque(joint, &[column], &[1.0]);
    torque.iter_mut().zip(own).filter(|(_, own)| *own == 0.0).for_each(|(torque, _)| *torque = 0.0);
    Some(study.data.share(before, table.spread(before, &study.data.fitted, &torque)))
}
