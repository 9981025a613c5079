"""Drawing detached houses: which bodies, how large, which roofs; and their materials by age."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scenegen.buildings.detached.attachments import garages, porches, wings, with_clear_entrance
from scenegen.buildings.detached.body import Body, End, HomeStyle, Role, Top
from scenegen.materials.palette import PaletteBuilder

_OLD_WALLS = ("brick_red", "wood_siding", "stucco_render", "brick_red", "wood_siding")
_NEW_WALLS = ("stucco_render", "wood_siding", "stucco_render", "brick_red", "concrete_wall")
_OLD_ROOFS = ("clay_roof_tile", "slate_roof", "asphalt_shingle", "clay_roof_tile")
_NEW_ROOFS = ("asphalt_shingle", "asphalt_shingle", "clay_roof_tile", "metal_roof_painted_mid")


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
        bodies += garages(main, style, spare, rng)
    if not any(b.y1_m <= 0.0 for b in bodies) and rng.uniform() < 0.35:
        bodies += wings(main, -1.0, rng.uniform(1.6, 3.0), rng)
    if rng.uniform() < 0.3:
        bodies += wings(main, 1.0, rng.uniform(2.4, 4.2), rng)
    bodies = with_clear_entrance(bodies)
    if (rng.uniform() < 0.6 and not traits.modern) or rng.uniform() < 0.3:
        bodies += porches(bodies, rng)
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
