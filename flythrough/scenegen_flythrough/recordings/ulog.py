"""Recordings of PX4 flight controllers: local position and attitude out of a ULog file.

Topics and frames: PX4 User Guide, uORB messages `vehicle_local_position` (north, east, down [m]) and
`vehicle_attitude` (q turns front-right-down body axes into north-east-down, scalar first).
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from scenegen.foundation.errors import InputError
from scenegen_flythrough.recordings.recording import Recording, checked

_ENU_FROM_NED = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
_FRD_FROM_FLU = np.diag([1.0, -1.0, -1.0])


def read_ulog(path: Path) -> Recording:
    """Local position as ENU, attitude as nose-left-up to ENU.

    Raises
    ------
    InputError
        In one line: without pyulog, for a file that is no ULog, or one without the two topics.
    """
    try:
        pyulog = import_module("pyulog")  # optional: only who flies a .ulg needs it
    except ImportError as error:
        raise InputError(
            f"{path}: reading .ulg takes pyulog; pip install 'thermal-scenegen[ulog]', or convert it to CSV"
        ) from error
    topics = ["vehicle_local_position", "vehicle_attitude"]
    try:
        log = pyulog.ULog(str(path), topics)
        position, attitude = (_first(log, name) for name in topics)
    except Exception as error:
        # pyulog raises bare Exceptions, KeyErrors, struct errors ... for damaged files
        raise InputError(f"{path}: not a ULog file that pyulog can read ({error})") from error
    for name, data in zip(topics, (position, attitude), strict=True):
        if data is None or len(data["timestamp"]) < 2:
            raise InputError(f"{path}: no {name} in this log; it takes {' and '.join(topics)}")
    assert position is not None
    assert attitude is not None
    turned_s, turned = _attitudes(attitude)
    time_s = position["timestamp"].astype(np.float64) * 1e-6
    keep = (
        (time_s >= turned_s[0]) & (time_s <= turned_s[-1]) & np.concatenate([[True], np.diff(time_s) > 0.0])
    )
    ned = np.stack([np.asarray(position[axis], np.float64) for axis in "xyz"], axis=1)[keep]
    if len(ned) == 0:
        raise InputError(f"{path}: position and attitude of this log do not overlap in time")
    quaternion = np.asarray(Slerp(turned_s, turned)(time_s[keep]).as_quat())
    return checked(str(path), time_s[keep], ned @ _ENU_FROM_NED.T, quaternion)


def _first(log: Any, name: str) -> dict[str, Any] | None:
    """Data of the first instance of a topic."""
    return next((d.data for d in log.data_list if d.name == name and d.multi_id == 0), None)


def _attitudes(data: dict[str, Any]) -> tuple[Any, Rotation]:
    """Times [s] and nose-left-up to ENU."""
    time_s = np.asarray(data["timestamp"], np.float64) * 1e-6
    rising = np.concatenate([[True], np.diff(time_s) > 0.0])
    wxyz = np.stack([np.asarray(data[f"q[{k}]"], np.float64) for k in range(4)], axis=1)[rising]
    matrices = Rotation.from_quat(wxyz[:, [1, 2, 3, 0]]).as_matrix()
    return time_s[rising], Rotation.from_matrix(_ENU_FROM_NED @ matrices @ _FRD_FROM_FLU)
