"""The types are what the package does."""

import pathlib
import subprocess
import sys

import pytest

import jointwise

pytest.importorskip("mypy")


def run(*arguments, cwd):
    done = subprocess.run([sys.executable, "-m", *arguments], cwd=cwd, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_mypy_is_content(tmp_path):
    folder = pathlib.Path(jointwise.__file__).parent
    assert (folder / "py.typed").exists()
    use = tmp_path / "use.py"
    use.write_text(
        "import numpy as np\n"
        "import jointwise\n"
        "result = jointwise.diagnose('a.urdf', train=['a.csv'], held_out=[{'t': np.zeros(9)}])\n"
        "size: float = result.effects[0].parameters['level'].interval[1]\n"
        "name: str = result.effects[0].alternatives[0].name\n"
        "torque: np.ndarray = jointwise.InverseDynamics('a.urdf').torque([0.0], [0.0], [0.0])\n"
        "model = jointwise.IndependentJointLearning('a.urdf', inputs='joint-motion')\n"
    )
    ignored = ["--disable-error-code", "import-untyped", "--disable-error-code", "type-arg"]
    run("mypy", "--strict", *ignored, "-p", "jointwise", cwd=tmp_path)
    run("mypy", "--strict", *ignored, "use.py", cwd=tmp_path)


def test_the_stub_is_the_extension(tmp_path):
    run("mypy.stubtest", "jointwise._core", "--ignore-disjoint-bases", cwd=tmp_path)
