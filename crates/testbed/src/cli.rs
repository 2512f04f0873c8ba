//! The command line.

use std::path::{Path, PathBuf};

use clap::{Args, Parser, Subcommand, ValueEnum};
use torque::{LengthScales, TrainingOptions};

mod numbers;

use crate::models::ModelKind;
use crate::prove::Shard;
use numbers::{parse_accuracy, parse_frequency, parse_urdf_error};

/// Tracking testbed and model diagnosis for robot arms
#[derive(Debug, Parser)]
#[command(
    version,
    about,
    args_conflicts_with_subcommands = true,
    arg_required_else_help = true
)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Option<Command>,
    #[command(flatten)]
    pub run: Option<RunArgs>,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Print tables I and II and figure 4 of the paper, with our results beside the published ones
    Tables(TablesArgs),
    /// Find the physical effects that a robot's model omits, from recordings
    Diagnose(DiagnoseArgs),
    /// Check the quality of recordings before anything is fitted to them
    Inspect(InspectArgs),
    /// Test the diagnosis blind: inject faults, seal the ground truth, diagnose, open the seal and score
    Prove(ProveArgs),
    /// Make recordings of a simulated robot with injected faults, and the ground truth in a separate file
    Conceal(ConcealArgs),
}

/// Run one scenario in closed loop.
#[derive(Debug, Args)]
pub struct RunArgs {
    /// The scenario: a name under scenarios/, or a .toml file
    #[arg(long, value_name = "NAME|FILE")]
    pub scenario: String,

    /// The feed-forward torque model of the controller [default: the scenario's, otherwise independent-joint]
    #[arg(long, value_enum)]
    pub model: Option<ModelKind>,

    /// The training data of the model: scenarios, or recordings [default: the scenario's list]
    #[arg(long, value_name = "A,B,…", value_delimiter = ',')]
    pub train: Option<Vec<String>>,

    /// The length scales of the regressions: one for all inputs, as in the paper, or one per input
    #[arg(long, value_enum, default_value = "one")]
    pub length_scales: LengthScalesArg,

    /// Output to Rerun: off, save[=FILE], spawn or connect[=URL] [default: save in the run's folder]
    #[cfg_attr(not(feature = "viewer"), arg(hide = true))]
    #[arg(long, value_name = "WHERE", value_parser = parse_rerun)]
    pub rerun: Option<Rerun>,

    /// The folder of the run [default: a new one under runs/]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,

    /// Also write the summary of the run to this file
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,

    /// The random seed, for the noise of the scenario's sensors
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
}

#[derive(Debug, Args)]
pub struct TablesArgs {
    /// The length scales of the regressions: one for all inputs, as in the paper, or one per input
    #[arg(long, value_enum, default_value = "one")]
    pub length_scales: LengthScalesArg,

    /// Also write the tables to this file
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct InspectArgs {
    /// The recordings: CSV, MCAP, rosbag2, Parquet, .npz or .mat, compressed or not
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,

    /// The robot's URDF, with which names, limits, signs and torques are compared
    #[arg(long, value_name = "URDF")]
    pub robot: Option<String>,

    /// The column map (.toml), for files with other headers or units
    #[arg(long, value_name = "MAP")]
    pub map: Option<PathBuf>,

    /// Write the complete result to this file as JSON
    #[arg(long, value_name = "OUT")]
    pub json: Option<PathBuf>,
}

/// The catalogue's effects, one a line.
fn effects_help() -> String {
    let line = |kind: &&dyn effects::EffectKind| format!("\n  {:<24} {}", kind.spec().name, kind.spec().meaning);
    let lines: String = effects::CATALOGUE.iter().map(line).collect();
    format!("Effects:{lines}")
}

#[derive(Debug, Args)]
#[command(after_long_help = effects_help())]
pub struct DiagnoseArgs {
    /// The robot's URDF
    #[arg(long, value_name = "URDF")]
    pub robot: String,

    /// The training recordings, to which the effects are fitted
    #[arg(long, required = true, num_args = 1.., value_name = "FILE")]
    pub train: Vec<PathBuf>,

    /// Recordings of the same robot from before something happened: what the other recordings show and these do not is
    /// what changed
    #[arg(long, num_args = 1.., value_name = "FILE")]
    pub before: Vec<PathBuf>,

    /// How far the URDF's masses, centres of mass and inertias may be off, as a fraction of each link's own (0.1: ten per cent)
    /// [default: estimated from the recordings]
    #[arg(long, value_name = "FRACTION", value_parser = parse_accuracy)]
    pub urdf_accuracy: Option<f64>,

    /// The relative standard deviation of the torque constants (0.05: five per cent), included in every interval
    /// [default: unknown; sizes are then in the newton metres of the recorded torque]
    #[arg(long, value_name = "FRACTION", value_parser = parse_accuracy)]
    pub torque_accuracy: Option<f64>,

    /// The held-out recordings, on which the fit is validated; without one, no finding is validated
    #[arg(long, num_args = 1.., value_name = "FILE")]
    pub held_out: Vec<PathBuf>,

    /// The column map (.toml), for files with other headers or units
    #[arg(long, value_name = "MAP")]
    pub map: Option<PathBuf>,

    /// Effects that the model is known to omit (.toml, as written by --model); they are not reported again
    #[arg(long, value_name = "FILE")]
    pub known: Option<PathBuf>,

    /// Skip the comparison with the simulation and with the learned correction, which is faster
    #[arg(long)]
    pub torques_only: bool,

    /// Test a hypothesis by fitting only these effects: effect:joint, or effect for the whole arm; or a file (.toml, as written
    /// by --model), whose parameter values are ignored
    #[arg(long, value_name = "EFFECT:JOINT,…|FILE", conflicts_with = "known")]
    pub only: Option<String>,

    /// Write the diagnosis to this file as JSON
    #[arg(long, value_name = "OUT")]
    pub json: Option<PathBuf>,

    /// Write a page to this file (.html): figures, parameters, effects that are not testable
    #[arg(long, value_name = "OUT")]
    pub report: Option<PathBuf>,

    /// Write the corrected model to this file (.toml): the known effects and the effects found
    #[arg(long, value_name = "OUT")]
    pub model: Option<PathBuf>,

    /// Write the URDF to this file, with those effects of the corrected model that a URDF can represent
    #[arg(long, value_name = "OUT")]
    pub urdf: Option<PathBuf>,

    /// Propose the motion that best distinguishes the remaining alternatives, and write it to this file as a scenario (.toml)
    #[arg(long, value_name = "OUT", conflicts_with = "only")]
    pub next: Option<PathBuf>,

    /// Output to Rerun: off, save[=FILE], spawn or connect[=URL]
    #[cfg_attr(not(feature = "viewer"), arg(hide = true))]
    #[arg(long, value_name = "WHERE", value_parser = parse_rerun)]
    pub rerun: Option<Rerun>,

    /// The number of threads, which does not change the result [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub jobs: Option<u16>,

    /// The half-power frequency of the low-pass filter (Hz)
    #[arg(long, value_name = "HZ", value_parser = parse_frequency)]
    pub cutoff: Option<f64>,
}

#[derive(Debug, Args)]
pub struct ProveArgs {
    /// Robots included in testbed, or URDF files; the cases alternate between them [default: puma560 seven_axis]
    #[arg(long, num_args = 1.., value_name = "NAME|URDF")]
    pub robot: Vec<String>,

    /// The number of cases to draw
    #[arg(long, value_name = "N", default_value_t = 200)]
    pub cases: usize,

    /// The seed from which the cases are drawn
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,

    /// Whether half of the cases resemble real robots: small amounts of every effect on every joint, torque constants that are off,
    /// friction that differs between recordings, coloured and quantised torques, elastic gearboxes, tools that are drawn but not
    /// mounted, files with clocks of their own
    #[arg(long, value_name = "BOOL", num_args = 0..=1, default_value_t = true, default_missing_value = "true", action = clap::ArgAction::Set)]
    pub lifelike: bool,

    /// How wrong the inertial parameters of all links are in the URDF, relative [default: 0, 0.03, 0.1 and 0.3 in turns]
    #[arg(long, value_name = "SIGMA", value_parser = parse_urdf_error)]
    pub urdf_error: Option<f64>,

    /// The folder of the proof; after an interruption, the same command continues
    #[arg(long, value_name = "DIR", default_value = "proof")]
    pub out: PathBuf,

    /// Use these cases instead: folders case_*, each with a .urdf, train*.csv and held_out*.csv
    #[arg(long, value_name = "DIR", conflicts_with_all = ["robot", "cases", "seed", "lifelike", "urdf_error"])]
    pub cases_from: Option<PathBuf>,

    /// The folder of the ground truths of --cases-from (case_*.json) [default: truth/ beside the cases]
    #[arg(long, value_name = "DIR", requires = "cases_from", conflicts_with_all = ["robot", "cases", "seed"])]
    pub truth: Option<PathBuf>,

    /// Use recordings of real robots instead, with the published values as ground truth (.toml, such as docs/published.toml)
    #[arg(long, value_name = "FILE", requires = "recordings", conflicts_with_all = ["robot", "cases", "seed", "cases_from", "shard", "merge"])]
    pub published: Option<PathBuf>,

    /// The folder of the recordings of --published, with one folder per robot
    #[arg(long, value_name = "DIR", requires = "published")]
    pub recordings: Option<PathBuf>,

    /// Also write the report to this file as Markdown
    #[arg(long, value_name = "FILE")]
    pub markdown: Option<PathBuf>,

    /// Run the k-th of n parts of the cases and write it to OUT/shard-k-of-n.parquet, for --merge
    #[arg(long, value_name = "k/n", value_parser = Shard::parse)]
    pub shard: Option<Shard>,

    /// Score all parts in this folder instead, as one proof
    #[arg(long, value_name = "DIR", conflicts_with_all = ["robot", "cases", "seed", "cases_from", "shard"])]
    pub merge: Option<PathBuf>,

    /// The number of concurrent processes, which does not change the result [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub jobs: Option<u16>,
}

#[derive(Debug, Args)]
pub struct ConcealArgs {
    /// Robots included in testbed, or URDF files; the cases alternate between them [default: puma560 seven_axis]
    #[arg(long, num_args = 1.., value_name = "NAME|URDF")]
    pub robot: Vec<String>,

    /// The effects to inject (.toml, as written by diagnose --model; an effect may have an onset and a form), with their values
    #[arg(long, value_name = "FILE", required_unless_present = "seed")]
    pub effects: Option<PathBuf>,

    /// The seed of all random choices; with --effects, of motions and noise only
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,

    /// The number of cases to draw
    #[arg(long, value_name = "K", default_value_t = 1, conflicts_with = "effects", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub cases: u32,

    /// Whether half of the cases (with --effects: the case) resemble real robots: small amounts of every effect on every joint, torque constants that are off,
    /// friction that differs between recordings, coloured and quantised torques, elastic gearboxes, tools that are drawn but not
    /// mounted, files with clocks of their own
    #[arg(long, value_name = "BOOL", num_args = 0..=1, default_value_t = false, default_missing_value = "true", action = clap::ArgAction::Set)]
    pub lifelike: bool,

    /// How wrong the inertial parameters of all links are in the URDF, relative [default: 0, 0.03, 0.1 and 0.3 in turns; with
    /// --effects 0]
    #[arg(long, value_name = "SIGMA", value_parser = parse_urdf_error)]
    pub urdf_error: Option<f64>,

    /// The output folder: case_000, … contain the recordings, truth/ the ground truth
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,

    /// With --effects: the sampling rate of the recordings (Hz)
    #[arg(long, value_name = "HZ", default_value_t = 250, requires = "effects")]
    pub rate: u32,

    /// With --effects: jitter the time stamps by 10 % of the period
    #[arg(long, requires = "effects")]
    pub jitter: bool,

    /// With --effects: drop 1 % of the rows
    #[arg(long, requires = "effects")]
    pub lost: bool,

    /// With --effects: add baseline Coulomb and viscous friction on every joint, drawn from the seed
    #[arg(long, requires = "effects")]
    pub friction: bool,

    /// With --effects: the number of training recordings
    #[arg(long, value_name = "N", default_value_t = 3, requires = "effects", value_parser = clap::value_parser!(u8).range(1..=20))]
    pub training: u8,

    /// The number of threads, which does not change the result [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub jobs: Option<u16>,
}

impl DiagnoseArgs {
    /// The files that will be written.
    pub fn outputs(&self) -> Vec<&Path> {
        let rerun = match &self.rerun {
            Some(Rerun::Save(Some(path))) => Some(path.as_path()),
            Some(Rerun::Save(None)) => Some(Path::new("diagnosis.rrd")),
            _ => None,
        };
        let files = [&self.json, &self.report, &self.model, &self.urdf, &self.next];
        files.into_iter().flatten().map(PathBuf::as_path).chain(rerun).collect()
    }
}

/// How many length scales a regression has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LengthScalesArg {
    /// One for all inputs (the paper's equation 4)
    One,
    /// One per input, which makes the result independent of the inputs' units
    PerInput,
}

impl LengthScalesArg {
    /// The training that this asks for.
    pub fn training_options(self) -> TrainingOptions {
        let lengths = match self {
            Self::One => LengthScales::Isotropic,
            Self::PerInput => LengthScales::PerInput,
        };
        TrainingOptions {
            lengths,
            ..TrainingOptions::default()
        }
    }
}

/// Where Rerun shows a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Rerun {
    /// Nowhere.
    Off,
    /// Into a file: this one, or `run.rrd` in the run's folder.
    Save(Option<PathBuf>),
    /// In a viewer started for it.
    Spawn,
    /// In a viewer that listens, by default on this machine.
    Connect(Option<String>),
}

fn parse_rerun(text: &str) -> Result<Rerun, String> {
    let (word, value) = match text.split_once('=') {
        Some((word, value)) => (word, Some(value)),
        None => (text, None),
    };
    match (word, value) {
        (_, Some("")) => Err("nothing follows the \"=\"".into()),
        ("off", None) => Ok(Rerun::Off),
        ("spawn", None) => Ok(Rerun::Spawn),
        ("save", file) => Ok(Rerun::Save(file.map(PathBuf::from))),
        ("connect", url) => Ok(Rerun::Connect(url.map(str::to_owned))),
        _ => Err("give off, save, save=FILE, spawn, connect or connect=URL".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rerun_targets_parse() {
        assert_eq!(parse_rerun("off"), Ok(Rerun::Off));
        assert_eq!(parse_rerun("save=a=b.rrd"), Ok(Rerun::Save(Some("a=b.rrd".into()))));
        assert_eq!(parse_rerun("connect"), Ok(Rerun::Connect(None)));
        assert!(parse_rerun("save=").is_err());
        assert!(parse_rerun("show").is_err());
        assert!(parse_rerun("off=1").is_err());
    }
}
