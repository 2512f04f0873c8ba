//! A case with all its results as one row. Rows are scored, and parts of a campaign are exchanged as rows.

use std::collections::BTreeMap;

use anyhow::Context;
use faults::{SealedCase, sha256};
use scoring::{Again, Answer, Score, Tried};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::tracking::CaseTracking;

/// The files of a case and of its results, as text.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The case.
    pub case: String,
    /// The joints' names, base to tip.
    pub joints: Vec<String>,
    /// SHA-256 of its recordings and its URDF, by name.
    pub files: BTreeMap<String, String>,
    /// The truth's file.
    pub truth: String,
    /// The diagnosis; `None` if the program gave no answer.
    pub diagnosis: Option<String>,
    /// The message of the program instead of a diagnosis.
    pub error: Option<String>,
    /// The true terms fitted by name.
    pub true_terms: Option<String>,
    /// A wrong term in place of a true one.
    pub wrong_term: Option<String>,
    /// The outcome of tracking a task ([`CaseTracking`]), in the cases in which one was tracked.
    pub tracking: Option<String>,
    /// The diagnosis with the recording of the motion that the first one proposed.
    pub again: Option<String>,
    /// The reason why there is no second diagnosis, if it was tried.
    pub again_error: Option<String>,
}

impl Row {
    /// The case in the seal.
    pub fn sealed(&self) -> SealedCase {
        SealedCase { case: self.case.clone(), truth: sha256(self.truth.as_bytes()), files: self.files.clone() }
    }

    /// The case with parsed results, for scoring.
    ///
    /// # Errors
    /// If a text is not what it should be.
    pub fn tried(&self) -> anyhow::Result<Tried> {
        let answer = |text: &Option<String>, what: &str| -> anyhow::Result<Option<Answer>> {
            let parse = |text: &String| serde_json::from_str(text).with_context(|| format!("{}: {what}", self.case));
            text.as_ref().map(parse).transpose()
        };
        let again = answer(&self.again, "the diagnosis with the proposed motion")?.map(Box::new);
        let tracked = self.tracked()?;
        let failed = self.again_error.clone().map(Again::Failed);
        Ok(Tried {
            truth: truth(&self.case, &self.truth)?,
            joints: self.joints.clone(),
            answer: answer(&self.diagnosis, "the diagnosis")?,
            true_terms: answer(&self.true_terms, "the true terms")?,
            wrong_term: answer(&self.wrong_term, "the wrong term")?,
            tracking_over_exact: tracked.as_ref().and_then(CaseTracking::over_exact),
            tracking_over_exact_without_lag: tracked.as_ref().and_then(CaseTracking::over_exact_without_lag),
            again: again.map(Again::Answer).or(failed),
        })
    }

    /// The outcome of tracking a task, if one was tracked.
    ///
    /// # Errors
    /// If the text is not what it should be.
    pub fn tracked(&self) -> anyhow::Result<Option<CaseTracking>> {
        let parse = |text: &String| serde_json::from_str(text).with_context(|| format!("{}: the tracking", self.case));
        self.tracking.as_ref().map(parse).transpose()
    }
}

/// Reads a truth.
///
/// # Errors
/// If the text is not a ground truth.
pub fn truth<T: DeserializeOwned>(case: &str, text: &str) -> anyhow::Result<T> {
    serde_json::from_str(text).with_context(|| format!("{case}: the truth"))
}

/// Scores `rows`, which come in the order of their names.
///
/// # Errors
/// If a text is not what it should be.
pub fn score<'a>(rows: impl Iterator<Item = &'a Row>) -> anyhow::Result<Score> {
    let tried: anyhow::Result<Vec<Tried>> = rows.map(Row::tried).collect();
    Ok(scoring::score(&tried?))
}
