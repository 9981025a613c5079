"""Trees in gardens, on verges and commons; shrubs along the houses; hedges on borders."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Bool, Float64

from scenegen.geometry.part import Part
from scenegen.geometry.placement import along, clear_of, first_come
from scenegen.maps.neighborhood.borders import Line, on_gardens
from scenegen.maps.neighborhood.kerbside import Kerbside
from scenegen.maps.neighborhood.parcels import Parcel
from scenegen.maps.neighborhood.streets import CARRIAGEWAY_M, StreetPlan
from scenegen.maps.neighborhood.workshop import NeighborhoodWorkshop
from scenegen.parts.vegetation.plant import crown_radius_m, hedges, plant, shrubs, triangles

_BROAD = (("oak", (6.0, 13.0)), ("lime", (6.0, 13.0)), ("birch", (6.0, 12.0)), ("poplar", (9.0, 16.0)))
_CONIFERS = (("spruce", (5.0, 14.0)), ("pine", (6.0, 13.0)))
_STREET_TREES = ("lime", "oak", "birch")
_COMMONS = 2.6
"""How much denser trees stand on commons than in gardens."""
_WIRE_GAP_M, _LOW_M = 0.9, 4.4
_STREET_PITCH_M = (11.0, 19.0)
_TREE_TRIANGLES, _DETAIL = 360_000, (0.28, 1.0)
"""Of all trees together, about; bounds for their share of the usual triangles. Rays pay most for leaves."""
_SHRUBS = 5
"""Tried per garden; low down they cost rays next to nothing."""
_SHRUB_DEPTH_M = 0.15
"""How deep shrubs stand: beside a pad the mesh of the ground lies a hand below the relief."""
_BANK_M, _BANK_FALL_M = 1.5, 0.5
"""On and above banks that fall so much across twice that way it lies further below."""
_SIDES = ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))


@dataclass(frozen=True, eq=False)
class Obstacles:
    """What greenery keeps clear of, as arrays of shapely geometries.

    Attributes
    ----------
    solid : array
        Houses, porches, sheds.
    paved : array
        Carriageway, driveways, paths, patios, pools with copings, beds.
    posts : array of shapely.Point
    spans : array of shapely.LineString
        Overhead wires.
    lines : array of shapely.LineString
        Fences and hedges.
    walks : array of shapely lines
        Ways of people.
    """

    solid: np.ndarray
    paved: np.ndarray
    posts: np.ndarray
    spans: np.ndarray
    lines: np.ndarray
    walks: np.ndarray


@dataclass(frozen=True, eq=False)
class Trees:
    """Chosen trees: position, species, height and crown radius [m]."""

    xy: Float64[np.ndarray, "trees 2"]
    species: np.ndarray
    height_m: Float64[np.ndarray, "trees"]
    radius_m: Float64[np.ndarray, "trees"]

    def only(self, keep: Bool[np.ndarray, "trees"]) -> Trees:
        """The trees that stay."""
        return Trees(self.xy[keep], self.species[keep], self.height_m[keep], self.radius_m[keep])


def obstacles(
    plan: StreetPlan,
    parcels: Sequence[Parcel],
    holes: Sequence[shapely.Polygon],
    kerbside: Kerbside,
    lines: list[Line],
    walks: np.ndarray,
) -> Obstacles:
    """Collect what trees, shrubs and people must not stand in."""
    spans = kerbside.overhead.spans()
    paved = [plan.carriageway, *(g for p in parcels for g in p.paved())]
    return Obstacles(
        np.asarray(holes, dtype=object),
        np.array(paved, dtype=object),
        np.asarray(shapely.points(kerbside.feet())),
        np.asarray(shapely.linestrings(spans)) if len(spans) else np.zeros(0, object),
        np.array([shapely.LineString(line.points) for line in lines], dtype=object),
        walks,
    )


def plan_trees(
    plan: StreetPlan,
    parcels: Sequence[Parcel],
    blocked: Obstacles,
    shop: NeighborhoodWorkshop,
    rng: np.random.Generator,
) -> Trees:
    """Draw trees that are clear of walls, wires, posts, paving and each other."""
    street, garden, which, order = rng.spawn(4)
    xy, names, height = _street_trees(plan, shop, street)
    spots = _scattered(plan, parcels, shop, garden)
    more, tall = _kinds(len(spots), shop, which)
    xy, names, height = (
        np.concatenate([xy, spots]),
        np.concatenate([names, more]),
        np.concatenate([height, tall]),
    )
    radius = np.zeros(len(xy))
    for name in np.unique(names):
        mine = names == name
        radius[mine] = crown_radius_m(str(name), height[mine])
    shuffle = order.permutation(len(xy))
    trees = Trees(xy[shuffle], names[shuffle], height[shuffle], radius[shuffle])
    return _standing(trees, blocked)


def _standing(trees: Trees, blocked: Obstacles) -> Trees:
    """Those with room for crown and trunk."""
    point = shapely.points(trees.xy)
    keep = clear_of(point, blocked.paved, 0.9) & clear_of(point, blocked.lines, 0.7)
    keep &= clear_of(point, blocked.posts, 1.0)
    trees = trees.only(keep)
    crown = shapely.buffer(shapely.points(trees.xy), trees.radius_m, quad_segs=4)
    keep = clear_of(crown, blocked.solid, 0.6) & clear_of(crown, blocked.posts, 0.25)
    bushy = (trees.height_m < _LOW_M) | np.isin(trees.species, [name for name, _ in _CONIFERS])
    keep &= ~bushy | clear_of(crown, blocked.walks, 0.2)
    keep &= (trees.height_m < _LOW_M) | clear_of(crown, blocked.spans, _WIRE_GAP_M)
    trees = trees.only(keep)
    closer = shapely.buffer(shapely.points(trees.xy), 0.85 * trees.radius_m, quad_segs=4)
    return trees.only(first_come(closer))


def build_greenery(
    trees: Trees,
    lines: list[Line],
    parcels: Sequence[Parcel],
    blocked: Obstacles,
    shop: NeighborhoodWorkshop,
    rng: np.random.Generator,
) -> list[Part]:
    """Trees, shrubs and hedges as parts."""
    raised = on_gardens(shop)
    detail = float(np.clip(_TREE_TRIANGLES / max(triangles(trees.height_m), 1), *_DETAIL))
    parts: list[Part] = []
    for name in np.unique(trees.species):
        mine = trees.species == name
        position = np.column_stack([trees.xy[mine], raised.relief(trees.xy[mine])])
        parts += plant(str(name), position, trees.height_m[mine], raised, rng, detail)
    rows = [line for line in lines if line.style == "hedge"]
    for height, width, corners in sorted({(r.height_m, r.width_m, len(r.points)) for r in rows}):
        alike = [r.points for r in rows if r.height_m == height and len(r.points) == corners]
        parts += hedges(alike, height, width, raised, rng)
    place, size = _shrub_spots(parcels, blocked, trees, rng)
    around = np.stack([raised.relief(place + step) for step in _BANK_M * np.array(_SIDES)])
    level = np.ptp(around, axis=0) < _BANK_FALL_M
    place, size = place[level], size[level]
    position = np.column_stack([place, raised.relief(place) - _SHRUB_DEPTH_M])
    return parts + shrubs(position, size, rng.uniform(0.0, 2 * np.pi, len(place)), raised, rng)


def _kinds(count: int, shop: NeighborhoodWorkshop, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Species and heights of scattered trees; each world prefers some species."""
    conifers = rng.uniform(*shop.knobs.conifer_share)
    table = [*_BROAD, *_CONIFERS]
    taste = rng.uniform(0.15, 1.0, len(table)) * np.array([1.0, 1.0, 1.0, 0.25, 1.0, 0.8])
    broad = len(_BROAD)
    taste[:broad] *= (1 - conifers) / taste[:broad].sum()
    taste[broad:] *= conifers / taste[broad:].sum()
    kind = rng.choice(len(table), count, p=taste)
    low, high = (np.array([row[1][k] for row in table])[kind] for k in (0, 1))
    young = rng.uniform(size=count) < 0.3
    height = (low + (high - low) * rng.beta(1.6, 1.8, count)) * np.where(young, 0.5, 1.0)
    return np.array([row[0] for row in table])[kind], height


def _scattered(
    plan: StreetPlan, parcels: Sequence[Parcel], shop: NeighborhoodWorkshop, rng: np.random.Generator
) -> np.ndarray:
    """Places in gardens, and denser ones on commons and empty lots."""
    rate = rng.uniform(*shop.knobs.trees_per_1000_m2) / 1000.0
    x0, y0, x1, y1 = plan.outline.bounds
    # Many candidates find no room: about half in gardens.
    count = int(2.0 * _COMMONS * rate * (x1 - x0) * (y1 - y0))
    xy = rng.uniform((x0, y0), (x1, y1), (count, 2))
    inside = shapely.contains_xy(plan.outline.buffer(-2.0), xy) & ~shapely.contains_xy(plan.front, xy)
    xy, luck = xy[inside], rng.uniform(size=count)[inside]
    gardens = shapely.STRtree(np.array([p.lot.area for p in parcels if p.solid is not None], dtype=object))
    garden = np.zeros(len(xy), bool)
    garden[gardens.query(shapely.points(xy), predicate="within")[0]] = True
    return np.asarray(xy[~garden & (luck < 0.6) | garden & (luck < 1.0 / _COMMONS)])


def _street_trees(
    plan: StreetPlan, shop: NeighborhoodWorkshop, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows on the verges of some streets, one species each."""
    share = rng.uniform(*shop.knobs.street_tree_share)
    places, names, heights = [np.zeros((0, 2))], [np.zeros(0, "<U8")], [np.zeros(0)]
    for line in plan.lines:
        chosen, name = rng.uniform() < share, _STREET_TREES[int(rng.integers(len(_STREET_TREES)))]
        pitch, tall = rng.uniform(*_STREET_PITCH_M), rng.uniform(4.5, 8.5)
        length = float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())
        if not chosen or plan.verge_m < 1.2 or length < 30.0:
            continue
        for side in (1.0, -1.0):
            marks = np.arange(10.0, length - 8.0, pitch) + rng.uniform(-1.0, 1.0)
            right = side * (CARRIAGEWAY_M / 2 + 0.6 * plan.verge_m)
            places.append(along(line, marks, np.full(len(marks), right))[0])
            names.append(np.full(len(marks), name, "<U8"))
            heights.append(tall * rng.uniform(0.85, 1.15, len(marks)))
    return np.concatenate(places), np.concatenate(names), np.concatenate(heights)


def _shrub_spots(
    parcels: Sequence[Parcel], blocked: Obstacles, trees: Trees, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Places and sizes of shrubs: along house walls, and loose ones in the garden."""
    rows = [np.zeros((0, 5))]
    for parcel in parcels:
        if parcel.solid is None:
            continue
        size = (
            rng.uniform(0.6, 1.7, (_SHRUBS, 1))
            * rng.uniform(0.8, 1.15, (_SHRUBS, 3))
            * np.array([1.0, 1.0, 0.85])
        )
        ring = parcel.solid.buffer(0.65 + 0.5 * float(size[:, 0].max()), join_style="mitre").exterior
        near = shapely.get_coordinates(
            shapely.line_interpolate_point(ring, rng.uniform(0.0, 1.0, _SHRUBS - 1), normalized=True)
        )
        x0, y0, x1, y1 = parcel.lot.area.bounds
        loose = rng.uniform((x0, y0), (x1, y1), (1, 2))
        xy = np.concatenate([near, loose])
        inside = shapely.contains_xy(parcel.lot.area.buffer(-1.0), xy)
        rows.append(np.column_stack([xy, size])[inside])
    table = np.concatenate(rows)
    half = 0.62 * table[:, 2:4].max(axis=1)
    shapes = shapely.buffer(shapely.points(table[:, :2]), half, quad_segs=3)
    keep = clear_of(shapes, blocked.solid, 0.12) & clear_of(shapes, blocked.paved, 0.05)
    keep &= clear_of(shapes, blocked.lines, 0.3) & clear_of(shapes, blocked.posts, 0.2)
    keep &= clear_of(shapes, blocked.walks, 0.4)
    keep &= clear_of(shapes, np.asarray(shapely.points(trees.xy)), 0.3)
    index = np.flatnonzero(keep)
    keep[index] = first_come(shapes[index])
    return table[keep, :2], table[keep, 2:]
