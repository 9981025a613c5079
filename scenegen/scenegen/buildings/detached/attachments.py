"""What is built on to a house: garages before and beside it, wings, carports, porches."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from scenegen.buildings.detached.body import Body, End, HomeStyle, Role, Top

_GARAGE_EAVE_M = 2.45
_PORCH_EAVE_M, _PORCH_SLOPE = 2.12, 0.13


def garages(main: Body, style: HomeStyle, spare: float, rng: np.random.Generator) -> list[Body]:
    """A garage before, beside, or a carport; mirrored later at will, so always at +x."""
    wide = rng.uniform(5.6, 6.2)
    choice = rng.uniform()
    if _joinable(main) and choice < 0.4 and main.half_across_m > wide / 2 + 0.3:
        return _snout(main, wide, rng)
    if spare < wide:
        wide = rng.uniform(3.3, 3.7)
    if spare < wide:
        return _snout(main, 3.6, rng) if _joinable(main) else []
    x0, y0, deep = main.x1_m, rng.uniform(0.0, 1.8), rng.uniform(5.9, 6.5)
    if choice > 0.88:
        return [
            Body(
                x0,
                x0 + min(wide, 3.4),
                y0,
                y0 + deep,
                2.3,
                1,
                Role.SHELTER,
                Top.FLAT,
                ends=(End.WALL, End.GABLE),
            )
        ]
    door = (("south", x0 + 0.35, x0 + wide - 0.35),)
    eave = min(_GARAGE_EAVE_M, main.eave_m - 0.2)
    if main.storeys == 1 or choice > 0.76:
        return [
            Body(
                x0, x0 + wide, y0, y0 + deep, eave - 0.1, 1, Role.GARAGE, Top.FLAT,
                ends=(End.WALL, End.GABLE), doors=door,
            )
        ]  # fmt: skip
    slope = min(main.slope, 0.62) if main.top is Top.RIDGED else 0.4
    if choice > 0.58:
        return [
            Body(
                x0, x0 + wide, y0, y0 + deep, eave, 1, Role.GARAGE, Top.RIDGED, True, False, slope,
                eaves_m=(0.0, 0.35), doors=door,
            )
        ]  # fmt: skip
    return [
        Body(
            x0, x0 + wide, y0, y0 + deep, eave, 1, Role.GARAGE, Top.RIDGED, False, False, slope,
            ends=(End.WALL, End.GABLE if rng.uniform() < 0.6 else End.HIP), doors=door,
        )
    ]  # fmt: skip


def wings(main: Body, side: float, deep: float, rng: np.random.Generator) -> list[Body]:
    """A wing to the front (-1) or the back (1)."""
    inset, most = _valley_inset(main), 1.85 * main.half_across_m
    wide = min(rng.uniform(3.8, 5.6), most, main.x1_m - main.x0_m - 2 * inset)
    if not _joinable(main) or wide < 3.0:
        return []
    x0 = main.x0_m + inset
    far = End.HIP if main.ends[0] is End.HIP else End.GABLE
    y0, y1 = (main.y0_m - deep, main.y0_m) if side < 0 else (main.y1_m, main.y1_m + deep)
    ends = (far, End.VALLEY) if side < 0 else (End.VALLEY, far)
    return [
        Body(
            x0,
            x0 + wide,
            y0,
            y1,
            main.eave_m,
            main.storeys,
            Role.HOUSE,
            Top.RIDGED,
            True,
            False,
            main.slope,
            ends,
        )
    ]


def with_clear_entrance(bodies: list[Body]) -> list[Body]:
    """Move the front door to the widest stretch of the main front that is free."""
    main = bodies[0]
    taken = [(b.x0_m, b.x1_m) for b in bodies[1:] if b.y1_m <= main.y0_m + 1e-9]
    taken += [(a, b) for _, a, b in main.doors]
    marks = sorted([main.x0_m, main.x1_m, *(x for span in taken for x in span)])
    free = [
        (a, b)
        for a, b in pairwise(marks)
        if b - a > 0.5 and not any(p <= a + 1e-9 and b <= q + 1e-9 for p, q in taken)
    ]
    if not free:
        return [replace(main, entrance_m=None), *bodies[1:]]
    a, b = max(free, key=lambda f: f[1] - f[0])
    wished = main.entrance_m if main.entrance_m is not None else (a + b) / 2
    return [
        replace(main, entrance_m=float(np.clip(wished, a + 0.4 * (b - a), a + 0.6 * (b - a)))),
        *bodies[1:],
    ]


def porches(bodies: list[Body], rng: np.random.Generator) -> list[Body]:
    """A roof on posts over the front door, or along the whole free front."""
    main = bodies[0]
    if main.entrance_m is None:
        return []
    x = main.entrance_m
    left = max([main.x0_m, *(b.x1_m for b in bodies[1:] if b.y1_m <= main.y0_m + 1e-9 and b.x1_m <= x)])
    right = min([main.x1_m, *(b.x0_m for b in bodies[1:] if b.y1_m <= main.y0_m + 1e-9 and b.x0_m >= x)])
    for _, a, b in main.doors:
        left, right = (max(left, b), right) if b <= x else (left, min(right, a))
    whole = rng.uniform() < 0.45
    half = rng.uniform(1.0, 1.6)
    a, b = (left + 0.5, right - 0.5) if whole else (max(x - half, left + 0.5), min(x + half, right - 0.5))
    if b - a < 1.5:
        return []
    deep = rng.uniform(1.5, 2.1)
    return [
        Body(
            a, b, main.y0_m - deep, main.y0_m, _PORCH_EAVE_M, 1, Role.SHELTER, Top.SHED, False, False, _PORCH_SLOPE,
            (End.GABLE, End.WALL),
        )
    ]  # fmt: skip


def _snout(main: Body, wide: float, rng: np.random.Generator) -> list[Body]:
    """A garage before the house, its roof running into the main slope."""
    inset = _valley_inset(main)
    if main.x1_m - main.x0_m - 2 * inset < wide:
        return []
    x1 = main.x1_m - inset
    deep = rng.uniform(2.6, 5.4)
    front = End.HIP if main.ends[0] is End.HIP else End.GABLE
    return [
        Body(
            x1 - wide, x1, main.y0_m - deep, main.y0_m, main.eave_m, main.storeys, Role.HOUSE, Top.RIDGED, True,
            False, main.slope, (front, End.VALLEY), doors=(("south", x1 - wide + 0.4, x1 - 0.4),),
        )
    ]  # fmt: skip


def _joinable(main: Body) -> bool:
    """Whether other roofs can run into its slopes."""
    return main.top is Top.RIDGED and not main.turned


def _valley_inset(main: Body) -> float:
    """Distance of a wing from the end of the main body: its eaves stay clear of verge or hip."""
    return 0.75 if main.ends[0] is End.GABLE else 1.2
