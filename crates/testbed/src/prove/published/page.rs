//! The report of a proof on published recordings, as blocks.

use report::block::{Block, table, text};
use report::numbers::{percent_to_a_tenth as percent, rounded};
use scoring::{Compared, Evidence, PublishedFate, quantile};

use super::fold::{ERRORS, error, over_joints};
use super::robots::names;
use super::{Real, Tried, figure, misses, robot_page};

/// The whole report.
pub fn blocks(real: &Real) -> Vec<Block> {
    let mut list = opening(real);
    list.extend(misses::blocks(&real.robots));
    list.extend(figure::numbers(&real.robots).map(|svg| Block::Figure {
        svg,
        caption: "Ratio of the estimated to the published value, with our 95 % interval. Hollow circles are constants of a model that the publishers use. Values outside the axis are drawn at its end.".into(),
    }));
    list.extend(errors(real));
    list.extend(protocol(real));
    list.extend(origins(real));
    list.push(Block::Heading("Results of each robot"));
    list.push(text(
        "Evidence: a `number` is a value given by the publishers; `derived` follows from a law that they give; a `constant` belongs to a model that they use, without a statement that it was measured; a `statement` has no value. `same torque` is an \
         equivalent parameterisation: friction of F₊ forwards and F₋ backwards equals Coulomb friction of (F₊ + F₋)/2 with an offset of (F₊ − F₋)/2, and a coupling acts on both of its joints. A \
         difference is (found − published)/|published|. An `alternative` is another effect that, according to the diagnosis, explains the recordings nearly as well. Our notes were written after the results were known.",
    ));
    list.extend(real.robots.iter().flat_map(robot_page::blocks));
    list.extend(hashes(real));
    list
}

/// The number of published effects of a robot whose fate is one of `fates`.
fn count(tried: &Tried, fates: &[PublishedFate]) -> usize {
    let said = tried.score.said.iter();
    said.filter(|said| fates.contains(&said.fate)).count()
}

/// The robot's published values with the estimates.
fn numbers(tried: &Tried) -> impl Iterator<Item = &Compared> {
    let said = tried.score.said.iter().flat_map(|said| &said.numbers);
    said.filter(|number| number.found.is_some())
}

/// The number of published values within the intervals as `k of n`, and the median of the absolute differences.
fn agreement<'a>(numbers: impl Iterator<Item = &'a Compared>) -> [String; 2] {
    let list: Vec<&Compared> = numbers.collect();
    let inside = list.iter().filter(|number| number.covered).count();
    let sizes: Vec<f64> = list.iter().filter_map(|n| Some(n.difference?.abs())).collect();
    let median = quantile(&sizes, 0.5).map_or_else(|| "–".to_owned(), percent);
    if list.is_empty() {
        return ["–".to_owned(), median];
    }
    [format!("{inside} of {}", list.len()), median]
}

fn opening(real: &Real) -> Vec<Block> {
    use PublishedFate::{Confusable, Missed, Named, NotObservable, SameTorque, Unexplained};
    let sum = |fates: &[PublishedFate]| -> usize { real.robots.iter().map(|tried| count(tried, fates)).sum() };
    let said: usize = real.robots.iter().map(|tried| tried.score.said.len()).sum();
    let besides = || real.robots.iter().flat_map(|tried| &tried.score.besides);
    let contradicted = besides().filter(|name| name.contradicted_by.is_some()).count();
    let [inside, median] = agreement(real.robots.iter().flat_map(numbers));
    let [found, equivalent] = [sum(&[Named, SameTorque]), sum(&[SameTorque])];
    let absent = match real.absent.as_slice() {
        [] => String::new(),
        list => format!(" Not tested, because their folders are missing: {}.", list.join(", ")),
    };
    let mut rows: Vec<Vec<String>> = real.robots.iter().map(row).collect();
    rows.push(vec![
        "**all**".into(),
        said.to_string(),
        sum(&[Named]).to_string(),
        sum(&[SameTorque]).to_string(),
        sum(&[Confusable]).to_string(),
        sum(&[NotObservable]).to_string(),
        sum(&[Unexplained]).to_string(),
        sum(&[Missed]).to_string(),
        inside.clone(),
        median.clone(),
        besides().filter(|name| name.contradicted_by.is_none()).count().to_string(),
        contradicted.to_string(),
    ]);
    let head = [
        "robot",
        "published effects",
        "named",
        "named by an equivalent effect",
        "alternative only",
        "declared not testable",
        "joint unexplained",
        "missed",
        "numbers inside our 95 % interval",
        "median difference",
        "named, not published",
        "contradicting the publication",
    ];
    vec![
        Block::Title("Real robots: published recordings, diagnosed blind".into()),
        text(format!(
            "Published recordings of {} real machines were diagnosed by processes that had access to the recordings and a rigid URDF only. Of {said} effects \
             that the publishers report (an effect on a joint), {found} are named, {equivalent} of them by an equivalent effect. Where the publishers give a value and the diagnosis names the effect, {inside} values are inside our 95 % interval; the \
             median difference is {median}. {contradicted} names contradict the publication.{absent}",
            real.robots.len()
        )),
        text(how_hard(real)),
        table(&head, 1, rows),
        by_evidence(real),
    ]
}

/// The limits of the test: how far the figures could have failed.
fn how_hard(real: &Real) -> String {
    let either = |tried: &Tried, fates: &[PublishedFate]| {
        let said = tried.score.said.iter().filter(|said| said.said.effects.len() > 1);
        said.filter(|said| fates.contains(&said.fate)).count()
    };
    let sum = |of: &dyn Fn(&Tried) -> usize| -> usize { real.robots.iter().map(of).sum() };
    let all = sum(&|tried| tried.score.said.len());
    let several = sum(&|tried| tried.score.said.iter().filter(|said| said.said.effects.len() > 1).count());
    let found = [PublishedFate::Named, PublishedFate::SameTorque];
    let (named, named_of_several) = (sum(&|tried| count(tried, &found)), sum(&|tried| either(tried, &found)));
    let deniable: Vec<(&str, usize)> = real
        .robots
        .iter()
        .map(|tried| (tried.robot.name.as_str(), tried.deniable))
        .filter(|(_, pairs)| *pairs > 0)
        .collect();
    let pairs: usize = deniable.iter().map(|(_, pairs)| pairs).sum();
    let list: Vec<String> = deniable.iter().map(|(robot, pairs)| format!("{robot} {pairs}")).collect();
    let list = if list.is_empty() { "none".to_owned() } else { list.join(", ") };
    format!(
        "Limits of this test: publishers rarely state that an effect is absent, so that a name can contradict the publication for only {pairs} of all \
         (effect, joint) pairs, on {} of {} robots ({list}). Of the {all} published effects, {several} leave open which of several effects is \
         meant (\u{201c}Coulomb or viscous\u{201d}). Of these {several}, {named_of_several} are named; of the other {}, {}.",
        deniable.len(),
        real.robots.len(),
        all - several,
        named - named_of_several,
    )
}

fn row(tried: &Tried) -> Vec<String> {
    use PublishedFate::{Confusable, Missed, Named, NotObservable, SameTorque, Unexplained};
    let score = &tried.score;
    let contradicted = score.besides.iter().filter(|name| name.contradicted_by.is_some()).count();
    let statements = score.said.iter().filter(|o| o.said.evidence == Evidence::Statement).count();
    let said = match statements {
        0 => score.said.len().to_string(),
        n => format!("{} ({n} without a number)", score.said.len()),
    };
    let mut cells = vec![tried.robot.name.clone(), said];
    for fate in [Named, SameTorque, Confusable, NotObservable, Unexplained, Missed] {
        cells.push(count(tried, &[fate]).to_string());
    }
    cells.extend(agreement(numbers(tried)));
    cells.push((score.besides.len() - contradicted).to_string());
    cells.push(contradicted.to_string());
    cells
}

/// The agreement of the estimates with the published values, by their evidence.
fn by_evidence(real: &Real) -> Block {
    let kinds = [
        (Evidence::Number, "`number`: given by the publishers"),
        (Evidence::Derived, "`derived` from a law they give"),
        (Evidence::Constant, "`constant` of a model they use"),
    ];
    let rows = kinds.iter().filter_map(|(kind, words)| {
        let outcomes = || real.robots.iter().flat_map(|tried| &tried.score.said);
        let known = || outcomes().filter(|outcome| outcome.said.evidence == *kind);
        let published: usize = known().map(|outcome| outcome.said.parameters.len()).sum();
        let numbers = known().flat_map(|outcome| &outcome.numbers);
        let [inside, median] = agreement(numbers.filter(|number| number.found.is_some()));
        (published > 0).then(|| vec![(*words).to_owned(), published.to_string(), inside, median])
    });
    let head = ["evidence", "values published", "inside our 95 % interval, of those found", "median difference"];
    table(&head, 1, rows.collect())
}

/// The errors on the held-out recordings.
fn errors(real: &Real) -> Vec<Block> {
    let row = |tried: &Tried| {
        let (robot, score) = (&tried.robot, &tried.score);
        let of = |figure: fn(&scoring::HeldOutErrors) -> Option<f64>| error(over_joints(&score.held_out, figure));
        let motion = |figure: fn(&scoring::Rollout) -> f64| {
            let rms = over_joints(&score.rollout, |rollout| Some(figure(rollout)));
            rms.map_or_else(|| "–".to_owned(), |rms| rounded(1e3 * rms, 3))
        };
        vec![
            robot.name.clone(),
            format!("{} and {}", robot.train.len(), robot.held_out.len()),
            match (&score.verdict, &tried.error) {
                (Some(verdict), _) => format!("`{verdict}`"),
                (None, reason) => format!("no answer: {}", reason.as_deref().unwrap_or_default()),
            },
            of(|errors| errors.nominal),
            of(|errors| errors.diagnosed),
            of(|errors| errors.said),
            of(|errors| errors.learned),
            motion(|rollout| rollout.nominal),
            motion(|rollout| rollout.diagnosed),
        ]
    };
    let head = [&["robot", "recordings, training and held out", "verdict"], &ERRORS[..]].concat();
    vec![
        text(
            "Prediction of the held-out recordings by each model: NRMSE of the torque (root mean square error over the torque\u{2019}s standard deviation, samples in motion), root mean square \
             over the joints; and the RMS position error of the simulated arm, driven by the recorded torques over short windows. `published effects, fitted` contains exactly the effects that the \
             publishers name, with their parameters fitted to the same recordings (`diagnose --only`); `learned` is Independent Joint Learning on the same recordings. A position error of hundreds of mrad means that the simulation diverges; it is a lower bound.",
        ),
        table(&head, 3, real.robots.iter().map(row).collect()),
    ]
}

fn protocol(real: &Real) -> Vec<Block> {
    vec![
        Block::Heading("Protocol and limits"),
        text(
            "Before the first diagnosis, the SHA-256 hashes of the program, of each recording and URDF and of the published values are written (`seal.json`, `SHA256SUMS`). Each diagnosis runs in its own \
             process, without environment variables, in a new folder that contains only copies of the recordings and the URDF; it is the public command with the same arguments for all robots. The published values are read at the start, to be \
             checked and sealed; no diagnosis has access to them, and no comparison is made before the hashes of all diagnoses are written (`answers.json`).",
        ),
        text(
            "**This is a blind run of the program, not a blind test of the method**: the authors of the diagnosis knew these recordings and most of the published values while they wrote it. \
             The test with unseen injected faults is in `docs/proof.md`. The publications are not a complete ground truth either: their values are estimates with another filter, possibly from other recordings, \
             or constants of a controller. A name therefore counts as false only where the publication contradicts it; a name without a publication is listed as such, and its correctness is unknown.",
        ),
        Block::Code { language: "sh", code: real.command.clone() },
    ]
}

fn origins(real: &Real) -> Vec<Block> {
    let row = |tried: &Tried| {
        let (robot, source) = (&tried.robot, &tried.robot.source);
        let year = source.year.map_or_else(String::new, |year| format!(", {year}"));
        vec![
            robot.name.clone(),
            format!("{}: {}{year}; {}", source.authors, source.title, source.url),
            source.licence.clone(),
            source.files.clone(),
            source.converted.clone(),
        ]
    };
    let head = ["folder", "source", "licence", "files there", "differences of our files"];
    vec![
        Block::Heading("Origin of the recordings"),
        text(
            "The recordings are not part of this repository, because each has its own licence. To repeat the proof, make one folder per robot in a folder of your choice (`--recordings`), with `robot.urdf` and the recordings as CSV: `t` (s), `q_<joint>` (rad or m), `qd_<joint>` where \
             the robot gave it, `tau_<joint>` (N m or N at the joint); more columns are described in `docs/recordings.md`. Values are in SI units at the joint, neither filtered nor resampled. The differences from the sources are taken from the notes of this collection of recordings and from the sources\u{2019} own programs; the values were not compared with the originals one by one. The seal at the end contains the SHA-256 of each of our files; files that are converted again with other rounding have other hashes. A robot without a folder is omitted, and the report says so.",
        ),
        table(&head, 5, real.robots.iter().map(row).collect()),
    ]
}

fn hashes(real: &Real) -> Vec<Block> {
    let code = |text: &str| format!("`{text}`");
    let mut rows = Vec::new();
    for tried in &real.robots {
        let name = &tried.robot.name;
        let Some(sealed) = real.seal.case(name) else { continue };
        for (ours, theirs) in names(&tried.robot) {
            let hash = sealed.files.get(&theirs).map_or_else(String::new, |hash| code(hash));
            rows.push(vec![name.clone(), code(&ours), hash]);
        }
        rows.push(vec![name.clone(), "published values".into(), code(&sealed.truth)]);
        let answer = real.answers.get(name).cloned().flatten();
        let answer = answer.map_or_else(|| "none".to_owned(), |hash| code(&hash));
        rows.push(vec![name.clone(), "the diagnosis".into(), answer]);
    }
    vec![
        Block::Heading("The seal"),
        text(format!(
            "Program: testbed {}, SHA-256 `{}`. Complete seal: `{}`, the SHA-256 of `SHA256SUMS`. Source: {}.",
            real.seal.program.version, real.seal.program.sha256, real.seal.whole, real.seal.source
        )),
        table(&["robot", "file", "SHA-256"], 3, rows),
    ]
}
