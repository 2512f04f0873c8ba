//! Reading a recording and putting it on its clock: seven joints, 100 s at 1 kHz.

use recording::{Recording, Signal};

fn main() {
    divan::main();
}

const ROWS: usize = 100_000;

fn recording() -> Recording {
    let time: Vec<f64> = (0..ROWS).map(|k| k as f64 * 1e-3 + 1e-4 * (k as f64 * 1.7).sin()).collect();
    let signal = |scale: f64| -> Signal {
        (0..7)
            .map(|joint| (0..ROWS).map(|k| scale * (k as f64 * 1e-3 * (1.0 + f64::from(joint))).sin()).collect())
            .collect()
    };
    Recording {
        joints: (1..=7).map(|joint| format!("joint{joint}")).collect(),
        time,
        q: signal(1.0),
        qd: Some(signal(3.0)),
        tau: signal(40.0),
        ..Recording::default()
    }
}

#[divan::bench(sample_count = 5)]
fn csv(bencher: divan::Bencher<'_, '_>) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("r.csv");
    recording().write_csv(&path).expect("it writes");
    bencher.bench(|| Recording::read(&path).expect("it reads"));
}

#[divan::bench(sample_count = 5)]
fn regular(bencher: divan::Bencher<'_, '_>) {
    let recording = recording();
    bencher.bench(|| recording.regular().expect("it has a clock"));
}
