//! Draws until the effects of a case are detectable and within bounds, and the position loop is stable.

use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;

use super::Stage;
use crate::campaign::CasePlan;
use crate::error::FaultError;
use crate::expressed_share::{Torques, share};
use crate::fault::{Fault, Leaves, Size, families, is_outside, outside};
use crate::machine::Run;
use crate::motion::{DURATION, LEAD_TICKS, Reference, start};
use crate::site::{Scales, log_uniform};
use crate::truth::Injected;

/// The largest number of attempts for a case, and for one effect.
const CASES: usize = 10;
const DRAWS: usize = 8;
/// The ratio to the quantisation noise above which the torque counts as oscillating; with a gap, it always oscillates.
const OSCILLATION: (f64, f64) = (0.2, 0.5);
/// The allowed expressed shares of a case.
const SHARES: (f64, f64) = (0.01, 1.2);

/// The duration of a recording that determines sizes (s); shares are those of whole recordings.
const TRIAL: f64 = 12.0;

/// The reference for effects: the machine with its baseline friction.
struct Base {
    /// The reference at the beginning of the first recording.
    trial: Reference,
    torques: Torques,
    /// The whole first recording.
    whole: Torques,
    above: f64,
    sorted: Vec<Vec<f64>>,
}

/// The effects of `plan`, and the runs with them.
pub(super) fn search(
    stage: &Stage<'_>,
    plan: &CasePlan,
    random: &mut ChaCha8Rng,
) -> Result<(Vec<Injected>, Vec<Run>), FaultError> {
    let base = base(stage)?;
    let mut names = plan.effects.clone();
    for attempt in 0..CASES {
        if attempt >= CASES / 2 {
            // Effects that are not detectable on this robot are replaced by others.
            for name in &mut names {
                let known = if is_outside(name) { outside() } else { families() };
                *name = known.choose(random).copied().unwrap_or(name).to_owned();
            }
            names.sort_unstable();
            names.dedup();
            // The loop may not be able to hold five effects at the same time.
            names.truncate(3);
        }
        let Some(mut effects) = draw_all(stage, plan, &names, &base, random)? else {
            continue;
        };
        let (runs, torques) = match stage.run_all(&effects) {
            Ok(done) => done,
            Err(error) if may_succeed_with_another_draw(&error) => continue,
            Err(error) => return Err(error),
        };
        if runs.iter().any(|run| !is_stable(stage, &effects, run, base.above)) {
            continue;
        }
        let mut shows = true;
        let is_base = effects.len() == 1 && !leaves_more_than_the_base(&effects[0]);
        for which in 0..effects.len() {
            match stage.share(&effects, which, &torques, is_base.then_some(&base.whole)) {
                Ok(share) => {
                    shows &= (SHARES.0..=SHARES.1).contains(&share);
                    effects[which].expressed_share = Some(share);
                }
                Err(error) if may_succeed_with_another_draw(&error) => shows = false,
                Err(error) => return Err(error),
            }
            if !shows {
                break;
            }
        }
        if shows {
            return Ok((effects, runs));
        }
    }
    Err(FaultError::NotExpressed {
        case: plan.name.clone(),
        effects: plan.effects.join(", "),
        robot: stage.robot.name().to_owned(),
    })
}

fn base(stage: &Stage<'_>) -> Result<Base, FaultError> {
    let run = stage.run(&[], None, &stage.training[0])?;
    let (torques, above) = stage.torques(&run);
    let trial = stage.training[0].clone().first_seconds(TRIAL);
    let sorted = torques
        .iter()
        .map(|torque| {
            let mut sizes: Vec<f64> = torque.iter().map(|tau| tau.abs()).collect();
            sizes.sort_unstable_by(f64::total_cmp);
            sizes
        })
        .collect();
    let begin = trial.ticks() - LEAD_TICKS;
    Ok(Base {
        torques: torques.iter().map(|torque| torque[..begin].to_vec()).collect(),
        whole: torques,
        above,
        sorted,
        trial,
    })
}

/// One of each effect, on different joints; `None` if one of them is not detectable by itself.
fn draw_all(
    stage: &Stage<'_>,
    plan: &CasePlan,
    names: &[String],
    base: &Base,
    random: &mut ChaCha8Rng,
) -> Result<Option<Vec<Injected>>, FaultError> {
    let coulomb: Vec<f64> = match &stage.friction {
        Some((levels, _)) => levels.iter().map(|(coulomb, _)| *coulomb).collect(),
        None => vec![0.0; stage.spreads.len()],
    };
    let scales = Scales {
        robot: stage.robot,
        hard: plan.hard,
        lifelike: plan.lifelike,
        spreads: &stage.spreads,
        loads: &stage.loads,
        urdf_error: plan.urdf_error,
        torques: &base.sorted,
        coulomb: &coulomb,
        span: (start(0), start(stage.training.len() - 1) + DURATION),
    };
    let mut effects: Vec<Injected> = Vec::new();
    for name in names {
        let known = Fault::named(name).filter(|fault| (fault.can_be_on)(stage.robot));
        let Some(fault) = known else { return Ok(None) };
        let joints = stage.robot.arm().joints();
        let used: Vec<usize> = (0..joints.len())
            .filter(|&j| effects.iter().any(|effect| effect.joint.as_deref() == Some(&joints[j].name)))
            .collect();
        let mut found = None;
        for _ in 0..DRAWS {
            let mut effect = scales.draw(fault, &used, random);
            let target = target(plan.hard, random);
            if scale_to_target(stage, fault, &mut effect, target, base)? {
                found = Some(effect);
                break;
            }
        }
        let Some(effect) = found else { return Ok(None) };
        effects.push(effect);
    }
    Ok(Some(effects))
}

/// The target share of an effect whose size is free.
fn target(hard: bool, random: &mut ChaCha8Rng) -> f64 {
    log_uniform(SHARES.0, if hard { 0.35 } else { 0.5 }, random)
}

/// Scales `effect` to its target share, on one recording and by itself; returns whether it is detectable there.
fn scale_to_target(
    stage: &Stage<'_>,
    fault: &Fault,
    effect: &mut Injected,
    target: f64,
    base: &Base,
) -> Result<bool, FaultError> {
    // Its onset does not influence its size.
    let onset = effect.onset.take();
    let reference = match effect.number("start") {
        Some(time) => stage.training.iter().rfind(|reference| reference.start <= time),
        None => None,
    };
    let is_whole = reference.is_some();
    let reference = reference.unwrap_or(&base.trial);
    let run = |effect: &Injected, without| stage.run(std::slice::from_ref(effect), without, reference);
    let without = if leaves_more_than_the_base(effect) || is_whole {
        match run(effect, Some(0)) {
            Ok(run) => stage.torques(&run).0,
            Err(error) if may_succeed_with_another_draw(&error) => return Ok(false),
            Err(error) => return Err(error),
        }
    } else {
        base.torques.clone()
    };
    let free = !matches!(fault.size, Size::AsDrawn);
    let mut shows = false;
    for attempt in 0..2 {
        let with = match run(effect, None) {
            Ok(run) if is_stable(stage, std::slice::from_ref(effect), &run, base.above) => stage.torques(&run).0,
            Ok(_) => return Ok(false),
            Err(error) if may_succeed_with_another_draw(&error) && free && attempt == 0 => {
                fault.resize(effect, 0.3);
                continue;
            }
            Err(error) if may_succeed_with_another_draw(&error) => return Ok(false),
            Err(error) => return Err(error),
        };
        let share = share(&[with], std::slice::from_ref(&without), fault.is_constant);
        shows = (SHARES.0..=SHARES.1).contains(&share);
        let off = (target / share.max(1e-4)).clamp(0.1, 10.0);
        if !free || off.ln().abs() < 0.7 {
            break;
        }
        // The share is not proportional to the size, because the effect is also in the denominator.
        fault.resize(effect, off.powf(0.9));
    }
    effect.onset = onset;
    Ok(shows)
}

/// Whether the machine without the effect differs from the one with baseline friction alone.
fn leaves_more_than_the_base(effect: &Injected) -> bool {
    effect.leaves() != Leaves::Nothing
}

/// Whether another draw may be stable.
fn may_succeed_with_another_draw(error: &FaultError) -> bool {
    matches!(
        error,
        FaultError::Lost { .. } | FaultError::Plant(plant::PlantError::Diverged { .. }) | FaultError::Effect { .. }
    )
}

/// Whether the loop does not oscillate.
fn is_stable(stage: &Stage<'_>, effects: &[Injected], run: &Run, base: f64) -> bool {
    let may_oscillate = effects.iter().filter_map(Injected::fault).any(|fault| fault.may_oscillate);
    let most = if may_oscillate { OSCILLATION.1 } else { OSCILLATION.0 };
    stage.torques(run).1 <= most + base
}
