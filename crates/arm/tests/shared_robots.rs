//! The URDFs of real robots load (`../shared`, which is not part of the repository).

use std::path::{Path, PathBuf};

use arm::Arm;

fn urdfs(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            urdfs(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "urdf") {
            found.push(path);
        }
    }
}

#[test]
#[ignore = "needs ../shared"]
fn robots_of_the_shared_recordings_load() {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    let mut found = Vec::new();
    urdfs(&shared, &mut found);
    assert!(!found.is_empty(), "there are no robots in {}", shared.display());
    for path in &found {
        let arm = Arm::from_urdf(path).unwrap_or_else(|error| panic!("{error}"));
        assert!((1..=10).contains(&arm.dof()), "{}: {} joints", path.display(), arm.dof());
    }
    println!("{} robots load", found.len());
}
