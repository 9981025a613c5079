"""What a killed training resumes from: step, networks, optimisers, and what is being trained on what."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from scenegen.foundation.errors import InputError
from scenegen_trainers.models.torch_file import unpacked, write_packed

STATE = "state.pt"
_FORMAT = "training-1"


def write_state(out: Path, identity: Mapping[str, Any], step: int, learner: Mapping[str, Any]) -> None:
    """Replace the saved state, whole or not at all."""
    content = {"scenegen": _FORMAT, "identity": dict(identity), "step": step, "learner": dict(learner)}
    write_packed(out / STATE, content)


def read_state(out: Path, identity: Mapping[str, Any]) -> dict[str, Any] | None:
    """The saved state; None where a training begins.

    Raises
    ------
    InputError
        If `out` holds the state of another training; names the first key that differs.
    """
    path = out / STATE
    if not path.exists():
        return None
    content = unpacked(path)
    if content.get("scenegen") != _FORMAT:
        raise InputError(f"{path}: no state of a training; choose another --out")
    differs = _difference(content["identity"], dict(identity))
    if differs:
        raise InputError(
            f"{out} holds a training with another {differs}; choose another --out, or remove it to start anew"
        )
    return content


def _difference(old: Any, new: Any, path: str = "") -> str:
    """Dotted name of the first key at which two nested mappings differ, with both values; the model comes first."""
    if not (isinstance(old, Mapping) and isinstance(new, Mapping)):
        same = old == new or (isinstance(old, list | tuple) and list(old) == list(new))
        return "" if same else f"{path.removeprefix('recipe.')} ({str(old)[:40]}, now {str(new)[:40]})"
    for key in sorted({*old, *new}, key=lambda key: (key != "model", key)):
        found = _difference(old.get(key), new.get(key), f"{path}.{key}" if path else str(key))
        if found:
            return found
    return ""
