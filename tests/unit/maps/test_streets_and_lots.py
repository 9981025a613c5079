"""The plan of a neighborhood: streets that wind, lots that share the blocks, ground that is graded for both."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import shapely

from scenegen.foundation.rng import stream
from scenegen.geometry.relief import draw_relief, sample_height_field
from scenegen.maps.neighborhood.grading import grade
from scenegen.maps.neighborhood.lots import divide
from scenegen.maps.neighborhood.streets import draw_streets
from scenegen.maps.neighborhood.warp import Warp


@cache
def streets(seed, curvature=0.9):
    return draw_streets(420.0, 33.0, curvature, 0.4, stream(seed, "streets"))


@pytest.mark.parametrize("seed", range(6))
def test_streets_are_one_network_that_winds(seed):
    plan = streets(seed)
    lines = shapely.union_all([shapely.LineString(line) for line in plan.lines], grid_size=0.01)
    assert lines.buffer(0.05).geom_type == "Polygon"
    assert plan.carriageway.is_valid
    assert plan.front.contains(plan.carriageway)
    assert any(a or b for a, b in plan.dead_end)
    headings = np.concatenate([np.arctan2(*np.diff(line, axis=0).T[::-1]) for line in plan.lines])
    main = 0.25 * np.angle(np.exp(4j * headings).mean())
    off = np.abs((headings - main + np.pi / 4) % (np.pi / 2) - np.pi / 4)
    assert np.quantile(off, 0.9) > 0.15  # no grid


def test_the_warp_keeps_areas():
    warp = Warp.draw(1.2, 500.0, stream(1, "warp"))
    xy = np.random.default_rng(3).uniform(-250.0, 250.0, (500, 2))
    step = 1e-3
    east, north = (warp(xy + step * e) - warp(xy - step * e) for e in np.eye(2))
    area = (east[:, 0] * north[:, 1] - east[:, 1] * north[:, 0]) / (2 * step) ** 2
    assert area == pytest.approx(1.0, abs=1e-5)


@pytest.mark.parametrize("seed", range(3))
def test_lots_share_the_blocks_without_overlap(seed):
    plan = streets(seed)
    division = divide(plan, 22.0, 33.0, stream(seed, "lots"))
    areas = np.array([lot.area for lot in division.lots], dtype=object)
    assert len(areas) > 80
    assert shapely.area(shapely.union_all(areas)) == pytest.approx(shapely.area(areas).sum(), rel=1e-4)
    assert shapely.area(shapely.intersection(shapely.union_all(areas), plan.front)) < 1.0
    assert (shapely.distance(areas, plan.front) < 0.01).all()
    for lot in division.lots:
        spot = lot.world(np.array([[lot.frontage_m / 2, 5.0]]))[0]
        assert lot.area.distance(shapely.Point(spot)) < 3.0


def test_grading_levels_pads_and_leaves_streets():
    relief = draw_relief(stream(0, "relief"), 5.0, (240.0, 900.0))
    pad = shapely.box(10.0, 10.0, 22.0, 20.0)
    street = shapely.box(-50.0, -5.0, 50.0, 5.0)
    graded = grade(relief, [pad], street, 60.0)
    inside = np.random.default_rng(0).uniform((10.0, 10.0), (22.0, 20.0), (50, 2))
    on_street = np.random.default_rng(1).uniform((-40.0, -4.0), (40.0, 4.0), (50, 2))
    assert np.ptp(relief(inside)) > 10 * np.ptp(graded(inside))
    assert graded(on_street) == pytest.approx(relief(on_street), abs=1e-5)
    assert sample_height_field(graded, 50.0, 2.0).at(inside) == pytest.approx(graded(inside), abs=0.02)
