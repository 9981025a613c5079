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
from scenegen.maps.coastline.shape import FAR_M
from scenegen.maps.coastline.waves import Waves, draw_waves
from scenegen.maps.coastline.workshop import CoastWorkshop

_CELLS = 110_000
"""Fine cells of the detailed sea, about: their size follows."""
_GROWTH = 1.16
_SITE_CELLS = 20
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
    """

    waves: Waves
    relief: CoastRelief
    temperature_K: float

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


def draw_sea(relief: CoastRelief, knobs: CoastlineKnobs, shop_K: float, rng: np.random.Generator) -> Sea:
    """Draw wind, swell and the water's departure from the climatology `shop_K` [K]."""
    own, phases = rng.spawn(2)
    towards = relief.coast.frame.heading_rad + 0.5 * np.pi + own.uniform(-0.9, 0.9)
    wind, fetch = own.uniform(*knobs.wind_mps), 1e3 * own.uniform(*knobs.fetch_km)
    waves = draw_waves(wind, fetch, own.uniform(*knobs.swell_m), towards, phases)
    warm = shop_K + 1.2 * float(np.clip(own.standard_normal(), -2.0, 2.0))
    return Sea(waves, relief, max(warm, FREEZING_K))


def build_sea(sea: Sea, shop: CoastWorkshop) -> Part:
    """Mesh of all water that is not under land."""
    axis = _axis(shop.coast.half_m)
    count, step = len(axis), np.gradient(axis)
    x, y = (g.ravel() for g in np.meshgrid(axis, axis))
    cell = np.maximum(*(g.ravel() for g in np.meshgrid(step, step)))
    points = np.column_stack([x, y])
    ground = shop.relief(points)
    i, j = (g.ravel() for g in np.meshgrid(np.arange(count - 1), np.arange(count - 1)))
    quads = (j * count + i)[:, None] + np.array([0, 1, count + 1, count])
    keep = (ground[quads] < _UNDER_BEACH_M).any(axis=1)
    quads, i, j = quads[keep], i[keep], j[keep]
    used, index = np.unique(quads, return_inverse=True)
    xy = points[used]
    vertices = np.column_stack([xy, sea.surface(xy, cell[used], ground[used])])
    quads = index.reshape(-1, 4)
    block, site = np.unique((j // _SITE_CELLS) * count + i // _SITE_CELLS, return_inverse=True)
    return _part(vertices, quads, site, len(block), sea, shop)


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


def _axis(half_m: float) -> np.ndarray:
    """Grid lines: even over the detailed square, then ever wider to the horizon."""
    step = 2 * half_m / np.sqrt(2.0 * _CELLS)
    count = int(2 * half_m / step)
    inner = np.linspace(-half_m, half_m, count + 1)
    tail, width = [], 2 * half_m / count
    at = half_m
    while at < FAR_M:
        width *= _GROWTH
        at = min(at + width, FAR_M) if at + 1.5 * width < FAR_M else FAR_M
        tail.append(at)
    return np.concatenate([-np.array(tail)[::-1], inner, tail])
