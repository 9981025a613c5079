"""Checkpoints of `scenegen train`: the network with its inputs and target, its camera, and how it came to be."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from scenegen.foundation.errors import InputError
from scenegen_trainers.models.network import DepthNetwork
from scenegen_trainers.models.torch_file import PROTOCOL, built, network_content, write_packed

NETWORK = f"{DepthNetwork.__module__}:{DepthNetwork.__qualname__}"

_FRAMES = ("width_px", "height_px", "hfov_deg")


@dataclass(frozen=True, eq=False)
class Checkpoint:
    """A network that was read.

    Attributes
    ----------
    network : DepthNetwork
        Ready to estimate.
    camera : mapping
        ``width_px``, ``height_px``, ``hfov_deg`` of the frames it was trained on.
    record : mapping
        How it came to be: name of the model, seed, steps, recipe, dataset.
    """

    network: DepthNetwork
    camera: Mapping[str, Any]
    record: Mapping[str, Any]


def write_checkpoint(
    path: Path,
    model: Any,
    config: Mapping[str, Any],
    camera: Mapping[str, Any],
    record: Mapping[str, Any],
) -> None:
    """Write one, whole or not at all.

    Parameters
    ----------
    path : Path
    model : torch.nn.Module
        The part that was trained.
    config : mapping
        Arguments of `DepthNetwork`.
    camera, record : mapping
        As in `Checkpoint`.
    """
    content = {
        "scenegen": PROTOCOL,
        "network": NETWORK,
        "config": dict(config),
        "state": {f"model.{name}": value.detach().cpu() for name, value in model.state_dict().items()},
        "camera": dict(camera),
        "record": dict(record),
    }
    write_packed(path, content)


def read_checkpoint(path: Path) -> Checkpoint:
    """Read one.

    Raises
    ------
    InputError
        If the file is missing, is no such checkpoint, or holds another network than it says.
    """
    content = network_content(path)
    if content["network"] != NETWORK:
        raise InputError(
            f"{path}: holds '{content['network']}', no network of `scenegen train`, which writes model.pt"
        )
    for key in ("camera", "record"):
        if not isinstance(content.get(key), Mapping):
            raise InputError(f"{path}: its key '{key}' is missing or of the wrong kind")
    for key in _FRAMES:
        if not isinstance(content["camera"].get(key), int | float):
            raise InputError(f"{path}: does not say the '{key}' of the frames it was trained on")
    return Checkpoint(built(path, content), dict(content["camera"]), dict(content["record"]))
