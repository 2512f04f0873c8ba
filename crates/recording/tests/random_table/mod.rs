//! Random tables with the errors of loggers.

use proptest::prelude::*;

#[path = "../../../../tests/properties.rs"]
mod properties;
pub use properties::config;

/// Rows of a time, positions and torques of some joints.
#[derive(Clone, Debug)]
pub struct Table {
    pub joints: Vec<String>,
    /// `t`, then `q_` of every joint, then `tau_` of every joint.
    pub rows: Vec<Vec<f64>>,
    /// The header's order.
    order: Vec<usize>,
}

impl Table {
    /// The table as CSV.
    pub fn csv(&self) -> Vec<u8> {
        let mut headers = vec!["t".to_owned()];
        headers.extend(self.joints.iter().map(|name| format!("q_{name}")));
        headers.extend(self.joints.iter().map(|name| format!("tau_{name}")));
        let line = |cell: &dyn Fn(usize) -> String| {
            let cells: Vec<String> = self.order.iter().map(|&column| cell(column)).collect();
            cells.join(",") + "\n"
        };
        let mut text = line(&|column| headers[column].clone());
        for row in &self.rows {
            text += &line(&|column| row[column].to_string());
        }
        text.into_bytes()
    }

    /// The table with its first `by` columns moved to the end.
    pub fn with_turned_columns(&self, by: usize) -> Self {
        let mut turned = self.clone();
        let length = turned.order.len();
        turned.order.rotate_left(by % length);
        turned
    }
}

/// An error in a part of the rows.
#[derive(Clone, Debug)]
enum Accident {
    /// Rows that were not written.
    Lost { at: f64, rows: usize },
    /// A pause (s).
    Pause { at: f64, seconds: f64 },
    /// A wrong value in one column.
    Spike { at: f64, column: usize, value: f64 },
    /// A column that is constant for some rows.
    Held { at: f64, rows: usize, column: usize },
    /// A row that is repeated.
    Twice { at: f64 },
    /// The time starts anew.
    Restart { at: f64 },
    /// Two rows in the wrong order.
    Swapped { at: f64 },
}

fn accidents(bad: bool) -> impl Strategy<Value = Accident> {
    let at = || 0.0..1.0_f64;
    let column = 0..20_usize;
    let good = prop_oneof![
        (at(), 1..12_usize).prop_map(|(at, rows)| Accident::Lost { at, rows }),
        (at(), 0.5..100.0_f64).prop_map(|(at, seconds)| Accident::Pause { at, seconds }),
        (at(), column.clone(), -50.0..50.0_f64).prop_map(|(at, column, value)| Accident::Spike { at, column, value }),
        (at(), 2..40_usize, column.clone()).prop_map(|(at, rows, column)| Accident::Held { at, rows, column }),
    ];
    let wrong = prop_oneof![
        at().prop_map(|at| Accident::Twice { at }),
        at().prop_map(|at| Accident::Restart { at }),
        at().prop_map(|at| Accident::Swapped { at }),
        (at(), column, prop::sample::select(vec![f64::NAN, f64::INFINITY, 1e300, -1e9, 1e-320]))
            .prop_map(|(at, column, value)| Accident::Spike { at, column, value }),
    ];
    if bad { prop_oneof![5 => good, 1 => wrong].boxed() } else { good.boxed() }
}

fn happen(rows: &mut Vec<Vec<f64>>, accident: &Accident) {
    let place = |at: f64, rows: &[Vec<f64>]| ((at * rows.len() as f64) as usize).min(rows.len() - 1);
    match *accident {
        Accident::Lost { at, rows: lost } => {
            let at = place(at, rows);
            let end = (at + lost).min(rows.len());
            if rows.len() - (end - at) >= 2 {
                rows.drain(at..end);
            }
        }
        Accident::Pause { at, seconds } => {
            let at = place(at, rows);
            for row in &mut rows[at..] {
                row[0] += seconds;
            }
        }
        Accident::Spike { at, column, value } => {
            let (at, width) = (place(at, rows), rows[0].len());
            rows[at][1 + column % (width - 1)] = value;
        }
        Accident::Held { at, rows: held, column } => {
            let (at, width) = (place(at, rows), rows[0].len());
            let column = 1 + column % (width - 1);
            let value = rows[at][column];
            for row in rows.iter_mut().skip(at).take(held) {
                row[column] = value;
            }
        }
        Accident::Twice { at } => {
            let at = place(at, rows);
            let row = rows[at].clone();
            rows.insert(at, row);
        }
        Accident::Restart { at } => {
            let at = place(at, rows);
            let from = rows[at][0];
            for row in &mut rows[at..] {
                row[0] -= from;
            }
        }
        Accident::Swapped { at } => {
            let at = place(at, rows);
            if at > 0 {
                rows.swap(at - 1, at);
            }
        }
    }
}

/// Recordings of 1 to 4 joints and 2 to 400 rows at 20 Hz to 2 kHz, with jitter and accidents; with `bad` ones, some cannot be read.
pub fn tables(bad: bool) -> impl Strategy<Value = Table> {
    (
        1..=4_usize,
        prop_oneof![1 => 2..20_usize, 5 => 20..400_usize],
        prop::sample::select(vec![20.0, 100.0, 250.0, 333.3, 1000.0, 2000.0_f64]),
        prop_oneof![Just(0.0), Just(0.02), Just(0.2)],
        prop::sample::select(vec![0.0, 5.0, 1_700_000_000.0]),
        prop::collection::vec(accidents(bad), 0..6),
        any::<u32>(),
    )
        .prop_map(|(joints, length, rate, jitter, start, accidents, seed)| {
            let mut random = u64::from(seed);
            let mut unit = move || {
                random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (random >> 33) as f64 / f64::from(1_u32 << 31)
            };
            let speeds: Vec<f64> = (0..2 * joints).map(|_| 0.2 + 8.0 * unit()).collect();
            let mut rows: Vec<Vec<f64>> = Vec::new();
            for k in 0..length {
                let t = k as f64 / rate;
                let stamp = start + t + jitter * (unit() - 0.5) / rate;
                let mut row = vec![(stamp * 1e7).round() / 1e7];
                row.extend(speeds.iter().map(|speed| (1e6 * (speed * t).sin()).round() / 1e6 + 1e-4 * unit()));
                rows.push(row);
            }
            for accident in &accidents {
                happen(&mut rows, accident);
            }
            Table {
                joints: ["base", "arm", "hand", "tip"][..joints].iter().map(|name| (*name).to_owned()).collect(),
                order: (0..=2 * joints).collect(),
                rows,
            }
        })
}
