//! Errors of the TOML parser, for the author of the file.

/// Keys that only one kind of file has.
const KINDS: [(&[&str], &str); 3] = [
    (&["controller", "reference", "duration", "plant", "sensors", "training"], "a scenario (--scenario)"),
    (&["time", "joints", "system", "topics", "delimiter"], "a column map (--map)"),
    (&["effects"], "a model of effects (--known)"),
];

/// The error that the key `unknown` is none of the `known` ones, with the nearest of them.
pub fn unknown_key(unknown: &str, known: &[String]) -> String {
    // A file of another kind that was given in its place.
    let kind = KINDS.iter().find(|(keys, _)| keys.contains(&unknown) && !known.iter().any(|key| key == unknown));
    let hint = match (kind, nearest(unknown, known)) {
        (Some((_, kind)), _) => format!("is this {kind}? "),
        (None, Some(nearest)) => format!("did you mean `{nearest}`? "),
        (None, None) => String::new(),
    };
    format!("unknown key `{unknown}`; {hint}known here: {}", known.join(", "))
}

/// The parser's error in one line; for an unknown key, with the nearest known one. The crate `toml` offers no types of errors, so that
/// this is the one place that reads its messages.
pub fn toml_reason(message: &str) -> String {
    match unknown_field(message) {
        Some((unknown, known)) => unknown_key(&unknown, &known),
        None => {
            let remedy = match message {
                _ if message.starts_with("missing field") => "; add it",
                _ if message.starts_with("duplicate key") => "; keep one of the two",
                _ if message.contains("expected `=`") => "; this is not TOML (key = value)",
                _ => "",
            };
            message.replace('\n', " ") + remedy
        }
    }
}

/// The name in `known` that is nearest to `name`, if it is similar enough.
pub fn nearest<'a>(name: &str, known: &'a [String]) -> Option<&'a str> {
    let distance = |other: &str| strsim::damerau_levenshtein(&name.to_lowercase(), &other.to_lowercase());
    let best = known.iter().min_by_key(|other| distance(other))?;
    (distance(best) <= name.len().max(best.len()).div_ceil(2)).then_some(best.as_str())
}

/// The unknown field and the known ones in serde's message "unknown field `a`, expected one of `b`, `c`".
fn unknown_field(message: &str) -> Option<(String, Vec<String>)> {
    let rest = message.strip_prefix("unknown field `")?;
    let (unknown, rest) = rest.split_once('`')?;
    let known = rest.split('`').skip(1).step_by(2).map(str::to_owned).collect();
    Some((unknown.to_owned(), known))
}
