//! Errors for Python: the sentences of the command line, with names of parameters in place of flags.

use pyo3::PyErr;
use pyo3::create_exception;
use pyo3::exceptions::PyValueError;

create_exception!(
    jointwise,
    JointwiseError,
    PyValueError,
    "An input that cannot be used: where it is, what was found, and the remedy."
);

/// Flags of the command line in messages, each with its replacement; longer flags come first.
const FLAGS: &[(&str, &str)] = &[
    ("--urdf-friction known", "urdf_friction=\"known\""),
    ("--urdf-accuracy", "urdf_accuracy"),
    ("--torque-accuracy", "torque_accuracy"),
    ("--verbose lists them", "the result's notes list them"),
    ("testbed inspect --json lists them", "testbed inspect --json FILE lists them"),
    ("--held-out", "held_out"),
    ("--torque-lag", "torque_lag"),
    ("--cutoff", "cutoff"),
    ("--before", "before"),
    ("--robot", "urdf"),
    ("--known", "known"),
    ("--model", "to_toml()"),
    ("--train", "train"),
    ("--base", "base"),
    ("--only", "only"),
    ("--map", "column_map"),
    ("--tip", "tip"),
];

/// `text` with the names of Python parameters in place of flags.
pub fn in_python(text: &str) -> String {
    let mut words = String::new();
    let mut rest = text;
    // As the keyword that it is: a mapping.
    while let Some((before, after)) = rest.split_once("--lock") {
        words.push_str(before);
        let given = after.trim_start().split_once("=VALUE");
        rest = match given.filter(|(joint, _)| !joint.contains(char::is_whitespace)) {
            Some((joint, after)) => {
                words.push_str(&format!("lock={{\"{joint}\": VALUE}}"));
                after
            }
            None => {
                words.push_str("lock");
                after
            }
        };
    }
    words.push_str(rest);
    for (flag, name) in FLAGS {
        words = words.replace(flag, name);
    }
    words
}

/// The exception with the text of `error`.
pub fn raised(error: &anyhow::Error) -> PyErr {
    JointwiseError::new_err(in_python(&study::sentence(error)))
}
