"""MuJoCo in the closed loop that our plant's example recorded: error and time of a millisecond, by integrator and step.

usage: simulate.py ROBOT.urdf TRACK.csv
"""

import json
import math
import sys
import time

import mujoco
import numpy as np
from mujoco import rollout


def model_of(path):
    text = open(path, encoding="utf-8").read()
    at = text.index(">", text.index("<robot")) + 1
    return mujoco.MjModel.from_xml_string(text[:at] + '<mujoco><compiler discardvisual="true"/></mujoco>' + text[at:])


def error(model, steps, gains, start, table):
    """The largest distance from the exact positions, with the torque of each millisecond held over `steps` steps."""
    n = model.nv
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = start
    model.opt.timestep = 1e-3 / steps
    worst = 0.0
    for row in table:
        wanted, speed, torque, exact = row[:n], row[n : 2 * n], row[2 * n : 3 * n], row[3 * n :]
        feedback = gains[0] * (wanted - data.qpos) + gains[1] * (speed - data.qvel)
        data.qfrc_applied[:] = torque + feedback
        mujoco.mj_step(model, data, nstep=steps)
        worst = max(worst, float(np.abs(data.qpos - exact).max()))
        if not worst < 1.0:
            return float("inf")
    return worst


def step_time(model, count=300):
    """Nanoseconds of a step: the median of runs so short that few are disturbed."""
    data = mujoco.MjData(model)
    size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    state = np.zeros((1, size))
    times = []
    for _ in range(41):
        begun = time.perf_counter()
        rollout.rollout(model, data, state, nstep=count)
        times.append((time.perf_counter() - begun) / count * 1e9)
    return sorted(times)[20]


def main():
    model = model_of(sys.argv[1])
    rows = np.loadtxt(sys.argv[2], delimiter=",")
    n = model.nv
    gains, start, table = rows[0, : 2 * n].reshape(2, n), (rows[1, :n], rows[1, n : 2 * n]), rows[2:]
    found = {}
    for name, integrator in (
        ("implicitfast", mujoco.mjtIntegrator.mjINT_IMPLICITFAST),
        ("rk4", mujoco.mjtIntegrator.mjINT_RK4),
    ):
        model.opt.integrator = integrator
        steps, found[name] = 1, []
        while steps < 10000:
            worst = error(model, steps, gains, start, table)
            found[name].append({"steps": steps, "error": worst, "ns": steps * step_time(model)})
            if worst <= 1e-6:
                break
            # An error of first order; a hundredth more, so that it suffices.
            steps = math.ceil(1.01 * steps * worst / 1e-6)
    print(json.dumps(found))


if __name__ == "__main__":
    main()
