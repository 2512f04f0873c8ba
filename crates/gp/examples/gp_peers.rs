//! Processor times of a fit as JSON, for `benches/peers.sh`. Inputs: `fit TABLE.csv STARTS`, or `sparse TRAIN.csv TEST.csv INDUCING`,
//! which also gives the error on the test points; the last column of a table is the target.

use std::time::SystemTime;

use gp::{FitOptions, Gp, LengthScales, TrainingSet};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        ["fit", table, starts] => fit(table, starts.parse().expect("the number of starts")),
        ["sparse", train, test, inducing] => sparse(train, test, inducing.parse().expect("the number of points")),
        _ => panic!("usage: gp_peers fit TABLE.csv STARTS, or gp_peers sparse TRAIN.csv TEST.csv INDUCING"),
    }
}

fn fit(table: &str, starts: usize) {
    let (dim, inputs, targets) = read(table);
    let training = TrainingSet::new(dim, &inputs, &targets).expect("the table is valid");
    let options = FitOptions { starts, ..FitOptions::default() };
    let start = clock();
    let gp = Gp::fit(&training, &options).expect("it fits");
    println!(
        "{{\"seconds\": {:.6}, \"likelihood\": {:.6}, \"rank\": {}}}",
        clock() - start,
        gp.log_marginal_likelihood(),
        gp.rank()
    );
}

fn sparse(train: &str, test: &str, inducing: usize) {
    let (dim, inputs, targets) = read(train);
    let training = TrainingSet::new(dim, &inputs, &targets).expect("the table is valid");
    let options = FitOptions { inducing: Some(inducing), lengths: LengthScales::PerInput, ..FitOptions::default() };
    let start = clock();
    let gp = Gp::fit(&training, &options).expect("it fits");
    let seconds = clock() - start;
    let (_, inputs, targets) = read(test);
    let squares = inputs.chunks_exact(dim).zip(&targets);
    let sum: f64 = squares.map(|(x, y)| (gp.mean(x) - y).powi(2)).sum();
    let error = (sum / targets.len() as f64).sqrt();
    eprintln!("{}", gp.conditioning());
    println!(
        "{{\"seconds\": {seconds:.3}, \"error\": {error:.6}, \"bound\": {:.3}, \"gap\": {:.3}, \"noise\": {:.4}}}",
        gp.log_marginal_likelihood(),
        gp.conditioning().likelihood_gap.unwrap_or(0.0),
        gp.hyperparameters().noise
    );
}

/// Processor time of this thread (s); where the system does not tell it, the time.
fn clock() -> f64 {
    let status = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = status.and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(
        || {
            let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
            now.expect("the clock is right").as_secs_f64()
        },
        |nanoseconds| nanoseconds * 1e-9,
    )
}

/// The number of inputs, the inputs and the targets.
fn read(path: &str) -> (usize, Vec<f64>, Vec<f64>) {
    let text = std::fs::read_to_string(path).expect("the table can be read");
    let (mut inputs, mut targets) = (Vec::new(), Vec::new());
    for line in text.lines().skip(1) {
        let mut row: Vec<f64> = line.split(',').map(|field| field.parse().expect("a number")).collect();
        targets.extend(row.pop());
        inputs.extend(row);
    }
    (inputs.len() / targets.len(), inputs, targets)
}
