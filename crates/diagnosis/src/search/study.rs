//! The state of the search: the data, columns, candidates, and the background that was selected.

use std::collections::BTreeMap;

use arm::{Matrix3, Placeholder};
use effects::arm::contact_columns;
use effects::laws::SIGN;
use effects::{Acts, Grounds, Term};

use crate::data::Data;
use crate::data::measure::{self, spans};
use crate::data::statistics::mean;
use crate::options::Options;
use crate::regression::background::{Background, LoadPrior, Prior};
use crate::regression::bodies::LeastBody;
use crate::regression::fit::Products;
use crate::regression::stated::Stated;
use crate::regression::strengths::PriorStrengths;
use crate::regression::table::{Moving, Table};
use crate::search::candidate::{Candidate, Hypothesis, catalogue};
use crate::search::own_load::OwnLoad;
use crate::search::problem::{Problem, Selection};
use crate::thresholds::{
    LEAST_BODY_MASS, LEAST_BODY_RADIUS, LEAST_FOR_DYNAMICS, NEARLY_NO_MASS, OF_PLACEHOLDERS, Thresholds,
};
use crate::trace::Trace;

mod anew;
mod constants;
mod formed;
mod friction_changes;
mod linearisation_point;
mod links;
mod memory;
mod notes;
mod on_links;
mod own_friction;
mod payloads;
mod strengths;

use formed::Formed;
pub use linearisation_point::LinearisationPoint;
pub use strengths::moved;

/// What a candidate claims: a hypothesis on a joint, and whether it always acts.
pub type Claim = (Hypothesis, Option<usize>, bool);

/// The data, and the columns and candidates that may explain them.
pub struct Study {
    /// The recordings; [`Data::rigid`] is that of the arm about which the columns are evaluated.
    pub data: Data,
    /// All columns.
    pub table: Table,
    /// All candidates.
    pub candidates: Vec<Candidate>,
    /// The columns of a force on the tool that always acts.
    force: [usize; 3],
    /// The torque of the arm on each joint (N m or N) along which its springs and gaps that are not selected were simulated, if it is
    /// not that of `rigid`: `[joint][chunk][tick]`.
    simulated_along: Vec<Option<Vec<Vec<f64>>>>,
    /// Whether the columns are evaluated about an arm other than the nominal one.
    carries: bool,
    /// The rows that are fitted.
    moving: Moving,
    /// The prior of the background.
    prior: Prior,
    /// The strengths of the background, selected by evidence.
    pub strengths: PriorStrengths,
    /// The strengths that the evidence prefers, if the held-out recordings reduced them.
    pub preferred: Option<PriorStrengths>,
    /// The strengths that the user states.
    pub stated: Stated,
    /// The thresholds.
    pub thresholds: Thresholds,
    /// A load at the tip that only some of the recordings have.
    pub own_load: Option<OwnLoad>,
    /// The effects in the arm about which the columns are evaluated, with their coefficients.
    carried: Vec<(Term, f64)>,
    /// The tensor about its centre of mass of a payload whose moments are not fitted (kg m²).
    pub load_tensor: Matrix3<f64>,
    /// The record of decisions.
    pub trace: Trace,
    /// The inner products of the present table.
    formed: Formed,
    /// How many pieces of evidence are worth one, one per joint, because its residual remembers.
    memory: Vec<f64>,
    /// Hypotheses that the final fit refused, and whether they always act; they are not searched again.
    refused: Vec<Claim>,
    /// The evidence, by joint, for the name of a constant torque that always acts, if the differences between recordings decide whether
    /// it is an offset or asymmetric friction (nats).
    pub directions: BTreeMap<usize, f64>,
    /// What the search exchanged for something that explains hardly more, each with a hypothesis that took its place.
    exchanged: Vec<(Claim, Claim)>,
    /// Names that the final fit gave up, because wrong inertial parameters explain nearly as much.
    pub given_up: Vec<(Hypothesis, Option<usize>)>,
}

/// `terms` of a hypothesis, each with `change`: a begin or an end. The Coulomb level that a friction generalises is there before and
/// after the change, and is not counted a second time.
fn changing(hypothesis: Hypothesis, terms: &[Term], change: impl Fn(&Term) -> Term) -> Vec<Term> {
    let generalises_friction = hypothesis.generalises().is_some_and(|simpler| simpler.spec().is_friction);
    let stays = |term: &Term| generalises_friction && term.is(&SIGN);
    let changing = |term: &Term| if stays(term) { *term } else { change(term) };
    terms.iter().map(changing).collect()
}

impl Study {
    /// Whether a candidate acts at all times, and not from an onset on.
    pub fn always_acts(&self, candidate: usize) -> bool {
        self.terms(candidate).iter().all(Term::is_always)
    }

    /// Whether the known effects contain this one on a joint, or one that generalises it.
    pub fn has_known(&self, hypothesis: Hypothesis, joint: Option<usize>) -> bool {
        let joint = joint.map(|joint| &*self.data.arm.joints()[joint].name);
        self.data.known.iter().any(|known| {
            let kind = known.kind();
            Hypothesis { kind, ..hypothesis }.contains(hypothesis) && known.joint() == joint
        })
    }

    /// Whether a candidate acts in the recordings from before only, or in the others only.
    pub fn changes(&self, candidate: usize) -> bool {
        let at = Acts::of(&self.terms(candidate)).time();
        at.is_some() && at == self.data.motions.changed_at
    }

    /// The candidates that `options` allow, with their columns along `data`.
    pub fn new(data: Data, options: &Options) -> Self {
        Self::with(data, options, None, None)
    }

    /// This study, in whose background the recordings with another load at the tip have a load of their own. A load that was
    /// picked up once may be an effect instead.
    pub fn with_own_load(self, options: &Options) -> Self {
        let motions = &self.data.motions;
        let found = OwnLoad::found(&self.data, &self.table, &self.prior);
        // An effect sets in within the training recordings.
        let may_be_effect = |load: &OwnLoad| motions.one_clock && load.was_picked_up(motions);
        let own_load = found.filter(|load| load.is_of(&self.data.fitted, false) || !may_be_effect(load));
        self.beside_load(options, own_load)
    }

    /// This study, in whose background the recordings with another load at the tip have a load of their own, also if it was picked up: for
    /// a search of no such effect.
    pub fn with_any_own_load(self, options: &Options) -> Self {
        let found = OwnLoad::found(&self.data, &self.table, &self.prior);
        let recordings = self.data.motions.sources.len();
        self.beside_load(options, found.map(|load| load.of_more_mass(recordings)))
    }

    fn beside_load(mut self, options: &Options, own_load: Option<OwnLoad>) -> Self {
        let motions = &self.data.motions;
        if let (Some(load), None) = (&own_load, motions.changed_at) {
            let mut data = self.data;
            for &recording in &load.recordings {
                data.motions.sources[recording].own_load_until = load.until.unwrap_or(f64::INFINITY);
            }
            let prior = load.prior(&data.fitted);
            self = Self::with(data, options, Some(prior), Some(self.table));
        }
        Self { own_load, ..self }
    }

    /// The study with a load that some recordings have of their own; columns that `known` contains are taken from it.
    fn with(data: Data, options: &Options, own_load: Option<LoadPrior>, known: Option<Table>) -> Self {
        let (stated, thresholds) = (Stated::of(options), options.thresholds.clone());
        let Data { arm, motions, rigid, scales, fitted, .. } = &data;
        let times: Vec<(f64, f64)> = spans(motions)
            .into_iter()
            .zip(fitted)
            .filter_map(|(span, fitted)| fitted.then_some(span))
            .flatten()
            .collect();
        let first = times.first().map_or(0.0, |span| span.0);
        let span = times.last().map_or(1.0, |span| span.1 - first).max(1.0);
        let all = arm.placeholders(LEAST_BODY_RADIUS, NEARLY_NO_MASS);
        let placeholders = if stated.links == Some(0.0) { Vec::new() } else { all };
        let mut bodies = vec![LeastBody::default(); arm.dof()];
        let mut least = vec![0.0; arm.dof()];
        for Placeholder { link, mass, length } in placeholders {
            bodies[link] = LeastBody { mass: mass.max(LEAST_BODY_MASS), radius: length.max(LEAST_BODY_RADIUS) };
            least[link] = OF_PLACEHOLDERS;
        }
        let prior = Prior::new(
            &arm.inertial_parameters(),
            &bodies,
            &scales.torque,
            &scales.speed,
            &moved(motions, scales),
            own_load,
        );
        let mut terms: Vec<Term> = prior.terms().to_vec();
        let mut candidates = Vec::new();
        let mass = |joint: usize| mean(rigid.iter().flat_map(|r| r.link_mass(joint)));
        let mut list = catalogue(&Grounds {
            arm,
            scales,
            span: motions.one_clock.then_some(span),
            times: &times,
            has_change: motions.changed_at.is_some(),
            mass: &(0..motions.dof).map(mass).collect::<Vec<f64>>(),
            largest: &measure::largest(motions),
            needed: &measure::needed(motions, rigid),
            inertial: &measure::inertial(motions, rigid, &scales.torque),
        });
        if motions.cutoff < LEAST_FOR_DYNAMICS {
            list.retain(|(hypothesis, ..)| !hypothesis.spec().is_simulated);
        }
        list.retain(|(hypothesis, joint, _)| {
            options.may_be(hypothesis.name(), joint.map(|joint| &arm.joints()[joint].name))
        });
        if let Some(at) = motions.changed_at {
            // Every named effect may have begun after the recordings from before. One that has only one sign may also have ended:
            // the other effects in addition to those from before are of the opposite sign then.
            let named =
                list.iter().filter(|(hypothesis, ..)| hypothesis.name().is_some() && !hypothesis.spec().is_simulated);
            let begun = |(hypothesis, joint, terms): &(Hypothesis, _, Vec<Term>)| {
                (*hypothesis, *joint, changing(*hypothesis, terms, |term| term.since(at)))
            };
            let ended = |(hypothesis, joint, terms): &(Hypothesis, _, Vec<Term>)| {
                (*hypothesis, *joint, changing(*hypothesis, terms, |term| term.until(at)))
            };
            let new: Vec<_> = named
                .clone()
                .map(begun)
                .chain(named.filter(|(hypothesis, ..)| hypothesis.spec().may_end).map(ended))
                .collect();
            list.extend(new);
        }
        for (hypothesis, joint, columns) in list {
            let columns = columns
                .into_iter()
                .map(|term| {
                    terms.iter().position(|&known| known == term).unwrap_or_else(|| {
                        terms.push(term);
                        terms.len() - 1
                    })
                })
                .collect();
            candidates.push(Candidate::new(hypothesis, joint, columns, &thresholds));
        }
        let always = contact_columns(f64::NEG_INFINITY, f64::INFINITY, false);
        let force = [0, 1, 2].map(|k| terms.len() + k);
        terms.extend(always);
        let terms = (prior.terms().len(), terms);
        let table = match known {
            Some(known) => known.formed_anew(motions, rigid, scales, terms, &[], Moving::Steadily),
            None => Table::new(motions, rigid, scales, terms, &[], Moving::Steadily),
        };
        Self {
            table,
            candidates,
            force,
            simulated_along: vec![None; motions.dof],
            carries: false,
            moving: Moving::Steadily,
            strengths: PriorStrengths { least, ..stated.first(arm.dof()) },
            preferred: None,
            stated,
            thresholds,
            prior,
            own_load: None,
            carried: Vec::new(),
            load_tensor: Matrix3::zeros(),
            trace: Trace::default(),
            formed: Formed::default(),
            memory: vec![1.0; data.motions.dof],
            refused: Vec::new(),
            exchanged: Vec::new(),
            given_up: Vec::new(),
            directions: BTreeMap::new(),
            data,
        }
    }

    /// The columns of a force on the tool that always acts, along x, y, z of the base.
    pub fn force(&self) -> [usize; 3] {
        self.force
    }

    /// The background of every fit; `None` if nothing is in it.
    pub fn background(&self) -> Option<Background> {
        self.prior.at(&self.strengths)
    }

    /// Inner products of a table over the training recordings, or over the held-out ones, without background.
    fn bare_products(&self, table: &Table, held_out: bool) -> Products {
        let Data { seconds, floor, fitted, .. } = &self.data;
        let selected = |recording: usize| fitted[recording] != held_out;
        Products::new(table, selected, seconds, &self.data.motions.tempo, floor)
    }

    /// The problem with these products.
    pub fn problem<'a>(&'a self, products: &'a Products) -> Problem<'a> {
        Problem {
            data: &self.data,
            table: &self.table,
            products,
            candidates: &self.candidates,
            thresholds: &self.thresholds,
        }
    }

    /// Fits a set to the training recordings, starting with the weights of `near`.
    pub fn chosen(&self, set: Vec<usize>, near: &[f64]) -> Selection {
        self.problem(&self.training_products()).choose(set, near)
    }

    /// The terms of a candidate.
    pub fn terms(&self, candidate: usize) -> Vec<Term> {
        self.candidates[candidate].terms(&self.table)
    }

    /// Evaluates more terms.
    pub fn extend(&mut self, terms: Vec<Term>) {
        if !terms.is_empty() {
            self.table.add(&self.data.motions, &self.data.rigid, &self.data.scales, terms, None);
        }
    }

    /// A new candidate with new columns; its index.
    pub fn add(&mut self, hypothesis: Hypothesis, joint: Option<usize>, terms: Vec<Term>) -> usize {
        let columns: Vec<usize> =
            terms.iter().filter_map(|term| self.table.terms.iter().position(|known| known == term)).collect();
        let columns = if columns.len() == terms.len() {
            columns
        } else {
            let missing: Vec<Term> = terms.iter().copied().filter(|term| !self.table.terms.contains(term)).collect();
            self.table.add(&self.data.motions, &self.data.rigid, &self.data.scales, missing, None);
            terms.iter().filter_map(|term| self.table.terms.iter().position(|known| known == term)).collect()
        };
        let same = |candidate: &Candidate| {
            candidate.hypothesis == hypothesis && candidate.joint == joint && candidate.columns == columns
        };
        if let Some(known) = self.candidates.iter().position(same) {
            return known;
        }
        let mut candidate = Candidate::new(hypothesis, joint, columns, &self.thresholds);
        if terms.iter().any(|term| term.onset().is_some()) {
            candidate.cost += self.thresholds.per_onset;
        }
        self.candidates.push(candidate);
        self.candidates.len() - 1
    }
}
