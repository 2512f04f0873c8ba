//! The regular clock that a drive sampled on, found from the stamps that a logger wrote.
//!
//! Stamps scatter about the clock (a logger stamps late), rows are lost, and the logger's own clock drifts. The period
//! is estimated from differences over increasingly long spans, the phase from blocks of rows, and rows are assigned to
//! ticks by the most likely strictly increasing sequence where rounding is ambiguous. If stamps scatter over most of
//! the period, no stamp determines a phase, and the ticks follow from the order of the rows alone (`track`).

mod sampling;
mod track;

pub use sampling::is_at_stamps;

/// A gap of more than this many periods may be followed by another phase.
pub const PHASE_GAP: f64 = 6.5;
/// Rows that share one phase.
const BLOCK: usize = 128;
/// Above this scatter (root mean square, as a share of the period), stamps have no clock.
const NO_CLOCK: f64 = 0.25;
/// Above this scatter, rows are assigned to ticks by their order, not by their phase.
const WIDE: f64 = 0.12;
/// Above this scatter of the steps about whole periods, the stamps determine no phase (evenly distributed steps have 0.37).
const BLURRED: f64 = 0.25;
/// The largest number of differences in an estimate of the period.
const SAMPLES: usize = 20_000;
/// Above this scatter of the steps about whole periods, the period is another one (evenly distributed steps have 0.29).
const NO_PULSE: f64 = 0.22;
/// Below this scatter of the stamps, a jump of the phase is visible at once.
const STEADY: f64 = 0.03;
/// A row within this share of the period from its tick is certain.
const SURE: f64 = 0.4;

/// A stretch of rows on one phase.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// Its rows.
    pub rows: std::ops::Range<usize>,
    /// The time of its tick 0 (s).
    pub start: f64,
    /// The difference of its phase from that of the piece before, as a share of the period; 0 if they are not distinguished.
    pub shift: f64,
}

/// The clock, and the rows on it.
#[derive(Clone, Debug, PartialEq)]
pub struct Clock {
    /// Its period (s).
    pub period: f64,
    /// The tick of each row, counted in its piece.
    pub ticks: Vec<i64>,
    /// The stretches of one phase, in order.
    pub pieces: Vec<Piece>,
    /// Whether the stamps have a clock; if not, the ticks have no meaning.
    pub regular: bool,
    /// Distance of the stamps from their ticks: root mean square and largest (s), and the row of the largest.
    pub jitter: (f64, f64, usize),
}

/// Finds the clock of the stamps `time` (s, increasing, two at least), which begin anew at `breaks`.
pub fn find(time: &[f64], breaks: &[usize]) -> Clock {
    let period = estimate_period(time, breaks);
    let near = scatter(time, breaks, period, 1);
    // With such a large scatter, an attempt by phase would fail and take twice the time.
    let wide = if near > BLURRED { track::by_order(time, breaks, period) } else { None };
    wide.unwrap_or_else(|| {
        let clock = by_phase(time, breaks, period, near);
        if near > BLURRED || clock.regular && clock.jitter.0 < WIDE * clock.period {
            return clock;
        }
        track::by_order(time, breaks, period).unwrap_or(clock)
    })
}

/// The clock by the phase of the stamps, which scatter (from one row to the next by `near` periods) by less than half a
/// period.
fn by_phase(time: &[f64], breaks: &[usize], period: f64, near: f64) -> Clock {
    let pieces = split(time, breaks, period, near < STEADY);
    let mut clock = Clock {
        period,
        ticks: Vec::with_capacity(time.len()),
        pieces: Vec::new(),
        regular: !accumulates(time, &pieces, period, near),
        jitter: (0.0, 0.0, 0),
    };
    for rows in &pieces {
        let stamps = &time[rows.clone()];
        let phases = phases(stamps, period);
        let ticks = assign(stamps, &phases, period);
        // Ticks count from the piece's first row.
        let first = ticks.first().copied().unwrap_or(0);
        // Two rows cannot share a tick.
        clock.regular &= ticks.windows(2).all(|pair| pair[0] < pair[1]);
        clock.ticks.extend(ticks.iter().map(|tick| tick - first));
        clock.pieces.push(Piece { rows: rows.clone(), start: 0.0, shift: 0.0 });
        measure_jitter(&mut clock, stamps, &phases, first, rows.start);
    }
    let rows = time.len() as f64;
    clock.jitter.0 = (clock.jitter.0 / rows).sqrt();
    // Steps of whole periods have a clock, even if many stamps are rounded to the next or the previous tick.
    clock.regular &= near < STEADY || clock.jitter.0 < NO_CLOCK * period;
    fit(&mut clock, time);
    clock
}

/// Differences over `lag` rows that do not cross a break, at most [`SAMPLES`] of them.
fn differences<'a>(time: &'a [f64], breaks: &'a [usize], lag: usize) -> impl Iterator<Item = f64> + 'a {
    let count = time.len().saturating_sub(lag);
    let stride = (count / SAMPLES).max(1);
    (0..count)
        .step_by(stride)
        .filter(move |&row| {
            let begun = |row: usize| breaks.partition_point(|&at| at <= row);
            begun(row) == begun(row + lag)
        })
        .map(move |row| time[row + lag] - time[row])
}

fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Distance from the nearest whole number.
fn fraction(value: f64) -> f64 {
    value - value.round()
}

fn estimate_period(time: &[f64], breaks: &[usize]) -> f64 {
    let mut steps: Vec<f64> = differences(time, breaks, 1).collect();
    if steps.is_empty() {
        return (time[time.len() - 1] - time[0]) / (time.len() - 1) as f64;
    }
    let middle = median(&mut steps);
    let mean = |keep: &dyn Fn(f64) -> bool| {
        let kept: Vec<f64> = steps.iter().copied().filter(|&step| keep(step)).collect();
        kept.iter().sum::<f64>() / kept.len().max(1) as f64
    };
    // The mean near the median if stamps are rounded, the overall mean if rows come in bursts.
    let candidates = [mean(&|step| step > 0.4 * middle && step < 1.6 * middle), middle, mean(&|_| true)];
    let mut best = (f64::INFINITY, candidates[0]);
    for candidate in candidates {
        let period = refine(time, breaks, candidate);
        let (mut off, mut ticks, mut count) = (0.0, 0.0, 0.0);
        for step in differences(time, breaks, 1).filter(|&step| step < PHASE_GAP * period) {
            off += fraction(step / period).powi(2);
            ticks += step / period;
            count += 1.0;
        }
        // Lost or doubled rows cost as much as scatter; a period that the steps are not multiples of is ruled out.
        let off = (off / count).sqrt();
        let cost = off + (ticks / count - 1.0_f64).abs() + if off > NO_PULSE { 1.0 } else { 0.0 };
        if cost < best.0 - 1e-6 {
            best = (cost, period);
        }
    }
    best.1
}

/// Refines a period over increasingly long spans, each of which the previous estimate determines within half a period.
fn refine(time: &[f64], breaks: &[usize], mut period: f64) -> f64 {
    let mut lag = 1;
    while lag < time.len() && lag <= 4096 {
        let (mut span, mut ticks) = (0.0, 0.0);
        for difference in differences(time, breaks, lag) {
            let count = (difference / period).round();
            if count >= 1.0 && (difference / period - count).abs() < 0.35 && difference < 20.0 * lag as f64 * period {
                span += difference;
                ticks += count;
            }
        }
        if ticks > 0.0 {
            period = span / ticks;
        }
        lag *= 4;
    }
    period
}

/// The distance of differences over `lag` rows from whole periods, as a share of the period; a robust estimate.
fn scatter(time: &[f64], breaks: &[usize], period: f64, lag: usize) -> f64 {
    let mut off: Vec<f64> =
        differences(time, breaks, lag).map(|difference| fraction(difference / period).abs()).collect();
    if off.is_empty() { 0.0 } else { 1.4826 * median(&mut off) }
}

/// Whether the deviations accumulate from row to row, so that rows were sampled at the times of their stamps.
fn accumulates(time: &[f64], pieces: &[std::ops::Range<usize>], period: f64, near: f64) -> bool {
    let breaks: Vec<usize> = pieces.iter().skip(1).map(|rows| rows.start).collect();
    let far = scatter(time, &breaks, period, 16);
    far > 0.06 && far > 2.0 * near
}

/// The rows between long gaps, breaks and, where stamps are `steady`, jumps of the phase.
fn split(time: &[f64], breaks: &[usize], period: f64, steady: bool) -> Vec<std::ops::Range<usize>> {
    let mut pieces = Vec::new();
    let mut begun = 0;
    for row in 1..time.len() {
        let step = (time[row] - time[row - 1]) / period;
        let jump = steady && step > 1.5 && fraction(step).abs() > 0.2;
        if step > PHASE_GAP || jump || breaks.binary_search(&row).is_ok() {
            pieces.push(begun..row);
            begun = row;
        }
    }
    pieces.push(begun..time.len());
    pieces
}

/// The time of a tick near each row (s), one a block of rows, with the block's middle row.
fn phases(stamps: &[f64], period: f64) -> Vec<(f64, f64)> {
    let mut phases: Vec<(f64, f64)> = Vec::new();
    let blocks = (stamps.len() / BLOCK).max(1);
    for block in 0..blocks {
        let rows = block * BLOCK..if block + 1 == blocks { stamps.len() } else { (block + 1) * BLOCK };
        let stamps = &stamps[rows.clone()];
        let origin = phases.last().map_or(stamps[0], |phase| phase.1);
        // The circular mean finds the phase wherever it is; the median then forgives late rows.
        let (mut sine, mut cosine) = (0.0, 0.0);
        for stamp in stamps {
            let (s, c) = (std::f64::consts::TAU * fraction((stamp - origin) / period)).sin_cos();
            sine += s;
            cosine += c;
        }
        let mean = sine.atan2(cosine) / std::f64::consts::TAU;
        let mut off: Vec<f64> = stamps.iter().map(|stamp| fraction((stamp - origin) / period - mean)).collect();
        let phase = origin + period * (mean + median(&mut off));
        phases.push(((rows.start + rows.end) as f64 / 2.0, phase));
    }
    phases
}

/// The phase (s) at each row, straight between the blocks' middles.
fn phase_at(phases: &[(f64, f64)], row: usize, block: &mut usize) -> f64 {
    let at = row as f64;
    while *block + 2 < phases.len() && at > phases[*block + 1].0 {
        *block += 1;
    }
    match phases.get(*block + 1) {
        None => phases[*block].1,
        Some(&(middle, phase)) => {
            let (before, start) = phases[*block];
            let share = ((at - before) / (middle - before)).clamp(0.0, 1.0);
            start + share * (phase - start)
        }
    }
}

/// The tick of each row.
fn assign(stamps: &[f64], phases: &[(f64, f64)], period: f64) -> Vec<i64> {
    let mut block = 0;
    let exact: Vec<f64> =
        (0..stamps.len()).map(|row| (stamps[row] - phase_at(phases, row, &mut block)) / period).collect();
    let nearest: Vec<i64> = exact.iter().map(|at| at.round() as i64).collect();
    let sure = nearest.windows(2).all(|pair| pair[1] > pair[0])
        && exact.iter().zip(&nearest).all(|(at, tick)| (at - *tick as f64).abs() < SURE);
    if sure { nearest } else { likeliest(&exact, &nearest) }
}

/// The number of ticks that a row may be later than its stamp; it may be one less earlier.
const CANDIDATES: usize = 5;
const EARLIEST: i64 = -3;

/// The strictly increasing ticks with the lowest cost, which depends on scatter, asymmetrically for late rows, and on
/// lost ticks.
fn likeliest(exact: &[f64], nearest: &[i64]) -> Vec<i64> {
    let mut off: Vec<f64> = exact.iter().zip(nearest).map(|(at, tick)| (at - *tick as f64).abs()).collect();
    let scale = (1.4826 * median(&mut off)).max(0.02);
    let tick = |row: usize, candidate: usize| nearest[row] + EARLIEST + candidate as i64;
    let own = |row: usize, candidate: usize| {
        let away = ((exact[row] - tick(row, candidate) as f64) / scale).abs();
        if away < 2.0 { away * away / 2.0 } else { 2.0 * away - 2.0 }
    };
    let mut cost: [f64; CANDIDATES] = std::array::from_fn(|candidate| own(0, candidate));
    let mut from: Vec<[u8; CANDIDATES]> = vec![[0; CANDIDATES]; exact.len()];
    for row in 1..exact.len() {
        let mut next = [f64::INFINITY; CANDIDATES];
        for candidate in 0..CANDIDATES {
            for before in 0..CANDIDATES {
                let step = tick(row, candidate) - tick(row - 1, before);
                if step < 1 {
                    continue;
                }
                let lost = if step == 1 { 0.0 } else { 4.0 + 0.5 * (step - 2) as f64 };
                let total = cost[before] + lost;
                if total < next[candidate] {
                    next[candidate] = total;
                    from[row][candidate] = before as u8;
                }
            }
            next[candidate] += own(row, candidate);
        }
        cost = next;
    }
    let mut best =
        (0..CANDIDATES).fold(0, |best, candidate| if cost[candidate] < cost[best] { candidate } else { best });
    if !cost[best].is_finite() {
        // If there are more rows than ticks, there is no clock.
        return nearest.to_vec();
    }
    let mut ticks = vec![0; exact.len()];
    for row in (0..exact.len()).rev() {
        ticks[row] = tick(row, best);
        best = usize::from(from[row][best]);
    }
    ticks
}

fn measure_jitter(clock: &mut Clock, stamps: &[f64], phases: &[(f64, f64)], first: i64, begun: usize) {
    let mut block = 0;
    for (row, stamp) in stamps.iter().enumerate() {
        let tick = (clock.ticks[begun + row] + first) as f64;
        let off = stamp - phase_at(phases, row, &mut block) - tick * clock.period;
        clock.jitter.0 += off * off;
        if off.abs() > clock.jitter.1 {
            (clock.jitter.1, clock.jitter.2) = (off.abs(), begun + row);
        }
    }
}

/// The period over all pieces by least squares, rounded to a whole number of hertz if it cannot be distinguished from
/// that, and the start of each piece.
fn fit(clock: &mut Clock, time: &[f64]) {
    let (mut numerator, mut denominator) = (0.0, 0.0);
    let mut means = Vec::new();
    for piece in &clock.pieces {
        let count = piece.rows.len() as f64;
        let tick = piece.rows.clone().map(|row| clock.ticks[row] as f64).sum::<f64>() / count;
        let origin = time[piece.rows.start];
        let stamp = piece.rows.clone().map(|row| time[row] - origin).sum::<f64>() / count;
        means.push((tick, stamp + origin));
        for row in piece.rows.clone() {
            let away = clock.ticks[row] as f64 - tick;
            numerator += away * (time[row] - origin - stamp);
            denominator += away * away;
        }
    }
    if clock.regular && denominator > 0.0 {
        let period = numerator / denominator;
        let rate = (1.0 / period).round();
        let doubt = 3.0 * clock.jitter.0 / denominator.sqrt() + 1e-9 * period;
        clock.period = if rate >= 1.0 && (1.0 / rate - period).abs() < doubt { 1.0 / rate } else { period };
    }
    let period = clock.period;
    let certain = 0.02 + 6.0 * clock.jitter.0 / period;
    let mut before: Option<f64> = None;
    for (piece, (tick, stamp)) in clock.pieces.iter_mut().zip(means) {
        piece.start = stamp - tick * period;
        let shift = before.map_or(0.0, |before| fraction((piece.start - before) / period));
        piece.shift = if shift.abs() > certain { shift } else { 0.0 };
        before = Some(piece.start);
    }
}

#[cfg(test)]
#[path = "clock_tests.rs"]
mod tests;
