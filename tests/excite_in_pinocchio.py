"""Checks the references that `testbed excite --csv` wrote, with Pinocchio and NumPy in place of testbed's own code.

pip install numpy pin
testbed excite --robot robot.urdf --csv excite.csv
python tests/excite_in_pinocchio.py robot.urdf excite.csv [recording.csv ...]

Checked: velocities and accelerations are derivatives of the positions; the motion begins and ends at rest, where it began; positions,
velocities and torques are within the URDF's limits. Printed: the rank of the regressor over random states, and the condition number of
the base regressor with the columns of friction and drive inertia, of the references and of the recordings. Exits with status 1 if a
check fails.
"""

import csv
import sys

import numpy as np
import pinocchio as pin

PER_LINK = 10


def columns(path):
    with open(path) as file:
        rows = list(csv.reader(file))
    return dict(zip(rows[0], np.array(rows[1:], dtype=float).T))


def regressor(model, data, q, qd, qdd, rest):
    """Rows of all samples: inertial parameters of the links, then viscous and Coulomb friction, then drive inertia."""
    n = model.nv
    blocks = []
    for sample in range(len(q)):
        inertial = pin.computeJointTorqueRegressor(model, data, q[sample], qd[sample], qdd[sample])
        own = [np.diag(qd[sample]), np.diag(np.tanh(qd[sample] / rest)), np.diag(qdd[sample])]
        blocks.append(np.hstack([inertial, *own]))
    return np.vstack(blocks), PER_LINK * n


def independent(rows):
    """The columns that no earlier ones explain."""
    chosen, basis = [], np.zeros((rows.shape[0], 0))
    sizes = np.linalg.norm(rows, axis=0)
    for column in range(rows.shape[1]):
        if sizes[column] <= 1e-12 * sizes.max():
            continue
        left = rows[:, column].copy()
        for _ in range(2):
            left -= basis @ (basis.T @ left)
        if np.linalg.norm(left) > 1e-7 * sizes[column]:
            chosen.append(column)
            basis = np.column_stack([basis, left / np.linalg.norm(left)])
    return chosen


def conditions(rows):
    values = np.linalg.svd(rows, compute_uv=False)
    scaled = np.linalg.svd(rows / np.linalg.norm(rows, axis=0), compute_uv=False)
    return values[0] / values[-1], scaled[0] / scaled[-1]


def low_pass(signal, rate, cutoff=10.0):
    """A Gaussian filter without phase."""
    width = int(round(0.1325 * rate / cutoff * 4)) * 2 + 1
    time = (np.arange(width) - width // 2) / rate
    kernel = np.exp(-0.5 * (time * 2 * np.pi * cutoff / np.sqrt(np.log(2))) ** 2)
    kernel /= kernel.sum()
    return np.apply_along_axis(lambda column: np.convolve(column, kernel, mode="valid"), 0, signal)


def main():
    if len(sys.argv) < 3 or sys.argv[1] in ("-h", "--help"):
        sys.exit(__doc__)
    urdf, path, *recordings = sys.argv[1:]
    model = pin.buildModelFromUrdf(urdf)
    data = model.createData()
    names = list(model.names)[1:]
    table = columns(path)
    pick = lambda prefix: np.column_stack([table[prefix + name] for name in names])
    q, qd, qdd, time = pick("q_"), pick("qd_"), pick("qdd_"), table["t"]
    rate = 1.0 / np.median(np.diff(time))
    failures = []

    def check(what, holds):
        print(f"{'ok  ' if holds else 'FAIL'} {what}")
        if not holds:
            failures.append(what)

    speeds = (q[2:] - q[:-2]) * rate / 2
    quick = (qd[2:] - qd[:-2]) * rate / 2
    check("qd is the derivative of q", np.abs(speeds - qd[1:-1]).max() < 2e-3 * np.abs(qd).max())
    check("qdd is the derivative of qd", np.abs(quick - qdd[1:-1]).max() < 5e-3 * np.abs(qdd).max())
    check("it begins and ends at rest", max(np.abs(signal[[0, -1]]).max() for signal in (qd, qdd)) < 1e-6)
    check("it ends where it began", np.abs(q[0] - q[-1]).max() < 1e-6)
    torques = np.array([pin.rnea(model, data, q[k], qd[k], qdd[k]) for k in range(len(q))])
    for j, name in enumerate(names):
        lower, upper = model.lowerPositionLimit[j], model.upperPositionLimit[j]
        within = q[:, j].min() >= lower and q[:, j].max() <= upper
        check(f"{name}: position {q[:, j].min():.3f} to {q[:, j].max():.3f} of {lower:.3f} to {upper:.3f}", within)
        for what, signal, limit in [
            ("speed", qd, model.velocityLimit[j]),
            ("torque", torques, model.effortLimit[j]),
        ]:
            most = np.abs(signal[:, j]).max()
            check(f"{name}: {what} {most:.3f} of {limit:.3f} ({100 * most / limit:.0f} %)", most <= limit)

    random = np.random.default_rng(1)
    low, high = model.lowerPositionLimit, model.upperPositionLimit
    states = [low + (high - low) * random.random((150, model.nq))]
    states += [size * (2 * random.random((150, model.nv)) - 1) for size in (model.velocityLimit, 5 * model.velocityLimit)]
    rest = 0.008 * model.velocityLimit
    rows, inertial = regressor(model, data, *states, rest)
    chosen = independent(rows)
    count = sum(column < inertial for column in chosen)
    print(f"base parameters: {len(chosen)}, of which {count} of the {inertial} inertial parameters")
    step = max(1, int(rate / 50))
    rows, _ = regressor(model, data, q[::step], qd[::step], qdd[::step], rest)
    print("condition number, and with scaled columns: %.4g, %.4g  (%s)" % (*conditions(rows[:, chosen]), path))
    for recording in recordings:
        table = columns(recording)
        rate = 1.0 / np.median(np.diff(table["t"]))
        q = low_pass(np.column_stack([table["q_" + name] for name in names]), rate)
        qd = np.gradient(q, 1 / rate, axis=0)
        qdd = np.gradient(qd, 1 / rate, axis=0)
        step = max(1, int(rate / 50))
        rows, _ = regressor(model, data, q[2:-2:step], qd[2:-2:step], qdd[2:-2:step], rest)
        print("condition number, and with scaled columns: %.4g, %.4g  (%s)" % (*conditions(rows[:, chosen]), recording))
    sys.exit(1 if failures else 0)


main()
