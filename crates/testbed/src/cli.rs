//! The command line.

use std::path::{Path, PathBuf};

use clap::{Args, Parser, Subcommand, ValueEnum};
use torque::{LengthScales, TrainingOptions};

use crate::models::ModelKind;
use crate::prove::Shard;

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
    /// Print the paper's tables I and II and its figure 4, ours beside theirs
    Tables(TablesArgs),
    /// Find which physics a robot's model leaves out, from recordings
    Diagnose(DiagnoseArgs),
    /// Say what recordings are worth, before anything is fitted to them
    Inspect(InspectArgs),
    /// Conceal physics in recordings, seal it, diagnose, open the seal and score
    Prove(ProveArgs),
    /// Make recordings of a simulated robot with physics concealed in them, and the truth in a file apart
    Conceal(ConcealArgs),
}

/// Close the loop on one scenario.
#[derive(Debug, Args)]
pub struct RunArgs {
    /// The scenario: a name under scenarios/, or a .toml file
    #[arg(long, value_name = "NAME|FILE")]
    pub scenario: String,

    /// The torque model that the controller feeds forward [default: the scenario's; independent-joint where it names none]
    #[arg(long, value_enum)]
    pub model: Option<ModelKind>,

    /// What the model is trained on: scenarios, or recordings (.csv) [default: the scenario's own list]
    #[arg(long, value_name = "A,B,…", value_delimiter = ',')]
    pub train: Option<Vec<String>>,

    /// The regressions' length scales: one for all inputs, as in the paper, or one an input
    #[arg(long, value_enum, default_value = "one")]
    pub length_scales: LengthScalesArg,

    /// Where Rerun shows the run: off, save[=FILE], spawn or connect[=URL] [default: save into the run's folder]
    #[cfg_attr(not(feature = "viewer"), arg(hide = true))]
    #[arg(long, value_name = "WHERE", value_parser = parse_rerun)]
    pub rerun: Option<Rerun>,

    /// The run's folder [default: a new one under runs/]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,

    /// Write the run's summary to this file as well
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,

    /// Seed of what is random: the noise of the scenario's sensors
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
}

#[derive(Debug, Args)]
pub struct TablesArgs {
    /// The regressions' length scales: one for all inputs, as in the paper, or one an input
    #[arg(long, value_enum, default_value = "one")]
    pub length_scales: LengthScalesArg,

    /// Write the tables to this file as well
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct InspectArgs {
    /// The recordings (.csv)
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,

    /// The robot's URDF: names, limits, signs and torques are compared with it
    #[arg(long, value_name = "URDF")]
    pub robot: Option<String>,

    /// The column map (.toml), for files with other headers or units
    #[arg(long, value_name = "MAP")]
    pub map: Option<PathBuf>,

    /// Write everything to this file as JSON
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

    /// The recordings to fit (.csv)
    #[arg(long, required = true, num_args = 1.., value_name = "FILE")]
    pub train: Vec<PathBuf>,

    /// The recordings to prove the fit on; without one no finding is proved
    #[arg(long, num_args = 1.., value_name = "FILE")]
    pub held_out: Vec<PathBuf>,

    /// The column map (.toml), for files with other headers or units
    #[arg(long, value_name = "MAP")]
    pub map: Option<PathBuf>,

    /// Effects that the model is known to leave out (.toml, as --model writes them): they are not reported again
    #[arg(long, value_name = "FILE")]
    pub known: Option<PathBuf>,

    /// Leave out what the diagnosis is compared with, the simulation and the learned correction: quicker
    #[arg(long)]
    pub torques_only: bool,

    /// Fit these effects and no others, to try a hypothesis: effect:joint or, of the whole arm, effect; or a file (.toml, as
    /// --model writes), whose sizes do not matter
    #[arg(long, value_name = "EFFECT:JOINT,…|FILE", conflicts_with = "known")]
    pub only: Option<String>,

    /// Write the diagnosis to this file as JSON
    #[arg(long, value_name = "OUT")]
    pub json: Option<PathBuf>,

    /// Write a page to this file (.html): figures, parameters, what could not be seen
    #[arg(long, value_name = "OUT")]
    pub report: Option<PathBuf>,

    /// Write the corrected model to this file (.toml): the known effects and those found
    #[arg(long, value_name = "OUT")]
    pub model: Option<PathBuf>,

    /// Write the URDF with what it can hold of the corrected model to this file
    #[arg(long, value_name = "OUT")]
    pub urdf: Option<PathBuf>,

    /// Propose the motion that tells most of what is left open, and write it to this file as a scenario (.toml)
    #[arg(long, value_name = "OUT", conflicts_with = "only")]
    pub next: Option<PathBuf>,

    /// Where Rerun shows the diagnosis: off, save[=FILE], spawn or connect[=URL]
    #[cfg_attr(not(feature = "viewer"), arg(hide = true))]
    #[arg(long, value_name = "WHERE", value_parser = parse_rerun)]
    pub rerun: Option<Rerun>,

    /// How many threads; the result is the same [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub jobs: Option<u16>,

    /// Half-power frequency of the low-pass filter (Hz)
    #[arg(long, value_name = "HZ", value_parser = parse_frequency)]
    pub cutoff: Option<f64>,
}

#[derive(Debug, Args)]
pub struct ProveArgs {
    /// Robots that come with testbed, or URDF files; drawn cases take turns [default: puma560 seven_axis]
    #[arg(long, num_args = 1.., value_name = "NAME|URDF")]
    pub robot: Vec<String>,

    /// How many cases to draw
    #[arg(long, value_name = "N", default_value_t = 200)]
    pub cases: usize,

    /// The seed that they are drawn from
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,

    /// Whether half of the cases look like reality: a little of everything on every joint, torque constants off, friction of the day, coloured and
    /// quantised torques, gearboxes that give, tools drawn and not mounted, files with clocks of their own
    #[arg(long, value_name = "BOOL", num_args = 0..=1, default_value_t = true, default_missing_value = "true", action = clap::ArgAction::Set)]
    pub lifelike: bool,

    /// How wrong the URDFs' inertials are everywhere, about relative [default: 0, 0.03, 0.1 and 0.3 in turns]
    #[arg(long, value_name = "SIGMA", value_parser = parse_urdf_error)]
    pub urdf_error: Option<f64>,

    /// Where everything is kept; the same command goes on where an interrupted one stopped
    #[arg(long, value_name = "DIR", default_value = "proof")]
    pub out: PathBuf,

    /// Take these cases instead: folders case_*, each with a .urdf, train*.csv and held_out*.csv
    #[arg(long, value_name = "DIR", conflicts_with_all = ["robot", "cases", "seed", "lifelike", "urdf_error"])]
    pub cases_from: Option<PathBuf>,

    /// Where the truths of --cases-from are (case_*.json) [default: truth/ beside the cases]
    #[arg(long, value_name = "DIR", requires = "cases_from", conflicts_with_all = ["robot", "cases", "seed"])]
    pub truth: Option<PathBuf>,

    /// Take real robots' recordings instead, with what their publishers say as the truth (.toml, such as docs/published.toml)
    #[arg(long, value_name = "FILE", requires = "recordings", conflicts_with_all = ["robot", "cases", "seed", "cases_from", "shard", "merge"])]
    pub published: Option<PathBuf>,

    /// Where the recordings of --published are: a folder a robot
    #[arg(long, value_name = "DIR", requires = "published")]
    pub recordings: Option<PathBuf>,

    /// Write the report to this file as Markdown as well
    #[arg(long, value_name = "FILE")]
    pub markdown: Option<PathBuf>,

    /// Do the k-th of n shares of the cases and write it to OUT/shard-k-of-n.parquet, for --merge
    #[arg(long, value_name = "k/n", value_parser = Shard::parse)]
    pub shard: Option<Shard>,

    /// Score all shares in this folder instead, as one proof
    #[arg(long, value_name = "DIR", conflicts_with_all = ["robot", "cases", "seed", "cases_from", "shard"])]
    pub merge: Option<PathBuf>,

    /// How many processes at once; the result is the same [default: one a core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub jobs: Option<u16>,
}

#[derive(Debug, Args)]
pub struct ConcealArgs {
    /// Robots that come with testbed, or URDF files; cases take turns [default: puma560 seven_axis]
    #[arg(long, num_args = 1.., value_name = "NAME|URDF")]
    pub robot: Vec<String>,

    /// What to conceal (.toml, as diagnose --model writes it; an effect may have an onset and a form), sizes as given
    #[arg(long, value_name = "FILE", required_unless_present = "seed")]
    pub effects: Option<PathBuf>,

    /// What everything is drawn from; with --effects motions and noise only
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,

    /// How many cases are drawn
    #[arg(long, value_name = "K", default_value_t = 1, conflicts_with = "effects", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub cases: u32,

    /// Whether half of the cases (with --effects: the case) look like reality: a little of everything on every joint, torque constants off,
    /// friction of the day, coloured and quantised torques, gearboxes that give, tools drawn and not mounted, files with clocks of their own
    #[arg(long, value_name = "BOOL", num_args = 0..=1, default_value_t = false, default_missing_value = "true", action = clap::ArgAction::Set)]
    pub lifelike: bool,

    /// How wrong the URDFs' inertials are everywhere, about relative [default: 0, 0.03, 0.1 and 0.3 in turns; with --effects 0]
    #[arg(long, value_name = "SIGMA", value_parser = parse_urdf_error)]
    pub urdf_error: Option<f64>,

    /// The folder: case_000 … in it hold recordings, truth/ the truth
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,

    /// Rows a second of recordings with --effects (Hz)
    #[arg(long, value_name = "HZ", default_value_t = 250, requires = "effects")]
    pub rate: u32,

    /// With --effects: stamps jitter by a tenth of the period
    #[arg(long, requires = "effects")]
    pub jitter: bool,

    /// With --effects: a hundredth of the rows is lost
    #[arg(long, requires = "effects")]
    pub lost: bool,

    /// With --effects: ordinary Coulomb and viscous friction on every joint, drawn from the seed
    #[arg(long, requires = "effects")]
    pub friction: bool,

    /// How many training recordings there are with --effects
    #[arg(long, value_name = "N", default_value_t = 3, requires = "effects", value_parser = clap::value_parser!(u8).range(1..=20))]
    pub training: u8,

    /// How many threads; the result is the same [default: one a core]
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

fn parse_frequency(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(hertz) if (0.1..=1000.0).contains(&hertz) => Ok(hertz),
        _ => Err("give a frequency from 0.1 to 1000 Hz".into()),
    }
}

fn parse_urdf_error(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(sigma) if (0.0..=1.0).contains(&sigma) => Ok(sigma),
        _ => Err("give a number from 0 (exact) to 1".into()),
    }
}

/// How many length scales a regression has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LengthScalesArg {
    /// One for all inputs (the paper's equation 4)
    One,
    /// One an input: in which units the inputs are does not matter then
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
