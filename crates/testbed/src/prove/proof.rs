//! The outcome of a proof.

use std::collections::BTreeMap;

use faults::{Program, Seal, sha256};
use scoring::Score;
use serde::Serialize;

use super::disturbance::{self, Disturbance};
use super::rows::{self, Row};
use super::tracking::CaseTracking;

/// The content of `score.json`.
#[derive(Serialize)]
pub struct Proof {
    /// `testbed.proof/1`.
    pub schema: &'static str,
    /// The command that repeats the proof.
    pub command: String,
    /// The seal, made before the first diagnosis.
    pub seal: Seal,
    /// The SHA-256 of each diagnosis by case, fixed before the ground truths were opened.
    pub answers: BTreeMap<String, Option<String>>,
    /// The score.
    pub score: Score,
    /// The outcome of the paper's own disturbance, which is not in the score; campaigns of random cases have it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub paper: Option<Disturbance>,
    /// The outcome of tracking task D on the machines of a dozen cases.
    pub tracking: Vec<CaseTracking>,
}

impl Proof {
    /// Scores `rows`, which are in the order of their names.
    pub fn new(program: Program, source: String, command: String, rows: &[Row]) -> anyhow::Result<Self> {
        let is_paper = |row: &&Row| row.case == disturbance::CASE;
        let answer = |row: &Row| row.diagnosis.as_ref().map(|text| sha256(text.as_bytes()));
        Ok(Self {
            schema: "testbed.proof/1",
            command,
            seal: Seal::new(program, source, rows.iter().map(Row::sealed).collect()),
            answers: rows.iter().map(|row| (row.case.clone(), answer(row))).collect(),
            score: rows::score(rows.iter().filter(|row| !is_paper(row)))?,
            paper: rows.iter().find(is_paper).map(disturbance::assess).transpose()?,
            tracking: rows.iter().filter_map(|row| row.tracked().transpose()).collect::<anyhow::Result<_>>()?,
        })
    }
}
