"""Independent Joint Learning: its regressions against scikit-learn's, and its interface."""

import pickle

import numpy as np
import pytest

sklearn = pytest.importorskip("sklearn")
from sklearn.base import clone  # noqa: E402
from sklearn.exceptions import NotFittedError  # noqa: E402
from sklearn.gaussian_process import GaussianProcessRegressor  # noqa: E402
from sklearn.gaussian_process.kernels import RBF, ConstantKernel  # noqa: E402
from sklearn.model_selection import KFold, cross_val_score  # noqa: E402

import jointwise  # noqa: E402
from conftest import ARM, motion  # noqa: E402


def samples(seed, count=120):
    """Motions and the torques of an arm with friction, which the model does not have."""
    dynamics = jointwise.InverseDynamics(ARM)
    times = np.sort(np.random.default_rng(seed).uniform(0.0, 12.0, count))
    q, qd, qdd = motion(times, len(dynamics.joints), 5)
    tau = dynamics.torque(q, qd, qdd) + 1.5 * qd + 0.8 * np.tanh(qd / 0.2)
    tau += np.random.default_rng(seed + 1).normal(0.0, 0.01, tau.shape)
    return np.hstack([q, qd, qdd]), tau, dynamics.torque(q, qd, qdd)


@pytest.mark.parametrize("length_scales", ["single", "per-input"])
def test_the_regressions_are_scikit_learns(length_scales):
    X, y, rigid = samples(1)
    Z, _, rigid_there = samples(2, 40)
    model = jointwise.IndependentJointLearning(ARM, inputs="joint-motion", length_scales=length_scales).fit(X, y)
    mean, deviation = model.predict(Z, return_std=True)
    assert np.array_equal(mean, model.predict(Z))
    for joint, found in enumerate(model.regressions_):
        lengths = found["length_scales"]
        kernel = ConstantKernel(found["amplitude"] ** 2) * RBF(lengths if len(lengths) > 1 else lengths[0])
        noise = max(found["noise"] ** 2, 1e-300)
        reference = GaussianProcessRegressor(kernel, alpha=noise, optimizer=None)
        reference.fit(X, y[:, joint] - rigid[:, joint])
        expected, spread = reference.predict(Z, return_std=True)
        scale = np.abs(y[:, joint]).max()
        assert np.abs(mean[:, joint] - rigid_there[:, joint] - expected).max() < 1e-6 * scale
        assert np.abs(deviation[:, joint] - spread).max() < 1e-5 * found["amplitude"]
        assert abs(found["log_marginal_likelihood"] - reference.log_marginal_likelihood_value_) < 1e-3


@pytest.mark.parametrize("inputs", ["newton-euler-12", "newton-euler-13", "newton-euler-own-frame", "joint-motion"])
def test_learning_explains_what_the_model_omits(inputs):
    X, y, _ = samples(1)
    Z, there, rigid = samples(2, 60)
    model = jointwise.IndependentJointLearning(ARM, inputs=inputs).fit(X, y)
    error = np.sqrt(np.mean((model.predict(Z) - there) ** 2))
    before = np.sqrt(np.mean((rigid - there) ** 2))
    assert error < 0.2 * before
    assert model.score(Z, there) > 0.95
    assert model.joints_ == jointwise.InverseDynamics(ARM).joints


def test_it_is_an_estimator():
    X, y, _ = samples(1, 60)
    model = jointwise.IndependentJointLearning(ARM, inputs="newton-euler-12", length_scales="single")
    with pytest.raises(NotFittedError):
        model.predict(X)
    copy = clone(model)
    assert copy.get_params() == model.get_params() and copy is not model
    copy.set_params(inputs="joint-motion", starts=2)
    assert copy.inputs == "joint-motion" and copy.get_params()["starts"] == 2
    fitted = clone(copy).fit(X, y)
    assert fitted.n_features_in_ == X.shape[1]
    assert not hasattr(clone(fitted), "joints_")
    again = pickle.loads(pickle.dumps(fitted))
    assert np.array_equal(again.predict(X), fitted.predict(X))
    scores = cross_val_score(copy, X, y, cv=KFold(3, shuffle=True, random_state=0))
    assert scores.shape == (3,) and scores.min() > 0.5
    assert "IndependentJointLearning" in repr(fitted)


# Those of scikit-learn's checks that do not make up a number of features: it is three times that of the arm's joints.
CHECKS = [
    "check_no_attributes_set_in_init",
    "check_parameters_default_constructible",
    "check_get_params_invariance",
    "check_set_params",
    "check_estimator_get_tags_default_keys",
    "check_estimator_tags_renamed",
    "check_valid_tag_types",
    "check_estimator_repr",
    "check_estimator_cloneable",
    "check_do_not_raise_errors_in_init_or_set_param",
]


@pytest.mark.parametrize("name", CHECKS)
def test_scikit_learns_own_checks(name):
    from sklearn.utils import estimator_checks

    check = getattr(estimator_checks, name, None)
    if check is None:
        pytest.skip("this version of scikit-learn has no such check")
    if name == "check_parameters_default_constructible":
        with pytest.raises(TypeError):
            jointwise.IndependentJointLearning()
        return
    check("IndependentJointLearning", jointwise.IndependentJointLearning(ARM))


@pytest.mark.parametrize(
    ("options", "change", "words"),
    [
        ({"inputs": "features"}, lambda X, y: (X, y), "give one of newton-euler-12"),
        ({"length_scales": "ard"}, lambda X, y: (X, y), "give one of single, per-input"),
        ({"starts": 0}, lambda X, y: (X, y), "at least 1"),
        ({}, lambda X, y: (X[:, :-1], y), "joints; give"),
        ({}, lambda X, y: (X, y[:, :1]), "joints; give"),
        ({}, lambda X, y: (X * np.nan, y), "NaN"),
    ],
)
def test_errors_have_a_remedy(options, change, words):
    X, y, _ = samples(1, 20)
    X, y = change(X, y)
    with pytest.raises(ValueError, match=words):
        jointwise.IndependentJointLearning(ARM, **options).fit(X, y)


def test_motions_of_other_arms_are_refused():
    X, y, _ = samples(1, 30)
    model = jointwise.IndependentJointLearning(ARM, length_scales="single").fit(X, y)
    with pytest.raises(ValueError, match="features"):
        model.predict(X[:, :3])
