//! What came of the proposed experiments, in words.
