//! Inner products of columns over rows.

use std::ops::Range;
use std::sync::{Arc, OnceLock};

use faer::{Accum, Mat, MatRef, Par, linalg::matmul::matmul};
use gp::release_vectors;

use crate::lanes::dot_over;
use crate::regression::lazy::Lazy;

/// A column on all rows of a table, which copies of the table share.
pub type SharedColumn = Arc<Vec<f64>>;

/// The number of columns that are copied together for their inner products.
const TOGETHER: usize = 64;

/// The rows of inner products.
#[derive(Clone, Debug, Default)]
enum Over {
    /// Those of other products, which are all formed.
    #[default]
    Elsewhere,
    /// Runs of consecutive rows.
    Runs(Arc<[Range<usize>]>),
    /// Those of several products together.
    All(Vec<Arc<Gram>>),
}

/// The inner products of a column with those before it.
#[derive(Debug)]
struct Row {
    /// The column on all rows of the table; empty in sums and picked products.
    x: SharedColumn,
    /// Those with the background's columns before it, then with itself; if the column is of the background, those with all columns up to it.
    formed: Vec<f64>,
    /// Whether those with all columns up to it are formed, as for a column of the background and in picked products.
    is_whole: bool,
    /// The other ones, if they are sums over several recordings.
    others: OnceLock<Box<[Lazy]>>,
}

impl Row {
    fn whole(formed: Vec<f64>) -> Self {
        Self { x: SharedColumn::default(), formed, is_whole: true, others: OnceLock::new() }
    }
}

/// Inner products of columns with each other and with y. Those with the background's columns, which every fit needs, are formed at once, and
/// those of two other columns when they are first needed: of most pairs, they never are.
#[derive(Clone, Debug, Default)]
pub struct Gram {
    /// The lower triangle. Rows are shared by copies.
    rows: Vec<Arc<Row>>,
    /// For each column, its number among the background's columns, if it is one of them.
    number: Vec<Option<usize>>,
    /// Inner products with y.
    right: Vec<f64>,
    /// The inner product of y with itself.
    square: f64,
    /// The sums of the columns.
    sums: Vec<f64>,
    over: Over,
}

impl Gram {
    /// Those over runs of consecutive rows, of no column yet.
    pub fn over(runs: Vec<Range<usize>>) -> Self {
        Self { over: Over::Runs(runs.into()), ..Self::default() }
    }

    /// The runs of rows; none if these products are the sum of others.
    pub fn runs(&self) -> &[Range<usize>] {
        match &self.over {
            Over::Runs(runs) => runs,
            Over::Elsewhere | Over::All(_) => &[],
        }
    }

    /// Whether they are known for all columns of a table of so many.
    pub fn has_all(&self, columns: usize) -> bool {
        columns > 0 && self.right.len() == columns
    }

    /// The number of columns.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// The product of two columns.
    pub fn of(&self, i: usize, k: usize) -> f64 {
        let (last, first) = (i.max(k), i.min(k));
        let row = &self.rows[last];
        if row.is_whole {
            return row.formed[first];
        }
        let formed = if first == last { row.formed.last() } else { self.number[first].map(|at| &row.formed[at]) };
        if let Some(formed) = formed {
            return *formed;
        }
        match &self.over {
            Over::Elsewhere => 0.0,
            Over::Runs(runs) => dot_over(runs, &self.rows[last].x, &self.rows[first].x),
            Over::All(parts) => {
                let none = || (0..last).map(|_| Lazy::default()).collect();
                let place = &row.others.get_or_init(none)[first];
                place.get_or(|| parts.iter().fold(0.0, |sum, part| sum + part.of(last, first)))
            }
        }
    }

    /// The product of a column and y.
    pub fn with_y(&self, i: usize) -> f64 {
        self.right[i]
    }

    /// The product of y with itself.
    pub fn y_square(&self) -> f64 {
        self.square
    }

    /// The sum of a column.
    pub fn sum_of(&self, i: usize) -> f64 {
        self.sums[i]
    }

    /// Adds the new ones among the columns `x`, with their products with y if it is another one, and with the columns that are of the background.
    pub fn refresh(&mut self, x: &[SharedColumn], y: &[f64], is_of_background: &[bool]) {
        let Over::Runs(runs) = self.over.clone() else { return };
        let (known, total) = (self.len(), x.len());
        self.square = dot_over(&runs, y, y);
        self.right.extend(x[self.right.len()..].iter().map(|x| dot_over(&runs, x, y)));
        let sum = |x: &SharedColumn| runs.iter().map(|run| x[run.clone()].iter().sum::<f64>()).sum::<f64>();
        self.sums.extend(x[known..].iter().map(sum));

        let before = self.number.iter().flatten().count();
        let (new, others): (Vec<usize>, Vec<usize>) = (known..total).partition(|&k| is_of_background[k]);
        let old: Vec<usize> = (0..known).filter(|&k| self.number[k].is_some()).collect();
        let all: Vec<usize> = if new.is_empty() { Vec::new() } else { (0..total).collect() };
        let with_new = products(&runs, x, &all, &new);
        let with_old = products(&runs, x, &others, &old);
        let (mut seen, mut other) = (0, 0);
        for k in known..total {
            let row = if is_of_background[k] {
                let formed = (0..=k).map(|i| with_new[(i, seen)]).collect();
                self.number.push(Some(before + seen));
                seen += 1;
                Row::whole(formed)
            } else {
                let of_old = (0..old.len()).map(|at| with_old[(other, at)]);
                let of_new = (0..seen).map(|at| with_new[(k, at)]);
                let formed = of_old.chain(of_new).chain([dot_over(&runs, &x[k], &x[k])]).collect();
                self.number.push(None);
                other += 1;
                Row { is_whole: false, ..Row::whole(formed) }
            };
            self.rows.push(Arc::new(Row { x: Arc::clone(&x[k]), ..row }));
        }
    }

    /// The products of the columns at these places with each other.
    pub fn taken(&self, places: &[usize], is_of_background: &[bool]) -> Self {
        let mut gram = Self { over: self.over.clone(), ..Self::default() };
        let mut background: Vec<usize> = Vec::new();
        for (k, &place) in places.iter().enumerate() {
            let with = |&first: &usize| self.of(first, place);
            let row = if is_of_background[k] {
                gram.number.push(Some(background.len()));
                background.push(place);
                Row::whole(places[..=k].iter().map(with).collect())
            } else {
                gram.number.push(None);
                let formed = background.iter().chain([&place]).map(with).collect();
                Row { is_whole: false, ..Row::whole(formed) }
            };
            gram.rows.push(Arc::new(Row { x: Arc::clone(&self.rows[place].x), ..row }));
            gram.sums.push(self.sums[place]);
        }
        gram
    }

    /// The products of the columns at these indices, in this order; zero for a missing one.
    pub fn picked(&self, places: &[Option<usize>]) -> Gram {
        let of = |i: Option<usize>, k: Option<usize>| match (i, k) {
            (Some(i), Some(k)) => self.of(i, k),
            _ => 0.0,
        };
        let row = |k: usize| Arc::new(Row::whole((0..=k).map(|i| of(places[i], places[k])).collect()));
        Gram {
            rows: (0..places.len()).map(row).collect(),
            number: vec![None; places.len()],
            right: places.iter().map(|place| place.map_or(0.0, |i| self.right[i])).collect(),
            square: self.square,
            sums: places.iter().map(|place| place.map_or(0.0, |i| self.sums[i])).collect(),
            over: Over::Elsewhere,
        }
    }

    /// These products with an additional part of y that no column has.
    pub fn with_noise(mut self, square: f64) -> Gram {
        self.square += square;
        self
    }

    /// The sum of several products of the same `columns` columns, the first ones of which may be in `known`: the sum of the same
    /// products when they had fewer columns.
    pub fn sum(known: Gram, columns: usize, grams: Vec<Arc<Gram>>) -> Gram {
        let mut sum = known;
        let number = grams.first().map_or_else(|| vec![None; columns], |gram| gram.number.clone());
        debug_assert!(grams.iter().all(|gram| gram.number == number), "the same columns are of the background");
        for k in sum.len()..columns {
            let first = grams.first().map(|gram| &gram.rows[k]);
            let mut formed = vec![0.0; first.map_or(k + 1, |row| row.formed.len())];
            for gram in &grams {
                formed.iter_mut().zip(&gram.rows[k].formed).for_each(|(value, more)| *value += more);
            }
            let is_whole = first.is_none_or(|row| row.is_whole);
            sum.rows.push(Arc::new(Row { is_whole, ..Row::whole(formed) }));
            sum.right.push(grams.iter().fold(0.0, |value, gram| value + gram.right[k]));
            sum.sums.push(grams.iter().fold(0.0, |value, gram| value + gram.sums[k]));
        }
        sum.number = number;
        sum.square = grams.iter().fold(0.0, |square, gram| square + gram.square);
        sum.over = Over::All(grams);
        sum
    }
}

/// The inner products of each of `some` of the columns `x`, in rows, with each of `others`, over runs of rows.
fn products(runs: &[Range<usize>], x: &[SharedColumn], some: &[usize], others: &[usize]) -> Mat<f64> {
    let length: usize = runs.iter().map(Range::len).sum();
    let packed = |columns: &[usize]| -> Vec<f64> {
        let mut packed = Vec::with_capacity(length * columns.len());
        for &column in columns {
            runs.iter().for_each(|run| packed.extend_from_slice(&x[column][run.clone()]));
        }
        packed
    };
    let mut all = Mat::zeros(some.len(), others.len());
    if others.is_empty() {
        return all;
    }
    let right = packed(others);
    let right = MatRef::from_column_major_slice(&right, length, others.len());
    let mut from = 0;
    for columns in some.chunks(TOGETHER) {
        let left = packed(columns);
        let left = MatRef::from_column_major_slice(&left, length, columns.len());
        let to = all.as_mut().subrows_mut(from, columns.len());
        matmul(to, Accum::Replace, left.transpose(), right, 1.0, Par::Seq);
        release_vectors();
        from += columns.len();
    }
    all
}

#[cfg(test)]
mod tests {
    use super::super::Stretch;
    use super::*;

    /// Products that are formed at once, when they are needed, or taken from another table are those of the rows, in the order of the
    /// columns of each table, and over several recordings together.
    #[test]
    fn products_are_those_of_the_rows() {
        let signal = |seed: usize| (0..90).map(|row| ((seed * 37 + row * row) as f64 * 0.1).sin()).collect();
        let x: Vec<SharedColumn> = (0..7).map(|seed| Arc::new(signal(seed))).collect();
        let [y, other]: [Vec<f64>; 2] = [signal(20), signal(21)];
        let moving: Vec<bool> = (0..90).map(|row| row % 11 != 0).collect();
        let stretches = || Stretch::of(&[0..50, 50..90], &[0, 1], &[false; 2], &[false; 2], &moving);
        let near = |value: f64, expected: f64| (value - expected).abs() < 1e-9;
        let product = |rows: &Range<usize>, a: &[f64], b: &[f64]| -> f64 {
            rows.clone().filter(|&row| moving[row]).map(|row| a[row] * b[row]).sum()
        };
        let are_right = |gram: &Gram, rows: Range<usize>, x: &[SharedColumn], y: &[f64]| {
            let of_pair = |i: usize, k: usize| near(gram.of(i, k), product(&rows, &x[i], &x[k]));
            let of_column =
                |i: usize| (0..x.len()).all(|k| of_pair(i, k)) && near(gram.with_y(i), product(&rows, &x[i], y));
            gram.len() == x.len() && (0..x.len()).all(of_column) && near(gram.y_square(), product(&rows, y, y))
        };
        let mut first = stretches();
        let background = [false, true, false, true, true, false, false];
        let mut all = Gram::default();
        for count in [4, 7] {
            first.iter_mut().for_each(|stretch| stretch.refresh(&x[..count], &y, &background[..count]));
            // The products of all columns are formed before others are added.
            all = Gram::sum(all, count, first.iter().map(|stretch| Arc::clone(&stretch.gram)).collect());
            assert!(are_right(&all, 0..90, &x[..count], &y));
        }
        assert!(are_right(&first[0].gram, 0..50, &x, &y));

        let picked = all.picked(&[Some(5), None, Some(1)]);
        assert_eq!([picked.of(0, 2), picked.of(1, 2), picked.sum_of(2)], [all.of(5, 1), 0.0, all.sum_of(1)]);

        // Another table has some of the columns in another order, new ones, another y, and other columns of the background.
        let places = [4, 6, 1, 0, 3];
        let mut columns: Vec<SharedColumn> = places.iter().map(|&place| Arc::clone(&x[place])).collect();
        let mut second = stretches();
        let background = [true, false, true, true, false, false, true];
        for (new, known) in second.iter_mut().zip(&first) {
            new.take(known, &places, &background[..5]);
        }
        columns.extend([30, 31].map(|seed| Arc::new(signal(seed))));
        second.iter_mut().for_each(|stretch| stretch.refresh(&columns, &other, &background));
        assert!(are_right(&second[0].gram, 0..50, &columns, &other));
        assert!(are_right(&second[1].gram, 50..90, &columns, &other));
        let grams = second.iter().map(|stretch| Arc::clone(&stretch.gram)).collect();
        assert!(are_right(&Gram::sum(Gram::default(), 7, grams), 0..90, &columns, &other));
    }
}
