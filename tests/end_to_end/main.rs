//! Tests of the whole, through the built program in a temporary folder.

mod conceal;
mod diagnose;
mod diagnose_blind;
mod diagnose_cases;
mod diagnose_invariances;
mod diagnose_made;
mod diagnose_maps;
mod diagnose_mistakes;
mod diagnose_next;
mod diagnose_readings;
mod diagnose_refusals;
mod diagnose_takeaways;
mod diagnose_terminal;
mod excite;
#[cfg(unix)]
mod faults;
#[cfg(unix)]
mod faults_outputs;
mod formats;
mod inspect;
mod manual;
mod named_once;
mod paper;
mod prove;
mod prove_paper;
mod prove_published;
mod readme;
mod refusals;
mod robots;
mod runs;
mod schema;
mod support;
mod tidy;
mod tracking;
mod transfer;
mod untrusted_names;
