//! The report of a proof, as blocks from which the page and the Markdown file are made.

use report::block::{Block, table, text};
use report::numbers::percent_to_a_tenth as percent;
use report::score;

use super::proof::Proof;
use super::{disturbance, experiments, tracking};

/// The self-contained HTML page.
pub fn page(proof: &Proof) -> String {
    let eyebrow = format!("testbed proof · {} · sealed as `{}`", proof.seal.source, proof.seal.whole);
    let made = format!(
        "Made by testbed {} (`testbed prove`). The same seed and program give the same page, byte for byte.",
        proof.seal.program.version
    );
    report::block_page("Injected faults: a blind proof", &eyebrow, &blocks(proof), &made)
}

/// The report as Markdown.
pub fn markdown(proof: &Proof) -> String {
    report::markdown(&blocks(proof), "Made by `testbed prove`; the same seed and program give the same bytes.")
}

/// The whole report.
fn blocks(proof: &Proof) -> Vec<Block> {
    let of = &proof.score;
    let mut list = score::opening(of);
    list.extend(injected(proof));
    list.extend(score::found(of));
    list.extend(score::numbers(of));
    list.extend(score::controls(of));
    list.extend(score::calibration(of));
    list.extend(score::experiments(&of.experiments, experiments::LOOKED_AT));
    list.extend(proof.paper.iter().flat_map(disturbance::words::blocks));
    list.extend(tracking::words::blocks(&proof.tracking));
    list.extend(score::failures(of));
    list.extend(hashes(proof));
    list
}

fn injected(proof: &Proof) -> Vec<Block> {
    let score = &proof.score;
    let empty = score.empty;
    let outside = score.outside.len();
    vec![
        Block::Heading("Cases and protocol"),
        text(format!(
            "The {} (`{}`): {empty} contain baseline friction only, {outside} contain an effect outside the catalogue, the others {} effects of the \
             catalogue. The recordings are of a simulated arm with these effects; the URDF beside them does not contain them. The expressed share of an effect is the largest \
             part of a joint's torque (in standard deviations) that vanishes when the arm is simulated without the effect; effects below {} are not required to be found.",
            proof.seal.source,
            &proof.seal.whole[..12],
            score.injected.len(),
            percent(scoring::LEAST_SHARE),
        )),
        text(
            "Before the first diagnosis, the SHA-256 hashes of the program, of all recordings and URDFs and of all ground truths are written (`seal.json`, \
             `SHA256SUMS`). Each diagnosis then runs in its own process, without environment variables, in a new folder that contains only copies of the recordings and the \
             URDF; the program that diagnoses is the sealed one. The hashes of all diagnoses are written (`answers.json`) before the first \
             ground truth is read, and a ground truth that differs from the sealed one is refused. This protocol is not a sandbox. It can be verified because the diagnosis \
             is the public command with the same arguments for all cases, and because the same seed and program give the same bytes. A seed of your own choice \
             excludes that the diagnosis was tuned on the cases.",
        ),
        Block::Code { language: "sh", code: proof.command.clone() },
    ]
}

fn hashes(proof: &Proof) -> Vec<Block> {
    let code = |text: &str| format!("`{text}`");
    let rows = proof.seal.cases.iter().map(|case| {
        let answer = proof.answers.get(&case.case).cloned().flatten();
        vec![
            case.case.clone(),
            code(&case.inputs()),
            code(&case.truth),
            answer.map_or_else(|| "none".to_owned(), |hash| code(&hash)),
        ]
    });
    vec![
        Block::Heading("The seal"),
        text(format!(
            "Program: testbed {}, SHA-256 `{}`. Complete seal: `{}`, the SHA-256 of `SHA256SUMS`. Recordings and URDF: the SHA-256 of their lines in that file, without folders.",
            proof.seal.program.version, proof.seal.program.sha256, proof.seal.whole
        )),
        table(&["case", "recordings and URDF", "ground truth", "diagnosis"], 4, rows.collect()),
    ]
}
