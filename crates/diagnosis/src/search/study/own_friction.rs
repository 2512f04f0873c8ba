//! Friction that is not the same in all recordings.

use effects::Term;
use effects::background::OWN_FRICTION;

use super::Study;
use crate::data::statistics::{median, rms};
use crate::regression::fit::Fit;
use crate::regression::strengths::PriorStrengths;
use crate::search::problem::Selection;
use crate::thresholds::{FRICTION_BETWEEN, FRICTION_PRIOR, SAME_FRICTION};

impl Study {
    /// The strengths that differ from the present ones in one link, or in the friction of one joint in some recordings.
    pub(super) fn in_one_place(&self, selected: &Selection) -> Vec<PriorStrengths> {
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
        let mut all = self.strengths.in_one_place(&different);
        all.extend(self.with_friction_between(selected));
        all
    }

    /// The strengths with which the friction of some joints differs less between recordings than that of others. With one strength for all,
    /// friction that differs on one joint would let what each recording has of its own take the place of the friction that another joint
    /// always has.
    fn with_friction_between(&self, selected: &Selection) -> Vec<PriorStrengths> {
        let now = &self.strengths;
        let mut list: Vec<PriorStrengths> = Vec::new();
        if now.friction == 0.0 {
            return list;
        }
        let scales = &self.data.scales;
        // The root mean square of what each recording has of its own, over its prior with the strength of all.
        let own = |joint: usize| {
            let unit = now.friction * FRICTION_PRIOR * scales.torque[joint].max(f64::MIN_POSITIVE);
            let background = selected.fit.columns.iter().zip(&selected.fit.coefficients).take(selected.fit.background);
            let relative = background.filter_map(|(&column, value)| {
                let term = &self.table.terms[column];
                let size = if term.form == 0 { *value } else { *value * scales.speed[joint] };
                (term.is(&OWN_FRICTION) && term.joint == Some(joint)).then_some(size / unit)
            });
            rms(relative)
        };
        let own: Vec<Option<f64>> = (0..self.data.motions.dof).map(own).collect();
        let mut add = |between: Vec<f64>| {
            let next = PriorStrengths { between, ..now.clone() };
            if next != *now && !list.contains(&next) {
                list.push(next);
            }
        };
        for factors in FRICTION_BETWEEN {
            // The least factor that allows for what there is; a joint without columns of its own has none.
            let of = |(joint, own): (usize, &Option<f64>)| match own {
                Some(own) => factors.iter().copied().find(|factor| *own <= factor.max(SAME_FRICTION)).unwrap_or(1.0),
                None => now.between[joint],
            };
            add(own.iter().enumerate().map(of).collect());
        }
        add(vec![1.0; own.len()]);
        list
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
