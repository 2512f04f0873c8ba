#!/usr/bin/env python3
"""Compares the torques of an MJCF file in MuJoCo (mj_inverse) with those of testbed's model along a motion.

usage: pip install mujoco numpy; python3 mjcf_in_mujoco.py ROBOT.xml MOTION.csv

MOTION.csv has no header, and a row per state: q, qd, qdd, tau of all joints. Prints the largest difference of a torque,
divided by the largest torque of its joint along the motion; fails if it is above 1e-6. The test mjcf_file::tests calls it.
"""
import sys

import mujoco
import numpy as np

model = mujoco.MjModel.from_xml_path(sys.argv[1])
data = mujoco.MjData(model)
rows = np.loadtxt(sys.argv[2], delimiter=",", ndmin=2)
n = model.nv
assert rows.shape[1] == 4 * n, f"{rows.shape[1]} columns for {n} joints"
found = np.empty((len(rows), n))
for k, row in enumerate(rows):
    data.qpos[:], data.qvel[:], data.qacc[:] = row[:n], row[n : 2 * n], row[2 * n : 3 * n]
    mujoco.mj_inverse(model, data)
    found[k] = data.qfrc_inverse
expected = rows[:, 3 * n :]
difference = np.abs(found - expected) / np.abs(expected).max(axis=0)
joint = int(difference.max(axis=0).argmax()) + 1
print(f"largest relative difference {difference.max():.1e} in {len(rows)} states (joint {joint})")
sys.exit(int(not difference.max() < 1e-6))
