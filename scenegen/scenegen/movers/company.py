"""A company of movers as arrays: what they are, fixed; where their vertices are, a pure function of time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from scenegen.geometry.part import Part, concatenate
from scenegen.movers.gait import Walkers
from scenegen.movers.mover import Mover
from scenegen.movers.route import TRAVELLED, Timetable, matrices

_NOTHING = np.zeros(0, np.int64)
_NOBODY = Part(
    vertices=np.zeros((0, 3)),
    faces=_NOTHING.reshape(0, 3),
    surface=_NOTHING,
    semantic=_NOTHING,
    object=_NOTHING,
    corner_site=_NOTHING.reshape(0, 3),
    site_position=np.zeros((0, 3)),
    site_normal=np.zeros((0, 3)),
    site_standoff=np.zeros(0),
)


@dataclass(frozen=True, eq=False)
class Company:
    """Some or all movers of a world.

    Attributes
    ----------
    movers : tuple of Mover
    body : Part
        Their rest poses, merged in order, each in its own frame.
    first : int64 (movers + 1,)
        First vertex of each mover, and the number of all.
    owner, site_owner : int64 (vertices,), int64 (sites,)
        Mover of each vertex and of each thermal site.
    site_surface : int64 (sites,)
        Palette index.
    box : float64 (movers, 2, 3)
        Lower and upper corner of each body in its own frame, all phases of its gait included [m].
    timetable : Timetable
    walkers : Walkers
    walking : int64 (gaits,)
        Movers that have a gait.
    """

    movers: tuple[Mover, ...]
    body: Part
    first: Int64[np.ndarray, "ends"]
    owner: Int64[np.ndarray, "vertices"]
    site_owner: Int64[np.ndarray, "sites"]
    site_surface: Int64[np.ndarray, "sites"]
    box: Float64[np.ndarray, "movers 2 3"]
    timetable: Timetable
    walkers: Walkers
    walking: Int64[np.ndarray, "gaits"]

    @staticmethod
    def of(movers: Sequence[Mover]) -> Company:
        """Put movers together."""
        counts = [len(m.body.vertices) for m in movers]
        body = concatenate([_NOBODY, *(m.body for m in movers)])
        surface = np.zeros(len(body.site_position), np.int64)
        surface[body.corner_site.ravel()] = np.repeat(body.surface, 3)
        first = np.cumsum([0, *counts])
        walking = [k for k, m in enumerate(movers) if m.gait is not None]
        return Company(
            movers=tuple(movers),
            body=body,
            first=first.astype(np.int64),
            owner=np.repeat(np.arange(len(movers)), counts),
            site_owner=np.repeat(np.arange(len(movers)), [len(m.body.site_position) for m in movers]),
            site_surface=surface,
            box=np.array([m.box_m for m in movers]).reshape(-1, 2, 3),
            timetable=Timetable.of([m.route for m in movers]),
            walkers=Walkers.of(
                [m.gait for m in movers if m.gait is not None], [int(first[k]) for k in walking]
            ),
            walking=np.array(walking, np.int64),
        )

    @property
    def speed_mps(self) -> Float64[np.ndarray, "movers"]:
        """Mean speed of each over its round."""
        table = self.timetable
        return np.asarray(table.round_m / (table.count * table.step_s))

    def poses(self, time_s: float) -> Float64[np.ndarray, "movers 4 4"]:
        """`world_from_mover` of all at one time."""
        return matrices(self.timetable.at(time_s))

    def poses_over(self, times_s: Float64[np.ndarray, "times"]) -> Float64[np.ndarray, "times movers 4 4"]:
        """The same at several times."""
        return matrices(self.timetable.over(times_s))

    def vertices(self, time_s: float) -> Float64[np.ndarray, "vertices 3"]:
        """World positions of all vertices at one time [m]."""
        state = self.timetable.at(time_s)
        rest = self.body.vertices
        if len(self.walking):
            rest = rest.copy()
            rest[self.walkers.vertex] = self.walkers.step(state[self.walking, TRAVELLED])
        world = np.empty((len(rest), 3))
        for pose, first, last in zip(matrices(state), self.first[:-1], self.first[1:], strict=True):
            world[first:last] = np.einsum("ij,nj->ni", pose[:3, :3], rest[first:last]) + pose[:3, 3]
        return world

    def vertices_of(self, who: Int64[np.ndarray, "some"], time_s: float) -> Float64[np.ndarray, "vertices 3"]:
        """The same for some movers, at a cost that grows with those only; all other vertices are NaN."""
        world = np.full(self.body.vertices.shape, np.nan)
        state = self.timetable.at(time_s)[who]
        for k, own, pose in zip(who.tolist(), state, matrices(state), strict=True):
            first, last, gait = self.first[k], self.first[k + 1], self.movers[k].gait
            rest = self.body.vertices[first:last] if gait is None else gait.after(own[TRAVELLED])
            world[first:last] = np.einsum("ij,nj->ni", pose[:3, :3], rest) + pose[:3, 3]
        return world
