//! The robots of the file whose recordings exist, and copies of their files under the names of the protocol.

use std::path::Path;

use anyhow::{Context, ensure};
use arm::Arm;
use faults::sha256_of;

use super::file::{File, Robot};
use crate::output;
use crate::prove::case_paths::CasePaths;

/// The robots whose folders are in `recordings`, with their published values in SI units, and the names of the others.
///
/// # Errors
/// If there is none, a file of one is missing, or a published effect does not fit its URDF.
pub fn there(file: &File, recordings: &Path) -> anyhow::Result<(Vec<Robot>, Vec<String>)> {
    let (mut robots, mut absent) = (Vec::new(), Vec::new());
    for robot in &file.robots {
        let folder = recordings.join(&robot.name);
        if !folder.is_dir() {
            absent.push(robot.name.clone());
            continue;
        }
        for name in robot.files() {
            let path = folder.join(name);
            ensure!(
                path.is_file(),
                "{}: does not exist, and robot \"{}\" needs it; get it from {}",
                path.display(),
                robot.name,
                robot.source.url
            );
        }
        let arm = Arm::from_urdf(folder.join(&robot.urdf))?;
        let mut robot = robot.clone();
        robot.dof = arm.dof();
        robot.published = Some(file.published(&robot, &arm)?);
        robots.push(robot);
    }
    let looked = recordings.display();
    ensure!(
        !robots.is_empty(),
        "--recordings {looked}: has none of the folders {}; docs/real.md says where the recordings come from",
        absent.join(", ")
    );
    for name in &absent {
        output::say(format_args!("note: {looked}/{name}: does not exist; the robot is omitted"));
    }
    Ok((robots, absent))
}

/// The place of a robot's copies and of its published values in the proof's folder `out`.
pub fn place(number: usize, robot: &Robot, out: &Path) -> CasePaths {
    CasePaths {
        number,
        name: robot.name.clone(),
        folder: out.join("cases").join(&robot.name),
        truth: out.join("truth").join(format!("{}.json", robot.name)),
    }
}

/// The robot's files by their names, each with the name that the protocol has for it: `train_…` and `held_out_…`.
pub fn names(robot: &Robot) -> Vec<(String, String)> {
    let prefixed = |prefix: &'static str, list: &[String]| -> Vec<(String, String)> {
        list.iter().map(|name| (name.clone(), format!("{prefix}_{name}"))).collect()
    };
    let mut list = vec![(robot.urdf.clone(), "robot.urdf".to_owned())];
    list.extend(prefixed("train", &robot.train));
    list.extend(prefixed("held_out", &robot.held_out));
    list
}

/// Copies the robot's files from `folder` and writes its published values. Files that exist already must be equal.
///
/// # Errors
/// If a file cannot be copied, or was changed since it was copied.
pub fn stage(robot: &Robot, folder: &Path, place: &CasePaths) -> anyhow::Result<()> {
    std::fs::create_dir_all(&place.folder).with_context(|| place.folder.display().to_string())?;
    for (from, to) in names(robot) {
        let (from, to) = (folder.join(from), place.folder.join(to));
        if to.is_file() {
            ensure!(
                sha256_of(&from)? == sha256_of(&to)?,
                "{}: differs from the copy in {}; give another --out",
                from.display(),
                to.display()
            );
            continue;
        }
        let bytes = std::fs::read(&from).with_context(|| from.display().to_string())?;
        recording::write_whole(&to, |file| file.write_all(&bytes))?;
    }
    let known: Vec<String> = names(robot).into_iter().map(|(_, to)| to).collect();
    for entry in std::fs::read_dir(&place.folder)?.flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        ensure!(known.contains(&name), "{}: belongs to another proof; give another --out", entry.path().display());
    }
    output::write_json(&place.truth, &robot.published)
}
