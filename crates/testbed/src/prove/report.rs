//! What a proof says, as blocks that the page and the Markdown file are both made of.

use report::block::{Block, table, text};
use report::numbers::percent_to_a_tenth as percent;
use report::score;

use super::command::Proof;
use super::{disturbance, experiments, tracking};

/// The page, which needs nothing beside it.
pub fn page(proof: &Proof) -> String {
    let eyebrow = format!(
        "testbed proof · {} · sealed as `{}`",
        proof.seal.source, proof.seal.whole
    );
    let made = format!(
        "Made by testbed {} (`testbed prove`). The same seed and program give the same page, byte for byte.",
        proof.seal.program.version
    );
    report::block_page("Concealed physics: a proof", &eyebrow, &blocks(proof), &made)
}

/// The report as Markdown.
pub fn markdown(proof: &Proof) -> String {
    report::markdown(
        &blocks(proof),
        "Made by `testbed prove`; the same seed and program give the same bytes.",
    )
}

/// The whole report.
fn blocks(proof: &Proof) -> Vec<Block> {
    let of = &proof.score;
    let mut list = score::opening(of);
    list.extend(concealed(proof));
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

fn concealed(proof: &Proof) -> Vec<Block> {
    let score = &proof.score;
    let empty = score.empty;
    let outside = score.outside.len();
    vec![
        Block::Heading("What was concealed, and from whom"),
        text(format!(
            "The {} (`{}`): {empty} hold nothing but ordinary friction, {outside} something outside the catalogue, the others {} effects of the \
             catalogue's. The recordings are of a simulated arm that has them; the URDF beside them has not. An effect's expressed share is the largest \
             part of a joint's torque (in standard deviations) that vanishes when the arm is simulated without it; under {} nobody is asked to find it.",
            proof.seal.source,
            &proof.seal.whole[..12],
            score.concealed.len(),
            percent(scoring::LEAST_SHARE),
        )),
        text(
            "Before the first diagnosis the SHA-256 of the program, of every recording and URDF and of every truth was written (`seal.json`, \
             `SHA256SUMS`). Each diagnosis then ran in a process of its own, without environment, in a new folder that held copies of the recordings and the \
             URDF and nothing else; the program that diagnoses is the one sealed. The hashes of all diagnoses were written (`answers.json`) before the first \
             truth was read, and a truth that is not the one sealed is refused. It is a protocol and no prison: what keeps the diagnosis honest is that \
             it is the command that anyone runs, with the same arguments, and that the same seed and program give the same bytes. Choose a seed of your \
             own, and nobody can have tuned on it.",
        ),
        Block::Code(proof.command.clone()),
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
            "Program: testbed {}, SHA-256 `{}`. All under seal: `{}`, the SHA-256 of `SHA256SUMS`. Recordings and URDF: the SHA-256 of their lines there, without folders.",
            proof.seal.program.version, proof.seal.program.sha256, proof.seal.whole
        )),
        table(
            &["case", "recordings and URDF", "truth", "diagnosis"],
            4,
            rows.collect(),
        ),
    ]
}
