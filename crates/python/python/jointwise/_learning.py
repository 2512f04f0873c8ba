"""Independent Joint Learning (Um, Park and Park, 2014) with the interface of scikit-learn."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any, Literal, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

try:
    from sklearn.base import BaseEstimator, RegressorMixin
    from sklearn.utils.validation import check_is_fitted, validate_data
except ImportError as error:
    raise ImportError(
        "jointwise.IndependentJointLearning has the interface of scikit-learn, and needs version 1.6 or newer; "
        "pip install scikit-learn"
    ) from error

from . import _core
from ._core import JointwiseError
from ._dynamics import InverseDynamics

_Floats = NDArray[np.float64]


class IndependentJointLearning(RegressorMixin, BaseEstimator):  # type: ignore[misc]
    """The torques of an arm: its rigid-body model, and one Gaussian process per joint for the rest.

    X is (n, 3 joints): positions, velocities and accelerations, `np.hstack([q, qd, qdd])`; y is (n, joints): torques.

    Parameters
    ----------
    urdf: The robot's URDF, or the name of a robot that comes with testbed.
    inputs: What the processes learn from. `"newton-euler-12"`: ω, ω̇ of the link, and moment and force on the next link,
        of the rigid-body model (the paper's); `"newton-euler-13"`: and its torque, too; `"newton-euler-own-frame"`: the 12, with
        moment and force in the frame of the link instead of the next one; `"joint-motion"`: q, q̇, q̈ of all joints.
    length_scales: `"per-input"`, or `"single"` for the paper's one length scale.
    base, tip, lock: Which of the robot's joints are the arm, as for :class:`InverseDynamics`.
    starts: Starts of the likelihood search.
    max_iterations: Its iterations from each start.

    Attributes
    ----------
    joints_: The names of the joints, base to tip.
    regressions_: For each joint, a dictionary of amplitude and noise (N m or N), length_scales (the inputs' units) and
        log_marginal_likelihood.
    """

    def __init__(
        self,
        urdf: Union[str, os.PathLike[str]],
        *,
        inputs: Literal[
            "newton-euler-12", "newton-euler-13", "newton-euler-own-frame", "joint-motion"
        ] = "newton-euler-13",
        length_scales: Literal["per-input", "single"] = "per-input",
        base: Optional[str] = None,
        tip: Optional[str] = None,
        lock: Optional[Mapping[str, float]] = None,
        starts: int = 4,
        max_iterations: int = 100,
    ) -> None:
        self.urdf = urdf
        self.inputs = inputs
        self.length_scales = length_scales
        self.base = base
        self.tip = tip
        self.lock = lock
        self.starts = starts
        self.max_iterations = max_iterations

    def fit(self, X: ArrayLike, y: ArrayLike) -> IndependentJointLearning:
        """Trains on motions X (n, 3 joints) and their torques y (n, joints)."""
        motions, torques = validate_data(self, X, y, dtype=np.float64, multi_output=True, y_numeric=True)
        targets: _Floats = np.array(torques, dtype=np.float64)
        self._is_flat = targets.ndim == 1
        self._X: _Floats = np.array(motions)
        self._y: _Floats = targets.reshape(len(targets), -1)
        self._model: Optional[_core.Learned] = self._trained()
        return self

    def predict(self, X: ArrayLike, return_std: bool = False) -> Union[_Floats, tuple[_Floats, _Floats]]:
        """The torques (n, joints) of motions X; with `return_std`, the standard deviations of their learned part, too
        (noise not included)."""
        check_is_fitted(self, "_X")
        motions = self._motion(validate_data(self, X, dtype=np.float64, reset=False))
        if self._model is None:
            self._model = self._trained()
        mean = self._shaped(self._model.predict(*motions))
        if not return_std:
            return mean
        return mean, self._shaped(np.sqrt(self._model.variance(*motions)))

    def _trained(self) -> _core.Learned:
        dynamics = InverseDynamics(self.urdf, base=self.base, tip=self.tip, lock=self.lock)
        self.joints_ = dynamics.joints
        dof = len(self.joints_)
        if self._X.shape[1] != 3 * dof or self._y.shape[1] != dof:
            raise JointwiseError(
                f"X has {self._X.shape[1]} columns and y has {self._y.shape[1]}, and {dynamics.name} has {dof} joints; "
                f"give {3 * dof} (q, qd, qdd) and {dof}"
            )
        model = _core.Learned.fit(
            dynamics._core,
            *self._motion(self._X),
            np.ascontiguousarray(self._y),
            self.inputs,
            self.length_scales,
            self.starts,
            self.max_iterations,
        )
        self.regressions_ = [
            {
                "amplitude": amplitude,
                "length_scales": np.array(lengths),
                "noise": noise,
                "log_marginal_likelihood": likelihood,
            }
            for amplitude, lengths, noise, likelihood in model.regressions()
        ]
        return model

    def _motion(self, X: _Floats) -> tuple[_Floats, _Floats, _Floats]:
        q, qd, qdd = (np.ascontiguousarray(part) for part in np.split(X, 3, axis=1))
        return q, qd, qdd

    def _shaped(self, values: _Floats) -> _Floats:
        return values if self._is_flat else values.reshape(-1, len(self.joints_))

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.target_tags.multi_output = True
        return tags

    def __getstate__(self) -> dict[str, Any]:
        # The training is deterministic: the model is trained again where it is needed.
        state: dict[str, Any] = super().__getstate__()
        return {**state, "_model": None} if "_model" in state else state
