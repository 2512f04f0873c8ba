//! No algorithm allocates when it is called.

use arm::{Arm, DMatrix, Matrix6xX, Workspace};

#[test]
fn no_call_allocates() {
    let arm = Arm::from_urdf(concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/puma560.urdf")).expect("it loads");
    let n = arm.dof();
    let mut workspace = Workspace::new(&arm);
    let (q, qd, qdd) = (vec![0.1; n], vec![0.2; n], vec![0.3; n]);
    let mut tau = vec![0.0; n];
    let mut features = vec![[0.0; arm::FEATURES]; n];
    let mut mass_matrix = DMatrix::zeros(n, n);
    let mut regressor = DMatrix::zeros(n, 10 * n);
    let mut jacobian = Matrix6xX::zeros(n);
    let tool = arm.tool_frame();
    let counted = allocation_counter::measure(|| {
        arm.inverse_dynamics(&mut workspace, &q, &qd, &qdd, &mut tau);
        arm.newton_euler_features(&mut workspace, &q, &qd, &qdd, &mut tau, &mut features);
        arm.bias_torque(&mut workspace, &q, &qd, &mut tau);
        arm.gravity_torque(&mut workspace, &q, &mut tau);
        arm.forward_dynamics(&mut workspace, &q, &qd, &qdd, &mut tau);
        arm.mass_matrix(&mut workspace, &q, &mut mass_matrix);
        arm.torque_regressor(&mut workspace, &q, &qd, &qdd, &mut regressor);
        arm.jacobian(&mut workspace, &q, &tool, &mut jacobian);
        arm.kinetic_energy(&mut workspace, &q, &qd);
        arm.potential_energy(&mut workspace, &q);
    });
    assert_eq!(counted.count_total, 0);
}
