//! Compressed files that are damaged, or that expand without end.

use std::io::Write;

use flate2::Compression;
use flate2::write::GzEncoder;

use crate::Recording;

fn refusal(bytes: &[u8]) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("r.csv.gz");
    std::fs::write(&path, bytes).expect("it writes");
    Recording::read(&path).expect_err("it is refused").to_string()
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes).expect("it compresses");
    encoder.finish().expect("it compresses")
}

#[test]
fn a_file_that_expands_without_end_is_refused_with_the_limit() {
    let zeros = vec![b'0'; 200 << 20];
    let packed = gzip(&zeros);
    let limit = (64 << 20) + 100 * packed.len();
    let found = refusal(&packed);
    let said = format!(
        "it expands to more than {} MB, over 100 times its size",
        limit / 1_000_000
    );
    assert!(found.contains("r.csv.gz: gzip: ") && found.contains(&said), "{found}");
    let packed = zstd::stream::encode_all(&zeros[..], 1).expect("it compresses");
    let found = refusal(&packed);
    assert!(found.contains("zstd: it expands to more than"), "{found}");
}

#[test]
fn a_cut_file_is_refused_as_such() {
    let text: String = (0..1000).map(|k| format!("{k},{},{}\n", k * k, k * 7)).collect();
    let packed = gzip(text.as_bytes());
    let found = refusal(&packed[..packed.len() / 2]);
    assert!(found.contains("damaged or cut"), "{found}");
}
