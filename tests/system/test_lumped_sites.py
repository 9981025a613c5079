"""Sites that stand for a lump look out past it: measured by the renderer, each kind alone on open ground.

Geometry: one copy of each kind, 60 m apart, on a level field of 1.2 km; seed 4.
Illumination: none; only what 256 rays over the hemisphere of each site meet.
Expected: a crown, a post or a tyre hardly ever sees itself. A top sees nearly the whole sky; what looks sideways sees
half of it, less what stands beside it.
"""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.classes import Semantic
from scenegen.climate.season import Season
from scenegen.foundation.rng import stream
from scenegen.geometry.builder import GeometryBuilder
from scenegen.geometry.part import LUMP_STANDOFF_M
from scenegen.geometry.patch import patches
from scenegen.geometry.template import Template, place
from scenegen.materials.palette import PaletteBuilder
from scenegen.parts.fixtures.posts import lamp, sign, traffic_light
from scenegen.parts.vegetation.grove import grove
from scenegen.parts.vegetation.growth import Plan
from scenegen.parts.vegetation.hedges import hedge_piece
from scenegen.parts.vegetation.shrubs import shrub
from scenegen.parts.vegetation.species import SPECIES
from scenegen.parts.vegetation.tree import LEAVES, tree
from scenegen.parts.vehicles.slots import SLOTS, TYRE
from scenegen.parts.vehicles.vehicle import vehicle
from scenegen.world import HeightField
from scenegen_render.exposure.expose import expose
from scenegen_render.exposure.knobs import ExposureKnobs
from scenegen_render.scene import load

JUNE = Season(latitude_deg=50.0, month=6, day=21)
HALF_M, APART_M = 600.0, 60.0
CROWNS = ("oak", "spruce", "pine", "palm")
TOPPED = (*CROWNS, "grove", "shrub", "hedge")


def kinds() -> dict[str, tuple[Template, int, float]]:
    """Template, slot of the lump and scale of each kind."""
    rng = stream(4, "templates")
    return {
        **{name: (tree(SPECIES[name], Plan(1700, 1.0), rng), LEAVES, 8.0) for name in CROWNS},
        "grove": (grove(rng), 0, 12.0),
        "shrub": (shrub(1.0, rng), LEAVES, 1.2),
        "hedge": (hedge_piece(rng), 0, 1.5),
        "tyres": (vehicle("saloon"), TYRE, 1.0),
        "lamp": (lamp(), 0, 1.0),
        "traffic light": (traffic_light(), 0, 1.0),
        "sign": (sign(), 0, 1.0),
    }


class Field:
    """The exposed field; sites of a kind by its name."""

    def __init__(self) -> None:
        palette = PaletteBuilder(stream(4, "palette"))
        ground, skin = palette.only("grass_dry"), palette.only("tree_crown")
        builder = GeometryBuilder()
        corners = HALF_M * np.array([[[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]], np.float64)
        one = np.ones(1, np.int64)
        builder.add(patches(corners, 50.0, ground * one, int(Semantic.GRASS) * one, one))
        for k, (template, slot, size) in enumerate(kinds().values()):
            surfaces = np.full((1, SLOTS), ground)
            surfaces[0, slot] = skin
            spot = np.array([[(k - 5.0) * APART_M, 0.0, 0.0]])
            builder.add(place(template, spot, np.zeros(1), np.full((1, 3), size), surfaces, one + 1 + k))
        merged = builder.merge()
        self.sites = merged.sites
        level = HeightField((-HALF_M, -HALF_M), 2 * HALF_M, np.zeros((2, 2), np.float32))
        world = merged.world(
            "field", palette.surfaces(), level, ((-HALF_M, -HALF_M, 0.0), (HALF_M, HALF_M, 120.0)), ()
        )
        loaded = load(world)
        knobs = ExposureKnobs(directions=256, sun_step_min=120.0, smoothing=False)
        exposure = expose(loaded, JUNE, stream(4, "exposure"), knobs)
        loaded.release()
        owner = np.append(self.sites.object, 0)
        met = owner[np.minimum(exposure.gather, len(self.sites.area))]
        self.own_share = (met == self.sites.object).mean(axis=0)
        self.sky_view = exposure.sky_view
        self.lump = self.sites.surface == skin

    def of(self, kind: str):
        """Mask of the lump's sites."""
        return self.lump & (self.sites.object == 2 + list(kinds()).index(kind))


@pytest.fixture(scope="module")
def field() -> Field:
    """Built once: a field is only read."""
    return Field()


@pytest.mark.parametrize("kind", kinds())
def test_a_lump_hardly_sees_itself(field, kind):
    mine = field.of(kind)
    assert 2 <= mine.sum() <= 20
    assert field.own_share[mine].mean() < 0.08
    assert field.own_share[mine].max() < 0.25


@pytest.mark.parametrize("kind", [*TOPPED, "tyres"])
def test_a_lump_says_that_it_is_one(field, kind):
    standoff = field.sites.standoff[field.of(kind)]
    assert standoff.min() > 0.05 and standoff.max() == pytest.approx(LUMP_STANDOFF_M)


@pytest.mark.parametrize("kind", TOPPED)
def test_the_top_of_a_crown_sees_nearly_all_of_the_sky(field, kind):
    mine = field.of(kind)
    top = mine & (field.sites.normal[:, 2] >= field.sites.normal[mine, 2].max() - 1e-6)
    assert 0.75 < field.sky_view[top].min() <= 1.0


@pytest.mark.parametrize("kind", ["lamp", "traffic light", "sign", "tyres"])
def test_what_looks_sideways_sees_half_of_the_sky(field, kind):
    mine = field.of(kind) & (np.abs(field.sites.normal[:, 2]) < 0.1)
    assert mine.any()
    assert 0.35 < field.sky_view[mine].min() <= field.sky_view[mine].max() < 0.52
