"""Recordings in, diagnosis out."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, Optional, Union

import numpy as np

from . import _core
from ._core import JointwiseError
from ._dynamics import InverseDynamics
from ._result import Diagnosis

if TYPE_CHECKING:
    import pandas

    from ._core import _Column, _Recording

Path = Union[str, "os.PathLike[str]"]
Recording = Union[Path, "pandas.DataFrame", Mapping[str, Any]]

_PER_JOINT = ("q", "qd", "qdd", "tau", "q_secondary", "tau_current", "current", "temperature")


class RecordingWarning(UserWarning):
    """A doubtful property of a recording that did not prevent its use."""


def diagnose(
    urdf: Path,
    train: Union[Recording, Sequence[Recording]],
    held_out: Union[Recording, Sequence[Recording]] = (),
    before: Union[Recording, Sequence[Recording]] = (),
    joints: Optional[Sequence[str]] = None,
    *,
    base: Optional[str] = None,
    tip: Optional[str] = None,
    lock: Optional[Mapping[str, float]] = None,
    column_map: Optional[Path] = None,
    known: Union[Path, Diagnosis, None] = None,
    only: Union[str, Iterable[str], None] = None,
    urdf_friction: Literal["diagnosed", "known", "ignored"] = "diagnosed",
    cutoff: Optional[float] = None,
    torque_lag: Optional[float] = None,
    urdf_accuracy: Optional[float] = None,
    torque_accuracy: Optional[float] = None,
    as_read: bool = False,
    torques_only: bool = False,
    next_experiment: bool = False,
    jobs: Optional[int] = None,
    progress: Optional[Callable[[str], object]] = None,
) -> Diagnosis:
    """Diagnoses which physical effects the model of a robot arm omits.

    A recording is the path of a file (any format of docs/recordings.md); a data frame with the columns `t`, `q_<joint>`,
    `tau_<joint>` and, if there are any, `qd_<joint>` and so on; or a mapping of arrays: `t` (n, in s), `q` and `tau`
    (n × joints, in rad or m and N m or N) and, if there is one, `qd`.

    Parameters
    ----------
    urdf: The robot's URDF, or the name of a robot that comes with testbed.
    train: The recordings to which the effects are fitted.
    held_out: Those on which the fit is validated; without one, no finding is validated.
    before: Those of the same robot from before something happened: what changed is diagnosed.
    joints: The joints of the columns of arrays; by default those of the arm, base to tip.
    base, tip, lock: The link on which the arm stands, its last link, and joints to be fixed with their positions.
    column_map: A column map (.toml), for files and frames with other columns or units.
    known: Effects that are known and not reported again: a file, or an earlier diagnosis.
    only: Effects to fit in place of a search: `"effect:joint"`, or a file that was written from a diagnosis.
    urdf_friction: Which friction in the URDF is known friction.
    cutoff: Half-power frequency of the low-pass filter (Hz), 0.1 to 1000.
    torque_lag: The lag of all recorded torques behind the positions, which is removed (s); by default, it is estimated, in all recordings and in single ones, if the joints agree on it, and is otherwise 0.
    urdf_accuracy: How far the URDF's inertial parameters may be off, as a fraction (0.1: ten per cent).
    torque_accuracy: The relative standard deviation of the torque constants.
    as_read: Diagnoses the recordings as they were read, even if their units, signs, order or zeros seem wrong.
    torques_only: Skips the simulation and the learned correction, which is faster.
    next_experiment: Proposes the motion that best distinguishes the remaining alternatives; `to_dict()` has it.
    jobs: The number of threads, which does not change the result.
    progress: Is called with what is being done.

    Raises
    ------
    JointwiseError: If an input cannot be used: place, reason and remedy.
    KeyboardInterrupt: On Ctrl-C; the computation ends with its current step.
    """
    for what, value, low, high in (
        ("cutoff", cutoff, 0.1, 1000.0),
        ("torque_lag", torque_lag, -0.2, 0.2),
        ("urdf_accuracy", urdf_accuracy, 0.0, 3.0),
        ("torque_accuracy", torque_accuracy, 0.0, 3.0),
        ("jobs", jobs, 1, 1024),
    ):
        if value is not None and not low <= value <= high:
            raise JointwiseError(f"{what} is {value}; give a number from {low:g} to {high:g}")
    lists = {"before": before, "train": train, "held_out": held_out}
    namer = _Namer(joints, lambda: InverseDynamics(urdf, base=base, tip=tip, lock=lock).joints)
    given = {
        what: [_recording(one, f"{what}[{k}]", namer) for k, one in enumerate(_listed(recordings))]
        for what, recordings in lists.items()
    }
    if not given["train"]:
        raise JointwiseError("train is empty; give at least one recording to which the effects are fitted")
    if known is not None and only is not None:
        raise JointwiseError("known and only are given; a hypothesis is fitted without known effects: give one of them")
    outcome, error, notes = _core.diagnose(
        os.fspath(urdf),
        given["before"],
        given["train"],
        given["held_out"],
        base=base,
        tip=tip,
        locks=_locks(lock),
        column_map=None if column_map is None else os.fspath(column_map),
        known_file=None if known is None or isinstance(known, Diagnosis) else os.fspath(known),
        known_text=known.to_toml() if isinstance(known, Diagnosis) else None,
        only=None if only is None else only if isinstance(only, str) else ",".join(only),
        urdf_friction=urdf_friction,
        cutoff=cutoff,
        torque_lag=torque_lag,
        urdf_accuracy=urdf_accuracy,
        torque_accuracy=torque_accuracy,
        as_read=as_read,
        torques_only=torques_only,
        next_experiment=next_experiment,
        threads=jobs or 0,
        progress=progress,
    )
    for text, is_warning in notes:
        if is_warning:
            warnings.warn(text, RecordingWarning, stacklevel=2)
    if error is not None:
        raise error
    assert outcome is not None
    result = Diagnosis._of(outcome, tuple(text for text, _ in notes))
    for doubt in result.doubts:
        joint = f"{doubt.joint}: " if doubt.joint else ""
        text = doubt.text.replace("--map", "column_map")
        warnings.warn(f"no effect was searched: {doubt.recording}: {joint}{text}", RecordingWarning, stacklevel=2)
    return result


def _locks(lock: Optional[Mapping[str, float]]) -> list[tuple[str, float]]:
    return [(joint, float(position)) for joint, position in (lock or {}).items()]


def _listed(recordings: Union[Recording, Sequence[Recording]]) -> list[Recording]:
    given: Any = recordings
    if isinstance(given, (str, os.PathLike, Mapping)) or _is_frame(given):
        return [given]
    return list(given)


def _is_frame(recording: object) -> bool:
    return hasattr(recording, "columns") and hasattr(recording, "__getitem__")


class _Namer:
    """The names of the columns of arrays: those that were given, or those of the arm if it has as many joints."""

    def __init__(self, given: Optional[Sequence[str]], of_arm: Callable[[], Sequence[str]]) -> None:
        self._given = None if given is None else [str(joint) for joint in given]
        self._of_arm = of_arm

    def names(self, count: int) -> Sequence[str]:
        if self._given is not None:
            return self._given
        numbers = [str(joint) for joint in range(count)]
        try:
            joints = self._of_arm()
        except JointwiseError:
            # What is wrong with the robot is said where it is read with its recordings.
            return numbers
        return joints if len(joints) == count else numbers


def _recording(recording: Recording, name: str, namer: _Namer) -> _Recording:
    if isinstance(recording, (str, os.PathLike)):
        return os.fspath(recording)
    if isinstance(recording, Mapping):
        return name, _of_arrays(recording, name, namer)
    if _is_frame(recording):
        return name, _of_frame(recording, name)
    raise JointwiseError(
        f"{name} is of type {type(recording).__name__}; give a path, a data frame, or a mapping with t, q and tau"
    )


def _of_frame(frame: pandas.DataFrame, name: str) -> list[tuple[str, _Column]]:
    if "t" not in frame.columns and getattr(getattr(frame, "index", None), "name", None) is not None:
        frame = frame.reset_index()
    columns: list[tuple[str, _Column]] = []
    for header in frame.columns:
        column = _column(frame[header], name, str(header))
        if column is not None:
            columns.append((str(header), column))
    return columns


def _column(series: Any, name: str, header: str) -> Optional[_Column]:
    """The column, or None if it holds no numbers and no times."""
    values = np.asarray(_filled(series))
    if values.dtype.kind == "O" and str(getattr(series, "dtype", "")).startswith("datetime64"):
        values = series.to_numpy(dtype="datetime64[ns]")
    if values.ndim != 1:
        raise JointwiseError(f"{name}: there are two columns \"{header}\"; rename one")
    if values.dtype.kind == "M":
        if np.isnat(values).any():
            row = int(np.flatnonzero(np.isnat(values))[0])
            raise JointwiseError(f"{name}: row {row + 1}: column \"{header}\" has no time; take the row out")
        return np.ascontiguousarray(values.astype("datetime64[ns]").astype(np.int64)), True
    if values.dtype.kind in "iu":
        return np.ascontiguousarray(values, dtype=np.int64)
    if values.dtype.kind in "fb":
        return np.ascontiguousarray(values, dtype=np.float64)
    try:
        # What pandas has for missing numbers is NaN.
        return np.array([np.nan if value is None or value is _na() else value for value in values], dtype=np.float64)
    except (TypeError, ValueError):
        return None


def _filled(values: Any) -> Any:
    """The values, with NaN where a masked array has none."""
    if not np.ma.is_masked(values):
        return values
    if values.dtype.kind in "iub":
        values = values.astype(np.float64)
    return values.filled(np.datetime64("NaT") if values.dtype.kind == "M" else np.nan)


def _na() -> object:
    try:
        import pandas
    except ImportError:
        return None
    return pandas.NA


def _of_arrays(arrays: Mapping[str, Any], name: str, namer: _Namer) -> list[tuple[str, _Column]]:
    unknown = [key for key in arrays if key != "t" and key not in _PER_JOINT]
    if unknown:
        raise JointwiseError(
            f"{name} has \"{unknown[0]}\", which is no quantity; its keys are t, q, tau and, if there are any, "
            "qd, qdd, q_secondary, tau_current, current, temperature"
        )
    for key in ("t", "q", "tau"):
        if key not in arrays:
            raise JointwiseError(f"{name} has no \"{key}\"; give t (n), q and tau (n × joints)")
    time = _column(arrays["t"], name, "t")
    if time is None:
        raise JointwiseError(f"{name}: \"t\" holds no numbers; give the time of each sample in s")
    columns: list[tuple[str, _Column]] = [("t", time)]
    names: Optional[Sequence[str]] = None
    for key in _PER_JOINT:
        if arrays.get(key) is None:
            continue
        try:
            values = np.asarray(_filled(arrays[key]), dtype=np.float64)
        except (TypeError, ValueError) as error:
            raise JointwiseError(f"{name}: \"{key}\" holds no numbers: {error}") from None
        if values.ndim == 1:
            values = values[:, np.newaxis]
        if values.ndim != 2:
            raise JointwiseError(f"{name}: \"{key}\" has the shape {values.shape}; give n × joints")
        if names is None:
            names = namer.names(values.shape[1])
        if len(names) != values.shape[1]:
            raise JointwiseError(
                f"{name}: \"{key}\" has {values.shape[1]} columns for {len(names)} joints; give one column per joint"
            )
        columns += [(f"{key}_{joint}", np.ascontiguousarray(values[:, k])) for k, joint in enumerate(names)]
    return columns
