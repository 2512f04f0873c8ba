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
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).expect("it compresses");
    encoder.finish().expect("it compresses")
}

#[test]
fn a_file_that_expands_without_end_is_refused_with_the_limit() {
    let zeros = vec![b'0'; 100 << 20];
    let packed = gzip(&zeros);
    // At most 64 MiB and 100 times what was read so far.
    let found = refusal(&packed);
    let said: Vec<u64> = found.split(' ').filter_map(|word| word.parse().ok()).collect();
    let most = ((64 << 20) + 100 * packed.len() as u64) / 1_000_000;
    assert!(said[0] > 64 && said[0] <= most && said[1] == 100, "{found}");
    assert!(found.contains("r.csv.gz: gzip: it expands to more than"), "{found}");
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
