//! The program's manual page, its shell completions, and the schema of its JSON.

use anyhow::Context;
use clap::{Command, CommandFactory};
use clap_complete::Shell;
use clap_mangen::Man;

use crate::cli::Cli;
use crate::output;

/// Prints the JSON Schema of `testbed diagnose --json`.
///
/// # Errors
/// If it cannot be printed.
pub fn schema() -> anyhow::Result<()> {
    output::print(&(serde_json::to_string_pretty(&diagnosis::json_schema())? + "\n"))
}

/// Prints the script that completes testbed's commands and options in `shell`.
///
/// # Errors
/// If it cannot be printed.
pub fn completions(shell: Shell) -> anyhow::Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "testbed", &mut script);
    print(script)
}

/// Prints the manual page: the program's options, then a section per command with those of the command.
///
/// # Errors
/// If it cannot be printed.
pub fn page() -> anyhow::Result<()> {
    let mut program = Cli::command();
    program.build();
    let mut page = Vec::new();
    let man = Man::new(program.clone());
    man.render_title(&mut page)?;
    man.render_name_section(&mut page)?;
    man.render_synopsis_section(&mut page)?;
    man.render_description_section(&mut page)?;
    man.render_options_section(&mut page)?;
    for command in program.get_subcommands().filter(|command| !is_help(command)) {
        let name = command.get_bin_name().unwrap_or(command.get_name()).to_uppercase();
        let man = Man::new(command.clone());
        let mut section = Vec::new();
        man.render_synopsis_section(&mut section)?;
        man.render_description_section(&mut section)?;
        man.render_options_section(&mut section)?;
        // A section's own headings are a level below it.
        let section = String::from_utf8(section).context("the manual page")?;
        let section = section.replace("\n.SH ", "\n.SS ").replacen(".SH ", ".SS ", 1);
        page.extend(format!(".SH \"{name}\"\n{section}").into_bytes());
    }
    print(page)
}

fn is_help(command: &Command) -> bool {
    command.get_name() == "help"
}

fn print(text: Vec<u8>) -> anyhow::Result<()> {
    output::print(&String::from_utf8(text).context("printing")?)
}
