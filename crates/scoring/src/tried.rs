//! A case with all its results.

use crate::answer::Answer;
use crate::truth::Truth;

/// A case with all its results.
#[derive(Clone, Debug)]
pub struct Tried {
    /// The ground truth.
    pub truth: Truth,
    /// The joints' names, base to tip: the order of the noise in the ground truth.
    pub joints: Vec<String>,
    /// The diagnosis; `None` if the program gave no answer.
    pub answer: Option<Answer>,
    /// The true terms fitted by name.
    pub true_terms: Option<Answer>,
    /// A wrong term in place of a true one.
    pub wrong_term: Option<Answer>,
    /// The ratio of the tracking error of a task with the diagnosed effects to that with the exact model; `None` if no task was
    /// tracked.
    pub tracking_over_exact: Option<f64>,
    /// The ratio of these tracking errors in a loop without the lag of the velocity filter, in which only the model differs.
    pub tracking_over_exact_without_lag: Option<f64>,
    /// A second diagnosis, with the proposed experiment; `None` if there was none.
    pub again: Option<Again>,
}

/// A second diagnosis, with the recording of the motion that the first proposed.
#[derive(Clone, Debug)]
pub enum Again {
    /// The second diagnosis.
    Answer(Box<Answer>),
    /// The reason why there is no second diagnosis: the motion could not be recorded, or the program gave no answer.
    Failed(String),
}
