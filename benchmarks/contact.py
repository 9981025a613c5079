"""The collision detector against brute force: spheres swept through real worlds and past their movers.

What stands: random segments are swept, more of them near surfaces than chance would have it. Every triangle whose box
comes near a segment's box is measured against it, all in float64, by formulas of this script alone: the distance of a
point to a triangle by the region its projection falls into, of a segment by golden-section search along it (the
distance of points of a line to a convex set is convex). A few points are measured against every triangle of the world,
so that the choice by boxes is itself proven.

What moves: the sphere is followed in steps of half a millisecond against `Company.vertices`, posed anew each time.

A miss is a contact that is not reported although brute force comes nearer than the radius less 0.1 mm; a false hit one
that is reported although it stays further than the radius and 1 cm.

    python benchmarks/contact.py [--map city] [--sweeps 25000] [--moving 300]
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from scenegen.climate.season import Season
from scenegen.foundation.rng import stream
from scenegen.maps.registry import MAPS, build_world, map_family
from scenegen.movers.company import Company
from scenegen.world import World
from scenegen_flythrough.loop.contact import Obstacles
from scenegen_flythrough.loop.moving_contact import MovingContact

RADIUS_M = 0.35
FASTEST_MPS = 22.2
STEP_S = 0.05
MOVING_STEPS = 100
"""Of half a millisecond: nothing closes in by more than 2 cm meanwhile, so the least gap is known to 1 cm."""
MISS_M, FALSE_M = 1e-4, 0.01
GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)


def to_triangle(p: np.ndarray, triangle: np.ndarray) -> np.ndarray:
    """Distance of points (n, 3) to triangles (n, 3, 3): project, clamp to the region the projection falls into.

    C. Ericson, Real-Time Collision Detection (2005), section 5.1.5: another way than the package's.
    """
    a, b, c = triangle[:, 0], triangle[:, 1], triangle[:, 2]
    ab, ac = b - a, c - a
    d1, d2 = ((e * (p - a)).sum(1) for e in (ab, ac))
    d3, d4 = ((e * (p - b)).sum(1) for e in (ab, ac))
    d5, d6 = ((e * (p - c)).sum(1) for e in (ab, ac))
    vc, vb, va = d1 * d4 - d3 * d2, d5 * d2 - d1 * d6, d3 * d6 - d5 * d4
    with np.errstate(divide="ignore", invalid="ignore"):
        on_ab, on_ac = d1 / (d1 - d3), d2 / (d2 - d6)
        on_bc = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        total = va + vb + vc
        inside = a + (vb / total)[:, None] * ab + (vc / total)[:, None] * ac
    cases = [
        ((d1 <= 0) & (d2 <= 0), a),
        ((d3 >= 0) & (d4 <= d3), b),
        ((vc <= 0) & (d1 >= 0) & (d3 <= 0), a + on_ab[:, None] * ab),
        ((d6 >= 0) & (d5 <= d6), c),
        ((vb <= 0) & (d2 >= 0) & (d6 <= 0), a + on_ac[:, None] * ac),
        ((va <= 0) & (d4 - d3 >= 0) & (d5 - d6 >= 0), b + on_bc[:, None] * (c - b)),
    ]
    nearest, open_ = inside, np.ones(len(p), bool)
    for case, place in cases:
        nearest = np.where((open_ & case)[:, None], place, nearest)
        open_ &= ~case
    return np.linalg.norm(p - nearest, axis=1)


def along(starts: np.ndarray, ends: np.ndarray, triangle: np.ndarray) -> np.ndarray:
    """Distance of segments to triangles, pair by pair: golden-section search to 1e-5 of the segment."""
    at = lambda s: to_triangle(starts + s[:, None] * (ends - starts), triangle)  # noqa: E731
    low, high = np.zeros(len(starts)), np.ones(len(starts))
    x, y = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    fx, fy = at(x), at(y)
    for _ in range(24):
        left = fx <= fy
        low, high = np.where(left, low, x), np.where(left, y, high)
        new = np.where(left, high - GOLDEN * (high - low), low + GOLDEN * (high - low))
        value = at(new)
        x, y, fx, fy = (
            np.where(left, new, y), np.where(left, x, new), np.where(left, value, fy), np.where(left, fx, value)
        )  # fmt: skip
    return np.minimum(np.minimum(fx, fy), np.minimum(at(np.zeros(len(low))), at(np.ones(len(low)))))


class Buckets:
    """Triangles of a world in square cells of the plan, by the corner of their boxes; large ones apart."""

    CELL_M = 8.0

    def __init__(self, world: World) -> None:
        a, b, c = (world.mesh.vertices[world.mesh.faces[:, k]].astype(np.float64) for k in range(3))
        low, high = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
        cell = np.floor(low[:, :2] / self.CELL_M).astype(np.int64) + 100_000
        key = cell[:, 0] * 1_000_000 + cell[:, 1]
        large = np.maximum(high[:, 0] - low[:, 0], high[:, 1] - low[:, 1]) > self.CELL_M
        order = np.argsort(np.where(large, -1, key), kind="stable")  # large ones first
        self.large = int(large.sum())
        self.key = key[order][self.large :]
        self.triangle = np.stack([a, b, c], axis=1)[order]
        self.low, self.high = low[order], high[order]

    def near(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Triangles whose boxes meet a box."""
        first = np.floor(low[:2] / self.CELL_M).astype(np.int64) + 100_000 - 1
        last = np.floor(high[:2] / self.CELL_M).astype(np.int64) + 100_000
        runs = [slice(0, self.large)]
        for column in range(first[0], last[0] + 1):
            ends = np.searchsorted(self.key, column * 1_000_000 + np.array([first[1], last[1] + 1]))
            runs.append(slice(*(ends + self.large)))
        found = []
        for run in runs:
            meets = (self.low[run] <= high) & (self.high[run] >= low)
            found.append(self.triangle[run][meets[:, 0] & meets[:, 1] & meets[:, 2]])
        return np.concatenate(found)


def brute(buckets: Buckets, starts: np.ndarray, ends: np.ndarray, reach: float) -> np.ndarray:
    """Distance of segments to all triangles where it is below `reach`; +inf beyond."""
    best = np.full(len(starts), np.inf)
    for first in range(0, len(starts), 500):
        part = range(first, min(first + 500, len(starts)))
        found = [
            buckets.near(np.minimum(starts[k], ends[k]) - reach, np.maximum(starts[k], ends[k]) + reach)
            for k in part
        ]
        row = np.repeat(np.array(part), [len(f) for f in found])
        triangle = np.concatenate(found)
        # The nearest is no further from the middle than the one nearest to the middle and half the segment.
        half = 0.5 * np.linalg.norm(ends - starts, axis=1)
        rough = to_triangle(0.5 * (starts + ends)[row], triangle)
        closest = np.full(len(starts), np.inf)
        np.minimum.at(closest, row, rough)
        keep = rough <= closest[row] + half[row] + 1e-9
        row, triangle = row[keep], triangle[keep]
        np.minimum.at(best, row, along(starts[row], ends[row], triangle))
    return np.where(best <= reach, best, np.inf)


def segments(world: World, count: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Half anywhere in the airspace below 40 m, half beginning within a metre of a random triangle's middle."""
    low, high = (np.array(corner, float) for corner in world.flight_box_m)
    high[2] = min(high[2], 40.0)
    anywhere = rng.uniform(low, high, (count // 2, 3))
    face = world.mesh.faces[rng.integers(0, len(world.mesh.faces), count - len(anywhere))]
    near = world.mesh.vertices[face].mean(axis=1) + rng.normal(0.0, 0.6, (len(face), 3))
    starts = np.concatenate([anywhere, near])
    way = rng.normal(size=(count, 3))
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    return starts, starts + way * rng.uniform(0.0, FASTEST_MPS * 2.0 * STEP_S, (count, 1))


def standing(
    world: World, obstacles: Obstacles, count: int, rng: np.random.Generator
) -> tuple[int, int, int]:
    """Hits, misses and false hits against what stands."""
    starts, ends = segments(world, count, rng)
    share = obstacles.proximity.first_contact(starts, ends, RADIUS_M)
    hit = np.isfinite(share)
    buckets, reach = Buckets(world), RADIUS_M + 0.05
    truth = brute(buckets, starts, ends, reach)
    every = world.mesh.vertices[world.mesh.faces].astype(np.float64)
    for k in rng.choice(count, 2, replace=False):  # against all triangles, no choice by cells
        whole = to_triangle(np.broadcast_to(starts[k], (len(every), 3)), every).min()
        assert np.isclose(brute(buckets, starts[k : k + 1], starts[k : k + 1], whole + 0.1)[0], whole)
    missed = int((~hit & (truth < RADIUS_M - MISS_M)).sum())
    false = int((hit & (truth > RADIUS_M + FALSE_M)).sum())
    # Up to the contact the way is free: nothing was reported too late.
    late = np.flatnonzero(hit & (share > 0.0))
    stops = starts[late] + share[late, None] * (ends[late] - starts[late])
    missed += int((brute(buckets, starts[late], stops, reach) < RADIUS_M - MISS_M).sum())
    return int(hit.sum()), missed, false


def moving(world: World, count: int, rng: np.random.Generator) -> tuple[int, int, int]:
    """Hits, misses and false hits against movers, for segments that begin near one."""
    hits = missed = false = 0
    for _ in range(count if world.movers else 0):
        time_s = float(rng.uniform(0.0, 3600.0))
        company = Company.of([world.movers[int(rng.integers(len(world.movers)))]])
        body = company.vertices(time_s)
        start = body[rng.integers(len(body))] + rng.normal(0.0, 0.8, 3)
        way = rng.normal(size=3)
        end = start + way / np.linalg.norm(way) * rng.uniform(0.0, FASTEST_MPS) * STEP_S
        share, _ = MovingContact(company).first(start[None], end[None], time_s, time_s + STEP_S, RADIUS_M)
        closest, first = followed(company, start, end, time_s)
        found = bool(np.isfinite(share[0]))
        hits += found
        missed += closest < RADIUS_M - MISS_M and not share[0] <= first + 1e-9
        false += found and closest > RADIUS_M + FALSE_M
    return hits, missed, false


def followed(company: Company, start: np.ndarray, end: np.ndarray, time_s: float) -> tuple[float, float]:
    """Least distance to the only mover of a company, and the share at which the radius is first undercut."""
    least, first = np.inf, np.inf
    for share in np.linspace(0.0, 1.0, MOVING_STEPS + 1):
        corner = company.vertices(time_s + share * STEP_S)[company.body.faces]
        point = start + share * (end - start)
        gap = float(to_triangle(np.broadcast_to(point, (len(corner), 3)), corner).min())
        least = min(least, gap)
        if gap < RADIUS_M - MISS_M and first == np.inf:
            first = float(share)
    return least, first


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--map", choices=sorted(MAPS), nargs="+", default=sorted(MAPS))
    parser.add_argument("--sweeps", type=int, default=25_000, help="per map")
    parser.add_argument("--moving", type=int, default=100, help="per map")
    asked = parser.parse_args()
    for name in asked.map:
        world = build_world(
            name, map_family(name).knobs(), Season(40.0, 7, 15), stream(0, "benchmark", "world")
        )
        obstacles, rng = Obstacles(world), stream(0, "contact", name)
        start = time.process_time()
        hits, missed, false = standing(world, obstacles, asked.sweeps, rng)
        print(f"{name}: {asked.sweeps:,} sweeps, {hits:,} contacts, {missed} missed, {false} false", end="")
        print(f" ({time.process_time() - start:.0f} s of CPU)")
        hits, missed, false = moving(world, asked.moving, rng)
        print(f"  movers: {asked.moving} sweeps, {hits} contacts, {missed} missed, {false} false")


if __name__ == "__main__":
    main()
