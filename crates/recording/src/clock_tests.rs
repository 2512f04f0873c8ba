//! Clocks whose truth is known: every row must land on its tick.

use super::*;

/// A small generator, the same everywhere (Steele, Lea and Flood 2014, SplitMix64).
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// Ticks of which a share is lost.
fn ticks(random: &mut Random, count: i64, lost: f64) -> Vec<i64> {
    (0..count).filter(|&tick| tick == 0 || random.uniform() > lost).collect()
}

fn checked(truth: &[i64], stamps: &[f64], period: f64) -> Clock {
    let clock = find(stamps, &[]);
    assert!(clock.regular);
    let off = (clock.period / period - 1.0).abs();
    let wrong = clock.ticks.iter().zip(truth).filter(|(found, truth)| *found != *truth).count();
    assert_eq!(wrong, 0, "of {} rows; the period is off by {off:e}", truth.len());
    assert!(off < 1e-4, "the period is off by {off:e}");
    clock
}

#[test]
fn jittered_stamps_with_lost_rows_land_on_their_ticks() {
    for seed in 0..20 {
        for (rate, rows) in [(100.0, 2500), (125.0, 300), (500.0, 12_500), (333.25, 5000)] {
            let mut random = Random(seed);
            let truth = ticks(&mut random, rows, 0.01);
            let period = 1.0 / rate;
            let jitter = 0.1 * period;
            let stamps: Vec<f64> = truth
                .iter()
                .map(|tick| 7.0 + *tick as f64 * period + jitter * random.normal().clamp(-4.5, 4.5))
                .collect();
            let clock = checked(&truth, &stamps, period);
            assert!((clock.jitter.0 / jitter - 1.0).abs() < 0.1);
        }
    }
}

#[test]
fn an_exact_clock_is_found_exactly() {
    for rate in [100.0, 250.0, 1000.0, 5000.0] {
        let truth: Vec<i64> = (0..5000).collect();
        let stamps: Vec<f64> = truth.iter().map(|tick| (*tick as f64 / rate * 1e6).round() / 1e6).collect();
        let clock = checked(&truth, &stamps, 1.0 / rate);
        assert_eq!(clock.period, 1.0 / rate);
        assert!(clock.pieces.len() == 1 && clock.pieces[0].start.abs() < 1e-9);
    }
}

#[test]
fn a_drifting_logger_and_late_rows_do_not_move_rows() {
    let mut random = Random(3);
    let truth = ticks(&mut random, 60_000, 0.01);
    let period = 1e-3;
    let mut stamps: Vec<f64> = truth
        .iter()
        .map(|tick| {
            let exact = *tick as f64 * period;
            // The logger's clock wanders by milliseconds and it stamps late, exponentially.
            exact + 5e-3 * (exact / 15.0).sin() - 0.08 * period * random.uniform().max(1e-9).ln()
        })
        .collect();
    for row in 1..stamps.len() {
        stamps[row] = stamps[row].max(stamps[row - 1] + 1e-6);
    }
    checked(&truth, &stamps, period);
}

#[test]
fn rows_that_come_late_in_bursts_go_back_to_their_ticks() {
    let truth: Vec<i64> = (0..4000).collect();
    let mut stamps: Vec<f64> = truth.iter().map(|tick| *tick as f64 * 0.01).collect();
    for burst in (500..3900).step_by(250) {
        let stalled = stamps[burst + 2] + 1e-4;
        for late in 0..3 {
            stamps[burst + late] = stalled + 5e-4 * late as f64;
        }
    }
    checked(&truth, &stamps, 0.01);
}

#[test]
fn stamps_in_whole_milliseconds_have_their_clock() {
    let truth: Vec<i64> = (0..4000).collect();
    let stamps: Vec<f64> = truth.iter().map(|tick| (*tick as f64 * 2.5).floor() * 1e-3).collect();
    let clock = checked(&truth, &stamps, 2.5e-3);
    assert_eq!(clock.period, 2.5e-3);
}

#[test]
fn a_gap_may_end_on_another_phase() {
    let mut stamps: Vec<f64> = (0..1000).map(|tick| f64::from(tick) * 2e-3).collect();
    stamps.extend((0..1000).map(|tick| 2.041 + f64::from(tick) * 2e-3));
    let clock = find(&stamps, &[]);
    assert!(clock.regular && clock.pieces.len() == 2);
    assert!((clock.pieces[1].shift.abs() - 0.5).abs() < 1e-6);
    assert!((clock.pieces[1].start - 2.041).abs() < 1e-9);
    assert_eq!(clock.ticks[1000..1003], [0, 1, 2]);
}

#[test]
fn stamps_without_a_clock_are_reported() {
    let mut random = Random(5);
    let mut at = 0.0;
    let walk: Vec<f64> = (0..5000)
        .map(|_| {
            at += 0.01 * (1.0 + 0.15 * random.normal()).max(0.1);
            at
        })
        .collect();
    assert!(!find(&walk, &[]).regular, "rows taken when they were stamped");
    let mut scattered: Vec<f64> = (0..5000).map(|_| 50.0 * random.uniform()).collect();
    scattered.sort_by(f64::total_cmp);
    scattered.dedup();
    let clock = find(&scattered, &[]);
    assert!(!clock.regular, "jitter {}", clock.jitter.0 / clock.period);
}

#[test]
fn a_clock_of_which_a_third_is_lost_is_found() {
    let mut random = Random(11);
    let truth = ticks(&mut random, 5000, 0.33);
    let stamps: Vec<f64> = truth.iter().map(|tick| 0.01 * *tick as f64 + 1e-3 * random.normal()).collect();
    let clock = find(&stamps, &[]);
    assert!(clock.regular && (clock.period - 0.01).abs() < 1e-6);
    // Long gaps part the pieces, and ticks count from each piece's first row.
    for piece in &clock.pieces {
        let first = truth[piece.rows.start];
        assert!(piece.rows.clone().all(|row| clock.ticks[row] == truth[row] - first));
    }
}

#[test]
fn few_rows_make_a_clock_too() {
    for rows in 2..12 {
        let stamps: Vec<f64> = (0..rows).map(|tick| 0.004 * f64::from(tick)).collect();
        let clock = find(&stamps, &[]);
        assert!(clock.regular && (clock.period - 0.004).abs() < 1e-12);
        assert_eq!(clock.ticks, (0..i64::from(rows)).collect::<Vec<_>>());
    }
}

#[test]
fn stamps_that_scatter_over_almost_a_period_do_not_bend_the_clock() {
    // Evenly, normally, or late by a queue's chance; all keep their order.
    for kind in 0..3 {
        for (rate, rows) in [(100.0, 3000), (250.0, 5000), (1000.0, 20_000)] {
            for (jitter, lost) in [(0.5, 0.05), (0.8, 0.0), (0.9, 0.02), (0.95, 0.0), (0.95, 0.05)] {
                let mut random = Random(kind + 17);
                let mut truth = ticks(&mut random, rows, lost);
                // A gap, too.
                truth.retain(|tick| !(rows / 3..rows / 3 + 40).contains(tick));
                let period = 1.0 / rate;
                let mut stamps: Vec<f64> = truth
                    .iter()
                    .map(|tick| {
                        let off = match kind {
                            0 => random.uniform(),
                            1 => 0.25 * random.normal(),
                            _ => -0.25 * random.uniform().max(1e-9).ln(),
                        };
                        period * (*tick as f64 + jitter * off)
                    })
                    .collect();
                for row in 1..stamps.len() {
                    stamps[row] = stamps[row].max(stamps[row - 1] + 1e-7 * period);
                }
                let clock = find(&stamps, &[]);
                let what = format!("kind {kind}, {rate} Hz, jitter {jitter}, lost {lost}");
                let off = (clock.period / period - 1.0).abs();
                assert!(clock.regular && off < 1e-4, "{what}: the period is off by {off:e}");
                assert_eq!(clock.pieces.len(), 2, "{what}");
                // A piece's own first row may be late: most of its rows show where it begins.
                let mut wrong = 0;
                for piece in &clock.pieces {
                    let mut off: Vec<i64> = piece.rows.clone().map(|row| clock.ticks[row] - truth[row]).collect();
                    let middle = off.len() / 2;
                    let usual = *off.select_nth_unstable(middle).1;
                    wrong += off.iter().filter(|off| **off != usual).count();
                }
                assert!(wrong * 50 < stamps.len(), "{what}: {wrong} rows on another tick");
            }
        }
    }
}

/// Samples at 1 kHz whose stamps scatter by 0.3 ms and are rounded to whole milliseconds: one row in seven has the stamp of the row before.
#[test]
fn coarse_stamps_have_a_clock() {
    let scatter = |row: usize| 0.3e-3 * (1.7 * row as f64).sin() * (0.3 * row as f64 * row as f64).cos();
    let mut time: Vec<f64> =
        (0..5000).map(|row| ((1e-3 * row as f64 + 0.25e-3 + scatter(row)) * 1e3).round() / 1e3).collect();
    for row in 1..time.len() {
        time[row] = time[row].max(time[row - 1].next_up());
    }
    let equal = time.windows(2).filter(|pair| pair[1] - pair[0] < 1e-9).count();
    assert!(equal > time.len() / 20, "{equal}");
    let clock = find(&time, &[]);
    assert!(clock.regular && (clock.period - 1e-3).abs() < 1e-9, "{}", clock.period);
    let wrong = (0..time.len()).filter(|&row| clock.ticks[row] != row as i64).count();
    assert_eq!(wrong, 0);
}
