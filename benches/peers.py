#!/usr/bin/env python3
"""Ours against Pinocchio, one call after the other in the same minutes; benches/peers.sh builds ours and calls this.

usage: peers.py OURS RUNS CALLS ROBOT.urdf...      (needs g++, and: pip install pin cmeel-eigen)
"""
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[name] = "1"
try:
    import pinocchio as pin
except ImportError:
    sys.exit("peers.py: this Python has no Pinocchio: pip install pin cmeel-eigen, or name another with PYTHON=…")

OURS, RUNS, CALLS = sys.argv[1], int(sys.argv[2]), sys.argv[3]
here = pathlib.Path(__file__).parent
work = pathlib.Path(tempfile.mkdtemp())
prefix = next(p for p in pathlib.Path(pin.__file__).parents if (p / "include/pinocchio").exists())
eigens = [pathlib.Path(p) for p in (os.environ.get("EIGEN", ""), f"{prefix}/include/eigen3", "/usr/include/eigen3") if p]
eigen = next((p for p in eigens if (p / "Eigen/Core").exists()), None)
if eigen is None:
    sys.exit("peers.py: Eigen's headers are missing: pip install cmeel-eigen, or name their folder with EIGEN=…")
small = [f"-DBOOST_MPL_LIMIT_{kind}_SIZE=30" for kind in ("LIST", "VECTOR")]
flags = ["-O3", "-DNDEBUG", "-std=c++17", *small, "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS", "-DBOOST_FUSION_INVOKE_MAX_ARITY=12", "-DPINOCCHIO_ENABLE_TEMPLATE_INSTANTIATION", "-w"]
libraries = ["-lpinocchio_default", "-lboost_serialization", f"-Wl,-rpath,{prefix}/lib"]
subprocess.run(
    ["g++", *flags, here / "pinocchio.cpp", "-o", work / "pinocchio", f"-I{prefix}/include", f"-I{eigen}", f"-L{prefix}/lib", *libraries],
    check=True,
)


def times(*command):
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


print(f"Pinocchio {pin.__version__}, {RUNS} runs of {CALLS} calls in turn; median ns, median ratio (smallest to largest)")
for urdf in sys.argv[4:]:
    model = pin.buildModelFromUrdf(urdf)
    saved = str(work / "model.txt")
    model.saveToText(saved)
    pairs = [(times(OURS, urdf, CALLS), times(work / "pinocchio", saved, CALLS)) for _ in range(RUNS)]
    print(f"\n{pathlib.Path(urdf).stem}\n{'':18} {'ours':>7} {'theirs':>7}  ratio")
    for row in pairs[0][0]:
        ours, theirs = ([run[side][row] for run in pairs] for side in (0, 1))
        ratios = [a / b for a, b in zip(ours, theirs)]
        middle = statistics.median(ratios)
        print(f"{row:18} {statistics.median(ours):7.0f} {statistics.median(theirs):7.0f}  {middle:.2f} ({min(ratios):.2f} to {max(ratios):.2f})")
