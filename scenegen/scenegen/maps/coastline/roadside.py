"""Beside the coastal road: guard rail where the land falls to the sea, poles with wires, lamps, signs, fences."""

from __future__ import annotations

import numpy as np
import shapely

from scenegen.classes import Semantic
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import LUMP_STANDOFF_M, Part
from scenegen.geometry.placement import along
from scenegen.geometry.template import Template, place
from scenegen.maps.coastline.layout import LIGHTHOUSE_YARD_M, Layout
from scenegen.maps.coastline.relief import ROAD_HALF_M
from scenegen.maps.coastline.workshop import CoastWorkshop
from scenegen.parts.fixtures.erect import erect
from scenegen.parts.fixtures.fences import fence
from scenegen.parts.fixtures.utility import fastenings
from scenegen.parts.fixtures.wires import wires

_BAY_M = 4.0
_POLE_PITCH_M = 38.0
_RAIL_M, _POLE_M, _LAMP_M, _SIGN_M = (
    ROAD_HALF_M + 0.7,
    ROAD_HALF_M + 3.6,
    ROAD_HALF_M + 1.1,
    ROAD_HALF_M + 1.3,
)


def guard_rail() -> Template:
    """Four metres of W-beam from x = 0 on its post, the beam towards +y. Slot: 0."""
    model = Modeller()
    model.box((1.94, -0.13, -0.3), (2.06, -0.02, 0.72), 0, Semantic.BARRIER, LUMP_STANDOFF_M)
    depth, rise = (0.0, 0.07, 0.0, 0.07, 0.0), (0.43, 0.5, 0.585, 0.67, 0.74)
    line = np.array([[0.0, d, z] for d, z in zip(depth, rise, strict=True)])
    points = np.concatenate([line, line + np.array([_BAY_M, 0, 0])])
    quads = np.array([[k, k + 1, k + 6, k + 5] for k in range(4)])
    faces = quads[:, [0, 2, 1, 0, 3, 2]].reshape(-1, 3)
    for side in (1.0, -1.0):
        site = model.site(
            np.array([2.0, 0.035 + 0.06 * side, 0.6]), np.array([0, side, 0.0]), LUMP_STANDOFF_M
        )
        skin = points + np.array([0, 0.004 * side, 0])
        turned = faces if side > 0 else faces[:, ::-1]
        model.mesh(skin, turned, 0, Semantic.BARRIER, np.full(faces.shape, site))
    return model.finish()


def build_roadside(
    layout: Layout, shop: CoastWorkshop, rng: np.random.Generator
) -> tuple[list[Part], dict[str, int]]:
    """Everything along the road, and counts."""
    line = shapely.get_coordinates(layout.road)
    line = line[np.abs(line).max(axis=1) < shop.coast.half_m + 150.0]
    rail_rng, pole_rng, lamp_rng, fence_rng = rng.spawn(4)
    rails, rail_m = _guard_rail(line, layout, shop, rail_rng)
    poles, standing = _poles(line, shop, pole_rng)
    lamps = _posts("lamp", line, layout, shop, lamp_rng)
    parts = [*rails, *poles, *lamps[0], *_lighthouse_fence(layout, shop, fence_rng)]
    return parts, {
        "guard rail (m)": rail_m,
        "utility poles": standing,
    } | lamps[1]


def _guard_rail(
    line: np.ndarray, layout: Layout, shop: CoastWorkshop, rng: np.random.Generator
) -> tuple[list[Part], int]:
    """On the seaward side (right of the line) where the ground falls within a stone's throw."""
    coast, length = shop.coast, shapely.LineString(line).length
    mark = np.arange(0.0, length - _BAY_M, _BAY_M)
    foot, _ = along(line, mark, np.full(len(mark), _RAIL_M))
    tip, _ = along(line, mark + _BAY_M, np.full(len(mark), _RAIL_M))
    middle = (foot + tip) / 2
    down, _ = along(line, mark + _BAY_M / 2, np.full(len(mark), _RAIL_M + 42.0))
    drop = shop.relief(middle) - shop.relief(down)
    low = np.array([p.bounds for p in shapely.buffer(shapely.points(middle), 2.5)])
    gaps = shapely.union_all([layout.drive.buffer(4.0), layout.path.buffer(3.0), layout.car_park.buffer(8.0)])
    keep = (drop > 5.0) & coast.inside(middle, -100.0) & ~shapely.intersects(gaps, shapely.box(*low.T))
    keep = np.convolve(keep.astype(float), np.ones(9) / 9, mode="same") > 0.5
    keep &= ~shapely.intersects(gaps, shapely.box(*low.T))
    a, b = foot[keep], tip[keep]
    step = b - a
    run = np.linalg.norm(step, axis=1)
    rise = (shop.relief(b) - shop.relief(a)) / np.maximum(run, 1e-6)
    unit = step / np.maximum(run, 1e-6)[:, None]
    scale = np.column_stack([run / _BAY_M, np.ones((len(a), 2))])
    owner = np.full(len(a), shop.builder.new_objects())
    skins = np.full((len(a), 1), shop.palette.pick("steel_galv_post", rng))
    for shape in shapely.linestrings(np.stack([a, b], axis=1)) if len(a) else ():
        shop.claims.hold(shape.buffer(0.3))
    position = np.column_stack([a, shop.relief(a)])
    heading = np.arctan2(unit[:, 1], unit[:, 0])
    return [place(guard_rail(), position, heading, scale, skins, owner, rise[:, None] * unit)], round(
        run.sum()
    )


def _poles(line: np.ndarray, shop: CoastWorkshop, rng: np.random.Generator) -> tuple[list[Part], int]:
    """Utility poles on the landward side with four wires and a telephone cable from pole to pole."""
    length = shapely.LineString(line).length
    mark = np.arange(rng.uniform(5.0, 30.0), length, _POLE_PITCH_M)
    xy, heading = along(line, mark, np.full(len(mark), -_POLE_M))
    free = shop.claims.free(shapely.buffer(shapely.points(xy), 0.5), 0.4)
    xy, heading = xy[free], heading[free]
    if len(xy) < 2:
        return [], 0
    for point in shapely.buffer(shapely.points(xy), 0.3):
        shop.claims.hold(point)
    foot = np.column_stack([xy, shop.relief(xy)])
    direct = np.diff(xy, axis=0)
    turn = np.arctan2(direct[:, 1], direct[:, 0])
    turn = np.concatenate([turn[:1], (np.unwrap(turn)[1:] + np.unwrap(turn)[:-1]) / 2, turn[-1:]])
    parts = erect("utility_pole", foot, turn, shop, rng)
    insulators, telephone = fastenings(foot, turn)
    tops = np.concatenate([insulators, telephone[:, None]], axis=1)
    span = np.linalg.norm(direct, axis=1)
    near = np.flatnonzero(span < 2.2 * _POLE_PITCH_M)
    skin = shop.palette.only("cable_weathered")
    hung = []
    for radius, some in ((0.006, slice(0, 4)), (0.013, slice(4, 5))):
        start, end = tops[near, some].reshape(-1, 3), tops[near + 1, some].reshape(-1, 3)
        sag = 0.022 * np.linalg.norm(end - start, axis=1)
        owner = shop.builder.new_objects(len(start)) + np.arange(len(start))
        hung.append(wires(start, end, sag, radius, skin, int(Semantic.WIRE), owner))
    return [*parts, *hung], len(xy)


def _posts(
    kind: str, line: np.ndarray, layout: Layout, shop: CoastWorkshop, rng: np.random.Generator
) -> tuple[list[Part], dict[str, int]]:
    """Lamps near the car park, signs along the road, a flag, benches and bins."""
    middle = float(shapely.LineString(line).project(layout.car_park.centroid))
    rows = {
        "lamp": (middle + np.arange(-96.0, 97.0, 32.0), -_LAMP_M, -0.5 * np.pi),
        "triangle_sign": (middle + np.array([-150.0, 170.0]), _SIGN_M, np.pi),
        "round_sign": (middle + np.array([-118.0, 236.0]), -_SIGN_M, 0.0),
        "bollard": (middle + np.arange(26.0, 40.0, 2.2), -ROAD_HALF_M - 0.9, 0.0),
    }
    parts: list[Part] = []
    count = 0
    for name, (mark, right, turn) in rows.items():
        xy, heading = along(line, mark, np.full(len(mark), right))
        keep = shop.coast.inside(xy, 5.0) & shop.claims.free(shapely.buffer(shapely.points(xy), 0.3), 0.3)
        for point in shapely.buffer(shapely.points(xy[keep]), 0.3):
            shop.claims.hold(point)
        position = np.column_stack([xy, shop.relief(xy)])[keep]
        parts += erect(name, position, heading[keep] + turn, shop, rng)
        count += int(keep.sum())
    parts += _along_pier(layout, shop, rng)
    return parts, {"lamps and signs": count}


def _along_pier(layout: Layout, shop: CoastWorkshop, rng: np.random.Generator) -> list[Part]:
    """Small lamps, benches and bins on the pier's deck; a flag at the lighthouse."""
    start, end = layout.pier
    ahead = (end - start) / np.linalg.norm(end - start)
    right, heading = np.array([ahead[1], -ahead[0]]), float(np.arctan2(ahead[1], ahead[0]))
    reach = np.linalg.norm(end - start) - 16.0
    rows = (
        ("lamp", np.arange(6.0, reach, 20.0), 1.35, 0.5, 0.5 * np.pi),
        ("bench", np.arange(16.0, reach, 20.0), -1.3, 1.0, np.pi),
        ("litter_bin", np.arange(18.0, reach, 40.0), -1.35, 1.0, 0.0),
    )
    parts: list[Part] = []
    for name, mark, side, size, turn in rows:
        xy = start + mark[:, None] * ahead + side * right
        position = np.column_stack([xy, np.full(len(xy), layout.pier_deck_m)])
        parts += erect(name, position, np.full(len(xy), heading + turn), shop, rng, size)
    flag = layout.lighthouse[:2] + (LIGHTHOUSE_YARD_M - 1.6) * right
    position = np.append(flag, layout.lighthouse[2])[None]
    return parts + erect("flag_pole", position, np.array([heading + 2.0]), shop, rng)


def _lighthouse_fence(layout: Layout, shop: CoastWorkshop, rng: np.random.Generator) -> list[Part]:
    """Around the lighthouse's yard, open where the drive comes in."""
    drive = shapely.get_coordinates(layout.drive)
    towards = drive[-2] - drive[-1]
    first = np.arctan2(towards[1], towards[0]) + 0.32
    turn = first + np.linspace(0.0, 2 * np.pi - 0.64, 22)
    ring = layout.lighthouse[:2] + (LIGHTHOUSE_YARD_M - 0.4) * np.column_stack([np.cos(turn), np.sin(turn)])
    return fence(ring, "picket" if rng.uniform() < 0.6 else "rail", 1.05, shop, rng)
