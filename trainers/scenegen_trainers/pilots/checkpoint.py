"""Depth networks of torch, from a checkpoint that says how to build them.

A checkpoint is what ``torch.save`` makes of a dictionary of plain data and tensors:

    {
      "scenegen": "depth-1",                       this protocol
      "network": "package.module:Class",           a torch.nn.Module that can be imported
      "config": {"width": 64},                     its keyword arguments
      "state": network.state_dict(),
      "camera": {"width_px": 256, "height_px": 256, "hfov_deg": 90.0},   what it was trained on; optional
    }

It is read with ``weights_only``, so opening one runs no code of its own; what is built is a class the machine already
has, and only one that is a network.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float32

from scenegen.foundation.errors import InputError
from scenegen_flythrough.loop.pilot import Need, Observation
from scenegen_render.camera import Camera
from scenegen_trainers.pilots.camera_check import check_camera
from scenegen_trainers.pilots.frames import depth, frames

PROTOCOL = "depth-1"


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
        self._torch = _torch(path)
        content = self._read(path)
        check_camera(path, content.get("camera"), camera)
        self._network = self._build(path, content)

    def estimate(self, seen: Observation) -> Float32[np.ndarray, "n rows columns"]:
        """Planar depth [m] of every pixel."""
        torch = self._torch
        now, before = frames(seen)
        with torch.inference_mode():
            answer = self._network(torch.from_numpy(now), torch.from_numpy(before))
        return depth(answer.numpy(), now)

    def _read(self, path: Path) -> Mapping[str, Any]:
        try:
            content = self._torch.load(path, map_location="cpu", weights_only=True)
        except Exception as error:  # whatever torch thinks of a file that is not its own
            raise InputError(f"{path}: no checkpoint of weights and plain data ({_short(error)})") from None
        if not isinstance(content, Mapping) or content.get("scenegen") != PROTOCOL:
            raise InputError(f"{path}: no depth network: its key 'scenegen' does not say '{PROTOCOL}'")
        for key, kind in (("network", str), ("config", Mapping), ("state", Mapping)):
            if not isinstance(content.get(key), kind):
                raise InputError(f"{path}: its key '{key}' is missing or of the wrong kind")
        return content

    def _build(self, path: Path, content: Mapping[str, Any]) -> Any:
        where = content["network"]
        try:
            module, _, name = where.partition(":")
            kind = getattr(importlib.import_module(module), name)
        except Exception as error:
            raise InputError(f"{path}: its network '{where}' cannot be imported ({_short(error)})") from None
        if not (isinstance(kind, type) and issubclass(kind, self._torch.nn.Module)):
            raise InputError(f"{path}: '{where}' is not a torch.nn.Module")
        try:
            network = kind(**content["config"])
            network.load_state_dict(content["state"])
        except Exception as error:
            raise InputError(f"{path}: its weights do not fit '{where}' ({_short(error)})") from None
        return network.eval()


def save(
    path: Path,
    network: Any,
    config: Mapping[str, Any],
    camera: Camera | None = None,
) -> None:
    """Write a checkpoint.

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
        hfov = 2.0 * float(np.degrees(np.arctan(0.5 * camera.width_px / camera.focal_px)))
        content["camera"] = {
            "width_px": camera.width_px,
            "height_px": camera.height_px,
            "hfov_deg": round(hfov, 6),
        }
    _torch(path).save(content, path)


def _torch(path: Path) -> Any:
    try:
        return importlib.import_module("torch")
    except ImportError:
        raise InputError(
            f"{path}: a torch checkpoint needs torch: pip install 'thermal-scenegen[torch]'"
        ) from None


def _short(error: Exception) -> str:
    return " ".join(f"{type(error).__name__}: {error}".split())[:160]
