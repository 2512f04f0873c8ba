//! Where Rerun shows a run: the values of `--rerun`.

use std::path::PathBuf;

/// Where Rerun shows a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Rerun {
    /// Nowhere.
    Off,
    /// Into a file: this one, or `run.rrd` in the run's folder.
    Save(Option<PathBuf>),
    /// In a viewer started for it.
    Spawn,
    /// In a running viewer at this address, by default on this machine.
    Connect(Option<String>),
}

/// The value of `--rerun`.
///
/// # Errors
/// If it is not one of the values, with the possible ones.
pub fn parse_rerun(text: &str) -> Result<Rerun, String> {
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
