//! All columns on all rows, and their inner products, from which every fit is computed.

use std::ops::Range;
use std::sync::Arc;

use effects::arm::INERTIAL_PARAMETER;
use effects::background::OWN_LOAD;
use effects::{LinkSide, Scales, Term};
use rayon::prelude::*;

use crate::data::motion::{Chunk, Motions};
use crate::data::rigid::Rigid;
use crate::data::statistics::deviation;
use crate::regression::bodies;
use crate::regression::columns::{link_side, link_side_torque, values};
use crate::thresholds::{CORE, REVERSAL, YIELDING};

mod gram;
mod stretch;

pub use gram::{Gram, SharedColumn};
pub use stretch::Stretch;

/// The number of terms that are evaluated at a time; simulations for them are stored until then.
const BATCH: usize = 12;

/// The rows of a joint that are fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Moving {
    /// Rows away from rest, where the sign of the velocity is certain.
    Steadily,
    /// The steady rows and rows near quick reversals, which contain most information about dry friction.
    ThroughReversals,
}

/// One joint's target and columns on the rows, through the second filter.
#[derive(Clone, Debug, Default)]
pub struct JointTable {
    /// Measured minus rigid torque (N m or N).
    pub y: Vec<f64>,
    /// The columns that act on this joint.
    pub x: Vec<SharedColumn>,
    /// Whether the joint moves: rows at rest are not fitted.
    pub moving: Vec<bool>,
    /// The recordings that move the joint; if there is only one, its stretches.
    pub stretches: Vec<Stretch>,
    /// The moving rows of each recording.
    pub count: Vec<usize>,
}

/// The columns of all joints.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// All terms.
    pub terms: Vec<Term>,
    /// The number of terms of the background, which are the first ones.
    background: usize,
    /// The index of a term among a joint's columns: `[joint][term]`.
    pub place: Vec<Vec<Option<usize>>>,
    /// The tables of the joints, one each.
    pub joints: Vec<JointTable>,
    /// The rows of each recording.
    pub rows: Vec<Range<usize>>,
    /// Whether each recording is from before a change.
    pub before: Vec<bool>,
    /// The first recording of the group of each, whose inner products are summed.
    pub groups: Vec<usize>,
    /// Another one whenever inner products change.
    identity: Arc<()>,
    /// The same one as long as columns are only added.
    origin: Arc<()>,
}

impl Table {
    /// Evaluates `terms` along `motions` for the arm of `rigid` (one per chunk). The part that this arm already contains of the
    /// terms in `carried`, with their coefficients, is added to y again: a Gauss-Newton step about it. `moving` selects the
    /// rows that are fitted. The first `background` terms are those of the background.
    pub fn new(
        motions: &Motions,
        rigid: &[Rigid],
        scales: &Scales,
        (background, terms): (usize, Vec<Term>),
        carried: &[(Term, f64)],
        moving: Moving,
    ) -> Self {
        let mut rows = vec![0..0; motions.sources.len()];
        let mut from = 0;
        for chunk in &motions.chunks {
            let to = from + chunk.rows();
            let range = &mut rows[chunk.recording];
            *range = if range.start == range.end { from..to } else { range.start..to };
            from = to;
        }
        let held_out: Vec<bool> = motions.sources.iter().map(|source| source.held_out).collect();
        let before: Vec<bool> = (0..rows.len()).map(|recording| motions.is_before(recording)).collect();
        let joints: Vec<JointTable> = (0..motions.dof)
            .into_par_iter()
            .map(|joint| {
                let mut y = Vec::new();
                let mut moves = Vec::new();
                for (chunk, rigid) in motions.chunks.iter().zip(rigid) {
                    let mut difference: Vec<f64> =
                        chunk.tau[joint].iter().zip(&rigid.tau[joint]).map(|(a, b)| a - b).collect();
                    if let Some(background) = rigid.background.get(joint) {
                        difference.iter_mut().zip(background).for_each(|(sum, x)| *sum += x);
                    }
                    for &(term, coefficient) in carried {
                        let column = values(term, joint, chunk, rigid, scales).unwrap_or_default();
                        for (sum, x) in difference.iter_mut().zip(column) {
                            *sum += coefficient * x;
                        }
                    }
                    y.extend(chunk.filter(&difference));
                    let core = (CORE * chunk.kernel.width() / chunk.period).ceil() as usize;
                    let rest = scales.rest[joint];
                    // A joint that is only deflected a little does not count as moving.
                    let (low, high) = chunk.q[joint]
                        .iter()
                        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &q| (low.min(q), high.max(q)));
                    let yields = high - low < YIELDING * scales.range[joint];
                    let is_dead = scales.torque[joint] == 0.0;
                    moves.extend((0..chunk.rows()).map(|row| {
                        let tick = chunk.tick_of(row);
                        let qd = &chunk.qd[joint];
                        if yields || is_dead {
                            return false;
                        }
                        let window = &qd[tick.saturating_sub(core)..(tick + core + 1).min(qd.len())];
                        match moving {
                            Moving::Steadily => window.iter().all(|qd| qd.abs() > rest),
                            Moving::ThroughReversals => {
                                qd[tick].abs() > rest && window.iter().any(|qd| qd.abs() > REVERSAL * rest)
                            }
                        }
                    }));
                }
                let count = rows.iter().map(|range| moves[range.clone()].iter().filter(|&&m| m).count()).collect();
                let stretches = Stretch::of(&rows, &motions.groups, &held_out, &before, &moves);
                JointTable { y, x: Vec::new(), moving: moves, stretches, count }
            })
            .collect();
        let mut table = Self {
            background,
            place: vec![Vec::new(); motions.dof],
            joints,
            rows,
            before,
            groups: motions.groups.clone(),
            ..Self::default()
        };
        table.add(motions, rigid, scales, terms, None);
        table
    }

    /// `terms` alone, without rows, for products from elsewhere: term k has the index k on every joint that it acts on.
    pub fn bare(terms: Vec<Term>, dof: usize) -> Self {
        let place = |joint: usize| -> Vec<Option<usize>> {
            let acts = |term: &Term| term.joint().is_none_or(|only| only == joint);
            let terms = terms.iter().enumerate();
            terms.map(|(k, term)| acts(term).then_some(k)).collect()
        };
        Self {
            place: (0..dof).map(place).collect(),
            joints: vec![JointTable::default(); dof],
            terms,
            ..Self::default()
        }
    }

    /// `terms` for another arm along these motions; those that `self` contains are taken from it, with their inner products if the same
    /// rows are fitted.
    pub fn formed_anew(
        self,
        motions: &Motions,
        rigid: &[Rigid],
        scales: &Scales,
        (background, terms): (usize, Vec<Term>),
        carried: &[(Term, f64)],
        moving: Moving,
    ) -> Self {
        let mut table = Self::new(motions, rigid, scales, (background, Vec::new()), carried, moving);
        table.add(motions, rigid, scales, terms, Some(self));
        table
    }

    /// Removes the terms that are not `kept`; the rows of the others are unchanged.
    pub fn retain(&mut self, kept: impl Fn(&Term) -> bool) {
        let list: Vec<usize> = (0..self.terms.len()).filter(|&k| kept(&self.terms[k])).collect();
        self.background = list.iter().take_while(|k| **k < self.background).count();
        self.terms = list.iter().map(|&k| self.terms[k]).collect();
        for place in &mut self.place {
            *place = list.iter().map(|&k| place[k]).collect();
        }
    }

    /// This table, which has no columns yet, with the `columns` of another one along the same motions and arm, those of the background first.
    pub fn with_columns_of(mut self, other: &Self, columns: &[usize]) -> Self {
        self.background = columns.iter().take_while(|column| **column < other.background).count();
        for (joint, (table, place)) in self.joints.iter_mut().zip(&mut self.place).enumerate() {
            let known = &other.joints[joint];
            let mut places = Vec::with_capacity(columns.len());
            for &column in columns {
                let taken = other.place[joint][column];
                place.push(taken.map(|_| places.len()));
                places.extend(taken);
            }
            let is_of_background = of_background(place, places.len(), self.background);
            for (stretch, known) in table.stretches.iter_mut().zip(&known.stretches) {
                stretch.take(known, &places, &is_of_background);
            }
            table.x = places.iter().map(|&place| Arc::clone(&known.x[place])).collect();
        }
        self.refresh();
        self.terms.extend(columns.iter().map(|&column| other.terms[column]));
        self
    }

    /// The rows of the recordings that `selected` selects.
    pub fn rows_of(&self, selected: impl Fn(usize) -> bool) -> Vec<usize> {
        let recordings = self.rows.iter().enumerate().filter(|(r, _)| selected(*r));
        recordings.flat_map(|(_, rows)| rows.clone()).collect()
    }

    /// The rows on which `joint` moves, in the recordings that are `fitted`.
    pub fn moving_rows(&self, joint: usize, fitted: &[bool]) -> Vec<usize> {
        let mut rows = self.rows_of(|recording| fitted[recording]);
        rows.retain(|&row| self.joints[joint].moving[row]);
        rows
    }

    /// The standard deviation of a `signal` on those rows.
    pub fn spread(&self, joint: usize, fitted: &[bool], signal: &[f64]) -> f64 {
        deviation(self.moving_rows(joint, fitted).iter().map(|&row| signal[row]))
    }

    /// The same one as long as the inner products are the same.
    pub fn identity(&self) -> &Arc<()> {
        &self.identity
    }

    /// The same one as long as the rows are the same, and columns are only added.
    pub fn origin(&self) -> &Arc<()> {
        &self.origin
    }

    fn refresh(&mut self) {
        self.identity = Arc::default();
        let background = self.background;
        self.joints.par_iter_mut().zip(&self.place).for_each(|(table, place)| {
            let is_of_background = of_background(place, table.x.len(), background);
            for stretch in &mut table.stretches {
                stretch.refresh(&table.x, &table.y, &is_of_background);
            }
        });
    }

    /// Takes those of the `known` columns that have `copies` among this table's first terms; it has no columns yet.
    fn take(&mut self, mut known: Table, copies: &[Option<usize>]) {
        for (joint, (table, place)) in self.joints.iter_mut().zip(&mut self.place).enumerate() {
            let old = &mut known.joints[joint];
            let taken = copies.iter().enumerate();
            let taken = taken.filter_map(|(term, &copy)| Some((term, known.place[joint][copy?]?)));
            let (terms, places): (Vec<usize>, Vec<usize>) = taken.unzip();
            let is_of_background: Vec<bool> = terms.iter().map(|&term| term < self.background).collect();
            for (stretch, known) in table.stretches.iter_mut().zip(&old.stretches) {
                stretch.take(known, &places, &is_of_background);
            }
            table.x = places.iter().map(|&column| std::mem::take(&mut old.x[column])).collect();
            terms.into_iter().enumerate().for_each(|(column, term)| place[term] = Some(column));
        }
    }

    /// Evaluates more terms; those that `known` contains are taken from it, if this table has no columns yet.
    pub fn add(&mut self, motions: &Motions, rigid: &[Rigid], scales: &Scales, terms: Vec<Term>, known: Option<Table>) {
        let first = self.terms.len();
        self.place.iter_mut().for_each(|place| place.resize(first + terms.len(), None));
        let of = |term: &Term| known.as_ref()?.terms.iter().position(|other| other == term);
        let copies: Vec<Option<usize>> = terms.iter().map(of).collect();
        if let Some(known) = known {
            self.take(known, &copies);
        }
        let is_new = |(term, copy): (&Term, &Option<usize>)| term.is(&INERTIAL_PARAMETER) && copy.is_none();
        let inertial: Vec<Vec<Vec<Vec<f64>>>> = if terms.iter().zip(&copies).any(is_new) {
            let along = motions.chunks.par_iter().zip(rigid);
            along.map(|(chunk, rigid)| rigid.inertial_columns(chunk)).collect()
        } else {
            Vec::new()
        };
        let batches = terms.chunks(BATCH).zip(copies.chunks(BATCH));
        for (from, (batch, copies)) in (first..).step_by(BATCH).zip(batches) {
            // The motion behind a compliant joint is simulated once for all joints on which it acts.
            let links: Vec<Vec<LinkSide>> = batch
                .par_iter()
                .zip(copies)
                .map(|(&term, copy)| {
                    let along = motions.chunks.iter().zip(rigid).filter(|_| copy.is_none());
                    along.filter_map(|(chunk, rigid)| link_side(term, chunk, rigid, scales)).collect()
                })
                .collect();
            // The column of every term on every joint; `None` if it does not act there.
            let rows = self.len();
            // That of an inertial parameter, which is evaluated now, or was taken before.
            let of_link = |joint: usize, link: usize, parameter: usize| -> Vec<f64> {
                if !inertial.is_empty() {
                    let k = link * bodies::PER_LINK + parameter;
                    return inertial.iter().flat_map(|chunk| &chunk[joint][k]).copied().collect();
                }
                let known = Term::about(&INERTIAL_PARAMETER, link).of(parameter);
                let place = terms.iter().position(|&term| term == known);
                let place = place.and_then(|term| self.place[joint][first + term]);
                place.map_or_else(|| vec![0.0; rows], |place| self.joints[joint].x[place].to_vec())
            };
            let evaluate = |joint: usize, at: usize| -> Option<Vec<f64>> {
                let (term, links) = (batch[at], &links[at]);
                if copies[at].is_some() {
                    return None;
                }
                let mut column = Vec::new();
                if term.is(&INERTIAL_PARAMETER) {
                    column = of_link(joint, term.of[0], term.of[1]);
                } else if term.is(&OWN_LOAD) {
                    let has = |chunk: &Chunk| chunk.shares_before(motions.sources[chunk.recording].own_load_until);
                    let shares = motions.chunks.iter().flat_map(has);
                    let values = of_link(joint, term.of[0], term.of[1]);
                    column.extend(values.iter().zip(shares).map(|(value, share)| share * value));
                } else {
                    for (c, (chunk, rigid)) in motions.chunks.iter().zip(rigid).enumerate() {
                        let values = match links.get(c) {
                            Some(link) => Some(link_side_torque(link, joint, chunk, rigid, scales)),
                            None => values(term, joint, chunk, rigid, scales),
                        };
                        match values {
                            Some(values) if values.iter().all(|&v| v == 0.0) => {
                                column.resize(column.len() + chunk.rows(), 0.0);
                            }
                            Some(values) => column.extend(chunk.filter(&values)),
                            None => break,
                        }
                    }
                }
                let acts = column.len() == rows && column.iter().any(|&v| v != 0.0);
                acts.then_some(column)
            };
            let (dof, count) = (self.dof(), batch.len());
            let columns: Vec<Option<Vec<f64>>> =
                (0..dof * count).into_par_iter().map(|k| evaluate(k / count, k % count)).collect();
            for (k, column) in columns.into_iter().enumerate() {
                let table = &mut self.joints[k / count];
                if let Some(column) = column {
                    self.place[k / count][from + k % count] = Some(table.x.len());
                    table.x.push(Arc::new(column));
                }
            }
        }
        self.refresh();
        self.terms.extend(terms);
    }

    /// The number of joints.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// The number of rows.
    pub fn len(&self) -> usize {
        self.joints[0].y.len()
    }

    /// The residual of y on `joint` with `coefficients` on the columns `columns`, on all rows (N m or N).
    pub fn residual(&self, joint: usize, columns: &[usize], coefficients: &[f64]) -> Vec<f64> {
        let mut residual = self.torque(joint, columns, coefficients);
        let y = &self.joints[joint].y;
        residual.iter_mut().zip(y).for_each(|(model, y)| *model = y - *model);
        residual
    }

    /// The torque on `joint` of `coefficients` on the columns `columns`, on all rows.
    pub fn torque(&self, joint: usize, columns: &[usize], coefficients: &[f64]) -> Vec<f64> {
        let mut torque = vec![0.0; self.len()];
        for (&column, &coefficient) in columns.iter().zip(coefficients) {
            if let Some(place) = self.place[joint][column] {
                for (sum, x) in torque.iter_mut().zip(self.joints[joint].x[place].iter()) {
                    *sum += coefficient * x;
                }
            }
        }
        torque
    }
}

/// Which of the first columns of a joint are of the first `background` terms; `place` is the place of each term.
fn of_background(place: &[Option<usize>], columns: usize, background: usize) -> Vec<bool> {
    let mut is_of_background = vec![false; columns];
    place.iter().take(background).flatten().for_each(|&place| is_of_background[place] = true);
    is_of_background
}
