//! Makes one long recording of a simulated arm with known effects: an hour at 1 kHz, in 144 motions of 25 s with pauses of 5 s.
//!
//! ```sh
//! cargo run --release -p faults --example hour -- OUT [MOTIONS [SEED]]
//! ```

use std::path::Path;

use faults::{Injected, Robot, Settings, conceal_effects};
use recording::Recording;

/// An hour of motion.
const MOTIONS: usize = 144;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |at: usize, usual: usize| arguments.get(at).map_or(Ok(usual), |text| text.parse::<usize>());
    let out = arguments.first().ok_or("usage: OUT [MOTIONS [SEED]]")?;
    let (motions, seed) = (number(1, MOTIONS)?, number(2, 6)?);
    let robot = Robot::new(include_str!("../../../assets/seven_axis.urdf"), "seven_axis.urdf")?;
    let settings = Settings {
        seed: seed as u64,
        rate: 1000,
        training: motions,
        background_friction: true,
        urdf_error: 0.03,
        ..Settings::default()
    };
    // The load is taken up after five sixths of the time.
    let effects = [
        Injected::new("torque_offset", Some("axis1")).with("offset", 1.5),
        Injected::new("stribeck_friction", Some("axis2"))
            .with("coulomb", 2.4)
            .with("breakaway", 5.0)
            .with("velocity", 0.08),
        Injected::new("thermal_drift", Some("axis4"))
            .with("coulomb", 1.2)
            .with("amplitude", 0.8)
            .with("time_constant", 900.0),
        Injected {
            onset: Some(25.0 * motions as f64),
            ..Injected::new("payload", None).with("mass", 0.5).with("com", vec![0.01, 0.0, 0.05])
        },
    ];
    let made = conceal_effects(&robot, "hour", &effects, &settings)?;
    let out = Path::new(out);
    std::fs::create_dir_all(out)?;
    std::fs::write(out.join("robot.urdf"), &made.urdf)?;
    std::fs::write(out.join("truth.json"), serde_json::to_string_pretty(&made.truth)?)?;
    joined(made.train).write_csv(&out.join("train.csv"))?;
    made.held_out.write_csv(&out.join("held_out.csv"))?;
    Ok(())
}

/// One recording of all `parts`, which share a clock.
fn joined(parts: Vec<Recording>) -> Recording {
    let mut parts = parts.into_iter();
    let mut whole = parts.next().unwrap_or_default();
    for part in parts {
        whole.time.extend(part.time);
        let signals = [(&mut whole.q, part.q), (&mut whole.tau, part.tau)];
        let velocities = whole.qd.as_mut().zip(part.qd);
        for (whole, part) in signals.into_iter().chain(velocities) {
            whole.iter_mut().zip(part).for_each(|(whole, part)| whole.extend(part));
        }
    }
    whole
}
