"""What a robot arm's URDF omits, found from recordings; inverse dynamics and learned torque models.

Joint space is q, qd, qdd, tau: positions (rad or m), velocities, accelerations, and joint torques (N m) or forces (N),
one column per joint, base to tip, on the joint side.
"""

from typing import TYPE_CHECKING, Any

from ._core import JointwiseError
from ._diagnose import RecordingWarning, diagnose
from ._dynamics import InverseDynamics
from ._result import Alternative, Diagnosis, DifferentLoad, Doubt, Effect, HeldOutFriction, JointFit, NotDiagnosed, NotTestable, Parameter, Unexplained

if TYPE_CHECKING:
    from ._learning import IndependentJointLearning

__all__ = [
    "Alternative",
    "Diagnosis",
    "DifferentLoad",
    "Doubt",
    "Effect",
    "HeldOutFriction",
    "IndependentJointLearning",
    "InverseDynamics",
    "JointFit",
    "JointwiseError",
    "NotDiagnosed",
    "NotTestable",
    "Parameter",
    "RecordingWarning",
    "Unexplained",
    "diagnose",
]


def __getattr__(name: str) -> Any:
    # scikit-learn is optional, and takes a second to import.
    if name == "IndependentJointLearning":
        from ._learning import IndependentJointLearning

        return IndependentJointLearning
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> "list[str]":
    return sorted({*globals(), *__all__})
