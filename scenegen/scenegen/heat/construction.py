"""What lies behind a visible surface: layers and inner boundary for each kind of build.

Layer data: ASHRAE 2005 Handbook of Fundamentals (insulation I01-I03, gypsum G01, plywood-like decks), ordinary values
for moist subsoil. Only the first 10-20 cm matter for a daily cycle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from scenegen.heat.conduction import Layer, Stack
from scenegen.materials.material import Build, Surface

ROOM_K = 295.15
"""Heated room behind walls, roofs and windows unless the surface says otherwise."""
BODY_CORE_K = 310.15

_SUBSOIL = Layer(1.0, 1800.0, 1200.0, math.inf)
_GRASS_SOIL = Layer(1.0, 1700.0, 1400.0, math.inf)
_INSULATION = Layer(0.04, 43.0, 1210.0, 0.08)
_PLASTER = Layer(0.16, 800.0, 1090.0, 0.0127)
_DECK = Layer(0.12, 540.0, 1210.0, 0.019)
_LINING = Layer(0.06, 60.0, 1200.0, 0.02)
_PANE_GAP = Layer(0.1, 1.2, 1005.0, 0.016)
_ROOM_SIDE_Wm2K = 7.7
# The air below roof tiles is stirred but sun-warmed itself: its coupling to the outdoor air is weak.
_GAP_SIDE_Wm2K = 0.5
_CABIN_SIDE_Wm2K = 7.7
_TISSUE_Wm2K = 12.0


@dataclass(frozen=True)
class Construction:
    """Layers behind a surface and the temperature of the space they end in.

    Attributes
    ----------
    stack : Stack
    inner_K : float
        Temperature of the inner space [K]; NaN where it follows the outdoor air (or where there is none).
    """

    stack: Stack
    inner_K: float


def construction(surface: Surface) -> Construction:
    """Construction of a palette entry by the build of its material."""
    m = surface.material
    skin = Layer(m.conductivity_WmK, m.density_kgm3, m.heat_capacity_JkgK, m.thickness_m)
    room = surface.interior_K if math.isfinite(surface.interior_K) else ROOM_K
    endless = math.inf
    match m.build:
        case Build.GROUND:
            return Construction(Stack((skin, _SUBSOIL), endless), math.nan)
        case Build.CANOPY_GROUND:
            return Construction(Stack((skin, _GRASS_SOIL), endless), math.nan)
        case Build.WALL_INSULATED:
            return Construction(Stack((skin, _INSULATION, _PLASTER), _ROOM_SIDE_Wm2K), room)
        case Build.ROOF_INSULATED:
            return Construction(Stack((skin, _INSULATION, _DECK), _ROOM_SIDE_Wm2K), room)
        case Build.ROOF_VENTILATED:
            return Construction(Stack((skin,), _GAP_SIDE_Wm2K), surface.interior_K)
        case Build.WINDOW:
            return Construction(Stack((skin, _PANE_GAP, skin), _ROOM_SIDE_Wm2K), room)
        case Build.VEHICLE:
            return Construction(Stack((skin, _LINING), _CABIN_SIDE_Wm2K), surface.interior_K)
        case Build.HUMAN:
            return Construction(Stack((skin,), _TISSUE_Wm2K), BODY_CORE_K)
        case Build.PANEL | Build.LEAF | Build.SOLID:
            return Construction(Stack((skin,), 0.0), math.nan)
        case Build.WATER:
            return Construction(Stack((skin,), 0.0), math.nan)
