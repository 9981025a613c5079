"""The shape of a world without its heat: all that depth needs, and all a pilot who is given the truth may know."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from scenegen.movers.company import Company
from scenegen_render import backend
from scenegen_render.scene import LoadedWorld
from scenegen_render.trace.troupe import Instant, Troupe


@dataclass(frozen=True, eq=False)
class Scenery:
    """A loaded world and its movers.

    Attributes
    ----------
    loaded : LoadedWorld
    troupe : Troupe
        The movers that appear.
    first_moving : mitsuba.UInt
        Index of the movers' first face in tables that number them on from the world's.
    """

    loaded: LoadedWorld
    troupe: Troupe
    first_moving: Any


def scenery(loaded: LoadedWorld, cast: Sequence[int] | None = None) -> Scenery:
    """Set a world up for views of its shape: no exposure, no thermal state.

    Parameters
    ----------
    loaded : LoadedWorld
    cast : sequence of int, optional
        Movers that appear; by default all, of which `Views` picks at every instant those that somebody sees.
    """
    mi, dr = backend.modules()
    movers = loaded.world.movers
    company = Company.of([movers[k] for k in (range(len(movers)) if cast is None else cast)])
    return Scenery(loaded, Troupe(company), dr.opaque(mi.UInt, len(loaded.world.face_object)))


def met(scenery: Scenery, now: Instant, origin: Any, direction: Any, near: Any) -> tuple[Any, Any]:
    """Face that each ray meets first, of the world or of a mover, and whether it meets any.

    Parameters
    ----------
    near : mitsuba.Bool
        Rays that can meet a mover; the others do not try.
    """
    mi, dr = backend.modules()
    world = scenery.loaded.scene.ray_intersect_preliminary(mi.Ray3f(origin, direction), coherent=True)

    def among_movers(origin: Any, direction: Any, t: Any, face: Any, met: Any) -> tuple[Any, Any]:
        ray = mi.Ray3f(origin, direction)
        ray.maxt = t
        mover = now.scene.ray_intersect_preliminary(ray, coherent=True)
        nearer = mover.is_valid()
        return dr.select(nearer, mover.prim_index + scenery.first_moving, face), nearer | met

    face, valid = dr.if_stmt(
        args=(origin, direction, world.t, world.prim_index, world.is_valid()),
        cond=near,
        true_fn=among_movers,
        false_fn=lambda origin, direction, t, face, met: (face, met),
        label="movers",
    )
    return face, valid
