"""Which part of a scene is made of what, and is what: the names of the file meet those of the sidecar."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from scenegen.classes import Semantic
from scenegen.foundation.errors import InputError, nearest
from scenegen.maps.own_scene.raw import Names
from scenegen.maps.own_scene.sidecar import Choice, Sidecar

_SHOWN = 8

_USUAL_CLASS: Mapping[str, Semantic] = {
    "asphalt_aged": Semantic.ROAD,
    "concrete_pavement": Semantic.SIDEWALK,
    "concrete_wall": Semantic.WALL,
    "brick_red": Semantic.WALL,
    "stucco_render": Semantic.WALL,
    "wood_siding": Semantic.WALL,
    "clay_roof_tile": Semantic.ROOF,
    "slate_roof": Semantic.ROOF,
    "asphalt_shingle": Semantic.ROOF,
    "bitumen_felt_roof": Semantic.ROOF,
    "epdm_black_roof": Semantic.ROOF,
    "white_membrane_roof": Semantic.ROOF,
    "metal_roof_painted_mid": Semantic.ROOF,
    "window_glass": Semantic.WINDOW,
    "grass_watered": Semantic.GRASS,
    "grass_dry": Semantic.GRASS,
    "tree_crown": Semantic.TREE,
    "bark_trunk": Semantic.TREE,
    "soil_dry": Semantic.SOIL,
    "soil_wet": Semantic.SOIL,
    "sand_dry_quartz": Semantic.SAND,
    "sand_wet": Semantic.SAND,
    "granite": Semantic.ROCK,
    "limestone_marble": Semantic.ROCK,
    "basalt": Semantic.ROCK,
    "water_fresh_or_sea": Semantic.WATER,
    "car_paint_black": Semantic.CAR,
    "car_paint_white": Semantic.CAR,
    "car_paint_silver": Semantic.CAR,
    "tyre_rubber": Semantic.CAR,
    "human_skin": Semantic.PERSON,
    "clothing": Semantic.PERSON,
    "artificial_turf": Semantic.SPORTS_SURFACE,
}
"""What a material mostly stands for; everything else is `Semantic.OTHER` until the sidecar says more."""

Value = TypeVar("Value")


@dataclass(frozen=True)
class Meaning:
    """What one part is.

    Attributes
    ----------
    made_of : str or Prescribed
    semantic : Semantic
    """

    made_of: Choice
    semantic: Semantic


def meanings(
    parts: Sequence[Names], sidecar: Sidecar, scene: Path, where: Path | None
) -> tuple[Meaning, ...]:
    """Material and class of every part.

    Parameters
    ----------
    parts : sequence of Names
    sidecar : Sidecar
    scene, where : Path
        The scene file and its sidecar (None if it has none), for messages.

    Raises
    ------
    InputError
        Listing the parts without a material, or naming an entry of the sidecar that no part goes by.
    """
    known = {name for part in parts for name in part[:3] if name}
    for section in ("materials", "classes"):
        _check_known(getattr(sidecar, section), known, f"{where}: {section}", scene)
    found = []
    unmapped: dict[str, None] = {}
    for part in parts:
        meaning = meaning_of(part, sidecar)
        if meaning is None:
            unmapped[part.shown] = None
        else:
            found.append(meaning)
    if unmapped:
        place = where or scene.with_suffix(".yaml")
        raise InputError(
            f"{scene}: no material for {_listed(unmapped)}; map them in {place} under 'materials', "
            "or set 'default_material'"
        )
    return tuple(found)


def meaning_of(part: Names, sidecar: Sidecar) -> Meaning | None:
    """Material and class of one part; None if the sidecar gives it no material."""
    made_of = _lookup(part, sidecar.materials, sidecar.default_material)
    if made_of is None:
        return None
    usual = _USUAL_CLASS.get(made_of, Semantic.OTHER) if isinstance(made_of, str) else Semantic.OTHER
    semantic = _lookup(part, sidecar.classes, usual)
    assert semantic is not None
    return Meaning(made_of, semantic)


def _lookup(part: Names, table: Mapping[str, Value], otherwise: Value | None) -> Value | None:
    """Entry of the most particular name that has one: node, then mesh, then material."""
    for name in (part.node, part.mesh, part.material):
        if name and name in table:
            return table[name]
    return otherwise


def _check_known(table: Iterable[str], known: Collection[str], where: str, scene: Path) -> None:
    for name in table:
        if name not in known:
            options = nearest(name, known) if known else ""
            hint = options if len(options) < 200 else f"{options[:200]}..."
            raise InputError(f"{where}: nothing in {scene} is called '{name}'{hint}")


def _listed(names: Collection[str]) -> str:
    shown = ", ".join(f"'{name}'" for name in list(names)[:_SHOWN])
    return shown if len(names) <= _SHOWN else f"{shown} and {len(names) - _SHOWN:,} more"
