"""The ground plan of the coast: sand, rock, heath, fields, road and paths, out to the horizon; holes under houses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely
from scipy.ndimage import gaussian_filter1d

from scenegen.classes import Semantic
from scenegen.geometry.ground import Region, drape
from scenegen.geometry.part import Part, face_normals
from scenegen.geometry.placement import along, clear_of, first_come, rectangles
from scenegen.geometry.planar import triangulate
from scenegen.geometry.scatter import contact_points, graded_points, hexagonal
from scenegen.maps.coastline.layout import LIGHTHOUSE_YARD_M, Layout, far_stations
from scenegen.maps.coastline.relief import ROAD_HALF_M
from scenegen.maps.coastline.shape import FAR_M
from scenegen.maps.coastline.things import Things
from scenegen.maps.coastline.workshop import CoastWorkshop

_FINE_M, _OPEN_M, _FACE_M = 2.1, 4.0, 1.05
_FINE_POINTS = 30_000
"""Points of the fine lattice, at most: where the shore is long, everything is a little coarser."""
_CONTACT_M = 1.2
_AROUND = ((1.0, 0.25), (1.5, 1.1))
"""Spacing and distance of the rows of points around rocks [m]."""
_ROAD_END_M = 2200.0
_CLEAR_M = 0.01
_FOLD = 0.45
"""Sites rise by this share of what the highest face around them rises over their plane."""
_COVERS = ("grass_watered", "grass_dry", "soil_dry", "grass_dry", "soil_wet", "grass_watered")


def build_ground(
    layout: Layout,
    things: Things,
    rock: str,
    sea_K: float,
    shop: CoastWorkshop,
    rng: np.random.Generator,
) -> Part:
    """All solid ground, a little below the sea's edge to the far edge of the land.

    Parameters
    ----------
    layout : Layout
    things : Things
        No ground below buildings, no sites below rocks (whose heat would be seen around them), gardens.
    rock : str
        Material of this coast's rock.
    sea_K : float
        Temperature of the water [K].
    shop : CoastWorkshop
    rng : numpy.random.Generator
    """
    strips = _Strips(shop)
    regions = [*strips.land(rng), *_fields(layout, shop, rng), *strips.shore(rock, sea_K, rng)]
    regions += [*_heath(layout, shop, rng), *things.lawns, *_roads(layout, shop, rng)]
    regions += _breakwater(layout, rock, shop, rng)
    regions += [Region(p, regions[0].surface, 0, 0, hole=True) for p in things.holes]
    points = _points(strips, things.holes, things.stones, rng)
    half = shop.coast.half_m
    spacing = np.array([_CONTACT_M if r.hole else _FINE_M for r in regions])
    plan = triangulate([r.outline for r in regions], points, spacing, (1.1 * half, 0.1))
    return _above_skin(drape(plan, regions, shop.relief))


def _above_skin(ground: Part) -> Part:
    """Lift sites clear of curved ground: on a crest they would lie just below the faces around them, and in a fold, as
    at the foot of a dune, their rays, which start a little aside, would start below the steeper side."""
    corner = ground.corner_site.ravel()
    normal, _ = face_normals(ground.vertices, ground.faces)
    first = ground.vertices[ground.faces[:, 0]]
    middle = ground.vertices[ground.faces].mean(axis=1)
    here, out = ground.site_position[ground.corner_site], ground.site_normal[ground.corner_site]
    depth = ((first[:, None] - here) * normal[:, None]).sum(axis=2).ravel()
    over = ((middle[:, None] - here) * out).sum(axis=2).ravel()
    rise = np.zeros((2, len(ground.site_position)))
    np.maximum.at(rise[0], corner, np.minimum(depth + _CLEAR_M, 0.5))
    np.maximum.at(rise[1], corner, np.minimum(over, 1.0))
    lift = rise[0] + _FOLD * rise[1]
    return replace(ground, site_position=ground.site_position + lift[:, None] * ground.site_normal)


class _Strips:
    """The long regions that follow the shore."""

    def __init__(self, shop: CoastWorkshop) -> None:
        self.shop = shop
        coast = self.coast = shop.coast
        self.s = far_stations(coast)
        self.foot = -1.1 / coast.foreshore / (1 + 2.2 * coast.cliff(self.s))
        self.edge = shapely.box(-FAR_M, -FAR_M, FAR_M, FAR_M)

    def line(self, q: np.ndarray) -> np.ndarray:
        """Plan of a line of given offsets."""
        return self.coast.plan(self.s, q)

    def land(self, rng: np.random.Generator) -> list[Region]:
        """Everything inland of the foot of the beach: heath, painted over by all others."""
        inland = self.coast.frame.world(np.array([[self.s[-1], 3 * FAR_M], [self.s[0], 3 * FAR_M]]))
        outline = shapely.Polygon(np.concatenate([self.line(self.foot), inland])).intersection(self.edge)
        skin = self.shop.palette.pick("grass_dry", rng)
        return [Region(outline, skin, int(Semantic.GRASS), self.shop.builder.new_objects())]

    def between(self, low: np.ndarray, high: np.ndarray, where: np.ndarray) -> list[shapely.Polygon]:
        """Strip between two lines, one polygon per run of stations."""
        a, b = self.line(low), self.line(high)
        cuts = np.flatnonzero(np.diff(np.concatenate([[False], where, [False]]).astype(int)))
        rings = [np.concatenate([a[i:j], b[i:j][::-1]]) for i, j in cuts.reshape(-1, 2) if j - i > 1]
        if not rings:
            return []
        clipped = shapely.intersection(shapely.polygons([shapely.linearrings(r) for r in rings]), self.edge)
        parts = shapely.get_parts(clipped)
        return [p for p in parts if p.geom_type == "Polygon" and p.area > 1.0]

    def shore(self, rock: str, sea_K: float, rng: np.random.Generator) -> list[Region]:
        """Beach, dunes and cliffs, seaward ones last."""
        coast, s, pick = self.coast, self.s, self.shop.palette.pick
        wet, beach, brow, back = (c(s) for c in (coast.wet, coast.beach, coast.brow, coast.back))
        rocky = np.clip((coast.cliff(s) - 0.06) / 0.6, 0.0, 1.0)  # headlands taper out on the sand
        core = beach + (0.35 + 0.25 * np.sin(s / 5.3)) * (brow - beach)
        top, base = core + rocky * (brow - core), core + rocky**0.7 * (self.foot - core)
        near = np.abs(s) < 1.5 * coast.half_m  # a thin strip far away would only cost triangles
        middle = beach + np.clip(0.45 + 0.2 * np.sin(s / 17.0) + 0.12 * np.sin(s / 6.1), 0.2, 0.8) * (
            back - beach
        )
        sand, stone = pick("sand_dry_quartz", rng), pick(rock, rng)
        wet_sand = self.shop.palette.variants("sand_wet", 2)[0]
        bend = np.arange(-1.5 * coast.half_m, 1.5 * coast.half_m, 2.0)
        smooth = gaussian_filter1d(coast.shore(bend) + coast.brow(bend), 9.0) + 6.5 + np.sin(bend / 21.0)
        trail = np.maximum(np.interp(s, bend, smooth) - coast.shore(s), brow + 2.5)
        bare = brow + (rocky == 1.0) * (1.6 + np.sin(s / 9.0) + 0.6 * np.sin(s / 3.7)) + 0.05
        sandy, under = coast.cliff(s) < 0.15, np.full(len(s), -0.1 / coast.foreshore)
        # What lies below the water is never seen: it has the water's temperature, so that none of it shows at the edge.
        bed = self.shop.palette.special("sand_wet", "bed", prescribed_K=sea_K)
        wide = np.maximum(middle, self.foot + 30.0)
        table = (
            (self.foot, wide, ~near, sand, Semantic.SAND),
            (self.foot, np.maximum(brow, self.foot + 25.0), ~near & (rocky > 0.5), stone, Semantic.ROCK),
            (self.foot, middle, near, sand, Semantic.SAND),
            (self.foot, wet, near, wet_sand, Semantic.SAND),
            (self.foot, under, sandy & near, bed, Semantic.SAND),
            (brow, bare, (rocky > 0.8) & near, pick("soil_dry", rng), Semantic.SOIL),
            (base, top, (rocky > 0.0) & near, stone, Semantic.ROCK),
            (trail, trail + 1.1, (rocky > 0.7) & near, pick("soil_dry", rng), Semantic.SOIL),
        )
        regions = []
        for low, high, where, skin, semantic in table:
            owner = self.shop.builder.new_objects()
            regions += [Region(p, skin, int(semantic), owner) for p in self.between(low, high, where)]
            if semantic is Semantic.SAND and high is middle:
                regions += self._patches(beach, middle, back, sand, rng)
        return regions

    def _patches(
        self, beach: np.ndarray, middle: np.ndarray, back: np.ndarray, sand: int, rng: np.random.Generator
    ) -> list[Region]:
        """Marram on the seaward dunes, blow-outs on the landward ones."""
        coast, shop = self.coast, self.shop
        grass, owner = shop.palette.pick("grass_dry", rng), shop.builder.new_objects(2)
        count = int(2.8 * coast.half_m / 4.0)
        s = rng.uniform(-1.4, 1.4, count) * coast.half_m
        share, size = rng.uniform(0.0, 1.0, count), rng.uniform(1.3, 4.2, count)
        low, mid, high = (np.interp(s, self.s, v) for v in (beach, middle, back))
        seaward = rng.uniform(size=count) < 0.6
        q = np.where(seaward, low + 2.0 + share * (mid - low), mid + 2.0 + share * (high - mid - 4.0))
        xy = coast.plan(s, q)
        good = (high - low > 25.0) & coast.inside(xy, 0.0)
        blobs = _blobs(xy[good], size[good], rng)
        keep = first_come(blobs)
        kind = seaward[good][keep].astype(int).tolist()
        labels = ((sand, Semantic.SAND, owner + 1), (grass, Semantic.GRASS, owner))
        return [
            Region(b, labels[k][0], int(labels[k][1]), labels[k][2])
            for b, k in zip(blobs[keep], kind, strict=True)
        ]


def _blobs(centre: np.ndarray, radius: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Irregular round patches."""
    angle = np.linspace(0.0, 2 * np.pi, 11, endpoint=False)
    reach = radius[:, None] * rng.uniform(0.65, 1.35, (len(centre), len(angle)))
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=-1)[None] * reach[..., None] + centre[:, None]
    return np.asarray(shapely.polygons(ring))


def _fields(layout: Layout, shop: CoastWorkshop, rng: np.random.Generator) -> list[Region]:
    """Fields and meadows behind the road, larger with distance."""
    coast, count = shop.coast, 110
    reach = np.concatenate(
        [rng.uniform(45.0, 420.0, 30), 420.0 + 7000.0 * rng.uniform(0.0, 1.0, count - 30) ** 1.6]
    )
    s = rng.uniform(-1.0, 1.0, count) * (1.2 * coast.half_m + 0.9 * reach)
    size = np.clip(0.16 * reach + rng.uniform(26.0, 60.0, count), 30.0, 600.0)
    centre = coast.frame.world(np.column_stack([s, coast.road(s) + reach]))
    turn = coast.frame.heading_rad + 0.5 * np.sin(s / 900.0) + rng.normal(0.0, 0.05, count)
    shapes = rectangles(centre, size, size * rng.uniform(0.45, 0.9, count), turn)
    held = np.array([layout.road.buffer(ROAD_HALF_M + 14.0), layout.car_park.buffer(12.0)], dtype=object)
    keep = clear_of(shapes, held) & first_come(shapes) & (np.abs(centre).max(axis=1) < FAR_M - 700.0)
    fields = shop.builder.new_objects(count)
    regions = []
    for k in np.flatnonzero(keep):
        name = _COVERS[int(rng.integers(len(_COVERS)))]
        semantic = Semantic.SOIL if name.startswith("soil") else Semantic.GRASS
        regions.append(Region(shapes[k], shop.palette.pick(name, rng), int(semantic), fields + int(k)))
    return regions


def _heath(layout: Layout, shop: CoastWorkshop, rng: np.random.Generator) -> list[Region]:
    """Patches of thicker, drier or trodden growth on the open land."""
    coast, count = shop.coast, 420
    s = rng.uniform(-1.4, 1.4, count) * coast.half_m
    q = coast.back(s) + 9.0 + rng.uniform(0.0, 1.0, count) ** 1.4 * 1.3 * coast.half_m
    size = rng.uniform(1.5, 6.0, count) + rng.uniform(0.0, 1.0, count) ** 3 * 9.0
    xy = coast.plan(s, q)
    blobs = _blobs(xy, size, rng)
    held = [layout.road.buffer(ROAD_HALF_M + 1.0), layout.car_park.buffer(1.0), layout.drive.buffer(2.0)]
    keep = coast.inside(xy, 4.0) & clear_of(blobs, np.array(held, dtype=object)) & first_come(blobs)
    owner = shop.builder.new_objects(count)
    regions = []
    for k in np.flatnonzero(keep):
        name = ("grass_dry", "grass_watered", "grass_dry", "soil_dry")[int(rng.integers(4))]
        semantic = Semantic.SOIL if name == "soil_dry" else Semantic.GRASS
        regions.append(Region(blobs[k], shop.palette.pick(name, rng), int(semantic), owner + int(k)))
    return regions


def _roads(layout: Layout, shop: CoastWorkshop, rng: np.random.Generator) -> list[Region]:
    """Track, paths, car park, carriageway and its paint."""
    first = shop.builder.new_objects(6)
    gravel, paved = shop.palette.pick("soil_dry", rng), shop.palette.pick("concrete_pavement", rng)
    asphalt = shop.palette.pick("asphalt_aged", rng)
    paint = shop.palette.special("asphalt_aged", "paint", solar_absorptance=0.55)
    yard = shapely.Point(layout.lighthouse[:2]).buffer(LIGHTHOUSE_YARD_M - 0.8, quad_segs=5)
    walk, road = int(Semantic.SIDEWALK), int(Semantic.ROAD)
    entry = layout.car_park.union(_gateway(layout)).buffer(0.0)
    regions = [
        Region(layout.drive.buffer(1.5, cap_style="flat", quad_segs=2), gravel, int(Semantic.SOIL), first),
        Region(yard, paved, walk, first + 1),
        Region(layout.path.buffer(0.9, cap_style="flat"), paved, walk, first + 2),
        Region(entry, asphalt, road, first + 3),
    ]
    edge = shapely.box(-_ROAD_END_M, -_ROAD_END_M, _ROAD_END_M, _ROAD_END_M)
    strip = layout.road.buffer(ROAD_HALF_M, cap_style="flat", quad_segs=2).intersection(edge)
    regions += [Region(p, asphalt, road, first + 4) for p in shapely.get_parts(strip)]
    dashes = _dashes(layout, shop)
    return regions + [Region(d, paint, int(Semantic.ROAD_MARKING), first + 5, lumped=True) for d in dashes]


def _gateway(layout: Layout) -> shapely.Polygon:
    """The drive from the road into the car park."""
    middle = shapely.get_coordinates(layout.car_park.centroid)[0]
    nearest = shapely.get_coordinates(layout.road.interpolate(layout.road.project(layout.car_park.centroid)))[
        0
    ]
    return shapely.LineString([nearest, middle]).buffer(3.4, cap_style="flat")


def _dashes(layout: Layout, shop: CoastWorkshop) -> np.ndarray:
    """The broken line in the middle of the detailed road, and the bays of the car park."""
    line = shapely.get_coordinates(layout.road)
    near = line[np.abs(line).max(axis=1) < shop.coast.half_m + 60.0]
    start = np.arange(4.0, shapely.LineString(near).length - 8.0, 9.0)
    a, _ = along(near, start, np.zeros(len(start)))
    b, _ = along(near, start + 3.0, np.zeros(len(start)))
    rows = [_bars(a, b, 0.14)]
    c, s = np.cos(layout.car_park_heading_rad), np.sin(layout.car_park_heading_rad)
    turn, middle = np.array([[c, s], [-s, c]]), shapely.get_coordinates(layout.car_park.centroid)[0]
    x = np.arange(-20.4, 20.5, 2.72)
    for y0, y1 in ((3.2, 7.9), (-7.9, -3.2)):
        use = x[np.abs(x) > 4.5] if y0 < 0 else x
        rows.append(
            _bars(
                np.column_stack([use, 0 * use + y0]) @ turn + middle,
                np.column_stack([use, 0 * use + y1]) @ turn + middle,
                0.1,
            )
        )
    return np.asarray(shapely.polygons(np.concatenate(rows)))


def _bars(a: np.ndarray, b: np.ndarray, width_m: float) -> np.ndarray:
    step = (b - a) / np.linalg.norm(b - a, axis=1)[:, None]
    side = np.column_stack([step[:, 1], -step[:, 0]]) * width_m / 2
    return np.stack([a + side, b + side, b - side, a - side], axis=1)


def _breakwater(layout: Layout, rock: str, shop: CoastWorkshop, rng: np.random.Generator) -> list[Region]:
    """Core of rock down to below the water, and a paved crown."""
    mound, first = layout.mound, shop.builder.new_objects(2)
    core = mound.line.buffer(mound.half_m + (mound.crown_m + 1.6) / mound.slope, quad_segs=4)
    crown = mound.line.buffer(mound.half_m - 0.2, quad_segs=3)
    concrete = shop.palette.pick("concrete_pavement", rng)
    return [
        Region(core.simplify(0.2), shop.palette.pick(rock, rng), int(Semantic.BARRIER), first),
        Region(crown.simplify(0.05), concrete, int(Semantic.BARRIER), first + 1),
    ]


def _points(
    strips: _Strips, holes: Sequence[shapely.Polygon], stones: np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    """Fine near the shore and the road, finer on faces of cliffs, coarse on open land and beyond."""
    coast = strips.coast

    def zone(xy: np.ndarray) -> np.ndarray:
        sq = coast.offset(xy)
        road = coast.road(sq[:, 0]) - coast.shore(sq[:, 0]) + 26.0
        return np.asarray((sq[:, 1] > np.interp(sq[:, 0], strips.s, strips.foot)) & (sq[:, 1] < road))

    def steep(xy: np.ndarray) -> np.ndarray:
        sq = coast.offset(xy)
        on_face = (sq[:, 1] > coast.beach(sq[:, 0]) - 1.0) & (sq[:, 1] < coast.brow(sq[:, 0]) + 1.0)
        return on_face & (coast.cliff_m(sq[:, 0]) > 4.0)

    nominal = hexagonal(*coast.core(), 2.0 * _FINE_M, rng)
    grain = max(float(np.sqrt(4.0 * zone(nominal).sum() / _FINE_POINTS)), 1.0)
    fine, face = (hexagonal(*coast.core(), grain * spacing, rng) for spacing in (_FINE_M, _FACE_M))
    far = graded_points(shapely.box(*coast.core()), FAR_M, grain * _OPEN_M, rng)
    square = np.abs(far).max(axis=1) < coast.half_m
    sq_far = coast.offset(far)
    dry = sq_far[:, 1] > np.interp(sq_far[:, 0], strips.s, strips.foot)
    large = [s for s in stones if s.area > 3.0]
    rows = [contact_points(list(holes), _CONTACT_M, 0.9), *(contact_points(large, s, d) for s, d in _AROUND)]
    fine = fine[zone(fine) & ~steep(fine)]
    points = np.concatenate([*rows, face[steep(face)], fine, far[dry & ~(square & zone(far))]])
    hidden = shapely.STRtree(stones).query(shapely.points(points), predicate="within")[0]
    return np.asarray(np.delete(points, np.unique(hidden), axis=0))
