"""The long regions that follow the shore: wet and dry sand, rock, bare brow, the cliff path; patches on dunes."""

from __future__ import annotations

import numpy as np
import shapely
from jaxtyping import Bool, Float64
from scipy.ndimage import gaussian_filter1d

from scenegen.classes import Semantic
from scenegen.geometry.ground import Region
from scenegen.geometry.placement import first_come
from scenegen.maps.coastline.layout import far_stations
from scenegen.maps.coastline.shape import FAR_M
from scenegen.maps.coastline.workshop import CoastWorkshop


class Strips:
    """The long regions that follow the shore.

    Attributes
    ----------
    shop : CoastWorkshop
    coast : Coast
    s : float64 (stations,)
        Distances along the shore, close together in the detailed square.
    foot : float64 (stations,)
        Offset of the line below the water where solid ground ends [m].
    """

    def __init__(self, shop: CoastWorkshop) -> None:
        self.shop = shop
        coast = self.coast = shop.coast
        self.s = far_stations(coast)
        self.foot = -1.1 / coast.foreshore / (1 + 2.2 * coast.cliff(self.s))
        self.edge = shapely.box(-FAR_M, -FAR_M, FAR_M, FAR_M)

    def line(self, q: Float64[np.ndarray, "stations"]) -> Float64[np.ndarray, "stations 2"]:
        """Plan of a line of given offsets [m]."""
        return self.coast.plan(self.s, q)

    def land(self, rng: np.random.Generator) -> list[Region]:
        """Everything inland of the foot of the beach: heath, painted over by all others."""
        inland = self.coast.frame.world(np.array([[self.s[-1], 3 * FAR_M], [self.s[0], 3 * FAR_M]]))
        outline = shapely.Polygon(np.concatenate([self.line(self.foot), inland])).intersection(self.edge)
        skin = self.shop.palette.pick("grass_dry", rng)
        return [Region(outline, skin, int(Semantic.GRASS), self.shop.builder.new_objects())]

    def between(
        self,
        low: Float64[np.ndarray, "stations"],
        high: Float64[np.ndarray, "stations"],
        where: Bool[np.ndarray, "stations"],
    ) -> list[shapely.Polygon]:
        """Strip between two lines of given offsets [m], one polygon per run of stations."""
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
        spots = blobs(xy[good], size[good], rng)
        keep = first_come(spots)
        kind = seaward[good][keep].astype(int).tolist()
        labels = ((sand, Semantic.SAND, owner + 1), (grass, Semantic.GRASS, owner))
        return [
            Region(b, labels[k][0], int(labels[k][1]), labels[k][2])
            for b, k in zip(spots[keep], kind, strict=True)
        ]


def blobs(
    centre: Float64[np.ndarray, "patches 2"], radius: Float64[np.ndarray, "patches"], rng: np.random.Generator
) -> np.ndarray:
    """Irregular round patches of about given radii [m], as an array of polygons."""
    angle = np.linspace(0.0, 2 * np.pi, 11, endpoint=False)
    reach = radius[:, None] * rng.uniform(0.65, 1.35, (len(centre), len(angle)))
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=-1)[None] * reach[..., None] + centre[:, None]
    return np.asarray(shapely.polygons(ring))
