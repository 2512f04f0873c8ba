from collections.abc import Callable
from typing import Union, final

import numpy as np
from numpy.typing import NDArray

__all__ = ["Dynamics", "JointwiseError", "Learned", "Outcome", "diagnose"]

# Arrays that go in are C-contiguous: float64, one row per sample and one column per joint. Those that come out are flat.
_Floats = NDArray[np.float64]
_Integers = NDArray[np.int64]
_Column = Union[_Floats, _Integers, tuple[_Integers, bool]]
_Recording = Union[str, tuple[str, list[tuple[str, _Column]]]]

class JointwiseError(ValueError): ...

@final
class Dynamics:
    def __new__(
        cls, urdf: str, base: str | None, tip: str | None, locks: list[tuple[str, float]]
    ) -> Dynamics: ...
    @property
    def name(self) -> str: ...
    @property
    def joints(self) -> list[str]: ...
    @property
    def notes(self) -> list[str]: ...
    def inertial_parameters(self) -> _Floats: ...
    def torque(self, q: _Floats, qd: _Floats, qdd: _Floats) -> _Floats: ...
    def gravity(self, q: _Floats) -> _Floats: ...
    def forward(self, q: _Floats, qd: _Floats, tau: _Floats) -> _Floats: ...
    def mass_matrix(self, q: _Floats) -> _Floats: ...
    def regressor(self, q: _Floats, qd: _Floats, qdd: _Floats) -> _Floats: ...

@final
class Learned:
    @staticmethod
    def fit(
        dynamics: Dynamics,
        q: _Floats,
        qd: _Floats,
        qdd: _Floats,
        tau: _Floats,
        inputs: str,
        length_scales: str,
        starts: int,
        max_iterations: int,
    ) -> Learned: ...
    def predict(self, q: _Floats, qd: _Floats, qdd: _Floats) -> _Floats: ...
    def variance(self, q: _Floats, qd: _Floats, qdd: _Floats) -> _Floats: ...
    def regressions(self) -> list[tuple[float, list[float], float, float]]: ...

@final
class Outcome:
    def json(self) -> str: ...
    def text(self, everything: bool) -> str: ...
    def page(self) -> str: ...
    def toml(self) -> str: ...
    def urdf(self) -> tuple[str, list[str]]: ...
    def mjcf(self) -> tuple[str, list[str]]: ...

def diagnose(
    urdf: str,
    before: list[_Recording],
    train: list[_Recording],
    held_out: list[_Recording],
    *,
    base: str | None,
    tip: str | None,
    locks: list[tuple[str, float]],
    column_map: str | None,
    known_file: str | None,
    known_text: str | None,
    only: str | None,
    urdf_friction: str,
    cutoff: float | None,
    torque_lag: float | None,
    urdf_accuracy: float | None,
    torque_accuracy: float | None,
    as_read: bool,
    torques_only: bool,
    next_experiment: bool,
    threads: int,
    progress: Callable[[str], object] | None,
) -> tuple[Outcome | None, BaseException | None, list[tuple[str, bool]]]: ...
