"""A source of depth in a process of its own: one that crashes its process costs the flights it was asked about.

Native code can end a process without a word, and would take the whole batch with it. Flights whose batch was lost like
that are flown once more with the network in such a box: `BoxedSource` asks it over a pipe, and when it dies says so as
any pilot that raises does, and starts it anew for the flights that are left. Planners stay outside and forget nothing.
It answers the same as without a box, some milliseconds later.
"""

from __future__ import annotations

import base64
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float32, Shaped

from scenegen.foundation.agenda import Task
from scenegen.foundation.worker_process import WorkerProcess
from scenegen_flythrough.loop.pilot import Need, Observation
from scenegen_flythrough.loop.pilots import DepthSource
from scenegen_render.camera import Camera

WORKER = "scenegen_trainers.pilots.box:worker"
"""What the process does."""


class BoxedSource:
    """A source of depth that is asked over a pipe.

    Parameters
    ----------
    name : str
    needs : frozenset of "depth", "thermal"
    spec : mapping
        Of the pilot, as plain data.
    camera : Camera
    """

    def __init__(self, name: str, needs: frozenset[Need], spec: Mapping[str, Any], camera: Camera) -> None:
        self.name, self.needs = name, needs
        self._setup = {"spec": dict(spec), "camera": asdict(camera), "path": str(Path.cwd())}
        self._process: WorkerProcess | None = None
        # Linux ends a child with the thread that started it, and pilots are asked in a new thread each time.
        self._line = ThreadPoolExecutor(max_workers=1, thread_name_prefix="box")

    def estimate(self, seen: Observation) -> Float32[np.ndarray, "n rows columns"]:
        """Planar depth [m] of every pixel.

        Raises
        ------
        RuntimeError
            If the process died over it, or with what the source itself raised.
        """
        return self._line.submit(self._asked, plain(seen)).result()

    def close(self) -> None:
        """End the process; it would otherwise end with this one."""
        self._line.shutdown()
        if self._process is not None:
            self._process.kill()
            self._process = None

    def _asked(self, payload: dict[str, Any]) -> Float32[np.ndarray, "n rows columns"]:
        if self._process is None:
            self._process = WorkerProcess(WORKER, self._setup, {})
        process = self._process
        process.give(Task("estimate", "box", payload))
        try:
            kind, value = process.receive()
            while kind == "ready":
                kind, value = process.receive()
        except (EOFError, OSError):
            self._process = None
            raise RuntimeError(f"its process {process.bury()}") from None
        if kind == "unready":
            self._process = None
            process.kill()
        if kind != "done":
            raise RuntimeError(value["message"])
        depth_m: np.ndarray = array(value["depth_m"])
        return depth_m


def worker(setup: Mapping[str, Any]) -> Callable[..., dict[str, Any]]:
    """The inside of the box."""
    import cv2

    from scenegen_trainers.pilots.modules import find_modules_here
    from scenegen_trainers.pilots.spec import PilotSpec, raise_source

    find_modules_here(setup["path"])
    cv2.setNumThreads(1)
    facts: dict[str, Any] = {k: tuple(v) if isinstance(v, list) else v for k, v in setup["camera"].items()}
    camera = Camera(**facts)
    source: DepthSource = raise_source(PilotSpec(**setup["spec"]), camera)

    def handle(task: Mapping[str, Any], say: Callable[[dict[str, Any]], None]) -> dict[str, Any]:
        return {"depth_m": packed(np.asarray(source.estimate(observation(task, camera))))}

    return handle


def plain(seen: Observation) -> dict[str, Any]:
    """An observation as plain data, but for its camera."""
    values = {field.name: getattr(seen, field.name) for field in fields(seen) if field.name != "camera"}
    return {name: packed(value) if isinstance(value, np.ndarray) else value for name, value in values.items()}


def observation(values: Mapping[str, Any], camera: Camera) -> Observation:
    """The observation it was."""
    arrays = {name: array(value) if isinstance(value, dict) else value for name, value in values.items()}
    return Observation(camera=camera, **arrays)


def packed(values: Shaped[np.ndarray, "..."]) -> dict[str, Any]:
    """An array as plain data."""
    data = base64.b64encode(np.ascontiguousarray(values).tobytes()).decode("ascii")
    return {"type": values.dtype.str, "shape": list(values.shape), "data": data}


def array(value: Mapping[str, Any]) -> Any:
    """The array it was."""
    flat = np.frombuffer(base64.b64decode(value["data"]), np.dtype(value["type"]))
    return flat.reshape(value["shape"])
