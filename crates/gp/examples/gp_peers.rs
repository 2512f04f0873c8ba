//! Times of a fit as JSON, for `benches/peers.sh`. Inputs: `fit TABLE.csv STARTS`; the table's last column is the target.

use std::time::Instant;

use gp::{FitOptions, Gp, TrainingSet};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [mode, table, number] = arguments.as_slice() else {
        panic!("usage: gp_peers fit TABLE.csv STARTS");
    };
    assert_eq!(mode, "fit", "usage: gp_peers fit TABLE.csv STARTS");
    let training = read(table);
    let options = FitOptions {
        starts: number.parse().expect("the number of starts"),
        ..FitOptions::default()
    };
    let start = Instant::now();
    let gp = Gp::fit(&training, &options).expect("it fits");
    println!(
        "{{\"seconds\": {:.6}, \"likelihood\": {:.6}, \"rank\": {}}}",
        start.elapsed().as_secs_f64(),
        gp.log_marginal_likelihood(),
        gp.rank()
    );
}

fn read(path: &str) -> TrainingSet {
    let text = std::fs::read_to_string(path).expect("the table can be read");
    let (mut inputs, mut targets) = (Vec::new(), Vec::new());
    for line in text.lines().skip(1) {
        let mut row: Vec<f64> = line.split(',').map(|field| field.parse().expect("a number")).collect();
        targets.extend(row.pop());
        inputs.extend(row);
    }
    TrainingSet::new(inputs.len() / targets.len(), &inputs, &targets).expect("the table is valid")
}
