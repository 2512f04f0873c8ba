//! Malicious recordings: compression bombs, computed tables, links out of the folder.

use std::io::Write;
use std::path::Path;

use recording::Recording;
use rusqlite::Connection;

/// The result of reading the file, and the largest number of bytes in memory.
fn refusal(path: &Path) -> (String, u64) {
    let mut error = None;
    let memory = allocation_counter::measure(|| error = Recording::read(path).err());
    (error.expect("it is refused").to_string(), memory.bytes_max)
}

/// 80 MB of zeros or digits, compressed to a thousandth.
fn bomb<W: Write>(mut packer: W, pattern: &[u8]) -> W {
    let block = pattern.repeat(1 << 16);
    for _ in 0..80 * (1 << 20) / block.len() {
        packer.write_all(&block).expect("it is packed");
    }
    packer
}

#[test]
fn bombs_are_refused_before_they_fill_the_memory() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("bomb");
    let rows = b"0.1,1,2\n";
    let gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    let zstandard = zstd::stream::write::Encoder::new(Vec::new(), 3).expect("an encoder");
    for packed in
        [bomb(gzip, rows).finish().expect("it is packed"), bomb(zstandard, rows).finish().expect("it is packed")]
    {
        assert!(packed.len() < 2_000_000, "{}", packed.len());
        std::fs::write(&path, packed).expect("it is written");
        let (error, most) = refusal(&path);
        assert!(error.contains("100 times its size") && most < 10_000_000, "{most} bytes: {error}");
    }
    // Version 5 of MATLAB's files: a header, and a compressed element.
    let zlib = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
    let packed = bomb(zlib, &[0; 8]).finish().expect("it is packed");
    let mut mat = vec![b' '; 124];
    mat[..8].copy_from_slice(b"MATLAB 5");
    mat.extend([0, 1, b'I', b'M', 15, 0, 0, 0]);
    mat.extend(u32::try_from(packed.len()).expect("it is short").to_le_bytes());
    mat.extend(packed);
    std::fs::write(&path, mat).expect("it is written");
    let (error, most) = refusal(&path);
    assert!(error.contains("hundred times") && most < 300_000_000, "{most} bytes: {error}");
}

/// A database whose tables are made by `statements`.
fn database(path: &Path, statements: &str) {
    let _ = std::fs::remove_file(path);
    let database = Connection::open(path).expect("it opens");
    database.execute_batch(statements).expect("they are good");
}

const TOPICS: &str = "CREATE TABLE topics(id INTEGER, name TEXT, type TEXT, serialization_format TEXT);
INSERT INTO topics VALUES (1, '/joint_states', 'sensor_msgs/msg/JointState', 'cdr');";

#[test]
fn tables_that_are_programs_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("bag.db3");
    let endless = "WITH RECURSIVE n(k) AS (SELECT 1 UNION ALL SELECT k + 1 FROM n)";
    let messages = "CREATE TABLE messages(topic_id INTEGER, timestamp INTEGER";
    for statements in [
        format!(
            "{TOPICS} CREATE VIEW messages AS {endless} SELECT 1 AS topic_id, k AS timestamp, zeroblob(1000) AS data FROM n;"
        ),
        format!(
            "CREATE VIEW topics AS {endless} SELECT k AS id, 'a' AS name, 'b' AS type, 'cdr' AS serialization_format FROM n; {messages}, data BLOB);"
        ),
        format!("{TOPICS} {messages}, data BLOB AS(zeroblob(900000000))); INSERT INTO messages VALUES (1, 1);"),
        format!("{TOPICS} {messages}, data BLOB);")
            .replace("serialization_format TEXT", "serialization_format TEXT AS(hex(zeroblob(400000000)))")
            .replace(", 'cdr')", ")"),
    ] {
        database(&path, &statements);
        let (error, most) = refusal(&path);
        assert!(error.contains("missing or computed") && most < 1_000_000, "{most} bytes: {error}");
    }
    database(&path, &format!("{TOPICS} {messages}, data BLOB);"));
    assert!(!refusal(&path).0.contains("computed"));
}

#[cfg(unix)]
#[test]
fn a_bag_reads_no_file_elsewhere() {
    let folder = tempfile::tempdir().expect("a folder");
    let (bag, elsewhere) = (folder.path().join("bag"), folder.path().join("elsewhere.mcap"));
    let recorded = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/formats/joint_states.mcap");
    std::fs::copy(recorded, &elsewhere).expect("it is copied");
    std::fs::create_dir(&bag).expect("a folder");
    std::os::unix::fs::symlink(&elsewhere, bag.join("bag_0.mcap")).expect("a link");
    let (error, _) = refusal(&bag);
    assert!(error.contains("bag_0.mcap is a link that leads out of the bag's folder"), "{error}");
    // A link to the bag itself was made by the user.
    std::fs::remove_file(bag.join("bag_0.mcap")).expect("it goes");
    std::fs::rename(&elsewhere, bag.join("bag_0.mcap")).expect("it moves");
    let link = folder.path().join("link");
    std::os::unix::fs::symlink(&bag, &link).expect("a link");
    assert!(Recording::read(&link).is_ok());
}
