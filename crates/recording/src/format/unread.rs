//! Formats that are recognised but not read, with the format to convert them into.

use super::{Format, Options};
use crate::RecordingError;
use crate::input::Input;
use crate::table::Table;

/// The first bytes of a format, its name, and the remedy.
const KNOWN: &[(&[u8], &str, &str)] = &[
    (
        b"MATLAB 7.3",
        ".mat",
        "version 7.3 (HDF5) is not read; save it again from MATLAB: save(\"run.mat\", \"t\", \"q\", \"tau\", \"-v7\"); or from Python: \
         scipy.io.savemat(\"run.mat\", {\"t\": t, \"q\": q, \"tau\": tau})",
    ),
    (
        b"\x89HDF\r\n",
        "HDF5",
        "it is not read; save its arrays with numpy.savez, or its table as Parquet or CSV",
    ),
    (
        b"#ROSBAG",
        "a bag of ROS 1",
        "it is not read; convert it with rosbags-convert into a bag of ROS 2",
    ),
    (
        b"\x93NUMPY",
        ".npy",
        "a single array has no names for its columns; save t, q and tau with numpy.savez",
    ),
];

/// The format that is recognised but not read.
pub struct Unread;

impl Format for Unread {
    fn matches(&self, input: &Input) -> bool {
        KNOWN.iter().any(|(mark, _, _)| input.head.starts_with(mark))
    }

    fn read(&self, input: Input, _: &Options<'_>) -> Result<Table, RecordingError> {
        let known = KNOWN.iter().find(|(mark, _, _)| input.head.starts_with(mark));
        let (name, remedy) = known.map_or(("a format", "it is not read"), |(_, name, remedy)| (*name, *remedy));
        Err(input.error(name, remedy))
    }
}
