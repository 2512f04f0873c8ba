//! The study evaluated again: about the arm of a fit, for the final fit, or for another search.

use effects::arm::INERTIAL_PARAMETER;
use effects::background::OWN_LOAD;
use effects::laws::RIGID;
use effects::{OnLinks, Term};
use rayon::prelude::*;

use super::formed::Formed;
use super::linearisation_point::inertial_changes;
use super::on_links::through_gear;
use super::{Claim, LinearisationPoint, Study};
use crate::data::Data;
use crate::data::motion::Chunk;
use crate::data::rigid::Rigid;
use crate::data::statistics::rms;
use crate::regression::background::Prior;
use crate::regression::bodies::PER_LINK;
use crate::regression::columns::values;
use crate::regression::fit::{Fit, Products};
use crate::regression::strengths::PriorStrengths;
use crate::regression::table::{Moving, Table};
use crate::search::candidate::Candidate;
use crate::search::problem::Selection;
use crate::thresholds::{LAST_BODY_STEP, MOST_BODIES, MOST_BODY_STEPS, SETTLED};

impl Study {
    /// Evaluates everything about the arm of `fit`, so that the remaining tilts, encoder offsets and payloads are small.
    /// Unsuccessful trial sizes are removed. Returns the new indices of the candidates `kept`, or `None` if nothing
    /// changes.
    pub fn relinearise(&mut self, fit: &Fit, kept: &[usize]) -> Option<Vec<usize>> {
        self.about(fit, kept, false)
    }

    /// Evaluates everything with the rows near reversals, for the final fit; returns the new indices of the candidates `kept`.
    pub fn linearise_for_final_fit(&mut self, fit: &Fit, kept: &[usize]) -> Vec<usize> {
        self.moving = Moving::ThroughReversals;
        self.about(fit, kept, true).unwrap_or_default()
    }

    /// A table with the background's columns, then `columns`, then those of `more`, with the rows that are `moving`; and its products
    /// over the training recordings beside a background of these `strengths`.
    pub fn reduced(
        &self,
        columns: &[usize],
        more: Vec<Term>,
        moving: Moving,
        strengths: &PriorStrengths,
    ) -> (Table, Products) {
        let Data { motions, rigid, scales, .. } = &self.data;
        let background = 0..self.prior.terms().len();
        let columns: Vec<usize> = background.chain(columns.iter().copied()).collect();
        let mut empty = Table::new(motions, rigid, scales, (0, Vec::new()), &[], moving);
        // The torques of this table contain those of the effects in the arm about which it is evaluated.
        for (joint, known) in empty.joints.iter_mut().zip(&self.table.joints) {
            joint.y.clone_from(&known.y);
        }
        let mut table = empty.with_columns_of(&self.table, &columns);
        if !more.is_empty() {
            table.add(motions, rigid, scales, more, None);
        }
        let products = self.bare_products(&table, false).with_background(self.prior.at(strengths));
        (table, products)
    }

    /// A table of `terms` alone, along the same motions and arm.
    pub fn table_of(&self, terms: Vec<Term>) -> Table {
        let Data { motions, rigid, scales, .. } = &self.data;
        Table::new(motions, rigid, scales, (0, terms), &[], self.moving)
    }

    /// `columns` and, after them, `more` terms fitted to the training recordings at given weights of the joints. The fit's columns are
    /// those of the background, and then the others in this order.
    pub fn fit_with(&self, columns: &[usize], more: Vec<Term>, weights: &[f64]) -> Fit {
        self.table_and_fit_with(columns, more, weights).1
    }

    /// The same fit after the table of its columns.
    pub fn table_and_fit_with(&self, columns: &[usize], more: Vec<Term>, weights: &[f64]) -> (Table, Fit) {
        self.table_and_fit_at(&self.strengths, columns, more, weights)
    }

    /// The same ones with other strengths of the background.
    pub fn table_and_fit_at(
        &self,
        strengths: &PriorStrengths,
        columns: &[usize],
        more: Vec<Term>,
        weights: &[f64],
    ) -> (Table, Fit) {
        let (table, products) = self.reduced(columns, more, self.moving, strengths);
        let columns: Vec<usize> = (self.prior.terms().len()..table.terms.len()).collect();
        let fit = products.solve(&table, &columns, weights);
        (table, fit)
    }

    /// Makes the prior of the links' inertial parameters quadratic about the bodies of `fit`.
    pub fn set_bodies(&mut self, fit: &Fit) {
        let changes = inertial_changes(&self.data, &self.table, fit);
        self.prior.set_bodies(&changes);
    }

    /// Makes the prior quadratic about the bodies of `fit`, but about the URDF's body of the last link; returns the prior before.
    pub fn set_bodies_but_the_last(&mut self, fit: &Fit) -> Prior {
        let before = self.prior.clone();
        let mut changes = inertial_changes(&self.data, &self.table, fit);
        let last = changes.len().saturating_sub(PER_LINK);
        changes[last..].fill(0.0);
        self.prior.set_bodies(&changes);
        before
    }

    /// Makes `prior` the prior again.
    pub fn set_prior(&mut self, prior: Prior) {
        self.prior = prior;
    }

    /// `selected` with the prior about its own bodies, and with the strengths of the background that the evidence then prefers.
    pub fn about_own_bodies(&mut self, mut selected: Selection) -> Selection {
        for _ in 0..MOST_BODIES {
            self.set_bodies(&selected.fit);
            let next = self.chosen(selected.set, &selected.fit.weights);
            selected = self.with_best_strengths(next);
        }
        self.with_possible_bodies(selected)
    }

    /// `selected` with the prior expanded about the bodies of its own fit, which are physically possible then: the most probable ones.
    fn with_possible_bodies(&mut self, mut selected: Selection) -> Selection {
        let strongest = self.strengths.strongest();
        if strongest == 0.0 {
            return selected;
        }
        let mut bodies = self.prior.possible(&inertial_changes(&self.data, &self.table, &selected.fit));
        for _ in 0..MOST_BODY_STEPS {
            self.prior.set_bodies(&bodies);
            selected = self.chosen(selected.set, &selected.fit.weights);
            let fitted = inertial_changes(&self.data, &self.table, &selected.fit);
            let (next, length) = self.prior.towards(&bodies, &fitted);
            if length < LAST_BODY_STEP * strongest {
                break;
            }
            bodies = next;
        }
        selected
    }

    pub(super) fn about(&mut self, fit: &Fit, kept: &[usize], anyway: bool) -> Option<Vec<usize>> {
        self.set_bodies(fit);
        let stages = LinearisationPoint::stages(&self.data, &self.table, fit, &self.load_tensor);
        let last = &stages[stages.len() - 1].1;
        // The arm contains no effect, neither of this fit nor of an earlier selection.
        let carries = !last.carried.is_empty() || last.bare.is_some();
        let on_links = self.on_links(fit, kept);
        if !carries && !self.carries && !anyway && self.are_near(&on_links) {
            return None;
        }
        self.carries = carries;
        self.carried.clone_from(&last.carried);
        let nominal = self.data.arm.inertial_parameters();
        let rigid: Vec<Rigid> = self
            .data
            .motions
            .chunks
            .par_iter()
            .map(|chunk| LinearisationPoint::along(&stages, &nominal, chunk))
            .collect();
        let before = self.with_rest_of(fit, rigid, on_links);
        let same_regressor = self.data.rigid.iter().zip(&before).all(|(now, before)| now.has_regressor_of(before));
        for joint in 0..self.data.motions.dof {
            let before = || before.iter().map(|rigid| through_gear(rigid, joint)).collect();
            let along = self.simulated_along[joint].take().unwrap_or_else(before);
            self.simulated_along[joint] = self.is_near(joint, &along).then_some(along);
        }
        let (set, terms) = self.forget_trials(kept);
        let columns = set.iter().flat_map(|&c| self.candidates[c].columns.iter());
        let selected: Vec<Term> = columns.map(|&column| terms[column]).collect();
        let is_near = |term: &Term| !term.law.is_of_base && self.simulated_along[term.of[0]].is_some();
        let keeps = |term: &Term| term.law.link_side.is_some() && is_near(term) && !selected.contains(term);
        let is_of_links = |term: &Term| term.is(&INERTIAL_PARAMETER) || term.is(&OWN_LOAD);
        let mut old = std::mem::take(&mut self.table);
        // Stored products refer to its columns, most of which are not needed any more.
        self.formed = Formed::default();
        old.retain(|term| !term.is_dynamic() || keeps(term) || same_regressor && is_of_links(term));
        let (Data { motions, rigid, scales, .. }, background) = (&self.data, self.prior.terms().len());
        self.table = old.formed_anew(motions, rigid, scales, (background, terms), &last.carried, self.moving);
        Some(set)
    }

    /// Replaces the rigid model by `rigid`, to which the torques of the drives in `fit` and those `on_links` are added; returns the one
    /// before.
    fn with_rest_of(&mut self, fit: &Fit, mut rigid: Vec<Rigid>, on_links: Vec<OnLinks>) -> Vec<Rigid> {
        let rest = self.rest_of(fit, &rigid);
        for ((rigid, rest), on_links) in rigid.iter_mut().zip(rest).zip(on_links) {
            (rigid.rest, rigid.on_links) = (rest, on_links);
        }
        std::mem::replace(&mut self.data.rigid, rigid)
    }

    /// The torques of the drives in `fit`, with the rigid model `rigid` (N m or N): `[chunk][joint][tick]`.
    fn rest_of(&self, fit: &Fit, rigid: &[Rigid]) -> Vec<Vec<Vec<f64>>> {
        let data = &self.data;
        let of_drives: Vec<(Term, f64)> = fit
            .columns
            .iter()
            .zip(&fit.coefficients)
            .map(|(&column, &value)| (self.table.terms[column], value))
            .filter(|(term, _)| term.law.carry.is_none() && term.law.link_side.is_none() && term.is_always())
            .collect();
        let rest = |chunk: &Chunk, rigid: &Rigid, joint: usize| {
            let mut sum = vec![0.0; chunk.ticks()];
            for &(term, value) in of_drives.iter().filter(|(term, _)| term.joint() == Some(joint)) {
                let column = values(term, joint, chunk, rigid, &data.scales).unwrap_or_default();
                sum.iter_mut().zip(column).for_each(|(sum, x)| *sum += value * x);
            }
            sum
        };
        rigid
            .par_iter()
            .zip(&data.motions.chunks)
            .map(|(rigid, chunk)| (0..data.motions.dof).map(|joint| rest(chunk, rigid, joint)).collect())
            .collect()
    }

    /// Whether the arm about which the columns are evaluated has settled: it contains the effects of `fit`, and the torques of the drives are
    /// those of `fit`, as far as a torque constant that changes multiplies them, as are the loads of gaps and springs by the candidates `kept`.
    pub fn has_settled(&self, fit: &Fit, kept: &[usize]) -> bool {
        let is_behind = |&column: &usize| self.table.terms[column].law.link_side.is_some();
        let have_loads_settled = !fit.columns.iter().any(is_behind) || self.are_near(&self.on_links(fit, kept));
        have_loads_settled && self.have_drives_settled(fit) && self.has_arm_settled(fit)
    }

    fn has_arm_settled(&self, fit: &Fit) -> bool {
        let mut columns = fit.selected().to_vec();
        columns.retain(|&column| self.table.terms[column].law.carry.is_some());
        let before = |column: usize| {
            let known = self.carried.iter().find(|(term, _)| *term == self.table.terms[column]);
            known.map_or(0.0, |(_, value)| *value)
        };
        let change: Vec<f64> = columns.iter().map(|&column| fit.coefficient(column) - before(column)).collect();
        (0..self.data.motions.dof).all(|joint| {
            let torque = self.table.torque(joint, &columns, &change);
            rms(torque).unwrap_or(0.0) <= SETTLED * self.data.scales.torque[joint]
        })
    }

    fn have_drives_settled(&self, fit: &Fit) -> bool {
        let changes = |&column: &usize| {
            let term = self.table.terms[column];
            (term.always().is(&RIGID) && term.onset().is_some()).then(|| term.joint()).flatten()
        };
        let joints: Vec<usize> = fit.columns.iter().filter_map(changes).collect();
        if joints.is_empty() {
            return true;
        }
        let now = self.rest_of(fit, &self.data.rigid);
        joints.into_iter().all(|joint| {
            let pairs = now.iter().zip(&self.data.rigid);
            let differences = pairs.flat_map(|(now, before)| now[joint].iter().zip(&before.rest[joint]));
            let change = rms(differences.map(|(now, before)| now - before)).unwrap_or(0.0);
            change <= SETTLED * self.data.scales.torque[joint]
        })
    }

    /// Removes the trial candidates that are not in `set`; returns the set's new indices, and the remaining terms. The table
    /// must be evaluated again.
    fn forget_trials(&mut self, set: &[usize]) -> (Vec<usize>, Vec<Term>) {
        let old = &self.table.terms;
        let mut terms: Vec<Term> = Vec::new();
        let mut place: Vec<Option<usize>> = vec![None; old.len()];
        let mut keep = |column: usize| -> usize {
            *place[column].get_or_insert_with(|| {
                terms.push(old[column]);
                terms.len() - 1
            })
        };
        // The background's columns stay first.
        (0..self.prior.terms().len()).for_each(|column| {
            keep(column);
        });
        self.force = self.force.map(&mut keep);
        let mut numbers = vec![0; self.candidates.len()];
        let mut kept = Vec::new();
        for (number, mut candidate) in std::mem::take(&mut self.candidates).into_iter().enumerate() {
            if candidate.is_trial && !set.contains(&number) {
                continue;
            }
            candidate.columns.iter_mut().for_each(|column| *column = keep(*column));
            numbers[number] = kept.len();
            kept.push(candidate);
        }
        self.candidates = kept;
        (set.iter().map(|&number| numbers[number]).collect(), terms)
    }

    /// Refuses the hypothesis of `candidate` on its joint, as it acts: always, or from an onset on. A torque constant within the usual
    /// tolerance, for example, says nothing against one that changes at some time.
    pub fn refuse(&mut self, candidate: usize) {
        self.refused.push(self.claim(candidate));
    }

    /// What `candidate` claims.
    pub fn claim(&self, candidate: usize) -> Claim {
        let Candidate { hypothesis, joint, .. } = self.candidates[candidate];
        (hypothesis, joint, self.always_acts(candidate))
    }

    /// Gives up the name of `candidate`, because wrong inertial parameters explain nearly as much.
    pub fn give_up(&mut self, candidate: usize) {
        let candidate = &self.candidates[candidate];
        let name = (candidate.hypothesis, candidate.joint);
        if !self.given_up.contains(&name) {
            self.given_up.push(name);
        }
    }

    /// Records what an exchange of the search removed from `before`, and what it took in its place, if this explains hardly more.
    pub fn record_exchange(&mut self, before: &Selection, after: &Selection) {
        if before.score - after.score >= self.thresholds.least_evidence {
            return;
        }
        let missing = |of: &Selection, from: &Selection| -> Vec<Claim> {
            of.set.iter().filter(|c| !from.set.contains(c)).map(|&c| self.claim(c)).collect()
        };
        let (removed, taken) = (missing(before, after), missing(after, before));
        let pairs = removed.iter().flat_map(|&removed| taken.iter().map(move |&taken| (removed, taken)));
        self.exchanged.extend(pairs);
    }

    /// The candidates that the search exchanged for `claim`, which explained hardly more, and that may be taken. Each exchange is
    /// returned once, because what is taken again may be dropped again.
    pub fn take_exchanged_for(&mut self, claim: Claim) -> Vec<usize> {
        let (exchanged, others) = self.exchanged.iter().partition(|(_, taken)| *taken == claim);
        self.exchanged = others;
        let exchanged: Vec<(Claim, Claim)> = exchanged;
        let is_exchanged = |c: &usize| exchanged.iter().any(|(removed, _)| *removed == self.claim(*c));
        self.allowed().into_iter().filter(is_exchanged).collect()
    }

    /// The number of refused hypotheses.
    pub fn refused(&self) -> usize {
        self.refused.len()
    }

    /// The candidates that may be taken.
    pub fn allowed(&self) -> Vec<usize> {
        (0..self.candidates.len()).filter(|&c| !self.refused.contains(&self.claim(c))).collect()
    }

    /// Evaluates everything about the nominal arm again, for another search.
    pub fn restart(&mut self) {
        self.moving = Moving::Steadily;
        self.forget();
        self.exchanged.clear();
        self.strengths =
            PriorStrengths { least: self.strengths.least.clone(), ..self.stated.first(self.data.arm.dof()) };
        let nothing = {
            let products = self.training_products();
            self.problem(&products).choose(Vec::new(), &products.first_weights())
        };
        self.about(&nothing.fit, &[], true);
    }
}
