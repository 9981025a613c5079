"""How fine the ground of a built-up place is: beside walls and cars, along kerbs, on streets, and elsewhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from jaxtyping import Float64

from scenegen.classes import Semantic
from scenegen.geometry.ground import Region
from scenegen.geometry.scatter import contact_points, finer_near


@dataclass(frozen=True)
class Fineness:
    """Spacings of the mesh and of the thermal sites of a ground plan, all in metres.

    Attributes
    ----------
    lattice_m : (float, float)
        Spacing of free points near walls and cars, and elsewhere.
    near_m : float
        How far "near" is.
    wall_row_m : (float, float)
        Spacing and distance of the row of points along walls; the spacing is that of the contact line, too.
    line_m, car_line_m : float
        Spacing along lines of paving and kerbs, and around what has a site of its own below it.
    road_grain_m, grain_m : float
        Cells that have one site at most: on streets finer, for what lies between cars and kerbs, and elsewhere.
    leap : float
        How much coarser the first band around the place is than the lattice inside.
    """

    lattice_m: tuple[float, float]
    near_m: float
    wall_row_m: tuple[float, float]
    line_m: float
    car_line_m: float
    road_grain_m: float
    grain_m: float
    leap: float = 2.0

    def grained(self, regions: Sequence[Region]) -> list[Region]:
        """The same regions, each with the cells its sites are merged in."""
        return [
            replace(r, grain_m=self.road_grain_m if r.semantic == int(Semantic.ROAD) else self.grain_m)
            for r in regions
        ]

    def line_spacing(self, region: Region) -> float:
        """Largest distance of points along a region's outline [m]."""
        if region.hole:
            return self.wall_row_m[0]
        return self.car_line_m if region.lumped and not region.merge_m else self.line_m

    def lattice(
        self,
        core: shapely.Polygon,
        solid: Sequence[shapely.Polygon],
        shading: Sequence[np.ndarray],
        far_m: float,
        rng: np.random.Generator,
    ) -> Float64[np.ndarray, "points 2"]:
        """Free points: a row along walls, a lattice that is finer near what casts shadows, coarser bands farther out.

        Parameters
        ----------
        core : shapely.Polygon
            The place.
        solid : sequence of shapely.Polygon
            Plans of its buildings.
        shading : sequence of arrays of shapely geometries
            What else casts shadows: cars, fences.
        far_m : float
            Half the side of the square that is covered [m].
        rng : numpy.random.Generator
        """
        near = np.concatenate([np.asarray(solid, dtype=object), *shading])
        free = finer_near(core, near, self.lattice_m, self.near_m, far_m, rng, self.leap)
        return np.concatenate([contact_points(solid, *self.wall_row_m), free])


def ground_below(plans: np.ndarray, regions: Sequence[Region]) -> list[Region]:
    """The ground below each thing, with a site of its own: beside the thing it is another world.

    Parameters
    ----------
    plans : array of shapely.Polygon
    regions : sequence of Region
        Of two that cover a thing's middle, the later one is on top.
    """
    if not len(plans):
        return []
    whole = [r for r in regions if not r.lumped]
    tree = shapely.STRtree(np.array([r.outline for r in whole], dtype=object))
    thing, ground = tree.query(shapely.centroid(plans), predicate="intersects")
    top = np.zeros(len(plans), np.int64)
    np.maximum.at(top, thing, ground)
    return [replace(whole[k], outline=p, lumped=True) for p, k in zip(plans, top.tolist(), strict=True)]
