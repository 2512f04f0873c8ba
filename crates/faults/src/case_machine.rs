//! The true machine of a case under an external controller.

use crate::error::FaultError;
use crate::machine::{Begin, Inverse, LinkMotion, Machine, Measured};
use crate::robot::Robot;
use crate::truth::{Injected, Truth};

/// The machine on which a case's recordings were made.
///
/// Its time is the recordings' clock: effects with an earlier onset are present, drives are warm, and a contact acts
/// only in its window.
pub struct CaseMachine<'a> {
    machine: Machine<'a>,
    robot: &'a Robot,
    quantum: f64,
}

/// A run of a machine; `[tick × dof + joint]`, ticks of 1 ms.
#[derive(Clone, Debug, PartialEq)]
pub struct Driven {
    /// True positions of the links (rad or m), which no encoder measures.
    pub links: Vec<f64>,
    /// Positions that the encoders report (rad or m).
    pub q: Vec<f64>,
    /// Commanded torques (N m or N).
    pub tau: Vec<f64>,
}

impl<'a> CaseMachine<'a> {
    /// The machine of `truth`, a case that was drawn on `robot`.
    ///
    /// # Errors
    /// [`FaultError::Setting`] if the truth belongs to another robot, [`FaultError::Effect`] if an effect does not fit
    /// this robot.
    pub fn new(robot: &'a Robot, truth: &Truth) -> Result<Self, FaultError> {
        if truth.robot != robot.name() {
            let (case, its, name) = (&truth.case, &truth.robot, robot.name());
            let reason = format!("{case} is of the robot \"{its}\", not of \"{name}\"; give the robot it was drawn on");
            return Err(FaultError::Setting(reason));
        }
        let effects: Vec<&Injected> = truth.injected.iter().filter(|effect| !robot.has_by_itself(effect)).collect();
        Ok(Self { machine: Machine::new(robot, &effects, None)?, robot, quantum: truth.encoder_quantum })
    }

    /// Runs the machine for `ticks` ticks of 1 ms from `start` (s). It begins at rest with its encoders at `q` (rad or
    /// m), under the torque that would hold the robot of the user's model. Once per tick, `controller` receives the
    /// encoders and returns torques (N m or N).
    ///
    /// # Errors
    /// [`FaultError::Plant`] if the motion exceeds all bounds.
    ///
    /// # Panics
    /// If `q` is of another size than the arm.
    pub fn drive(
        &self,
        start: f64,
        q: &[f64],
        ticks: usize,
        mut controller: impl FnMut(&Measured<'_>, &mut [f64]),
    ) -> Result<Driven, FaultError> {
        let arm = self.robot.arm();
        let mut holding = vec![0.0; arm.dof()];
        arm.gravity_torque(&mut arm::Workspace::new(arm), q, &mut holding);
        let begin = Begin { time: start, q, holding: &holding };
        let (run, links) = self.machine.drive(&begin, self.quantum, ticks, &mut controller)?;
        Ok(Driven { links, q: run.q, tau: run.tau })
    }

    /// The torques that a motion of the links requires by the machine's own laws: the exact model.
    ///
    /// Dry friction has the sign of the velocity and is zero at rest. Contacts, which are events, gaps and torque limits, which
    /// no torque compensates, and the damping of springs are omitted. States with memory start as in a run.
    pub fn inverse(&self, motion: &LinkMotion<'_>) -> Inverse {
        self.machine.inverse(motion)
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::motion::{LEAD_TICKS, excitation};
    use crate::test_robots::{puma, seven_axis};

    fn truth(robot: &Robot, injected: Vec<Injected>) -> Truth {
        Truth {
            case: "case_000".into(),
            robot: robot.name().into(),
            seed: 0,
            injected,
            background_friction: false,
            torque_noise: vec![0.0; robot.arm().dof()],
            encoder_quantum: 1e-5,
            period: 1e-3,
            urdf_sigma: None,
            lifelike: None,
        }
    }

    /// RMS distance of the links from the reference with the feed-forward of the user's model, and with that of the
    /// machine's own laws.
    fn errors(robot: &Robot, injected: Vec<Injected>) -> [f64; 2] {
        let machine = CaseMachine::new(robot, &truth(robot, injected)).expect("the effects fit");
        let reference = excitation(robot, 60.0, &mut ChaCha8Rng::seed_from_u64(5)).first_seconds(4.0);
        let n = robot.arm().dof();
        let start = reference.time(0);
        let inverse = machine.inverse(&LinkMotion { start, q: &reference.q, qd: &reference.qd, qdd: &reference.qdd });
        let beyond = vec![0.0; inverse.beyond.len()];
        [(&reference.ff, &beyond), (&inverse.tau, &inverse.beyond)].map(|(ff, beyond)| {
            let begin: Vec<f64> = (0..n).map(|j| reference.q[j] + beyond[j]).collect();
            let driven = machine
                .drive(start, &begin, reference.ticks(), |seen, torque| {
                    for (j, torque) in torque.iter_mut().enumerate() {
                        let at = seen.tick * n + j;
                        let (p, d) = (400.0 * robot.inertia(j), 32.0 * robot.inertia(j));
                        *torque = ff[at]
                            + p * (reference.q[at] + beyond[at] - seen.q[j])
                            + d * (reference.qd[at] - seen.qd[j]);
                    }
                })
                .expect("it can be driven");
            let squares = driven.links.iter().zip(&reference.q).skip(n * LEAD_TICKS);
            (squares.map(|(q, wanted)| (wanted - q).powi(2)).sum::<f64>() / (reference.ticks() - LEAD_TICKS) as f64)
                .sqrt()
        })
    }

    /// The machine follows its own inverse model with every fault: with forms that the catalogue does not have, with
    /// memory, and with a spring.
    #[test]
    fn the_machine_follows_its_own_inverse() {
        let robot = seven_axis();
        let on = |effect: &str| Injected::new(effect, Some("axis4"));
        let level = |effect: &str| on(effect).with("amplitude", 4.0);
        for effect in [
            on("quadratic_drag").with("coefficient", 8.0).formed("power"),
            on("spring").with("stiffness", 30.0).with("rest", 0.6).formed("gas spring"),
            on("encoder_offset").with("offset", 0.05),
            on("torque_scale").with("factor", 1.5),
            level("hysteresis_unknown").with("scale", 0.1).with("shape", 0.6),
            level("history_unknown").with("time_constant", 1.0),
            Injected::new("payload", None).with("mass", 2.0).with("com", serde_json::json!([0.0, 0.0, 0.1])),
        ] {
            let [nominal, exact] = errors(&robot, vec![effect.clone()]);
            assert!(exact < 0.2 * nominal, "{effect:?}: {exact} {nominal}");
        }
    }

    /// The drives' inertias are those of the robot, whether the truth lists them or not; a truth of another robot is
    /// refused.
    #[test]
    fn rotor_inertias_of_the_robot_are_not_injected_twice() {
        let robot = puma();
        let joints = robot.arm().joints().iter().zip(robot.rotor_inertias());
        let drives: Vec<Injected> = joints
            .map(|(joint, &inertia)| Injected::new("rotor_inertia", Some(&joint.name)).with("inertia", inertia))
            .collect();
        assert_eq!(errors(&robot, drives), errors(&robot, Vec::new()));
        assert!(CaseMachine::new(&seven_axis(), &truth(&robot, Vec::new())).is_err());
    }
}
