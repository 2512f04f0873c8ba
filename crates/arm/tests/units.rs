//! Units of a URDF that its own numbers put into doubt.

use std::path::{Path, PathBuf};

use arm::Arm;

/// Factors on lengths, centres of mass, masses and moments of inertia.
struct Factors(f64, f64, f64, f64);

/// A slender arm of four links, each with 2 kg and 0.3 m.
fn arm(Factors(length, com, mass, inertia): Factors) -> Arm {
    let mut text = String::from("<robot name=\"four\"><link name=\"base\"/>");
    let mut parent = "base".to_owned();
    for link in 0..4 {
        let (x, at) = (if link == 0 { 0.0 } else { 0.3 * length }, 0.15 * com);
        let (mass, moment) = (2.0 * mass, 0.015 * inertia);
        text += &format!(
            "<joint name=\"j{link}\" type=\"revolute\"><parent link=\"{parent}\"/><child link=\"l{link}\"/>\
             <origin xyz=\"{x} 0 0\"/><axis xyz=\"0 1 0\"/><limit lower=\"-3\" upper=\"3\" effort=\"50\" velocity=\"3\"/></joint>\
             <link name=\"l{link}\"><inertial><origin xyz=\"{at} 0 0\"/><mass value=\"{mass}\"/>\
             <inertia ixx=\"{moment}\" ixy=\"0\" ixz=\"0\" iyy=\"{moment}\" iyz=\"0\" izz=\"{moment}\"/></inertial></link>"
        );
        parent = format!("l{link}");
    }
    Arm::from_urdf_text(&(text + "</robot>"), "four.urdf").expect("an arm")
}

#[test]
fn other_units_than_those_of_a_urdf_are_doubted() {
    for (factors, expected) in [
        (Factors(1e3, 1.0, 1.0, 1.0), "lengths seem to be in mm"),
        (Factors(1e3, 1e3, 1.0, 1.0), "lengths seem to be in mm"),
        (Factors(1.0, 1e3, 1.0, 1.0), "centres of mass seem to be in mm"),
        (Factors(1.0, 1.0, 1e3, 1e3), "masses seem to be in g"),
        (Factors(1.0, 1.0, 1.0, 1e6), "kg mm²"),
    ] {
        let doubts = arm(factors).doubtful_units();
        assert!(doubts.len() == 1 && doubts[0].contains(expected), "{expected}: {doubts:?}");
    }
    for factors in [Factors(1.0, 1.0, 1.0, 1.0), Factors(1.0, 1.0, 5.0, 5.0), Factors(1.0, 1.0, 1.0, 1e-3)] {
        assert_eq!(arm(factors).doubtful_units(), Vec::<String>::new());
    }
}

#[test]
fn moments_of_inertia_of_points_are_noted() {
    let notes = |inertia| arm(Factors(1.0, 1.0, 1.0, inertia)).warnings().to_vec();
    assert!(notes(1e-6).iter().any(|note| note.contains("at most 0.09 mm")), "{:?}", notes(1e-6));
    assert_eq!([notes(1.0), notes(0.1)].concat(), Vec::<String>::new());
}

/// A wrist whose axes meet has no length to compare its bodies with.
#[test]
fn an_arm_without_a_length_is_not_judged() {
    let arm = arm(Factors(0.0, 0.0, 1.0, 1e6));
    assert_eq!(arm.doubtful_units(), Vec::<String>::new());
}

#[test]
fn no_robot_of_the_repository_is_doubted() {
    let folders = ["tests/robots", "../../assets", "../../examples"];
    assert!(not_doubted(&folders) > 4);
}

#[test]
#[ignore = "needs the recordings of ../shared"]
fn no_real_robot_is_doubted() {
    assert!(not_doubted(&["../../../shared/recordings"]) > 9);
}

/// The number of URDFs in these folders, none of which is doubted.
fn not_doubted(folders: &[&str]) -> usize {
    let mut files: Vec<PathBuf> = folders.iter().flat_map(|folder| urdfs(folder.as_ref())).collect();
    files.retain(|file| {
        let arm = Arm::from_urdf(file).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(arm.doubtful_units(), Vec::<String>::new(), "{}", file.display());
        true
    });
    files.len()
}

fn urdfs(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("the folder is there");
    entries
        .flat_map(|entry| match entry.expect("it reads").path() {
            path if path.is_dir() => urdfs(&path),
            path if path.extension().is_some_and(|end| end == "urdf") => vec![path],
            _ => Vec::new(),
        })
        .collect()
}
