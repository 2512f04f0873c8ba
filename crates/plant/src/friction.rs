//! Dry friction: which joints slide and which stick.

/// The present state of a joint's dry friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Contact {
    /// The joint slides in the positive (1) or negative (−1) direction, or has no dry friction (0).
    Sliding(f64),
    /// The joint is at rest and locked.
    Stuck,
}

/// The joints' dry friction.
#[derive(Clone, Debug)]
pub(crate) struct DryFriction {
    /// The largest friction torque of each joint (N m or N).
    pub(crate) levels: Vec<f64>,
    pub(crate) contacts: Vec<Contact>,
    /// Joints that remain at rest for this step, whatever their torque.
    pub(crate) pinned: Vec<bool>,
    /// The distance of each joint from its event at the end of the last trial; negative after the event.
    pub(crate) margins: Vec<f64>,
    pub(crate) qdd: Vec<f64>,
}

impl DryFriction {
    pub(crate) fn new(levels: &[f64], dof: usize) -> Self {
        let mut all = levels.to_vec();
        all.resize(dof, 0.0);
        Self {
            levels: all,
            contacts: vec![Contact::Sliding(0.0); dof],
            pinned: vec![false; dof],
            margins: vec![f64::INFINITY; dof],
            qdd: vec![0.0; dof],
        }
    }

    pub(crate) fn set_levels(&mut self, levels: &[f64]) {
        self.levels.copy_from_slice(levels);
    }

    /// Whether any joint has dry friction.
    pub(crate) fn is_dry(&self) -> bool {
        self.levels.iter().any(|&level| level > 0.0)
    }

    pub(crate) fn is_stuck(&self, i: usize) -> bool {
        self.contacts[i] == Contact::Stuck
    }

    /// Discards the joints' states; the next step determines them again.
    pub(crate) fn release(&mut self) {
        self.contacts.fill(Contact::Sliding(0.0));
    }

    /// What friction adds to the torque of joint `i` while it slides (N m or N).
    pub(crate) fn torque(&self, i: usize) -> f64 {
        match self.contacts[i] {
            Contact::Sliding(sign) => -sign * self.levels[i],
            Contact::Stuck => 0.0,
        }
    }

    /// The joints that stick.
    pub(crate) fn stuck(&self) -> Vec<usize> {
        (0..self.contacts.len()).filter(|&i| self.is_stuck(i)).collect()
    }

    /// A joint other than `known` that is past its event at the end of the last trial.
    pub(crate) fn violated(&self, known: Option<usize>) -> Option<usize> {
        (0..self.margins.len()).find(|&i| self.margins[i] < 0.0 && Some(i) != known)
    }
}
