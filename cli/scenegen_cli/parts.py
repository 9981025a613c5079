"""``scenegen maps SCENE``: what a scene file holds, and what its sidecar makes of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from scenegen.foundation.errors import InputError
from scenegen.maps.own_scene.identity import sidecar_path
from scenegen.maps.own_scene.naming import Meaning, meaning_of, meanings
from scenegen.maps.own_scene.raw import RawScene
from scenegen.maps.own_scene.reading import read_scene
from scenegen.maps.own_scene.sidecar import read_sidecar
from scenegen_cli.console import note, say, say_json, table

_COLUMNS = ("node", "mesh", "material in the file", "triangles", "made of", "class")
_SHOWN = 200


def list_parts(path: Path, *, as_json: bool) -> int:
    """List the parts of a scene, with or without a sidecar; returns the exit code.

    What is still to be mapped is said below the list: the list is what a sidecar is written from.
    """
    where = sidecar_path(path)
    sidecar = read_sidecar(where)
    raw = read_scene(path, sidecar)
    triangles = np.bincount(raw.part, minlength=len(raw.parts)).tolist()
    rows = [
        (part.node, part.mesh, part.material, f"{count:,}", *_words(meaning_of(part, sidecar)))
        for part, count in zip(raw.parts, triangles, strict=True)
    ]
    if as_json:
        say_json({"parts": [dict(zip(_COLUMNS, row, strict=True)) for row in rows], **_summary(raw)})
    else:
        say(table([_COLUMNS, *rows[:_SHOWN]]))
        if len(rows) > _SHOWN:
            say(f"... and {len(rows) - _SHOWN:,} more")
        say(_in_words(raw))
    try:
        meanings(raw.parts, sidecar, path, where)
    except InputError as error:
        note(f"still to do: {error}")
    return 0


def _words(meaning: Meaning | None) -> tuple[str, str]:
    if meaning is None:
        return "?", "?"
    if isinstance(meaning.made_of, str):
        return meaning.made_of, meaning.semantic.name.lower()
    fixed = meaning.made_of
    return f"{fixed.temperature_K:g} K, emissivity {fixed.emissivity:g}", meaning.semantic.name.lower()


def _summary(raw: RawScene) -> dict[str, Any]:
    low, high = raw.vertices.min(axis=0), raw.vertices.max(axis=0)
    return {
        "triangles": len(raw.faces),
        "low_m": low.tolist(),
        "high_m": high.tolist(),
        "repairs": dict(raw.repairs),
        "shift_m": list(raw.shift_m),
    }


def _in_words(raw: RawScene) -> str:
    (x, y, z), (east, north) = (raw.vertices.max(axis=0) - raw.vertices.min(axis=0)).tolist(), raw.shift_m
    words = [f"{len(raw.faces):,} triangles", f"{x:.1f} x {y:.1f} x {z:.1f} m (east, north, up)"]
    words += [f"{count:,} {what}" for what, count in raw.repairs]
    if (east, north) != (0.0, 0.0):
        words.append(f"moved to the origin from {east:.0f} m east, {north:.0f} m north")
    return "; ".join(words)
