#!/usr/bin/env python3
"""Writes the reference derivatives that crates/arm/tests/pinocchio.rs checks against.

usage: pip install pin numpy; python3 derivatives.py

For each robot, <robot>_derivatives.bin holds 50 random states, each a row of little-endian f64:
    q, qd, qdd                          n each
    dtau/dq, dtau/dqd                   n * n each, row by row: computeRNEADerivatives
"""
import pathlib
import numpy as np
import pinocchio as pin

here = pathlib.Path(__file__).parent
robots = {
    "puma560": here.parents[3] / "assets/puma560.urdf",
    "seven_axis": here.parent / "robots/seven_axis.urdf",
    "prismatic": here.parent / "robots/prismatic.urdf",
}
for name, urdf in robots.items():
    model = pin.buildModelFromUrdf(str(urdf))
    data = model.createData()
    random = np.random.default_rng(561)
    rows = []
    for _ in range(50):
        q, qd, qdd = random.uniform(-3, 3, (3, model.nv))
        pin.computeRNEADerivatives(model, data, q, qd, qdd)
        rows.append(np.concatenate([q, qd, qdd, data.dtau_dq.ravel(), data.dtau_dv.ravel()]))
    np.array(rows, dtype="<f8").tofile(here / f"{name}_derivatives.bin")
    print(name, len(rows[0]), "values per state; Pinocchio", pin.__version__)
