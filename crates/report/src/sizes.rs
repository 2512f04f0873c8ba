//! The sizes of findings in words.

use diagnosis::{Finding, Parameter};

use crate::numbers;
use crate::words::{parameter, wording};

/// The sizes of a finding with their intervals: its main parameters without those that are zero, each with its name if there are
/// several. Without a main parameter, the first one.
pub fn list(finding: &Finding) -> Vec<String> {
    let main = wording(finding.effect).main.iter();
    let mut found: Vec<(&&str, &Parameter)> = main
        .filter_map(|name| finding.parameters.get_key_value(name))
        .filter(|(_, parameter)| parameter.value != 0.0)
        .collect();
    if found.is_empty() {
        found.extend(finding.parameters.iter().next());
    }
    let named = found.len() > 1;
    let text = |(name, size): (&&str, &Parameter)| {
        let text = numbers::with_interval(name, size);
        if named { format!("{} {text}", parameter(name)) } else { text }
    };
    found.into_iter().map(text).collect()
}

/// The sizes of a finding in one cell of a table.
pub fn cell(finding: &Finding, separator: &str) -> String {
    let sizes = list(finding);
    if sizes.is_empty() { "–".to_owned() } else { sizes.join(separator) }
}
