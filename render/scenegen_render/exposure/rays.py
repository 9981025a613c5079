"""Where the rays of the sites start, on the device, in an order that keeps neighbours together."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Int64

from scenegen.world import Sites
from scenegen_render import backend
from scenegen_render.exposure.order import spatial_order

_LIFT_M = 2e-3
"""Origins are lifted along the normal, well above the rounding of float32 coordinates at 1 km (0.06 mm)."""


@dataclass(frozen=True, eq=False)
class SiteRays:
    """Ray origins of all sites in spatial order.

    Attributes
    ----------
    order : int64 (sites,)
        Site at each place of the order.
    site : mitsuba.UInt
        The same, on the device.
    origin, normal : mitsuba.Float, 3 per site
        Lifted position [m] and unit normal, packed.
    standoff : mitsuba.Float
        [m] along the ray.
    """

    order: Int64[np.ndarray, "sites"]
    site: Any
    origin: Any
    normal: Any
    standoff: Any

    @staticmethod
    def of(sites: Sites) -> SiteRays:
        """Sort the sites and put their ray origins on the device."""
        mi, _ = backend.modules()
        order = spatial_order(sites.position)
        normal = sites.normal[order]
        origin = sites.position[order] + np.float32(_LIFT_M) * normal
        return SiteRays(
            order=order,
            site=mi.UInt(order.astype(np.uint32)),
            origin=mi.Float(origin.reshape(-1)),
            normal=mi.Float(normal.reshape(-1)),
            standoff=mi.Float(sites.standoff[order]),
        )

    def start(self, place: Any, direction: Any, active: Any) -> Any:
        """Rays from places of the order.

        Parameters
        ----------
        place : mitsuba.UInt
        direction : mitsuba.Vector3f
        active : mitsuba.Bool
        """
        mi, dr = backend.modules()
        origin = dr.gather(mi.Point3f, self.origin, place, active)
        return mi.Ray3f(origin + direction * dr.gather(mi.Float, self.standoff, place, active), direction)
