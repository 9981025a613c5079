"""Where, when and with what camera Table 2 is flown."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from scenegen.maps.own_scene.own_scene import describe
from scenegen.maps.registry import MAPS
from scenegen_datasets.resolve import Source
from scenegen_datasets.store import LOCK, read_lock
from scenegen_flythrough.planners.registry import planner
from scenegen_trainers.campaign.recipe import FlightRecipe, resolve_flights

_OURS = {"map": list(MAPS), "campaign": {"batches_per_world": 1}}
"""All maps; a new world for every batch, because flights of one world share its streets."""

_NOT_OURS = (
    "pairs",
    "map",
    "scenes",
    "layers",
    "clips_per_world",
    "pairs_per_clip",
    "first_world",
    "flight",
    "splits",
    "render",
    "merged",
    "sensed",
)
"""Keys of a dataset's recipe that its flights do not take over."""


def flight_recipe(
    asked: Sequence[Source], camera: Mapping[str, Any] | None, data: Path | None
) -> FlightRecipe:
    """Where, when and with what camera is flown.

    Parameters
    ----------
    asked : sequence of Source
        File and flags, from weakest to strongest.
    camera : mapping or None
        That of the checkpoints.
    data : Path or None
        Dataset whose seed, climate, camera and sensor count, below `asked`: its test worlds are flown, in the hours and
        weather it does not hold out unless `asked` says otherwise (`campaign.conditions`).

    Raises
    ------
    InputError
        In one line, naming file and key.
    """
    sources = [Source("table2", _OURS)]
    if camera is not None:
        sources.append(Source("the checkpoints", {"camera": dict(camera)}))
    if data is not None:
        recipe_of_data = read_lock(data)["recipe"]
        kept = {key: value for key, value in recipe_of_data.items() if key not in _NOT_OURS}
        held = recipe_of_data.get("splits") or {}
        kept["splits"] = {key: held[key] for key in ("test_hours", "test_weather") if held.get(key)}
        sources.append(Source(str(data / LOCK), kept))
    recipe = resolve_flights([*sources, *asked])
    for scene in recipe.dataset.scenes.values():
        describe(scene)
    return recipe


def check_planner(name: str, recipe: FlightRecipe) -> None:
    """Say early what is wrong with a planner's name."""
    planner(name, recipe.loop)
