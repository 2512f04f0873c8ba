#!/usr/bin/env python3
"""Writes the reference values that crates/arm/tests/pinocchio.rs checks against.

usage: pip install pin cmeel-eigen numpy; python3 generate.py

For each robot, <robot>.bin holds 1000 random states, each a row of little-endian f64:
    q, qd, qdd, tau                     n each; position, velocity, acceleration, torque (inputs)
    R (9, row by row), p (3)            pose of the tool frame in the root frame
    J qd                                6; twist of the tool, angular part first, root axes
    rnea(q, qd, qdd)                    n
    rnea(q, qd, 0), rnea(q, 0, 0)       n each
    aba(q, qd, tau)                     n
    M(q)                                n (n + 1) / 2; lower triangle, row by row
    Y(q, qd, qdd) p                     n; torque regressor times p_k = sin(k + 1)
    features(q, qd, qdd) w              n; for joint i, the sum of sin(k + 1) times the k-th of
                                        omega_i, domega_i (link i's frame), moment and force on link i + 1 (its frame)
"""
import pathlib
import numpy as np
import pinocchio as pin

here = pathlib.Path(__file__).parent
root = here.parents[3]
robots = {
    "puma560": (root / "assets/puma560.urdf", "link6"),
    "seven_axis": (here.parent / "robots/seven_axis.urdf", "tool"),
    "prismatic": (here.parent / "robots/prismatic.urdf", "tool"),
}


def features(model, data, q, qd, qdd):
    """The twelve Newton-Euler features of each joint: omega, domega, moment and force of the next."""
    pin.rnea(model, data, q, qd, qdd)
    rows = []
    for i in range(1, model.njoints):
        distal = data.f[i + 1] if i + 1 < model.njoints else pin.Force.Zero()
        rows.append(np.concatenate([data.v[i].angular, data.a_gf[i].angular, distal.angular, distal.linear]))
    return np.array(rows)


for name, (urdf, tool) in robots.items():
    model = pin.buildModelFromUrdf(str(urdf))
    data = model.createData()
    frame = model.getFrameId(tool)
    n = model.nv
    random = np.random.default_rng(560)
    lower = np.tril_indices(n)
    p = np.sin(np.arange(10 * n) + 1.0)
    rows = []
    for _ in range(1000):
        q, qd, qdd = random.uniform(-3, 3, (3, n))
        tau = random.uniform(-30, 30, n)
        pin.framesForwardKinematics(model, data, q)
        pose = data.oMf[frame]
        jacobian = pin.computeFrameJacobian(model, data, q, frame, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
        twist = jacobian @ qd
        mass_matrix = pin.crba(model, data, q)
        mass_matrix = np.triu(mass_matrix) + np.triu(mass_matrix, 1).T
        rows.append(np.concatenate([
            q, qd, qdd, tau,
            pose.rotation.ravel(), pose.translation,
            twist[3:], twist[:3],
            pin.rnea(model, data, q, qd, qdd),
            pin.rnea(model, data, q, qd, 0 * q),
            pin.rnea(model, data, q, 0 * q, 0 * q),
            pin.aba(model, data, q, qd, tau),
            mass_matrix[lower],
            pin.computeJointTorqueRegressor(model, data, q, qd, qdd) @ p,
            features(model, data, q, qd, qdd) @ np.sin(np.arange(12) + 1.0),
        ]))
    np.array(rows, dtype="<f8").tofile(here / f"{name}.bin")
    print(name, n, "joints,", len(rows[0]), "values per state; Pinocchio", pin.__version__)
