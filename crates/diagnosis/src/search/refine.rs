//! Sizes that a column is not linear in, found by trying sizes between the catalogue's.

use rayon::prelude::*;

use crate::data::measure::mean;
use crate::regression::term::Term;
use crate::search::candidate::STOP_RATIOS;
use crate::search::problem::Chosen;
use crate::search::study::Study;

/// Factors on a size, each round finer.
const ROUNDS: [[f64; 4]; 4] = [
    [0.75, 0.87, 1.15, 1.33],
    [0.9, 0.95, 1.05, 1.1],
    [0.965, 0.983, 1.017, 1.035],
    [0.988, 0.994, 1.006, 1.012],
];

/// The shortest memory that is none of friction (s).
const SHORTEST_MEMORY: f64 = 0.1;
/// The first step about an onset (s).
const ONSET_STEP: f64 = 0.4;

/// A size that a column is not linear in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// A velocity, a time, a limit, a stiffness, a gap.
    Main,
    /// The damping beside a stiffness.
    Damping,
    /// What the ends of a gap give.
    Stop,
    /// How long a contact lasts.
    Duration,
    /// The periods of a ripple.
    Periods,
    /// The exponent of a drag; a form rather than a size, it has no interval.
    Exponent,
}

/// The sizes that some terms have, of which there are intervals.
pub fn sizes(terms: &[Term]) -> Vec<Size> {
    [Size::Main, Size::Damping, Size::Stop, Size::Periods, Size::Duration]
        .into_iter()
        .filter(|&size| varied(terms, size, 1.01) != terms)
        .collect()
}

/// The same terms with one size times `factor`.
pub fn varied(terms: &[Term], size: Size, factor: f64) -> Vec<Term> {
    let mut terms = terms.to_vec();
    for term in &mut terms {
        match (size, term) {
            (
                Size::Main,
                Term::Stribeck { velocity: value, .. }
                | Term::Warm {
                    time_constant: value, ..
                }
                | Term::Excess { limit: value, .. }
                | Term::Late { delay: value, .. }
                | Term::Elastic { stiffness: value, .. }
                | Term::Gap { halfgap: value, .. },
            )
            | (Size::Damping, Term::Elastic { damping: value, .. })
            | (Size::Stop, Term::Gap { stop: value, .. })
            | (Size::Periods, Term::Ripple { periods: value, .. })
            | (Size::Exponent, Term::Drag { exponent: value, .. }) => *value *= factor,
            // What is forgotten sooner is the velocity itself.
            (Size::Main, Term::Memory(_, value, _)) => *value = (*value * factor).max(SHORTEST_MEMORY),
            (Size::Duration, Term::Force { from, to, .. }) => *to = *from + factor * (*to - *from),
            _ => {}
        }
    }
    terms
}

/// The same terms with their main size, or exponent, times `factor`; empty if they have none.
fn resized(terms: &[Term], factor: f64) -> Vec<Term> {
    let new = varied(&varied(terms, Size::Main, factor), Size::Exponent, factor);
    if new == terms { Vec::new() } else { new }
}

/// The rounds in which other forms are tried.
const FORMS: usize = 2;

/// The other form that terms may have, at the sizes at which it is most like theirs.
fn forms(terms: &[Term]) -> Vec<Vec<Term>> {
    let mut list = Vec::new();
    for factor in [0.7, 1.0, 1.4] {
        let mut other = terms.to_vec();
        let mut changed = false;
        for term in &mut other {
            match term {
                Term::Stribeck { exponent, velocity, .. } => {
                    *exponent = 3.0 - *exponent;
                    *velocity *= factor;
                    changed = true;
                }
                Term::Gap { stop, ratio, .. } if stop.is_finite() => {
                    *ratio *= factor.powi(2);
                    changed |= factor != 1.0;
                }
                Term::Force { from, to, round, .. } => {
                    *round = !*round;
                    let (middle, half) = (0.5 * (*from + *to), 0.5 * factor * (*to - *from));
                    (*from, *to) = (middle - half, middle + half);
                    changed = true;
                }
                _ => {}
            }
        }
        if changed {
            list.push(other);
        }
    }
    list
}

/// Where the ends of a gap that were rigid may swing against the link, first (Hz).
const FIRST_STOPS: [f64; 3] = [12.0, 20.0, 32.0];

/// The same terms with each of the first stiffnesses of a gap's ends, if they are rigid; `mass` is of the link (kg m²).
fn softened(terms: &[Term], mass: f64) -> Vec<Vec<Term>> {
    let soften = |(hertz, first): (f64, f64)| -> Option<Vec<Term>> {
        let mut terms = terms.to_vec();
        let (stop, ratio) = terms.iter_mut().find_map(|term| match term {
            Term::Gap { stop, ratio, .. } if stop.is_infinite() => Some((stop, ratio)),
            _ => None,
        })?;
        *stop = mass * (2.0 * std::f64::consts::PI * hertz).powi(2);
        *ratio = first;
        Some(terms)
    };
    let first = FIRST_STOPS
        .iter()
        .flat_map(|&hertz| STOP_RATIOS.map(|ratio| (hertz, ratio)));
    first.filter_map(soften).collect()
}

/// Variants of a candidate's terms in a round of refinement; `mass` is the inertia of its link (kg m² or kg).
fn variants(terms: &[Term], round: usize, mass: f64) -> Vec<Vec<Term>> {
    let mut list: Vec<Vec<Term>> = ROUNDS[round].iter().map(|&factor| resized(terms, factor)).collect();
    list.retain(|terms| !terms.is_empty());
    // A spring's stiffness and its damping hang together, as a gap and what its ends give: each size of the one with each of
    // the other.
    let second = [Size::Damping, Size::Stop]
        .into_iter()
        .find(|second| sizes(terms).contains(second));
    if let Some(second) = second {
        let steps = [-1.0, -0.4, 0.4, 1.0].map(|step: f64| (1.2 * step * 0.25_f64.powi(round as i32)).exp());
        let stiffer = list.clone();
        for terms in stiffer.into_iter().chain([terms.to_vec()]) {
            list.extend(steps.map(|factor| varied(&terms, second, factor)));
        }
    }
    let sized: Vec<Vec<Term>> = list.iter().cloned().chain([terms.to_vec()]).collect();
    list.extend(sized.iter().flat_map(|terms| softened(terms, mass)));
    list.extend(if round < FORMS { forms(terms) } else { Vec::new() });
    // A finer step about a ripple's period, relative to one period over the range.
    let nudges = [-1.0, -0.4, 0.4, 1.0].map(|step| step * 0.25_f64.powi(round as i32));
    let mut nudged = |change: &dyn Fn(&mut Term, f64) -> bool| {
        for step in nudges {
            let mut terms = terms.to_vec();
            let mut changed = false;
            for term in &mut terms {
                changed |= change(term, step);
            }
            if changed {
                list.push(terms);
            }
        }
    };
    nudged(&|term, step| match term {
        Term::Ripple { periods, .. } => {
            *periods *= 1.0 + 0.02 * step;
            true
        }
        Term::Wave { omega, .. } => {
            *omega *= 1.0 + 0.01 * step;
            true
        }
        Term::Since { from, .. } => {
            *from += ONSET_STEP * step;
            true
        }
        Term::Force { from, to, .. } => {
            *from += 0.25 * step * (*to - *from).max(0.3);
            true
        }
        _ => false,
    });
    nudged(&|term, step| match term {
        Term::Force { from, to, .. } => {
            *to += 0.25 * step * (*to - *from).max(0.3);
            true
        }
        _ => false,
    });
    nudged(&|term, step| match term {
        Term::Force { from, to, .. } => {
            let (middle, half) = (0.5 * (*from + *to), 0.5 * (*to - *from) * (0.4 * step).exp());
            (*from, *to) = (middle - half, middle + half);
            true
        }
        _ => false,
    });
    list.retain(|terms| {
        terms.iter().all(|term| match term {
            Term::Force { from, to, .. } => to - from > 0.05,
            _ => true,
        })
    });
    list
}

/// Finds the sizes of what is in `chosen`, coarsely first if they were not refined before, and takes out what then does not pay.
pub fn refine(study: &mut Study, chosen: Chosen, again: bool) -> Chosen {
    let chosen = resize(study, chosen, again);
    let products = study.products(|r| study.fitted[r]);
    study.problem(&products).prune(chosen)
}

/// Finds the sizes of what is in `chosen`, all of which stays, in its order.
pub fn resize(study: &mut Study, mut chosen: Chosen, again: bool) -> Chosen {
    let fitted = study.fitted.clone();
    for round in (if again { 2 } else { 0 })..ROUNDS.len() {
        let mut options: Vec<(usize, Vec<Vec<Term>>)> = Vec::new();
        let mut missing = Vec::new();
        for &member in &chosen.set {
            let candidate = &study.candidates[member];
            let terms: Vec<Term> = candidate
                .columns
                .iter()
                .map(|&column| study.table.terms[column])
                .collect();
            let mass = candidate.joint.map_or(0.0, |joint| {
                mean(study.rigid.iter().flat_map(|rigid| &rigid.mass[joint][joint]))
            });
            let list = variants(&terms, round, mass);
            for &term in list.iter().flatten() {
                if !study.table.terms.contains(&term) && !missing.contains(&term) {
                    missing.push(term);
                }
            }
            if !list.is_empty() {
                options.push((member, list));
            }
        }
        if options.is_empty() {
            break;
        }
        study.extend(missing);
        let options: Vec<(usize, Vec<usize>)> = options
            .into_iter()
            .map(|(member, list)| {
                let (cause, joint) = (study.candidates[member].cause, study.candidates[member].joint);
                let known = study.candidates.len();
                let add = |terms| study.add(cause, joint, terms);
                let indices = list.into_iter().map(add).collect();
                study.candidates[known..]
                    .iter_mut()
                    .for_each(|trial| trial.is_trial = true);
                (member, indices)
            })
            .collect();
        let products = study.products(|r| fitted[r]);
        let problem = study.problem(&products);
        for (member, indices) in options {
            let best = indices
                .into_par_iter()
                .filter_map(|index| {
                    let set = chosen
                        .set
                        .iter()
                        .map(|&m| if m == member { index } else { m })
                        .collect();
                    let next = problem.choose(set, &chosen.fit.weights);
                    problem.is_possible(index, &next.fit).then_some(next)
                })
                .collect::<Vec<_>>()
                .into_iter()
                .min_by(|a, b| a.score.total_cmp(&b.score));
            if let Some(best) = best
                && best.score < chosen.score
            {
                chosen = best;
            }
        }
    }
    chosen
}
