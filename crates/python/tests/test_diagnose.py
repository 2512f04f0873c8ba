"""A diagnosis from Python is the program's."""

import json
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np
import pytest

import jointwise
from conftest import ARM, CASES, COULOMB, ROOT, VISCOUS, frame

FRICTION = ("tests/cases/friction/train_1.csv", "tests/cases/friction/held_out.csv")
PAYLOAD = ("tests/cases/spring_and_payload/train_1.csv", "tests/cases/spring_and_payload/held_out.csv")


@pytest.mark.parametrize(
    ("case", "options", "flags"),
    [
        (FRICTION, {}, []),
        (PAYLOAD, {"torques_only": True, "urdf_accuracy": 0.1, "cutoff": 8.0}, ["--torques-only", "--urdf-accuracy", "0.1", "--cutoff", "8"]),
        (PAYLOAD, {"only": ["payload"], "jobs": 1}, ["--only", "payload", "--jobs", "2"]),
    ],
)
def test_the_json_is_the_programs_to_the_byte(testbed, tmp_path, monkeypatch, case, options, flags):
    train, held_out = case
    path = tmp_path / "out.json"
    robot = "tests/cases/arm.urdf"
    testbed("diagnose", "--robot", robot, "--train", train, "--held-out", held_out, "--json", path, *flags)
    monkeypatch.chdir(ROOT)
    result = jointwise.diagnose(robot, train=[train], held_out=[held_out], **options)
    assert result.to_json() == path.read_text(encoding="utf-8")
    assert result.to_dict() == json.loads(path.read_text(encoding="utf-8"))


def test_before_is_the_programs(testbed, tmp_path, monkeypatch):
    path, model, urdf = tmp_path / "out.json", tmp_path / "out.toml", tmp_path / "out.urdf"
    robot, before = "tests/cases/arm.urdf", FRICTION[0]
    files = ["--json", path, "--model", model, "--urdf", urdf]
    testbed("diagnose", "--robot", robot, "--before", before, "--train", PAYLOAD[0], "--held-out", PAYLOAD[1], "--torques-only", *files)
    monkeypatch.chdir(ROOT)
    result = jointwise.diagnose(robot, train=PAYLOAD[0], held_out=PAYLOAD[1], before=before, torques_only=True)
    assert result.to_json() == path.read_text(encoding="utf-8")
    assert result.to_toml() == model.read_text(encoding="utf-8")
    assert result.to_urdf() == urdf.read_text(encoding="utf-8")
    assert result.changed is not None


def test_effects_have_names_joints_and_intervals(found):
    assert found.verdict == "explained"
    joint = jointwise.InverseDynamics(ARM).joints[0]
    effects = {effect.name: effect for effect in found.effects if effect.joint == joint}
    for name, key, truth in (("viscous_friction", "coefficient", VISCOUS), ("coulomb_friction", "level", COULOMB)):
        parameter = effects[name].parameters[key]
        low, high = parameter.interval
        assert low < parameter.value < high
        assert abs(parameter.value - truth) < 0.1 * truth
        assert effects[name].probability is not None and effects[name].probability > 0.5
    fit = found.joints[joint]
    assert fit.augmented < 0.3 * fit.nominal
    assert found.robot and "viscous" in str(found).lower()
    with pytest.raises(AttributeError):
        found.verdict = "unexplained"


def test_the_result_is_also_a_frame_a_page_and_a_model(found):
    pytest.importorskip("pandas")
    table = found.to_frame()
    assert set(table["effect"]) == {effect.name for effect in found.effects}
    assert (table["low"] <= table["value"]).all() and (table["value"] <= table["high"]).all()
    assert found.to_html().lstrip().lower().startswith("<!doctype html>")
    assert "viscous_friction" in found.to_toml()
    assert "<robot" in found.to_urdf() and "<mujoco" in found.to_mjcf()
    assert len(found.text(everything=True)) > len(found.text())


def test_arrays_frames_and_files_are_one(found, recordings, tmp_path):
    frames = [frame(arrays) for arrays in recordings]
    of_frames = jointwise.diagnose(ARM, train=frames[0], held_out=[frames[1]], torques_only=True)
    assert of_frames.to_json() == found.to_json()
    paths = []
    for k, table in enumerate(frames):
        paths.append(tmp_path / f"{k}.csv")
        table.to_csv(paths[k], index=False)
    of_files = jointwise.diagnose(ARM, train=[paths[0]], held_out=paths[1], torques_only=True)
    text = of_files.to_json().replace(str(paths[0]), "train[0]").replace(str(paths[1]), "held_out[0]")
    assert text == found.to_json()


def test_named_columns_choose_the_order(found, recordings):
    joints = jointwise.InverseDynamics(ARM).joints
    turned = [
        {"t": arrays["t"], "q": arrays["q"][:, ::-1], "tau": arrays["tau"][:, ::-1]} for arrays in recordings
    ]
    result = jointwise.diagnose(ARM, train=turned[:1], held_out=turned[1:], joints=joints[::-1], torques_only=True)
    assert result.to_json() == found.to_json()


def test_what_is_known_is_not_found_again(found, recordings, tmp_path):
    train, held_out = recordings
    path = tmp_path / "known.toml"
    path.write_text(found.to_toml(), encoding="utf-8")
    for known in (found, path):
        again = jointwise.diagnose(ARM, train=train, held_out=held_out, known=known, torques_only=True)
        assert again.verdict == "no_mismatch"
        assert not {effect.name for effect in again.effects} & {"viscous_friction", "coulomb_friction"}


def refusal(*arguments, **options):
    with pytest.raises(jointwise.JointwiseError) as raised:
        jointwise.diagnose(*arguments, **options)
    message = str(raised.value)
    assert "--" not in message, message
    return message


def test_errors_say_where_what_and_how(recordings, tmp_path):
    train, _ = recordings
    short = {**train, "tau": train["tau"][:, :1]}
    halved = {**train, "tau": train["tau"][:100]}
    assert "nowhere.urdf" in refusal("nowhere.urdf", train=train)
    assert "did you mean \"puma560\"" in refusal("puma56", train=train)
    assert "absent.csv: cannot be read" in refusal(ARM, train="absent.csv")
    assert "train is empty" in refusal(ARM, train=[])
    assert "train[0] has no \"tau\"" in refusal(ARM, train={"t": train["t"], "q": train["q"]})
    assert "no quantity" in refusal(ARM, train={**train, "torque": train["tau"]})
    assert "train[0]" in refusal(ARM, train=short)
    masked = np.ma.array(train["tau"], mask=False)
    masked[5:9] = np.ma.masked
    assert "row 6: column \"tau_" in refusal(ARM, train={**train, "tau": masked})
    assert "has 100 values" in refusal(ARM, train=halved)
    assert "held_out[0]: contains the same samples as train[0]" in refusal(ARM, train=train, held_out=train)
    assert "given as a training and as a held-out" in refusal(ARM, train=CASES / "friction/train_1.csv", held_out=CASES / "friction/train_1.csv")
    assert "of type int" in refusal(ARM, train=[3])
    assert "cutoff is 0" in refusal(ARM, train=train, cutoff=0)
    assert "give one of diagnosed, known, ignored" in refusal(ARM, train=train, urdf_friction="all")
    assert "friction: no such effect is in the catalogue" in refusal(ARM, train=train, only="friction")
    other = frame(train).rename(columns=lambda name: name.replace("_shoulder", "_wrist"))
    assert "lock={\"shoulder\": VALUE}" in refusal(ARM, train=other)
    assert "column_map" in refusal(ARM, train=frame(train).rename(columns={"t": "time"}))
    with pytest.raises(ValueError):
        jointwise.diagnose(ARM, train=frame(train).iloc[:1])


def test_units_come_first(recordings, tmp_path):
    train, _ = recordings
    millinewton = {**train, "tau": 1000.0 * train["tau"]}
    with pytest.warns(jointwise.RecordingWarning, match="no effect was searched: .*mN m") as warned:
        result = jointwise.diagnose(ARM, train=millinewton, torques_only=True)
    assert not any("--" in str(warning.message) for warning in warned)
    assert result.verdict == "units_first" and result.effects == ()
    with pytest.raises(jointwise.JointwiseError, match="no effect was searched"):
        result.to_urdf()
    path = tmp_path / "map.toml"
    path.write_text(result.doubts[0].column_map, encoding="utf-8")
    mended = jointwise.diagnose(ARM, train=millinewton, torques_only=True, column_map=path)
    assert mended.doubts == () and {effect.name for effect in mended.effects} >= {"viscous_friction"}


def test_a_joint_without_a_torque_is_not_diagnosed(recordings):
    def dead(recording):
        tau = recording["tau"].copy()
        tau[:, -1] = 0.3
        return {**recording, "tau": tau}

    train, held_out = map(dead, recordings)
    result = jointwise.diagnose(ARM, train=[train], held_out=[held_out], torques_only=True)
    [group] = result.not_diagnosed
    assert group.joints[0] not in result.joints and "almost constant" in group.because
    assert str(result).startswith(f"{group.joints[0]} was not diagnosed")


def test_doubtful_recordings_are_warned_of(recordings):
    train, _ = recordings
    # Above the effort limit of the URDF, 200 N m.
    strong = {**train, "tau": train["tau"].copy()}
    strong["tau"][1000:1005, 0] += 400.0
    with pytest.warns(jointwise.RecordingWarning, match=r"train\[0\]: turn: the torque reaches"):
        result = jointwise.diagnose(ARM, train=strong, torques_only=True)
    assert any("effort limit" in note for note in result.notes)


def test_progress_is_told_and_may_stop_it(recordings):
    train, _ = recordings
    steps = []
    jointwise.diagnose(ARM, train=train, torques_only=True, progress=steps.append)
    assert len(steps) > 3 and all(isinstance(step, str) for step in steps)

    class Enough(Exception):
        pass

    def stop(_):
        raise Enough

    with pytest.raises(Enough):
        jointwise.diagnose(ARM, train=train, progress=stop)


def test_other_threads_run_meanwhile(recordings):
    train, _ = recordings
    ticks = []
    done = threading.Event()

    def tick():
        while not done.wait(0.005):
            ticks.append(time.monotonic())

    thread = threading.Thread(target=tick)
    thread.start()
    start = time.monotonic()
    jointwise.diagnose(ARM, train=train, torques_only=True)
    took = time.monotonic() - start
    done.set()
    thread.join()
    assert len(ticks) > 0.1 * took / 0.005


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGINT for one process")
def test_ctrl_c_interrupts(tmp_path):
    script = textwrap.dedent(
        f"""
        import os, signal, jointwise
        # A process that was begun in the background ignores Ctrl-C, and so do its children.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        def started(_):
            global started
            os.kill(os.getpid(), signal.SIGINT)
        try:
            jointwise.diagnose({str(ARM)!r}, train=[{str(ROOT / FRICTION[0])!r}], progress=started)
        except KeyboardInterrupt:
            print("interrupted")
        """
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert done.stdout == "interrupted\n", done.stderr


def test_recordings_with_another_load_are_told(monkeypatch):
    monkeypatch.chdir(ROOT)
    result = jointwise.diagnose("tests/cases/arm.urdf", train=[PAYLOAD[0], FRICTION[0]], held_out=FRICTION[1])
    assert result.different_load is not None
    assert result.different_load.recordings == (PAYLOAD[0],)
    low, high = result.different_load.more_than_others.interval
    assert low < 1.0 < high
    alone = jointwise.diagnose("tests/cases/arm.urdf", train=FRICTION[0], held_out=FRICTION[1])
    assert alone.different_load is None
    assert dict(alone.constant_torques) == {}


def test_small_constant_torques_of_all_joints(monkeypatch):
    pandas = pytest.importorskip("pandas")
    monkeypatch.chdir(ROOT)
    constants = {"turn": 0.012, "shoulder": -0.014, "elbow": 0.004}
    train, held_out = (pandas.read_csv(path) for path in FRICTION)
    for joint, constant in constants.items():
        train[f"tau_{joint}"] += constant
        held_out[f"tau_{joint}"] += constant
    result = jointwise.diagnose("tests/cases/arm.urdf", train=train, held_out=held_out)
    assert result.constant_torques.keys() == constants.keys()
    for joint, constant in constants.items():
        low, high = result.constant_torques[joint].interval
        assert low < constant < high
