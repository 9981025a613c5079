"""First contact of swept spheres with bodies that move, turn and walk meanwhile: conservative advancement.

Between two instants the distance of a sphere's middle to a body changes by no more than both can move: the way of the
sphere, the fastest any point of the body goes. So a sphere at distance d can be moved on until d could have been used
up, and is measured again (Mirtich 1996, "Impulse-based dynamic simulation of rigid body systems"). No motion is
approximated: bodies are measured where their routes and gaits put them at that very instant.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from scenegen.geometry.part import Part
from scenegen.movers.company import Company
from scenegen.movers.gait import Walkers
from scenegen.movers.mover import Mover
from scenegen.movers.route import HEADING, ROLL, TRAVELLED, Timetable, Z, matrices
from scenegen.world import TriangleMesh
from scenegen_flythrough.clearance import MeshProximity
from scenegen_flythrough.distance import point_triangle

TOLERANCE_M = 0.004
"""A gap this small counts as contact: advancing would never quite arrive."""
_STEEPEST = 1.5
"""No Catmull-Rom curve is steeper than this times the largest difference of neighbouring rows: the sum of the sizes of
the three differences' weights in its derivative, largest in the middle of a step."""


@dataclass(frozen=True, eq=False)
class _Bounds:
    """How far movers reach from their origins and how fast any of their points can go.

    Attributes
    ----------
    reach_m : float64 (movers,)
    origin_mps, point_mps : float64 (movers,)
        Of the origin alone, and of every point.
    """

    reach_m: Float64[np.ndarray, "movers"]
    origin_mps: Float64[np.ndarray, "movers"]
    point_mps: Float64[np.ndarray, "movers"]

    @staticmethod
    def of(movers: tuple[Mover, ...]) -> _Bounds:
        rows = [_bounds(mover) for mover in movers]
        table = np.array(rows, np.float64).reshape(-1, 3)
        return _Bounds(table[:, 0], table[:, 1], table[:, 2])


class MovingContact:
    """Contact with the movers of a company.

    Parameters
    ----------
    company : Company
    """

    def __init__(self, company: Company) -> None:
        self._company = company
        self._bounds = _Bounds.of(company.movers)
        self._rigid: dict[int, MeshProximity] = {}
        self._walkers: dict[int, Walkers] = {}
        self._timetables: dict[int, Timetable] = {}

    def first(
        self,
        starts: Float64[np.ndarray, "n 3"],
        ends: Float64[np.ndarray, "n 3"],
        t0_s: float,
        t1_s: float,
        radius_m: float,
    ) -> tuple[Float64[np.ndarray, "n"], Int64[np.ndarray, "n"]]:
        """Share of each segment until contact (+inf: none), and the mover touched (-1: none)."""
        share, touched = np.full(len(starts), np.inf), np.full(len(starts), -1, np.int64)
        row, mover = self._near(starts, ends, t0_s, t1_s, radius_m)
        along, span = ends - starts, t1_s - t0_s
        # How much the gap can close over the whole segment.
        closing = np.linalg.norm(along[row], axis=1) + self._bounds.point_mps[mover] * span
        place = np.zeros(len(row))
        alive = np.arange(len(row))
        while len(alive):
            r, m, s = row[alive], mover[alive], place[alive]
            gap = self._distances(starts[r] + s[:, None] * along[r], m, t0_s + s * span) - radius_m
            met = gap <= TOLERANCE_M
            for hit in alive[met]:
                if place[hit] < share[row[hit]]:
                    share[row[hit]], touched[row[hit]] = place[hit], mover[hit]
            place[alive] = s + gap / np.maximum(closing[alive], 1e-12)
            alive = alive[~met & (place[alive] <= 1.0) & (place[alive] < share[r])]
        return share, touched

    def distance(
        self, points: Float64[np.ndarray, "n 3"], time_s: float, limit_m: float
    ) -> Float64[np.ndarray, "n"]:
        """Distance [m] of points to the nearest mover at one time; +inf beyond the limit."""
        best = np.full(len(points), np.inf)
        row, mover = self._near(points, points, time_s, time_s, limit_m)
        found = self._distances(points[row], mover, np.full(len(row), time_s))
        np.minimum.at(best, row, np.where(found <= limit_m, found, np.inf))
        return best

    def spheres_apart(self, points: Float64[np.ndarray, "n 3"], time_s: float) -> Float64[np.ndarray, "n"]:
        """Least distance [m] of points to the spheres around the movers; negative inside, +inf without movers."""
        origin = self._company.poses(time_s)[:, :3, 3]
        apart = np.linalg.norm(points[:, None] - origin, axis=2) - self._bounds.reach_m
        return np.asarray(apart.min(axis=1, initial=np.inf))

    def _near(
        self,
        starts: Float64[np.ndarray, "n 3"],
        ends: Float64[np.ndarray, "n 3"],
        t0_s: float,
        t1_s: float,
        radius_m: float,
    ) -> tuple[Int64[np.ndarray, "pairs"], Int64[np.ndarray, "pairs"]]:
        """Pairs of segment and mover whose spheres meet."""
        origin = self._company.poses(0.5 * (t0_s + t1_s))[:, :3, 3]
        reach = self._bounds.reach_m + 0.5 * (t1_s - t0_s) * self._bounds.origin_mps + radius_m + TOLERANCE_M
        apart = np.linalg.norm(0.5 * (starts + ends)[:, None] - origin, axis=2)
        half = 0.5 * np.linalg.norm(ends - starts, axis=1)
        row, mover = np.nonzero(apart <= reach + half[:, None])
        return row, mover

    def _distances(
        self,
        points: Float64[np.ndarray, "pairs 3"],
        mover: Int64[np.ndarray, "pairs"],
        time_s: Float64[np.ndarray, "pairs"],
    ) -> Float64[np.ndarray, "pairs"]:
        """Distance of each point to its mover at its own time."""
        found = np.empty(len(points))
        for m in np.unique(mover):
            mine = np.flatnonzero(mover == m)
            state = self._timetable(int(m)).over(time_s[mine])[:, 0]
            pose = matrices(state)
            local = np.einsum("nij,ni->nj", pose[:, :3, :3], points[mine] - pose[:, :3, 3])
            if self._company.movers[m].gait is None:
                found[mine] = self._body(int(m)).distance(local)
            else:
                found[mine] = self._walking(int(m), local, state[:, TRAVELLED])
        return found

    def _timetable(self, mover: int) -> Timetable:
        if mover not in self._timetables:
            self._timetables[mover] = Timetable.of([self._company.movers[mover].route])
        return self._timetables[mover]

    def _body(self, mover: int) -> MeshProximity:
        if mover not in self._rigid:
            self._rigid[mover] = MeshProximity(_mesh(self._company.movers[mover].body))
        return self._rigid[mover]

    def _walking(
        self, mover: int, points: Float64[np.ndarray, "n 3"], travelled_m: Float64[np.ndarray, "n"]
    ) -> Float64[np.ndarray, "n"]:
        one = self._company.movers[mover]
        if mover not in self._walkers:
            assert one.gait is not None
            self._walkers[mover] = Walkers.of([one.gait], [0])
        found = np.empty(len(points))
        for k, point in enumerate(points):
            body = self._walkers[mover].step(travelled_m[k : k + 1])[one.body.faces]
            found[k] = np.sqrt(point_triangle(np.broadcast_to(point, (len(body), 3)), body).min())
        return found


def _mesh(body: Part) -> TriangleMesh:
    return TriangleMesh(body.vertices.astype(np.float32), body.faces.astype(np.uint32))


def _bounds(mover: Mover) -> tuple[float, float, float]:
    """Reach [m], fastest origin and fastest point [m/s] of one mover."""
    rise = np.abs(np.diff(mover.route.rows, axis=0))
    fastest = _STEEPEST / mover.route.step_s
    step = np.diff(mover.route.rows[:, : Z + 1], axis=0)
    origin = fastest * float(np.linalg.norm(step, axis=1).max())
    turning = fastest * float(rise[:, HEADING : ROLL + 1].sum(axis=1).max())
    reach = float(np.linalg.norm(np.abs(mover.box_m).max(axis=0)))
    limbs = 0.0
    if mover.gait is not None:
        cycle = mover.gait.cycle.astype(np.float64)
        longest = np.linalg.norm(np.roll(cycle, -1, axis=0) - cycle, axis=2).max()
        per_metre = float(longest) * len(cycle) / mover.gait.stride_m
        limbs = per_metre * fastest * float(rise[:, TRAVELLED].max())
    return reach, origin, origin + turning * reach + limbs
