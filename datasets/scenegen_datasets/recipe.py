"""The recipe: everything that decides a dataset's samples, composed of each room's own section."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, field_validator

from scenegen.climate.knobs import ClimateKnobs
from scenegen.foundation.errors import InputError
from scenegen.foundation.section import Count, Section
from scenegen.maps.city.knobs import CityKnobs
from scenegen.maps.registry import MAPS, map_family
from scenegen_datasets.layers import DEFAULT_LAYERS, check_layers
from scenegen_datasets.resolve import Source, merge, resolve
from scenegen_flythrough.knobs import FlightKnobs
from scenegen_render.camera_knobs import CameraKnobs, preset
from scenegen_render.exposure.knobs import ExposureKnobs
from scenegen_render.knobs import RenderKnobs
from scenegen_render.sensor.knobs import SensorKnobs

SCENE_SEMANTICS = 1
"""Raised whenever the same recipe comes to mean other samples; part of every ``recipe_id``."""

MAX_PAIRS = 100_000_000
"""More pairs than any disk of today holds."""

_LAYER_KNOBS = {"flow_back": "backward_flow", "covisible_back": "backward_flow", "normal": "normals"}


def _one_or_many(value: Any) -> Any:
    return (value,) if isinstance(value, str) else tuple(value) if isinstance(value, list) else value


Names = Annotated[tuple[str, ...], BeforeValidator(_one_or_many)]


class Recipe(Section):
    """What a dataset is made of. How many pairs of it are made is not part of it."""

    seed: Annotated[Count, Field(ge=0, lt=2**63)] = 0
    """Root of all randomness."""
    map: Names = ("city",)
    """Map families; several take turns, world by world."""
    clips_per_world: Annotated[Count, Field(ge=1, le=1000)] = 8
    """Flights through one world, each with its own weather and hour."""
    pairs_per_clip: Annotated[Count, Field(ge=1, le=9000)] = 64
    """Pairs in one flight; it stores one frame more."""
    layers: Names = check_layers(DEFAULT_LAYERS)
    """What is stored of each frame."""
    climate: ClimateKnobs = ClimateKnobs()
    flight: FlightKnobs = FlightKnobs()
    render: RenderKnobs = RenderKnobs()
    exposure: ExposureKnobs = ExposureKnobs()
    camera: CameraKnobs = CameraKnobs()
    sensor: SensorKnobs = SensorKnobs()
    city: CityKnobs = CityKnobs()

    @field_validator("map")
    @classmethod
    def _known_maps(cls, value: tuple[str, ...]) -> tuple[str, ...]:
        if not value:
            raise ValueError(f"name at least one map; known: {', '.join(MAPS)}")
        if len(set(value)) < len(value):
            raise ValueError("names a map twice")
        for name in value:
            map_family(name)
        return value

    @field_validator("layers")
    @classmethod
    def _known_layers(cls, value: tuple[str, ...]) -> tuple[str, ...]:
        layers = check_layers(value)
        if "thermal" not in layers or "depth" not in layers:
            raise ValueError("a pair needs at least 'thermal' and 'depth'")
        return layers

    @property
    def stored_layers(self) -> tuple[str, ...]:
        """Layers written, those asked for by the `render` section included."""
        extra = [layer for layer, knob in _LAYER_KNOBS.items() if getattr(self.render, knob)]
        return check_layers([*self.layers, *extra])

    @property
    def tracing(self) -> RenderKnobs:
        """The `render` section with everything switched on that `layers` asks for."""
        wanted = {knob: True for layer, knob in _LAYER_KNOBS.items() if layer in self.layers}
        return self.render.model_copy(update=wanted)

    def map_knobs(self, name: str) -> Section:
        """Section of one map family."""
        knobs = getattr(self, name)
        assert isinstance(knobs, Section)
        return knobs

    def canonical(self) -> dict[str, Any]:
        """Plain data of everything that decides samples; sections of maps that are not used are left out."""
        unused = {name for name in MAPS if name not in self.map}
        return self.model_dump(mode="json", exclude=unused)


def resolve_recipe(sources: list[Source]) -> Recipe:
    """Compose a recipe from what was asked: preset below file below flags, key by key.

    Parameters
    ----------
    sources : list of Source
        From weakest to strongest; the camera preset named by the strongest goes below all of them.

    Raises
    ------
    InputError
        In one line, naming file and key.
    """
    asked = merge(source.values for source in sources)
    camera = asked.get("camera")
    name = camera.get("preset") if isinstance(camera, Mapping) else None
    if isinstance(name, str):
        chosen = preset(name)
        base = {"camera": dict(chosen.camera), "sensor": dict(chosen.sensor)}
        sources = [Source(f"camera preset {name}", base), *sources]
    return resolve(Recipe, sources)


def settle_pairs(recipe: Recipe, pairs: int) -> tuple[Recipe, int]:
    """Fit clip length and number of pairs to each other.

    Fewer pairs than a clip shorten the clip (and make another recipe); otherwise pairs are rounded up to whole clips.

    Raises
    ------
    InputError
        If `pairs` is not between 1 and 10^8.
    """
    if not 1 <= pairs <= MAX_PAIRS:
        raise InputError(f"--pairs {pairs}: ask for 1 to {MAX_PAIRS:,} pairs")
    if pairs < recipe.pairs_per_clip:
        return recipe.model_copy(update={"pairs_per_clip": pairs}), pairs
    clips = -(-pairs // recipe.pairs_per_clip)
    return recipe, clips * recipe.pairs_per_clip
