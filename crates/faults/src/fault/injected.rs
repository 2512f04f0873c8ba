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

    /// This effect, listed for the outer of its two joints if it acts alike on both, as the catalogue lists it. `place` gives the index of a
    /// joint.
    pub(crate) fn listed_for_outer_joint(&self, place: impl Fn(&str) -> Option<usize>) -> Self {
        let mut listed = self.clone();
        let other = self.parameters.get("other").and_then(serde_json::Value::as_str);
        if let ("transmission_coupling", Some(own), Some(other)) = (self.effect.as_str(), self.joint.as_deref(), other)
            && place(own) < place(other)
        {
            listed.parameters.insert("other".into(), own.into());
            listed.joint = Some(other.to_owned());
        }
        listed
    }

    /// Whether `other` is the same effect on the same joint (with the same other joint), and both begin at an onset or
    /// neither does.
    pub(crate) fn is_same_effect(&self, other: &Self) -> bool {
        let with = |injected: &Self| injected.parameters.get("other").cloned();
        let is_same = self.effect == other.effect && self.joint == other.joint && with(self) == with(other);
        is_same && self.onset.is_some() == other.onset.is_some() && self.fault().is_some_and(|fault| !fault.may_repeat)
    }
}
