//! Arrays with one row per sample, and computations row by row.

use arm::Arm;
use numpy::{PyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::error::JointwiseError;

/// The number of rows that a thread computes at a time.
const BLOCK: usize = 256;

/// A copy of an array of `n` rows, one column per joint.
pub struct Rows {
    /// The values, row by row.
    pub values: Vec<f64>,
    columns: usize,
}

impl Rows {
    /// The rows of `array`, called `what` in messages, which must have `columns` columns.
    ///
    /// # Errors
    /// If it has others, or is not C-contiguous.
    pub fn of(array: &PyReadonlyArray2<'_, f64>, what: &str, columns: usize) -> PyResult<Self> {
        let found = array.shape()[1];
        if found != columns {
            return Err(JointwiseError::new_err(format!(
                "{what} has {found} columns, and the arm has {columns} joints; give one column per joint"
            )));
        }
        let values = array.as_slice()?.to_vec();
        Ok(Self { values, columns })
    }

    /// The number of rows.
    pub fn len(&self) -> usize {
        self.values.len() / self.columns
    }

    /// The values of one row.
    pub fn row(&self, row: usize) -> &[f64] {
        &self.values[row * self.columns..][..self.columns]
    }
}

/// All of `given` as rows of the arm's joints, of which there must be as many in each.
///
/// # Errors
/// If the columns are not the joints, or the numbers of rows differ.
pub fn rows<const N: usize>(arm: &Arm, given: [(&str, &PyReadonlyArray2<'_, f64>); N]) -> PyResult<[Rows; N]> {
    let mut list = Vec::with_capacity(N);
    for (what, array) in given {
        let rows = Rows::of(array, what, arm.dof())?;
        if let Some((first, other)) = list.first().map(|first: &Rows| (first.len(), given[0].0))
            && first != rows.len()
        {
            return Err(JointwiseError::new_err(format!(
                "{what} has {} rows, and {other} has {first}; give one row per sample in each",
                rows.len()
            )));
        }
        list.push(rows);
    }
    list.try_into().map_err(|_| JointwiseError::new_err("arrays were lost on the way"))
}

/// A flat array of one row with `width` numbers per sample; `of` computes it from the sample's rows of `given`. A row's numbers do not
/// depend on the other rows.
pub fn map_rows<'py, W: Send, const N: usize>(
    py: Python<'py>,
    arm: &Arm,
    given: [(&str, &PyReadonlyArray2<'_, f64>); N],
    width: usize,
    workspace: impl Fn() -> W + Sync + Send,
    of: impl Fn(&mut W, [&[f64]; N], &mut [f64]) + Sync + Send,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let signals = rows(arm, given)?;
    let mut values = vec![0.0; signals[0].len() * width];
    py.detach(|| {
        let blocks = values.par_chunks_mut(BLOCK * width.max(1)).enumerate();
        blocks.for_each_init(workspace, |workspace, (block, values)| {
            for (k, row) in values.chunks_exact_mut(width.max(1)).enumerate() {
                of(workspace, signals.each_ref().map(|signal| signal.row(block * BLOCK + k)), row);
            }
        });
    });
    Ok(flat(py, values))
}

/// `values` as a flat NumPy array, which the Python side gives its shape.
pub fn flat(py: Python<'_>, values: Vec<f64>) -> Bound<'_, PyArray1<f64>> {
    PyArray1::from_vec(py, values)
}
