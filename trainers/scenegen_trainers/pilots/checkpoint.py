"""Depth networks of torch as sources of depth; their files are described in `scenegen_trainers.models.torch_file`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float32

from scenegen_flythrough.loop.pilot import Need, Observation
from scenegen_render.camera import Camera
from scenegen_trainers.models.torch_file import PROTOCOL, built, network_content, torch_for, write_packed
from scenegen_trainers.pilots.camera_check import check_camera, frames_of
from scenegen_trainers.pilots.frames import depth, frames


class TorchDepth:
    """A depth network of torch, on the CPU.

    Parameters
    ----------
    path : Path
        Checkpoint.
    camera : Camera
        Whose frames it will be given.

    Raises
    ------
    InputError
        If torch is missing, the file is no such checkpoint, the network cannot be built, or it was trained with another
        camera.
    """

    needs: frozenset[Need] = frozenset({"thermal"})

    def __init__(self, path: Path, camera: Camera) -> None:
        self.name = path.stem
        self._torch = torch_for(path)
        content = network_content(path)
        check_camera(path, content.get("camera"), camera)
        self._network = built(path, content)

    def estimate(self, seen: Observation) -> Float32[np.ndarray, "n rows columns"]:
        """Planar depth [m] of every pixel."""
        torch = self._torch
        now, before = frames(seen)
        with torch.inference_mode():
            answer = self._network(torch.from_numpy(now), torch.from_numpy(before))
        return depth(answer.numpy(), now)


def save(
    path: Path,
    network: Any,
    config: Mapping[str, Any],
    camera: Camera | None = None,
) -> None:
    """Write a network of your own as such a file.

    Parameters
    ----------
    path : Path
    network : torch.nn.Module
        Of a class that can be imported by its name.
    config : mapping
        The keyword arguments it was built with; plain data.
    camera : Camera, optional
        What it was trained on.
    """
    kind = type(network)
    content: dict[str, Any] = {
        "scenegen": PROTOCOL,
        "network": f"{kind.__module__}:{kind.__qualname__}",
        "config": dict(config),
        "state": network.state_dict(),
    }
    if camera is not None:
        content["camera"] = frames_of(camera.width_px, camera.height_px, camera.focal_px)
    write_packed(path, content)
