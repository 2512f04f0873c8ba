//! What no compiler checks: the architecture page names the crates there are, files are headed and not over-long.

use std::path::{Path, PathBuf};

use arm::JointKind;
use effects::{Shape, Spec};

mod modules;

const LONGEST_FILE: usize = 400;

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("the folder can be read").flatten() {
        let path = entry.path();
        if path.is_dir() {
            if path.file_name().is_some_and(|name| name != "target") {
                rust_files(&path, found);
            }
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

fn all_rust_files() -> Vec<PathBuf> {
    let mut files = Vec::new();
    for folder in ["crates", "tests"] {
        rust_files(&crate::support::root().join(folder), &mut files);
    }
    assert!(files.len() > 30);
    files
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).expect("the file can be read")
}

#[test]
fn every_file_opens_with_its_line() {
    for path in all_rust_files() {
        assert!(read(&path).starts_with("//! "), "{} does not open with a //! line", path.display());
    }
}

#[test]
fn no_file_is_over_long() {
    for path in all_rust_files() {
        let lines = read(&path).lines().count();
        assert!(lines <= LONGEST_FILE, "{} has {lines} lines: two rooms in one?", path.display());
    }
}

/// A page that a command wrote has the paths with which the command was given.
#[test]
fn pages_have_relative_paths_to_what_is_beside_the_repository() {
    let root = crate::support::root();
    let docs = std::fs::read_dir(root.join("docs")).expect("the folder can be read");
    let pages = docs.flatten().map(|entry| entry.path());
    let pages = pages.chain(["README.md", "ARCHITECTURE.md", "CHANGELOG.md"].map(|name| root.join(name)));
    for page in pages.filter(|path| path.extension().is_some_and(|extension| extension == "md")) {
        let text = read(&page).replace("../shared", "");
        assert!(!text.contains("/shared/"), "{} has an absolute path", page.display());
    }
}

#[test]
fn the_architecture_page_names_the_crates_there_are() {
    let page = read(&crate::support::root().join("ARCHITECTURE.md"));
    let rows = page.lines().filter_map(|line| line.strip_prefix("| `crates/"));
    let mut named: Vec<&str> = rows.filter_map(|row| row.split('`').next()).collect();
    named.sort_unstable();
    let entries = std::fs::read_dir(crate::support::root().join("crates")).expect("the folder can be read").flatten();
    let mut there: Vec<String> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    there.sort_unstable();
    assert_eq!(named, there);
}

#[test]
fn every_scenario_and_robot_comes_with_the_program() {
    // The folders of the root are links into the crates that compile the files into themselves.
    for (folder, part, library) in [
        ("scenarios", "crates/testbed/scenarios", "crates/testbed/src/library.rs"),
        ("assets", "crates/study/robots", "crates/study/src/robot.rs"),
    ] {
        let list = read(&crate::support::root().join(library));
        for entry in std::fs::read_dir(crate::support::root().join(part)).expect("the folder can be read").flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            assert!(list.contains(&format!("/{name}\")")), "{name} is not in {library}");
            let link = crate::support::root().join(folder).join(&name);
            assert!(link.is_file(), "{name} is not in {folder}");
        }
    }
    let ready = read(&crate::support::root().join("crates/recording/src/dialect.rs"));
    for entry in
        std::fs::read_dir(crate::support::root().join("assets/maps")).expect("the folder can be read").flatten()
    {
        let name = entry.path().file_stem().expect("a file").to_string_lossy().into_owned();
        assert!(ready.contains(&format!("ready!(\"{name}\")")), "{name} is not in dialect.rs");
    }
}

/// A row of the catalogue's table: name, what it adds, parameters with their units on a turning joint.
fn row(spec: &Spec) -> String {
    let parameter = |parameter: &effects::Parameter| {
        let unit = parameter.quantity.unit(JointKind::Revolute);
        let remark = match (parameter.remark, parameter.shape) {
            (Some(remark), _) => remark,
            (None, Shape::Points) => "points",
            (None, _) => unit,
        };
        let key = parameter.key;
        if remark.is_empty() { format!("`{key}`") } else { format!("`{key}` ({remark})") }
    };
    let other = spec.has_other.then(|| "`other` (a joint)".to_owned());
    let onset = spec.may_set_in.then(|| "`onset` (s)".to_owned());
    let parameters = other.into_iter().chain(spec.parameters.iter().map(parameter)).chain(onset);
    let parameters = parameters.collect::<Vec<_>>().join(", ");
    let formula = spec.formula.replace('|', "\\|");
    format!("| `{}` | {formula} | {parameters} |\n", spec.name)
}

/// `UPDATE_DOCS=1` writes the table anew.
#[test]
fn the_catalogues_table_is_the_catalogue() {
    let path = crate::support::root().join("docs/diagnosis.md");
    let page = read(&path);
    let head = "| effect | torque or meaning | parameters |\n|---|---|---|\n";
    let start = page.find(head).expect("the table is there") + head.len();
    let end = start + page[start..].find("\n\n").expect("the table ends") + 1;
    let table: String = effects::CATALOGUE.iter().map(|spec| row(spec)).collect();
    if std::env::var_os("UPDATE_DOCS").is_some() {
        let page = [&page[..start], &table, &page[end..]].concat();
        std::fs::write(&path, page).expect("the page can be written");
        return;
    }
    assert_eq!(&page[start..end], table, "UPDATE_DOCS=1 writes the table anew");
}

/// `UPDATE_DOCS=1` writes the schema anew.
#[test]
fn the_published_schema_is_that_of_the_program() {
    let path = crate::support::root().join("docs/diagnosis.schema.json");
    let schema = crate::support::Sandbox::new().succeed(&["schema"]);
    if std::env::var_os("UPDATE_DOCS").is_some() {
        std::fs::write(&path, schema).expect("the schema can be written");
        return;
    }
    assert!(read(&path) == schema, "UPDATE_DOCS=1 writes docs/diagnosis.schema.json anew");
}

/// The documentation's pages, by name.
fn pages() -> Vec<String> {
    let entries = std::fs::read_dir(crate::support::root().join("docs")).expect("the folder can be read");
    let names = entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = names.filter(|name| name.ends_with(".md") && name != "SUMMARY.md").collect();
    names.sort();
    names
}

/// The targets of the links of a page, without those of the web.
fn links(text: &str) -> Vec<String> {
    let mut in_code = false;
    let mut targets = Vec::new();
    for line in text.lines() {
        in_code ^= line.starts_with("```");
        if in_code {
            continue;
        }
        let parts = line.split("](").skip(1).filter_map(|rest| rest.split(')').next());
        targets.extend(parts.filter(|target| !target.contains("://")).map(str::to_owned));
    }
    targets
}

#[test]
fn the_books_contents_name_every_page() {
    let summary = read(&crate::support::root().join("docs/SUMMARY.md"));
    let mut named = links(&summary);
    named.sort();
    assert_eq!(named, pages());
}

/// The name under which a heading can be linked to.
fn anchor(heading: &str) -> String {
    let kept = heading.to_lowercase();
    let kept = kept.chars().filter(|&c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

#[test]
fn no_link_is_dead() {
    let root = crate::support::root();
    let mut files = vec!["README.md".to_owned(), "ARCHITECTURE.md".into(), "examples/README.md".into()];
    files.extend(pages().into_iter().map(|page| format!("docs/{page}")));
    for file in files {
        let path = root.join(&file);
        let text = read(&path);
        let folder = path.parent().expect("a file is in a folder");
        for target in links(&text) {
            let (name, part) = target.split_once('#').unwrap_or((&target, ""));
            let to = if name.is_empty() { path.clone() } else { folder.join(name) };
            assert!(to.exists(), "{file} links to {target}, which is not there");
            // The book has no page outside its folder.
            assert!(!file.starts_with("docs/") || !name.starts_with(".."), "{file} links to {target}");
            if !part.is_empty() {
                let page = read(&to);
                let mut headings = page.lines().filter_map(|line| line.strip_prefix('#'));
                let found = headings.any(|line| anchor(line.trim_start_matches('#').trim()) == part);
                assert!(found, "{file} links to {target}, but there is no such heading");
            }
        }
    }
}
