//! Named arrays with a row per sample, and the table that they make.

use crate::input::Input;
use crate::table::{Column, Table};
use crate::{RecordingError, Warning};

/// An array of one or two dimensions.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Its name.
    pub name: String,
    /// The numbers of rows and columns.
    pub shape: (usize, usize),
    /// Whether `values` are stored row after row, or else column after column.
    pub by_rows: bool,
    /// The values, rows times columns.
    pub values: Column,
}

impl Array {
    /// Its columns, or its rows if `transposed`.
    fn columns(&self, transposed: bool) -> Vec<Column> {
        let (rows, columns) = self.shape;
        let (samples, series) = if transposed { (columns, rows) } else { (rows, columns) };
        let index = |sample: usize, series: usize| {
            let (row, column) = if transposed { (series, sample) } else { (sample, series) };
            if self.by_rows { row * columns + column } else { column * rows + row }
        };
        (0..series).map(|series| self.values.picked((0..samples).map(|sample| index(sample, series)))).collect()
    }
}

/// The table of all arrays that have a value (or a row) for each sample; the number of samples is the length of the
/// longest vector. The columns of an array with several are named `name[0]` and so on.
///
/// # Errors
/// [`RecordingError::Format`] if there is no vector.
pub fn table(input: &Input, format: &'static str, arrays: &[Array]) -> Result<Table, RecordingError> {
    let vectors = arrays.iter().filter(|array| array.shape.0 == 1 || array.shape.1 == 1);
    let samples = vectors.map(|array| array.shape.0.max(array.shape.1)).max().unwrap_or(0);
    if samples < 2 {
        let names: Vec<&str> = arrays.iter().map(|array| array.name.as_str()).collect();
        let reason = format!(
            "no array of numbers is a vector with a value per sample; save t, and q and tau with a column per joint; its arrays are {}",
            if names.is_empty() { "none".to_owned() } else { names.join(", ") }
        );
        return Err(input.error(format, reason));
    }
    let (mut columns, mut left_out) = (Vec::new(), Vec::new());
    for array in arrays {
        let transposed = match array.shape {
            (rows, _) if rows == samples => false,
            (_, columns) if columns == samples => true,
            (rows, columns) if ["q", "tau"].contains(&array.name.as_str()) => {
                let reason = format!(
                    "{} has {rows} rows and {columns} columns, and the longest vector has {samples} values; save a row of {0} for \
                     each sample",
                    array.name
                );
                return Err(input.error(format, reason));
            }
            _ => {
                left_out.push(array.name.as_str());
                continue;
            }
        };
        let mut found = array.columns(transposed);
        if found.len() == 1 {
            columns.extend(found.pop().map(|column| (array.name.clone(), column)));
        } else {
            let named = found.into_iter().enumerate();
            columns.extend(named.map(|(index, column)| (format!("{}[{index}]", array.name), column)));
        }
    }
    let mut table = Table::of_columns(columns);
    if !left_out.is_empty() {
        let what = format!("left out, because they have not {samples} rows: {}", left_out.join(", "));
        table.warnings.push(Warning::LeftOut { what });
    }
    Ok(table)
}
