"""Torch files of plain data and tensors, and the protocol of depth networks in them.

A depth network is what ``torch.save`` makes of

    {
      "scenegen": "depth-1",                       this protocol
      "network": "package.module:Class",           a torch.nn.Module that can be imported
      "config": {"width": 64},                     its keyword arguments
      "state": network.state_dict(),
      "camera": {"width_px": 256, "height_px": 256, "hfov_deg": 90.0},   what it was trained on; optional
    }

Files are read with ``weights_only``, so opening one runs no code of its own; what is built is a class the machine
already has, and only one that is a network. torch itself is imported when a file is touched.
"""

from __future__ import annotations

import importlib
import io
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from scenegen.foundation.atomic import write_atomic
from scenegen.foundation.errors import InputError

PROTOCOL = "depth-1"

_PARTS = {"network": str, "config": Mapping, "state": Mapping}


def torch_for(path: Path) -> Any:
    """The library that opens a file.

    Raises
    ------
    InputError
        If it is missing.
    """
    try:
        return importlib.import_module("torch")
    except ImportError:
        raise InputError(
            f"{path}: a torch checkpoint needs torch: pip install 'thermal-scenegen[torch]'"
        ) from None


def write_packed(path: Path, content: Mapping[str, Any]) -> None:
    """Write plain data and tensors, whole or not at all; equal content becomes equal bytes."""
    buffer = io.BytesIO()
    torch_for(path).save(_told_once(dict(content)), buffer)
    write_atomic(path, buffer.getvalue())


def _told_once(value: Any) -> Any:
    """The same plain data with one object for equal words: the format writes an object once and points to it after
    that, so that where a word came from would show in the bytes."""
    if type(value) is str:
        return sys.intern(value)
    if type(value) is dict:
        return {_told_once(key): _told_once(item) for key, item in value.items()}
    if type(value) in (list, tuple):
        return type(value)(map(_told_once, value))
    return value


def unpacked(path: Path) -> dict[str, Any]:
    """Read plain data and tensors.

    Raises
    ------
    InputError
        If the file is missing or holds anything else.
    """
    torch = torch_for(path)
    if not path.exists():
        raise InputError(f"{path}: no such file")
    if path.is_dir():
        raise InputError(f"{path}: is a directory; `scenegen train` writes a network to model.pt in it")
    try:
        content = torch.load(path, map_location="cpu", weights_only=True)
    except Exception as error:
        # whatever torch thinks of a file that is not its own; its advice would run code
        reason = type(error).__name__
        raise InputError(f"{path}: no torch file of weights and plain data, or damaged ({reason})") from None
    if not isinstance(content, dict):
        raise InputError(
            f"{path}: no torch file of weights and plain data: it holds a {type(content).__name__}"
        )
    return content


def network_content(path: Path) -> dict[str, Any]:
    """Read the file of a depth network; see the protocol above.

    Raises
    ------
    InputError
        If it is none.
    """
    content = unpacked(path)
    if content.get("scenegen") != PROTOCOL:
        raise InputError(f"{path}: no depth network: its key 'scenegen' does not say '{PROTOCOL}'")
    for key, kind in _PARTS.items():
        if not isinstance(content.get(key), kind):
            raise InputError(f"{path}: its key '{key}' is missing or of the wrong kind")
    return content


def built(path: Path, content: Mapping[str, Any]) -> Any:
    """The network of a file, ready to estimate.

    Parameters
    ----------
    path : Path
        For the messages.
    content : mapping
        Of `network_content`.

    Raises
    ------
    InputError
        If its class cannot be imported, is no network, or takes other weights.
    """
    where = content["network"]
    try:
        module, _, name = where.partition(":")
        kind = getattr(importlib.import_module(module), name)
    except Exception as error:  # foreign code: whatever its import raises
        raise InputError(f"{path}: its network '{where}' cannot be imported ({_short(error)})") from None
    if not (isinstance(kind, type) and issubclass(kind, torch_for(path).nn.Module)):
        raise InputError(f"{path}: '{where}' is not a torch.nn.Module")
    try:
        network = kind(**content["config"])
        network.load_state_dict(content["state"])
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    except Exception as error:
        raise InputError(f"{path}: its weights do not fit '{where}' ({_short(error)})") from None
    return network.eval()


def _short(error: Exception) -> str:
    return " ".join(f"{type(error).__name__}: {error}".split())[:160]
