//! Ticks of stamps whose scatter is so large, relative to the period, that no single stamp determines its tick.
//!
//! Rows keep their order, and few are lost: the ticks are the sequence whose stamps remain near a slowly changing
//! phase. Several sequences are followed at the same time, each with its own phase (and period); of two with the same
//! number of ticks, the better one is kept (Viterbi's algorithm with estimates for each survivor).

use super::{BLOCK, Clock, Piece, fit, measure_jitter, split};

/// Above this scatter, stamps have no clock (evenly distributed over a period: 0.29).
const WIDEST: f64 = 0.36;
/// The number of sequences that are followed.
const SURVIVORS: usize = 4;
/// The cost of a lost tick, in squares of the scatter: about one row in a hundred is lost.
const LOST: f64 = 4.5;
const LOST_MORE: f64 = 1.0;
/// The share of a stamp's distance by which the phase is corrected.
const GAIN: f64 = 0.04;
/// The cost above that of the best at which a sequence is abandoned.
const HOPELESS: f64 = 60.0;
/// The number of missing ticks that divides stretches.
const FARTHEST: i64 = 200;
/// The largest delay of a row, in periods.
const LATEST: i64 = 3;
/// The number of rows from which the period is estimated first.
const FIRST: usize = 4000;
/// The correlation of successive steps if each stamp scatters independently about a clock (−1/2, slightly more if
/// ticks are lost). It is 0 if rows were sampled at the times of their stamps.
const BESIDE: std::ops::Range<f64> = -0.62..-0.2;
/// The largest correlation of steps further apart.
const UNRELATED: f64 = 0.2;

/// A sequence of ticks.
#[derive(Clone, Copy)]
struct Survivor {
    cost: f64,
    /// The tick of the row.
    tick: i64,
    /// The time of that tick (s).
    phase: f64,
    period: f64,
    /// The index of the sequence at the previous row that it continues.
    from: u8,
}

/// The ticks of `stamps` (increasing, one piece), counted from the first, for a clock with about the period `period`
/// (s) and a scatter of the stamps of `scatter` periods.
fn ticks(stamps: &[f64], period: f64, scatter: f64, learn: f64) -> Vec<i64> {
    let mut survivors = vec![Survivor { cost: 0.0, tick: 0, phase: stamps[0], period, from: 0 }];
    let mut path: Vec<[(u8, u8); SURVIVORS]> = Vec::with_capacity(stamps.len());
    path.push([(0, 0); SURVIVORS]);
    let mut next: Vec<Survivor> = Vec::with_capacity(3 * SURVIVORS);
    for (row, &stamp) in stamps.iter().enumerate().skip(1) {
        // The first stamp is as uncertain as any other: the phase converges as a mean does.
        let gain = GAIN.max(1.0 / (row as f64 + 1.0));
        next.clear();
        let mut cheapest = f64::INFINITY;
        for (from, survivor) in survivors.iter().enumerate() {
            let away = (stamp - survivor.phase) / survivor.period;
            let near = (away.round() as i64).clamp(1, FARTHEST);
            // A stamp may be up to three periods late, but less than one period early.
            for step in (near - LATEST).max(1)..=near + 1 {
                let off = away - step as f64;
                let size = (off / scatter).abs();
                // Quadratic near the phase and linear beyond it, because a stamp may be very late.
                let own = if size < 2.0 { size * size / 2.0 } else { 2.0 * size - 2.0 };
                let lost = if step == 1 { 0.0 } else { LOST + LOST_MORE * (step - 2) as f64 };
                let pull = off.clamp(-2.0 * scatter, 2.0 * scatter) * survivor.period;
                let cost = survivor.cost + own + lost;
                if cost > HOPELESS + cheapest {
                    continue;
                }
                cheapest = cheapest.min(cost);
                let found = Survivor {
                    cost,
                    tick: survivor.tick + step,
                    phase: survivor.phase + step as f64 * survivor.period + gain * pull,
                    period: survivor.period + learn * pull,
                    from: from as u8,
                };
                match next.iter_mut().find(|other| other.tick == found.tick) {
                    Some(other) if other.cost <= found.cost => {}
                    Some(other) => *other = found,
                    None => next.push(found),
                }
            }
        }
        if next.len() > SURVIVORS {
            next.select_nth_unstable_by(SURVIVORS - 1, |a, b| a.cost.total_cmp(&b.cost));
            next.truncate(SURVIVORS);
        }
        let mut entry = [(0, 0); SURVIVORS];
        for (slot, found) in next.iter_mut().enumerate() {
            found.cost -= cheapest;
            let step = found.tick - survivors[usize::from(found.from)].tick;
            entry[slot] = (found.from, step as u8);
        }
        path.push(entry);
        std::mem::swap(&mut survivors, &mut next);
    }
    let mut slot = (0..survivors.len()).fold(
        0,
        |best, slot| {
            if survivors[slot].cost < survivors[best].cost { slot } else { best }
        },
    );
    let mut list = vec![0; stamps.len()];
    let mut tick = survivors[slot].tick;
    for row in (0..stamps.len()).rev() {
        list[row] = tick;
        let (from, step) = path[row][slot];
        tick -= i64::from(step);
        slot = usize::from(from);
    }
    list
}

/// The slope of `stamps` on `ticks` (s): the period.
fn slope(stamps: &[f64], ticks: &[i64]) -> Option<f64> {
    let count = stamps.len() as f64;
    let (mut tick, mut stamp) = (0.0, 0.0);
    for (s, t) in stamps.iter().zip(ticks) {
        tick += *t as f64 / count;
        stamp += (s - stamps[0]) / count;
    }
    let (mut numerator, mut denominator) = (0.0, 0.0);
    for (s, t) in stamps.iter().zip(ticks) {
        let away = *t as f64 - tick;
        numerator += away * (s - stamps[0] - stamp);
        denominator += away * away;
    }
    (denominator > 0.0).then(|| numerator / denominator)
}

/// Properties of the steps from row to row: their mean without those over a lost tick (s), the scatter of the stamps as
/// a share of it, and whether they scatter about a clock.
fn steps(stamps: &[f64]) -> (f64, f64, bool) {
    let all: Vec<f64> = stamps.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let mut sorted = all.clone();
    let middle = super::median(&mut sorted);
    let mut usual = middle;
    for _ in 0..8 {
        // Differences of scattered stamps are distributed symmetrically about the period; larger ones may contain a
        // lost tick.
        let (mut sum, mut count) = (0.0, 0.0);
        for step in all.iter().filter(|step| (*step - usual).abs() < 0.8 * usual) {
            sum += step;
            count += 1.0;
        }
        usual = if count > 0.0 { sum / count } else { middle };
    }
    let off: Vec<f64> = all.iter().map(|step| step - usual).collect();
    // The mean product of steps at this distance without a lost tick.
    let product = |lag: usize| {
        let pairs = off.iter().zip(&off[lag.min(off.len())..]);
        let kept = pairs.filter(|(a, b)| a.abs() < usual && b.abs() < usual);
        let (sum, count) = kept.fold((0.0, 0.0), |(sum, count), (a, b)| (sum + a * b, count + 1.0));
        sum / f64::max(count, 1.0)
    };
    let variance = product(0);
    let beside = product(1) / variance;
    let alone = [2, 3].iter().all(|&lag| (product(lag) / variance).abs() < UNRELATED);
    (usual, (variance / 2.0).sqrt() / usual, BESIDE.contains(&beside) && alone)
}

/// The period (s) and each row's tick, counted from the first of its piece, if stamps scatter widely about a clock;
/// `None` if they do not.
fn find(time: &[f64], stretches: &[std::ops::Range<usize>]) -> Option<(f64, Vec<i64>)> {
    let longest = stretches.iter().max_by_key(|rows| rows.len())?;
    let start = &time[longest.start..longest.end.min(longest.start + FIRST)];
    if start.len() < 30 {
        return None;
    }
    let (mut period, scatter, anticorrelated) = steps(start);
    if !anticorrelated {
        return None;
    }
    let scatter = scatter.clamp(0.05, 0.4);
    for learn in [GAIN * GAIN / 4.0, GAIN * GAIN / 16.0, 0.0] {
        period = slope(start, &ticks(start, period, scatter, learn)).filter(|period| *period > 0.0)?;
    }
    let mut found = Vec::with_capacity(time.len());
    let (mut sum, mut weight) = (0.0, 0.0);
    for rows in stretches {
        let stamps = &time[rows.clone()];
        let own = ticks(stamps, period, scatter, 0.0);
        if let Some(slope) = slope(stamps, &own) {
            let share = (rows.len() as f64).powi(3);
            sum += share * slope;
            weight += share;
        }
        found.extend(own);
    }
    (weight > 0.0).then(|| (sum / weight, found))
}

/// The clock by the order of the rows, for stamps with a large scatter.
pub fn by_order(time: &[f64], breaks: &[usize], period: f64) -> Option<Clock> {
    let pieces = split(time, breaks, period, false);
    let (period, ticks) = find(time, &pieces)?;
    let mut clock =
        Clock { period, ticks, pieces: Vec::with_capacity(pieces.len()), regular: true, jitter: (0.0, 0.0, 0) };
    for rows in &pieces {
        let stamps = &time[rows.clone()];
        let phases = levels(stamps, &clock.ticks[rows.clone()], period);
        clock.pieces.push(Piece { rows: rows.clone(), start: 0.0, shift: 0.0 });
        measure_jitter(&mut clock, stamps, &phases, 0, rows.start);
    }
    clock.jitter.0 = (clock.jitter.0 / time.len() as f64).sqrt();
    if clock.jitter.0 > WIDEST * period {
        return None;
    }
    fit(&mut clock, time);
    Some(clock)
}

/// The mean distance of the stamps from the ticks, for known ticks (see [`super::phases`]).
fn levels(stamps: &[f64], ticks: &[i64], period: f64) -> Vec<(f64, f64)> {
    let blocks = (stamps.len() / BLOCK).max(1);
    let level = |block: usize| {
        let rows = block * BLOCK..if block + 1 == blocks { stamps.len() } else { (block + 1) * BLOCK };
        let sum: f64 = rows.clone().map(|row| stamps[row] - stamps[0] - ticks[row] as f64 * period).sum();
        ((rows.start + rows.end) as f64 / 2.0, stamps[0] + sum / rows.len() as f64)
    };
    (0..blocks).map(level).collect()
}
