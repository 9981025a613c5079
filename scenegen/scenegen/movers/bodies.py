"""Vehicles and boats in their rest pose, taken from the shared parts: bodies at the origin, facing +x."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from scenegen.geometry.part import Part, concatenate
from scenegen.parts.boats.moor import moor
from scenegen.parts.vehicles.park import park
from scenegen.parts.workshop import Workshop


def vehicles(kinds: Sequence[str], shop: Workshop, rng: np.random.Generator) -> list[Part]:
    """Driven vehicles of given kinds, in order: warm bonnets, tyres, exhausts."""
    made: dict[str, list[Part]] = {}
    for kind in dict.fromkeys(kinds):
        origin = np.zeros((kinds.count(kind), 3))
        made[kind] = apart(park(kind, origin, origin[:, 0], origin[:, :2], shop, rng, driven=True))
    return [made[kind].pop() for kind in kinds]


def boats(kinds: Sequence[str], running: bool, shop: Workshop, rng: np.random.Generator) -> list[Part]:
    """Boats of given kinds, in order, their engines running or not; the origin lies on the water."""
    made: dict[str, list[Part]] = {}
    for kind in dict.fromkeys(kinds):
        origin = np.zeros((kinds.count(kind), 3))
        made[kind] = apart(moor(kind, origin, origin[:, 0], shop, rng, running))
    return [made[kind].pop() for kind in kinds]


def apart(parts: Sequence[Part]) -> list[Part]:
    """One part for each object, by increasing id; objects share no vertices and no sites."""
    if not parts:
        return []
    all_ = concatenate(parts)
    single = []
    for owner in np.unique(all_.object):
        mine = np.flatnonzero(all_.object == owner)
        vertex, faces = np.unique(all_.faces[mine], return_inverse=True)
        site, corner_site = np.unique(all_.corner_site[mine], return_inverse=True)
        single.append(
            Part(
                vertices=all_.vertices[vertex],
                faces=faces.reshape(-1, 3),
                surface=all_.surface[mine],
                semantic=all_.semantic[mine],
                object=all_.object[mine],
                corner_site=corner_site.reshape(-1, 3),
                site_position=all_.site_position[site],
                site_normal=all_.site_normal[site],
                site_standoff=all_.site_standoff[site],
            )
        )
    return single
