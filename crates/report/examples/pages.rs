//! Writes the pages of made-up diagnoses to a folder: `cargo run -p report --example pages FOLDER`.

#[path = "../tests/pages/made_up/mod.rs"]
mod made_up;

use std::path::Path;

use made_up::Plot;

fn main() -> std::io::Result<()> {
    let Some(folder) = std::env::args_os().nth(1) else {
        eprintln!("usage: cargo run -p report --example pages FOLDER");
        std::process::exit(2);
    };
    for (joints, plot, name) in [
        (7, Plot::Rich, "rich.html"),
        (1, Plot::Rich, "one.html"),
        (6, Plot::Clean, "clean.html"),
        (3, Plot::TooShort, "short.html"),
    ] {
        let (report, traces, arm) = made_up::diagnosis(joints, plot);
        let path = Path::new(&folder).join(name);
        std::fs::write(&path, report::page(&report, &traces, &arm))?;
        println!("{}", path.display());
    }
    Ok(())
}
