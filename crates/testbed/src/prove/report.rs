//! What a proof says, as blocks that the page and the Markdown file are both made of.

use scoring::{Counted, Fate, Name, Score};

use super::command::{Proof, figure, percent, wanted};
use super::{disturbance, experiments, reasons, results, tracking};

/// What was declared not observable is listed from this expressed share on.
const LARGE: f64 = 0.06;

/// A piece of a report. Text may hold `code` between backticks.
pub enum Block {
    /// A title.
    Title(String),
    /// A heading.
    Heading(&'static str),
    /// A heading under it.
    Section(String),
    /// A paragraph.
    Text(String),
    /// A table; the columns after the first `words` hold numbers.
    Table {
        /// Over the columns.
        head: Vec<String>,
        /// Cells.
        rows: Vec<Vec<String>>,
        /// How many columns hold words.
        words: usize,
    },
    /// A drawing and what it shows; only on the page.
    Figure {
        /// SVG.
        svg: String,
        /// In words.
        caption: String,
    },
    /// Commands.
    Code(String),
}

/// A table.
pub fn table(head: &[&str], words: usize, rows: Vec<Vec<String>>) -> Block {
    Block::Table {
        head: head.iter().map(|&word| word.to_owned()).collect(),
        rows,
        words,
    }
}

/// A paragraph.
pub fn text(text: impl Into<String>) -> Block {
    Block::Text(text.into())
}

/// `k of n (p %, low to high %)`.
pub fn counted(counted: &Counted) -> String {
    let [low, high] = counted.wilson.map(|bound| 100.0 * bound);
    match counted.share() {
        Some(share) => format!(
            "{} of {} ({}; {low:.0} to {high:.0} %)",
            counted.hits,
            counted.of,
            percent(share)
        ),
        None => "none to count".to_owned(),
    }
}

/// Two decimals.
pub fn number(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:.2}"))
}

/// A share, where there is one.
pub fn share(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), percent)
}

/// An effect and its joint in words.
pub fn name((effect, joint): &Name) -> String {
    match joint {
        Some(joint) => format!("`{effect}` on {joint}"),
        None => format!("`{effect}`"),
    }
}

/// The whole report.
pub fn blocks(proof: &Proof) -> Vec<Block> {
    let score = &proof.score;
    let mut list = Vec::new();
    list.extend(opening(proof));
    list.extend(concealed(proof));
    list.extend(results::found(score));
    list.extend(results::numbers(score));
    list.extend(results::controls(score));
    list.extend(results::calibration(score));
    list.extend(experiments::words::blocks(&score.experiments));
    list.extend(proof.paper.iter().flat_map(disturbance::words::blocks));
    list.extend(tracking::words::blocks(&proof.tracking));
    list.extend(failures(score));
    list.extend(hashes(proof));
    list
}

fn opening(proof: &Proof) -> Vec<Block> {
    let score = &proof.score;
    let reached = score
        .targets
        .iter()
        .filter(|target| target.reached == Some(true))
        .count();
    let asked = score.targets.iter().filter(|target| target.reached.is_some()).count();
    let rows = score.targets.iter().map(|target| {
        let interval = target.counted.map_or_else(String::new, |counted| {
            let [low, high] = counted.wilson.map(|bound| 100.0 * bound);
            format!("{low:.0} to {high:.0} %")
        });
        let reached = match target.reached {
            Some(true) => "yes",
            Some(false) => "**no**",
            None => "–",
        };
        vec![
            target.what.clone(),
            figure(target),
            interval,
            target.of.to_string(),
            wanted(target),
            reached.to_owned(),
        ]
    });
    let head = ["", "figure", "Wilson 95 %", "of", "wanted", "reached"];
    let mut list = vec![
        Block::Title("Concealed physics: what was found, what was not, and where it fails".into()),
        text(format!(
            "{} concealed effects in {} cases were diagnosed by processes that were given the recordings and a rigid URDF alone. {reached} of the \
             {asked} figures that were asked for are reached. {}",
            score.concealed.len(),
            score.cases,
            unanswered(score),
        )),
        table(&head, 1, rows.collect()),
        text(exempt(score)),
    ];
    for target in score.targets.iter().filter(|target| target.reached == Some(false)) {
        list.push(text(format!("**{}**: {}", target.what, reasons::reason(target, score))));
    }
    list
}

/// How many cases have no answer, and what that does to the figures.
fn unanswered(score: &Score) -> String {
    match score.unanswered.as_slice() {
        [] => "All cases got an answer.".to_owned(),
        list => format!(
            "Cases without an answer: {} ({}); nothing counts as found there, and they are in no figure about what was named, about errors or about intervals.",
            list.len(),
            list.join(", ")
        ),
    }
}

/// What the diagnosis was let off: neither F1 nor coverage asks for it.
fn exempt(score: &Score) -> String {
    let exempt = || {
        let counted = score.concealed.iter().filter(|o| o.counts);
        counted.filter(|o| o.fate == Fate::NotObservable)
    };
    let mut large: Vec<_> = exempt()
        .filter_map(|o| Some((o.share.filter(|&share| share > LARGE)?, o)))
        .collect();
    large.sort_by(|(a, x), (b, y)| b.total_cmp(a).then(x.case.cmp(&y.case)));
    let largest = exempt().filter_map(|o| o.share).reduce(f64::max);
    let words = large.iter().map(|(share, o)| {
        let what = name(&(o.effect.clone(), o.joint.clone()));
        format!("{what} in {} ({})", o.case, percent(*share))
    });
    let list = match words.collect::<Vec<_>>().as_slice() {
        [] => String::new(),
        list => format!(": {}", list.join(", ")),
    };
    format!(
        "Neither F1 nor coverage asks for what a diagnosis declared not observable at its size: {} effects, the largest with an expressed share of {}, {} above {}{list}. \
         If they count as missed and as not covered, macro F1 is {} and the truth is in the finding or its confusable set in {}.",
        exempt().count(),
        share(largest),
        large.len(),
        percent(LARGE),
        number(score.macro_f1_strict),
        counted(&score.covered_strict),
    )
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

fn failures(score: &Score) -> Vec<Block> {
    let mut rows = Vec::new();
    for outcome in score.concealed.iter().filter(|o| o.counts && !o.fate.is_found()) {
        let fate = match outcome.fate {
            Fate::Covered => "in a confusable set only",
            Fate::NotObservable => "declared not observable",
            Fate::Refused => "joint refused",
            Fate::Found | Fate::SameMachine | Fate::Missed => "missed",
        };
        let mut said: Vec<String> = outcome.instead.iter().map(name).collect();
        said.insert(0, fate.to_owned());
        let mut what = name(&(outcome.effect.clone(), outcome.joint.clone()));
        if let Some(form) = &outcome.form {
            what.push_str(&format!(" ({form})"));
        }
        rows.push(vec![
            outcome.case.clone(),
            what,
            said.join("; named "),
            share(outcome.share),
        ]);
    }
    for wrong in &score.false_names {
        let what = name(&(wrong.effect.clone(), wrong.joint.clone()));
        let there = if wrong.concealed_there.is_empty() {
            "nothing there".to_owned()
        } else {
            format!("there: {}", wrong.concealed_there.join(", "))
        };
        let admits = if wrong.admits_the_truth {
            "; the truth is in its confusable set"
        } else {
            ""
        };
        let said = format!("named falsely{admits}; {there}");
        rows.push(vec![wrong.case.clone(), what, said, percent(wrong.share)]);
    }
    for case in score.outside.iter().filter(|case| !case.refused) {
        let what = case.concealed.iter().map(name).collect::<Vec<_>>().join(", ");
        rows.push(vec![
            case.case.clone(),
            what,
            "not refused".to_owned(),
            share(case.share),
        ]);
    }
    for case in &score.refusals_without_cause {
        let what = format!("refused {}", case.unexplained.join(", "));
        rows.push(vec![
            case.case.clone(),
            what,
            "nothing outside the catalogue".to_owned(),
            String::new(),
        ]);
    }
    for case in &score.unanswered {
        rows.push(vec![case.clone(), "no answer".to_owned(), String::new(), String::new()]);
    }
    rows.sort();
    vec![
        Block::Heading("Where it fails: every failure"),
        text(format!(
            "{} in all; `diagnoses/CASE.json` and `truth/CASE.json` hold the whole of it.",
            rows.len()
        )),
        table(&["case", "what", "how", "share"], 3, rows),
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
