//! The table of all thresholds in `docs/thresholds.md`: made from their files, so that no value changes unseen.

use std::fmt::Write as _;

/// The phases in order, with the files of their thresholds.
const FILES: [(&str, &str); 6] = [
    (
        "The most decisive ones, which can be varied",
        include_str!("../thresholds.rs"),
    ),
    ("Data", include_str!("data.rs")),
    ("Regression", include_str!("regression.rs")),
    ("Search", include_str!("search.rs")),
    ("Selection", include_str!("selection.rs")),
    ("Findings", include_str!("findings.rs")),
];

/// The rows of a file: each constant or field that has a value, below its doc comment.
fn rows(source: &str) -> String {
    let mut rows = String::new();
    let mut words: Vec<&str> = Vec::new();
    for line in source.lines().map(str::trim) {
        if let Some(doc) = line.strip_prefix("/// ") {
            words.push(doc);
            continue;
        }
        let constant = line.strip_prefix("pub const ").and_then(|line| line.split_once(" = "));
        let field = line.strip_suffix(',').and_then(|line| line.split_once(": "));
        let entry = constant.map(|(head, value)| (head.split(':').next().unwrap_or(head), value.trim_end_matches(';')));
        let field = field.filter(|(_, value)| value.parse::<f64>().is_ok());
        let is_number = |(_, value): &(&str, &str)| !value.starts_with('&');
        if let Some((name, value)) = entry.or(field).filter(is_number) {
            assert!(!words.is_empty(), "{name} says what it decides");
            let decides = words.join(" ").replace("[`", "`").replace("`]", "`");
            writeln!(rows, "| `{name}` | {value} | {decides} |").expect("a string takes everything");
        }
        words.clear();
    }
    rows
}

/// `UPDATE_DOCS=1` writes the page anew.
#[test]
fn the_page_lists_every_threshold_with_its_value() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/thresholds.md");
    let page = std::fs::read_to_string(path).expect("the page is there");
    let (head, rest) = page
        .split_once("<!-- begin -->\n")
        .expect("the page says where the tables begin");
    let (_, tail) = rest.split_once("<!-- end -->").expect("the page says where they end");
    let mut tables = String::new();
    for (phase, source) in FILES {
        let table = rows(source);
        assert!(!table.is_empty(), "{phase}");
        write!(
            tables,
            "\n## {phase}\n\n| threshold | value | decides |\n|---|---|---|\n{table}"
        )
        .expect("a string takes it");
    }
    let new = format!("{head}<!-- begin -->\n{tables}\n<!-- end -->{tail}");
    if std::env::var_os("UPDATE_DOCS").is_some() {
        std::fs::write(path, new).expect("the page can be written");
        return;
    }
    assert_eq!(page, new, "UPDATE_DOCS=1 writes the page anew");
}
