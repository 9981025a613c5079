"""The sea as a mesh: fine waves near the coast, coarser ones towards the horizon, running a little under the beach."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from scenegen.classes import Semantic
from scenegen.climate.sea import FREEZING_K
from scenegen.geometry.part import LUMP_STANDOFF_M, Part
from scenegen.geometry.patch import quads_to_triangles
from scenegen.maps.coastline.knobs import CoastlineKnobs
from scenegen.maps.coastline.relief import CoastRelief
from scenegen.maps.coastline.sea_lattice import cell_size_m, level_seams, sea_lattice
from scenegen.maps.coastline.waves import Waves, draw_waves
from scenegen.maps.coastline.workshop import CoastWorkshop

_FAR_SWELL_M = 1.6
_SCATTER = np.array([[1.37, 0.91], [-0.83, 1.59], [1.91, -1.13]])
_UNDER_BEACH_M = 0.4
_BREAKING = 0.6
"""Waves are no higher than this share of the depth (McCowan's 0.78, less for random seas)."""


@dataclass(frozen=True, eq=False)
class Sea:
    """The water of one world.

    Attributes
    ----------
    waves : Waves
    relief : CoastRelief
        Decides the depth.
    temperature_K : float
    slope : float
        Standard deviation of the slope of the surface along one direction.
    """

    waves: Waves
    relief: CoastRelief
    temperature_K: float
    slope: float

    def height(
        self, xy: Float64[np.ndarray, "points 2"], cell_m: Float64[np.ndarray, "points"]
    ) -> Float64[np.ndarray, "points"]:
        """Height of the surface [m], waves lower where the water is shallow."""
        return self.surface(xy, cell_m, self.relief(xy))

    def surface(
        self,
        xy: Float64[np.ndarray, "points 2"],
        cell_m: Float64[np.ndarray, "points"],
        ground_m: Float64[np.ndarray, "points"],
    ) -> Float64[np.ndarray, "points"]:
        """The same where the height of the ground [m] is known already."""
        depth = np.maximum(-ground_m, 0.0)
        share = np.minimum(_BREAKING * depth / max(self.waves.significant_m, 0.05), 1.0)
        return np.asarray(share * self.waves.elevation(xy, cell_m))

    def swelling(
        self, xy: Float64[np.ndarray, "points 2"], cell_m: Float64[np.ndarray, "points"]
    ) -> Float64[np.ndarray, "points"]:
        """Rise and fall [m] that gives far, large cells some of the slope of the waves they cannot carry.

        Without it the far sea would be a perfect mirror of the horizon, and no horizon could be seen. It grows with
        the distance and is never higher than a ship could tell.
        """
        beyond = np.maximum(np.abs(xy).max(axis=1) - self.relief.coast.half_m, 0.0)
        most = 0.25 * self.waves.significant_m + _FAR_SWELL_M * (1.0 - np.exp(-beyond / 3000.0))
        most = most * np.minimum(beyond / 100.0, 1.0)
        # Far shorter than any cell: no two vertices agree.
        scatter = np.sin(xy @ _SCATTER.T).sum(axis=1) / np.sqrt(1.5)
        return np.asarray(np.minimum(self.slope * cell_m / np.sqrt(2.0), most) * scatter)


def draw_sea(relief: CoastRelief, knobs: CoastlineKnobs, shop_K: float, rng: np.random.Generator) -> Sea:
    """Draw wind, swell and the water's departure from the climatology `shop_K` [K]."""
    own, phases = rng.spawn(2)
    towards = relief.coast.frame.heading_rad + 0.5 * np.pi + own.uniform(-0.9, 0.9)
    wind, fetch = own.uniform(*knobs.wind_mps), 1e3 * own.uniform(*knobs.fetch_km)
    waves = draw_waves(wind, fetch, own.uniform(*knobs.swell_m), towards, phases)
    warm = shop_K + 1.2 * float(np.clip(own.standard_normal(), -2.0, 2.0))
    # Cox and Munk 1954, half of the mean square slope along either axis.
    slope = float(np.sqrt(0.5 * (0.003 + 0.00512 * wind)))
    return Sea(waves, relief, max(warm, FREEZING_K), slope)


def build_sea(sea: Sea, shop: CoastWorkshop) -> Part:
    """Mesh of all water that is not under land."""
    points, quads, block = sea_lattice(shop.coast.half_m)
    cell = cell_size_m(points, shop.coast.half_m)
    ground = shop.relief(points)
    keep = (ground[quads] < _UNDER_BEACH_M).any(axis=1)
    used, index = np.unique(quads[keep], return_inverse=True)
    xy = points[used]
    height = sea.surface(xy, cell[used], ground[used]) + sea.swelling(xy, cell[used])
    height = level_seams(xy, height, shop.coast.half_m)
    _, site = np.unique(block[keep], return_inverse=True)
    return _part(np.column_stack([xy, height]), index.reshape(-1, 4), site, int(site.max()) + 1, sea, shop)


def _part(
    vertices: np.ndarray, quads: np.ndarray, site: np.ndarray, sites: int, sea: Sea, shop: CoastWorkshop
) -> Part:
    """Water has a known temperature: one site for a whole block of cells, above its crests."""
    skin = shop.palette.special("water_fresh_or_sea", "sea", prescribed_K=sea.temperature_K)
    middle = vertices[quads].mean(axis=1)
    weight = np.bincount(site, minlength=sites)
    position = np.stack([np.bincount(site, middle[:, k], sites) / weight for k in range(3)], axis=1)
    np.maximum.at(position[:, 2], site, vertices[quads, 2].max(axis=1))
    position[:, 2] += LUMP_STANDOFF_M
    faces = quads_to_triangles(quads)
    return Part(
        vertices=vertices,
        faces=faces,
        surface=np.full(len(faces), skin),
        semantic=np.full(len(faces), int(Semantic.WATER)),
        object=np.full(len(faces), shop.builder.new_objects()),
        corner_site=np.repeat(np.repeat(site, 2)[:, None], 3, axis=1),
        site_position=position,
        site_normal=np.tile([0.0, 0.0, 1.0], (sites, 1)),
        site_standoff=np.full(sites, LUMP_STANDOFF_M),
    )
