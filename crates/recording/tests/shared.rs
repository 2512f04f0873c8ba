//! Recordings kept beside the repository (`../shared`): concealed hard cases and real robots.

use std::path::{Path, PathBuf};

use recording::{Quality, Recording, RegularRecording, Warning};

fn shared(folder: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared").join(folder)
}

fn csv_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).expect("the folder can be read").flatten() {
        let path = entry.path();
        if path.is_dir() {
            files.extend(csv_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "csv") {
            files.push(path);
        }
    }
    files.sort();
    files
}

fn load(path: &Path) -> (Recording, RegularRecording, Vec<Warning>) {
    let recording = Recording::read(path).unwrap_or_else(|error| panic!("{error}"));
    let (regular, found) = recording.regular().unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let warnings = [recording.warnings.clone(), found].concat();
    (recording, regular, warnings)
}

/// Each sample's distance from the cubic through its four neighbours, over its noise.
fn roughest(values: &[f64], noise: f64) -> f64 {
    let cubic = |k: usize| (4.0 * (values[k - 1] + values[k + 1]) - values[k - 2] - values[k + 2]) / 6.0;
    (2..values.len() - 2).map(|k| (values[k] - cubic(k)).abs() / noise).fold(0.0, f64::max)
}

/// The stamps of these cases jitter by a tenth of the period about a clock of whole hertz that ticks at 0 s.
#[test]
#[ignore = "needs ../shared"]
fn hard_cases_land_on_their_ticks() {
    let folder = shared("blind/hard");
    let (mut rows, mut wrong, mut worst) = (0, 0, 0.0_f64);
    for path in csv_files(&folder) {
        let (recording, regular, _) = load(&path);
        assert!(regular.has_clock, "{}", path.display());
        assert_eq!(regular.segments.len(), 1, "{}", path.display());
        let rate = (1.0 / regular.period).round();
        assert_eq!(regular.period, 1.0 / rate, "{}", path.display());
        let off = (regular.start * rate).round() / rate - regular.start;
        assert!(off.abs() < 0.02 * regular.period, "{}: phase off by {off} s", path.display());
        // A row's own tick by its stamp alone is right up to deviations of five standard deviations.
        let present = (0..regular.len()).filter(|&tick| regular.present[tick]);
        for (stamp, tick) in recording.time.iter().zip(present) {
            wrong += usize::from((regular.time(tick) - stamp).abs() > 0.5 * regular.period);
            rows += 1;
        }
        // A row at a wrong tick would differ by its velocity times the period, a few hundred times the noise.
        let quality = Quality::of(&recording, &regular);
        for (joint, q) in quality.joints.iter().zip(&regular.q) {
            let noise = joint.q_noise.max(joint.q_step.unwrap_or(0.0) / 12.0_f64.sqrt());
            worst = worst.max(roughest(q, noise));
        }
    }
    println!(
        "{rows} rows, {wrong} farther than half a period from their tick; roughest {worst:.1} standard deviations"
    );
    assert!(wrong <= rows / 100_000 + 1);
    assert!(worst < 40.0, "{worst}");
}

#[test]
#[ignore = "needs ../shared"]
fn real_recordings_are_read_and_measured() {
    let folder = shared("recordings");
    for path in csv_files(&folder) {
        let (recording, regular, warnings) = load(&path);
        // The stamps of the Panda are 0.7 to 8.8 ms apart: there is no clock, so that rows keep their times.
        let is_panda = path.parent().is_some_and(|folder| folder.ends_with("panda"));
        assert_eq!(regular.has_clock, !is_panda, "{}", path.display());
        if regular.has_clock {
            let rate = (1.0 / regular.period).round();
            assert!((1.0 / regular.period - rate).abs() < 0.01 * rate, "{}", path.display());
        }
        let quality = Quality::of(&recording, &regular);
        assert!(quality.joints.iter().any(|joint| joint.moves), "{}", path.display());
        println!("{}: {} rows, {} warnings", path.display(), recording.len(), warnings.len());
    }
    // Three runs one after the other, each with its own clock.
    let (recording, ..) = load(&folder.join("iiwa14/joints_3_to_7.csv"));
    assert_eq!(recording.breaks.len(), 2);
}
