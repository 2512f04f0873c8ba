//! The torques with which dry friction holds joints at rest.

use arm::DMatrix;

/// Where a joint's friction torque lies between its limits.
#[derive(Clone, Copy, PartialEq)]
enum Bound {
    /// Within its limits: the joint remains at rest.
    Within,
    /// At its positive or negative limit: the joint breaks away.
    At(f64),
}

/// The friction torques of joints at rest, each bounded by its level. A joint within its level has zero acceleration;
/// a joint at its level accelerates against the friction torque.
///
/// `response` is the symmetric, positive definite block of M⁻¹ for these joints, `free` their accelerations without
/// friction, `levels` the largest friction torque of each (N m or N). The solution is unique. Source: least-index
/// principal pivoting (Murty 1974), with two bounds instead of one.
pub(crate) fn holding_torques(response: &DMatrix<f64>, free: &[f64], levels: &[f64]) -> Vec<f64> {
    let n = free.len();
    let mut bounds = vec![Bound::Within; n];
    let mut torques = vec![0.0; n];
    // Each of the n joints has three states, so that there are at most 3ⁿ combinations.
    for _ in 0..3_usize.saturating_pow(n as u32) {
        solve_within(response, free, levels, &bounds, &mut torques);
        let violated = (0..n).find_map(|i| match bounds[i] {
            Bound::Within if torques[i].abs() > levels[i] => Some((i, Bound::At(torques[i].signum()))),
            Bound::At(sign) if sign * acceleration(response, free, &torques, i) > 0.0 => Some((i, Bound::Within)),
            _ => None,
        });
        let Some((i, bound)) = violated else { break };
        bounds[i] = bound;
    }
    for i in 0..n {
        torques[i] = torques[i].clamp(-levels[i], levels[i]);
    }
    torques
}

/// The torques that hold all joints at rest, without regard to their levels (N m or N).
pub(crate) fn locking_torques(response: &DMatrix<f64>, free: &[f64]) -> Vec<f64> {
    let mut torques = vec![0.0; free.len()];
    solve_within(response, free, &[], &vec![Bound::Within; free.len()], &mut torques);
    torques
}

fn solve_within(response: &DMatrix<f64>, free: &[f64], levels: &[f64], bounds: &[Bound], torques: &mut [f64]) {
    for (i, bound) in bounds.iter().enumerate() {
        torques[i] = match bound {
            Bound::Within => 0.0,
            Bound::At(sign) => sign * levels[i],
        };
    }
    let within: Vec<usize> = (0..bounds.len()).filter(|&i| bounds[i] == Bound::Within).collect();
    if within.is_empty() {
        return;
    }
    let block = DMatrix::from_fn(within.len(), within.len(), |a, b| response[(within[a], within[b])]);
    let wanted = DMatrix::from_fn(within.len(), 1, |a, _| -acceleration(response, free, torques, within[a]));
    // `response` is positive definite, so that the solution exists.
    if let Some(solution) = block.lu().solve(&wanted) {
        for (a, &i) in within.iter().enumerate() {
            torques[i] = solution[a];
        }
    }
}

fn acceleration(response: &DMatrix<f64>, free: &[f64], torques: &[f64], i: usize) -> f64 {
    free[i] + torques.iter().enumerate().map(|(j, torque)| response[(i, j)] * torque).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A joint within its level does not accelerate; one at its level does not accelerate in the direction of its
    /// friction torque. Other pivoting rules may cycle on such problems.
    #[test]
    fn every_joint_rests_or_gives_way() {
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        for case in 0..500 {
            let n = 1 + case % 7;
            let factor = DMatrix::from_fn(n, n, |_, _| random());
            let response = &factor * factor.transpose() + DMatrix::identity(n, n) * 0.01;
            let free: Vec<f64> = (0..n).map(|_| 3.0 * random()).collect();
            let levels: Vec<f64> = (0..n).map(|_| 0.1 + 2.0 * random().abs()).collect();
            let torques = holding_torques(&response, &free, &levels);
            for i in 0..n {
                let acceleration = acceleration(&response, &free, &torques, i);
                assert!(torques[i].abs() <= levels[i], "case {case}: beyond the level");
                if torques[i].abs() < levels[i] {
                    assert!(acceleration.abs() < 1e-8, "case {case}: moves by {acceleration}");
                } else {
                    assert!(acceleration * torques[i] < 1e-8, "case {case}: driven by friction");
                }
            }
        }
    }
}
