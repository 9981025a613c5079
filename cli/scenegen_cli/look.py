"""What ``scenegen maps MAP --preview`` and ``--export`` do: build one world, draw it, write it out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from scenegen.foundation.atomic import write_atomic
from scenegen.foundation.errors import InputError, nearest
from scenegen.world import World
from scenegen_cli.console import say, say_json
from scenegen_cli.maps import Maps
from scenegen_cli.render import ask
from scenegen_datasets.census import count_classes, count_objects
from scenegen_datasets.pictures.world_sheet import draw_world, in_numbers
from scenegen_datasets.place import make_directory
from scenegen_datasets.recipe import Recipe
from scenegen_datasets.stage import raise_world
from scenegen_datasets.world_file import ENDINGS, SIDECAR_MARK, parts_of, sidecar, world_file

_NODES = ("class", "object")
_MOST_WORLDS = 100_000


def look(command: Maps, flags: Mapping[str, Any]) -> int:
    """Build one world and write what was asked for; returns the exit code."""
    _, recipe = ask(command.recipe, None, {**flags, "map": command.map})
    (map,) = recipe.map
    _check(command)
    world = _draw(command, recipe, map) if command.preview else raise_world(recipe, map, command.world)[1]
    written = [] if command.preview is None else [command.preview]
    if command.export is not None:
        written += _export(world, command.export, command.nodes)
    if command.json:
        say_json({**facts(world), "files": [str(path) for path in written]})
        return 0
    for path in written:
        say(str(path))
    say("\n".join(in_numbers(world)))
    return 0


def facts(world: World) -> dict[str, Any]:
    """What was counted, as plain data."""
    return {
        "counts": dict(world.counts),
        "triangles": len(world.mesh.faces),
        "sites": len(world.sites.area),
        "objects": count_objects(world),
        "classes": {
            c.kind.name: {"objects": c.objects, "triangles": c.triangles} for c in count_classes(world)
        },
    }


def _check(command: Maps) -> None:
    """Refuse what cannot be written before anything is built."""
    if not 0 <= command.world < _MOST_WORLDS:
        raise InputError(f"--world {command.world}: choose 0 to {_MOST_WORLDS - 1:,}")
    if command.nodes not in _NODES:
        raise InputError(f"--nodes {command.nodes}: unknown{nearest(command.nodes, _NODES)}")
    _check_out(command.preview, (".png",), "--preview")
    _check_out(command.export, ENDINGS, "--export")


def _check_out(path: Path | None, endings: Sequence[str], flag: str) -> None:
    if path is None:
        return
    if path.suffix.lower() not in endings:
        raise InputError(f"{flag} {path}: name a file that ends in {', '.join(endings)}")
    if path.is_dir():
        raise InputError(f"{flag} {path}: is a directory; name a file")
    make_directory(path.parent, flag)


def _draw(command: Maps, recipe: Recipe, map: str) -> World:
    assert command.preview is not None
    world, png = draw_world(recipe, map, command.world)
    write_atomic(command.preview, png)
    return world


def _export(world: World, path: Path, nodes: str) -> list[Path]:
    """Write the world and, where the format has names, the sidecar that reads it back."""
    parts = parts_of(world, "object" if nodes == "object" else "class")
    ending = path.suffix.lower()
    beside, words = path.with_suffix(".yaml"), sidecar(world, parts, ending)
    if words and beside.exists() and not _ours(beside):
        raise InputError(f"{beside} is there already, and not from here; choose another name for {path.name}")
    write_atomic(path, world_file(parts, ending))
    if not words:
        return [path]
    write_atomic(beside, words.encode())
    return [path, beside]


def _ours(path: Path) -> bool:
    """Whether a sidecar was written by an export."""
    try:
        with path.open("rb") as file:
            return file.read(len(SIDECAR_MARK)) == SIDECAR_MARK.encode()
    except OSError:
        return False
