"""A detached house as a plan: rectangular bodies in the frame of its lot, before they become geometry."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
import shapely
from jaxtyping import Float64

from scenegen.buildings.lots import Lot


class Top(StrEnum):
    """Form of the roof of a body."""

    RIDGED = "ridged"
    SHED = "shed"
    FLAT = "flat"


class End(StrEnum):
    """What a roof does at one end of its ridge (at a side of a shed roof)."""

    GABLE = "gable"
    HIP = "hip"
    WALL = "wall"
    """It stops at the wall of a higher body."""
    VALLEY = "valley"
    """It runs into the slope of a roof with the same eaves and slope."""


class Role(StrEnum):
    """What a body is for."""

    HOUSE = "house"
    GARAGE = "garage"
    HUT = "hut"
    SHELTER = "shelter"
    """A roof on posts: porch, carport."""


@dataclass(frozen=True)
class Body:
    """An upright box with a roof. Bodies of a house touch, they do not overlap.

    Attributes
    ----------
    x0_m, x1_m, y0_m, y1_m : float
        Plan in the frame of the lot: x along the street, y away from it.
    eave_m : float
        Height of its walls above the floor; of a shed roof, at the lower side.
    storeys : int
    role : Role
    top : Top
    turned : bool
        The ridge runs along y instead of x; a shed roof rises towards +x instead of +y.
    falling : bool
        A shed roof falls in that direction instead.
    slope : float
        Rise over run.
    ends : (End, End)
        At the lower and the upper coordinate of the ridge. For a shed roof, at its lower and its higher side; for a
        flat one, at the lower and the upper x.
    eaves_m : (float, float)
        Overhang of the two long sides, at the lower and the upper coordinate.
    doors : tuple of (str, float, float)
        Garage doors: side ("south" only faces the street) and span along x.
    entrance_m : float or None
        Where along x the front door should be.
    """

    x0_m: float
    x1_m: float
    y0_m: float
    y1_m: float
    eave_m: float
    storeys: int
    role: Role
    top: Top
    turned: bool = False
    falling: bool = False
    slope: float = 0.0
    ends: tuple[End, End] = (End.GABLE, End.GABLE)
    eaves_m: tuple[float, float] = (0.45, 0.45)
    doors: tuple[tuple[str, float, float], ...] = ()
    entrance_m: float | None = None

    def moved(self, dx_m: float, dy_m: float, mirror: bool) -> Body:
        """The body shifted; mirrored about x = 0 first if wished."""
        x0, x1 = (-self.x1_m, -self.x0_m) if mirror else (self.x0_m, self.x1_m)
        doors = tuple((s, -b if mirror else a, -a if mirror else b) for s, a, b in self.doors)
        door = None if self.entrance_m is None else (-1.0 if mirror else 1.0) * self.entrance_m + dx_m
        swap_ends = mirror and not self.turned and self.top is Top.RIDGED
        swap_eaves = mirror and self.turned and self.top is Top.RIDGED
        return replace(
            self,
            x0_m=x0 + dx_m,
            x1_m=x1 + dx_m,
            y0_m=self.y0_m + dy_m,
            y1_m=self.y1_m + dy_m,
            ends=self.ends[::-1] if swap_ends else self.ends,
            eaves_m=self.eaves_m[::-1] if swap_eaves else self.eaves_m,
            falling=not self.falling if mirror and self.turned and self.top is Top.SHED else self.falling,
            doors=tuple((s, a + dx_m, b + dx_m) for s, a, b in doors),
            entrance_m=door,
        )

    @property
    def half_across_m(self) -> float:
        """Half the width across the ridge."""
        return (self.x1_m - self.x0_m if self.turned else self.y1_m - self.y0_m) / 2

    @property
    def rise_m(self) -> float:
        """From the eaves to the ridge, or to the higher side of a shed roof."""
        factor = {Top.RIDGED: 1.0, Top.SHED: 2.0, Top.FLAT: 0.0}[self.top]
        return factor * self.half_across_m * self.slope


@dataclass(frozen=True)
class HomeStyle:
    """Materials and proportions of one house.

    Attributes
    ----------
    wall, gable, roof, glass, cold_glass, door, gate, timber, stone : int
        Palette indices: walls, gables and upper parts, roofs, panes of heated and unheated rooms, front door, garage
        doors, posts, slabs and chimneys.
    pitch_m, window_share : float
        Distance between window columns, window width over pitch.
    sill_m, head_m : float
        Above each floor [m].
    storey_m, recess_m : float
    blank_share, unheated_share : float
        Share of wall cells without a window; share of windows of unheated rooms.
    """

    wall: int
    gable: int
    roof: int
    glass: int
    cold_glass: int
    door: int
    gate: int
    timber: int
    stone: int
    pitch_m: float
    window_share: float
    sill_m: float
    head_m: float
    storey_m: float
    recess_m: float
    blank_share: float
    unheated_share: float


@dataclass(frozen=True, eq=False)
class Home:
    """One house, hut or garage: one instance.

    Attributes
    ----------
    object : int
        Instance id.
    style : HomeStyle
    bodies : tuple of Body
        The main body first.
    lot : Lot
        Whose frame the bodies are in.
    floor_m : float
        Height of its floor [m].
    foundation_m : float
        How far its walls continue below.
    chimneys : float64 (chimneys, 3)
        Plan position in the lot's frame and height of the top above the floor [m].
    dormers : float64 (dormers, 3)
        Position along the main ridge, side (-1 or 1), width [m].
    """

    object: int
    style: HomeStyle
    bodies: tuple[Body, ...]
    lot: Lot
    floor_m: float
    foundation_m: float
    chimneys: Float64[np.ndarray, "chimneys 3"]
    dormers: Float64[np.ndarray, "dormers 3"]

    def plan(self, roles: tuple[Role, ...] = tuple(Role)) -> shapely.Polygon:
        """Ground plan of the bodies with given roles, in the world."""
        return shapely.Polygon(self.lot.world(shapely.get_coordinates(outline(self.bodies, roles).exterior)))


def outline(bodies: tuple[Body, ...], roles: tuple[Role, ...] = tuple(Role)) -> shapely.Polygon:
    """Plan of bodies in their own frame."""
    mine = [b for b in bodies if b.role in roles]
    boxes = [shapely.box(b.x0_m, b.y0_m, b.x1_m, b.y1_m) for b in mine]
    joined = shapely.union_all(boxes) if len(boxes) > 1 else boxes[0]
    return max(shapely.get_parts(joined), key=lambda g: float(g.area))
