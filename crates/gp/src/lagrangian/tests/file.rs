//! Files of models: a model is read as it was saved, and other files are refused.

use super::fit::{options, pendulum};
use super::*;

#[test]
fn a_saved_model_is_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("model.json");
    let zero = TorqueSamples::new(&JOINTS, [&[0.1; 8], &[0.2; 8], &[0.3; 8]], &[0.0; 8]).expect("valid");
    for samples in [pendulum(60, 0.3, 0.0, 0.0), pendulum(60, 0.3, 0.0, 0.2), zero] {
        let gp = LagrangianGp::fit(&samples, &options(20)).expect("it fits");
        gp.save(&path).expect("it can be written");
        let read = LagrangianGp::load(&path).expect("it can be read");
        let of = |gp: &LagrangianGp| {
            let dof = gp.dof();
            let (mut mean, mut variance) = (vec![0.0; dof], vec![0.0; dof]);
            let motion = [0.4, -0.1, 0.9, 0.2];
            let motion: [&[f64]; 3] = [&motion[..dof]; 3];
            gp.mean(motion, &mut gp.workspace(), &mut mean);
            gp.variance(motion, &mut gp.workspace(), &mut variance);
            let share = gp.range().variance_share(0, &mut {
                let mut workspace = gp.workspace();
                gp.mean(motion, &mut workspace, &mut vec![0.0; dof]);
                workspace
            });
            (mean, variance, share)
        };
        assert_eq!(of(&gp), of(&read));
        assert_eq!((gp.prior(), gp.noise(), gp.conditioning()), (read.prior(), read.noise(), read.conditioning()));
        assert_eq!(gp.log_marginal_likelihood(), read.log_marginal_likelihood());
    }
    let text = std::fs::read_to_string(&path).expect("it is there");
    for (from, to, expected) in [
        ("testbed.lagrangian/1", "testbed.lagrangian/2", "expected \"testbed.lagrangian/1\""),
        ("\"noise\":[0.0,", "\"noise\":[", "noise has 3 entries, expected 4"),
        ("\"kinetic\":[0.0,", "\"kinetic\":[-1.0,", "kinetic is -1: it must be finite and not negative"),
        ("\"potential\":[0.0,", "\"potential\":[", "potential has 3 entries, expected 4"),
        ("\"weights\":[0.0,", "\"weights\":[", "4 motions and 3 weights of 4 joints"),
        ("\"units\":[1.0,", "\"units\":[0.0,", "units has the entry 0"),
        ("\"projected\":null", "\"projected\":null,\"more\":1", "unknown field `more`"),
    ] {
        assert!(text.contains(from), "no {from} in {text}");
        std::fs::write(&path, text.replacen(from, to, 1)).expect("it can be written");
        let message = LagrangianGp::load(&path).expect_err("it is refused").to_string();
        assert!(message.contains(expected) && message.contains("model.json"), "{message}");
    }
    let missing = LagrangianGp::load(folder.path().join("none.json")).expect_err("it is refused");
    assert!(matches!(missing, GpError::File { .. }));
}
