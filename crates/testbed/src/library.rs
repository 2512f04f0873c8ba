//! The scenarios that come with testbed, and where others are found.

mod serial;

use std::path::Path;

use anyhow::{Context, bail};
use recording::nearest;
pub use serial::serial_urdf;
use study::Source;

/// The largest number of scenarios that a message lists.
const MOST_LISTED: usize = 20;

/// The files are part of the program, so that it runs from any folder.
const SCENARIOS: [(&str, &str); 5] = [
    ("taskA", include_str!("../scenarios/taskA.toml")),
    ("taskB", include_str!("../scenarios/taskB.toml")),
    ("taskC", include_str!("../scenarios/taskC.toml")),
    ("taskD", include_str!("../scenarios/taskD.toml")),
    ("beyond", include_str!("../scenarios/beyond.toml")),
];

/// Motor inertias (kg m²) and gear ratios of robots whose URDFs omit them. PUMA 560: Corke and Armstrong-Hélouvry 1994.
const DRIVES: &[(&str, &[(f64, f64)])] = &[(
    "puma560",
    &[(200e-6, 62.6111), (200e-6, 107.815), (200e-6, 53.7063), (33e-6, 76.0364), (33e-6, 71.923), (33e-6, 76.686)],
)];

/// Finds the scenario `name`: a file if the name ends in `.toml` or contains a folder; otherwise `scenarios/<name>.toml`
/// below the current folder; otherwise a scenario that comes with testbed.
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
        known.extend(local_scenarios().into_iter().filter(|name| !SCENARIOS.iter().any(|(known, _)| known == name)));
        let hint = nearest(name, &known).map_or(String::new(), |nearest| format!("did you mean {nearest}? "));
        let listed = known.iter().take(MOST_LISTED).map(String::as_str).collect::<Vec<_>>().join(", ");
        let more = match known.len().saturating_sub(MOST_LISTED) {
            0 => String::new(),
            more => format!(" and {more} more under scenarios/"),
        };
        bail!("there is no scenario \"{name}\"; {hint}there are {listed}{more}, or give the path of a .toml file");
    };
    let text = std::fs::read_to_string(&path).with_context(|| {
        format!(
            "{}: the scenario cannot be read; give the path of a .toml file, or a name such as taskD",
            path.display()
        )
    })?;
    let name = path.file_stem().map_or(name.to_owned(), |stem| stem.to_string_lossy().into_owned());
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

/// The reflected inertias of a robot's drives at its joints (kg m²), which its URDF does not contain; `None` if they are
/// unknown.
pub fn rotor_inertias(robot: &str) -> Option<Vec<f64>> {
    let (_, drives) = DRIVES.iter().find(|(name, _)| *name == robot)?;
    Some(drives.iter().map(|(motor, gear)| motor * gear * gear).collect())
}
