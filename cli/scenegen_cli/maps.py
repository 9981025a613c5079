"""``scenegen maps``: the kinds of worlds, their knobs, and a look at one of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import tyro

from scenegen.foundation.errors import InputError
from scenegen_cli.console import say, say_json, table
from scenegen_cli.parse import parse, split_recipe_flags
from scenegen_datasets.recipe import Recipe
from scenegen_datasets.resolve import leaves


@dataclass(frozen=True)
class Maps:
    """List the maps, the knobs of one, the parts of a scene of your own, or look at one of their worlds.

    Takes all recipe keys as flags, such as --seed and --climate.hour.
    """

    map: Annotated[str, tyro.conf.Positional] = ""
    """Name of a map, or path of a scene file; without it, all maps are listed."""
    world: int = 0
    """Which of the map's worlds."""
    recipe: Path | None = None
    """YAML file of recipe keys; flags win over it."""
    preview: Path | None = None
    """Draw the world into this PNG file: from above, from the air, and as a drone sees it."""
    export: Path | None = None
    """Write the world's triangles to this file (.glb, .gltf, .obj or .ply), for Blender and friends."""
    nodes: str = "class"
    """What becomes a node of the exported file: each class and material, or each object ('class' or 'object')."""
    json: bool = False
    """Report as JSON."""


def run(arguments: Sequence[str]) -> int:
    """Run the subcommand; returns the exit code."""
    own, flags = split_recipe_flags(arguments, [key for key, _, _ in leaves(Recipe)])
    command = parse(Maps, "maps", own)
    looks = command.preview is not None or command.export is not None
    if not command.map:
        if looks:
            raise InputError("name the map to look at, such as 'scenegen maps city --preview city.png'")
        return _list_maps(command)
    if looks:
        from scenegen_cli.look import look

        return look(command, flags)
    from scenegen.maps.own_scene.identity import is_scene_path

    if is_scene_path(command.map):
        from scenegen_cli.parts import list_parts

        return list_parts(Path(command.map), as_json=command.json)
    return _list_knobs(command)


def _list_maps(command: Maps) -> int:
    rows = _rows()
    if command.json:
        say_json(rows)
        return 0
    say(
        table(
            [
                ("name", "knobs", "description"),
                *((r["name"], str(len(r["keys"])), r["description"]) for r in rows),
            ]
        )
    )
    return 0


def _list_knobs(command: Maps) -> int:
    from scenegen.maps.registry import map_family

    family = map_family(command.map)
    keys = [(f"{family.name}.{key}", default, meaning) for key, meaning, default in leaves(family.knobs)]
    if command.json:
        say_json([{"key": key, "default": default, "meaning": meaning} for key, default, meaning in keys])
        return 0
    say(f"{family.name}: {family.description}\n")
    say(
        table(
            [
                ("key", "default", "meaning"),
                *((key, _text(default), meaning) for key, default, meaning in keys),
            ]
        )
    )
    return 0


def _text(value: Any) -> str:
    return " ".join(f"{v:g}" for v in value) if isinstance(value, tuple) else str(value)


def _rows() -> list[dict[str, Any]]:
    from scenegen.maps.registry import MAPS

    return [
        {
            "name": family.name,
            "description": family.description,
            "keys": {
                f"{family.name}.{key}": field.description for key, field in family.knobs.model_fields.items()
            },
        }
        for family in MAPS.values()
    ]
