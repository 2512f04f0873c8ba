//! The evidence of the recordings together with a motion that is not recorded yet.

use effects::Term;
use torque::{Motion, Reference};

use super::designs::DURATION;
use crate::data::motion::{Chunk, Motions};
use crate::data::rigid::{Needed, Rigid};
use crate::data::signal::Kernel;
use crate::findings::observability::Visibility;
use crate::regression::columns::values;
use crate::regression::fit::{Products, evidence_rate};
use crate::regression::table::{Moving, Table};
use crate::search::physics::is_possible;
use crate::search::study::LinearisationPoint;
use crate::selection::{FinalFit, rivals};

/// The pause between the last recording and the motion (s).
const PAUSE: f64 = 10.0;
/// The ratio of a proposed motion's ticks to those of the recordings.
const COARSER: usize = 2;
/// The number of iterations for a torque that depends on itself (a delay).
const PASSES: usize = 3;

/// A finding and one of its alternatives, as sets of columns.
pub struct Pair {
    /// All effects without the finding.
    pub without: Vec<usize>,
    /// All effects with the alternative in the finding's place, at each of its sizes; and the candidates of the alternative.
    pub instead: Vec<(Vec<usize>, Vec<usize>)>,
}

/// The recordings reduced to some columns, to which a motion can be added.
pub struct Prospect<'a> {
    pub last: &'a FinalFit,
    point: LinearisationPoint,
    nominal: Vec<f64>,
    /// Indices of the study's columns, in ascending order.
    columns: Vec<usize>,
    bare: Table,
    old: Products,
    template: usize,
    /// What the columns need of the rigid model.
    needed: Needed,
    /// The time between ticks of a motion (s), the filter on that grid, and the number of ticks between rows.
    grid: (f64, Kernel, usize),
    /// The time at which the motion begins (s).
    start: f64,
    /// The integrals of [`moments`] over the recordings, one entry per joint.
    torque: Vec<[f64; 3]>,
    /// The integrals of [`powers`] over the recordings, one entry per joint.
    speed: Vec<[f64; 2]>,
}

/// The recordings with a motion.
pub struct Outlook {
    products: Products,
    torque: Vec<f64>,
    weights: Vec<f64>,
    /// The largest torque that the motion needs, one per joint (N m or N).
    pub largest: Vec<f64>,
}

impl<'a> Prospect<'a> {
    /// The recordings of the fit `last`, reduced to its columns and to `columns`; `None` if none is fitted.
    pub fn new(last: &'a FinalFit, mut columns: Vec<usize>) -> Option<Self> {
        let (data, table, fit) = (&last.study.data, &last.study.table, &last.judged.named.fit);
        columns.extend(&fit.columns);
        columns.sort_unstable();
        columns.dedup();
        let terms: Vec<Term> = columns.iter().map(|&column| table.terms[column]).collect();
        let fitted = || {
            let chunks = data.motions.chunks.iter();
            chunks.filter(|chunk| data.fitted[chunk.recording])
        };
        let template = fitted().max_by_key(|chunk| chunk.ticks())?;
        // A sum of slow sines needs no finer grid.
        let (period, stride) = (COARSER as f64 * template.period, template.stride.div_ceil(COARSER));
        let needs = |term: &Term| term.law.needs_derivatives;
        let dof = data.motions.dof;
        let end = data.motions.chunks.iter().map(|chunk| chunk.time(chunk.ticks()));
        let mut torque = vec![[0.0; 3]; dof];
        let mut speed = vec![[0.0; 2]; dof];
        for chunk in fitted() {
            for j in 0..dof {
                moments(&mut torque[j], &chunk.tau[j], chunk.period);
                powers(&mut speed[j], &chunk.qd[j], &chunk.qdd[j], chunk.period);
            }
        }
        Some(Self {
            last,
            point: LinearisationPoint::last(data, table, fit, &last.study.load_tensor),
            nominal: data.arm.inertial_parameters(),
            needed: if terms.iter().any(needs) { Needed::All } else { Needed::WithoutDerivatives },
            grid: (period, Kernel::new(data.motions.cutoff, period), stride),
            bare: Table::bare(terms, dof),
            old: last.products.picked(table, &columns),
            columns,
            template: template.recording,
            start: end.fold(0.0, f64::max) + PAUSE,
            torque,
            speed,
        })
    }

    /// The recordings alone, without a motion.
    pub fn now(&self) -> Outlook {
        Outlook {
            products: self.old.clone(),
            torque: self.last.study.data.scales.torque.clone(),
            weights: self.last.judged.named.fit.weights.clone(),
            largest: vec![0.0; self.last.study.data.motions.dof],
        }
    }

    /// The recordings with the motion of `reference`.
    pub fn with(&self, reference: &Reference) -> Outlook {
        let (data, thresholds) = (&self.last.study.data, &self.last.study.thresholds);
        let (dof, fit) = (data.motions.dof, &self.last.judged.named.fit);
        let mut chunk = self.chunk(reference);
        let LinearisationPoint { arm, offset, .. } = &self.point;
        let rigid = Rigid::with(arm, &self.nominal, offset, &chunk, self.needed);
        self.add_torques(&mut chunk, &rigid);
        let largest = chunk.tau.iter().map(|tau| tau.iter().fold(0.0_f64, |most, tau| most.max(tau.abs())));
        let largest = largest.collect();
        let (mut torque, mut tempo, mut rates) = (Vec::new(), Vec::new(), Vec::new());
        for j in 0..dof {
            let mut sums = self.torque[j];
            moments(&mut sums, &chunk.tau[j], chunk.period);
            let seconds = sums[0].max(f64::MIN_POSITIVE);
            torque.push((sums[2] / seconds - (sums[1] / seconds).powi(2)).max(0.0).sqrt());
            let mut power = self.speed[j];
            powers(&mut power, &chunk.qd[j], &chunk.qdd[j], chunk.period);
            tempo.push((power[1] / power[0].max(1e-300)).sqrt() / std::f64::consts::TAU);
            rates.push(evidence_rate(data.motions.tempo[j]));
        }
        let seconds = chunk.period * chunk.stride as f64;
        let mut source = data.motions.sources[self.template].clone();
        (source.held_out, source.own_load_until) = (false, f64::NEG_INFINITY);
        let this = data.motions.sources.len();
        let motions = Motions {
            changed_at: None,
            groups: data.motions.groups.iter().copied().chain([this]).collect(),
            dof,
            chunks: vec![chunk],
            sources: data.motions.sources.iter().cloned().chain([source]).collect(),
            cutoff: data.motions.cutoff,
            tempo: tempo.clone(),
            one_clock: data.motions.one_clock,
            begins: data.motions.begins,
            remarks: Vec::new(),
        };
        // The products of all of them are needed.
        let terms = (self.bare.terms.len(), self.bare.terms.clone());
        let table = Table::new(&motions, &[rigid], &data.scales, terms, &self.point.carried, Moving::ThroughReversals);
        let seconds_of_all: Vec<f64> = data.seconds.iter().copied().chain([seconds]).collect();
        let new = Products::new(&table, |_| true, &seconds_of_all, &tempo, &data.floor);
        let new = new.picked(&table, &(0..self.columns.len()).collect::<Vec<_>>());
        // The residual of the motion is predicted to be as large as that of the recordings.
        let variance: Vec<f64> = (0..dof).map(|j| fit.rss[j].max(0.0) / self.old.count[j].max(1.0)).collect();
        let evidence = (0..dof)
            .map(|j| {
                let rate = evidence_rate(tempo[j]);
                self.old.evidence[j] / rates[j] * rate + new.count[j] * seconds * rate
            })
            .collect();
        let floor = (0..dof).map(|j| data.noise[j] + (thresholds.tolerance * torque[j]).powi(2)).collect();
        Outlook {
            products: self.old.joined(&new, &variance, evidence, floor),
            torque,
            weights: fit.weights.clone(),
            largest,
        }
    }

    /// The motion on the grid of the recordings. It is slow enough to pass the first filter unchanged.
    fn chunk(&self, reference: &Reference) -> Chunk {
        let dof = self.last.study.data.motions.dof;
        let (period, kernel, stride) = self.grid.clone();
        let ticks = (DURATION / period) as usize + 1;
        let zeros = || vec![vec![0.0; ticks]; dof];
        let mut chunk = Chunk {
            start: self.start,
            q: zeros(),
            qd: zeros(),
            qdd: zeros(),
            tau: zeros(),
            known: Vec::new(),
            // The own friction of another recording is not that of the motion.
            recording: self.last.study.data.motions.sources.len(),
            group: self.last.study.data.motions.sources.len(),
            period,
            kernel,
            stride,
        };
        let mut motion = Motion::new(dof);
        for tick in 0..ticks {
            reference.at(tick as f64 * period, &mut motion);
            for j in 0..dof {
                chunk.q[j][tick] = motion.q[j];
                chunk.qd[j][tick] = motion.qd[j];
                chunk.qdd[j][tick] = motion.qdd[j];
            }
        }
        chunk
    }

    /// The torques that the motion needs by the findings.
    fn add_torques(&self, chunk: &mut Chunk, rigid: &Rigid) {
        let fit = &self.last.judged.named.fit;
        let is_carried = |term: Term| self.point.carried.iter().any(|(carried, _)| *carried == term);
        let scales = &self.last.study.data.scales;
        let mut free = rigid.tau.clone();
        let mut own = Vec::new();
        for (&column, &value) in fit.columns.iter().zip(&fit.coefficients) {
            let term = self.last.study.table.terms[column];
            // A motion within a torque limit never exceeds it, so that the column is zero.
            if is_carried(term) || term.law.cuts {
                continue;
            }
            if term.law.uses_measured_torque {
                own.push((term, value));
                continue;
            }
            for (joint, tau) in free.iter_mut().enumerate() {
                add(tau, value, values(term, joint, chunk, rigid, scales));
            }
        }
        chunk.tau.clone_from(&free);
        for _ in 0..if own.is_empty() { 0 } else { PASSES } {
            let mut next = free.clone();
            for &(term, value) in &own {
                for (joint, tau) in next.iter_mut().enumerate() {
                    add(tau, value, values(term, joint, chunk, rigid, scales));
                }
            }
            chunk.tau = next;
        }
    }

    fn places(&self, columns: &[usize]) -> Vec<usize> {
        columns.iter().filter_map(|column| self.columns.binary_search(column).ok()).collect()
    }

    /// The evidence (nats) in `outlook` for the finding of `pair` against its alternative, and the evidence that distinguishes
    /// them.
    pub fn separation(&self, outlook: &Outlook, pair: &Pair) -> [f64; 2] {
        let fit = |columns: &[usize]| {
            let places = self.places(columns);
            outlook.products.fit(&self.bare, &places, &outlook.weights)
        };
        let named = &self.last.judged.named.fit;
        let background = &named.columns[..named.background];
        let with = fit(named.selected()).loss;
        let without = fit(&pair.without).loss;
        let mut rivals: Vec<_> = pair.instead.iter().map(|(set, added)| (fit(set), set, added)).collect();
        rivals.sort_by(|a, b| a.0.loss.total_cmp(&b.0.loss));
        let study = &self.last.study;
        let possible = rivals.into_iter().find_map(|(mut fit, set, added)| {
            fit.columns = [background, set].concat();
            let is_possible = |&c: &usize| is_possible(&study.candidates[c], &study.table, &fit, &study.data.arm);
            added.iter().all(is_possible).then_some(fit.loss)
        });
        // An alternative that is physically impossible there counts as no effect in the finding's place.
        [possible.unwrap_or(without) - with, rivals::allowance(without - with)]
    }

    /// The detectability of columns in addition to the findings, each on a joint.
    pub fn visibility(&self, outlook: &Outlook, wanted: &[(usize, usize)]) -> Vec<Visibility> {
        let products = &outlook.products;
        let columns = self.places(self.last.judged.named.fit.selected());
        let fit = products.fit(&self.bare, &columns, &outlook.weights);
        let of = |&(joint, column): &(usize, usize)| {
            let place = self.columns.binary_search(&column).ok()?;
            Some(Visibility {
                own: products.drop_of(&self.bare, &fit, place),
                spread: products.spread(joint, place),
                count: products.count[joint],
                evidence: products.evidence[joint],
                torque: outlook.torque[joint],
                least_share: self.last.study.thresholds.least_share,
            })
        };
        wanted.iter().filter_map(of).collect()
    }
}

fn add(sum: &mut [f64], factor: f64, values: Option<Vec<f64>>) {
    for (sum, value) in sum.iter_mut().zip(values.unwrap_or_default()) {
        *sum += factor * value;
    }
}

/// Adds the integrals over time of 1, of a signal and of its square; ticks are `period` (s) apart.
fn moments(sums: &mut [f64; 3], signal: &[f64], period: f64) {
    sums[0] += period * signal.len() as f64;
    sums[1] += period * signal.iter().sum::<f64>();
    sums[2] += period * signal.iter().map(|v| v * v).sum::<f64>();
}

/// Adds the integrals over time of the squares of speed and acceleration; ticks are `period` (s) apart.
fn powers(sums: &mut [f64; 2], speed: &[f64], acceleration: &[f64], period: f64) {
    sums[0] += period * speed.iter().map(|v| v * v).sum::<f64>();
    sums[1] += period * acceleration.iter().map(|v| v * v).sum::<f64>();
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The weight of a motion depends on its duration and not on its grid.
    #[test]
    fn a_coarser_grid_counts_as_much() {
        let (mut fine, mut coarse) = ([0.0; 3], [0.0; 3]);
        moments(&mut fine, &[2.0; 8], 0.5);
        moments(&mut coarse, &[2.0; 4], 1.0);
        assert_eq!((fine, coarse), ([4.0, 8.0, 16.0], fine));
        let (mut fine, mut coarse) = ([0.0; 2], [0.0; 2]);
        powers(&mut fine, &[2.0; 8], &[3.0; 8], 0.5);
        powers(&mut coarse, &[2.0; 4], &[3.0; 4], 1.0);
        assert_eq!((fine, coarse), ([16.0, 36.0], fine));
    }
}
