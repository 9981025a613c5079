"""What vehicles are painted with, and what is warm on them when they are driven.

Ranges: engine bays 330-360 K behind the bonnet, exhausts 350-450 K inside, brakes and rims 310-330 K inside, tyres
10-25 K above the air in ordinary wind by the heat of their own flexing (rolling resistance of a few hundred watts a
wheel on 0.75 m^2), undertrays over gearbox and exhaust 310-330 K.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Int64

from scenegen.parts.vehicles.slots import (
    BONNET,
    CARGO,
    EXHAUST,
    GLASS,
    PAINT,
    SLOTS,
    TYRE,
    UNDERSIDE,
    WHEEL,
)
from scenegen.parts.workshop import Workshop

PAINTS = ("car_paint_black", "car_paint_white", "car_paint_silver", "car_paint_mid")
_SHARES = (0.27, 0.25, 0.26, 0.22)
_VARIANTS = 2

ENGINE_BAY_K = (330.0, 360.0)
EXHAUST_K = (350.0, 450.0)
BRAKES_K = (312.0, 332.0)
UNDERTRAY_K = (310.0, 330.0)
TYRE_Wm2 = (200.0, 320.0)
HEATED_CABIN_K = 293.0


def skins(
    kind: str, count: int, driven: bool, shop: Workshop, rng: np.random.Generator
) -> Int64[np.ndarray, "vehicles slots"]:
    """Palette indices for the slots of vehicles, one row each; warmth is drawn once per world and paint."""
    palette = shop.palette
    heat = _Heat(driven, rng)
    paint = rng.choice(len(PAINTS), count, p=_SHARES)
    variants = np.array([palette.variants(name, _VARIANTS) for name in PAINTS])
    rows = np.empty((count, SLOTS), np.int64)
    rows[:, PAINT] = variants[paint, rng.integers(_VARIANTS, size=count)]
    if driven:
        warm = [palette.special(name, "bonnet", interior_K=heat.engine_K) for name in PAINTS]
        rows[:, BONNET] = np.array(warm)[paint]
        rows[:, TYRE] = palette.special("tyre_rubber", "rolling", released_Wm2=heat.tyre_Wm2)
        rows[:, WHEEL] = palette.special("steel_oxidised", "brakes", interior_K=heat.brakes_K)
        rows[:, UNDERSIDE] = palette.special("plastic_dark", "undertray", interior_K=heat.tray_K)
        rows[:, EXHAUST] = palette.special("steel_oxidised", "exhaust", interior_K=heat.exhaust_K)
    else:
        rows[:, BONNET] = rows[:, PAINT]
        rows[:, TYRE] = palette.only("tyre_rubber")
        rows[:, WHEEL] = rows[:, EXHAUST] = palette.variants("steel_oxidised", 1)[0]
        rows[:, UNDERSIDE] = palette.variants("plastic_dark", 2)[0]
    glass = palette.only("vehicle_glass")
    if driven and kind == "bus":
        glass = palette.special("vehicle_glass", "bus", interior_K=HEATED_CABIN_K)
    rows[:, GLASS] = glass
    rows[:, CARGO] = np.array(palette.variants("car_paint_white", _VARIANTS))[
        rng.integers(_VARIANTS, size=count)
    ]
    return rows


class _Heat:
    """Temperatures behind the warm parts; the same number of draws whether driven or not."""

    def __init__(self, driven: bool, rng: np.random.Generator) -> None:
        ranges = (ENGINE_BAY_K, EXHAUST_K, BRAKES_K, UNDERTRAY_K, TYRE_Wm2)
        draws = [float(rng.uniform(*r)) for r in ranges]
        self.engine_K, self.exhaust_K, self.brakes_K, self.tray_K, self.tyre_Wm2 = draws
        self.driven = driven
