//! What the definition of a fault says of an injected one.

use arm::Arm;

use super::{Fault, Leaves, parts};
use crate::error::FaultError;
use crate::truth::Injected;

impl Injected {
    /// Refuses an effect that cannot be injected into `arm`.
    ///
    /// # Errors
    /// [`FaultError::Effect`], with the effect, what is wrong and the remedy.
    pub fn check(&self, arm: &Arm) -> Result<(), FaultError> {
        parts(self, arm, true).map(|_| ())
    }

    /// The definition of its kind, if there is such a fault.
    pub(crate) fn fault(&self) -> Option<&'static Fault> {
        Fault::named(&self.effect)
    }

    /// The part that remains when it is removed.
    pub(crate) fn leaves(&self) -> Leaves {
        if self.is_not_mounted() {
            return Leaves::Tool;
        }
        self.fault().map_or(Leaves::Nothing, |fault| fault.leaves)
    }

    /// Whether `other` is the same effect on the same joint (with the same other joint), and both begin at an onset or
    /// neither does.
    pub(crate) fn is_same_effect(&self, other: &Self) -> bool {
        let with = |injected: &Self| injected.parameters.get("other").cloned();
        let is_same = self.effect == other.effect && self.joint == other.joint && with(self) == with(other);
        is_same && self.onset.is_some() == other.onset.is_some() && self.fault().is_some_and(|fault| !fault.may_repeat)
    }
}
