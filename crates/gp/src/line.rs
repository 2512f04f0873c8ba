//! The maximum of a function of one variable, from few values: parabolas through the best ones.
//!
//! Each value costs a factorisation and is rounded. Brent's method, which argmin offers, narrows an interval until its values differ
//! by less than that rounding; here the last values are so far apart that the parabola through them is not made of rounding.

/// Values after which the best one is taken.
const VALUES: usize = 32;

/// The longest step beyond the values known, in units of their distance.
const EXPANSION: f64 = 4.0;

/// How far off a curvature known beforehand may be, as a share of it.
const DOUBT: f64 = 0.3;

/// How many times as far as on one side the next value may be on the other.
const LOPSIDED: f64 = 4.0;

/// When a maximum is found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Goal {
    /// Gains that are no gain.
    pub(crate) negligible: f64,
    /// The difference between values up to which a parabola describes the function well, and by which they stand out from
    /// rounding: the last values have about this difference, and are on both sides. `None` if that is not asked for.
    pub(crate) near: Option<f64>,
}

/// A function, and its values in the order of their places.
pub(crate) struct Line<F> {
    function: F,
    /// The least and the largest place allowed.
    range: (f64, f64),
    known: Vec<(f64, f64)>,
}

/// Where a function is largest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Maximum {
    /// The place of the largest value known.
    pub(crate) at: f64,
    pub(crate) value: f64,
    /// The place of the maximum, as the values beside it tell; the values' own rounding is less in it.
    pub(crate) top: f64,
    /// Minus the second derivative there; `None` if the values do not tell.
    pub(crate) curvature: Option<f64>,
}

/// The estimate of the maximum next to the largest of some values.
struct Outlook {
    /// The next place to look at, if there is any more to gain.
    next: Option<f64>,
    top: f64,
    curvature: Option<f64>,
}

impl Outlook {
    fn unknown(next: f64) -> Self {
        Self { next: Some(next), top: next, curvature: None }
    }
}

impl<F: FnMut(f64) -> f64> Line<F> {
    pub(crate) fn new(range: (f64, f64), function: F) -> Self {
        Self { function, range, known: Vec::new() }
    }

    /// Evaluates the function at `at`, or at the end of the range; `false` if it is known there. A value that is no number counts
    /// as minus infinity.
    pub(crate) fn look(&mut self, at: f64) -> bool {
        let at = at.clamp(self.range.0, self.range.1);
        if self.known.iter().any(|known| known.0 == at) {
            return false;
        }
        let value = (self.function)(at);
        let value = if value.is_nan() { f64::NEG_INFINITY } else { value };
        let next = self.known.partition_point(|known| known.0 < at);
        self.known.insert(next, (at, value));
        true
    }

    /// Climbs to the maximum next to the largest value. `curvature` is known beforehand, if it is given.
    pub(crate) fn climb(&mut self, curvature: Option<f64>, goal: Goal) -> Maximum {
        loop {
            let better = |a: usize, i: usize| if self.known[i].1 > self.known[a].1 { i } else { a };
            let best = (1..self.known.len()).fold(0, better);
            let (at, value) = self.known[best];
            let inside = best > 0 && best + 1 < self.known.len();
            let outlook = if inside { self.within(best, goal) } else { self.beyond(best, curvature, goal) };
            let more = self.known.len() < VALUES && value > f64::NEG_INFINITY;
            if !(more && outlook.next.is_some_and(|next| self.look(next))) {
                let top = if outlook.next.is_none() { outlook.top } else { at };
                return Maximum { at, value, top: top.clamp(self.range.0, self.range.1), curvature: outlook.curvature };
            }
        }
    }

    /// The outlook if the values on both sides of the largest are lower.
    fn within(&self, best: usize, goal: Goal) -> Outlook {
        let (at, value) = self.known[best];
        let distance = |side: usize| (self.known[side].0 - at).abs();
        let Some((vertex, curvature)) = vertex(&self.known[best - 1..=best + 1]) else {
            // Values that are infinitely low tell only where not to look.
            let side = if distance(best - 1) > distance(best + 1) { best - 1 } else { best + 1 };
            return Outlook::unknown(0.5 * (at + self.known[side].0));
        };
        let outlook = |next: Option<f64>| Outlook { next, top: vertex, curvature: Some(curvature) };
        let (side, other, sign) = match vertex < at {
            true => (best - 1, best + 1, -1.0),
            false => (best + 1, best - 1, 1.0),
        };
        let mut step = (vertex - at).abs();
        if 0.5 * curvature * step.powi(2) > goal.negligible {
            if distance(side) > LOPSIDED * distance(other) {
                step = step.max(0.5 * LOPSIDED * distance(other));
            }
            return outlook(Some(at + sign * step));
        }
        let Some(near) = goal.near else { return outlook(None) };
        let step = (2.0 * near / curvature).sqrt();
        let far = |side: usize| value - self.known[side].1 > 4.0 * near && distance(side) > step;
        if far(side) {
            outlook(Some(at + sign * step))
        } else if far(other) {
            outlook(Some(at - sign * step))
        } else {
            outlook(None)
        }
    }

    /// The outlook if the largest value is at an end.
    fn beyond(&self, best: usize, curvature: Option<f64>, goal: Goal) -> Outlook {
        let (at, value) = self.known[best];
        let Some(&(other, lower)) = self.known.get(if best == 0 { 1 } else { best - 1 }) else {
            return Outlook { next: None, top: at, curvature: None };
        };
        let distance = at - other;
        let three = match best {
            0 => self.known.get(..3),
            _ => best.checked_sub(2).map(|first| &self.known[first..]),
        };
        let measured = three.and_then(vertex).map(|(vertex, curvature)| (vertex, curvature, 0.0));
        let expected = || {
            let from_middle = (value - lower) / (distance * curvature?);
            Some((0.5 * (at + other) + from_middle, curvature?, DOUBT * from_middle.abs()))
        };
        let found = measured.or_else(expected).filter(|(vertex, ..)| vertex.is_finite());
        let Some((vertex, curvature, doubt)) = found else {
            return Outlook::unknown(at + 2.0 * distance);
        };
        let gain = 0.5 * curvature * ((vertex - at).abs() + doubt).powi(2);
        let outlook = |next: Option<f64>| Outlook { next, top: vertex, curvature: Some(curvature) };
        if gain <= goal.negligible {
            let step = goal.near.map(|near| (2.0 * near / curvature).sqrt());
            return outlook(step.map(|step| at + step.copysign(distance)));
        }
        let mut step = ((vertex - at) / distance).min(EXPANSION);
        if step.abs() < 0.3 {
            // Values next to each other tell little; one beyond tells where the function falls.
            step = 0.5;
        }
        outlook(Some(at + step * distance))
    }
}

/// Where the parabola through three values has its maximum, and minus its second derivative; `None` if it has none.
fn vertex(three: &[(f64, f64)]) -> Option<(f64, f64)> {
    let [(a, at_a), (b, at_b), (c, at_c)] = *three else {
        return None;
    };
    let (left, right) = ((at_b - at_a) / (b - a), (at_c - at_b) / (c - b));
    let curvature = 2.0 * (left - right) / (c - a);
    let found = curvature > 0.0 && curvature.is_finite();
    found.then(|| (0.5 * (a + b) + left / curvature, curvature))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Climbs `function` from 0 and 0.5: the maximum, and the number of values it took.
    fn climbed(function: impl Fn(f64) -> f64, negligible: f64) -> (Maximum, usize) {
        let mut values = 0;
        let mut line = Line::new((-20.0, 20.0), |x| {
            values += 1;
            function(x)
        });
        line.look(0.0);
        line.look(0.5);
        let goal = Goal { negligible, near: None };
        let found = line.climb(None, goal);
        (found, values)
    }

    #[test]
    fn a_parabola_takes_one_value_more_than_it_has_coefficients() {
        let (found, values) = climbed(|x| 3.0 - 50.0 * (x - 0.8).powi(2), 1e-9);
        assert!((found.at - 0.8).abs() < 1e-9 && (found.value - 3.0).abs() < 1e-9, "{found:?}");
        assert!((found.curvature.expect("known") - 100.0).abs() < 1e-6);
        assert_eq!(values, 4);
    }

    #[test]
    fn a_curvature_known_beforehand_saves_a_value() {
        let mut values = 0;
        let mut line = Line::new((-20.0, 20.0), |x: f64| {
            values += 1;
            -500.0 * (x - 0.3).powi(2)
        });
        line.look(0.25);
        line.look(0.35);
        let goal = Goal { negligible: 2.0, near: None };
        let found = line.climb(Some(1000.0), goal);
        assert_eq!(values, 2);
        assert!((found.value + 1.25).abs() < 1e-9);
    }

    #[test]
    fn hills_far_off_skew_or_cut_off_are_climbed() {
        for (name, function, maximum) in [
            ("far to the left", (|x: f64| -(x + 12.0).cosh().ln()) as fn(f64) -> f64, -12.0),
            ("skew", |x: f64| 100.0 * (x - x.exp()), 0.0),
            ("at the end of the range", |x: f64| x, 20.0),
            ("no number on one side", |x: f64| if x < 3.0 { x } else { f64::NAN }, 3.0),
        ] {
            let (found, values) = climbed(function, 1e-3);
            assert!((found.at - maximum).abs() < 0.1, "{name}: {found:?} after {values} values");
        }
    }

    #[test]
    fn nothing_but_infinitely_low_values_ends() {
        assert_eq!(climbed(|_| f64::NAN, 0.1).0.value, f64::NEG_INFINITY);
    }
}
