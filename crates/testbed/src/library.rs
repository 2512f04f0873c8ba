//! The scenarios and robots that come with testbed, and where others are found.

mod serial;

use std::ops::Range;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use arm::{Arm, ChainOptions};
pub use recording::nearest;
pub use serial::serial_urdf;

/// The files are part of the program, so that it runs from any folder.
const SCENARIOS: [(&str, &str); 4] = [
    ("taskA", include_str!("../../../scenarios/taskA.toml")),
    ("taskB", include_str!("../../../scenarios/taskB.toml")),
    ("taskC", include_str!("../../../scenarios/taskC.toml")),
    ("taskD", include_str!("../../../scenarios/taskD.toml")),
];

const ROBOTS: [(&str, &str); 2] = [
    ("puma560", include_str!("../../../assets/puma560.urdf")),
    ("seven_axis", include_str!("../../../assets/seven_axis.urdf")),
];

/// Motor inertias (kg m²) and gear ratios of the PUMA 560 (Corke and Armstrong-Hélouvry 1994), which its URDF leaves out.
const PUMA_DRIVES: [(f64, f64); 6] = [
    (200e-6, 62.6111),
    (200e-6, 107.815),
    (200e-6, 53.7063),
    (33e-6, 76.0364),
    (33e-6, 71.923),
    (33e-6, 76.686),
];

/// The text of a scenario and where it came from.
pub struct Source {
    /// The scenario's name.
    pub name: String,
    /// Its file, or `scenarios/<name>.toml` for one that comes with testbed.
    pub path: PathBuf,
    /// What it says.
    pub text: String,
}

impl Source {
    /// `file:line` of a range of bytes of the text.
    pub fn place(&self, span: Range<usize>) -> String {
        let before = &self.text.as_bytes()[..span.start.min(self.text.len())];
        let line = before.iter().filter(|byte| **byte == b'\n').count() + 1;
        format!("{}:{line}", self.path.display())
    }

    /// The line of the text that holds byte `position`, without its comment.
    pub fn line(&self, position: usize) -> &str {
        let position = self.text.floor_char_boundary(position.min(self.text.len()));
        let start = self.text[..position].rfind('\n').map_or(0, |newline| newline + 1);
        let line = self.text[start..].lines().next().unwrap_or_default();
        line.split('#').next().unwrap_or_default().trim()
    }
}

/// Finds the scenario `name`: a file if it ends in `.toml` or has a folder in it, else
/// `scenarios/<name>.toml` below the current folder, else one that comes with testbed.
///
/// # Errors
/// If there is none, with the names that there are.
pub fn find_scenario(name: &str) -> anyhow::Result<Source> {
    anyhow::ensure!(!name.is_empty(), "the name of a scenario is empty");
    let given = Path::new(name);
    let is_file = given.extension().is_some_and(|extension| extension == "toml") || given.components().count() > 1;
    let local = Path::new("scenarios").join(format!("{name}.toml"));
    let path = if is_file {
        given.to_owned()
    } else if local.is_file() {
        local
    } else if let Some(source) = built_in_scenario(name) {
        return Ok(source);
    } else {
        let mut known: Vec<String> = SCENARIOS.iter().map(|(name, _)| (*name).to_owned()).collect();
        known.extend(
            local_scenarios()
                .into_iter()
                .filter(|name| !SCENARIOS.iter().any(|(known, _)| known == name)),
        );
        let hint = nearest(name, &known).map_or(String::new(), |nearest| format!("did you mean {nearest}? "));
        bail!(
            "there is no scenario \"{name}\"; {hint}there are {}, or give the path of a .toml file",
            known.join(", ")
        );
    };
    let text = std::fs::read_to_string(&path).with_context(|| {
        format!(
            "{}: the scenario cannot be read; give the path of a .toml file, or a name such as taskD",
            path.display()
        )
    })?;
    let name = path
        .file_stem()
        .map_or(name.to_owned(), |stem| stem.to_string_lossy().into_owned());
    Ok(Source { name, path, text })
}

/// The scenario `name` that comes with testbed, whatever is below the current folder.
pub fn built_in_scenario(name: &str) -> Option<Source> {
    let (name, text) = SCENARIOS.iter().find(|(known, _)| *known == name)?;
    Some(Source {
        name: (*name).into(),
        path: Path::new("scenarios").join(format!("{name}.toml")),
        text: (*text).into(),
    })
}

/// The names of the scenarios below the current folder, sorted.
fn local_scenarios() -> Vec<String> {
    let entries = std::fs::read_dir("scenarios").into_iter().flatten().flatten();
    let mut names: Vec<String> = entries
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .filter_map(|path| path.file_stem().map(|stem| stem.to_string_lossy().into_owned()))
        .collect();
    names.sort();
    names
}

/// The names of the robots that come with testbed.
pub fn built_in() -> impl Iterator<Item = &'static str> {
    ROBOTS.iter().map(|(name, _)| *name)
}

/// The inertias of a robot's drives, seen at its joints (kg m²), as far as they are known beside its URDF.
pub fn rotor_inertias(robot: &str) -> Option<Vec<f64>> {
    let inertia = |(motor, gear): (f64, f64)| motor * gear * gear;
    (robot == "puma560").then(|| PUMA_DRIVES.map(inertia).to_vec())
}

/// Whether `robot` is the name of a robot that comes with testbed.
pub fn is_built_in(robot: &str) -> bool {
    ROBOTS.iter().any(|(known, _)| *known == robot)
}

/// The URDF of a robot.
pub struct RobotFile {
    /// Its file, or `assets/<name>.urdf` for one that comes with testbed.
    pub path: PathBuf,
    /// What it says.
    pub text: String,
}

impl RobotFile {
    /// The arm that `options` choose.
    ///
    /// # Errors
    /// If the text is no URDF, or has no such arm.
    pub fn arm(&self, options: &ChainOptions) -> anyhow::Result<Arm> {
        Ok(Arm::from_urdf_chain(&self.text, &self.path, options)?)
    }
}

/// The robot named on the command line: the path of a URDF, or the name of one that comes with testbed.
///
/// # Errors
/// If there is none.
pub fn named_robot(robot: &str) -> anyhow::Result<RobotFile> {
    let here = Source {
        name: String::new(),
        path: PathBuf::new(),
        text: String::new(),
    };
    find_robot(robot, &here).with_context(|| format!("--robot {robot}"))
}

/// The robot that a scenario names: the path of a URDF beside the scenario (or absolute), or the name of one that comes
/// with testbed.
///
/// # Errors
/// If there is none, or it cannot be read.
pub fn find_robot(robot: &str, scenario: &Source) -> anyhow::Result<RobotFile> {
    if let Some((name, text)) = ROBOTS.iter().find(|(known, _)| *known == robot) {
        let path = PathBuf::from(format!("assets/{name}.urdf"));
        let text = (*text).to_owned();
        return Ok(RobotFile { path, text });
    }
    let path = scenario.path.parent().unwrap_or(Path::new("")).join(robot);
    let is_path = Path::new(robot).extension().is_some_and(|e| e == "urdf" || e == "xml");
    if path.is_file() {
        refuse_no_xml(&path)?;
    } else if path.is_dir() {
        bail!("{}: is a folder; give the path of a .urdf file in it", path.display());
    } else if !is_path {
        let known: Vec<String> = ROBOTS.iter().map(|(name, _)| (*name).to_owned()).collect();
        let hint = nearest(robot, &known).map_or(String::new(), |nearest| format!("did you mean \"{nearest}\"? "));
        bail!(
            "there is no robot of this name; {hint}there are {}, or give the path of a .urdf file",
            known.join(", ")
        );
    }
    let text = std::fs::read_to_string(&path).map_err(|source| arm::ArmError::Read {
        path: path.clone(),
        source,
    })?;
    Ok(RobotFile { path, text })
}

/// Refuses a file that does not begin as XML does: a recording, say.
fn refuse_no_xml(path: &Path) -> anyhow::Result<()> {
    use std::io::Read;
    let mut start = Vec::new();
    let unread = || {
        format!(
            "{}:1: cannot be read; give a .urdf file that you may read",
            path.display()
        )
    };
    let file = std::fs::File::open(path).with_context(unread)?;
    file.take(4096).read_to_end(&mut start).with_context(unread)?;
    if start.starts_with(b"\xFF\xFE") || start.starts_with(b"\xFE\xFF") {
        bail!("{}:1: the text is UTF-16; save it as UTF-8", path.display());
    }
    let text = String::from_utf8_lossy(&start);
    let text = text.trim_start_matches('\u{FEFF}').trim_start();
    if text.is_empty() {
        bail!("{}:1: the file is empty; give the robot's URDF", path.display());
    }
    if !text.starts_with('<') {
        let line: String = text.lines().next().unwrap_or_default().chars().take(40).collect();
        bail!(
            "{}:1: is not a URDF, which is XML: it begins with \"{line}\"; give the robot's URDF here, recordings after \
             --train or --held-out",
            path.display()
        );
    }
    Ok(())
}
