"""Lines, running track and platforms of a football ground, against the laws that fix their sizes."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from scenegen.maps.field.frame import Frame, Plot
from scenegen.maps.field.pitch import LINE_M, line_quads
from scenegen.maps.field.relief import draw_land, level
from scenegen.maps.field.track import LANE_M, RADIUS_M, STRAIGHT_M, fits_inside, oval


def test_lines_follow_the_laws():
    quads = line_quads(105.0, 68.0)
    painted = shapely.union_all(shapely.polygons(quads))
    assert painted.bounds == pytest.approx((-52.5, -34.0, 52.5, 34.0))
    straight = 2 * 105.0 + 3 * 68.0 - 6 * LINE_M
    boxes = 2 * (2 * 16.5 + 40.32 + 2 * 5.5 + 18.32) - 8 * LINE_M
    arcs = 2 * np.pi * (9.15 - LINE_M / 2) + 4 * np.arccos(5.5 / 9.15) * (9.15 - LINE_M / 2)
    spots = 2 * 0.22**2
    # Lines that end on others overlap them by less than half a square metre in all.
    assert painted.area == pytest.approx((straight + boxes + arcs) * LINE_M + spots, abs=0.7)
    for x, y in (
        (52.5 - 16.5 + 0.06, 0.0),
        (52.5 - 5.5 + 0.06, 0.0),
        (9.09, 0.0),
        (0.0, 0.0),
        (52.5 - 11.0, 0.0),
    ):
        assert painted.contains(shapely.Point(x, y))


def test_the_track_measures_400_m():
    """World Athletics measures 0.30 m outside the kerb of the first lane."""
    ring = shapely.LinearRing(oval(RADIUS_M + 0.30))
    assert ring.length == pytest.approx(400.0, abs=0.3)
    assert ring.length == pytest.approx(2 * STRAIGHT_M + 2 * np.pi * 36.8, abs=0.3)
    assert shapely.LinearRing(oval(RADIUS_M + 8 * LANE_M)).is_ccw
    assert fits_inside(100.0, 64.0)
    assert not fits_inside(110.0, 72.0)


def test_platforms_are_level_and_joined_smoothly():
    rng = np.random.default_rng(3)
    land = draw_land(3.0, 40.0, rng)
    plots = (Plot(Frame(0.0, 0.0, 0.3), 50.0, 30.0), Plot(Frame(90.0, 75.0, 0.3), 40.0, 30.0))
    relief = level(land, plots)
    for plot, height in zip(plots, relief.level_m, strict=True):
        inside = plot.frame.world(rng.uniform(-1.0, 1.0, (500, 2)) * [plot.half_x_m, plot.half_y_m])
        assert relief(inside) == pytest.approx(height, abs=1e-4)
        assert height == pytest.approx(land(inside).mean(), abs=0.8)
    away = np.array([[400.0, -300.0], [-220.0, 10.0]])
    assert relief(away) == pytest.approx(land(away))
    walk = np.column_stack([np.linspace(-120.0, 220.0, 4000), np.linspace(-60.0, 140.0, 4000)])
    step = np.linalg.norm(walk[1] - walk[0])
    assert np.abs(np.diff(relief(walk))).max() < 1.0 * step
