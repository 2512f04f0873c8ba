//! Friction that is not the same in all recordings.

use effects::Term;
use effects::background::OWN_FRICTION;

use super::Study;
use crate::data::statistics::median;
use crate::regression::fit::Fit;
use crate::regression::strengths::Strengths;
use crate::search::problem::Selection;

impl Study {
    /// The strengths that differ from the present ones in one link, or in the friction of one joint in some recordings.
    pub(super) fn in_one_place(&self, selected: &Selection) -> Vec<Strengths> {
        let relative = |joint: usize| {
            let levels = self.own_levels(&selected.fit, joint);
            // Of two recordings, none is the usual one, and what changed since those from before is an effect.
            let is_one_apart = levels.len() > 2 && self.data.motions.changed_at.is_none();
            let known = if is_one_apart { levels } else { Vec::new() };
            known.into_iter().map(move |(recording, more)| {
                let relative = more.abs() / self.data.scales.torque[joint].max(f64::MIN_POSITIVE);
                (relative, (joint, recording))
            })
        };
        let all = (0..self.data.motions.dof).flat_map(relative);
        let is_free = |place: &(usize, usize)| self.strengths.varied.contains(place);
        let mut different: Vec<(f64, (usize, usize))> =
            all.filter(|(relative, place)| *relative > 0.0 && !is_free(place)).collect();
        different.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let different: Vec<(usize, usize)> = different.into_iter().map(|(_, place)| place).collect();
        self.strengths.in_one_place(&different)
    }

    /// The training recordings that move a joint, and the dry friction (N m or N) of the joint in each of them beyond that in most.
    pub fn own_levels(&self, fit: &Fit, joint: usize) -> Vec<(usize, f64)> {
        let own = |recording: usize| {
            let term = Term::on(&OWN_FRICTION, joint).of(recording);
            let column = self.table.terms.iter().position(|known| *known == term)?;
            Some((recording, fit.coefficient(column)))
        };
        let mut levels: Vec<(usize, f64)> = (0..self.data.fitted.len()).filter_map(own).collect();
        if !levels.is_empty() {
            let usual = median(levels.iter().map(|(_, level)| *level).collect());
            levels.iter_mut().for_each(|(_, level)| *level -= usual);
        }
        levels
    }
}
