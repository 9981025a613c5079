"""Own scenes in a recipe: a path among the maps becomes a name, and the name stands for the content of the files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from scenegen.foundation.errors import InputError
from scenegen.maps.own_scene.identity import content_hash, is_scene_path, scene_name
from scenegen.maps.own_scene.knobs import OwnScene
from scenegen.maps.registry import MAPS
from scenegen_datasets.resolve import Source


def name_scenes(sources: Sequence[Source]) -> list[Source]:
    """Replace paths of scene files among the maps by names, and enter the files under `scenes`.

    Raises
    ------
    InputError
        If two files would have one name.
    """
    return [_named(source) for source in sources]


def _named(source: Source) -> Source:
    maps = source.values.get("map")
    asked = [maps] if isinstance(maps, str) else maps
    if not isinstance(asked, list | tuple) or not any(isinstance(m, str) and is_scene_path(m) for m in asked):
        return source
    scenes: dict[str, dict[str, str]] = {}
    names: list[Any] = []
    for entry in asked:
        if not (isinstance(entry, str) and is_scene_path(entry)):
            names.append(entry)
            continue
        name = scene_name(entry, MAPS)
        if name in scenes:
            where = f"{source.name}: map" if source.name else "--map"
            raise InputError(
                f"{where}: '{scenes[name]['file']}' and '{entry}' are both called {name}; rename one file"
            )
        scenes[name] = {"file": entry}
        names.append(name)
    given = source.values.get("scenes")
    known = dict(given) if isinstance(given, dict) else {}
    return Source(source.name, {**source.values, "map": names, "scenes": {**known, **scenes}})


def identified(scenes: dict[str, OwnScene], used: Sequence[str]) -> dict[str, OwnScene]:
    """The scenes that are used, with absolute paths and the identity of their content.

    Raises
    ------
    InputError
        If a file cannot be read, or is not the one whose identity the recipe gives.
    """
    found = {}
    for name, scene in scenes.items():
        if name not in used:
            continue
        path = Path(scene.file).absolute()
        content = content_hash(path)
        if scene.sha256 not in ("", content):
            raise InputError(f"{scene.file}: it or its sidecar is not the one this recipe was made with")
        found[name] = OwnScene(file=str(path), sha256=content)
    return found
