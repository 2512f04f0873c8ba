//! What the tests of diagnoses share.

use std::cell::RefCell;

use study::notes::Notes;
use study::{Listener, Step};

/// Keeps the notes of a diagnosis.
#[derive(Default)]
pub struct Heard(pub RefCell<Vec<String>>);

impl Listener for Heard {
    fn doing(&self, _: Step<'_>) {}

    fn note(&self, text: &str) {
        self.0.borrow_mut().push(text.to_owned());
    }

    fn recordings(&self, _: &Notes) {}
}
