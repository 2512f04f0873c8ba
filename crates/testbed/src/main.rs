//! testbed: tracking testbed and model diagnosis for robot arms.

mod alone;
mod cli;
mod conceal;
mod diagnose;
mod excite;
mod inspect;
mod interrupt;
mod library;
mod manual;
mod models;
mod output;
mod paper;
mod progress;
mod prove;
mod run;
mod scenario;
mod sensors;
mod simulation;
mod tables;
mod telemetry;
mod training;
mod transfer;
#[cfg(feature = "viewer")]
mod viewer;
mod written;

use std::process::ExitCode;

use clap::{CommandFactory, Parser};

fn main() -> ExitCode {
    let cli = cli::Cli::parse();
    if let Err(error) = interrupt::listen() {
        eprintln!("warning: Ctrl-C may leave partial files behind: {error}");
    }
    let result = match (&cli.command, &cli.run) {
        (Some(cli::Command::Tables(args)), _) => {
            tables::run(args.json.as_deref(), &args.length_scales.training_options(), args.today)
        }
        (Some(cli::Command::Transfer(args)), _) => transfer::run(args),
        (Some(cli::Command::Inspect(args)), _) => inspect::run(args),
        (Some(cli::Command::Diagnose(args)), _) => match diagnose::run(args) {
            Ok(status) => return status,
            Err(error) => Err(error),
        },
        (Some(cli::Command::Excite(args)), _) => excite::run(args),
        (Some(cli::Command::Prove(args)), _) => prove::run(args),
        (Some(cli::Command::Conceal(args)), _) => conceal::run(args),
        (Some(cli::Command::Schema), _) => manual::schema(),
        (Some(cli::Command::Completions(args)), _) => manual::completions(args.shell),
        (Some(cli::Command::Man), _) => manual::page(),
        (None, Some(args)) => run::run(args, &cli.chain),
        (None, None) => {
            let mut command = cli::Cli::command();
            eprintln!("{}", command.render_help());
            return ExitCode::from(2);
        }
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            output::say(format_args!("error: {}", study::sentence(&error)));
            if interrupt::requested() { ExitCode::from(interrupt::EXIT_CODE) } else { ExitCode::FAILURE }
        }
    }
}
