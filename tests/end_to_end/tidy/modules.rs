//! The modules of a crate use each other in one direction only.
//!
//! A module is a file together with the folder of its name. Two modules of the same folder may not need each other, neither directly
//! nor through others: each can then be read after those that it uses. A module and the modules inside it are not compared.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A module's path in its crate: `[]` is the root, `["data", "motion"]` is `crate::data::motion`.
type Module = Vec<String>;

/// A path that a file uses, and the name that it gives to it where it is a `use` with `pub`.
struct Used {
    path: Vec<String>,
    exported_as: Option<String>,
}

/// Words, `::`, and single other characters of a Rust file, without comments, strings and its unit tests.
fn tokens(text: &str) -> Vec<String> {
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let mut tokens: Vec<String> = Vec::new();
    for line in text.lines() {
        let line = line.split("//").next().unwrap_or_default();
        for (k, part) in line.split('"').enumerate() {
            if k % 2 == 1 {
                continue;
            }
            let mut in_word = false;
            for c in part.chars().filter(|c| *c != '\r') {
                let is_word = c.is_alphanumeric() || c == '_';
                match tokens.last_mut() {
                    Some(last) if is_word && in_word => last.push(c),
                    Some(last) if c == ':' && last == ":" => last.push(c),
                    _ if c.is_whitespace() => {}
                    _ => tokens.push(c.to_string()),
                }
                in_word = is_word;
            }
        }
    }
    tokens
}

fn is_word(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// The paths of the tree that begins at token `at`, and the place after it.
fn tree(tokens: &[String], mut at: usize, before: &[String], is_exported: bool, found: &mut Vec<Used>) -> usize {
    let mut path = before.to_vec();
    loop {
        match tokens.get(at).map(String::as_str) {
            Some("{") => {
                at += 1;
                while tokens.get(at).is_some_and(|token| token != "}") {
                    at = tree(tokens, at, &path, is_exported, found);
                    at += usize::from(tokens.get(at).is_some_and(|token| token == ","));
                }
                return at + 1;
            }
            Some("*") => at += 1,
            Some("self") if !path.is_empty() => at += 1,
            Some(word) if is_word(word) => {
                path.push(word.to_owned());
                at += 1;
            }
            // What is no path is passed over.
            _ => return at + 1,
        }
        if tokens.get(at).is_none_or(|token| token != "::") {
            break;
        }
        at += 1;
    }
    let mut name = path.last().cloned();
    if tokens.get(at).is_some_and(|token| token == "as") {
        name = tokens.get(at + 1).cloned();
        at += 2;
    }
    found.push(Used { exported_as: name.filter(|_| is_exported), path });
    at
}

/// The paths that a file uses.
fn used(text: &str) -> Vec<Used> {
    let tokens = tokens(text);
    let mut found = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        let before = at.checked_sub(1).map_or("", |before| tokens[before].as_str());
        at = match tokens[at].as_str() {
            "use" => tree(&tokens, at + 1, &[], matches!(before, "pub" | ")"), &mut found),
            "crate" | "super" if before != "in" => tree(&tokens, at, &[], false, &mut found),
            _ => at + 1,
        };
    }
    found
}

/// The modules of a crate that are not only for its tests, and their files' texts.
fn modules(source: &Path) -> BTreeMap<Module, String> {
    let mut files = Vec::new();
    super::rust_files(source, &mut files);
    let mut modules = BTreeMap::new();
    for file in files {
        let place = file.strip_prefix(source).expect("the file is in the folder").with_extension("");
        let mut module: Module = place.iter().map(|part| part.to_string_lossy().into_owned()).collect();
        let is_root = ["lib", "main"].iter().any(|root| module == [root.to_owned()]);
        if is_root || module.last().is_some_and(|last| last == "mod") {
            module.pop();
        }
        modules.insert(module, super::read(&file));
    }
    let is_test = |module: &Module| {
        (1..=module.len()).any(|depth| {
            let (name, parent) = (&module[depth - 1], &module[..depth - 1]);
            modules.get(parent).is_some_and(|text: &String| text.contains(&format!("#[cfg(test)]\nmod {name};")))
        })
    };
    let tests: BTreeSet<Module> = modules.keys().filter(|module| is_test(module)).cloned().collect();
    modules.retain(|module, _| !tests.contains(module));
    modules
}

/// The uses between modules of the same folder: from, to, and where.
fn uses(modules: &BTreeMap<Module, String>) -> BTreeMap<Module, BTreeMap<Module, String>> {
    let of_files: Vec<(&Module, Vec<Used>)> = modules.iter().map(|(module, text)| (module, used(text))).collect();
    // The absolute path of a path that is used in a module; of another crate, there is none.
    let absolute = |module: &Module, path: &[String]| -> Option<Vec<String>> {
        let up = path.iter().take_while(|part| *part == "super").count();
        let (base, rest) = match path.first().map(String::as_str) {
            Some("crate") => (&module[..0], &path[1..]),
            Some("super") => (&module[..module.len().checked_sub(up)?], &path[up..]),
            Some("self") => (&module[..], &path[1..]),
            Some(_) => {
                let inner = [&module[..], &path[..1]].concat();
                modules.contains_key(&inner).then_some((&module[..], path))?
            }
            None => return None,
        };
        Some([base, rest].concat())
    };
    let mut exports: BTreeMap<Vec<String>, Vec<String>> = BTreeMap::new();
    for (module, list) in &of_files {
        for used in list {
            if let (Some(name), Some(path)) = (&used.exported_as, absolute(module, &used.path)) {
                exports.insert([&module[..], std::slice::from_ref(name)].concat(), path);
            }
        }
    }
    // The module in which a path is defined: names that a module passes on are followed.
    let defined = |path: Vec<String>| -> Module {
        let mut path = path;
        for _ in 0..8 {
            let known = (0..=path.len()).rev().find(|&depth| modules.contains_key(&path[..depth]));
            let depth = known.unwrap_or(0);
            let next = path.get(..=depth).and_then(|named| exports.get(named));
            match next {
                Some(next) if *next != path => path = [&next[..], &path[depth + 1..]].concat(),
                _ => return path[..depth].to_vec(),
            }
        }
        path
    };
    let mut uses: BTreeMap<Module, BTreeMap<Module, String>> = BTreeMap::new();
    for (module, list) in &of_files {
        for used in list.iter().filter(|used| used.exported_as.is_none() || !module.is_empty()) {
            let Some(path) = absolute(module, &used.path) else {
                continue;
            };
            let target = defined(path);
            let common = module.iter().zip(&target).take_while(|(a, b)| a == b).count();
            if common < module.len() && common < target.len() {
                let line = format!("{} uses {}", module.join("/"), used.path.join("::"));
                let from = uses.entry(module[..=common].to_vec()).or_default();
                from.entry(target[..=common].to_vec()).or_insert(line);
            }
        }
    }
    uses
}

/// The uses that close a circle, if there is one: a shortest way from a module back to it.
fn circle(uses: &BTreeMap<Module, BTreeMap<Module, String>>) -> Option<Vec<String>> {
    let around = |start: &Module| {
        let mut ways: Vec<(Module, Vec<String>)> = vec![(start.clone(), Vec::new())];
        let mut seen = BTreeSet::new();
        let mut at = 0;
        while at < ways.len() {
            let (module, way) = ways[at].clone();
            for (next, line) in uses.get(&module).into_iter().flatten() {
                let way = [&way[..], std::slice::from_ref(line)].concat();
                if next == start {
                    return Some(way);
                }
                if seen.insert(next.clone()) {
                    ways.push((next.clone(), way));
                }
            }
            at += 1;
        }
        None
    };
    uses.keys().filter_map(around).min_by_key(Vec::len)
}

#[test]
fn no_modules_use_each_other_in_a_circle() {
    let entries = std::fs::read_dir(crate::support::root().join("crates")).expect("the folder can be read");
    for folder in entries.flatten().map(|entry| entry.path()) {
        let name = folder.display();
        let uses = uses(&modules(&folder.join("src")));
        assert!(!uses.is_empty(), "{name}");
        if let Some(circle) = circle(&uses) {
            panic!("modules of {name} use each other in a circle:\n{}", circle.join("\n"));
        }
    }
}

#[test]
fn a_circle_is_found_through_names_that_are_passed_on() {
    let texts = [
        ("", "mod a;\nmod b;\nmod c;\npub use a::One;"),
        ("a", "use crate::b::{self, Two as Other};\nmod inner;"),
        ("a/inner", "use super::One;"),
        ("b", "fn f(_: &super::c::Three) {}"),
        ("c", "// crate::a\n"),
    ];
    let modules = |c: &str| -> BTreeMap<Module, String> {
        let named = texts.iter().map(|(module, text)| {
            let module: Module = module.split('/').filter(|part| !part.is_empty()).map(str::to_owned).collect();
            (module, (*text).to_owned())
        });
        named.chain([(vec!["c".to_owned()], c.to_owned())]).collect()
    };
    assert_eq!(circle(&uses(&modules("// crate::a\n"))), None);
    let found = circle(&uses(&modules("use crate::One;")));
    let lines = ["a uses crate::b", "b uses super::c::Three", "c uses crate::One"];
    assert_eq!(found, Some(lines.map(str::to_owned).to_vec()));
}
