//! Words of sentences.

use std::borrow::Borrow;

/// Several words as "A, B and C".
pub fn list<S: Borrow<str>>(words: &[S]) -> String {
    match words {
        [] => String::new(),
        [one] => one.borrow().to_owned(),
        [first @ .., last] => format!("{} and {}", first.join(", "), last.borrow()),
    }
}

/// A lag of so many seconds in words: "23.4 ms later".
pub fn late(seconds: f64) -> String {
    format!("{:.1} ms {}", 1e3 * seconds.abs(), if seconds > 0.0 { "later" } else { "earlier" })
}

#[cfg(test)]
mod tests {
    use super::list;

    #[test]
    fn the_last_word_follows_an_and() {
        assert_eq!(list::<&str>(&[]), "");
        assert_eq!(list(&["a"]), "a");
        assert_eq!(list(&["a", "b"]), "a and b");
        assert_eq!(list(&["a".to_owned(), "b".to_owned(), "c".to_owned()]), "a, b and c");
    }
}
