"""The result of a diagnosis, as values with names."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, Optional

if TYPE_CHECKING:
    import pandas

    from ._core import Outcome

Verdict = Literal["no_mismatch", "explained", "partly_explained", "unexplained", "not_enough_data", "units_first"]


@dataclass(frozen=True)
class Parameter:
    """A number with its 95 % interval, in the SI unit at the joint."""

    value: float
    interval: tuple[float, float]
    unit: str

    def __str__(self) -> str:
        low, high = self.interval
        return f"{self.value:.4g} [{low:.4g}, {high:.4g}] {self.unit}".rstrip()


@dataclass(frozen=True)
class Alternative:
    """An effect that explains nearly as much in the place of another; `joint` is None for the whole arm."""

    name: str
    joint: Optional[str]


@dataclass(frozen=True)
class Effect:
    """A physical effect that the model omits."""

    name: str
    """The catalogue's name, such as `viscous_friction`."""
    joint: Optional[str]
    """The joint, or None for the whole arm."""
    other: Optional[str]
    """The joint whose motion it depends on, for a coupling."""
    parameters: Mapping[str, Parameter]
    probability: Optional[float]
    """The probability that this effect is present on this joint; None where it was not calibrated."""
    share: float
    """Standard deviation of its torque over that of the measured torque; the largest of the joints."""
    share_by_joint: Mapping[str, float]
    held_out_gain: Optional[float]
    """Relative drop of the error over recordings that it was not fitted to; None if none of them tries it."""
    alternatives: tuple[Alternative, ...]
    alternative_pairs: tuple[tuple[Alternative, Alternative], ...]
    """Two effects that explain nearly as much together, and neither alone."""
    sentence: str
    since_before: bool
    """Whether it is present since the recordings from before."""
    change: Optional[str]
    """How it changed since then: "added", "increased", "removed" or "reduced"; the last two are in the recordings from before only."""
    sensor: Optional[str]
    """"motor_current" or "second_encoder", if that sensor shows it and the torque does not; None otherwise."""
    time: tuple[tuple[float, float], ...]
    """The stretches of time in which it acts (s); the whole time if empty."""


@dataclass(frozen=True)
class JointFit:
    """How well a joint's torque is predicted. Errors are RMS errors over the standard deviation of the measured torque,
    on the held-out recordings; None where there are none."""

    torque_std: float
    """Standard deviation of the measured torque (N m or N)."""
    noise: float
    """Measured noise after filtering (N m or N)."""
    nominal: Optional[float]
    """With the URDF's model."""
    augmented: Optional[float]
    """With the effects found."""
    learned: Optional[float]
    """With a correction learned (IJL) from the same recordings."""
    exported: Optional[float]
    """With the exported corrected model."""
    train_nominal: float
    """With the URDF's model, training recordings."""
    train_augmented: float
    """With the effects found, training recordings."""


@dataclass(frozen=True)
class Unexplained:
    """A structured residual that no effect in the catalogue explains."""

    joint: str
    share: float
    """Its standard deviation over that of the measured torque."""
    depends_on: tuple[str, ...]
    next: str
    """The experiment that narrows it down."""


@dataclass(frozen=True)
class NotTestable:
    """An effect that the recordings cannot test."""

    name: str
    joint: Optional[str]
    because: str
    would_be_seen_above: Mapping[str, float]
    would_be_seen_below: Mapping[str, float]


def _frozen(mapping: dict[str, Any]) -> Mapping[str, Any]:
    return MappingProxyType(mapping)


def _parameter(of: dict[str, Any]) -> Parameter:
    low, high = of["ci95"]
    return Parameter(of["value"], (low, high), of["unit"])


def _doubts(of: list[dict[str, Any]]) -> tuple[Doubt, ...]:
    return tuple(Doubt(one["recording"], one["joint"], one["text"], one["column_map"]) for one in of)


def _effect(finding: dict[str, Any]) -> Effect:
    def alternative(of: dict[str, Any]) -> Alternative:
        return Alternative(of["effect"], of["joint"])

    return Effect(
        name=finding["effect"],
        joint=finding["joint"],
        other=finding.get("other"),
        parameters=_frozen({key: _parameter(of) for key, of in finding["parameters"].items()}),
        probability=finding["probability"],
        share=finding["share"],
        share_by_joint=_frozen(finding["share_by_joint"]),
        held_out_gain=finding["held_out_gain"],
        alternatives=tuple(alternative(of) for of in finding["confusable_with"]),
        alternative_pairs=tuple(
            (alternative(one), alternative(other)) for one, other in finding.get("confusable_with_pairs", ())
        ),
        sentence=finding["sentence"],
        since_before=finding.get("since_before", False),
        change=finding.get("change"),
        sensor=finding.get("sensor"),
        time=tuple((start, end) for start, end in finding["where"]["time"]),
    )


def _fit(of: dict[str, Any]) -> JointFit:
    return JointFit(
        torque_std=of["torque_std"],
        noise=of["noise"],
        nominal=of["held_out_nrmse_nominal"],
        augmented=of["held_out_nrmse_augmented"],
        learned=of["held_out_nrmse_learned"],
        exported=of["held_out_nrmse_exported"],
        train_nominal=of["train_nrmse_nominal"],
        train_augmented=of["train_nrmse_augmented"],
    )


@dataclass(frozen=True)
class DifferentLoad:
    """A load at the tip that only some of the recordings have."""

    recordings: tuple[str, ...]
    """These recordings: at most half of all, or those that begin before `until`."""
    until: Optional[float]
    """The time at which the load was put down within the last of them (s, on their common clock); `None` if they have it to their ends."""
    more_than_others: Parameter
    """The mass that they have more than the others; negative if they have less."""


@dataclass(frozen=True)
class HeldOutFriction:
    """A joint whose friction in a held-out recording is a multiple of that in the training recordings."""

    recording: str
    joint: str
    factor: float
    """The friction over that in the training recordings."""


@dataclass(frozen=True)
class Doubt:
    """A recording whose units, signs, order or zeros do not fit the robot."""

    recording: str
    joint: Optional[str]
    """The joint, or None where it is about all that move."""
    text: str
    """What is wrong, and the remedy."""
    column_map: Optional[str]
    """The complete column map (TOML) that corrects it, if a column map can."""


@dataclass(frozen=True)
class NotDiagnosed:
    """Joints that are not diagnosed, because their torque channels hold no usable torque."""

    joints: tuple[str, ...]
    because: str
    """The reason, and the remedy."""


@dataclass(frozen=True)
class Diagnosis:
    """The result of a diagnosis."""

    robot: str
    verdict: Verdict
    doubts: tuple[Doubt, ...]
    """What comes first where the verdict is `units_first`: no effect was searched then. Empty otherwise."""
    warnings: tuple[Doubt, ...]
    """What contradicts the URDF in the recordings as they were read, and does not prevent a diagnosis."""
    effects: tuple[Effect, ...]
    """The effects that the model omits, the largest share first."""
    joints: Mapping[str, JointFit]
    """The errors of each joint."""
    unexplained: tuple[Unexplained, ...]
    not_diagnosed: tuple[NotDiagnosed, ...]
    """The joints whose torque channels hold no usable torque; the rest of the result is about the other joints."""
    not_testable: tuple[NotTestable, ...]
    not_enough_data: tuple[str, ...]
    """The reasons why the data are not sufficient for a diagnosis; empty if there are."""
    changed: Optional[tuple[str, ...]]
    """What changed since the recordings from before, in sentences; None without such recordings."""
    different_load: Optional[DifferentLoad]
    """The load at the tip that only some of the recordings have; None if all have the same."""
    held_out_friction: tuple[HeldOutFriction, ...]
    """The joints whose friction in a held-out recording differs from that in the training recordings, which explains most of their
    held-out error; empty if there are none."""
    constant_torques: Mapping[str, Parameter]
    """The constant torques that correct the joints and that no effect names, in N m or N, by the joints' names."""
    notes: tuple[str, ...]
    """The notes on the robot and the recordings."""
    _outcome: Outcome = field(repr=False, compare=False)

    @classmethod
    def _of(cls, outcome: Outcome, notes: tuple[str, ...]) -> Diagnosis:
        report = json.loads(outcome.json())
        changed, load = report.get("changed"), report.get("different_load")
        return cls(
            robot=report["robot"],
            verdict=report["verdict"],
            doubts=_doubts(report.get("doubts", [])),
            warnings=_doubts(report.get("warnings", [])),
            effects=tuple(_effect(finding) for finding in report["findings"]),
            joints=_frozen({joint: _fit(of) for joint, of in report["fit"].items()}),
            unexplained=tuple(
                Unexplained(of["joint"], of["share"], tuple(of["depends_on"]), of["next"])
                for of in report["unexplained"]
            ),
            not_diagnosed=tuple(
                NotDiagnosed(tuple(of["joints"]), of["because"]) for of in report.get("not_diagnosed", [])
            ),
            not_testable=tuple(
                NotTestable(
                    of["effect"],
                    of["joint"],
                    of["because"],
                    _frozen(of["would_be_seen_above"]),
                    _frozen(of.get("would_be_seen_below", {})),
                )
                for of in report["not_observable"]
            ),
            not_enough_data=tuple(report["not_enough_data"]),
            changed=None if changed is None else tuple(changed),
            different_load=None
            if load is None
            else DifferentLoad(tuple(load["recordings"]), load.get("until"), _parameter(load["more_than_others"])),
            held_out_friction=tuple(
                HeldOutFriction(of["recording"], of["joint"], of["factor"]) for of in report.get("held_out_friction", [])
            ),
            constant_torques=_frozen({joint: _parameter(of) for joint, of in report.get("constant_torques", {}).items()}),
            notes=notes,
            _outcome=outcome,
        )

    def to_json(self) -> str:
        """The report as `testbed diagnose --json FILE` writes it, to the byte."""
        return self._outcome.json() + "\n"

    def to_dict(self) -> dict[str, Any]:
        """The report as a dictionary: that of :meth:`to_json`."""
        report: dict[str, Any] = json.loads(self._outcome.json())
        return report

    def to_frame(self) -> pandas.DataFrame:
        """The effects as a pandas frame, one row per parameter."""
        import pandas

        rows = [
            {
                "effect": effect.name,
                "joint": effect.joint,
                "parameter": key,
                "value": parameter.value,
                "low": parameter.interval[0],
                "high": parameter.interval[1],
                "unit": parameter.unit,
                "probability": effect.probability,
                "share": effect.share,
                "held_out_gain": effect.held_out_gain,
            }
            for effect in self.effects
            for key, parameter in effect.parameters.items()
        ]
        columns = "effect joint parameter value low high unit probability share held_out_gain".split()
        return pandas.DataFrame(rows, columns=columns)

    def text(self, everything: bool = False) -> str:
        """The report as the terminal shows it; `everything`: as with --verbose."""
        return self._outcome.text(everything)

    def to_html(self) -> str:
        """The report as one HTML page with figures."""
        return self._outcome.page()

    def to_toml(self) -> str:
        """The corrected model: the known effects and those found, for `known` of the next diagnosis."""
        return self._outcome.toml()

    def to_urdf(self) -> str:
        """The URDF with those effects of the corrected model that a URDF can represent; a comment lists the others."""
        return self._outcome.urdf()[0]

    def to_mjcf(self) -> str:
        """The corrected model for MuJoCo, as far as MJCF can represent it; a comment lists the rest."""
        return self._outcome.mjcf()[0]

    def __str__(self) -> str:
        return self.text()
