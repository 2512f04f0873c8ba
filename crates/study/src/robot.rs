//! The robots that come with testbed, and the search for others.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use arm::{Arm, ChainOptions};
use recording::nearest;

/// The files are part of the program, so that it runs from any folder.
const ROBOTS: [(&str, &str); 2] =
    [("puma560", include_str!("../robots/puma560.urdf")), ("seven_axis", include_str!("../robots/seven_axis.urdf"))];

/// The names of the robots that come with testbed.
pub fn built_in() -> impl Iterator<Item = &'static str> {
    ROBOTS.iter().map(|(name, _)| *name)
}

/// Whether `robot` is the name of a robot that comes with testbed.
pub fn is_built_in(robot: &str) -> bool {
    ROBOTS.iter().any(|(known, _)| *known == robot)
}

/// The URDF of a robot.
#[derive(Clone, Debug)]
pub struct RobotFile {
    /// Its file, or `assets/<name>.urdf` for one that comes with testbed.
    pub path: PathBuf,
    /// The text of the file.
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

/// The robot of a command line: the path of a URDF, or the name of one that comes with testbed.
///
/// # Errors
/// If there is none.
pub fn named_robot(robot: &str) -> anyhow::Result<RobotFile> {
    find_robot(robot, Path::new("")).context("--robot")
}

/// The robot that is named in a file of `folder`: the path of a URDF beside that file (or absolute), or the name of one
/// that comes with testbed.
///
/// # Errors
/// If there is none, or it cannot be read; the error names the robot or its file once.
pub fn find_robot(robot: &str, folder: &Path) -> anyhow::Result<RobotFile> {
    if let Some((name, text)) = ROBOTS.iter().find(|(known, _)| *known == robot) {
        let path = PathBuf::from(format!("assets/{name}.urdf"));
        let text = (*text).to_owned();
        return Ok(RobotFile { path, text });
    }
    let path = folder.join(robot);
    let is_path = Path::new(robot).extension().is_some_and(|e| e == "urdf" || e == "xml");
    if path.is_file() {
        refuse_no_xml(&path)?;
    } else if path.is_dir() {
        bail!("{}: is a folder; give the path of a .urdf file in it", path.display());
    } else if !is_path {
        let known: Vec<String> = ROBOTS.iter().map(|(name, _)| (*name).to_owned()).collect();
        let hint = nearest(robot, &known).map_or(String::new(), |nearest| format!("did you mean \"{nearest}\"? "));
        bail!(
            "{robot}: there is no robot of this name; {hint}there are {}, or give the path of a .urdf file",
            known.join(", ")
        );
    }
    let bytes = std::fs::read(&path).map_err(|source| arm::ArmError::Read { path: path.clone(), source })?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = 1 + valid.iter().filter(|&&byte| byte == b'\n').count();
        anyhow::anyhow!(
            "{}:{line}: the text is not UTF-8; save it as UTF-8 (iconv -f ISO-8859-1 -t UTF-8, if it is Latin-1)",
            path.display()
        )
    })?;
    Ok(RobotFile { path, text })
}

/// Refuses a file that does not begin as XML does, such as a recording.
fn refuse_no_xml(path: &Path) -> anyhow::Result<()> {
    use std::io::Read;
    let mut start = Vec::new();
    let unread = || format!("{}:1: cannot be read; give a .urdf file that you may read", path.display());
    let file = std::fs::File::open(path).with_context(unread)?;
    file.take(4096).read_to_end(&mut start).with_context(unread)?;
    if start.starts_with(b"\xFF\xFE") || start.starts_with(b"\xFE\xFF") {
        bail!("{}:1: the text is UTF-16; save it as UTF-8", path.display());
    }
    let is_text = match std::str::from_utf8(&start) {
        Ok(_) => true,
        // The last character may be cut.
        Err(error) => error.error_len().is_none(),
    };
    let text = String::from_utf8_lossy(&start);
    let text = text.trim_start_matches('\u{FEFF}').trim_start();
    if text.is_empty() {
        bail!("{}:1: the file is empty; give the robot's URDF", path.display());
    }
    let is_binary = |c: char| c.is_control() && !c.is_whitespace();
    if !text.starts_with('<') && (!is_text || text.contains(is_binary)) {
        bail!(
            "{}: is not a URDF, which is XML, but a binary file; give the robot's URDF here, recordings after --train or \
             --held-out",
            path.display()
        );
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
