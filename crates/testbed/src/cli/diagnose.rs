//! The arguments of `testbed diagnose`.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use study::inputs::{Given, Recordings};
use study::urdf_file::CORRECTED;
use study::{Known, Request};

use super::chain::ChainArgs;
use super::numbers::{parse_accuracy, parse_frequency, parse_lag};
use super::rerun::{Rerun, parse_rerun};
use crate::output::{self, OutputFile};

/// The creator of Parquet files of `--residuals`.
pub const RESIDUALS_CREATOR: &str = "testbed residuals";

/// By which an earlier file of `--residuals` at `path` is recognised.
fn residuals_mark(path: &Path) -> &'static str {
    let is_parquet = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("parquet"));
    if is_parquet { RESIDUALS_CREATOR } else { "recording,held_out,t,measured_" }
}

/// The catalogue's effects with their meanings, each wrapped beside its name.
fn effects_help() -> String {
    const NAME: usize = 24;
    const WIDTH: usize = 100;
    let mut help = String::from("Effects:");
    for spec in effects::CATALOGUE {
        let mut line = format!("  {:<NAME$}", spec.name);
        for word in spec.meaning.split_whitespace() {
            if line.chars().count() + 1 + word.chars().count() > WIDTH {
                help += &format!("\n{line}");
                line = " ".repeat(2 + NAME);
            }
            line += &format!(" {word}");
        }
        help += &format!("\n{line}");
    }
    help
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

    /// Recordings of the same robot from before something happened; the report then begins with what changed
    #[arg(long, num_args = 1.., value_name = "FILE")]
    pub before: Vec<PathBuf>,

    /// The relative error of each link's mass, centre of mass and inertia in the URDF (0.1: ten per cent)
    /// [default: estimated from the recordings]
    #[arg(long, value_name = "FRACTION", value_parser = parse_accuracy, allow_negative_numbers = true)]
    pub urdf_accuracy: Option<f64>,

    /// The relative standard deviation of the torque constants (0.05: five per cent), included in every interval
    /// [default: unknown; sizes are then in the newton metres of the recorded torque]
    #[arg(long, value_name = "FRACTION", value_parser = parse_accuracy, allow_negative_numbers = true)]
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

    /// Diagnose the recordings as they were read, even if their units, signs, order or zeros seem wrong, or the units of the URDF
    #[arg(long)]
    pub as_read: bool,

    /// Test a hypothesis by fitting only these effects: effect:joint, or effect for the whole arm; or a file (.toml, as written
    /// by --model), whose parameter values are ignored
    #[arg(long, value_name = "EFFECT:JOINT,…|FILE", conflicts_with = "known")]
    pub only: Option<String>,

    /// Write the diagnosis to this file as JSON; - prints it on standard output, and nothing else there
    #[arg(long, value_name = "OUT")]
    pub json: Option<PathBuf>,

    /// Write a page to this file (.html): figures, parameters, effects that are not testable
    #[arg(long, value_name = "OUT")]
    pub report: Option<PathBuf>,

    /// Write the findings to this file as Markdown (.md)
    #[arg(long, value_name = "OUT")]
    pub markdown: Option<PathBuf>,

    /// Write measured torques, the nominal and the corrected model's predictions and the residuals to this file (.csv or .parquet);
    /// one row for each time of the filtered signals, which are fewer than the recorded rows
    #[arg(long, value_name = "OUT")]
    pub residuals: Option<PathBuf>,

    /// Write the corrected model to this file (.toml): the known effects, the effects found, and the corrections of links and constant torques that no finding names
    #[arg(long, value_name = "OUT")]
    pub model: Option<PathBuf>,

    /// Write the URDF to this file, with those effects of the corrected model that a URDF can represent
    #[arg(long, value_name = "OUT")]
    pub urdf: Option<PathBuf>,

    /// Write what was tried, taken and dropped, by which rule and with which gain (nats), to this file (.csv)
    #[arg(long, value_name = "OUT")]
    pub trace: Option<PathBuf>,

    /// Write the corrected model to this file as MJCF (.xml), for MuJoCo, with those effects that MJCF can represent
    #[arg(long, value_name = "OUT")]
    pub mjcf: Option<PathBuf>,

    /// Which friction of the URDF (its "dynamics" tags) counts as part of the model. In most URDFs it is a placeholder
    #[arg(long, value_enum, default_value = "diagnosed")]
    pub urdf_friction: UrdfFriction,

    /// Propose the motion that best distinguishes the remaining alternatives, and write it to this file as a scenario (.toml)
    #[arg(long, value_name = "OUT", conflicts_with = "only")]
    pub next: Option<PathBuf>,

    /// Output to Rerun: off, save[=FILE], spawn or connect[=URL]
    #[cfg_attr(not(feature = "viewer"), arg(hide = true))]
    #[arg(long, value_name = "WHERE", value_parser = parse_rerun)]
    pub rerun: Option<Rerun>,

    /// Print everything: each note, and all parameters, alternatives and effects that are not testable
    #[arg(long, short, conflicts_with = "quiet")]
    pub verbose: bool,

    /// Print nothing but errors and the files written
    #[arg(long, short)]
    pub quiet: bool,

    /// Exit with status 3 unless the model explains the recordings of all joints without any effect
    #[arg(long)]
    pub fail_on_mismatch: bool,

    /// The number of threads, which does not change the result [default: one per core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub jobs: Option<u16>,

    /// The half-power frequency of the low-pass filter (Hz)
    #[arg(long, value_name = "HZ", value_parser = parse_frequency, allow_negative_numbers = true)]
    pub cutoff: Option<f64>,

    /// The lag of all recorded torques behind the positions, which is removed (s) [default: estimated, in all recordings and in single ones, if the joints agree on it, otherwise 0]
    #[arg(long, value_name = "S", value_parser = parse_lag, allow_negative_numbers = true)]
    pub torque_lag: Option<f64>,

    #[command(flatten)]
    pub chain: ChainArgs,
}

impl DiagnoseArgs {
    /// What is to be diagnosed.
    pub fn request(&self) -> Request {
        let files = |paths: &[PathBuf]| paths.iter().cloned().map(Given::File).collect();
        Request {
            robot: self.robot.clone(),
            chain: self.chain.options(&[]),
            recordings: Recordings {
                before: files(&self.before),
                train: files(&self.train),
                held_out: files(&self.held_out),
                map: self.map.clone(),
            },
            known: self.known.clone().map(Known::File),
            only: self.only.clone(),
            urdf_friction: self.urdf_friction.into(),
            cutoff: self.cutoff,
            torque_lag: self.torque_lag,
            urdf_accuracy: self.urdf_accuracy,
            torque_accuracy: self.torque_accuracy,
            as_read: self.as_read,
            torques_only: self.torques_only,
            next: self.next.is_some(),
        }
    }

    /// The files that will be written.
    pub fn outputs(&self) -> Vec<OutputFile<'_>> {
        let given = OutputFile::given;
        let files = [
            self.json_file().map(|path| OutputFile::json(path, "\"schema\": \"testbed.diagnosis/")),
            given("--report", self.report.as_deref(), &["html", "htm"])
                .map(|file| file.marked("name=\"generator\" content=\"testbed diagnose\"")),
            self.markdown
                .as_deref()
                .map(OutputFile::markdown)
                .map(|file| file.marked("(`testbed diagnose`), schema `testbed.diagnosis/")),
            given("--residuals", self.residuals.as_deref(), &["csv", "parquet"])
                .map(|file| file.marked(residuals_mark(file.path))),
            given("--model", self.model.as_deref(), &["toml"])
                .map(|file| file.marked("# Effects that the URDF omits; testbed diagnose reads them")),
            given("--urdf", self.urdf.as_deref(), &["urdf", "xml"]).map(|file| file.marked(CORRECTED)),
            given("--trace", self.trace.as_deref(), &["csv"]).map(|file| file.marked("step,action,effect,")),
            given("--mjcf", self.mjcf.as_deref(), &["xml", "mjcf"])
                .map(|file| file.marked("Written by testbed diagnose")),
            given("--next", self.next.as_deref(), &["toml"]),
            self.rerun_file().map(OutputFile::rerun),
        ];
        files.into_iter().flatten().collect()
    }

    /// The file that Rerun saves to.
    pub fn rerun_file(&self) -> Option<&Path> {
        match &self.rerun {
            Some(Rerun::Save(Some(path))) => Some(path),
            Some(Rerun::Save(None)) => Some(Path::new("diagnosis.rrd")),
            _ => None,
        }
    }

    /// Whether the diagnosis is printed as JSON.
    pub fn prints_json(&self) -> bool {
        output::is_stdout(self.json.as_deref())
    }

    /// The file that the diagnosis is written to as JSON.
    pub fn json_file(&self) -> Option<&Path> {
        self.json.as_deref().filter(|_| !self.prints_json())
    }
}

/// Which friction in a URDF is known friction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum UrdfFriction {
    /// Only friction that testbed diagnose wrote into the URDF with --urdf
    Diagnosed,
    /// All friction in the URDF
    Known,
    /// None of it
    Ignored,
}

impl From<UrdfFriction> for study::urdf_friction::UrdfFriction {
    fn from(which: UrdfFriction) -> Self {
        match which {
            UrdfFriction::Diagnosed => Self::Diagnosed,
            UrdfFriction::Known => Self::Known,
            UrdfFriction::Ignored => Self::Ignored,
        }
    }
}
