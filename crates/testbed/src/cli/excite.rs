//! The arguments of `testbed excite`.

use std::path::PathBuf;

use clap::Args;

use super::chain::ChainArgs;
use super::numbers::parse_frequency;
use crate::output::OutputFile;

/// A limit of one joint, or of all joints if no joint is named.
pub type Limit<T> = (Option<String>, T);

#[derive(Debug, Args)]
pub struct ExciteArgs {
    /// The robot: a URDF, or the name of a robot included in testbed
    #[arg(long, value_name = "NAME|URDF")]
    pub robot: String,

    /// Write the motion to this file as a scenario (.toml), for testbed --scenario
    #[arg(long, value_name = "OUT")]
    pub scenario: Option<PathBuf>,

    /// Write the motion to this file as references (.csv): t, and q_, qd_ and qdd_ of every joint
    #[arg(long, value_name = "OUT")]
    pub csv: Option<PathBuf>,

    /// The rate of the rows of --csv (Hz)
    #[arg(long, value_name = "HZ", default_value_t = 250.0, value_parser = parse_frequency)]
    pub rate: f64,

    /// The duration of the motion (s)
    #[arg(long, value_name = "SECONDS", default_value_t = 25.0, value_parser = parse_duration)]
    pub duration: f64,

    /// The lowest and the highest position (rad or m), in place of the URDF's; of all joints without JOINT=
    #[arg(long, value_name = "[JOINT=]LOW:HIGH", value_parser = parse_range, allow_hyphen_values = true)]
    pub position_limit: Vec<Limit<[f64; 2]>>,

    /// The largest speed (rad/s or m/s), in place of the URDF's
    #[arg(long, value_name = "[JOINT=]VALUE", value_parser = parse_limit)]
    pub velocity_limit: Vec<Limit<f64>>,

    /// The largest acceleration (rad/s² or m/s²), which a URDF does not have
    #[arg(long, value_name = "[JOINT=]VALUE", value_parser = parse_limit)]
    pub acceleration_limit: Vec<Limit<f64>>,

    /// The largest torque (N m) or force (N), in place of the URDF's
    #[arg(long, value_name = "[JOINT=]VALUE", value_parser = parse_limit)]
    pub effort_limit: Vec<Limit<f64>>,

    /// Also measure the motion of these recordings beside the proposed one
    #[arg(long, num_args = 1.., value_name = "FILE")]
    pub compare: Vec<PathBuf>,

    /// The seed of the search
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,

    #[command(flatten)]
    pub chain: ChainArgs,
}

impl ExciteArgs {
    /// The files that will be written.
    pub fn outputs(&self) -> Vec<OutputFile<'_>> {
        let files = [
            OutputFile::given("--scenario", self.scenario.as_deref(), &["toml"]),
            OutputFile::given("--csv", self.csv.as_deref(), &["csv"]),
        ];
        files.into_iter().flatten().collect()
    }
}

fn parse_duration(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if (5.0..=600.0).contains(&seconds) => Ok(seconds),
        _ => Err("give a duration from 5 to 600 s".into()),
    }
}

/// The joint before the last `=`, and the rest.
fn split(text: &str) -> (Option<String>, &str) {
    match text.rsplit_once('=') {
        Some((joint, value)) => (Some(joint.to_owned()), value),
        None => (None, text),
    }
}

fn parse_limit(text: &str) -> Result<Limit<f64>, String> {
    let (joint, value) = split(text);
    match value.parse() {
        Ok(value) if value > 0.0 && f64::is_finite(value) => Ok((joint, value)),
        _ => Err("give VALUE or JOINT=VALUE with a positive number, for example elbow=1.5".into()),
    }
}

fn parse_range(text: &str) -> Result<Limit<[f64; 2]>, String> {
    let (joint, range) = split(text);
    let numbers =
        range.split_once(':').and_then(|(low, high)| Some([low.parse::<f64>().ok()?, high.parse::<f64>().ok()?]));
    match numbers {
        Some([low, high]) if low < high && low.is_finite() && high.is_finite() => Ok((joint, [low, high])),
        _ => Err("give LOW:HIGH or JOINT=LOW:HIGH with two increasing numbers, for example elbow=-1.2:0.8".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_parse() {
        assert_eq!(parse_limit("1.5"), Ok((None, 1.5)));
        assert_eq!(parse_limit("a=b=2"), Ok((Some("a=b".into()), 2.0)));
        assert_eq!(parse_range("elbow=-1.2:0.8"), Ok((Some("elbow".into()), [-1.2, 0.8])));
        assert_eq!(parse_range("-1:1"), Ok((None, [-1.0, 1.0])));
        for wrong in ["", "a=", "0", "-1", "nan", "inf"] {
            assert!(parse_limit(wrong).is_err(), "{wrong}");
        }
        for wrong in ["", "1", "1:0", "a=1:1", "nan:1", "0:inf"] {
            assert!(parse_range(wrong).is_err(), "{wrong}");
        }
    }
}
