"""Sites of vehicles, people, boats and fixtures lie outside and look out: measured by the renderer.

Geometry: one copy of each, 40 m apart, on a level field of 1.8 km; seed 4.
Illumination: none; only what 128 rays over the hemisphere of each site meet.
Expected: a site on the outside of a car meets the car hardly ever; what stands between other things (a deck under a
boom, legs, the roof of a shelter) meets them for a part. A site inside its own body would meet nothing else.
"""

from __future__ import annotations

import numpy as np
import pytest

from scenegen.classes import Semantic
from scenegen.climate.season import Season
from scenegen.foundation.rng import stream
from scenegen.geometry.builder import GeometryBuilder
from scenegen.geometry.patch import patches
from scenegen.geometry.template import place
from scenegen.materials.palette import PaletteBuilder
from scenegen.parts.boats.boat import boat
from scenegen.parts.fixtures.erect import FIXTURES
from scenegen.parts.people.body import body
from scenegen.parts.vehicles.shapes import CARS
from scenegen.parts.vehicles.vehicle import vehicle
from scenegen.world import HeightField
from scenegen_render.exposure.expose import expose
from scenegen_render.exposure.knobs import ExposureKnobs
from scenegen_render.scene import load

HALF_M, APART_M = 900.0, 40.0
VEHICLES = (*CARS, "van", "bus", "truck")
BOATS = ("rowing", "sailing", "motor", "fishing")
POSTURES = ("standing", "walking", "sitting", "running")
OPEN = ("bench", "bus_shelter")
KINDS = (*VEHICLES, *POSTURES, *BOATS, *FIXTURES)
SKINS = ("bark_trunk", "soil_dry", "soil_wet", "granite", "basalt", "limestone_marble", "snow_medium", "ice")


@pytest.fixture(scope="module")
def own_share() -> dict[str, np.ndarray]:
    """Share of the rays of each site of each kind that meet the thing itself."""
    templates = [
        *map(vehicle, VEHICLES), *(body(p, 0.2) for p in POSTURES), *map(boat, BOATS),
        *(make() for make, _ in FIXTURES.values()),
    ]  # fmt: skip
    palette = PaletteBuilder(stream(4, "palette"))
    ground, skins = palette.only("grass_dry"), [palette.only(name) for name in SKINS]
    builder, one = GeometryBuilder(), np.ones(1, np.int64)
    corners = HALF_M * np.array([[[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]], np.float64)
    builder.add(patches(corners, 60.0, ground * one, int(Semantic.GRASS) * one, one))
    for k, template in enumerate(templates):
        spot = np.array([[(k - len(templates) / 2) * APART_M, 0.0, 0.0]])
        builder.add(place(template, spot, np.zeros(1), np.ones((1, 3)), np.array([skins]), one + 1 + k))
    merged = builder.merge()
    level = HeightField((-HALF_M, -HALF_M), 2 * HALF_M, np.zeros((2, 2), np.float32))
    world = merged.world(
        "field", palette.surfaces(), level, ((-HALF_M, -HALF_M, 0.0), (HALF_M, HALF_M, 120.0)), ()
    )
    loaded = load(world)
    knobs = ExposureKnobs(directions=128, sun_step_min=120.0, smoothing=False)
    exposure = expose(loaded, Season(50.0, 6, 21), stream(4, "exposure"), knobs)
    loaded.release()
    owner = merged.sites.object
    met = np.append(owner, 0)[np.minimum(exposure.gather, len(owner))]
    share = (met == owner).mean(axis=0)
    return {kind: share[owner == 2 + k] for k, kind in enumerate(KINDS)}


@pytest.mark.parametrize("kind", [k for k in VEHICLES if k != "truck"])
def test_a_vehicle_looks_out_all_around(kind, own_share):
    assert 12 <= len(own_share[kind]) <= 18
    assert np.sort(own_share[kind])[:-1].max() < 0.15  # all but the deep bonnet of a bus under its windscreen
    assert own_share[kind].max() < 0.4


def test_a_truck_hides_only_the_gap_behind_its_cab(own_share):
    assert (own_share["truck"] > 0.55).sum() <= 3
    assert own_share["truck"].mean() < 0.25


@pytest.mark.parametrize("kind", POSTURES)
def test_a_body_sees_little_of_itself(kind, own_share):
    assert own_share[kind].mean() < 0.2 and own_share[kind].max() < 0.35


@pytest.mark.parametrize("kind", BOATS)
def test_boats_see_their_rigging_but_not_their_bilge(kind, own_share):
    assert own_share[kind].mean() < 0.3 and own_share[kind].max() < 0.7


@pytest.mark.parametrize("kind", [k for k in FIXTURES if k not in OPEN])
def test_posts_see_past_themselves(kind, own_share):
    assert own_share[kind].mean() < 0.1 and own_share[kind].max() < 0.25


@pytest.mark.parametrize("kind", OPEN)
def test_furniture_one_sits_in_sees_itself_in_part(kind, own_share):
    assert own_share[kind].mean() < 0.4 and own_share[kind].max() < 0.85
