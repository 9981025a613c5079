"""First contact of swept spheres with everything in a world: what stands, and what moves meanwhile."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from scenegen.movers.company import Company
from scenegen.world import World
from scenegen_flythrough.clearance import MeshProximity
from scenegen_flythrough.loop.moving_contact import MovingContact


@dataclass(frozen=True, eq=False)
class Contacts:
    """What spheres swept along segments touch first.

    Attributes
    ----------
    share : float64 (n,)
        Share 0..1 of the segment until contact; +inf where nothing is touched.
    object, semantic : int64 (n,)
        Instance id and class of what is touched; 0 where nothing is.
    """

    share: Float64[np.ndarray, "n"]
    object: Int64[np.ndarray, "n"]
    semantic: Int64[np.ndarray, "n"]


class Obstacles:
    """Everything in a world that a drone can touch. Built once per world; asking changes nothing.

    Parameters
    ----------
    world : World
    proximity : MeshProximity, optional
        Of the world's mesh, if it is at hand (`Airspace.proximity`).
    """

    def __init__(self, world: World, proximity: MeshProximity | None = None) -> None:
        self.world = world
        self.proximity = MeshProximity(world.mesh) if proximity is None else proximity
        self.company = Company.of(world.movers)
        self._moving = MovingContact(self.company)

    def first_contacts(
        self,
        starts: Float64[np.ndarray, "n 3"],
        ends: Float64[np.ndarray, "n 3"],
        t0_s: float,
        t1_s: float,
        radius_m: float,
    ) -> Contacts:
        """Move spheres along segments, each evenly from `t0_s` to `t1_s` of world time.

        Nothing is missed, whatever the speed. Against the mesh contact is exact to the last digits of float64; against
        movers it comes at most `moving_contact.TOLERANCE_M` too early. Where both are touched the earlier counts.
        """
        share = self.proximity.first_contact(starts, ends, radius_m)
        met = np.isfinite(share)
        object_, semantic = np.zeros((2, len(starts)), np.int64)
        if met.any():
            face = self._face_at(starts[met], ends[met], share[met], radius_m)
            object_[met] = self.world.face_object[face]
            semantic[met] = self.world.face_semantic[face]
        moving, mover = self._moving.first(starts, ends, t0_s, t1_s, radius_m)
        sooner = moving < share
        share[sooner] = moving[sooner]
        body = self.company.movers
        object_[sooner] = [body[m].object for m in mover[sooner]]
        semantic[sooner] = [int(body[m].body.semantic[0]) for m in mover[sooner]]
        return Contacts(share, object_, semantic)

    def distance(
        self, points: Float64[np.ndarray, "n 3"], time_s: float, limit_m: float
    ) -> Float64[np.ndarray, "n"]:
        """Distance [m] of points to anything at one world time; +inf beyond the limit."""
        standing = self.proximity.distance(points, limit_m)
        return np.asarray(np.minimum(standing, self._moving.distance(points, time_s, limit_m)))

    def movers_apart(self, points: Float64[np.ndarray, "n 3"], time_s: float) -> Float64[np.ndarray, "n"]:
        """Least distance [m] of points to the spheres around the movers at one world time; +inf without movers."""
        return self._moving.spheres_apart(points, time_s)

    def _face_at(
        self,
        starts: Float64[np.ndarray, "hits 3"],
        ends: Float64[np.ndarray, "hits 3"],
        share: Float64[np.ndarray, "hits"],
        radius_m: float,
    ) -> Int64[np.ndarray, "hits"]:
        """The face nearest to the place of contact."""
        place = starts + share[:, None] * (ends - starts)
        # A little more than the radius: the place is rounded towards the start.
        slack = 1e-5 * np.linalg.norm(ends - starts, axis=1).max(initial=0.0) + 1e-6
        return self.proximity.sweep(place, place, radius_m + float(slack)).face
