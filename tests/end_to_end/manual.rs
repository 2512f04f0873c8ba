//! What the program says of itself: completions and manual page name every option, and no colour goes where it is not wanted.

use std::collections::BTreeSet;
use std::process::Command;

use crate::support::Sandbox;

const COMMANDS: [&str; 10] =
    ["tables", "transfer", "diagnose", "inspect", "excite", "prove", "conceal", "schema", "completions", "man"];

/// The long options of a help text, as `--name`.
fn options(help: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for line in help.lines().filter(|line| line.trim_start().starts_with('-')) {
        let words = line.split([' ', ',', '=', '[']);
        let option = words.map(str::trim).find(|word| word.starts_with("--") && word.len() > 2);
        found.extend(option.map(str::to_owned));
    }
    found
}

/// Every command with its options, from its help; the program itself is the empty command.
fn all(sandbox: &Sandbox) -> Vec<(&'static str, BTreeSet<String>)> {
    let help = sandbox.succeed(&["--help"]);
    let listed: Vec<&str> = help
        .lines()
        .skip_while(|line| *line != "Commands:")
        .skip(1)
        .take_while(|line| !line.is_empty())
        .filter_map(|line| line.strip_prefix("  ")?.split(' ').next().filter(|word| !word.is_empty()))
        .collect();
    for command in &listed {
        assert!(*command == "help" || COMMANDS.contains(command), "{command} is not in COMMANDS");
    }
    let mut all = vec![("", options(&help))];
    for command in COMMANDS {
        assert!(listed.contains(&command), "{command} is not in\n{help}");
        all.push((command, options(&sandbox.succeed(&[command, "--help"]))));
    }
    let number: usize = all.iter().map(|(_, options)| options.len()).sum();
    assert!(number > 60, "only {number} options were read");
    all
}

#[test]
fn completions_name_every_command_and_option() {
    let sandbox = Sandbox::new();
    let all = all(&sandbox);
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = sandbox.succeed(&["completions", shell]);
        for (command, options) in &all {
            assert!(script.contains(command), "{command} is not in the script for {shell}");
            for option in options {
                // fish names an option without its dashes.
                let name =
                    if shell == "fish" { format!("-l {}", option.trim_start_matches('-')) } else { option.clone() };
                assert!(script.contains(&name), "{command} {option} is not in the script for {shell}");
            }
        }
    }
    let refusal = sandbox.refuse(&["completions", "cmd"]);
    assert!(refusal.contains("bash"), "{refusal}");
}

#[test]
fn the_manual_page_names_every_command_and_option() {
    let sandbox = Sandbox::new();
    let page = sandbox.succeed(&["man"]).replace("\\-", "-");
    assert!(page.contains(".TH testbed 1"), "{page}");
    for (command, options) in all(&sandbox) {
        let section = if command.is_empty() {
            page.as_str()
        } else {
            let heading = format!(".SH \"TESTBED {}\"", command.to_uppercase());
            let start = page.find(&heading).unwrap_or_else(|| panic!("no {heading}"));
            let rest = &page[start + heading.len()..];
            &rest[..rest.find("\n.SH ").unwrap_or(rest.len())]
        };
        for option in options {
            assert!(section.contains(&option), "{command} {option} is not in its section:\n{section}");
        }
    }
}

/// Commands that print help, errors, tables, notes and progress.
const PRINTING: [&[&str]; 5] = [
    &["--help"],
    &["diagnose", "--help"],
    &["--scenario", "nowhere"],
    &["diagnose"],
    &["--scenario", "short.toml", "--rerun", "off", "--out", "run"],
];

fn printed(arguments: &[&str], variables: &[(&str, &str)]) -> Vec<u8> {
    let sandbox = Sandbox::new();
    sandbox.write(
        "short.toml",
        "robot = \"puma560\"\nduration = 0.5\n[model]\nkind = \"rigid-body\"\n[reference]\namplitude = 0.1\n\
         frequency_1 = 0.2\nfrequency_2 = 0.3\n",
    );
    let mut command = Command::new(env!("CARGO_BIN_EXE_testbed"));
    command.args(arguments).current_dir(sandbox.path("")).env_clear();
    let output = command.envs(variables.iter().copied()).output().expect("the program starts");
    [output.stdout, output.stderr].concat()
}

const ESCAPE: u8 = 0x1b;

#[test]
fn without_a_terminal_nothing_is_escaped() {
    for arguments in PRINTING {
        for variables in [&[][..], &[("TERM", "xterm-256color")], &[("NO_COLOR", "1")]] {
            let text = printed(arguments, variables);
            assert!(!text.is_empty(), "{arguments:?}");
            assert!(!text.contains(&ESCAPE), "{arguments:?} with {variables:?}: {}", String::from_utf8_lossy(&text));
        }
    }
}

#[test]
fn no_color_is_obeyed_where_colours_would_be_used() {
    let forced = ("CLICOLOR_FORCE", "1");
    let help = printed(PRINTING[0], &[forced]);
    assert!(help.contains(&ESCAPE), "this test would see no colours");
    for arguments in PRINTING {
        let text = printed(arguments, &[forced, ("NO_COLOR", "1")]);
        assert!(!text.contains(&ESCAPE), "{arguments:?}: {}", String::from_utf8_lossy(&text));
    }
}
