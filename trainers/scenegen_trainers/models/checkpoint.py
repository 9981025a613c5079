"""Checkpoints of depth networks: weights and plain data, the protocol that pilots fly by. No code travels in them."""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch

from scenegen.foundation.atomic import write_atomic
from scenegen.foundation.errors import InputError
from scenegen_trainers.models.network import DepthNetwork
from scenegen_trainers.pilots.checkpoint import PROTOCOL

NETWORK = f"{DepthNetwork.__module__}:{DepthNetwork.__qualname__}"


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
    write_atomic(path, packed(content))


def read_checkpoint(path: Path) -> Checkpoint:
    """Read one.

    Raises
    ------
    InputError
        If the file is missing, is no such checkpoint, or holds another network than it says.
    """
    content = unpacked(path)
    if content.get("scenegen") != PROTOCOL or content.get("network") != NETWORK:
        raise InputError(f"{path}: no depth network of `scenegen train`, which writes model.pt")
    try:
        network = DepthNetwork(**content["config"])
        network.load_state_dict(content["state"])
        return Checkpoint(network.eval(), dict(content["camera"]), dict(content["record"]))
    except (KeyError, TypeError, ValueError, RuntimeError, AttributeError) as error:
        reason = " ".join(str(error).split())[:160]
        raise InputError(f"{path}: what it holds does not fit the network it names ({reason})") from None


def packed(content: Mapping[str, Any]) -> bytes:
    """Plain data and tensors as the bytes of a torch file."""
    buffer = io.BytesIO()
    torch.save(dict(content), buffer)
    return buffer.getvalue()


def unpacked(path: Path) -> dict[str, Any]:
    """Read a torch file of plain data and tensors; opening one never runs code of its own.

    Raises
    ------
    InputError
        If it is missing or holds anything else.
    """
    try:
        content = torch.load(path, map_location="cpu", weights_only=True)
    except FileNotFoundError:
        raise InputError(f"{path}: no such file") from None
    except Exception as error:  # whatever torch thinks of a file that is not its own
        reason = " ".join(f"{type(error).__name__}: {error}".split())[:160]
        raise InputError(f"{path}: no checkpoint of weights and plain data ({reason})") from None
    if not isinstance(content, dict):
        raise InputError(f"{path}: no checkpoint of weights and plain data")
    return content
