"""Runs ours and theirs alternately, and prints each row's ratio of times: median, smallest and largest of the pairs."""

import argparse
import gzip
import json
import os
import pathlib
import statistics
import subprocess
import sys
import time
from xml.etree import ElementTree

HERE = pathlib.Path(__file__).resolve().parent
ROBOT = HERE.parents[1] / "assets" / "puma560.urdf"
# So few that a pass over them is rarely interrupted, in theirs, which takes longer, as in ours.
STATES = "1000"

# Row, our key, their key, target. A batch is compared with their calls one by one.
ARM = [
    ("inverse dynamics", "inverse_dynamics", "rnea", 0.35),
    ("inverse dynamics with features", "features", "rnea", 0.6),
    ("forward dynamics", "forward_dynamics", "aba", 0.45),
    ("mass matrix", "mass_matrix", "crba", 0.6),
    ("mass matrix, against Convention::LOCAL", "mass_matrix", "crba_local", None),
    ("torque regressor", "regressor", "regressor", 0.3),
    ("inverse dynamics, batch", "inverse_dynamics_batch", "rnea", 0.15),
    ("forward dynamics, batch", "forward_dynamics_batch", "aba", 0.15),
    ("mass matrix, batch", "mass_matrix_batch", "crba", 0.15),
    ("torque regressor, batch", "regressor_batch", "regressor", 0.15),
]


class Missing(Exception):
    """A peer that cannot run here."""


def run(command):
    """The JSON that a program prints, on one thread."""
    one = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", MKL_NUM_THREADS="1", RAYON_NUM_THREADS="1")
    done = subprocess.run([str(part) for part in command], env=one, capture_output=True, text=True)
    if done.returncode:
        raise Missing(f"{command[0]}: {done.stderr.strip().splitlines()[-1:]}")
    return json.loads(done.stdout)


def pairs(rounds, ours, theirs):
    """The answers of both, in turns, who is first changing."""
    answers = []
    for turn in range(rounds):
        order = [ours, theirs] if turn % 2 == 0 else [theirs, ours]
        found = {id(command): run(command) for command in order}
        answers.append((found[id(ours)], found[id(theirs)]))
    return answers


def row(name, ratios, target, note=""):
    middle = statistics.median(ratios)
    verdict = "" if target is None else f"{target:g} {'met' if middle <= target else 'missed'}"
    print(f"| {name} | {middle:.3g} | {min(ratios):.3g} to {max(ratios):.3g} | {verdict} | {note} |", flush=True)


def same(ours, theirs, tolerance):
    """Refuses to compare the times of different answers."""
    for a, b in zip(ours, theirs, strict=True):
        if abs(a - b) > tolerance * max(abs(a), abs(b)):
            sys.exit(f"the answers differ: {ours} and {theirs}")


def pinocchio(build):
    """Compiles the peer against the pip packages."""
    try:
        import pinocchio as pin
    except ImportError:
        raise Missing("Pinocchio: pip install pin cmeel-eigen cmeel-boost cmeel-urdfdom cmeel-urdfdom-headers")
    prefix = next(p for p in pathlib.Path(pin.__file__).parents if (p / "include" / "pinocchio").exists())
    include = prefix / "include"
    folders = [include, include / "eigen3", include / "urdfdom_headers", include / "urdfdom"]
    program = build / "pinocchio"
    # The limits are those that Pinocchio itself is built with; the arity is what its visitors need.
    options = """-O3 -DNDEBUG -std=c++17 -Wno-deprecated-declarations -DPINOCCHIO_ENABLE_TEMPLATE_INSTANTIATION
        -DBOOST_MPL_LIMIT_LIST_SIZE=30 -DBOOST_MPL_LIMIT_VECTOR_SIZE=30 -DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS
        -DBOOST_FUSION_INVOKE_MAX_ARITY=12""".split()
    command = ["g++", *options, HERE / "pinocchio.cpp", "-o", program, *[f"-I{folder}" for folder in folders]]
    command += [f"-L{prefix}/lib", f"-Wl,-rpath,{prefix}/lib", "-lpinocchio_default", "-lpinocchio_parsers"]
    try:
        subprocess.run(command, check=True)
    except (FileNotFoundError, subprocess.CalledProcessError) as error:
        raise Missing(f"Pinocchio: g++ did not build the program ({error})")
    return program, pin.__version__


def arm(programs, build, rounds):
    program, version = pinocchio(build)
    answers = pairs(rounds, [programs / "arm_peers", ROBOT, STATES], [program, ROBOT, STATES])
    same(answers[0][0]["sums"], answers[0][1]["sums"], 1e-9)
    for name, our, their, target in ARM:
        ratios = [ours["ns"][our] / theirs["ns"][their] for ours, theirs in answers]
        times = [statistics.median(side["ns"][key] for side in found) for found, key in zip(zip(*answers), (our, their))]
        row(name, ratios, target, f"{times[0]:.0f} ns, Pinocchio {version} {their} {times[1]:.0f} ns")


def possible_robot(build):
    """The robot with masses and tensors that a body can have: MuJoCo refuses others, of which the paper's robot has two."""
    tree = ElementTree.parse(ROBOT)
    for inertial in tree.iter("inertial"):
        mass, tensor = inertial.find("mass"), inertial.find("inertia")
        mass.set("value", str(max(float(mass.get("value")), 1e-3)))
        diagonal = [float(tensor.get(name)) for name in ("ixx", "iyy", "izz")]
        if 2 * max(diagonal) > sum(diagonal):
            for name in ("ixx", "iyy", "izz"):
                tensor.set(name, str(max(diagonal)))
    path = build / "possible.urdf"
    tree.write(path)
    return path


def plant(programs, build, rounds):
    try:
        import mujoco
    except ImportError:
        raise Missing("MuJoCo: pip install mujoco")
    robot, track = possible_robot(build), build / "track.csv"
    run([programs / "plant_peers", robot, track])
    theirs = [sys.executable, HERE / "simulate.py", robot, track]
    answers = pairs(rounds, [programs / "plant_peers", robot, track], theirs)
    for integrator in ("implicitfast", "rk4"):
        ratios, notes = [], ""
        for ours, theirs in answers:
            # The cheapest of each that keeps to a microradian.
            good = [found for found in ours["orders"] if found["error"] <= 1e-6]
            their_good = [found for found in theirs[integrator] if found["error"] <= 1e-6]
            if not good or not their_good:
                closest = min(found["error"] for found in theirs[integrator])
                sys.exit(f"no step of {integrator} reaches 1e-6 rad: {closest:.1e}")
            our, their = (min(found, key=lambda found: found["ns"]) for found in (good, their_good))
            ratios.append(our["ns"] / their["ns"])
            notes = (
                f"{our['ns'] / 1e3:.1f} µs (order {our['order']}, {our['error']:.0e} rad), MuJoCo {mujoco.__version__} "
                f"{their['ns'] / 1e3:.1f} µs ({their['steps']} steps, {their['error']:.0e} rad)"
            )
        row(f"plant, 1 ms at 1e-6 rad, against {integrator}", ratios, 1.0 if integrator == "implicitfast" else None, notes)


def joint2(build):
    table = build / "joint2.csv"
    table.write_bytes(gzip.decompress((HERE / "joint2.csv.gz").read_bytes()))
    return table


def gp(programs, build, rounds):
    try:
        import sklearn
    except ImportError:
        raise Missing("scikit-learn: pip install scikit-learn")
    table = joint2(build)
    for starts in (1, 4):
        answers = pairs(rounds, [programs / "gp_peers", "fit", table, starts], [sys.executable, HERE / "regress.py", table])
        ratios = [ours["seconds"] / theirs["seconds"] for ours, theirs in answers]
        ours, theirs = answers[-1]
        note = (
            f"{ours['seconds']:.3f} s, likelihood {ours['likelihood']:.0f}; scikit-learn {sklearn.__version__} "
            f"{theirs['seconds']:.1f} s, {theirs['likelihood']:.0f}; processor time"
        )
        row(f"GP fit, 2000 points, 13 inputs, {starts} start(s) against 1", ratios, 0.01, note)


def sparse(programs, build, rounds):
    """Noisy points by inducing points: as many for both."""
    try:
        import gpytorch
    except ImportError:
        raise Missing("GPyTorch: pip install gpytorch (several gigabytes)")
    for samples, epochs, seconds in ((20_000, 60, 60), (100_000, 12, 600)):
        train, test = (build / f"{name}{samples}.csv" for name in ("train", "test"))
        subprocess.run([programs / "torque_peers", str(samples), train, test], check=True)
        ours = [programs / "gp_peers", "sparse", train, test, "200"]
        answers = pairs(rounds, ours, [sys.executable, HERE / "sparse.py", train, test, "200", epochs])
        ours, theirs = answers[-1]
        note = f"{ours['seconds']:.0f} s, of {seconds}; GPyTorch {gpytorch.__version__} {theirs['seconds']:.0f} s, processor time"
        row(f"{samples} noisy points, time", [a["seconds"] / b["seconds"] for a, b in answers], None, note)
        note = f"{ours['error']:.3f} N m; {theirs['error']:.3f} N m; bound within {ours['gap']:.0f} nats"
        row(f"{samples} noisy points, test error", [a["error"] / b["error"] for a, b in answers], 1.0, note)


def diagnosis(programs, build, rounds):
    """The diagnosis of five recordings, and FIGAROH's identification of the same, without the import of its libraries."""
    try:
        import figaroh
    except ImportError:
        raise Missing("FIGAROH: pip install figaroh")
    testbed, case, report = programs.parent / "testbed", build / "diagnosis" / "case_000", build / "diagnosis.json"
    if not case.exists():
        effects = HERE.parents[1] / "examples" / "concealed" / "effects.toml"
        options = f"--robot seven_axis --effects {effects} --seed 11 --friction --training 4 --out {case.parent}"
        subprocess.run([testbed, "conceal", *options.split()], check=True, stdout=subprocess.DEVNULL)
    train, held_out = sorted(case.glob("train_*.csv")), case / "held_out.csv"
    ours = [testbed, "diagnose", "--robot", case / "robot.urdf", "--train", *train, "--held-out", held_out]
    ours += ["--torques-only", "--quiet", "--json", report]
    theirs = [sys.executable, HERE / "identify.py", case / "robot.urdf", *train, held_out]
    one = dict(os.environ, RAYON_NUM_THREADS="1")
    ratios, times = [], []
    for _ in range(rounds):
        begun = time.perf_counter()
        subprocess.run([str(part) for part in ours], env=one, check=True, capture_output=True)
        our = time.perf_counter() - begun
        their = run(theirs)
        ratios.append(our / their["seconds"])
        times.append((our, their["seconds"]))
    fit = json.loads(report.read_text())["fit"].values()
    median = lambda values: 100 * statistics.median(values)
    our, their_time = (statistics.median(side) for side in zip(*times))
    note = (
        f"{our:.2f} s, held-out error {median(joint['held_out_nrmse_augmented'] for joint in fit):.1f} % (median of the joints); "
        f"FIGAROH {figaroh.__version__} {their_time:.2f} s, {median(their['held_out']):.1f} % (rows near reversals included); one thread each"
    )
    row("diagnosis, 7 joints, 4 × 25 s × 250 Hz", ratios, 0.2, note)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--only", default="arm,plant,gp,diagnosis")
    parser.add_argument("--ours", type=pathlib.Path, required=True, help="folder of our programs")
    parser.add_argument("--build", type=pathlib.Path, required=True, help="folder for what is made on the way")
    options = parser.parse_args()
    parts = {"arm": arm, "plant": plant, "gp": gp, "sparse": sparse, "diagnosis": diagnosis}
    print("| row | ours / theirs, median | range | target | times of the last round or median |")
    print("|---|---|---|---|---|")
    missing = []
    for name in options.only.split(","):
        try:
            parts[name](options.ours.resolve(), options.build.resolve(), options.rounds)
        except Missing as error:
            missing.append(str(error))
    for error in missing:
        print(f"missing: {error}")
    print(f"load: {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
