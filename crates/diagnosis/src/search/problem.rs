//! The joint search: which candidates together explain the residual.

use effects::background::OWN_FRICTION;
use effects::laws::{SIGN, VELOCITY};
use effects::{Acts, Law, Term};
use rayon::prelude::*;

use crate::data::Data;
use crate::regression::fit::{Fit, Products};
use crate::regression::table::Table;
use crate::search::candidate::Candidate;
use crate::search::physics::is_possible;
use crate::thresholds::{FRICTION_PRIOR, KNOWN_DRIVE, MOST_SELECTED, TELLING_DRIVES, Thresholds, UNUSUAL_SIZE};

mod exchange;
mod exclusion;
mod growth;
mod promise;

pub use growth::Growth;

/// Selected candidates with their fit.
#[derive(Clone, Debug)]
pub struct Selection {
    /// Indices into the candidates.
    pub set: Vec<usize>,
    /// The fit of all of them.
    pub fit: Fit,
    /// Loss and costs (nats).
    pub score: f64,
}

impl Selection {
    /// Its set without one member.
    pub fn others(&self, member: usize) -> Vec<usize> {
        self.set.iter().copied().filter(|&c| c != member).collect()
    }
}

/// The rule that removes what is physically impossible.
pub const IMPOSSIBLE: &str = "its parameters are not physical";

/// The rule that removes what does not pay.
pub const DOES_NOT_PAY: &str = "costs more evidence than it brings";

/// The data of the search.
#[derive(Clone, Copy)]
pub struct Problem<'a> {
    /// The recordings.
    pub data: &'a Data,
    /// All columns.
    pub table: &'a Table,
    /// The inner products over the training recordings.
    pub products: &'a Products,
    /// All candidates.
    pub candidates: &'a [Candidate],
    /// The thresholds.
    pub thresholds: &'a Thresholds,
}

impl Problem<'_> {
    /// The columns of a set, without repetition.
    pub fn columns(&self, set: &[usize]) -> Vec<usize> {
        let mut columns: Vec<usize> = set.iter().flat_map(|&c| self.candidates[c].columns.iter().copied()).collect();
        columns.sort_unstable();
        columns.dedup();
        columns
    }

    /// The cost of a set; shared columns are paid once.
    fn cost(&self, set: &[usize]) -> f64 {
        let own: f64 = set.iter().map(|&c| self.candidates[c].cost).sum();
        let counted: usize = set.iter().map(|&c| self.candidates[c].columns.len()).sum();
        let drives = set.iter().filter(|&&c| self.candidates[c].hypothesis.is_drive_inertia()).count();
        own - self.thresholds.per_coefficient * (counted - self.columns(set).len()) as f64
            - KNOWN_DRIVE * drives.saturating_sub(TELLING_DRIVES) as f64
    }

    /// Fits a set, starting with the weights of `near`.
    pub fn choose(&self, set: Vec<usize>, near: &[f64]) -> Selection {
        let fit = self.products.fit(self.table, &self.columns(&set), near);
        let score = fit.loss + self.cost(&set) + self.misfit(&set, &fit);
        Selection { set, fit, score }
    }

    /// `selected` with the joints weighted by their residuals.
    pub fn reweighted(&self, selected: Selection) -> Selection {
        let fit = self.products.reweighted(self.table, selected.fit);
        let score = fit.loss + self.cost(&selected.set) + self.misfit(&selected.set, &fit);
        Selection { fit, score, ..selected }
    }

    /// The cost of coefficients that are unusual (nats).
    fn misfit(&self, set: &[usize], fit: &Fit) -> f64 {
        set.iter()
            .map(|&c| &self.candidates[c])
            .map(|candidate| self.misfit_of(candidate, fit.coefficient(candidate.columns[0])))
            .sum()
    }

    /// The cost of a candidate with this coefficient of its first column (nats): of a simulated effect, it should be one.
    fn misfit_of(&self, candidate: &Candidate, coefficient: f64) -> f64 {
        let spec = candidate.hypothesis.spec();
        if spec.is_simulated {
            0.5 * (coefficient.max(1e-3).ln() / self.thresholds.unit_spread).powi(2)
        } else if spec.usual.is_some_and(|[least, most]| !(least..=most).contains(&coefficient)) {
            UNUSUAL_SIZE
        } else {
            0.0
        }
    }

    /// Whether `candidate` is possible in `fit`.
    pub fn is_possible(&self, candidate: usize, fit: &Fit) -> bool {
        is_possible(&self.candidates[candidate], self.table, fit, &self.data.arm)
    }

    /// `set` and, last, `candidate`. Unmodelled structure comes with baseline friction: every drive has it, and a curve over
    /// position or time must not replace it.
    fn with(&self, set: &[usize], candidate: usize) -> Vec<usize> {
        let mut set = set.to_vec();
        if self.is_unmodelled(candidate) {
            let is_friction = |c: &usize| {
                let other = &self.candidates[*c];
                other.joint == self.candidates[candidate].joint && other.hypothesis.spec().is_friction
            };
            for friction in (0..self.candidates.len()).filter(is_friction) {
                if !set.iter().any(|&other| other == friction || self.exclude(friction, other)) {
                    set.push(friction);
                }
            }
        }
        set.push(candidate);
        set
    }

    fn is_unmodelled(&self, candidate: usize) -> bool {
        self.candidates[candidate].hypothesis.name().is_none()
    }

    /// Whether a member of `set` may be removed for its cost. Baseline friction may not be removed beside unmodelled forms of its joint.
    fn may_go(&self, set: &[usize], member: usize) -> bool {
        let this = &self.candidates[member];
        !this.hypothesis.spec().is_friction
            || !set.iter().any(|&c| self.is_unmodelled(c) && self.candidates[c].joint == this.joint)
    }

    /// The residual sums of squares of `fit` on the recordings of `held`, which decide on `candidate`. For a form of friction, dry and
    /// viscous friction of these recordings may differ from the fit's, as much as the background lets those of a training recording
    /// differ.
    pub fn held_out_rss(&self, held: &Products, candidate: usize, fit: &Fit) -> Vec<f64> {
        let rss = held.rss(self.table, &fit.columns, &fit.coefficients);
        let scale = |joint: usize| FRICTION_PRIOR * self.products.own_friction(joint);
        if (0..rss.len()).all(|joint| scale(joint) == 0.0)
            || !self.candidates[candidate].hypothesis.spec().is_form_of_friction()
        {
            return rss;
        }
        let scales = &self.data.scales;
        let column = |law: &'static Law, joint: usize| {
            let term = Term::on(law, joint);
            self.table.terms.iter().position(|known| *known == term)
        };
        let own_friction = |joint: usize| {
            let is_own = |term: &Term| term.is(&OWN_FRICTION) && term.joint == Some(joint);
            self.table.terms.iter().any(is_own).then_some(())?;
            let level = Some(scale(joint) * scales.torque[joint]).filter(|level| *level > 0.0)?;
            let slope = level / scales.speed[joint].max(1e-300);
            Some([(column(&SIGN, joint)?, level), (column(&VELOCITY, joint)?, slope)])
        };
        let own_friction: Vec<_> = (0..rss.len()).map(own_friction).collect();
        held.rss_beside(self.table, (fit, &rss), &own_friction)
    }

    /// Whether an effect may be a part of the background. It then need not predict better than the background, but it costs
    /// less evidence.
    pub fn is_background_too(&self, candidate: &Candidate) -> bool {
        self.products.has_background() && candidate.hypothesis.spec().is_certain_in_form
    }

    /// Removes members that do not pay, or that are impossible, one by one.
    pub fn prune(&self, selected: Selection) -> Selection {
        self.prune_noting(selected, |_, _, _| {})
    }

    /// As [`Self::prune`], and tells `note` each removal: its rule, and the selections before and after it.
    pub fn prune_noting(
        &self,
        mut selected: Selection,
        note: impl Fn(&'static str, &Selection, &Selection),
    ) -> Selection {
        loop {
            let best = (0..selected.set.len())
                .into_par_iter()
                .filter_map(|k| {
                    let mut set = selected.set.clone();
                    let removed = set.remove(k);
                    let must = !self.is_possible(removed, &selected.fit);
                    let may = must || self.may_go(&set, removed);
                    may.then(|| (must, self.without(&selected, removed)))
                })
                .collect::<Vec<_>>()
                .into_iter()
                .min_by(|a, b| b.0.cmp(&a.0).then(a.1.score.total_cmp(&b.1.score)));
            match best {
                Some((must, next)) if must || next.score <= selected.score => {
                    note(if must { IMPOSSIBLE } else { DOES_NOT_PAY }, &selected, &next);
                    selected = self.reweighted(next);
                }
                _ => return selected,
            }
        }
    }

    /// Adds candidates of `allowed` that pay, then removes those that no longer do.
    pub fn forward(&self, mut selected: Selection, allowed: &[usize]) -> Selection {
        let mut growth = Growth::default();
        while selected.set.len() < MOST_SELECTED {
            match self.grow(&selected, allowed, &mut growth) {
                Some(next) => selected = self.reweighted(next),
                None => break,
            }
        }
        self.prune(selected)
    }

    /// `selected` without one of its members. A form of a simpler effect is replaced by that, if it pays.
    pub fn without(&self, selected: &Selection, member: usize) -> Selection {
        let set = selected.others(member);
        let bare = self.choose(set.clone(), &selected.fit.weights);
        let candidate = &self.candidates[member];
        let acts = |c: &Candidate| self.acts(c);
        let is_contained = |plain: &Candidate| plain.columns.iter().all(|column| candidate.columns.contains(column));
        let is_plain = |&c: &usize| {
            let plain = &self.candidates[c];
            Some(plain.hypothesis) == candidate.hypothesis.generalises()
                && plain.joint == candidate.joint
                && (is_contained(plain) || acts(plain).is_like(acts(candidate)))
        };
        // Among candidates with an onset, only those with nearly the same onset.
        let apart = |&c: &usize| match (acts(&self.candidates[c]), acts(candidate)) {
            (Acts::Since(a), Acts::Since(b)) => (a - b).abs(),
            _ => 0.0,
        };
        let plain = (0..self.candidates.len()).filter(is_plain);
        let Some(plain) = plain.min_by(|a, b| {
            let is_other = |c: &usize| !is_contained(&self.candidates[*c]);
            is_other(a).cmp(&is_other(b)).then(apart(a).total_cmp(&apart(b)))
        }) else {
            return bare;
        };
        if set.contains(&plain) {
            return bare;
        }
        let mut with = set;
        with.push(plain);
        let simpler = self.choose(with, &selected.fit.weights);
        if simpler.score < bare.score && self.is_possible(plain, &simpler.fit) { simpler } else { bare }
    }
}
