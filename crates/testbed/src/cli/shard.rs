//! Parts of a campaign: the values of `--shard`.

use serde::{Deserialize, Serialize};

/// A part: the `number`-th of `of`, from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// The number of the part, from 1.
    pub number: usize,
    /// The number of parts.
    pub of: usize,
}

impl Shard {
    /// Reads `k/n`.
    ///
    /// # Errors
    /// If the text is not of this form.
    pub fn parse(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
        match parts {
            Some((number, of)) if (1..=of).contains(&number) => Ok(Self { number, of }),
            _ => Err("give k/n with k from 1 to n, as in 3/20".into()),
        }
    }

    /// Whether a case is in this part.
    pub fn has(self, case: usize) -> bool {
        case % self.of == self.number - 1
    }

    /// The name of its folder and of its file.
    pub fn name(self) -> String {
        format!("shard-{}-of-{}", self.number, self.of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_parsed_and_contain_every_case_once() {
        assert_eq!(Shard::parse("3/20"), Ok(Shard { number: 3, of: 20 }));
        for wrong in ["0/3", "4/3", "3", "a/b", "1/0"] {
            assert!(Shard::parse(wrong).is_err(), "{wrong}");
        }
        for case in 0..50 {
            assert_eq!((1..=7).filter(|&number| Shard { number, of: 7 }.has(case)).count(), 1);
        }
    }
}
