"""What the tests have in common: robots, cases, and motions of our own."""

import os
import pathlib
import subprocess

import numpy as np
import pytest

import jointwise

ROOT = pathlib.Path(__file__).resolve().parents[3]
CASES = ROOT / "tests" / "cases"
ARM = CASES / "arm.urdf"


def motion(times, joints, seed=0):
    """Positions, velocities and accelerations (n, joints) of a sum of sines."""
    rng = np.random.default_rng(seed)
    t = np.asarray(times)[:, None]
    q = qd = qdd = 0.0
    for frequency in (0.23, 0.41, 0.67):
        amplitude = rng.uniform(0.2, 0.5, joints)
        phase = rng.uniform(0.0, 2.0 * np.pi, joints)
        omega = 2.0 * np.pi * frequency * rng.uniform(0.9, 1.1, joints)
        q = q + amplitude * np.sin(omega * t + phase)
        qd = qd + amplitude * omega * np.cos(omega * t + phase)
        qdd = qdd - amplitude * omega**2 * np.sin(omega * t + phase)
    return q, qd, qdd


VISCOUS = 1.5
COULOMB = 2.0


def recording(seed):
    """25 s at 100 Hz of the arm with viscous and Coulomb friction on its first joint, as arrays."""
    dynamics = jointwise.InverseDynamics(ARM)
    rng = np.random.default_rng(1000 + seed)
    t = 0.01 * np.arange(2500)
    q, qd, qdd = motion(t, len(dynamics.joints), seed)
    tau = dynamics.torque(q, qd, qdd)
    tau[:, 0] += VISCOUS * qd[:, 0] + COULOMB * np.sign(qd[:, 0])
    tau += rng.normal(0.0, 0.02, tau.shape)
    q = q + rng.normal(0.0, 1e-5, q.shape)
    return {"t": t, "q": q, "tau": tau}


def frame(arrays):
    """The recording of arrays as a data frame."""
    pandas = pytest.importorskip("pandas")
    joints = jointwise.InverseDynamics(ARM).joints
    columns = {"t": arrays["t"]}
    for key in ("q", "tau"):
        columns.update({f"{key}_{joint}": arrays[key][:, k] for k, joint in enumerate(joints)})
    return pandas.DataFrame(columns)


@pytest.fixture(scope="session")
def recordings():
    """For training and held out."""
    return recording(1), recording(2)


@pytest.fixture(scope="session")
def found(recordings):
    """Their diagnosis."""
    train, held_out = recordings
    return jointwise.diagnose(ARM, train=[train], held_out=[held_out], torques_only=True)


@pytest.fixture(scope="session")
def testbed():
    """Runs the built program in the repository's root."""
    built = [ROOT / "target" / profile / "testbed" for profile in ("release", "debug")]
    given = os.environ.get("TESTBED")
    program = pathlib.Path(given) if given else next((path for path in built if path.exists()), None)
    if program is None:
        pytest.skip("the program is not built (cargo build --release -p testbed --no-default-features)")

    def run(*arguments):
        subprocess.run([program, *map(str, arguments)], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)

    return run
