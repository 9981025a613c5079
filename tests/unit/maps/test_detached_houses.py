"""Houses made of bodies: roofs that meet in valleys, shells that close, plans without overlap."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from scenegen.buildings.detached.body import Body, End, Home, Role, Top, outline
from scenegen.buildings.detached.draw import Traits, draw_bodies, draw_home_style
from scenegen.buildings.detached.roofs import home_roofs
from scenegen.buildings.detached.walls import home_walls
from scenegen.buildings.lots import Lot
from scenegen.classes import Semantic
from scenegen.foundation.rng import stream
from scenegen.geometry.part import concatenate, face_normals
from scenegen.materials.palette import PaletteBuilder


def house(bodies, seed=0):
    palette = PaletteBuilder(stream(seed, "palette"))
    style = draw_home_style(Traits(False, 1, False, 0.3), 0, palette, stream(seed, "style"))
    lot = Lot(shapely.box(-50, -50, 50, 50), np.zeros(2), 0.0, 100.0)
    none = np.zeros((0, 3))
    return Home(1, style, bodies, lot, 0.0, 0.5, none, none)


def test_a_cross_gable_covers_its_plan_once():
    """Seen from above, main roof and wing roof meet in valleys: no hole and no second layer inside the walls."""
    main = Body(-6.0, 6.0, 0.0, 9.0, 2.8, 1, Role.HOUSE, Top.RIDGED, slope=0.7)
    wing = Body(
        -5.0, 0.0, -3.0, 0.0, 2.8, 1, Role.HOUSE, Top.RIDGED, True, slope=0.7, ends=(End.GABLE, End.VALLEY)
    )
    roof = home_roofs([house((main, wing))])
    normals, _ = face_normals(roof.vertices, roof.faces)
    upper = (normals[:, 2] > 0.3) & (roof.semantic == Semantic.ROOF)
    tree = shapely.STRtree(shapely.polygons(roof.vertices[roof.faces[upper]][..., :2]))
    xy = np.random.default_rng(0).uniform((-6.0, -3.0), (6.0, 9.0), (2000, 2))
    xy = xy[shapely.contains_xy(outline((main, wing)).buffer(-0.1), xy)]
    hits = np.bincount(tree.query(shapely.points(xy), predicate="within")[0], minlength=len(xy))
    assert (hits == 1).mean() > 0.995
    assert hits.max() == 1


@pytest.mark.parametrize("end", [End.GABLE, End.HIP])
def test_walls_and_roof_close_around_a_plain_house(end):
    """The roof looks up and outward, its ridge no higher than its slope allows, and the walls look outward."""
    a, b, eave, slope = 12.0, 8.0, 2.8, 0.6
    body = Body(-a / 2, a / 2, 0.0, b, eave, 1, Role.HOUSE, Top.RIDGED, slope=slope, ends=(end, end))
    home = house((body,))
    shell = concatenate([home_walls([home], stream(0, "walls")), home_roofs([home])])
    normals, _ = face_normals(shell.vertices, shell.faces)
    middle = shell.vertices[shell.faces].mean(axis=1)
    roof = (shell.semantic == Semantic.ROOF) & (normals[:, 2] > 0.3)
    assert ((normals[roof] * (middle[roof] - np.array([0.0, b / 2, 0.0]))).sum(axis=1) > 0).all()
    ridge = middle[roof][:, 2].max()
    assert eave < ridge < eave + slope * b / 2 + 0.3
    wall = (shell.semantic != Semantic.ROOF) & (np.abs(normals[:, 2]) < 0.01)
    outward = (normals[wall] * (middle[wall] - np.array([0.0, b / 2, 0.0])))[:, :2].sum(axis=1)
    assert (outward > 0).mean() > 0.7  # the rest are reveals of windows


@pytest.mark.parametrize("seed", range(40))
def test_bodies_touch_but_do_not_overlap(seed):
    rng = stream(seed, "bodies")
    traits = Traits(bool(rng.uniform() < 0.5), int(rng.integers(1, 3)), True, 0.3)
    style = draw_home_style(traits, 0, PaletteBuilder(rng), rng)
    bodies = draw_bodies(traits, style, rng.uniform(10.0, 24.0), rng)
    boxes = np.array([shapely.box(b.x0_m, b.y0_m, b.x1_m, b.y1_m) for b in bodies], dtype=object)
    assert shapely.area(boxes).sum() == pytest.approx(outline(bodies).area, rel=1e-6)
    mirrored = tuple(b.moved(3.0, 4.0, True) for b in bodies)
    assert outline(mirrored).area == pytest.approx(outline(bodies).area, rel=1e-9)
    main = bodies[0]
    for body in bodies[1:]:
        if End.VALLEY in body.ends:
            assert body.slope == main.slope
            assert body.eave_m == main.eave_m
            assert body.half_across_m <= main.half_across_m
