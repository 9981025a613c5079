"""The process that reads scene files: limited, expendable, and the only one that ever sees a stranger's bytes.

It parses with trimesh, checks and repairs what came out (`scenegen.maps.own_scene.repair`) and leaves plain arrays in
a file. Whatever a broken file does to it, its parent sees one line or a dead child.
"""

from __future__ import annotations

import hashlib
import io
import warnings
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from scenegen.foundation.errors import InputError
from scenegen.foundation.worker import Emit
from scenegen.maps.own_scene.gltf import prune_glb, prune_gltf
from scenegen.maps.own_scene.limits import MAX_FACES, MAX_FILE_BYTES, READING_BYTES, READING_CPU_S
from scenegen.maps.own_scene.obj import prune_obj
from scenegen.maps.own_scene.raw import Names
from scenegen.maps.own_scene.repair import Soup, join, repair


def worker(setup: Mapping[str, Any]) -> Callable[[dict[str, Any], Emit], dict[str, Any]]:
    """Factory for `scenegen.foundation.pool.Pool`, without setup; puts this process under its limits for good."""
    _limit()
    return read


def read(payload: dict[str, Any], emit: Emit) -> dict[str, Any]:
    """Read one scene.

    Parameters
    ----------
    payload : dict
        ``file``; ``up_axis`` ("y" or "z"); ``unit_m``; ``out``, where to put the arrays (npz).

    Returns
    -------
    dict
        ``sha256`` of the bytes that were read, ``parts`` (list of `Names`), ``repairs``, ``shift_m``.
    """
    path = Path(payload["file"])
    with path.open("rb") as file:
        data = file.read(MAX_FILE_BYTES + 1)
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            # numpy's word for text that is no list of numbers
            warnings.simplefilter("error", DeprecationWarning)
            soups, ignored = parse(data, path.suffix.lower(), path.stem)
            scene = repair(join(soups), ignored, payload["up_axis"], payload["unit_m"])
    except InputError:
        raise
    except MemoryError:
        raise InputError(f"needs more than {READING_BYTES >> 30} GiB of memory to be read") from None
    except Exception as error:
        said = " ".join(str(error).split())[:120]
        raise InputError(
            f"cannot be read as {path.suffix[1:].upper()} ({type(error).__name__}: {said})"
        ) from None
    np.savez(payload["out"], vertices=scene.vertices, faces=scene.faces, part=scene.part)
    return {
        "sha256": hashlib.sha256(data).hexdigest(),
        "parts": [list(names) for names in scene.parts],
        "repairs": [list(entry) for entry in scene.repairs],
        "shift_m": list(scene.shift_m),
    }


def parse(data: bytes, ending: str, stem: str) -> tuple[list[Soup], int]:
    """Parse the bytes of a file.

    Returns
    -------
    list of Soup
        Of each part, in the order of the file.
    int
        Primitives that are not triangles.
    """
    if ending in (".glb", ".gltf"):
        pruned = prune_glb(data) if ending == ".glb" else prune_gltf(data)
        return _load(pruned.data, ending, pruned.names), pruned.ignored
    if ending == ".obj":
        text, names = prune_obj(data)
        return _load(text, ending, names), 0
    return _load(data, ending, {}, Names(stem, "", "", 0)), 0


def _load(data: bytes, ending: str, names: Mapping[str, Names], only: Names | None = None) -> list[Soup]:
    """Let trimesh read it, without resolver: nothing but these bytes can be reached."""
    import trimesh

    options: dict[str, Any] = {"split_objects": True} if ending == ".obj" else {}
    scene = trimesh.load_scene(
        io.BytesIO(data),
        file_type=ending[1:],
        resolver=None,
        process=False,
        maintain_order=True,
        skip_materials=True,
        **options,
    )
    faces = 0
    rank = {name: k for k, name in enumerate(names)}
    found: dict[int, Soup] = {}
    for node in scene.graph.nodes_geometry:
        matrix, geometry = scene.graph[node]
        mesh = scene.geometry[geometry]
        if not isinstance(mesh, trimesh.Trimesh):
            continue
        key = str(geometry) if geometry in names else node
        faces += len(mesh.faces)
        if faces > MAX_FACES:
            raise InputError(f"has more than {MAX_FACES:,} triangles; decimate it or split it")
        found[rank.get(key, 0)] = Soup(
            np.asarray(mesh.vertices, np.float64),
            np.asarray(mesh.faces, np.int64),
            np.asarray(matrix, np.float64),
            only or names[key],
        )
    return [found[k] for k in sorted(found)]


def _limit() -> None:
    """No more memory, time, files or dumps than a sound scene needs; for the rest of this process."""
    import resource

    for what, most in (
        (resource.RLIMIT_AS, READING_BYTES),
        (resource.RLIMIT_CPU, READING_CPU_S),
        (resource.RLIMIT_FSIZE, 1 << 30),
        (resource.RLIMIT_CORE, 0),
        (resource.RLIMIT_NOFILE, 64),
    ):
        _, hard = resource.getrlimit(what)
        ceiling = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(what, (ceiling, ceiling))
