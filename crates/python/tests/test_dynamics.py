"""Rigid-body dynamics against Pinocchio, and against each other."""

import pickle

import numpy as np
import pytest

import jointwise
from conftest import ARM, ROOT

ROBOTS = sorted((ROOT / "crates" / "arm" / "tests" / "robots").glob("*.urdf")) + [ARM, ROOT / "assets" / "puma560.urdf"]


def state(dynamics, count=50, seed=3):
    rng = np.random.default_rng(seed)
    return rng.uniform(-1.5, 1.5, (3, count, len(dynamics.joints)))


@pytest.mark.parametrize("path", ROBOTS, ids=lambda path: path.stem)
def test_dynamics_are_pinocchios(path):
    pinocchio = pytest.importorskip("pinocchio")
    dynamics = jointwise.InverseDynamics(path)
    model = pinocchio.buildModelFromUrdf(str(path))
    data = model.createData()
    if list(model.names)[1:] != list(dynamics.joints):
        pytest.skip("Pinocchio moves joints that are no part of the arm")
    q, qd, qdd = state(dynamics)
    torque, gravity, mass = dynamics.torque(q, qd, qdd), dynamics.gravity(q), dynamics.mass_matrix(q)
    forward = dynamics.forward(q, qd, torque)
    for k in range(len(q)):
        # A joint without limits has two numbers in Pinocchio.
        position = pinocchio.integrate(model, pinocchio.neutral(model), q[k])
        expected = pinocchio.rnea(model, data, position, qd[k], qdd[k])
        scale = 1.0 + np.abs(expected).max()
        assert np.abs(torque[k] - expected).max() < 1e-10 * scale
        held = pinocchio.computeGeneralizedGravity(model, data, position)
        assert np.abs(gravity[k] - held).max() < 1e-10 * scale
        upper = np.triu(pinocchio.crba(model, data, position))
        assert np.abs(np.triu(mass[k]) - upper).max() < 1e-10 * (1.0 + np.abs(upper).max())
        accelerated = pinocchio.aba(model, data, position, qd[k], torque[k])
        assert np.abs(forward[k] - accelerated).max() < 1e-8 * (1.0 + np.abs(accelerated).max())


@pytest.mark.parametrize("robot", ["puma560", "seven_axis", ARM], ids=str)
def test_the_functions_agree(robot):
    dynamics = jointwise.InverseDynamics(robot)
    dof = len(dynamics.joints)
    # More rows than one block.
    q, qd, qdd = state(dynamics, 700)
    torque = dynamics.torque(q, qd, qdd)
    regressor = dynamics.regressor(q, qd, qdd)
    assert regressor.shape == (700, dof, 10 * dof)
    assert np.allclose(regressor @ dynamics.inertial_parameters, torque, rtol=1e-10, atol=1e-10)
    bias = dynamics.torque(q, qd, np.zeros_like(q))
    mass = dynamics.mass_matrix(q)
    assert np.allclose(np.einsum("nij,nj->ni", mass, qdd) + bias, torque, rtol=1e-9, atol=1e-9)
    assert np.array_equal(mass, np.swapaxes(mass, 1, 2))
    assert np.allclose(dynamics.gravity(q), dynamics.torque(q, 0 * q, 0 * q), rtol=1e-12, atol=1e-12)
    assert np.allclose(dynamics.forward(q, qd, torque), qdd, rtol=1e-6, atol=1e-6)
    # A row does not depend on the others.
    assert np.array_equal(torque[513], dynamics.torque(q[513], qd[513], qdd[513]))


def test_shapes_are_kept_and_broadcast():
    dynamics = jointwise.InverseDynamics("puma560")
    zero = [0.0] * 6
    assert dynamics.torque(zero, zero, zero).shape == (6,)
    assert dynamics.mass_matrix(np.zeros((2, 3, 6))).shape == (2, 3, 6, 6)
    assert dynamics.torque(np.zeros((4, 6)), zero, zero).shape == (4, 6)
    assert dynamics.gravity(np.zeros((0, 6))).shape == (0, 6)
    turned = np.asfortranarray(np.random.default_rng(0).normal(size=(5, 6)))
    assert np.array_equal(dynamics.gravity(turned), dynamics.gravity(turned.copy(order="C")))


def test_the_arm_may_be_chosen_and_pickled():
    whole = jointwise.InverseDynamics("puma560")
    joint = whole.joints[-1]
    part = jointwise.InverseDynamics("puma560", lock={joint: 0.3})
    assert part.joints == whole.joints[:-1]
    q = np.full(5, 0.2)
    assert np.allclose(part.gravity(q), whole.gravity([*q, 0.3])[:5], rtol=1e-12, atol=1e-12)
    again = pickle.loads(pickle.dumps(part))
    assert np.array_equal(again.gravity(q), part.gravity(q)) and repr(again) == repr(part)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: jointwise.InverseDynamics("absent.urdf"), "absent.urdf"),
        (lambda: jointwise.InverseDynamics("puma560", lock={"wheel": 0.0}), "wheel"),
        (lambda: jointwise.InverseDynamics("puma560").gravity([0.0] * 5), "its last axis must be 6"),
        (lambda: jointwise.InverseDynamics("puma560").gravity(0.0), "its last axis must be 6"),
        (lambda: jointwise.InverseDynamics("puma560").torque(np.zeros((2, 6)), np.zeros((3, 6)), [0.0] * 6), "do not fit together"),
    ],
)
def test_errors_have_a_remedy(call, words):
    with pytest.raises(jointwise.JointwiseError, match=words) as raised:
        call()
    assert "--" not in str(raised.value)
