"""Side profiles of vehicles as data: where the cabin, the pillars and the axles are.

All lengths in metres; x runs forwards from the middle of the vehicle. Sizes are those of ordinary European vehicles.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Shape:
    """A body that one loft can make.

    Attributes
    ----------
    length_m, width_m, height_m : float
    belt_m, nose_m, tail_m : float
        Heights of the lower edge of the side windows, of the front edge of the bonnet, of the rear edge of the boot.
    sill_m : float
        Lower edge of the body.
    cabin : (float, float, float, float)
        Foot of the rear screen, rear and front end of the roof, foot of the windscreen.
    tuck_m : float
        How far the roof's edge lies inside the widest line.
    axles : tuple of float
    wheel_m : float
        Radius of a wheel.
    glazed : (float, float)
        Stretch of the sides that has windows.
    pillars : tuple of float
        Between the side windows.
    rear_screen : bool
        Whether there is glass in the back.
    rounding_m : float
        How much narrower both ends are on each side.
    """

    length_m: float
    width_m: float
    height_m: float
    belt_m: float
    nose_m: float
    tail_m: float
    sill_m: float
    cabin: tuple[float, float, float, float]
    tuck_m: float
    axles: tuple[float, ...]
    wheel_m: float
    glazed: tuple[float, float]
    pillars: tuple[float, ...]
    rear_screen: bool = True
    rounding_m: float = 0.14


SALOON = Shape(
    4.65, 1.82, 1.44, 0.93, 0.74, 0.96, 0.24, (-1.72, -0.95, 0.3, 1.12), 0.24, (-1.38, 1.42), 0.32,
    (-1.45, 0.8), (-0.28,),
)  # fmt: skip
ESTATE = Shape(
    4.7, 1.82, 1.48, 0.94, 0.75, 0.9, 0.24, (-2.25, -1.95, 0.3, 1.12), 0.22, (-1.4, 1.42), 0.32,
    (-2.05, 0.8), (-0.28, -1.2),
)  # fmt: skip
HATCHBACK = Shape(
    4.05, 1.76, 1.48, 0.94, 0.78, 0.9, 0.24, (-1.95, -1.45, 0.3, 1.1), 0.22, (-1.28, 1.28), 0.3,
    (-1.6, 0.8), (-0.3,),
)  # fmt: skip
OFF_ROADER = Shape(
    4.55, 1.88, 1.68, 1.08, 0.95, 1.05, 0.34, (-2.2, -1.8, 0.3, 1.02), 0.2, (-1.35, 1.38), 0.36,
    (-1.95, 0.75), (-0.3, -1.25),
)  # fmt: skip
COMPACT_VAN = Shape(
    4.4, 1.83, 1.82, 1.08, 0.9, 1.0, 0.26, (-2.18, -2.05, 0.75, 1.45), 0.14, (-1.3, 1.45), 0.32,
    (-1.9, 1.1), (-0.35, 0.6),
)  # fmt: skip
VAN = Shape(
    5.9, 2.02, 2.45, 1.25, 1.08, 1.2, 0.3, (-2.93, -2.88, 1.45, 2.1), 0.16, (-1.75, 1.95), 0.34,
    (0.85, 1.8), (), rear_screen=False, rounding_m=0.1,
)  # fmt: skip
BUS = Shape(
    12.0, 2.55, 3.05, 1.15, 1.12, 1.15, 0.3, (-5.99, -5.85, 5.6, 5.97), 0.1, (-2.9, 3.1), 0.48,
    (-5.6, 5.7), (-4.3, -2.8, -1.3, 0.2, 1.7, 3.2, 4.6), rounding_m=0.1,
)  # fmt: skip
TRUCK_CAB = Shape(
    2.0, 2.4, 2.9, 1.6, 1.45, 1.6, 0.5, (-0.99, -0.97, 0.6, 0.98), 0.12, (0.1,), 0.48,
    (-0.35, 0.8), (), rear_screen=False, rounding_m=0.12,
)  # fmt: skip

CARS: dict[str, tuple[Shape, float]] = {
    "saloon": (SALOON, 0.27),
    "estate": (ESTATE, 0.17),
    "hatchback": (HATCHBACK, 0.3),
    "off_roader": (OFF_ROADER, 0.18),
    "compact_van": (COMPACT_VAN, 0.08),
}
"""Bodies of cars and their shares of the traffic."""
