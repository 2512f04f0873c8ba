//! Inner products of several columns at a time, in the lanes of the processor's vectors. Each product has the same bits as
//! if it were computed alone.

use std::ops::Range;

use gp::{Wide, on_widest};

/// The number of columns that are treated together.
pub const LANES: usize = 8;

/// One entry of several columns, a column in each lane.
pub type Lanes = [f64; LANES];

/// The number of partial sums of an inner product.
const PARTS: usize = 4;

/// The inner product over the length of the second vector.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; PARTS];
    let (x, y) = (a[..b.len()].chunks_exact(PARTS), b.chunks_exact(PARTS));
    let rest: f64 = x.remainder().iter().zip(y.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in x.zip(y) {
        for part in 0..PARTS {
            sums[part] += x[part] * y[part];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

/// [`dot`] of `a` with every lane.
#[inline(always)]
fn dots(a: &[f64], b: &[Lanes]) -> Lanes {
    let mut sums = [[0.0; LANES]; PARTS];
    let (x, y) = (a[..b.len()].chunks_exact(PARTS), b.chunks_exact(PARTS));
    let mut rest = [-0.0; LANES];
    for (x, y) in x.remainder().iter().zip(y.remainder()) {
        for lane in 0..LANES {
            rest[lane] += x * y[lane];
        }
    }
    for (x, y) in x.zip(y) {
        for part in 0..PARTS {
            for lane in 0..LANES {
                sums[part][lane] += x[part] * y[part][lane];
            }
        }
    }
    std::array::from_fn(|lane| (sums[0][lane] + sums[1][lane]) + (sums[2][lane] + sums[3][lane]) + rest[lane])
}

/// Replaces `right` by L⁻¹ of it; `lower` are the rows of L.
pub fn forward(lower: &[Vec<f64>], right: &mut [Lanes]) {
    on_widest(Forward { lower, right });
}

struct Forward<'a> {
    lower: &'a [Vec<f64>],
    right: &'a mut [Lanes],
}

impl Wide for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        for (i, row) in self.lower.iter().enumerate() {
            let (before, rest) = self.right.split_at_mut(i);
            let known = dots(row, before);
            for lane in 0..LANES {
                rest[0][lane] = (rest[0][lane] - known[lane]) / row[i];
            }
        }
    }
}

/// [`dot`] of each of `rows` with every lane of `columns`.
pub fn dots_of(rows: &[&[f64]], columns: &[Lanes]) -> Vec<Lanes> {
    on_widest(DotsOf { rows, columns })
}

struct DotsOf<'a> {
    rows: &'a [&'a [f64]],
    columns: &'a [Lanes],
}

impl Wide for DotsOf<'_> {
    type Output = Vec<Lanes>;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> Vec<Lanes> {
        self.rows.iter().map(|row| dots(row, self.columns)).collect()
    }
}

/// [`dot`] of `a` with each of `others`.
pub fn dots_with(a: &[f64], others: &[&[f64]]) -> Vec<f64> {
    on_widest(DotsWith { a, others })
}

struct DotsWith<'a> {
    a: &'a [f64],
    others: &'a [&'a [f64]],
}

/// The number of inner products that are formed at the same time, so that none waits for its own additions.
const AT_ONCE: usize = 4;

impl Wide for DotsWith<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> Vec<f64> {
        let Self { a, others } = self;
        let mut products = Vec::with_capacity(others.len());
        let groups = others.chunks_exact(AT_ONCE);
        let alone = groups.remainder();
        let whole = a.len() / PARTS * PARTS;
        for group in groups {
            let mut sums = [[0.0; PARTS]; AT_ONCE];
            for from in (0..whole).step_by(PARTS) {
                let x = &a[from..from + PARTS];
                for (sums, other) in sums.iter_mut().zip(group) {
                    let y = &other[from..from + PARTS];
                    for part in 0..PARTS {
                        sums[part] += x[part] * y[part];
                    }
                }
            }
            for (sums, other) in sums.iter().zip(group) {
                let rest: f64 = a[whole..].iter().zip(&other[whole..]).map(|(x, y)| x * y).sum();
                products.push((sums[0] + sums[1]) + (sums[2] + sums[3]) + rest);
            }
        }
        products.extend(alone.iter().map(|other| dot(a, other)));
        products
    }
}

/// The number of partial sums of an inner product of long vectors.
const LONG_PARTS: usize = 16;

/// The inner product of two signals over runs of rows.
pub fn dot_over(runs: &[Range<usize>], a: &[f64], b: &[f64]) -> f64 {
    on_widest(DotOver { runs, a, b })
}

struct DotOver<'a> {
    runs: &'a [Range<usize>],
    a: &'a [f64],
    b: &'a [f64],
}

impl Wide for DotOver<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> f64 {
        let mut sums = [0.0; LONG_PARTS];
        for run in self.runs {
            let (x, y) = (self.a[run.clone()].chunks_exact(LONG_PARTS), self.b[run.clone()].chunks_exact(LONG_PARTS));
            // Runs may be short: no addition waits for another one of the same run.
            for (sum, (x, y)) in sums.iter_mut().zip(x.remainder().iter().zip(y.remainder())) {
                *sum += x * y;
            }
            for (x, y) in x.zip(y) {
                for part in 0..LONG_PARTS {
                    sums[part] += x[part] * y[part];
                }
            }
        }
        sums.iter().sum()
    }
}

/// Replaces `right` by L⁻¹ of it, column by column of L: `lower` has its columns one after the other.
pub fn forward_by_columns(lower: &[f64], right: &mut [Lanes]) {
    on_widest(ForwardByColumns { lower, right });
}

struct ForwardByColumns<'a> {
    lower: &'a [f64],
    right: &'a mut [Lanes],
}

impl Wide for ForwardByColumns<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let Self { lower, right } = self;
        let p = right.len();
        for i in 0..p {
            let column = &lower[i * p..(i + 1) * p];
            let coefficients = right[i].map(|value| value / column[i]);
            right[i] = coefficients;
            for (values, entry) in right[i + 1..].iter_mut().zip(&column[i + 1..]) {
                for lane in 0..LANES {
                    values[lane] += -coefficients[lane] * entry;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(seed: usize, rows: usize) -> Vec<f64> {
        (0..rows).map(|k| ((seed * 31 + k * 7) as f64).sin()).collect()
    }

    /// Results in lanes have the same bits as results that are computed alone.
    #[test]
    fn lanes_have_the_bits_of_single_columns() {
        for rows in [1, 3, 4, 7, 21] {
            let columns: [Vec<f64>; LANES] = std::array::from_fn(|lane| column(lane, rows));
            let lanes: Vec<Lanes> = (0..rows).map(|k| std::array::from_fn(|lane| columns[lane][k])).collect();
            let others: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
            let a = column(40, rows);
            let expected: Vec<f64> = others.iter().map(|other| dot(&a, other)).collect();
            assert_eq!(dots_of(&[&a], &lanes)[0].to_vec(), expected);
            assert_eq!(dots_with(&a, &others[..7]), expected[..7]);
            let lower: Vec<Vec<f64>> = (0..rows)
                .map(|i| (0..=i).map(|k| if i == k { 2.0 } else { ((i * 5 + k) as f64).cos() }).collect())
                .collect();
            let matrix = nalgebra::DMatrix::from_fn(rows, rows, |i, k| if k <= i { lower[i][k] } else { 0.0 });
            let (mut by_rows, mut by_columns) = (lanes.clone(), lanes.clone());
            forward(&lower, &mut by_rows);
            forward_by_columns(matrix.as_slice(), &mut by_columns);
            for (lane, column) in columns.iter().enumerate() {
                let alone = matrix.solve_lower_triangular(&nalgebra::DVector::from_column_slice(column));
                let alone = alone.expect("the diagonal is not zero");
                let mut solved = column.clone();
                for i in 0..rows {
                    solved[i] = (solved[i] - dot(&lower[i], &solved[..i])) / lower[i][i];
                }
                for k in 0..rows {
                    assert_eq!(by_columns[k][lane], alone[k]);
                    assert_eq!(by_rows[k][lane], solved[k]);
                }
            }
        }
    }
}
