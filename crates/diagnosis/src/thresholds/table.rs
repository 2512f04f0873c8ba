//! The tables of all thresholds in `docs/thresholds.md`, which are generated from their files, so that every change of a
//! value shows there.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use effects::{CATALOGUE, Spec};

/// The phases in order, with the files of their thresholds.
const FILES: [(&str, &str); 7] = [
    ("The most decisive ones, which can be varied", DECISIVE),
    ("Data", include_str!("data.rs")),
    ("Regression", include_str!("regression.rs")),
    ("Search", include_str!("search.rs")),
    ("Selection", include_str!("selection.rs")),
    ("Findings", include_str!("findings.rs")),
    ("Next experiment", include_str!("next.rs")),
];

/// The file of the thresholds that can be varied.
const DECISIVE: &str = include_str!("../thresholds.rs");

/// The rows of a file: each constant or field that has a value, below its doc comment; `file` is put before its name.
fn rows(file: &str, source: &str) -> String {
    let mut rows = String::new();
    let mut words: Vec<&str> = Vec::new();
    let source = source.split("#[cfg(test)]\nmod tests {").next().unwrap_or(source);
    let mut lines = source.lines().map(str::trim);
    while let Some(line) = lines.next() {
        if let Some(doc) = line.strip_prefix("/// ") {
            words.push(doc);
            continue;
        }
        let mut line = line.to_owned();
        // A list of lists stands on several lines.
        if line.contains("const ") && line.ends_with(" = [") {
            let inner: Vec<&str> = lines.by_ref().take_while(|&part| part != "];").collect();
            line += &format!("{}];", inner.join(" ").trim_end_matches(','));
        }
        let line = line.as_str();
        let constant = line.strip_prefix("pub ").unwrap_or(line).strip_prefix("const ");
        let constant = constant.and_then(|line| line.split_once(" = "));
        let field = line.strip_suffix(',').and_then(|line| line.split_once(": "));
        let entry = constant.map(|(head, value)| (head.split(':').next().unwrap_or(head), value.trim_end_matches(';')));
        let field = field.filter(|(_, value)| file.is_empty() && value.parse::<f64>().is_ok());
        let is_number =
            |(_, value): &(&str, &str)| value.starts_with(|c: char| c.is_ascii_digit() || "-[(".contains(c));
        if let Some((name, value)) = entry.or(field).filter(is_number) {
            assert!(!words.is_empty(), "{name} says what it decides");
            let decides = words.join(" ").replace("[`", "`").replace("`]", "`");
            writeln!(rows, "| {file}`{name}` | {value} | {decides} |").expect("a string takes everything");
        }
        words.clear();
    }
    rows
}

/// The evidence that each effect must bring, and its relations to others, from the specs.
fn relations() -> String {
    let row = |spec: &Spec| {
        let mut relations: Vec<String> = Vec::new();
        if let (Some(plain), true) = (spec.generalises, spec.least_beyond_simpler > 0.0) {
            relations.push(format!("explains {} of the torque beyond `{plain}`", spec.least_beyond_simpler));
        }
        relations.extend(spec.least_beside.iter().map(|(name, part)| format!("exceeds {part} of `{name}`")));
        if let Some(nats) = spec.least_beside_inertials {
            relations.push(format!("brings {nats} nats beside the best correction of all inertial parameters"));
        }
        if let Some(most) = spec.most_beside_inertials {
            relations.push(format!("deviates by at most {most} where the URDF is wrong everywhere"));
        }
        if let Some(multiple) = spec.least_beside_residual {
            relations.push(format!("exceeds {multiple} times the structured residual"));
        }
        format!("| `{}` | {} | {} |\n", spec.name, spec.prior, relations.join("; "))
    };
    CATALOGUE.iter().map(|spec| row(spec)).collect()
}

/// The thresholds of the checks of recordings, from their file in `study`.
fn of_the_checks() -> String {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../study/src/check/thresholds.rs");
    rows("", &std::fs::read_to_string(path).expect("text"))
}

/// The limits of the effects, from their files.
fn limits() -> String {
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("../effects/src");
    let files = |folder: &str| -> Vec<PathBuf> {
        let entries = std::fs::read_dir(sources.join(folder)).expect("the folder is there");
        let mut files: Vec<PathBuf> = entries.map(|entry| entry.expect("it can be read").path()).collect();
        files.sort();
        files
    };
    let folders = ["friction", "drive", "sensor", "arm", "joint", "unmodelled"];
    let files = folders
        .into_iter()
        .flat_map(files)
        .chain(["fitted.rs", "background.rs", "spec.rs"].map(|file| sources.join(file)));
    let rows = files.map(|path| {
        let file = path.strip_prefix(&sources).expect("it is below").display().to_string();
        rows(&format!("{file}: "), &std::fs::read_to_string(&path).expect("text"))
    });
    rows.collect()
}

#[test]
fn every_decisive_threshold_has_a_source() {
    let table = rows("", DECISIVE);
    let names = |with: &str| -> Vec<String> {
        let rows = table.lines().filter(|row| row.contains(with));
        rows.filter_map(|row| row.split('`').nth(1).map(str::to_owned)).collect()
    };
    assert_eq!(names(""), super::Thresholds::NAMES);
    assert_eq!(names(" Source: "), super::Thresholds::NAMES);
}

/// `UPDATE_DOCS=1` writes the page anew.
#[test]
fn the_page_lists_every_threshold_with_its_value() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/thresholds.md");
    let page = std::fs::read_to_string(path).expect("the page is there");
    let (head, rest) = page.split_once("<!-- begin -->\n").expect("the page says where the tables begin");
    let (_, tail) = rest.split_once("<!-- end -->").expect("the page says where they end");
    let mut tables = format!(
        "\n## Checks of recordings against the URDF\n\n| threshold | value | decides |\n|---|---|---|\n{}",
        of_the_checks()
    );
    for (phase, source) in FILES {
        let table = rows("", source);
        assert!(!table.is_empty(), "{phase}");
        write!(tables, "\n## {phase}\n\n| threshold | value | decides |\n|---|---|---|\n{table}")
            .expect("a string takes it");
    }
    write!(
        tables,
        "\n## Effects: evidence and relations\n\n| effect | evidence beyond that of its coefficients (nats) | named only if it |\n|---|---|---|\n{}\
         \n## Effects: limits\n\n| threshold | value | decides |\n|---|---|---|\n{}",
        relations(),
        limits()
    )
    .expect("a string takes it");
    let new = format!("{head}<!-- begin -->\n{tables}\n<!-- end -->{tail}");
    if std::env::var_os("UPDATE_DOCS").is_some() {
        std::fs::write(path, new).expect("the page can be written");
        return;
    }
    assert_eq!(page, new, "UPDATE_DOCS=1 writes the page anew");
}
