"""Writes the recordings of this folder, each with the Python library of its format.

    pip install numpy pandas scipy pyarrow mcap mcap-ros2-support rosbags zstandard lz4
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


STORE = get_typestore(Stores.ROS2_HUMBLE)
JointState = STORE.types["sensor_msgs/msg/JointState"]
Header = STORE.types["std_msgs/msg/Header"]
Time = STORE.types["builtin_interfaces/msg/Time"]


def joint_state(stamp, names, position, velocity, effort, little_endian=True):
    """A message in CDR; the stamp in ns."""
    header = Header(stamp=Time(sec=stamp // 10**9, nanosec=stamp % 10**9), frame_id="base")
    fields = [np.array(values, dtype=np.float64) for values in (position, velocity, effort)]
    message = JointState(header, names, *fields)
    return bytes(STORE.serialize_cdr(message, JointState.__msgtype__, little_endian=little_endian))


def bag_messages():
    """The motion with a finger that has no effort; every other message has another order of the names."""
    for k in range(ROWS):
        _, q, qd, tau = row(k)
        names, q, qd, tau = ["finger", *NAMES], [0.02, *q], [0.0, *qd], [math.nan, *tau]
        if k % 2:
            names, q, qd, tau = names[::-1], q[::-1], qd[::-1], tau[::-1]
        stamp = EPOCH * 10**9 + nanos(k)
        # Logged late.
        yield stamp + 1_000_000 + 300_000 * (k % 3), joint_state(stamp, names, q, qd, tau)


def mcap_file(name, compression, topics):
    """`topics` are lists of (time of logging, CDR)."""
    with open(HERE / name, "wb") as file:
        writer = Writer(file, chunk_size=4096, compression=compression)
        writer.start(profile="ros2", library="make.py")
        definition = STORE.generate_msgdef("sensor_msgs/msg/JointState", ros_version=2)[0]
        schema = writer.register_schema("sensor_msgs/msg/JointState", "ros2msg", definition.encode())
        for topic, messages in topics.items():
            channel = writer.register_channel(topic, "cdr", schema)
            for logged, data in messages:
                writer.add_message(channel, logged, data, logged)
        writer.finish()


def mcap_files():
    mcap_file("joint_states.mcap", CompressionType.ZSTD, {"/joint_states": bag_messages()})
    # Big-endian; positions and velocities in one topic, efforts in another 2.5 ms later, and a reference.
    stamps = [EPOCH * 10**9 + nanos(k) for k in range(ROWS)]
    motion = [(t, joint_state(t, NAMES, *row(k)[1:3], [], False)) for k, t in enumerate(stamps)]
    later = [t + 2_500_000 for t in stamps]
    effort = [(t, joint_state(t, NAMES, [], [], row(k + 0.25)[3], False)) for k, t in enumerate(later)]
    both = [(t, joint_state(t, NAMES, *row(k)[1:], False)) for k, t in enumerate(stamps)]
    mcap_file("two_topics.mcap", CompressionType.LZ4, {"/motion": motion, "/torques": effort})
    wanted = [(t, joint_state(t, NAMES, [0, 0], [], [], False)) for t in stamps[::3]]
    mcap_file("ambiguous.mcap", CompressionType.LZ4, {"/a": both, "/b": both, "/wanted": wanted})
    unstamped = [(t, joint_state(0, NAMES, *row(k)[1:])) for k, t in enumerate(stamps)]
    mcap_file("unstamped.mcap", CompressionType.NONE, {"/joint_states": unstamped})
    # Written by the ROS 2 writer of MCAP itself.
    with open(HERE / "ros_writer.mcap", "wb") as file:
        writer = RosWriter(file)
        header = "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n"
        header += "=" * 80 + "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
        header += "=" * 80 + "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
        schema = writer.register_msgdef("sensor_msgs/msg/JointState", header)
        for k, stamp in enumerate(stamps):
            _, q, qd, tau = row(k)
            time = {"sec": stamp // 10**9, "nanosec": stamp % 10**9}
            message = {"header": {"stamp": time, "frame_id": ""}, "name": NAMES}
            message |= {"position": q, "velocity": qd, "effort": tau}
            writer.write_message("/joint_states", schema, message, log_time=stamp + 5, publish_time=stamp)
        writer.finish()


def bag_folder(name, plugin, compression=None):
    path = HERE / name
    shutil.rmtree(path, ignore_errors=True)
    writer = BagWriter(path, version=9, storage_plugin=plugin)
    if compression:
        writer.set_compression(compression, CompressionFormat.ZSTD)
    with writer:
        states = writer.add_connection("/joint_states", JointState.__msgtype__, typestore=STORE)
        other = writer.add_connection("/chatter", "std_msgs/msg/String", typestore=STORE)
        text = STORE.types["std_msgs/msg/String"]("hello")
        writer.write(other, 5, STORE.serialize_cdr(text, "std_msgs/msg/String"))
        for logged, data in bag_messages():
            writer.write(states, logged, data)


def bags():
    bag_folder("bag_sqlite", StoragePlugin.SQLITE3)
    bag_folder("bag_messages", StoragePlugin.SQLITE3, CompressionMode.MESSAGE)
    bag_folder("bag_file", StoragePlugin.SQLITE3, CompressionMode.FILE)
    bag_folder("bag_mcap", StoragePlugin.MCAP)


def columns():
    """The motion as columns of names and of arrays."""
    t, q, qd, tau = (np.array(values) for values in zip(*(row(k) for k in range(ROWS))))
    named = {"t": t}
    for prefix, values in (("q", q), ("qd", qd), ("tau", tau)):
        named |= {f"{prefix}_{name}": values[:, i] for i, name in enumerate(NAMES)}
    return named, {"t": t, "q": q, "qd": qd, "tau": tau}


def parquet_files():
    named, arrays = columns()
    frame = pd.DataFrame(named)
    for compression in ("snappy", "zstd", "gzip", "lz4"):
        frame.to_parquet(HERE / f"plain_{compression}.parquet", compression=compression)
    stamps = [EPOCH * 10**9 + nanos(k) for k in range(ROWS)]
    # A text, a gap in a column that is not needed, and stamps of a calendar.
    frame = frame.assign(t=pd.to_datetime(stamps, unit="ns"), mode="run", note=[None, *range(ROWS - 1)])
    frame.to_parquet(HERE / "datetime.parquet")
    pd.DataFrame(named).assign(t=pd.to_timedelta(named["t"], unit="s")).to_parquet(HERE / "timedelta.parquet")
    pd.DataFrame(named).iloc[:0].to_parquet(HERE / "empty.parquet")
    # LeRobot: lists, single precision, a clock that starts again with each of two episodes.
    single = lambda values: pa.array(values.astype(np.float32).tolist(), pa.list_(pa.float32()))
    twice = lambda values: np.concatenate([values, values])
    data = {
        "observation.state": single(twice(arrays["q"])),
        "observation.velocity": single(twice(arrays["qd"])),
        "observation.effort": single(twice(arrays["tau"])),
        "action": single(twice(arrays["q"])),
        "timestamp": pa.array(twice(arrays["t"]).astype(np.float32)),
        "episode_index": pa.array([k // ROWS for k in range(2 * ROWS)], pa.int64()),
        "frame_index": pa.array([k % ROWS for k in range(2 * ROWS)], pa.int64()),
    }
    pq.write_table(pa.table(data), HERE / "lerobot.parquet")
    one = {name: values[:ROWS] for name, values in data.items() if name != "episode_index"}
    pq.write_table(pa.table(one), HERE / "lerobot_one_episode.parquet")
    del data["observation.effort"]
    pq.write_table(pa.table(data), HERE / "lerobot_no_torques.parquet")


def array_files():
    named, arrays = columns()
    np.savez(HERE / "named.npz", **named)
    np.savez_compressed(HERE / "short.npz", t=arrays["t"], q=arrays["q"][:-3], tau=arrays["tau"])
    np.savez_compressed(HERE / "arrays.npz", **arrays, rate=100.0, joints=np.array(NAMES))
    np.savez(HERE / "fortran.npz", **{name: np.asfortranarray(values.astype(">f8")) for name, values in arrays.items()})
    np.savez(HERE / "half.npz", **{**arrays, "q": arrays["q"].astype(np.float16)})
    np.savez(HERE / "complex.npz", **{**arrays, "q": arrays["q"].astype(complex)})
    scipy.io.savemat(HERE / "version_4.mat", {"t": arrays["t"], "q": arrays["q"], "tau": arrays["tau"]}, format="4")
    scipy.io.savemat(HERE / "named.mat", named)
    # Rows of values, as MATLAB users have them; with what is no array of numbers.
    rows = {name: values.T for name, values in arrays.items()}
    more = {"rate": 100.0, "info": {"robot": "duo"}, "names": np.array(NAMES, dtype=object), "text": "a text"}
    scipy.io.savemat(HERE / "rows.mat", rows | more, do_compression=True)
    (HERE / "new.mat").write_bytes(newer_header())


def newer_header():
    """The first bytes of a file of MATLAB's version 7.3: its header in the user block of an HDF5 file, and that file's superblock."""
    said = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Thu Mar 14 15:09:26 2024 HDF5 schema 1.00 ."
    header = said.ljust(116) + bytes(8) + b"\x00\x02IM"
    superblock = b"\x89HDF\r\n\x1a\n" + bytes([0, 0, 0, 0, 0, 8, 8, 0, 4, 0, 16, 0]) + bytes(4)
    addresses = (512).to_bytes(8, "little") + b"\xff" * 8 + (2048).to_bytes(8, "little") + b"\xff" * 8
    return header.ljust(512, b"\x00") + superblock + addresses


if __name__ == "__main__":
    csv_files()
    mcap_files()
    bags()
    parquet_files()
    array_files()
