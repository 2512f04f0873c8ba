//! A pass over the recordings, from the data to the conclusion.

use arm::Arm;

use crate::data::Data;
use crate::data::input::Input;
use crate::error::DiagnosisError;
use crate::findings::conclusion::Conclusion;
use crate::options::{Options, Step};
use crate::search::study::Study;
use crate::selection::FinalFit;
use crate::trace::Trace;

/// The final fit, and the conclusions.
pub struct Pass {
    /// The final fit.
    pub last: FinalFit,
    /// The conclusions from it.
    pub conclusion: Conclusion,
}

impl Pass {
    /// The pass over these recordings, whose decisions continue `trace`.
    ///
    /// # Errors
    /// [`DiagnosisError`], if there is nothing to fit.
    pub fn new(
        arm: &Arm,
        inputs: &[Input<'_>],
        options: &Options,
        trace: Trace,
        progress: &dyn Fn(Step<'_>),
    ) -> Result<Self, DiagnosisError> {
        progress(Step::new(0.08, "filtering, rigid-body torques"));
        let data = Data::new(arm, inputs, options)?;
        let mut study = Study::new(data, options).with_own_load(options);
        study.trace = trace;
        let last = FinalFit::new(study, options, progress)?;
        if !last.judged.named.score.is_finite() {
            return Err(DiagnosisError::NotFinite);
        }
        progress(Step::new(0.78, "alternatives of the findings"));
        let conclusion = Conclusion::new(&last, inputs, options);
        Ok(Self { last, conclusion })
    }
}
