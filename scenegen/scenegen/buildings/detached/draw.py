"""Drawing detached houses: which bodies, how large, which roofs; and their materials by age."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scenegen.buildings.detached.body import Body, End, HomeStyle, Role, Top
from scenegen.materials.palette import PaletteBuilder

_OLD_WALLS = ("brick_red", "wood_siding", "stucco_render", "brick_red", "wood_siding")
_NEW_WALLS = ("stucco_render", "wood_siding", "stucco_render", "brick_red", "concrete_wall")
_OLD_ROOFS = ("clay_roof_tile", "slate_roof", "asphalt_shingle", "clay_roof_tile")
_NEW_ROOFS = ("asphalt_shingle", "asphalt_shingle", "clay_roof_tile", "metal_roof_painted_mid")
_GARAGE_EAVE_M = 2.45
_PORCH_EAVE_M, _PORCH_SLOPE = 2.12, 0.13


@dataclass(frozen=True)
class Traits:
    """What a house should be like.

    Attributes
    ----------
    modern : bool
    storeys : int
    garage : bool
    unheated_share : float
        Share of windows of unheated rooms.
    """

    modern: bool
    storeys: int
    garage: bool
    unheated_share: float


def draw_home_style(
    traits: Traits, cold_glass: int, palette: PaletteBuilder, rng: np.random.Generator
) -> HomeStyle:
    """Draw the look of a house.

    Parameters
    ----------
    traits : Traits
    cold_glass : int
        Palette index of panes of unheated rooms.
    palette : PaletteBuilder
    rng : numpy.random.Generator
    """
    walls, roofs = (_NEW_WALLS, _NEW_ROOFS) if traits.modern else (_OLD_WALLS, _OLD_ROOFS)
    wall = palette.pick(walls[int(rng.integers(5))], rng)
    other = palette.pick(("wood_siding", "stucco_render")[int(rng.integers(2))], rng)
    sill = rng.uniform(0.5, 0.9) if traits.modern else rng.uniform(0.75, 0.95)
    storey = rng.uniform(2.65, 2.95)
    return HomeStyle(
        wall=wall,
        gable=other if rng.uniform() < 0.35 else wall,
        roof=palette.pick(roofs[int(rng.integers(4))], rng),
        glass=palette.pick("window_glass", rng),
        cold_glass=cold_glass,
        door=palette.pick("wood_siding", rng),
        gate=palette.pick("metal_roof_painted_mid" if rng.uniform() < 0.7 else "wood_siding", rng),
        timber=palette.pick("wood_siding", rng),
        stone=palette.pick("brick_red" if rng.uniform() < 0.6 else "concrete_wall", rng),
        pitch_m=rng.uniform(2.7, 3.8),
        window_share=rng.uniform(0.45, 0.68) if traits.modern else rng.uniform(0.32, 0.48),
        sill_m=sill,
        head_m=sill + rng.uniform(1.15, 1.5),
        storey_m=storey,
        recess_m=rng.uniform(0.06, 0.14),
        blank_share=rng.uniform(0.04, 0.2),
        unheated_share=traits.unheated_share,
    )


def draw_bodies(
    traits: Traits, style: HomeStyle, room_m: float, rng: np.random.Generator
) -> tuple[Body, ...]:
    """Draw the bodies of a house, its main front on y = 0 about the origin.

    Parameters
    ----------
    traits : Traits
    style : HomeStyle
    room_m : float
        Width there is [m].
    rng : numpy.random.Generator
    """
    two = traits.storeys > 1
    depth = rng.uniform(7.4, 9.6)
    wide = rng.uniform(8.2, 11.0) if two else rng.uniform(10.5, 15.0)
    integral = traits.garage and not two and rng.uniform() < 0.35 and room_m > wide + 3.0
    wide = min(wide + 3.0 * integral, room_m)
    eave = traits.storeys * style.storey_m + rng.uniform(-0.1, 0.15)
    top, turned, ends, slope = _main_roof(traits, wide, depth, rng)
    main = Body(
        -wide / 2, wide / 2, 0.0, depth, eave, traits.storeys, Role.HOUSE, top, turned, False, slope, ends,
        entrance_m=rng.uniform(-0.2, 0.2) * wide,
    )  # fmt: skip
    if integral:
        gate = min(5.2, 0.42 * wide)
        main = replace(
            main, doors=(("south", wide / 2 - 0.4 - gate, wide / 2 - 0.4),), entrance_m=-0.18 * wide
        )
    bodies = [main]
    spare = room_m - wide
    if traits.garage and not integral:
        bodies += _garage(main, style, spare, rng)
    if not any(b.y1_m <= 0.0 for b in bodies) and rng.uniform() < 0.35:
        bodies += _ell(main, -1.0, rng.uniform(1.6, 3.0), rng)
    if rng.uniform() < 0.3:
        bodies += _ell(main, 1.0, rng.uniform(2.4, 4.2), rng)
    bodies = _clear_entrance(bodies)
    if rng.uniform() < 0.6 and not traits.modern or rng.uniform() < 0.3:
        bodies += _porch(bodies, rng)
    return tuple(bodies)


def draw_hut(size_m: tuple[float, float], style: HomeStyle, rng: np.random.Generator) -> Body:
    """A garden shed, its front on y = 0 about the origin."""
    a, b = size_m
    top = (Top.RIDGED, Top.SHED, Top.RIDGED)[int(rng.integers(3))]
    slope = rng.uniform(0.4, 0.7) if top is Top.RIDGED else rng.uniform(0.1, 0.2)
    over = (0.2, 0.2) if top is Top.RIDGED else (0.45, 0.45)
    return Body(
        -a / 2, a / 2, 0.0, b, rng.uniform(1.95, 2.2), 1, Role.HUT, top, False, bool(rng.uniform() < 0.5),
        slope, eaves_m=over, entrance_m=0.0,
    )  # fmt: skip


def draw_chimneys(main: Body, rng: np.random.Generator) -> np.ndarray:
    """None to two stacks near the ridge; position in the lot's frame, top above the floor."""
    count = int(rng.choice([0, 1, 1, 2]))
    if main.top is not Top.RIDGED or not count:
        return np.zeros((0, 3))
    half = (main.y1_m - main.y0_m if main.turned else main.x1_m - main.x0_m) / 2
    hip = End.HIP in main.ends
    reach = max(half - main.half_across_m, 0.5) if hip else half - 0.9
    along = np.array([-1.0, 1.0])[:count] * rng.uniform(0.45, 0.95, count) * reach
    across = rng.uniform(0.0, 0.4, count)
    middle = np.array([(main.x0_m + main.x1_m) / 2, (main.y0_m + main.y1_m) / 2])
    offset = np.column_stack([-across, along] if main.turned else [along, across])
    top = np.full(count, main.eave_m + main.rise_m + rng.uniform(0.55, 0.9))
    return np.column_stack([middle + offset, top])


def draw_dormers(main: Body, bodies: tuple[Body, ...], rng: np.random.Generator) -> np.ndarray:
    """None to three dormers on a steep slope without valleys: position along the ridge, side, width."""
    if main.top is not Top.RIDGED or main.slope < 0.62 or rng.uniform() < 0.45 or main.half_across_m < 3.4:
        return np.zeros((0, 3))
    joined = {-1.0 if b.y0_m < main.y0_m else 1.0 for b in bodies if End.VALLEY in b.ends}
    sides = [s for s in (-1.0, 1.0) if s not in joined]
    if not sides:
        return np.zeros((0, 3))
    half = (main.y1_m - main.y0_m if main.turned else main.x1_m - main.x0_m) / 2
    reach = half - (main.half_across_m * 0.75 if End.HIP in main.ends else 0.4) - 1.1
    count = min(int(rng.integers(1, 4)), int(2 * max(reach, 0.0) / 2.4) + 1)
    if reach < 0.0:
        return np.zeros((0, 3))
    side, width = sides[int(rng.integers(len(sides)))], rng.uniform(1.25, 1.7)
    along = np.linspace(-reach, reach, count) if count > 1 else np.zeros(1)
    return np.column_stack(
        [along * (0.85 if count > 1 else 1.0), np.full(count, side), np.full(count, width)]
    )


def _main_roof(
    traits: Traits, wide: float, depth: float, rng: np.random.Generator
) -> tuple[Top, bool, tuple[End, End], float]:
    """Form, direction, ends and slope of the main roof."""
    choice = rng.uniform()
    if traits.modern and choice < 0.14:
        return Top.SHED, False, (End.GABLE, End.GABLE), rng.uniform(0.12, 0.25)
    if traits.modern and choice < 0.20:
        return Top.FLAT, False, (End.GABLE, End.GABLE), 0.0
    hip = choice > (0.5 if traits.modern else 0.75)
    slope = rng.uniform(0.35, 0.6) if traits.modern else rng.uniform(0.65, 1.0)
    turned = not hip and wide < 1.12 * depth and rng.uniform() < 0.4
    if hip:
        slope = min(slope, 0.75)
    return Top.RIDGED, turned, ((End.HIP, End.HIP) if hip else (End.GABLE, End.GABLE)), slope


def _joinable(main: Body) -> bool:
    """Whether other roofs can run into its slopes."""
    return main.top is Top.RIDGED and not main.turned


def _garage(main: Body, style: HomeStyle, spare: float, rng: np.random.Generator) -> list[Body]:
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


def _ell(main: Body, side: float, deep: float, rng: np.random.Generator) -> list[Body]:
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


def _valley_inset(main: Body) -> float:
    """Distance of a wing from the end of the main body: its eaves stay clear of verge or hip."""
    return 0.75 if main.ends[0] is End.GABLE else 1.2


def _clear_entrance(bodies: list[Body]) -> list[Body]:
    """Move the front door to the widest stretch of the main front that is free."""
    main = bodies[0]
    taken = [(b.x0_m, b.x1_m) for b in bodies[1:] if b.y1_m <= main.y0_m + 1e-9]
    taken += [(a, b) for _, a, b in main.doors]
    marks = sorted([main.x0_m, main.x1_m, *(x for span in taken for x in span)])
    free = [
        (a, b)
        for a, b in zip(marks[:-1], marks[1:], strict=True)
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


def _porch(bodies: list[Body], rng: np.random.Generator) -> list[Body]:
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
