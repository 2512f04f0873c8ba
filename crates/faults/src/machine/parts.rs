//! The parts of a machine, sorted by where they act.

use arm::Arm;

use crate::part::{Body, Connection, Contact, DriveLaw, DryLaw, LinkLaw, Part, Property};

/// The parts on each joint's drive, and the parts on the whole machine.
pub(super) struct Parts {
    joints: Vec<Joint>,
    pub(super) links: Vec<OnLink>,
    couplings: Vec<(usize, usize, f64, f64)>,
    bodies: Vec<(Body, f64)>,
    pub(super) contacts: Vec<Contact>,
    /// Factor of each joint's dry friction.
    pub(super) friction: Vec<f64>,
}

/// A law that acts on the link's side of a joint.
pub(super) struct OnLink {
    pub joint: usize,
    pub law: Box<dyn LinkLaw>,
    /// Its onset (s).
    pub onset: f64,
}

#[derive(Default)]
struct Joint {
    dry: Vec<(Box<dyn DryLaw>, f64)>,
    smooth: Vec<(Box<dyn DriveLaw>, f64)>,
    drive: Vec<(Property, f64)>,
}

/// The properties of a drive at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DriveNow {
    /// The ratio of the reported to the true torque.
    pub factor: f64,
    /// The torque limit (N m or N), as it is reported.
    pub limit: f64,
    pub soft: bool,
    /// The time constant (s).
    pub delay: f64,
    pub lags: bool,
}

impl Parts {
    pub(super) fn new(parts: Vec<Part>, dof: usize) -> Self {
        let mut sorted = Self {
            joints: (0..dof).map(|_| Joint::default()).collect(),
            links: Vec::new(),
            couplings: Vec::new(),
            bodies: Vec::new(),
            contacts: Vec::new(),
            friction: vec![1.0; dof],
        };
        for Part { onset, what } in parts {
            match what {
                Property::Dry(j, law) => sorted.joints[j].dry.push((law, onset)),
                Property::Drive(j, law) => sorted.joints[j].smooth.push((law, onset)),
                Property::Link(joint, law) => sorted.links.push(OnLink { joint, law, onset }),
                Property::CouplingInertia(j, o, inertia) => sorted.couplings.push((j, o, inertia, onset)),
                Property::Body(body) => sorted.bodies.push((body, onset)),
                Property::Contact(contact) => sorted.contacts.push(contact),
                Property::Scale(j, _)
                | Property::Limit(j, ..)
                | Property::Delay(j, ..)
                | Property::Encoder(j, _)
                | Property::Elastic(j, _) => sorted.joints[j].drive.push((what, onset)),
            }
        }
        // Payloads are not scaled with the links.
        sorted.bodies.sort_by_key(|(body, _)| matches!(body, Body::Payload(_)));
        sorted
    }

    /// `arm` with the changed bodies that are present at `time` (s).
    pub(super) fn arm_at(&self, arm: Arm, time: f64) -> Arm {
        let there = self.bodies.iter().filter(|(_, onset)| time >= *onset);
        there.fold(arm, |arm, (body, _)| body.applied_to(arm))
    }

    /// The inertia of the rotor of joint `j`, from the start, in addition to the known inertia of its drive (kg m²).
    pub(super) fn more_rotor(&self, j: usize) -> f64 {
        let of = |(body, onset): &(Body, f64)| match body {
            Body::Rotor(joint, inertia) if *joint == j && *onset == f64::NEG_INFINITY => *inertia,
            _ => 0.0,
        };
        self.bodies.iter().map(of).sum()
    }

    /// The time of the arm's next change after `time` (s); infinite if there is none.
    pub(super) fn next_change(&self, time: f64) -> f64 {
        let bodies = self.bodies.iter().map(|(_, onset)| *onset);
        let elastic = self.joints.iter().flat_map(|joint| &joint.drive);
        let elastic = elastic.filter(|(what, _)| matches!(what, Property::Elastic(..)));
        bodies.chain(elastic.map(|(_, onset)| *onset)).filter(|onset| *onset > time).fold(f64::INFINITY, f64::min)
    }

    /// The connection between rotor and link of joint `j`: springs and gaps combined.
    pub(super) fn connection_at(&self, j: usize, time: f64) -> Option<Connection> {
        self.drive(j, time).fold(None, |found: Option<Connection>, what| match what {
            Property::Elastic(_, connection) => Some(match found {
                None => *connection,
                Some(found) => Connection {
                    stiffness: found.stiffness.or(connection.stiffness),
                    damping: found.damping.or(connection.damping),
                    halfgap: found.halfgap + connection.halfgap,
                    more_rotor: found.more_rotor,
                    hardening: found.hardening.min(connection.hardening),
                    round: found.round || connection.round,
                },
            }),
            _ => found,
        })
    }

    fn drive(&self, j: usize, time: f64) -> impl Iterator<Item = &Property> {
        let drive = self.joints[j].drive.iter();
        drive.filter(move |(_, onset)| time >= *onset).map(|(what, _)| what)
    }

    pub(super) fn drive_at(&self, j: usize, time: f64) -> DriveNow {
        let mut now = DriveNow { factor: 1.0, limit: f64::INFINITY, soft: false, delay: 0.0, lags: false };
        for what in self.drive(j, time) {
            match *what {
                Property::Scale(_, factor) => now.factor *= factor,
                Property::Limit(_, limit, soft) => {
                    now.limit = now.limit.min(limit);
                    now.soft = soft;
                }
                Property::Delay(_, delay, lags) => {
                    now.delay += delay;
                    now.lags = lags;
                }
                _ => {}
            }
        }
        now
    }

    /// The error of the encoder of joint `j` (rad or m).
    pub(super) fn encoder(&self, j: usize, time: f64) -> f64 {
        let offset = |what: &Property| {
            if let Property::Encoder(_, offset) = what { *offset } else { 0.0 }
        };
        self.drive(j, time).map(offset).sum()
    }

    pub(super) fn dry(&self, j: usize, time: f64) -> impl Iterator<Item = &dyn DryLaw> {
        let dry = self.joints[j].dry.iter();
        dry.filter(move |(_, onset)| time >= *onset).map(|(law, _)| law.as_ref())
    }

    pub(super) fn smooth(&self, j: usize, time: f64) -> impl Iterator<Item = &dyn DriveLaw> {
        let smooth = self.joints[j].smooth.iter();
        smooth.filter(move |(_, onset)| time >= *onset).map(|(law, _)| law.as_ref())
    }

    pub(super) fn depends_on_rigid_load(&self) -> bool {
        let mut dry = self.joints.iter().flat_map(|joint| &joint.dry);
        dry.any(|(law, _)| law.depends_on_rigid_load())
    }

    /// Joint, other joint and inertia of the drives that two joints move.
    pub(super) fn couplings(&self, time: f64) -> impl Iterator<Item = (usize, usize, f64)> {
        let there = self.couplings.iter().filter(move |coupling| time >= coupling.3);
        there.map(|&(j, o, inertia, _)| (j, o, inertia))
    }
}
