//! Another recording of a case, along a given motion.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use recording::Recording;

use crate::campaign::CasePlan;
use crate::conceal::{RECORD_AGAIN, TRAINING};
use crate::error::FaultError;
use crate::machine::Machine;
use crate::motion::{LEAD_TICKS, Reference, TICK, start};
use crate::robot::Robot;
use crate::sensor::Sensors;
use crate::truth::{Injected, Truth};

/// Runs the machine of a drawn case along `motion`, which writes the positions (rad or m, base to tip) at a time (s,
/// from 0 to `duration`), and records it with the sensors and the clock of the case, after all its other recordings.
/// # Errors
/// [`FaultError::Lost`] if the position loop cannot hold the machine on that motion; [`FaultError::Effect`] if the
/// truth does not fit this robot.
pub fn record_again(
    robot: &Robot,
    plan: &CasePlan,
    truth: &Truth,
    duration: f64,
    motion: &mut dyn FnMut(f64, &mut [f64]),
) -> Result<Recording, FaultError> {
    let n = robot.arm().dof();
    let ticks = LEAD_TICKS + (duration / TICK).round() as usize + 1;
    let mut q = vec![0.0; ticks * n];
    for (tick, q) in q.chunks_mut(n).enumerate() {
        // Before the recording, the loop settles at the beginning of the motion.
        motion((tick as f64 - LEAD_TICKS as f64).max(0.0) * TICK, q);
    }
    // After the training and held-out recordings.
    let reference = Reference::new(robot.arm(), start(TRAINING[usize::from(plan.hard)] + 1), q);
    let effects: Vec<&Injected> = truth.injected.iter().filter(|effect| !robot.has_by_itself(effect)).collect();
    let run = Machine::new(robot, &effects, None)?.run(&reference, truth.encoder_quantum)?;
    // The factor of friction in that recording is the mean one.
    let real = truth.lifelike.clone().unwrap_or_default();
    let sensors = Sensors {
        ticks: (truth.period / TICK).round() as usize,
        jitter: plan.hard,
        lost: plan.hard,
        quantum: truth.encoder_quantum,
        noise: truth.torque_noise.clone(),
        noise_time: real.noise_time,
        torque_quantum: real.torque_quantum,
        own_clocks: real.own_clocks,
    };
    let mut noise = ChaCha8Rng::seed_from_u64(truth.seed);
    noise.set_stream(RECORD_AGAIN);
    Ok(sensors.record(robot, &reference, &run, &mut noise))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::Campaign;
    use crate::conceal::conceal_case;
    use crate::expressed_share::deviation;
    use crate::test_robots::puma;

    /// The machine is that of the case: along the same motion it needs the recorded torques, apart from noise.
    #[test]
    fn a_case_is_recorded_again_as_it_was() {
        let robot = puma();
        let campaign = Campaign { seed: 5, cases: 4, lifelike: false, urdf_error: None };
        let mut plan = campaign.case(0).expect("there is one");
        // From the start on, so that it is also present in the second recording.
        plan.effects = vec!["transmission_coupling".into()];
        plan.hard = false;
        // Encoder steps in the second reference would reverse dry friction.
        plan.background_friction = false;
        let concealment = conceal_case(&robot, &plan).expect("it is concealed");
        let first = &concealment.train[0];
        let n = first.joints.len();
        let at = |time: f64, q: &mut [f64]| {
            let x = time / 0.004;
            let row = (x.floor() as usize).clamp(1, first.len() - 3);
            let u = x - row as f64;
            for (j, q) in q.iter_mut().enumerate() {
                // A Catmull-Rom spline: straight lines would accelerate only at the rows, where the torque is
                // compared.
                let [a, b, c, d] = [0, 1, 2, 3].map(|k| first.q[j][row + k - 1]);
                *q = b + 0.5 * u * (c - a + u * (2.0 * a - 5.0 * b + 4.0 * c - d + u * (3.0 * (b - c) + d - a)));
            }
        };
        let mut at = at;
        let again = record_again(&robot, &plan, &concealment.truth, 20.0, &mut at).expect("it is recorded");
        assert_eq!(again.joints, first.joints);
        assert!(again.time[0] > concealment.held_out.time[concealment.held_out.len() - 1]);
        // Torques at low frequency: the reference consists of encoder counts, whose steps are amplified by
        // differentiation.
        let mean = |tau: &[f64]| tau[1000..4000].iter().sum::<f64>() / 3000.0;
        for j in 0..n {
            let (was, is) = (mean(&first.tau[j]), mean(&again.tau[j]));
            let most = 0.02 * deviation(&first.tau[j]) + 0.02 * was.abs();
            assert!((was - is).abs() < most, "{j}: {was} {is}, at most {most} apart");
        }
        let mut same = |time: f64, q: &mut [f64]| at(time, q);
        let twice = record_again(&robot, &plan, &concealment.truth, 20.0, &mut same).expect("it is recorded");
        assert_eq!(again, twice);
    }
}
