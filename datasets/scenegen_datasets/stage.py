"""One world, built, exposed and loaded, with everything the clips flown through it share."""

from __future__ import annotations

from dataclasses import dataclass

from scenegen.climate.knobs import draw_season
from scenegen.climate.season import Season
from scenegen.exposure import Exposure
from scenegen.foundation.rng import stream
from scenegen.heat.solve import HeatModel
from scenegen.maps.registry import build_world
from scenegen.world import World
from scenegen_datasets.recipe import Recipe
from scenegen_datasets.stopwatch import Stopwatch
from scenegen_flythrough.airspace import Airspace
from scenegen_render.exposure.expose import expose
from scenegen_render.scene import LoadedWorld, load


@dataclass(frozen=True, eq=False)
class Stage:
    """A world ready to be flown through.

    Attributes
    ----------
    world : World
    loaded : LoadedWorld
    exposure : Exposure
        Of the season drawn for this world.
    heat : HeatModel
    airspace : Airspace
    """

    world: World
    loaded: LoadedWorld
    exposure: Exposure
    heat: HeatModel
    airspace: Airspace

    def release(self) -> None:
        """Give the renderer's memory back."""
        self.loaded.release()


def raise_world(recipe: Recipe, map: str, index: int) -> tuple[Season, World]:
    """Season and geometry of world `index` of a map."""
    season = draw_season(recipe.climate, stream(recipe.seed, map, index, "season"))
    return season, build_world(map, recipe.map_knobs(map), season, stream(recipe.seed, map, index, "world"))


def set_stage(recipe: Recipe, map: str, index: int, watch: Stopwatch) -> Stage:
    """Build world `index` of a map; a pure function of recipe, map and index.

    Season, geometry and exposure draw from generators of their own, so that changing one leaves the others alone.
    """
    with watch("build"):
        season, world = raise_world(recipe, map, index)
    with watch("load"):
        loaded = load(world)
    with watch("expose"):
        exposure = expose(loaded, season, stream(recipe.seed, map, index, "exposure"), recipe.exposure)
    with watch("heat classes"):
        heat = HeatModel.of(world, exposure)
    with watch("airspace"):
        airspace = Airspace(world)
    return Stage(world, loaded, exposure, heat, airspace)
