"""Reading a scene: the parent's side. Starts the limited child, waits, and checks what it left."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from scenegen.foundation.errors import InputError
from scenegen.foundation.pool import Done, Failed, Pool, Task
from scenegen.maps.own_scene.identity import file_hash
from scenegen.maps.own_scene.limits import MAX_FACES, READING_BYTES, READING_CPU_S, READING_WALL_S
from scenegen.maps.own_scene.raw import Names, RawScene
from scenegen.maps.own_scene.sidecar import Sidecar

_CHILD = "scenegen.maps.own_scene.parse:worker"
_ENVIRONMENT = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


def read_scene(path: Path, sidecar: Sidecar) -> RawScene:
    """Read the triangles of a scene file in a process of its own.

    Parameters
    ----------
    path : Path
    sidecar : Sidecar
        Says which way is up and how long a unit is.

    Raises
    ------
    InputError
        If the file cannot be read, is broken beyond repair, or asks for more than the limits; one line.
    """
    expected = file_hash(path)
    up_axis = sidecar.up_axis or ("y" if path.suffix.lower() in (".glb", ".gltf") else "z")
    with tempfile.TemporaryDirectory(prefix="scenegen-") as folder:
        out = Path(folder) / "scene.npz"
        payload = {
            "file": str(path.absolute()),
            "up_axis": up_axis,
            "unit_m": sidecar.unit_m,
            "out": str(out),
        }
        value = _ask(path, payload)
        if value["sha256"] != expected:
            raise InputError(f"{path}: changed while it was read; run the command again")
        with np.load(out, allow_pickle=False) as arrays:
            vertices, faces, part = arrays["vertices"], arrays["faces"], arrays["part"]
    parts = tuple(
        Names(str(node), str(mesh), str(made), int(owner)) for node, mesh, made, owner in value["parts"]
    )
    assert np.isfinite(vertices).all() and 0 < len(faces) <= MAX_FACES
    assert faces.min() >= 0 and faces.max() < len(vertices) and part.min() >= 0 and part.max() < len(parts)
    east, north = map(float, value["shift_m"])
    repairs = tuple((str(what), int(count)) for what, count in value["repairs"])
    return RawScene(vertices, faces, part, parts, repairs, (east, north))


def _ask(path: Path, payload: dict[str, Any]) -> dict[str, Any]:
    """Give the file to a fresh child; one attempt."""
    with Pool(_CHILD, {}, 1, environment=_ENVIRONMENT, silence_s=READING_WALL_S, strikes=1) as pool:
        for event in pool.run([Task(str(path), "scene", payload)]):
            if isinstance(event, Done):
                return event.value
            if isinstance(event, Failed):
                failure = event.failure
                if failure.exit_code is not None:
                    raise InputError(f"{path}: {failure.message}")
                raise InputError(
                    f"{path}: cannot be read: {failure.message} (limits: {READING_CPU_S} s of CPU time, "
                    f"{READING_BYTES >> 30} GiB); is it sound, and not too large?"
                )
    raise AssertionError("a task always ends")
