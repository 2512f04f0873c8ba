//! The tables of `testbed transfer` as text for the terminal.

use report::numbers::rounded;

use super::{Harm, Labels, Row, Transfer};
use crate::tables::mean;

/// The report.
pub fn text(transfer: &Transfer) -> String {
    let labels = &transfer.labels;
    let joints = transfer.joints.iter().cloned();
    let mut text = format!(
        "{}: RMS torque error on a task that the model was not trained on, relative to that of the rigid body alone (1: \
         nothing learned; –: the rigid body has no error)\n",
        transfer.model.title()
    );
    let header = ["train", "test"].map(str::to_owned).into_iter();
    let header =
        header.chain(joints.clone()).chain(["mean".to_owned(), "predicted".to_owned(), "likelihood".to_owned()]);
    let mut table = report::terminal::table(header);
    for row in &transfer.rows {
        let mut cells = vec![names(labels, &row.train), labels.of(&row.test).to_owned()];
        cells.extend(with_mean(&parts(row, &row.error)));
        cells.push(number(mean_of_known(&parts(row, &row.predicted)), 2));
        cells.push(number(mean(&row.likelihood), 3));
        table.add_row(cells);
    }
    text += &format!("{table}\n");
    text += "predicted: the same ratio as predicted by the model from its variance, without torques of the task. likelihood: log \
             likelihood of the torques of the task, nats per sample, mean over the joints.\n\n";
    text += "Rank correlation with the measured error (1: the same order)\n";
    let mut table =
        report::terminal::table(["of"].map(str::to_owned).into_iter().chain(joints).chain(["mean".to_owned()]));
    for (name, values) in
        [("predicted error", &transfer.correlation.predicted), ("likelihood", &transfer.correlation.likelihood)]
    {
        let mut cells = vec![name.to_owned()];
        cells.extend(with_mean(values));
        table.add_row(cells);
    }
    text += &format!("{table}\n\n");
    text + &harm(transfer)
}

/// The errors of `row` in units of the rigid body's; NaN where that has none.
fn parts(row: &Row, errors: &[f64]) -> Vec<f64> {
    let part = |(error, rigid): (&f64, &f64)| if *rigid > 0.0 { error / rigid } else { f64::NAN };
    errors.iter().zip(&row.rigid).map(part).collect()
}

/// The cells of `values` and of their mean.
fn with_mean(values: &[f64]) -> Vec<String> {
    values.iter().copied().chain([mean_of_known(values)]).map(|value| number(value, 2)).collect()
}

/// The mean of the values that are numbers; NaN if there is none.
fn mean_of_known(values: &[f64]) -> f64 {
    let known: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    mean(&known)
}

/// `digits` digits, or a dash for what is not a number.
fn number(value: f64, digits: usize) -> String {
    if value.is_finite() { rounded(value, digits) } else { "–".to_owned() }
}

fn names(labels: &Labels, tasks: &[String]) -> String {
    tasks.iter().map(|task| labels.of(task)).collect::<Vec<_>>().join(", ")
}

/// A line for each task that makes an error larger.
fn harm(transfer: &Transfer) -> String {
    if transfer.harm.is_empty() {
        return "No task makes the error of a joint on another task larger by 5 %.\n".into();
    }
    let labels = &transfer.labels;
    let mut text = String::from("Data that harm (the error of a joint rises by more than 5 %):\n");
    let mut rest = transfer.harm.as_slice();
    while let Some(first) = rest.first() {
        let same =
            |other: &&Harm| (&other.train, &other.added, &other.test) == (&first.train, &first.added, &first.test);
        let (these, others) = rest.split_at(rest.iter().take_while(same).count());
        rest = others;
        let joints: Vec<String> = these
            .iter()
            .map(|harm| {
                let [without, with] = harm.error.map(|error| rounded(error, 3));
                format!("{} ({without} to {with})", harm.joint)
            })
            .collect();
        text += &format!(
            "- adding {} to {} for {}: {}\n",
            labels.of(&first.added),
            names(labels, &first.train),
            labels.of(&first.test),
            joints.join(", ")
        );
    }
    let count = |said: fn(&Harm) -> bool| transfer.harm.iter().filter(|harm| said(harm)).count();
    text += &format!(
        "The likelihood of the task left out fell in {} of these {} cases, and the predicted error rose in {}.\n",
        count(|harm| harm.likelihood_fell),
        transfer.harm.len(),
        count(|harm| harm.predicted_rose)
    );
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// No error is divided by zero.
    #[test]
    fn an_exact_rigid_body_gives_a_dash() {
        let row = Row {
            train: vec!["A".into()],
            test: "D".into(),
            error: vec![0.5, 0.5, 0.0],
            rigid: vec![2.0, 0.0, 0.0],
            predicted: vec![0.0; 3],
            likelihood: vec![0.0; 3],
        };
        assert_eq!(with_mean(&parts(&row, &row.error)), ["0.25", "–", "–", "0.25"]);
        assert_eq!(number(mean_of_known(&[f64::NAN]), 2), "–");
    }
}
