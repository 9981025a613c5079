"""What ``scenegen maps MAP --preview`` does: build one world, draw it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from scenegen.foundation.errors import InputError
from scenegen_cli.console import say, say_json
from scenegen_cli.maps import Maps
from scenegen_cli.render import ask
from scenegen_datasets.census import count_classes, count_objects
from scenegen_datasets.pictures.world_sheet import draw_world, in_numbers


def look(command: Maps, flags: Mapping[str, Any]) -> int:
    """Build one world and write what was asked for; returns the exit code."""
    _, recipe = ask(command.recipe, None, {**flags, "map": command.map})
    (map,) = recipe.map
    assert command.preview is not None
    _check_out(command.preview, (".png",), "--preview")
    world, png = draw_world(recipe, map, command.world)
    _write(command.preview, png)
    say(str(command.preview))
    if command.json:
        say_json(
            {
                "counts": dict(world.counts),
                "triangles": len(world.mesh.faces),
                "sites": len(world.sites.area),
                "objects": count_objects(world),
                "classes": {
                    c.kind.name: {"objects": c.objects, "triangles": c.triangles}
                    for c in count_classes(world)
                },
            }
        )
    else:
        say(in_numbers(world))
    return 0


def _check_out(path: Path, endings: tuple[str, ...], flag: str) -> None:
    if path.suffix.lower() not in endings:
        raise InputError(f"{flag} {path}: write a file that ends in {', '.join(endings)}")
    if path.is_dir():
        raise InputError(f"{flag} {path}: is a directory; name a file")


def _write(path: Path, content: bytes) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}") from None
