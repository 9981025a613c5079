"""A world to fly in: geometry and obstacles at once, the renderer once somebody looks, heat once he looks at heat."""

from __future__ import annotations

import gc
from functools import cached_property
from typing import Any

from scenegen.exposure import Exposure
from scenegen.foundation.canonical import digest
from scenegen.foundation.rng import stream
from scenegen.heat.solve import HeatModel
from scenegen_datasets.recipe import Recipe
from scenegen_datasets.stage import raise_world
from scenegen_datasets.stopwatch import Stopwatch
from scenegen_flythrough.airspace import Airspace
from scenegen_flythrough.loop.contact import Obstacles
from scenegen_render.exposure.expose import expose
from scenegen_render.scene import LoadedWorld, load, release_memory


class Place:
    """World `index` of a map, as the dataset plan of the same recipe has it.

    Parameters
    ----------
    recipe : Recipe
    map : str
    index : int
    watch : Stopwatch
        Is told what each stage costs.

    Attributes
    ----------
    season : Season
    world : World
    airspace : Airspace
    obstacles : Obstacles
    """

    def __init__(self, recipe: Recipe, map: str, index: int, watch: Stopwatch) -> None:
        self._recipe, self._map, self._index, self._watch = recipe, map, index, watch
        with watch("build"):
            self.season, self.world = raise_world(recipe, map, index)
        with watch("airspace"):
            self.airspace = Airspace(self.world)
            self.obstacles = Obstacles(self.world, self.airspace.proximity)

    @cached_property
    def loaded(self) -> LoadedWorld:
        """The world in the renderer's hands; a blind pilot never asks for it."""
        with self._watch("load"):
            return load(self.world)

    @cached_property
    def exposure(self) -> Exposure:
        """What all sites see; the most costly part of a world, made when it is first asked for."""
        loaded = self.loaded
        with self._watch("expose"):
            rng = stream(self._recipe.seed, self._map, self._index, "exposure")
            return expose(loaded, self.season, rng, self._recipe.exposure)

    @cached_property
    def heat(self) -> HeatModel:
        """Its heat balance."""
        with self._watch("heat classes"):
            return HeatModel.of(self.world, self.exposure)

    def release(self) -> None:
        """Give the renderer's memory back."""
        if "loaded" in self.__dict__:
            self.loaded.release()


class Places:
    """Keeps one world standing: recipes of a sweep that differ in weather or speed alone share it."""

    def __init__(self, watch: Stopwatch) -> None:
        self._watch = watch
        self._standing: tuple[str, Place] | None = None

    def at(self, recipe: Recipe, map: str, index: int) -> Place:
        """The world, standing already or built now."""
        key = digest(_what_decides(recipe, map, index))
        if self._standing is None or self._standing[0] != key:
            self.leave()
            self._standing = key, Place(recipe, map, index, self._watch)
        return self._standing[1]

    def leave(self) -> None:
        """Tear the standing world down."""
        if self._standing is not None:
            self._standing[1].release()
        self._standing = None
        gc.collect()
        release_memory()


def _what_decides(recipe: Recipe, map: str, index: int) -> dict[str, Any]:
    """Everything a world and its exposure are a function of."""
    climate = recipe.climate
    return {
        "seed": recipe.seed,
        "map": map,
        "index": index,
        "knobs": recipe.map_knobs(map).model_dump(mode="json"),
        "latitude_deg": climate.latitude_deg,
        "date": climate.date,
        "exposure": recipe.exposure.model_dump(mode="json"),
    }
