//! The flags that choose the arm among the joints of a robot.

use std::fmt;

use arm::ChainOptions;
use clap::Args;

/// Which joints of the robot are the arm.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Which of the robot's joints are the arm")]
pub struct ChainArgs {
    /// The link on which the arm stands still [default: the root link]
    #[arg(long, value_name = "LINK")]
    pub base: Option<String>,

    /// The last link of the arm: the joints from the base to it move, all others are fixed [default: the only chain whose
    /// joints are recorded, without grippers]
    #[arg(long, value_name = "LINK")]
    pub tip: Option<String>,

    /// Fix a joint at a position (rad or m); may be given several times [default: joints beside the arm are fixed at 0, or at
    /// the limit nearest to it]
    #[arg(long, value_name = "JOINT=VALUE", value_parser = parse_lock)]
    pub lock: Vec<(String, f64)>,
}

impl ChainArgs {
    /// The options of the arm, for recordings with the joints `recorded` (empty without recordings).
    pub fn options(&self, recorded: &[String]) -> ChainOptions {
        ChainOptions {
            base: self.base.clone(),
            tip: self.tip.clone(),
            locks: self.lock.clone(),
            recorded: recorded.to_vec(),
        }
    }

    /// Whether any of the flags is given.
    pub fn is_given(&self) -> bool {
        self.base.is_some() || self.tip.is_some() || !self.lock.is_empty()
    }
}

impl fmt::Display for ChainArgs {
    /// The flags as they are given, each after a space.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (flag, link) in [("--base", &self.base), ("--tip", &self.tip)] {
            if let Some(link) = link {
                write!(formatter, " {flag} {link}")?;
            }
        }
        for (joint, value) in &self.lock {
            write!(formatter, " --lock {joint}={value}")?;
        }
        Ok(())
    }
}

fn parse_lock(text: &str) -> Result<(String, f64), String> {
    let (joint, value) = text
        .rsplit_once('=')
        .filter(|(joint, _)| !joint.is_empty())
        .ok_or("give JOINT=VALUE, for example finger_joint=0.02")?;
    let value: f64 =
        value.parse().map_err(|_| format!("\"{value}\" is not a number; give the position in rad or m"))?;
    if !value.is_finite() {
        return Err("give a finite position in rad or m".into());
    }
    Ok((joint.to_owned(), value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn locks_parse() {
        assert_eq!(parse_lock("a=0.5"), Ok(("a".into(), 0.5)));
        assert_eq!(parse_lock("a=b=-1e-2"), Ok(("a=b".into(), -0.01)));
        for wrong in ["a", "=1", "a=", "a=x", "a=nan", "a=inf"] {
            assert!(parse_lock(wrong).is_err(), "{wrong}");
        }
    }
}
