//! The elements between a joint's commanded torque and its link: delay, limit, scale, a spring, a gap.

use effects::{Machine, Sprung};

/// The stiffness of the end of a gap, as the phase of its oscillation per plant step (rad).
const STOP_PHASE: f64 = 0.5;
/// Damping ratio of that spring.
const STOP_DAMPING: f64 = 0.3;
/// The number of rotor steps per plant step.
const ROTOR_STEPS: usize = 8;

/// A flexible or loose connection of a joint's rotor to its link; the encoder is the rotor's.
pub(super) struct Connection {
    stiffness: f64,
    damping: f64,
    halfgap: f64,
    /// The rotor's inertia if it moves by itself (kg m² or kg); `None` if it moves with the link and the static deflection.
    rotor: Option<f64>,
    /// Angle and velocity of the rotor.
    theta: f64,
    theta_dot: f64,
}

impl Connection {
    /// The torque on the link at a deflection (rotor minus link) and its rate.
    fn torque(&self, deflection: f64, rate: f64) -> f64 {
        let stretched = deflection - deflection.clamp(-self.halfgap, self.halfgap);
        if stretched == 0.0 { 0.0 } else { self.stiffness * stretched + self.damping * rate }
    }

    /// The deflection under a constant torque.
    fn deflection(&self, torque: f64) -> f64 {
        let gap = if torque == 0.0 { 0.0 } else { self.halfgap.copysign(torque) };
        gap + torque / self.stiffness
    }

    /// Sets the rotor to an encoder's angle and velocity; returns the link's angle under the torque.
    pub(super) fn start(&mut self, theta: f64, theta_dot: f64, torque: f64) -> f64 {
        (self.theta, self.theta_dot) = (theta, theta_dot);
        theta - self.deflection(torque)
    }

    /// The mean torque on the link while the drive holds `torque` for `time` and the link moves from `q` at `qd` (rad, rad/s).
    pub(super) fn advance(&mut self, torque: f64, q: f64, qd: f64, qdd: f64, time: f64) -> f64 {
        let Some(inertia) = self.rotor else {
            let end = q + qd * time + 0.5 * qdd * time * time;
            self.theta = end + self.deflection(torque);
            return torque;
        };
        let part = time / ROTOR_STEPS as f64;
        let mut impulse = 0.0;
        for k in 0..ROTOR_STEPS {
            let link = q + qd * (k as f64 + 0.5) * part;
            // The rotor at the middle of the substep, so that energy is conserved.
            let middle = self.theta + 0.5 * part * self.theta_dot;
            let through = self.torque(middle - link, self.theta_dot - qd);
            self.theta_dot += part * (torque - through) / inertia;
            self.theta = middle + 0.5 * part * self.theta_dot;
            impulse += part * through;
        }
        impulse / time
    }

    /// The encoder's reading.
    pub(super) fn encoder(&self) -> f64 {
        self.theta
    }
}

/// The drives of all joints.
pub(super) struct Drives {
    /// Delays (s), one per joint.
    pub(super) delays: Vec<f64>,
    pub(super) connections: Vec<Option<Connection>>,
    pub(super) remarks: Vec<String>,
}

impl Drives {
    /// The drives of a machine. `rotors` and `links` are the inertias on either side of each joint (kg m² or kg), `names` the
    /// joints, `step` the plant's step (s).
    pub(super) fn new(machine: &Machine, names: &[String], rotors: &[f64], links: &[f64], step: f64) -> Self {
        let mut drives = Self {
            delays: machine.delays.clone(),
            connections: names.iter().map(|_| None).collect(),
            remarks: Vec::new(),
        };
        for (j, name) in names.iter().enumerate() {
            let (spring, gap) = (machine.springs[j], machine.gaps[j]);
            if spring.is_none() && gap == 0.0 {
                continue;
            }
            let lighter = rotors[j].min(links[j]);
            let Sprung { stiffness, damping } = spring.unwrap_or_else(|| {
                let stiffness = lighter * (STOP_PHASE / step).powi(2);
                let damping = 2.0 * STOP_DAMPING * (stiffness * lighter).sqrt();
                Sprung { stiffness, damping }
            });
            // Link and rotor are stepped in turn, which is stable and sufficiently exact while a step is a fraction of the
            // oscillation.
            let resolved = rotors[j] > 0.0 && stiffness * step * step <= lighter && damping * step <= lighter;
            if !resolved {
                drives.remarks.push(format!(
                    "{name}: the rotor is simulated as a part of the link, with the static deflection of the drive only ({})",
                    if rotors[j] > 0.0 {
                        "the spring is too stiff for the time step"
                    } else {
                        "no rotor inertia is known"
                    }
                ));
            }
            drives.connections[j] = Some(Connection {
                stiffness: if resolved || spring.is_some() { stiffness } else { f64::INFINITY },
                damping,
                halfgap: gap,
                rotor: resolved.then_some(rotors[j]),
                theta: 0.0,
                theta_dot: 0.0,
            });
        }
        drives
    }

    /// Whether the rotor of joint `j` moves by itself.
    pub(super) fn is_separate(&self, j: usize) -> bool {
        self.connections[j].as_ref().is_some_and(|connection| connection.rotor.is_some())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use arm::Arm;
    use effects::Effect;
    use effects::drive::{ACTUATION_DELAY, BACKLASH, JOINT_ELASTICITY};

    fn machine(effects: &[Effect]) -> Machine {
        let urdf = r#"<robot name="one"><link name="base"/>
<joint name="a" type="continuous"><parent link="base"/><child link="l"/><axis xyz="0 0 1"/></joint>
<link name="l"><inertial><mass value="1"/><inertia ixx=".1" ixy="0" ixz="0" iyy=".1" iyz="0" izz=".1"/></inertial></link></robot>"#;
        let arm = Arm::from_urdf_text(urdf, "one.urdf").expect("it is an arm");
        Machine::new(&arm, effects).expect("they are physical")
    }

    /// A rotor and a link on a spring, stepped in turn, oscillate at ω² = K (1/J + 1/M) and conserve energy.
    #[test]
    fn rotor_and_link_oscillate_as_two_bodies() {
        let (inertia, mass, stiffness, step) = (0.5, 1.0, 2000.0, 1e-3);
        let effects = [Effect::of(&JOINT_ELASTICITY).on("a").with("stiffness", stiffness).with("damping", 0.0)];
        let mut drives = Drives::new(&machine(&effects), &["a".into()], &[inertia], &[mass], step);
        assert!(drives.is_separate(0) && drives.remarks.is_empty());
        let connection = drives.connections[0].as_mut().expect("there is a spring");
        // Stretched by 0.01 and at rest: the link moves back by J/M times the rotor's motion.
        assert_eq!(connection.start(0.01, 0.0, 0.0), 0.01);
        let (mut q, mut qd) = (0.0, 0.0);
        let omega = (stiffness * (1.0 / inertia + 1.0 / mass)).sqrt();
        for k in 1..=1000 {
            let torque = connection.advance(0.0, q, qd, 0.0, step);
            q += qd * step + 0.5 * torque / mass * step * step;
            qd += torque / mass * step;
            let expected = 0.01 * (omega * f64::from(k) * step).cos();
            assert!((connection.encoder() - q - expected).abs() < 2e-4, "{k}: {} {expected}", connection.encoder() - q);
        }
    }

    #[test]
    fn a_rotor_without_inertia_is_deflected() {
        let effects = [
            Effect::of(&JOINT_ELASTICITY).on("a").with("stiffness", 100.0).with("damping", 1.0),
            Effect::of(&BACKLASH).on("a").with("halfgap", 0.01),
            Effect::of(&ACTUATION_DELAY).on("a").with("delay", 0.004),
        ];
        let mut drives = Drives::new(&machine(&effects), &["a".into()], &[0.0], &[1.0], 1e-3);
        assert_eq!(drives.delays, [0.004]);
        assert_eq!(drives.remarks.len(), 1);
        let connection = drives.connections[0].as_mut().expect("there is a spring");
        assert_eq!(connection.start(0.5, 0.0, -2.0), 0.5 + 0.01 + 0.02);
        assert_eq!(connection.advance(3.0, 0.0, 0.0, 0.0, 1e-3), 3.0);
        assert_eq!(connection.encoder(), 0.01 + 0.03);
    }
}
