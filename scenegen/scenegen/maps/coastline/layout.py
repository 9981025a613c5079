"""Where people have built on the coast: road, car park, pier, breakwater, lighthouse; and the land they levelled."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely
from jaxtyping import Float64
from scipy.ndimage import gaussian_filter1d

from scenegen.geometry.placement import rectangles
from scenegen.maps.coastline.knobs import CoastlineKnobs
from scenegen.maps.coastline.relief import ROAD_HALF_M, CoastRelief, Mound, Pad, with_road
from scenegen.maps.coastline.shape import FAR_M, Coast

LIGHTHOUSE_YARD_M = 7.5
"""Radius of the level ground around the lighthouse [m]."""

_CAR_PARK_M = (46.0, 17.0)
_EDGE_M = 60.0
_ROAD_SMOOTHING_M = 38.0


@dataclass(frozen=True, eq=False)
class Layout:
    """What people have laid out, before it becomes geometry.

    Attributes
    ----------
    road : shapely.LineString
        Centre line of the coastal road, far beyond the detailed square.
    drive : shapely.LineString
        From the road to the lighthouse.
    path : shapely.LineString
        From the car park over the dunes to the pier.
    car_park : shapely.Polygon
    car_park_heading_rad : float
        Along its length, as the road runs.
    lighthouse : float64 (3,)
        Foot of the tower [m].
    pier : float64 (2, 2)
        Plan of its landward and its seaward end [m].
    pier_deck_m : float
        Height of its deck.
    mound : Mound
        The breakwater.
    """

    road: shapely.LineString
    drive: shapely.LineString
    path: shapely.LineString
    car_park: shapely.Polygon
    car_park_heading_rad: float
    lighthouse: Float64[np.ndarray, "3"]
    pier: Float64[np.ndarray, "2 2"]
    pier_deck_m: float
    mound: Mound


def lay_out(land: CoastRelief, knobs: CoastlineKnobs, rng: np.random.Generator) -> tuple[Layout, CoastRelief]:
    """Draw the layout and level the land for it."""
    coast = land.coast
    spots, pier_rng, wall_rng, light_rng = rng.spawn(4)
    relief = with_road(land, lambda h: gaussian_filter1d(h, _ROAD_SMOOTHING_M / 2.0))
    s = _stations_inside(coast)
    pier_s = _somewhere(s, coast.cliff(s), spots)
    pier = _pier(coast, pier_s, pier_rng.uniform(*knobs.pier_length_m), pier_rng)
    mound = _breakwater(
        coast, _beside(s, pier_s, coast, spots), pier_s, wall_rng.uniform(*knobs.breakwater_length_m)
    )
    relief = replace(relief, mounds=(mound,))
    free = np.abs(s - pier_s) > min(70.0, 0.3 * np.ptp(s))
    light_s = float(s[free][int(np.argmax(coast.cliff_m(s[free]) + light_rng.uniform(0.0, 2.0, free.sum())))])
    tower = _at(coast, light_s, float(coast.brow(np.array([light_s]))[0]) + 3.5 + LIGHTHOUSE_YARD_M)
    park, heading = _car_park(coast, pier_s + spots.uniform(-12.0, 12.0))
    yard = shapely.Point(tower).buffer(LIGHTHOUSE_YARD_M)
    pads = tuple(Pad(p, float(relief(shapely.get_coordinates(p.centroid))[0])) for p in (park, yard))
    relief = replace(relief, pads=pads)
    layout = Layout(
        road=_road(coast),
        drive=_drive(coast, light_s, tower),
        path=_path(coast, pier[0]),
        car_park=park,
        car_park_heading_rad=heading,
        lighthouse=np.append(tower, pads[1].level_m),
        pier=pier,
        pier_deck_m=float(relief(pier[:1])[0]) + 0.25,
        mound=mound,
    )
    return layout, relief


def _stations_inside(coast: Coast) -> np.ndarray:
    """Distances along the shore at which shore and road lie well inside the detailed square."""
    s = np.arange(-1.4 * coast.half_m, 1.4 * coast.half_m, 4.0)
    shore, road = coast.plan(s, np.zeros(len(s))), coast.frame.world(np.column_stack([s, coast.road(s)]))
    good = coast.inside(shore, _EDGE_M) & coast.inside(road, 0.4 * _EDGE_M)
    return np.asarray(s[good]) if good.any() else np.array([0.0, 4.0])


def _at(coast: Coast, s: float, q: float) -> np.ndarray:
    return np.asarray(coast.plan(np.array([s]), np.array([q]))[0])


def _somewhere(s: np.ndarray, cliff: np.ndarray, rng: np.random.Generator) -> float:
    """A place on the open beach, or where there is least cliff."""
    inner = np.abs(s - s.mean()) < 0.36 * np.ptp(s) + 4.0
    good = np.flatnonzero((cliff <= max(0.1, float(cliff[inner].min()))) & inner)
    return float(s[int(rng.choice(good))])


def _beside(s: np.ndarray, pier_s: float, coast: Coast, rng: np.random.Generator) -> float:
    """Root of the breakwater: some way from the pier, rather not under the highest cliff."""
    away = np.abs(s - pier_s)
    misfit = np.abs(away - 110.0) / 40.0 + 1.5 * coast.cliff(s) + rng.uniform(0.0, 0.5, len(s))
    return float(s[int(np.argmin(misfit))])


def _pier(coast: Coast, s: float, length_m: float, rng: np.random.Generator) -> np.ndarray:
    """From the head of the beach straight out, as far as the detailed square goes."""
    start = _at(coast, s, float(coast.beach(np.array([s]))[0]) - 3.0)
    angle = coast.frame.heading_rad - 0.5 * np.pi + rng.uniform(-0.12, 0.12)
    ahead = np.array([np.cos(angle), np.sin(angle)])
    length = length_m + float(coast.beach(np.array([s]))[0])
    while not coast.inside((start + length * ahead)[None], 25.0)[0] and length > 20.0:
        length -= 5.0
    return np.array([start, start + length * ahead])


def _breakwater(coast: Coast, root_s: float, pier_s: float, length_m: float) -> Mound:
    """Out from the beach, then bent towards the pier."""
    towards = np.sign(pier_s - root_s) if pier_s != root_s else 1.0
    ahead = -0.5 * np.pi + towards * np.array([0.0, 0.05, 0.2, 0.55, 0.85, 1.0])
    step = length_m * np.array([0.12, 0.2, 0.2, 0.18, 0.16, 0.14])
    root = coast.frame.local(_at(coast, root_s, float(coast.wet(np.array([root_s]))[0]) + 6.0)[None])[0]
    local = root + np.concatenate(
        [np.zeros((1, 2)), np.cumsum(np.column_stack([np.cos(ahead), np.sin(ahead)]) * step[:, None], axis=0)]
    )
    line = coast.frame.world(local)
    inside = np.cumprod(coast.inside(line, 30.0)).astype(bool)
    inside[:2] = True
    return Mound(shapely.LineString(line[inside]), 2.9, 1.9, 0.62)


def _car_park(coast: Coast, s: float) -> tuple[shapely.Polygon, float]:
    """Beside the road, on its landward side."""
    ends = coast.frame.world(
        np.column_stack([s + np.array([-10.0, 10.0]), coast.road(s + np.array([-10.0, 10.0]))])
    )
    ahead = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    inland = np.array([-ahead[1], ahead[0]])
    centre = ends.mean(axis=0) + (ROAD_HALF_M + 2.2 + _CAR_PARK_M[1] / 2) * inland
    heading = float(np.arctan2(ahead[1], ahead[0]))
    length, width = (np.array([v]) for v in _CAR_PARK_M)
    return rectangles(centre[None], length, width, np.array([heading]))[0], heading


def _road(coast: Coast) -> shapely.LineString:
    s = far_stations(coast)
    return shapely.LineString(coast.frame.world(np.column_stack([s, coast.road(s)])))


def far_stations(coast: Coast) -> Float64[np.ndarray, "stations"]:
    """Distances along the shore, close together in the detailed square, ever farther apart beyond."""
    near = np.arange(0.0, 1.45 * coast.half_m, 3.5)
    tail, step = [float(near[-1])], 3.5
    while tail[-1] < 1.45 * FAR_M:
        step *= 1.12
        tail.append(tail[-1] + step)
    far = np.array(tail[1:])
    return np.concatenate([-far[::-1], -near[:0:-1], near, far])


def _drive(coast: Coast, s: float, tower: np.ndarray) -> shapely.LineString:
    """A gravel track from the road, slightly bent."""
    start = coast.frame.world(np.array([[s, float(coast.road(np.array([s]))[0])]]))[0]
    middle = (start + tower) / 2 + 0.08 * np.array([-(tower - start)[1], (tower - start)[0]])
    return shapely.LineString([start, middle, tower])


def _path(coast: Coast, pier: np.ndarray) -> shapely.LineString:
    """A straight path from the road to the landward end of the pier."""
    s = coast.frame.local(pier[None])[0, 0]
    start = coast.frame.world(np.array([[s, float(coast.road(np.array([s]))[0])]]))[0]
    return shapely.LineString([start, (start + pier) / 2, pier])
