"""What stands along the streets: lamps, utility poles with their wires, signs, letter boxes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Float64

from scenegen.buildings.detached.body import Home, Role, Top
from scenegen.classes import Semantic
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import LUMP_STANDOFF_M, Part
from scenegen.geometry.placement import along
from scenegen.geometry.template import Template, place
from scenegen.maps.neighborhood.parcels import Parcel
from scenegen.maps.neighborhood.streets import CARRIAGEWAY_M, KERB_M, StreetPlan
from scenegen.maps.neighborhood.workshop import NeighborhoodWorkshop
from scenegen.parts.fixtures.erect import erect
from scenegen.parts.fixtures.utility import fastenings
from scenegen.parts.fixtures.wires import wires

_POLE_PITCH_M, _LAMP_PITCH_M = (31.0, 39.0), (30.0, 38.0)
_FROM_DRIVE_M, _FROM_KERB_M, _END_M = 0.7, 0.3, 7.0
_WIRE_M, _CABLE_M, _DROP_M = 0.009, 0.016, 0.011
_SAG, _DROP_SAG = 0.018, 0.03
_LONGEST_SPAN_M, _LONGEST_DROP_M = 52.0, 42.0
_MAST_IN_M, _MAST_UP_M, _MAST_RADIUS_M = 0.6, 1.05, 0.035


@dataclass(frozen=True, eq=False)
class Kerbside:
    """Where things stand along streets.

    Attributes
    ----------
    lamps, signs, boxes : float64 (n, 3)
        Position and heading.
    poles : tuple of float64 (n, 3)
        Utility poles of each stretch of line, in order; position and heading along the line.
    spans : float64 (spans, 2, 2)
        Plan of all overhead spans, drops included; trees keep clear.
    drops : tuple of (int, float64 (3,), float64 (3,))
        Index of the home, top of its mast, fastening at the pole.
    """

    lamps: Float64[np.ndarray, "lamps 3"]
    signs: Float64[np.ndarray, "signs 3"]
    boxes: Float64[np.ndarray, "boxes 3"]
    poles: tuple[Float64[np.ndarray, "_ 3"], ...]
    spans: Float64[np.ndarray, "spans 2 2"]
    drops: tuple[tuple[int, np.ndarray, np.ndarray], ...]

    def feet(self) -> Float64[np.ndarray, "feet 2"]:
        """Plan of all posts."""
        rows = [self.lamps, self.signs, self.boxes, *self.poles]
        return np.concatenate([r[:, :2] for r in rows])


def plan_kerbside(
    plan: StreetPlan,
    parcels: Sequence[Parcel],
    homes: Sequence[Home],
    solid: np.ndarray,
    shop: NeighborhoodWorkshop,
    rng: np.random.Generator,
) -> Kerbside:
    """Draw places that keep clear of driveways and of each other.

    Parameters
    ----------
    plan, parcels, homes
        What was drawn so far.
    solid : array of shapely.Polygon
        Plan of each home.
    shop : NeighborhoodWorkshop
    rng : numpy.random.Generator
    """
    houses = shapely.STRtree(solid)
    drives = np.array([p.driveway for p in parcels if p.driveway is not None], dtype=object)
    tree = shapely.STRtree(np.append(drives, plan.carriageway.buffer(_FROM_KERB_M - _FROM_DRIVE_M)))
    share = rng.uniform(*shop.knobs.pole_share)
    lamps, poles = [np.zeros((0, 3))], []
    for line in plan.lines:
        side = 1.0 if rng.uniform() < 0.5 else -1.0
        if rng.uniform() < share:
            row = _row(line, rng.uniform(*_POLE_PITCH_M), side * _offset(plan), tree, rng)
            if len(row) > 1:
                poles.append(_facing_on(row))
        light = _row(line, rng.uniform(*_LAMP_PITCH_M), -side * _offset(plan), tree, rng)
        light[:, 2] += -0.5 * np.pi * side
        lamps.append(light)
    lights = np.concatenate(lamps)
    drops = _drops(poles, homes, houses, shop)
    lines = [np.stack([p[:-1, :2], p[1:, :2]], axis=1) for p in poles] + [_links(poles, houses)]
    lines += [np.array([[d[1][:2], d[2][:2]]]) for d in drops]
    return Kerbside(
        lights, _signs(plan), _letter_boxes(parcels, plan, lights), tuple(poles),
        np.concatenate([np.zeros((0, 2, 2)), *lines]), tuple(drops),
    )  # fmt: skip


def build_kerbside(
    kerbside: Kerbside, homes: Sequence[Home], shop: NeighborhoodWorkshop, rng: np.random.Generator
) -> list[Part]:
    """Posts, wires and boxes as parts."""
    parts = erect("lamp", _on_ground(kerbside.lamps, shop), kerbside.lamps[:, 2], shop, rng, 0.8)
    parts += erect("stop_sign", _on_ground(kerbside.signs, shop), kerbside.signs[:, 2], shop, rng, 0.95)
    parts += _boxes(kerbside.boxes, shop, rng)
    every = np.concatenate([np.zeros((0, 3)), *kerbside.poles])
    loaded = rng.uniform(size=len(every)) < 0.16
    for kind, mine in (("utility_pole", ~loaded), ("transformer_pole", loaded)):
        parts += erect(kind, _on_ground(every[mine], shop), every[mine, 2], shop, rng)
    return parts + _overhead(kerbside, homes, shop, rng)


def _offset(plan: StreetPlan) -> float:
    """From the centre line to posts: on the verge, or behind the sidewalk."""
    half = CARRIAGEWAY_M / 2
    return half + 0.55 * plan.verge_m if plan.verge_m > 1.0 else half + plan.walk_m + 0.35


def _row(
    line: np.ndarray, pitch_m: float, right_m: float, drives: shapely.STRtree, rng: np.random.Generator
) -> np.ndarray:
    """Evenly spaced posts beside a street, each shifted or left out where a driveway or a turning circle is."""
    length = float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())
    count = int((length - 2 * _END_M) / pitch_m) + 1
    if length < 3 * _END_M:
        return np.zeros((0, 3))
    marks = np.linspace(_END_M, length - _END_M, max(count, 2)) + rng.uniform(-1.0, 1.0, max(count, 2))
    rows = []
    for mark in marks:
        for shift in (0.0, 2.5, -2.5, 5.0, -5.0):
            at = np.clip(mark + shift, 3.0, length - 3.0)
            xy, heading = along(line, np.array([at]), np.array([right_m]))
            if not len(drives.query(shapely.Point(xy[0]), predicate="dwithin", distance=_FROM_DRIVE_M)):
                rows.append([*xy[0], float(heading[0])])
                break
    return np.array(rows).reshape(-1, 3)


def _facing_on(row: np.ndarray) -> np.ndarray:
    """Poles turned so that cross-arms halve the angle between their two spans."""
    step = np.diff(row[:, :2], axis=0)
    unit = step / np.linalg.norm(step, axis=1)[:, None]
    mean = np.concatenate([unit[:1], unit[:-1] + unit[1:], unit[-1:]])
    return np.column_stack([row[:, :2], np.arctan2(mean[:, 1], mean[:, 0])])


def _links(poles: Sequence[np.ndarray], houses: shapely.STRtree) -> np.ndarray:
    """Spans between the ends of different stretches, so that few lines end nowhere; none over a house."""
    if len(poles) < 2:
        return np.zeros((0, 2, 2))
    ends = np.array([[p[0, :2], p[-1, :2]] for p in poles])
    everyone = np.concatenate([p[:, :2] for p in poles])
    owner = np.repeat(np.arange(len(poles)), [len(p) for p in poles])
    found, joined = [], set()
    for k, pair in enumerate(ends):
        for end in pair:
            gap = np.linalg.norm(everyone - end, axis=1)
            gap[owner == k] = np.inf
            near = int(np.argmin(gap))
            key = (min(k, int(owner[near])), max(k, int(owner[near])))
            if gap[near] < _LONGEST_SPAN_M and key not in joined:
                joined.add(key)
                found.append([end, everyone[near]])
    spans = np.array(found).reshape(-1, 2, 2)
    crossing = houses.query(shapely.linestrings(spans), predicate="intersects")[0] if len(spans) else []
    return np.delete(spans, np.unique(crossing).astype(np.int64), axis=0)


def _drops(
    poles: Sequence[np.ndarray], homes: Sequence[Home], houses: shapely.STRtree, shop: NeighborhoodWorkshop
) -> list[tuple[int, np.ndarray, np.ndarray]]:
    """From poles to masts on the roofs of houses nearby, where no other house is in the way."""
    if not poles:
        return []
    every = np.concatenate(poles)
    _, cables = fastenings(_on_ground(every, shop), every[:, 2])
    drops = []
    for k, home in enumerate(homes):
        if home.bodies[0].role is not Role.HOUSE:
            continue
        tops = _mast_tops(home)
        gap = np.linalg.norm(tops[:, None, :2] - cables[None, :, :2], axis=2)
        corner, pole = np.unravel_index(int(np.argmin(gap)), gap.shape)
        span = shapely.LineString([tops[corner, :2], cables[pole, :2]])
        others = set(houses.query(span, predicate="intersects").tolist()) - {k}
        if gap[corner, pole] < _LONGEST_DROP_M and not others:
            drops.append((k, tops[corner], cables[pole] + np.array([0.0, 0.0, 0.45])))
    return drops


def _mast_tops(home: Home) -> np.ndarray:
    """Tops of masts that might stand at the four corners of the main roof."""
    body, d = home.bodies[0], _MAST_IN_M
    local = np.array([[x, y] for x in (body.x0_m + d, body.x1_m - d) for y in (body.y0_m + d, body.y1_m - d)])
    over = {Top.RIDGED: d * body.slope, Top.FLAT: 0.25, Top.SHED: body.rise_m}[body.top]
    top = home.floor_m + body.eave_m + over + _MAST_UP_M
    return np.column_stack([home.lot.world(local), np.full(4, top)])


def _overhead(
    kerbside: Kerbside, homes: Sequence[Home], shop: NeighborhoodWorkshop, rng: np.random.Generator
) -> list[Part]:
    """Conductors and telephone cables from pole to pole, drops and the masts they end on."""
    starts, ends = [np.zeros((0, 4, 3))], [np.zeros((0, 4, 3))]
    cable_starts, cable_ends = [np.zeros((0, 3))], [np.zeros((0, 3))]
    tips: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
    for row in kerbside.poles:
        insulators, cables = fastenings(_on_ground(row, shop), row[:, 2])
        starts.append(insulators[:-1])
        ends.append(insulators[1:])
        cable_starts.append(cables[:-1])
        cable_ends.append(cables[1:])
        tips.append((row[:, :2], insulators, cables))
    if tips:
        places, insulators, cables = (np.concatenate([t[k] for t in tips]) for k in range(3))
        count = sum(len(p) - 1 for p in kerbside.poles)
        links = kerbside.spans[count : len(kerbside.spans) - len(kerbside.drops)]
        for a, b in links:
            i, j = (int(np.argmin(np.linalg.norm(places - p, axis=1))) for p in (a, b))
            cable_starts.append(cables[i : i + 1])
            cable_ends.append(cables[j : j + 1])
    aluminium = shop.palette.pick("metal_galv_weathered", rng)
    rubber = shop.palette.only("tyre_rubber")
    parts = [
        _hung(
            np.concatenate(starts).reshape(-1, 3),
            np.concatenate(ends).reshape(-1, 3),
            _SAG,
            _WIRE_M,
            aluminium,
            shop,
        )
    ]
    parts.append(
        _hung(np.concatenate(cable_starts), np.concatenate(cable_ends), 1.3 * _SAG, _CABLE_M, rubber, shop)
    )
    if kerbside.drops:
        tops = np.array([d[1] for d in kerbside.drops])
        parts.append(_hung(tops, np.array([d[2] for d in kerbside.drops]), _DROP_SAG, _DROP_M, rubber, shop))
        owner = np.array([homes[k].object for k, _, _ in kerbside.drops], np.int64)
        eave = np.array([homes[k].floor_m + homes[k].bodies[0].eave_m for k, _, _ in kerbside.drops])
        feet = np.column_stack([tops[:, :2], eave - 0.1])
        upper = tops + np.array([0.0, 0.0, 0.06])
        none = np.zeros(len(tops))
        parts.append(wires(feet, upper, none, _MAST_RADIUS_M, aluminium, int(Semantic.POLE), owner, chords=1))
    return parts


def _hung(
    start: np.ndarray, end: np.ndarray, sag: float, radius_m: float, skin: int, shop: NeighborhoodWorkshop
) -> Part:
    """Wires whose sag is a share of their span, one instance each."""
    span = np.linalg.norm(end - start, axis=1)
    owner = shop.builder.new_objects(len(start)) + np.arange(len(start))
    return wires(start, end, sag * span, radius_m, skin, int(Semantic.WIRE), owner)


def _signs(plan: StreetPlan) -> np.ndarray:
    """A stop sign at the right of each street that ends at a junction."""
    rows = []
    for line, (start, end) in zip(plan.lines, plan.dead_end, strict=True):
        length = float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())
        if length < 50.0 or np.linalg.norm(line[0] - line[-1]) < 1.0:
            continue
        right = CARRIAGEWAY_M / 2 + max(0.4 * plan.verge_m, 0.3)
        for dead, at, side in ((end, length - 9.5, 1.0), (start, 9.5, -1.0)):
            if not dead:
                xy, heading = along(line, np.array([at]), np.array([side * right]))
                rows.append([*xy[0], float(heading[0]) + (np.pi if side > 0 else 0.0)])
    table = np.array(rows[::2]).reshape(-1, 3)
    return table[~shapely.dwithin(plan.carriageway, shapely.points(table[:, :2]), 0.2)]


def _letter_boxes(parcels: Sequence[Parcel], plan: StreetPlan, lamps: np.ndarray) -> np.ndarray:
    """One where each path meets the sidewalk, facing the street."""
    rows = []
    for parcel in parcels:
        door = parcel.bodies[0].entrance_m if parcel.bodies else None
        if parcel.path is None or door is None:
            continue
        rows.append(
            [*parcel.lot.world(np.array([[door + 1.1, 0.35]]))[0], parcel.lot.heading_rad - 0.5 * np.pi]
        )
    table = np.array(rows).reshape(-1, 3)
    drives = np.array([p.driveway for p in parcels if p.driveway is not None], dtype=object)
    points = shapely.points(table[:, :2])
    blocked = shapely.STRtree(drives).query(points, predicate="dwithin", distance=0.5)[0]
    inside = np.zeros(len(table), bool)
    areas = shapely.STRtree(np.array([p.lot.area for p in parcels], dtype=object))
    inside[areas.query(points, predicate="within")[0]] = True
    inside[blocked] = False
    if len(lamps):
        inside[
            shapely.STRtree(shapely.points(lamps[:, :2])).query(points, predicate="dwithin", distance=0.8)[0]
        ] = False
    return table[inside]


def _letter_box() -> Template:
    """A box with a round top on a post, its door towards +x. Slots: 0 metal, 1 timber."""
    model = Modeller()
    kind = Semantic.STREET_FURNITURE
    model.box((-0.05, -0.05, -0.1), (0.05, 0.05, 1.0), 1, kind, LUMP_STANDOFF_M, covered=True)
    angle = np.linspace(0.0, np.pi, 6)
    rim = np.concatenate(
        [[[0.11, 0.0]], np.column_stack([0.11 * np.cos(angle), 0.14 + 0.11 * np.sin(angle)]), [[-0.11, 0.0]]]
    )
    back, front = (np.column_stack([np.full(len(rim), x), rim[:, 0], 1.0 + rim[:, 1]]) for x in (-0.22, 0.26))
    k, after = np.arange(len(rim)), (np.arange(len(rim)) + 1) % len(rim)
    shell = np.stack([k, after, after + len(rim), k + len(rim)], axis=1)
    fan = np.stack([np.zeros(len(rim) - 2, np.int64), k[1:-1], k[2:]], axis=1)
    faces = np.concatenate([shell[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3), fan[:, ::-1], fan + len(rim)])
    top = model.site(np.array([0.0, 0.0, 1.3]), np.array([0.0, 0.0, 1.0]), LUMP_STANDOFF_M)
    door = model.site(np.array([0.3, 0.0, 1.15]), np.array([1.0, 0.0, 0.2]), LUMP_STANDOFF_M)
    site = np.full(faces.shape, top)
    site[-len(fan) :] = door
    model.mesh(np.concatenate([back, front]), faces, 0, kind, site)
    return model.finish()


def _boxes(rows: np.ndarray, shop: NeighborhoodWorkshop, rng: np.random.Generator) -> list[Part]:
    if not len(rows):
        return []
    count = len(rows)
    metal = np.array([shop.palette.pick("metal_galv_weathered", rng) for _ in range(count)], np.int64)
    wood = np.full(count, shop.palette.pick("wood_siding", rng))
    owner = shop.builder.new_objects(count) + np.arange(count)
    skins = np.column_stack([metal, wood])
    return [place(_letter_box(), _on_ground(rows, shop), rows[:, 2], np.ones((count, 3)), skins, owner)]


def _on_ground(rows: np.ndarray, shop: NeighborhoodWorkshop) -> np.ndarray:
    """Positions on verges, sidewalks and gardens."""
    return np.column_stack([rows[:, :2], shop.relief(rows[:, :2]) + KERB_M])
