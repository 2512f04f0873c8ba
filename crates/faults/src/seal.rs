//! The seal: hashes of all files that are fixed before the first diagnosis, which anyone can verify.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use thiserror::Error;

/// The `schema` line of a seal.
const SCHEMA: &str = "testbed.seal/1";

/// The seal of a proof, written before the first diagnosis.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Seal {
    /// `testbed.seal/1`.
    pub schema: String,
    /// The program that injects faults, diagnoses and scores.
    pub program: Program,
    /// The origin of the cases: a seed, or a folder.
    pub source: String,
    /// The cases, in their order.
    pub cases: Vec<SealedCase>,
    /// The SHA-256 of all lines `sha256  name` of the program, the recordings, the URDFs and the truths: the one hash to
    /// write down.
    pub whole: String,
}

/// A program.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Program {
    /// Its version.
    pub version: String,
    /// SHA-256 of its binary.
    pub sha256: String,
}

/// A sealed case.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SealedCase {
    /// Its name.
    pub case: String,
    /// SHA-256 of its truth.
    pub truth: String,
    /// SHA-256 of its recordings and its URDF, by file name.
    pub files: BTreeMap<String, String>,
}

/// Errors of checking a seal.
#[derive(Debug, Error, PartialEq, Eq)]
pub enum SealError {
    /// A file was changed after sealing.
    #[error("{what}: its SHA-256 is {found}, but {sealed} was sealed; nothing under seal may change")]
    Changed {
        /// Its name.
        what: String,
        /// Its present hash.
        found: String,
        /// Its sealed hash.
        sealed: String,
    },
    /// A file cannot be read.
    #[error("{what}: {reason}")]
    Unreadable {
        /// The file.
        what: String,
        /// The reason.
        reason: String,
    },
}

/// The SHA-256 of `bytes`, as 64 hexadecimal digits.
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The SHA-256 of a file.
///
/// # Errors
/// [`SealError::Unreadable`].
pub fn sha256_of(path: &Path) -> Result<String, SealError> {
    let unreadable =
        |reason: std::io::Error| SealError::Unreadable { what: path.display().to_string(), reason: reason.to_string() };
    let mut file = std::fs::File::open(path).map_err(unreadable)?;
    let mut hash = Sha256::new();
    std::io::copy(&mut file, &mut hash).map_err(unreadable)?;
    Ok(hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
}

impl Seal {
    /// Seals `cases`.
    pub fn new(program: Program, source: String, cases: Vec<SealedCase>) -> Self {
        let mut seal = Self { schema: SCHEMA.to_owned(), program, source, cases, whole: String::new() };
        seal.whole = sha256(seal.lines().as_bytes());
        seal
    }

    /// All hashes as `sha256sum` writes them: the text whose hash is [`Seal::whole`].
    pub fn lines(&self) -> String {
        let mut lines = format!("{}  testbed {}\n", self.program.sha256, self.program.version);
        for case in &self.cases {
            for (name, hash) in &case.files {
                lines.push_str(&format!("{hash}  cases/{}/{name}\n", case.case));
            }
            lines.push_str(&format!("{}  truth/{}.json\n", case.truth, case.case));
        }
        lines
    }

    /// Checks that the seal's own number is that of its lines.
    ///
    /// # Errors
    /// [`SealError::Changed`], if it was edited.
    pub fn check(&self) -> Result<(), SealError> {
        compare("the seal", sha256(self.lines().as_bytes()), &self.whole)
    }

    /// The sealed case with this name.
    pub fn case(&self, name: &str) -> Option<&SealedCase> {
        self.cases.iter().find(|case| case.case == name)
    }
}

impl SealedCase {
    /// One hash for all inputs of a diagnosis.
    pub fn inputs(&self) -> String {
        let lines: String = self.files.iter().map(|(name, hash)| format!("{hash}  {name}\n")).collect();
        sha256(lines.as_bytes())
    }

    /// Checks that the recordings and the URDF in `folder` are the sealed ones.
    ///
    /// # Errors
    /// [`SealError`] for the first file that is not.
    pub fn check_files(&self, folder: &Path) -> Result<(), SealError> {
        for (name, sealed) in &self.files {
            compare(&format!("{}/{name}", self.case), sha256_of(&folder.join(name))?, sealed)?;
        }
        Ok(())
    }

    /// Checks that `truth` is the sealed one.
    ///
    /// # Errors
    /// [`SealError::Changed`], if it is not.
    pub fn check_truth(&self, truth: &[u8]) -> Result<(), SealError> {
        compare(&format!("the truth of {}", self.case), sha256(truth), &self.truth)
    }
}

fn compare(what: &str, found: String, sealed: &str) -> Result<(), SealError> {
    if found == sealed {
        return Ok(());
    }
    Err(SealError::Changed { what: what.to_owned(), found, sealed: sealed.to_owned() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_that_of_the_standard() {
        // FIPS 180-4, appendix B.1.
        assert_eq!(sha256(b"abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    }

    #[test]
    fn a_change_breaks_the_seal() {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("a.csv"), "1\n").expect("it writes");
        let case = SealedCase {
            case: "case_000".into(),
            truth: sha256(b"nothing"),
            files: [("a.csv".to_owned(), sha256(b"1\n"))].into(),
        };
        let program = Program { version: "1".into(), sha256: sha256(b"program") };
        let mut seal = Seal::new(program, "seed 7".into(), vec![case.clone()]);
        assert_eq!(seal.check(), Ok(()));
        assert_eq!(case.check_files(folder.path()), Ok(()));
        assert_eq!(case.check_truth(b"nothing"), Ok(()));
        assert!(case.check_truth(b"something").is_err());
        std::fs::write(folder.path().join("a.csv"), "2\n").expect("it writes");
        let error = case.check_files(folder.path()).expect_err("it changed").to_string();
        assert!(error.starts_with("case_000/a.csv: its SHA-256 is "), "{error}");
        seal.cases[0].truth = sha256(b"something");
        assert!(seal.check().is_err());
    }
}
