//! The tables of `testbed transfer` as text for the terminal.

use report::numbers::rounded;

use super::{Harm, Row, Transfer, short};
use crate::tables::mean;

/// The report.
pub fn text(transfer: &Transfer) -> String {
    let joints = transfer.joints.iter().cloned();
    let mut text = format!(
        "{}: RMS torque error on a task that the model was not trained on, relative to that of the rigid body alone (1: \
         nothing learned)\n",
        transfer.model.title()
    );
    let header = ["train", "test"].map(str::to_owned).into_iter();
    let header =
        header.chain(joints.clone()).chain(["mean".to_owned(), "predicted".to_owned(), "likelihood".to_owned()]);
    let mut table = report::terminal::table(header);
    for row in &transfer.rows {
        let mut cells = vec![names(&row.train), short(&row.test)];
        let parts = parts(row, &row.error);
        cells.extend(parts.iter().map(|part| rounded(*part, 2)));
        cells.push(rounded(mean(&parts), 2));
        cells.push(rounded(mean(&self::parts(row, &row.predicted)), 2));
        cells.push(rounded(mean(&row.likelihood), 3));
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
        cells.extend(values.iter().map(|value| rounded(*value, 2)));
        cells.push(rounded(mean(values), 2));
        table.add_row(cells);
    }
    text += &format!("{table}\n\n");
    text + &harm(transfer)
}

/// The errors of `row` in units of the rigid body's.
fn parts(row: &Row, errors: &[f64]) -> Vec<f64> {
    errors.iter().zip(&row.rigid).map(|(error, rigid)| error / rigid).collect()
}

fn names(tasks: &[String]) -> String {
    tasks.iter().map(|task| short(task)).collect::<Vec<_>>().join(", ")
}

/// A line for each task that makes an error larger.
fn harm(transfer: &Transfer) -> String {
    if transfer.harm.is_empty() {
        return "No task makes the error of a joint on another task larger by 5 %.\n".into();
    }
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
            short(&first.added),
            names(&first.train),
            short(&first.test),
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
