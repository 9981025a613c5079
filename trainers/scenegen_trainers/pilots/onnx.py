"""Depth networks as ONNX graphs, run by onnxruntime on the CPU.

The graph takes one or two float32 inputs of shape (n, rows, columns) or (n, 1, rows, columns), counts first and the
previous frame's counts second, and gives depth in metres in one of these shapes. A batch size fixed to 1 is fine: such
a graph is asked flight by flight.
"""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float32

from scenegen.foundation.errors import InputError
from scenegen_flythrough.loop.pilot import Need, Observation
from scenegen_render.camera import Camera
from scenegen_trainers.pilots.camera_check import check_camera
from scenegen_trainers.pilots.frames import Frames, depth, frames


class OnnxDepth:
    """A depth network as an ONNX graph.

    Parameters
    ----------
    path : Path
    camera : Camera
        Whose frames it will be given.

    Raises
    ------
    InputError
        If onnxruntime is missing, the file is no graph, or the graph takes something else than such frames.
    """

    needs: frozenset[Need] = frozenset({"thermal"})

    def __init__(self, path: Path, camera: Camera) -> None:
        self.name = path.stem
        self._session = _session(path)
        inputs = self._session.get_inputs()
        if not 1 <= len(inputs) <= 2 or any(i.type != "tensor(float)" for i in inputs):
            kinds = ", ".join(f"{i.name}: {i.type}" for i in inputs)
            raise InputError(
                f"{path}: takes {kinds}; a depth network takes counts and previous counts, float32"
            )
        for entry in inputs:
            _check_shape(path, entry, camera)
        self._inputs = [(i.name, len(i.shape) == 4) for i in inputs]
        self._one_by_one = inputs[0].shape[0] == 1

    def estimate(self, seen: Observation) -> Float32[np.ndarray, "n rows columns"]:
        """Planar depth [m] of every pixel."""
        both = frames(seen)
        if not self._one_by_one:
            return self._run(both)
        rows = [self._run((both[0][k : k + 1], both[1][k : k + 1])) for k in range(len(both[0]))]
        return np.concatenate(rows)

    def _run(self, both: tuple[Frames, Frames]) -> Frames:
        given = {
            name: layer[:, None] if channel else layer
            for (name, channel), layer in zip(self._inputs, both, strict=False)
        }
        return depth(np.asarray(self._session.run(None, given)[0]), both[0])


def _check_shape(path: Path, entry: Any, camera: Camera) -> None:
    """Rank, channels and, where the graph fixes them, rows and columns."""
    shape = list(entry.shape)
    if len(shape) not in (3, 4) or (len(shape) == 4 and shape[1] not in (1, None)):
        raise InputError(
            f"{path}: its input '{entry.name}' has shape {shape}; "
            "a frame is (n, rows, columns) or (n, 1, rows, columns)"
        )
    fixed = {k: v for k, v in zip(("height_px", "width_px"), shape[-2:], strict=True) if isinstance(v, int)}
    check_camera(path, fixed, camera)


def _session(path: Path) -> Any:
    try:
        runtime: Any = importlib.import_module("onnxruntime")
    except ImportError:
        raise InputError(
            f"{path}: an ONNX graph needs onnxruntime: pip install 'thermal-scenegen[onnx]'"
        ) from None
    options = runtime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.log_severity_level = 4
    try:
        return runtime.InferenceSession(str(path), options, providers=["CPUExecutionProvider"])
    except Exception as error:  # whatever onnxruntime thinks of a file that is not its own
        raise InputError(f"{path}: no ONNX graph ({' '.join(str(error).split())[:160]})") from None
