//! A case recorded once more, along a motion that somebody asks for.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use recording::Recording;

use crate::campaign::CasePlan;
use crate::conceal::{AGAIN, TRAINING};
use crate::error::FaultError;
use crate::machine::{Machine, TICK};
use crate::motion::{LEAD, Reference, start};
use crate::robot::Robot;
use crate::sensor::Sensors;
use crate::truth::{Injected, Truth};

/// Drives the machine of a drawn case along `motion`, which writes the positions (rad or m, base to tip) of a time (s, from 0
/// to `duration`), and records it with the case's own sensors and clock, after all that is recorded of it.
///
/// # Errors
/// [`FaultError::Lost`] if the position loop cannot hold the machine on that motion; [`FaultError::Effect`] if the truth is
/// not of this robot.
pub fn record_again(
    robot: &Robot,
    plan: &CasePlan,
    truth: &Truth,
    duration: f64,
    motion: &mut dyn FnMut(f64, &mut [f64]),
) -> Result<Recording, FaultError> {
    let n = robot.arm().dof();
    let ticks = LEAD + (duration / TICK).round() as usize + 1;
    let mut q = vec![0.0; ticks * n];
    for (tick, q) in q.chunks_mut(n).enumerate() {
        // Before the recording the loop settles where the motion begins.
        motion((tick as f64 - LEAD as f64).max(0.0) * TICK, q);
    }
    // After the training recordings and the one held out.
    let reference = Reference::new(robot.arm(), start(TRAINING[usize::from(plan.hard)] + 1), q);
    let effects: Vec<&Injected> = truth.concealed.iter().filter(|effect| !robot.brings(effect)).collect();
    let run = Machine::new(robot, &effects, None)?.run(&reference, truth.encoder_quantum)?;
    let sensors = Sensors {
        ticks: (truth.period / TICK).round() as usize,
        jitter: plan.hard,
        lost: plan.hard,
        quantum: truth.encoder_quantum,
        noise: truth.torque_noise.clone(),
    };
    let mut noise = ChaCha8Rng::seed_from_u64(truth.seed);
    noise.set_stream(AGAIN);
    Ok(sensors.record(robot, &reference, &run, &mut noise))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::Campaign;
    use crate::conceal::conceal_case;
    use crate::test_robots::puma;

    /// The machine is the case's own: along the same motion it needs the torques that were recorded, but for the noise.
    #[test]
    fn a_case_is_recorded_again_as_it_was() {
        let robot = puma();
        let mut plan = Campaign { seed: 5, cases: 4 }.case(0).expect("there is one");
        plan.effects = vec!["quadratic_drag".into()];
        plan.hard = false;
        let concealment = conceal_case(&robot, &plan).expect("it is concealed");
        let first = &concealment.train[0];
        let n = first.joints.len();
        let at = |time: f64, q: &mut [f64]| {
            let x = time / 0.004;
            let (row, part) = ((x.floor() as usize).min(first.len() - 2), x - x.floor());
            for (j, q) in q.iter_mut().enumerate() {
                *q = first.q[j][row] + part * (first.q[j][row + 1] - first.q[j][row]);
            }
        };
        let mut at = at;
        let again = record_again(&robot, &plan, &concealment.truth, 20.0, &mut at).expect("it is recorded");
        assert_eq!(again.joints, first.joints);
        assert!(again.time[0] > concealment.held_out.time[concealment.held_out.len() - 1]);
        // Slow torques: the reference is what encoders counted, whose steps differentiation makes large.
        let mean = |tau: &[f64]| tau[1000..4000].iter().sum::<f64>() / 3000.0;
        for j in 0..n {
            let (was, is) = (mean(&first.tau[j]), mean(&again.tau[j]));
            let noise = concealment.truth.torque_noise[j];
            assert!((was - is).abs() < 3.0 * noise + 0.02 * was.abs(), "{j}: {was} {is}");
        }
        let mut same = |time: f64, q: &mut [f64]| at(time, q);
        let twice = record_again(&robot, &plan, &concealment.truth, 20.0, &mut same).expect("it is recorded");
        assert_eq!(again, twice);
    }
}
