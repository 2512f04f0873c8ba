//! The texts of a diagnosis and of a proof: blocks, charts, pages, Markdown, terminal. It returns strings and writes no files.
//!
//! A diagnosis is a [`page`](page()) with figures, a text for the [`terminal`], and [Markdown](diagnosis_markdown()). Any other
//! report is a list of [`block`]s, which [`block_page`](block_page()) and [`markdown`](markdown()) both render; [`score`] makes those of a proof.
//!
//! ```
//! use report::block::Block;
//!
//! let head = vec!["joint".to_owned(), "error".to_owned()];
//! let rows = vec![vec!["elbow".to_owned(), "0.22".to_owned()]];
//! let blocks = [Block::Title("A report".to_owned()), Block::Table { head, rows, words: 1 }];
//! let text = report::markdown(&blocks, "made by hand");
//! assert!(text.starts_with("# A report") && text.contains("| elbow | 0.22 |"));
//! ```

// Only the command line prints.
#![warn(clippy::print_stderr, clippy::print_stdout)]

mod alternatives;
pub mod block;
mod block_page;
pub mod chart;
mod diagnosis_markdown;
mod differences;
pub mod doubts;
pub mod left_out;
mod markdown;
pub mod next_words;
mod not_diagnosed;
pub mod numbers;
mod page;
mod regions;
pub mod score;
mod shell;
mod sizes;
pub mod terminal;
pub mod words;

pub use block_page::block_page;
pub use diagnosis_markdown::diagnosis_markdown;
pub use markdown::markdown;
pub use page::page;
