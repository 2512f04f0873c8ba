"""FIGAROH's identification of recordings: base parameters, viscous and Coulomb friction, drive inertia and offset.

usage: identify.py ROBOT.urdf TRAIN.csv… HELD_OUT.csv

The recordings have testbed's columns. Positions are filtered without lag and differentiated centrally; FIGAROH builds the regressor by
Pinocchio, and eliminates and regroups its columns; regressor and torque are decimated by ten, as it does by default; the solution is by
weighted least squares.
"""

import contextlib
import io
import json
import sys
import time
import warnings

import numpy as np
from scipy.signal import butter, decimate, filtfilt

CUTOFF = 20.0


def read(path):
    with open(path) as file:
        header = file.readline().strip().split(",")
    table = np.loadtxt(path, delimiter=",", skiprows=1)
    of = lambda prefix: table[:, [k for k, name in enumerate(header) if name.startswith(prefix)]]
    return table[:, 0], of("q_"), of("tau_")


def processed(path):
    t, q, tau = read(path)
    period = np.median(np.diff(t))
    low = butter(5, CUTOFF * 2 * period)
    q = filtfilt(*low, q, axis=0)
    v = np.gradient(q, period, axis=0)
    a = np.gradient(v, period, axis=0)
    inner = slice(100, -100)
    return q[inner], v[inner], a[inner], tau[inner]


def main():
    from figaroh.tools.load_robot import load_robot
    from figaroh.tools.qrdecomposition import QRDecomposer
    from figaroh.tools.regressor import RegressorBuilder, RegressorConfig, build_regressor_reduced, get_index_eliminate

    urdf, *train, held_out = sys.argv[1:]
    begun = time.perf_counter()
    robot = load_robot(urdf, load_by_urdf=True)
    builder = RegressorBuilder(robot, RegressorConfig(has_friction=True, has_actuator_inertia=True, has_joint_offset=True))
    n = robot.model.nv

    def stacked(path):
        q, v, a, tau = processed(path)
        w = builder.build_basic_regressor(q, v, a, {"act_idxv": list(range(n))})
        # Rows are grouped by joint.
        fewer = lambda values: decimate(values, 10, axis=0, zero_phase=True)
        return [fewer(w[j * len(q) : (j + 1) * len(q)]) for j in range(n)], [fewer(tau[:, j]) for j in range(n)]

    parts = [stacked(path) for path in train]
    w = np.vstack([np.vstack([part[0][j] for part in parts]) for j in range(n)])
    y = np.concatenate([np.concatenate([part[1][j] for part in parts]) for j in range(n)])
    rows = [sum(len(part[1][j]) for part in parts) for j in range(n)]
    names = {f"c{k}": 1.0 for k in range(w.shape[1])}
    eliminated, kept = get_index_eliminate(w, names, 1e-6)
    reduced = build_regressor_reduced(w, eliminated)
    base, _ = QRDecomposer().decompose_with_pivoting(y, reduced, list(kept))[:2]
    # The residuals of each joint weight its rows.
    solve = lambda matrix, right: np.linalg.lstsq(matrix, right, rcond=None)[0]
    independent = np.asarray(base)
    first = independent @ solve(independent, y)
    sizes = np.concatenate([np.full(count, part.std()) for part, count in zip(np.split(y - first, np.cumsum(rows)[:-1]), rows)])
    solution = solve(reduced / sizes[:, None], y / sizes)
    seconds = time.perf_counter() - begun

    blocks, tau = stacked(held_out)
    error = [float(np.sqrt(np.mean((build_regressor_reduced(b, eliminated) @ solution - t) ** 2)) / t.std()) for b, t in zip(blocks, tau)]
    return {"seconds": seconds, "columns": int(independent.shape[-1]), "held_out": error}


if __name__ == "__main__":
    with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()):
        warnings.simplefilter("ignore")
        answer = main()
    print(json.dumps(answer))
