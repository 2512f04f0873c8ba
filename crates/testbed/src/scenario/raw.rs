//! A scenario as it is written in TOML; only its structure is checked.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;

use anyhow::anyhow;
use serde::Deserialize;
use toml::Spanned;

use study::Source;

/// One number for all joints, or a list with one per joint.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged, expecting = "a number, or a list of numbers with one per joint")]
pub enum PerJoint {
    All(f64),
    Each(Vec<f64>),
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawScenario {
    pub title: Option<String>,
    pub robot: Spanned<String>,
    #[serde(default)]
    pub chain: RawChain,
    pub duration: Spanned<f64>,
    #[serde(default)]
    pub model: RawModel,
    pub reference: Spanned<RawReference>,
    #[serde(default)]
    pub controller: RawController,
    #[serde(default)]
    pub training: RawTraining,
    #[serde(default)]
    pub plant: RawPlant,
    #[serde(default)]
    pub sensors: RawSensors,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawChain {
    pub base: Option<String>,
    pub tip: Option<String>,
    #[serde(default)]
    pub lock: BTreeMap<String, f64>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawModel {
    pub kind: Option<Spanned<String>>,
    pub inertia_scale: Option<Spanned<f64>>,
    pub length_scales: Option<Spanned<String>>,
    pub fade: Option<bool>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawReference {
    pub file: Option<Spanned<PathBuf>>,
    pub cutoff: Option<Spanned<f64>>,
    pub amplitude: Option<Spanned<PerJoint>>,
    pub frequency_1: Option<Spanned<PerJoint>>,
    pub frequency_2: Option<Spanned<PerJoint>>,
    pub centre: Option<Spanned<PerJoint>>,
    pub fade: Option<Spanned<f64>>,
    #[serde(default)]
    pub sines: Vec<RawSine>,
    pub sample_rate: Option<Spanned<f64>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawSine {
    pub amplitude: Spanned<PerJoint>,
    pub frequency: Spanned<PerJoint>,
    pub phase: Option<Spanned<PerJoint>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawController {
    pub rate: Option<Spanned<f64>>,
    pub feedback: Option<Spanned<String>>,
    pub kp: Option<Spanned<PerJoint>>,
    pub kd: Option<Spanned<PerJoint>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawTraining {
    #[serde(default)]
    pub scenarios: Vec<String>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawPlant {
    pub rotor_inertia: Option<Spanned<PerJoint>>,
    pub viscous_friction: Option<Spanned<PerJoint>>,
    pub coulomb_friction: Option<Spanned<PerJoint>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawSensors {
    pub position_noise: Option<Spanned<PerJoint>>,
    pub velocity_noise: Option<Spanned<PerJoint>>,
    pub torque_noise: Option<Spanned<PerJoint>>,
}

/// Examples of the required keys.
const EXAMPLES: [(&str, &str); 6] = [
    ("robot", ": robot = \"puma560\", or the path of a URDF"),
    ("duration", ": duration = 10.0 (s)"),
    ("reference", ": [reference], with amplitude, frequency_1 and frequency_2"),
    ("amplitude", ": amplitude = 0.5 (rad or m)"),
    ("frequency", ": frequency = 0.2 (Hz)"),
    ("scenarios", ": scenarios = [\"taskA\"]"),
];

/// Parses the text of a scenario.
///
/// # Errors
/// In one line: file, line and reason; for an unknown key, also the most similar known one.
pub fn parse(source: &Source) -> anyhow::Result<RawScenario> {
    toml::from_str(&source.text).map_err(|error| {
        if let Some(key) = error.message().strip_prefix("missing field `") {
            let key = key.trim_end_matches('`');
            let example = EXAMPLES.iter().find(|(known, _)| *known == key).map_or("", |(_, example)| example);
            let place = source.place(error.span().unwrap_or(Range { start: 0, end: 0 }));
            return anyhow!("{place}: the key `{key}` is missing; add it{example}");
        }
        let place = source.place(error.span().unwrap_or(Range { start: 0, end: 0 }));
        let written = source.line(error.span().map_or(0, |span| span.start));
        anyhow!("{place}: `{written}`: {}", recording::toml_reason(error.message()))
    })
}
