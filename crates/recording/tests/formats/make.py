"""Writes the recordings of this folder, each with the Python library of its format.

    pip install numpy pandas scipy pyarrow mcap mcap-ros2-support rosbags zstandard
    python make.py

All hold the same motion of two joints: 60 rows at 100 Hz, from 1 700 000 000.25 s where stamps are of a calendar.
"""

import csv
import datetime
import gzip
import io
import math
import pathlib
import shutil
import struct

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import scipy.io
import zstandard
from mcap.writer import CompressionType, Writer
from mcap_ros2.writer import Writer as RosWriter
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as BagWriter
from rosbags.typesys import Stores, get_typestore

HERE = pathlib.Path(__file__).parent
ROWS = 60
EPOCH = 1_700_000_000
NAMES = ["shoulder", "elbow"]


def row(k):
    t = 0.01 * k
    q = [0.8 * math.sin(2 * t), 0.3 * math.cos(5 * t) - 1]
    qd = [1.6 * math.cos(2 * t), -1.5 * math.sin(5 * t)]
    tau = [5 * math.cos(3 * t) + 1, -2 * math.sin(4 * t)]
    return t, q, qd, tau


def nanos(k):
    return 250_000_000 + 10_000_000 * k


def text(name, header, cells, separator=","):
    with open(HERE / name, "w", newline="") as file:
        writer = csv.writer(file, delimiter=separator, lineterminator="\n")
        if header:
            writer.writerow(header)
        for k in range(ROWS):
            writer.writerow(cells(k, *row(k)))


def numbered(names, joints=2):
    return [f"{name}_{i}" for name in names for i in range(joints)]


def indexed(name, joints=2):
    return [f"{name}[{i}]" for i in range(joints)]


def csv_files():
    ur = ["actual_q", "actual_qd", "actual_current", "actual_current_as_torque"]
    text("ur_rtde.csv", ["timestamp", *numbered(ur)], lambda k, t, q, qd, tau: [1000 + t, *q, *qd, 0.5, 0.5, *tau], " ")
    text("ur_rtde_current.csv", ["timestamp", *numbered(ur[:3])], lambda k, t, q, qd, tau: [1000 + t, *q, *qd, *tau])
    # libfranka writes q_d of the state and of the command, and spaces after some commas.
    franka = ["duration", " success rate"]
    franka += indexed(" q") + indexed("q_d") + indexed("dq") + indexed("tau_J") + ["sent commands"] + indexed("q_d")
    text("libfranka.csv", franka, lambda k, t, q, qd, tau: [10 * k, 1, *q, *q, *qd, *tau, "", *q])
    plotjuggler = ["__time"]
    plotjuggler += [f"/joint_states/{name}/{field}" for name in NAMES for field in ["position", "velocity", "effort"]]
    text(
        "plotjuggler.csv",
        plotjuggler,
        lambda k, t, q, qd, tau: [f"{EPOCH}.{nanos(k):09}", q[0], qd[0], tau[0], q[1], qd[1], tau[1]],
    )
    ros1 = ["%time", "field.header.seq", "field.header.stamp", "field.header.frame_id"]
    ros1 += [f"field.{field}{i}" for field in ["name", "position", "velocity", "effort"] for i in range(2)]
    stamp = EPOCH * 10**9
    text(
        "rostopic_echo.csv",
        ros1,
        lambda k, t, q, qd, tau: [stamp + nanos(k) + 999, k, stamp + nanos(k), "base", *NAMES, *q, *qd, *tau],
    )
    text("ros2_topic_echo.csv", None, lambda k, t, q, qd, tau: [EPOCH, nanos(k), "base", *NAMES, *q, *qd, *tau])
    own = [f"{prefix}_{name}" for prefix in ["q", "qd", "tau"] for name in NAMES]
    text("sec_nanosec.csv", ["sec", "nanosec", *own], lambda k, t, q, qd, tau: [EPOCH, nanos(k), *q, *qd, *tau])
    iso = lambda k: datetime.datetime.fromtimestamp(EPOCH, datetime.UTC) + datetime.timedelta(microseconds=nanos(k) // 1000)
    text("iso8601.csv", ["t", *own], lambda k, t, q, qd, tau: [iso(k).isoformat(), *q, *qd, *tau])
    text("plain.csv", ["t", *own], lambda k, t, q, qd, tau: [t, *q, *qd, *tau])
    plain = (HERE / "plain.csv").read_bytes()
    with gzip.GzipFile(HERE / "plain.csv.gz", "wb", mtime=0) as file:
        file.write(plain)
    (HERE / "plain.csv.zst").write_bytes(zstandard.compress(plain))


if __name__ == "__main__":
    csv_files()
