//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use torque::{LengthScales, TrainingOptions};

mod chain;
mod diagnose;
mod excite;
mod numbers;
mod rerun;
mod shard;

use crate::models::ModelKind;
pub use chain::ChainArgs;
pub use diagnose::{DiagnoseArgs, RESIDUALS_CREATOR};
pub use excite::{ExciteArgs, Limit};
use numbers::parse_urdf_error;
pub use rerun::Rerun;
use rerun::parse_rerun;
pub use shard::Shard;

/// Tracking testbed and model diagnosis for robot arms
#[derive(Debug, Parser)]
#[command(version, about, args_conflicts_with_subcommands = true, arg_required_else_help = true)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Option<Command>,
    #[command(flatten)]
    pub run: Option<RunArgs>,
    // Not within RunArgs, because clap never fills an optional struct that contains another struct.
    #[command(flatten)]
    pub chain: ChainArgs,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Print tables I and II and figure 4 of the paper, with our results beside the published ones
    Tables(TablesArgs),
    /// Train a model on every set of tasks, and compare its predicted and measured errors on the other tasks
    Transfer(TransferArgs),
    /// Find the physical effects that a robot's model omits, from recordings
    Diagnose(Box<DiagnoseArgs>),
    /// Propose the motion of the first recording: the one from which inertial parameters and friction are estimated best
    Excite(ExciteArgs),
    /// Check the quality of recordings before anything is fitted to them
    Inspect(InspectArgs),
    /// Test the diagnosis blind: inject faults, seal the ground truth, diagnose, open the seal and score
    Prove(ProveArgs),
    /// Make recordings of a simulated robot with injected faults, and the ground truth in a separate file
    Conceal(ConcealArgs),
    /// Print the JSON Schema of what diagnose --json writes
    Schema,
    /// Print a script that completes commands and options in a shell
    Completions(CompletionsArgs),
    /// Print the manual page, for man -l - or a file testbed.1
    Man,
}

#[derive(Debug, Args)]
pub struct CompletionsArgs {
    /// The shell that reads the script
    #[arg(value_enum)]
    pub shell: clap_complete::Shell,
}

/// Run one scenario in closed loop.
#[derive(Debug, Args)]
pub struct RunArgs {
    /// The scenario: one that is included (taskA, taskB, taskC, taskD or beyond), or a .toml file; a name is also looked for in the
    /// folder scenarios/
    #[arg(long, value_name = "NAME|FILE")]
    pub scenario: String,

    /// The feed-forward torque model of the controller [default: the scenario's, otherwise independent-joint]
    #[arg(long, value_enum)]
    pub model: Option<ModelKind>,

    /// The training data of the model: scenarios, or recordings with the columns qd_ and qdd_, as a run's recording.csv has them
    /// [default: the scenario's list]
    #[arg(long, value_name = "A,B,…", value_delimiter = ',')]
    pub train: Option<Vec<String>>,

    /// The length scales of the regressions: one for all inputs, as in the paper, or one per input [default: the scenario's,
    /// otherwise one]
    #[arg(long, value_enum)]
    pub length_scales: Option<LengthScalesArg>,

    /// Whether the learned torque fades to the rigid-body model where its variance nears the prior's or the mean square of its data
    /// [default: the scenario's, otherwise true]
    #[arg(long, value_name = "BOOL", num_args = 0..=1, default_missing_value = "true", action = clap::ArgAction::Set)]
    pub fade: Option<bool>,

    /// With more samples than this, approximate each regression by this number of inducing points; the result states the
    /// error [default: exact; 250 samples of all joints for the energies]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub inducing: Option<u32>,

    /// Output to Rerun: off, save[=FILE], spawn or connect[=URL] [default: save in the run's folder]
    #[cfg_attr(not(feature = "viewer"), arg(hide = true))]
    #[arg(long, value_name = "WHERE", value_parser = parse_rerun)]
    pub rerun: Option<Rerun>,

    /// The folder of the run [default: a new one under runs/]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,

    /// Also write the summary of the run to this file; - prints it on standard output, and nothing else there
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

    /// Also train models that are newer than the paper: the regression by energies, with a rigid body and alone
    #[arg(long)]
    pub today: bool,

    /// Also write the tables to this file as JSON; - prints it on standard output, and nothing else there
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct TransferArgs {
    /// The tasks (2 to 6): a model is trained on every combination of them, and tested on each
    #[arg(long, value_name = "A,B,…", value_delimiter = ',', default_value = "taskA,taskB,taskC")]
    pub train: Vec<String>,

    /// The scenario to test on, with the robot and its errors; it may be one of the tasks
    #[arg(long, value_name = "NAME|FILE", default_value = "taskD")]
    pub test: String,

    /// The model to train
    #[arg(long, value_enum, default_value = "independent-joint")]
    pub model: ModelKind,

    /// The length scales of the regressions: one for all inputs, as in the paper, or one per input
    #[arg(long, value_enum, default_value = "one")]
    pub length_scales: LengthScalesArg,

    /// Also write the result to this file as JSON; - prints it on standard output, and nothing else there
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,

    /// Also write the samples of every task into this folder, as CSV, for other models
    #[arg(long, value_name = "DIR")]
    pub samples: Option<PathBuf>,
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

    /// Write the complete result to this file as JSON; - prints it on standard output, and nothing else there
    #[arg(long, value_name = "OUT")]
    pub json: Option<PathBuf>,

    #[command(flatten)]
    pub chain: ChainArgs,
}

#[derive(Debug, Args)]
pub struct ProveArgs {
    /// Robots included in testbed, or URDF files; the cases alternate between them [default: puma560 seven_axis]
    #[arg(long, num_args = 1.., value_name = "NAME|URDF")]
    pub robot: Vec<String>,

    /// The number of cases to draw; 0 for the paper's disturbance alone
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(..=100_000))]
    pub cases: u32,

    /// The seed from which the cases are drawn
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,

    /// Whether half of the cases resemble real robots: small amounts of every effect on every joint, wrong torque constants,
    /// friction that differs between recordings, coloured and quantised torques, elastic gearboxes, tools that the URDF draws and
    /// that are not mounted, files with clocks of their own
    #[arg(long, value_name = "BOOL", num_args = 0..=1, default_value_t = true, default_missing_value = "true", action = clap::ArgAction::Set)]
    pub lifelike: bool,

    /// Relative error of all links' inertial parameters in the URDF [default: 0, 0.03, 0.1 and 0.3 in turns]
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

    #[command(flatten)]
    pub chain: ChainArgs,
}

#[derive(Debug, Args)]
pub struct ConcealArgs {
    /// Robots included in testbed, or URDF files; the cases alternate between them [default: puma560 seven_axis]
    #[arg(long, num_args = 1.., value_name = "NAME|URDF")]
    pub robot: Vec<String>,

    /// The effects to inject (.toml, as written by diagnose --model; an effect may have an onset and a form), with their values
    #[arg(long, value_name = "FILE")]
    pub effects: Option<PathBuf>,

    /// The seed of all random choices; with --effects, of motions and noise only. One of the two is needed
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,

    /// The number of cases to draw
    #[arg(long, value_name = "K", default_value_t = 1, conflicts_with = "effects", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub cases: u32,

    /// Whether half of the cases (with --effects: the case) resemble real robots: small amounts of every effect on every joint, wrong torque constants,
    /// friction that differs between recordings, coloured and quantised torques, elastic gearboxes, tools that the URDF draws and
    /// that are not mounted, files with clocks of their own
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

    #[command(flatten)]
    pub chain: ChainArgs,
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
    /// The name on the command line and in a scenario.
    pub fn flag(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }

    /// The training that this asks for.
    pub fn training_options(self) -> TrainingOptions {
        let lengths = match self {
            Self::One => LengthScales::Isotropic,
            Self::PerInput => LengthScales::PerInput,
        };
        TrainingOptions { lengths, ..TrainingOptions::default() }
    }
}
