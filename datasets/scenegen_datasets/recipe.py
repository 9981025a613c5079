"""The recipe: everything that decides a dataset's samples, composed of each room's own section."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, field_validator

from scenegen.climate.knobs import ClimateKnobs
from scenegen.foundation.errors import InputError, nearest
from scenegen.foundation.section import Count, Section
from scenegen.maps.city.knobs import CityKnobs
from scenegen.maps.coastline.knobs import CoastlineKnobs
from scenegen.maps.field.knobs import FieldKnobs
from scenegen.maps.neighborhood.knobs import NeighborhoodKnobs
from scenegen.maps.own_scene.knobs import OwnScene
from scenegen.maps.registry import MAPS
from scenegen_datasets.job import MAX_WORLD, is_map_name
from scenegen_datasets.layers import DEFAULT_LAYERS, check_layers
from scenegen_datasets.plan import last_world
from scenegen_datasets.resolve import Source, merge, resolve
from scenegen_datasets.scenes import identified, name_scenes
from scenegen_datasets.splits.knobs import SplitKnobs
from scenegen_flythrough.knobs import FlightKnobs
from scenegen_render.camera_knobs import CameraKnobs, preset
from scenegen_render.exposure.knobs import ExposureKnobs
from scenegen_render.knobs import RenderKnobs
from scenegen_render.sensor.knobs import SensorKnobs

SCENE_SEMANTICS = 4
"""Raised whenever the same recipe comes to mean other samples; part of every ``recipe_id``."""

MAX_PAIRS = 100_000_000
"""More pairs than any disk of today holds."""

MAX_CLIPS = 1_000_000
"""A plan is held in memory, and a lock from elsewhere may ask for any."""

_LAYER_KNOBS = {"flow_back": "backward_flow", "covisible_back": "backward_flow", "normal": "normals"}


def _one_or_many(value: Any) -> Any:
    return (value,) if isinstance(value, str) else tuple(value) if isinstance(value, list) else value


Names = Annotated[tuple[str, ...], BeforeValidator(_one_or_many)]


class Recipe(Section):
    """What a dataset is made of. How many pairs of it are made is not part of it."""

    seed: Annotated[Count, Field(ge=0, lt=2**63)] = 0
    """Root of all randomness."""
    scenes: dict[str, OwnScene] = Field(default_factory=dict)
    """Scenes of your own by name; a path among the maps enters itself here."""
    map: Names = ("city",)
    """Map families, own scenes by name or path; several take turns, world by world."""
    first_world: Annotated[Count, Field(ge=0, le=MAX_WORLD)] = 0
    """Number of the first world; with one seed, machines that begin at 0, 100, 200, ... make parts of one dataset."""
    clips_per_world: Annotated[Count, Field(ge=1, le=1000)] = 8
    """Flights through one world, each with its own weather and hour."""
    pairs_per_clip: Annotated[Count, Field(ge=1, le=9000)] = 64
    """Pairs in one flight; it stores one frame more."""
    layers: Names = check_layers(DEFAULT_LAYERS)
    """What is stored of each frame."""
    movers: bool = True
    """Vehicles, people and boats go their ways; off: they stand still where they are at the world's time zero."""
    climate: ClimateKnobs = ClimateKnobs()
    splits: SplitKnobs = SplitKnobs()
    flight: FlightKnobs = FlightKnobs()
    render: RenderKnobs = RenderKnobs()
    exposure: ExposureKnobs = ExposureKnobs()
    camera: CameraKnobs = CameraKnobs()
    sensor: SensorKnobs = SensorKnobs()
    city: CityKnobs = CityKnobs()
    coastline: CoastlineKnobs = CoastlineKnobs()
    neighborhood: NeighborhoodKnobs = NeighborhoodKnobs()
    field: FieldKnobs = FieldKnobs()

    @field_validator("map")
    @classmethod
    def _known_maps(cls, value: tuple[str, ...], info: Any) -> tuple[str, ...]:
        known = {*MAPS, *info.data.get("scenes", ())}
        if not value:
            raise ValueError(f"name at least one map; known: {', '.join(sorted(known))}")
        if len(set(value)) < len(value):
            raise ValueError("names a map twice")
        for name in value:
            if name not in known:
                raise ValueError(f"unknown map '{name}'{nearest(name, known)}")
        return value

    @field_validator("scenes")
    @classmethod
    def _scene_names(cls, value: dict[str, OwnScene]) -> dict[str, OwnScene]:
        for name in value:
            if name in MAPS or not is_map_name(name):
                raise ValueError(
                    f"'{name}' cannot be the name of a scene: lower-case letters, digits, underscores"
                )
        return value

    @field_validator("layers")
    @classmethod
    def _known_layers(cls, value: tuple[str, ...]) -> tuple[str, ...]:
        layers = check_layers(value)
        if "thermal" not in layers or "depth" not in layers:
            raise ValueError("a pair needs at least 'thermal' and 'depth'")
        return layers

    @field_validator("splits")
    @classmethod
    def _can_be_split(cls, value: SplitKnobs, info: Any) -> SplitKnobs:
        if {"map", "climate"} <= info.data.keys():
            reason = value.contradiction(info.data["map"], info.data["climate"])
            if reason:
                raise ValueError(reason)
        return value

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
        """Section of one map family, or the files of an own scene."""
        knobs = self.scenes.get(name) or getattr(self, name)
        assert isinstance(knobs, Section)
        return knobs

    def canonical(self) -> dict[str, Any]:
        """Plain data of everything that decides samples; sections of maps that are not used are left out.

        Own scenes and recordings enter by their content, wherever their files lie. Splits enter if anything is held
        out, the first world if it is not 0: without, a recipe keeps the identity it had before there were such keys.
        """
        left_out: dict[str, Any] = {name: True for name in MAPS if name not in self.map}
        left_out |= {"scenes": True, "flight": {"recorded": {"file"}}}
        if self.splits == SplitKnobs():
            left_out["splits"] = True
        if self.first_world == 0:
            left_out["first_world"] = True
        plain = self.model_dump(mode="json", exclude=left_out)
        used = {name: {"sha256": scene.sha256} for name, scene in self.scenes.items() if name in self.map}
        return {**plain, "scenes": used} if used else plain


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
    recipe = resolve(Recipe, name_scenes(sources))
    return (
        recipe.model_copy(update={"scenes": identified(recipe.scenes, recipe.map)})
        if recipe.scenes
        else recipe
    )


def settle_pairs(recipe: Recipe, pairs: int) -> tuple[Recipe, int]:
    """Fit clip length and number of pairs to each other.

    Fewer pairs than a clip shorten the clip (and make another recipe); otherwise pairs are rounded up to whole clips.

    Raises
    ------
    InputError
        If `pairs` is not between 1 and 10^8, or asks for more worlds or clips than a dataset can hold.
    """
    if not 1 <= pairs <= MAX_PAIRS:
        raise InputError(f"--pairs {pairs}: ask for 1 to {MAX_PAIRS:,} pairs")
    if pairs < recipe.pairs_per_clip:
        return recipe.model_copy(update={"pairs_per_clip": pairs}), pairs
    whole = -(-pairs // recipe.pairs_per_clip) * recipe.pairs_per_clip
    refuse_too_large_a_plan(recipe, whole)
    return recipe, whole


def refuse_too_large_a_plan(recipe: Recipe, pairs: int) -> None:
    """Stop where a plan of so many pairs needs worlds beyond the largest number, or more clips than memory should hold.

    Raises
    ------
    InputError
    """
    clips = -(-pairs // recipe.pairs_per_clip)
    if clips > MAX_CLIPS:
        raise InputError(
            f"{pairs:,} pairs are {clips:,} clips of {recipe.pairs_per_clip}, and a dataset holds at most "
            f"{MAX_CLIPS:,}; raise --pairs-per-clip"
        )
    last = last_world(
        len(recipe.map), recipe.clips_per_world, recipe.pairs_per_clip, pairs, recipe.first_world
    )
    if last > MAX_WORLD:
        raise InputError(
            f"{pairs:,} pairs need worlds up to number {last:,}, and the largest is {MAX_WORLD:,}; raise "
            "--clips-per-world or --pairs-per-clip"
        )
