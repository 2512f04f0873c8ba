"""Rigid-body dynamics of the arm in a URDF."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._core import JointwiseError

_Floats = NDArray[np.float64]


class InverseDynamics:
    """The rigid-body dynamics of an arm.

    Arrays are (…, joints), one entry per joint, base to tip; their leading axes are broadcast. Positions are in rad (m),
    torques in N m (N), on the joint side. Gravity is 9.81 m/s² down the base's z axis.

    Parameters
    ----------
    urdf: The robot's URDF, or the name of a robot that comes with testbed.
    base, tip: The link on which the arm stands still, and its last link.
    lock: Joints to be fixed, each with its position (rad or m).

    Raises
    ------
    JointwiseError: If there is no such file, or no such arm in it.
    """

    def __init__(
        self,
        urdf: Union[str, os.PathLike[str]],
        *,
        base: Optional[str] = None,
        tip: Optional[str] = None,
        lock: Optional[Mapping[str, float]] = None,
    ) -> None:
        locks = [(joint, float(position)) for joint, position in (lock or {}).items()]
        self._given = (os.fspath(urdf), base, tip, locks)
        self._core = _core.Dynamics(*self._given)
        self.joints: tuple[str, ...] = tuple(self._core.joints)
        """The moving joints, base to tip."""

    @property
    def name(self) -> str:
        """The robot's name."""
        return self._core.name

    @property
    def notes(self) -> tuple[str, ...]:
        """What in the URDF is doubtful, and which joints were fixed unasked."""
        return tuple(self._core.notes)

    @property
    def inertial_parameters(self) -> _Floats:
        """The ten inertial parameters of every link, base to tip: m, m c (3), Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the
        origin of the link's frame. With :meth:`regressor`: torque = regressor @ inertial_parameters."""
        return self._core.inertial_parameters()

    def torque(self, q: ArrayLike, qd: ArrayLike, qdd: ArrayLike) -> _Floats:
        """The torques for a motion: (…, joints)."""
        (a, b, c), shape = self._rows(q=q, qd=qd, qdd=qdd)
        return self._core.torque(a, b, c).reshape(shape)

    def gravity(self, q: ArrayLike) -> _Floats:
        """The torques that hold the arm at rest: (…, joints)."""
        (a,), shape = self._rows(q=q)
        return self._core.gravity(a).reshape(shape)

    def forward(self, q: ArrayLike, qd: ArrayLike, tau: ArrayLike) -> _Floats:
        """The accelerations under torques: (…, joints)."""
        (a, b, c), shape = self._rows(q=q, qd=qd, tau=tau)
        return self._core.forward(a, b, c).reshape(shape)

    def mass_matrix(self, q: ArrayLike) -> _Floats:
        """The joint-space mass matrix: (…, joints, joints)."""
        (a,), shape = self._rows(q=q)
        return self._core.mass_matrix(a).reshape(*shape, len(self.joints))

    def regressor(self, q: ArrayLike, qd: ArrayLike, qdd: ArrayLike) -> _Floats:
        """The matrix that gives the torques from :attr:`inertial_parameters`: (…, joints, 10 joints)."""
        (a, b, c), shape = self._rows(q=q, qd=qd, qdd=qdd)
        return self._core.regressor(a, b, c).reshape(*shape, 10 * len(self.joints))

    def _rows(self, **arrays: ArrayLike) -> tuple[list[_Floats], tuple[int, ...]]:
        dof = len(self.joints)
        given = {}
        for name, array in arrays.items():
            values = np.asarray(array, dtype=np.float64)
            if values.ndim == 0 or values.shape[-1] != dof:
                raise JointwiseError(
                    f"{name} has the shape {values.shape}, and {self.name} has {dof} joints ({', '.join(self.joints)}); "
                    f"its last axis must be {dof}"
                )
            given[name] = values
        try:
            shape = np.broadcast_shapes(*(values.shape for values in given.values()))
        except ValueError:
            shapes = ", ".join(f"{name} {values.shape}" for name, values in given.items())
            raise JointwiseError(f"the shapes do not fit together: {shapes}") from None
        rows = [
            np.ascontiguousarray(np.broadcast_to(values, shape).reshape(-1, dof)) for values in given.values()
        ]
        return rows, shape

    def __reduce__(self) -> tuple[Any, ...]:
        return _remade, self._given

    def __repr__(self) -> str:
        return f"InverseDynamics({self._given[0]!r}: {', '.join(self.joints)})"


def _remade(
    urdf: str, base: Optional[str], tip: Optional[str], locks: list[tuple[str, float]]
) -> InverseDynamics:
    return InverseDynamics(urdf, base=base, tip=tip, lock=dict(locks))
