//! A motion of a small arm, and the check that an effect's columns and its torque in a machine are the same law.

use ::arm::{Arm, PARAMETERS_PER_LINK, Vector3, Workspace};
use nalgebra::DMatrix;

use crate::machine::Circumstance;
use crate::{Base, Effect, Machine, OnLinks, Rigid, Scales, Signals, State, Term, sign};

/// An arm of two joints, with the tool 0.5 m beyond the second.
const URDF: &str = r#"<robot name="two"><link name="base"/>
<joint name="a" type="continuous"><parent link="base"/><child link="la"/><axis xyz="0 1 0"/></joint>
<link name="la"><inertial><origin xyz=".5 0 0"/><mass value="1"/><inertia ixx=".1" ixy="0" ixz="0" iyy=".1" iyz="0" izz=".2"/></inertial></link>
<joint name="b" type="continuous"><origin xyz="1 0 0"/><parent link="la"/><child link="lb"/><axis xyz="0 0 1"/></joint>
<link name="lb"><inertial><origin xyz=".2 .1 0"/><mass value="2"/><inertia ixx=".1" ixy="0" ixz="0" iyy=".1" iyz="0" izz=".3"/></inertial></link>
<joint name="f" type="fixed"><origin xyz=".5 0 0"/><parent link="lb"/><child link="tool"/></joint><link name="tool"/></robot>"#;

const TICKS: usize = 100;
const PERIOD: f64 = 0.01;

fn arm() -> Arm {
    Arm::from_urdf_text(URDF, "test.urdf").expect("it is an arm")
}

/// The machine of the test's arm with one effect.
pub fn machine(effect: &Effect) -> Machine {
    Machine::new(&arm(), std::slice::from_ref(effect)).expect("it is physical")
}

/// Position, velocity and acceleration of both joints at a tick. They move in opposite directions, and never slowly.
fn state(tick: usize) -> [[f64; 2]; 3] {
    let t = tick as f64 * PERIOD;
    let (s, c) = (2.0 * t).sin_cos();
    [[0.3 + 1.5 * t + 0.2 * s, -0.8 - 2.0 * t], [1.5 + 0.4 * c, -2.0], [-0.8 * s, 0.0]]
}

/// A signal of two joints, tick by tick.
fn signals(pick: impl Fn(usize) -> [f64; 2]) -> Vec<Vec<f64>> {
    (0..2).map(|joint| (0..TICKS).map(|tick| pick(tick)[joint]).collect()).collect()
}

/// The torque of the motion (N m).
fn torque(arm: &Arm, [q, qd, qdd]: [[f64; 2]; 3]) -> [f64; 2] {
    let mut tau = [0.0; 2];
    arm.inverse_dynamics(&mut Workspace::new(arm), &q, &qd, &qdd, &mut tau);
    tau
}

/// The derivative of the torque with respect to a change of the arm or the motion, at a tick.
fn derivative(change: &dyn Fn(f64, &mut [[f64; 2]; 3]) -> Arm, tick: usize) -> [f64; 2] {
    const STEP: f64 = 1e-5;
    let at = |by: f64| {
        let mut state = state(tick);
        let arm = change(by, &mut state);
        torque(&arm, state)
    };
    let (plus, minus) = (at(STEP), at(-STEP));
    [0, 1].map(|joint| (plus[joint] - minus[joint]) / (2.0 * STEP))
}

/// Calls `visit` with the motion of the test's arm and the model along it.
pub fn along<T>(visit: impl FnOnce(&Signals<'_>) -> T) -> T {
    let arm = arm();
    let nominal = arm.inertial_parameters();
    let tau = signals(|tick| torque(&arm, state(tick)));
    let square = |pick: &dyn Fn(usize, usize) -> [f64; 2]| -> Vec<Vec<Vec<f64>>> {
        let by: Vec<Vec<Vec<f64>>> = (0..2).map(|by| signals(|tick| pick(by, tick))).collect();
        (0..2).map(|joint| by.iter().map(|by| by[joint].clone()).collect()).collect()
    };
    let regressor = |tick: usize| {
        let [q, qd, qdd] = state(tick);
        let mut regressor = DMatrix::zeros(2, 2 * PARAMETERS_PER_LINK);
        arm.torque_regressor(&mut Workspace::new(&arm), &q, &qd, &qdd, &mut regressor);
        regressor
    };
    let links = square(&|link, tick| {
        let regressor = regressor(tick);
        let from = link * PARAMETERS_PER_LINK;
        [0, 1].map(|joint| (0..PARAMETERS_PER_LINK).map(|k| regressor[(joint, from + k)] * nominal[from + k]).sum())
    });
    // A body's torque is linear in its parameters about the tool: those of unit mass, of unit first moments, and so on.
    let payload: Vec<Vec<Vec<f64>>> = {
        let with = |parameters: [f64; 10]| {
            let heavy = arm.clone().with_payload(&crate::arm::body(&parameters));
            signals(|tick| torque(&heavy, state(tick)))
        };
        let bare = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let of_mass = with(bare);
        let column = |parameter: usize| {
            let mut parameters = bare;
            parameters[parameter] += if parameter == 0 { 0.0 } else { 1.0 };
            let from = if parameter == 0 { &tau } else { &of_mass };
            let with = with(parameters);
            let less = |joint: usize| with[joint].iter().zip(&from[joint]).map(|(a, b)| a - b).collect::<Vec<f64>>();
            [less(0), less(1)]
        };
        let columns: Vec<[Vec<f64>; 2]> = (0..10).map(column).collect();
        (0..2).map(|joint| columns.iter().map(|column| column[joint].clone()).collect()).collect()
    };
    let moved = |which: usize| {
        let arm = &arm;
        square(&move |by, tick| {
            let change = |step: f64, state: &mut [[f64; 2]; 3]| {
                state[which][by] += step;
                arm.clone()
            };
            derivative(&change, tick)
        })
    };
    let tilts: Vec<Vec<Vec<f64>>> = [Vector3::x(), Vector3::y()]
        .map(|axis| {
            let turned =
                |step: f64, _: &mut [[f64; 2]; 3]| arm.clone().with_turned_base(axis * step.signum(), step.abs());
            signals(|tick| derivative(&turned, tick))
        })
        .to_vec();
    let tilt: Vec<[Vec<f64>; 2]> = (0..2).map(|joint| [tilts[0][joint].clone(), tilts[1][joint].clone()]).collect();
    let weightless = |tick: usize| torque(&arm.clone().with_gravity(Vector3::zeros()), state(tick));
    let along = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| {
        let pulled = arm.clone().with_gravity(axis);
        signals(|tick| {
            let (with, without) = (torque(&pulled, state(tick)), weightless(tick));
            [0, 1].map(|joint| with[joint] - without[joint])
        })
    });
    let gravity: Vec<[Vec<f64>; 3]> =
        (0..2).map(|joint| [0, 1, 2].map(|axis: usize| along[axis][joint].clone())).collect();
    let ones = || vec![1.0; TICKS];
    let force: Vec<[Vec<f64>; 3]> = (0..2).map(|_| [ones(), ones(), ones()]).collect();
    let (by_position, by_velocity, mass) = (moved(0), moved(1), moved(2));
    let [q, qd, qdd] = [0, 1, 2].map(|which| signals(|tick| state(tick)[which]));
    let scales = Scales {
        speed: vec![2.0; 2],
        rest: vec![1e-9; 2],
        turning: vec![3e-10; 2],
        swept: vec![2.0; 2],
        middle: vec![0.0; 2],
        range: vec![2.0; 2],
        torque: vec![1.0; 2],
    };
    visit(&Signals {
        recording: 0,
        start: 0.0,
        period: PERIOD,
        q: &q,
        qd: &qd,
        qdd: &qdd,
        tau: &tau,
        known: &[],
        rigid: Rigid {
            tau: &tau,
            rotors: &[],
            rest: &[],
            on_links: &OnLinks::default(),
            links: &links,
            payload: &payload,
            fixed_bodies: &[],
            by_position: &by_position,
            by_velocity: &by_velocity,
            mass: &mass,
            tilt: &tilt,
            gravity: &gravity,
            force: &force,
            tool: &[ones(), ones(), ones()],
            base: &Base::default(),
        },
        scales: &scales,
    })
}

/// A column on a joint, and the joint's torque.
pub fn column(term: &Term, joint: usize) -> (Vec<f64>, Vec<f64>) {
    along(|motion| {
        let column = term.column(joint, motion).expect("it acts on the joint");
        (column, motion.tau[joint].clone())
    })
}

/// Asserts that columns times coefficients equal the torque that a machine with the effect needs in addition to the arm's.
#[track_caller]
pub fn agree(effect: &Effect, columns: &[(Term, f64)]) {
    let machine = machine(effect);
    let mut arm = machine.arm.clone().with_rotor_inertias(&machine.rotors);
    for (_, payload) in &machine.payloads {
        arm = arm.with_payload(payload);
    }
    along(|motion| {
        for joint in 0..2 {
            let fitted: Vec<Option<Vec<f64>>> = columns.iter().map(|(term, _)| term.column(joint, motion)).collect();
            for tick in 0..motion.ticks() {
                let [mut q, qd, qdd] = state(tick);
                let said = q;
                for (q, offset) in q.iter_mut().zip(&machine.encoder_offsets) {
                    *q += offset;
                }
                let at = Circumstance { time: Some(motion.time(tick)), load: motion.load(joint, tick) };
                let mut needed = torque(&arm, [q, qd, qdd])[joint] - motion.rigid.tau[joint][tick];
                for (_, dry) in machine.dry.iter().filter(|(on, _)| *on == joint) {
                    let direction = sign(qd[joint]);
                    needed += direction * dry.level(qd[joint], at) + direction.abs() * dry.bias();
                }
                let now = State { q: &said, qd: &qd, qdd: &qdd };
                needed += machine
                    .smooth
                    .iter()
                    .filter(|smooth| smooth.joint == joint)
                    .map(|smooth| smooth.torque(now))
                    .sum::<f64>();
                let found: f64 = fitted
                    .iter()
                    .zip(columns)
                    .map(|(column, (_, value))| column.as_ref().map_or(0.0, |column| value * column[tick]))
                    .sum();
                assert!((found - needed).abs() < 1e-9, "joint {joint}, tick {tick}: {found} is not {needed}");
            }
        }
    });
}
