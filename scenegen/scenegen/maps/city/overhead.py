"""Overhead wires of trams and trolleybuses: pairs of poles, span wires across the street, contact wires along it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Bool, Float64, Int64

from scenegen.classes import Semantic
from scenegen.geometry.part import Part
from scenegen.geometry.placement import along
from scenegen.geometry.template import Template, place
from scenegen.maps.city.streets import KERB_M, Rank, StreetPlan
from scenegen.maps.city.workshop import CityWorkshop
from scenegen.parts.fixtures.wires import wires
from scenegen.parts.skin import Skin

_FROM_KERB_M = 0.6
_POLE_M, _SPAN_HEIGHT_M, _SPAN_SAG_M = 7.6, 7.2, 0.9
_PITCH_M, _TRIES_M = 29.0, (0.0, 1.7, -1.7, 3.4, -3.4, 5.1, -5.1)
_LANES_M = {Rank.ARTERIAL: (-5.0, -1.8, 1.8, 5.0), Rank.COLLECTOR: (-1.9, 1.9)}
"""Where contact wires run, right of the centre line [m]."""
_CLEAR_M = 1.3
"""From lamps, lights and signs."""
_SPAN_RADIUS_M, _CONTACT_RADIUS_M = 0.01, 0.012


@dataclass(frozen=True, eq=False)
class Overhead:
    """Spans across streets, in the order in which contact wires meet them.

    Attributes
    ----------
    poles : float64 (spans, 2, 3)
        The pole on the left and on the right, and the direction to the other one [m, m, rad].
    street : int64 (spans,)
    joined : bool (spans,)
        Whether the wires go on to the next span.
    lanes_m : tuple of (float, ...)
        Lateral places of the contact wires of each street of the plan; empty where it has none.
    """

    poles: Float64[np.ndarray, "spans 2 3"]
    street: Int64[np.ndarray, "spans"]
    joined: Bool[np.ndarray, "spans"]
    lanes_m: tuple[tuple[float, ...], ...]

    def places(self) -> Float64[np.ndarray, "poles 2"]:
        """Where the poles stand."""
        return self.poles[..., :2].reshape(-1, 2)


def plan_overhead(
    plan: StreetPlan,
    posts: Float64[np.ndarray, "posts 2"],
    covered: int | None,
    shop: CityWorkshop,
    rng: np.random.Generator,
) -> Overhead:
    """Choose streets and put up their poles.

    Parameters
    ----------
    plan : StreetPlan
    posts : float64 (posts, 2)
        What stands at the kerbs already.
    covered : int or None
        A street under a viaduct, which has no room for wires.
    shop : CityWorkshop
    rng : numpy.random.Generator
    """
    share = rng.uniform(*shop.knobs.wired_street_share)
    blocks, tree = (
        shapely.STRtree(np.asarray(plan.blocks, dtype=object)),
        shapely.STRtree(shapely.points(posts)),
    )
    rows: list[np.ndarray] = []
    street: list[int] = []
    lanes: list[tuple[float, ...]] = []
    for k, line in enumerate(plan.streets):
        wired = line.rank in _LANES_M and k not in (0, covered) and rng.uniform() < share
        lanes.append(_LANES_M[line.rank] if wired else ())
        for link in plan.links:
            if link.street == k and wired:
                found = _spans(line.line, link.start_m, link.end_m, line.width_m, blocks, tree)
                rows += found
                street += [k] * len(found)
    poles = np.array(rows, np.float64).reshape(-1, 2, 3)
    owner = np.array(street, np.int64)
    middle = poles[..., :2].mean(axis=1)
    gap = np.linalg.norm(np.diff(middle, axis=0), axis=1)
    joined = np.zeros(len(owner), bool)
    joined[:-1] = (np.diff(owner) == 0) & (gap < 3.0 * _PITCH_M)
    return Overhead(poles, owner, joined, tuple(lanes))


def _spans(
    line: np.ndarray,
    start_m: float,
    end_m: float,
    width_m: float,
    blocks: shapely.STRtree,
    posts: shapely.STRtree,
) -> list[np.ndarray]:
    """Pairs of poles along a link; each moves a little along the street until both have room."""
    count = max(int((end_m - start_m) // _PITCH_M), 1)
    aside = width_m / 2 + _FROM_KERB_M
    found = []
    for mark in start_m + (np.arange(count) + 0.5) * (end_m - start_m) / count:
        for shift in _TRIES_M:
            xy, heading = along(line, np.full(2, mark + shift), np.array([-aside, aside]))
            spots = shapely.points(xy)
            on_kerb = len(np.unique(blocks.query(spots, predicate="within")[0])) == 2
            if on_kerb and not posts.query(spots, predicate="dwithin", distance=_CLEAR_M).size:
                across = heading + np.array([-0.5, 0.5]) * np.pi
                found.append(np.column_stack([xy, across]))
                break
    return found


def build_overhead(overhead: Overhead, shop: CityWorkshop) -> list[Part]:
    """Poles and wires as parts: one instance for each pole, one for the wires of a street."""
    count = len(overhead.poles)
    if not count:
        return []
    steel, cable = shop.palette.variants("steel_galv_post", 2)[0], shop.palette.only("cable_weathered")
    flat = overhead.poles.reshape(-1, 3)
    position = np.column_stack([flat[:, :2], shop.relief(flat[:, :2]) + KERB_M])
    owner = shop.builder.new_objects(2 * count) + np.arange(2 * count)
    skins = np.full((2 * count, 1), steel)
    posts = place(_pole(), position, flat[:, 2], np.ones((2 * count, 3)), skins, owner)
    net = shop.builder.new_objects(len(overhead.lanes_m)) + overhead.street
    tops = position.reshape(-1, 2, 3) + np.array([0.0, 0.0, _SPAN_HEIGHT_M])
    label = int(Semantic.WIRE)
    sag = np.full(count, _SPAN_SAG_M)
    spans = wires(tops[:, 0], tops[:, 1], sag, _SPAN_RADIUS_M, cable, label, net, chords=12)
    start, end, who = _contacts(overhead, tops, net)
    contact = wires(start, end, np.full(len(start), 0.06), _CONTACT_RADIUS_M, cable, label, who, chords=4)
    return [posts, spans, contact]


def _contacts(
    overhead: Overhead, tops: np.ndarray, net: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Ends and owners of the contact wires between successive spans: they hang on the span wires."""
    width = np.linalg.norm(tops[:, 1, :2] - tops[:, 0, :2], axis=1)
    starts, ends, owners = [np.zeros((0, 3))], [np.zeros((0, 3))], [np.zeros(0, np.int64)]
    for lane in sorted({m for row in overhead.lanes_m for m in row}):
        has = np.array([lane in overhead.lanes_m[k] for k in overhead.street])
        t = 0.5 + lane / width
        point = tops[:, 0] + t[:, None] * (tops[:, 1] - tops[:, 0])
        point[:, 2] -= 4.0 * _SPAN_SAG_M * t * (1.0 - t)
        here = np.flatnonzero(has & overhead.joined)
        starts.append(point[here])
        ends.append(point[here + 1])
        owners.append(net[here])
    return np.concatenate(starts), np.concatenate(ends), np.concatenate(owners)


def _pole() -> Template:
    """A tapered steel pole on a collar. Slot: 0."""
    skin = Skin(Semantic.POLE, smooth=True)
    skin.tube((0.0, 0.0, -0.15), (0.0, 0.0, 1.1), (0.13, 0.13), 0, 8)
    skin.tube((0.0, 0.0, 1.1), (0.0, 0.0, _POLE_M), (0.1, 0.07), 0, 8)
    skin.around(0, (0.0, 0.0, 0.5 * _POLE_M))
    return skin.finish()
