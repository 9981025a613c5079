"""What a scene is called, which files belong to it, and what tells two of them apart."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Collection
from pathlib import Path

from scenegen.foundation.canonical import digest
from scenegen.foundation.errors import InputError
from scenegen.maps.own_scene.limits import FORMATS, MAX_FILE_BYTES, MAX_SIDECAR_BYTES

SHARED_SIDECAR = "scene.yaml"
"""Name of the sidecar of every scene of a folder that has none of its own name."""

_LONGEST_NAME = 24


def is_scene_path(name: str) -> bool:
    """Whether what was given as a map is the path of a scene file."""
    return name.lower().endswith(FORMATS)


def scene_name(file: str, taken: Collection[str] = ()) -> str:
    """Name of a scene in directories and keys: its file's, in lower-case letters, digits and underscores.

    Parameters
    ----------
    file : str
    taken : collection of str
        Names that mean something else (the map families): those get ``scene_`` in front.
    """
    name = re.sub(r"[^a-z0-9]+", "_", Path(file).stem.lower()).strip("_")
    if not re.match(r"[a-z]", name) or name in taken:
        name = f"scene_{name}"
    return name[:_LONGEST_NAME].rstrip("_")


def sidecar_path(scene: Path) -> Path | None:
    """The scene's own sidecar (``house.yaml`` beside ``house.glb``), else the folder's ``scene.yaml``, else none."""
    for path in (scene.with_suffix(".yaml"), scene.with_name(SHARED_SIDECAR)):
        if path.is_file():
            return path
    return None


def content_hash(scene: Path) -> str:
    """SHA-256 of the bytes of a scene and of its sidecar: another content is another recipe.

    Raises
    ------
    InputError
        If the scene is missing, no regular file, empty or too large.
    """
    sidecar = sidecar_path(scene)
    return digest(
        {
            "scene": file_hash(scene),
            "format": scene.suffix.lower(),
            "sidecar": _hash(sidecar, MAX_SIDECAR_BYTES) if sidecar is not None else None,
        }
    )


def file_hash(scene: Path) -> str:
    """SHA-256 of the scene file alone. Errors as `content_hash`."""
    if scene.suffix.lower() not in FORMATS:
        raise InputError(f"{scene}: is no scene; scenes end in {', '.join(FORMATS)}")
    return _hash(scene, MAX_FILE_BYTES)


def _hash(path: Path, most: int) -> str:
    try:
        if not path.is_file():
            what = "is no regular file" if path.exists() else "does not exist"
            raise InputError(f"{path}: {what}; give the path of a scene file")
        size = path.stat().st_size
        if not 0 < size <= most:
            what = f"has {size / 2**20:,.0f} MiB, more than {most >> 20}" if size else "is empty"
            raise InputError(f"{path}: {what}; a scene has to fit into one world")
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise InputError(f"{str(path)!r}: cannot be read: {reason}") from None
