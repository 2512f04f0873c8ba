//! Files that nobody vouches for: the fuzz targets' corpus (`fuzz/corpus`), replayed and mutated by a seeded generator. None may panic, and
//! none may ask for more memory than its size justifies.
//!
//! `UNTRUSTED_ROUNDS=1000` tries as many mutations of each file; `UNTRUSTED_SEED=7` tries others.

#[path = "../../crates/testbed/src/viewer/mesh.rs"]
mod mesh;
#[path = "../../fuzz/src/targets.rs"]
mod targets;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use rand::seq::IndexedRandom;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// What a file may ask for: that which a compressed one may expand to (64 MB and a hundred times its size), and its table.
fn most_memory(length: usize) -> u64 {
    2 * ((64 << 20) + 100 * length as u64)
}

/// Larger files are not mutated: they take long, and small ones have the same parts.
const LARGEST: u64 = 40_000;

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("the folder is there").flatten() {
        let path = entry.path();
        if path.is_dir() {
            files(&path, found);
        } else if path.extension().is_none_or(|extension| extension != "py") {
            found.push(path);
        }
    }
}

/// The seeds of a target, by name.
fn corpus(folders: &[&str]) -> Vec<Vec<u8>> {
    let mut found = Vec::new();
    for folder in folders {
        files(&root().join(folder), &mut found);
    }
    found.sort();
    let small = found.iter().filter(|path| path.metadata().expect("it is there").len() <= LARGEST);
    small.map(|path| std::fs::read(path).expect("it can be read")).collect()
}

fn setting(name: &str, usual: u64) -> u64 {
    std::env::var(name).map(|text| text.parse().expect("a number")).unwrap_or(usual)
}

/// Words and numbers at which parsers go wrong.
const SPLINTERS: [&[u8]; 22] = [
    b"nan",
    b"-inf",
    b"1e999",
    b"1e-320",
    b"-0",
    b"9223372036854775808",
    b"\"",
    b"'",
    b"\n",
    b"\0",
    b"\xff\xff\xff\xff",
    b"\xff\xff\xff\x7f",
    b"\0\0\0\x80",
    b"\x01\0\0\0\0\0\0\0",
    b"<a>",
    b"<!DOCTYPE r [<!ENTITY a \"b\">]>",
    b"&a;",
    b"[[",
    b"{",
    b",,",
    b"=",
    b"\xc3\xa9",
];

/// A changed copy of `seed`, with pieces of `other`.
fn mutated(seed: &[u8], other: &[u8], random: &mut ChaCha8Rng) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    let place = |length: usize, random: &mut ChaCha8Rng| random.random_range(0..=length);
    let range = |length: usize, random: &mut ChaCha8Rng| {
        let from = place(length, random);
        from..(from + random.random_range(0..64)).min(length)
    };
    for _ in 0..random.random_range(1..=6) {
        let at = place(bytes.len(), random);
        match random.random_range(0..7) {
            0 if at < bytes.len() => bytes[at] ^= 1 << random.random_range(0..8),
            1 if at < bytes.len() => bytes[at] = random.random(),
            2 => bytes.truncate(at),
            3 => {
                bytes.drain(range(bytes.len(), random));
            }
            4 => {
                let piece = other[range(other.len(), random)].to_vec();
                bytes.splice(at..at, piece);
            }
            5 => {
                let piece = bytes[range(bytes.len(), random)].to_vec();
                let end = (at + piece.len()).min(bytes.len());
                bytes.splice(at..end, piece);
            }
            _ => {
                let splinter = SPLINTERS.choose(random).expect("there are some");
                let end = (at + random.random_range(0..8)).min(bytes.len());
                bytes.splice(at..end, splinter.iter().copied());
            }
        }
    }
    bytes
}

/// Tries the corpus in `folders`, and `rounds` mutations of each of its files.
fn check(name: &str, folders: &[&str], rounds: u64, target: fn(&[u8])) {
    let seeds = corpus(folders);
    assert!(!seeds.is_empty(), "{name} has no corpus");
    let mut random = ChaCha8Rng::seed_from_u64(setting("UNTRUSTED_SEED", 1));
    let rounds = setting("UNTRUSTED_ROUNDS", rounds);
    let tried = |bytes: &[u8]| {
        let mut whole = false;
        let memory = allocation_counter::measure(|| {
            whole = catch_unwind(AssertUnwindSafe(|| target(bytes))).is_ok();
        });
        let bounded = memory.bytes_max <= most_memory(bytes.len());
        if !whole || !bounded {
            let kept = std::env::temp_dir().join(format!("untrusted_{name}"));
            std::fs::write(&kept, bytes).expect("it can be written");
            let most = memory.bytes_max;
            panic!("{name}: {} bytes panic or ask for {most} bytes; they are kept as {}", bytes.len(), kept.display());
        }
    };
    for seed in &seeds {
        tried(seed);
        for _ in 0..rounds {
            let other = seeds.choose(&mut random).expect("there are some");
            tried(&mutated(seed, other, &mut random));
        }
    }
}

#[test]
fn robots() {
    check("urdf", &["fuzz/corpus/urdf", "crates/arm/tests/robots"], 300, targets::urdf);
}

#[test]
fn recordings() {
    let folders = [
        "fuzz/corpus/csv",
        "fuzz/corpus/mcap",
        "fuzz/corpus/parquet",
        "fuzz/corpus/recording_bytes",
        "crates/recording/tests/formats",
    ];
    check("recording", &folders, 100, targets::recording);
}

#[test]
fn scenarios() {
    check("scenario", &["fuzz/corpus/scenario", "scenarios"], 400, targets::scenario);
}

#[test]
fn column_maps() {
    check("column_map", &["fuzz/corpus/column_map", "assets/maps"], 200, targets::column_map);
}

#[test]
fn models() {
    check("model", &["fuzz/corpus/model"], 400, targets::model);
}

#[test]
fn truths() {
    check("truth", &["fuzz/corpus/truth"], 400, targets::truth);
}
