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
# Fan-stirred air under a bonnet, or exhaust gas in a pipe, against bare metal.
_ENGINE_SIDE_Wm2K = 10.0
_TISSUE_Wm2K = 12.0


@dataclass(frozen=True)
class Construction:
    """Layers behind a surface and the temperature of the space they end in.

    Attributes
    ----------
    stack : Stack
    inner_K : float
        Temperature of the inner space [K]; NaN where it follows the outdoor air (or where there is none).
    released_Wm2 : float
        Heat set free between the last layer and the inner space [W/m^2].
    """

    stack: Stack
    inner_K: float
    released_Wm2: float = 0.0

    @property
    def arriving_Wm2(self) -> float:
        """Part of the released heat that reaches the outer face while that is held at 0 K [W/m^2].

        A constant source between layers of resistance R and a space of coefficient h: ``1 / (1 + h R)`` of it goes
        outwards, the rest to the space. Endless layers release nothing.
        """
        if self.released_Wm2 == 0.0 or self.stack.endless:
            return 0.0
        resistance = sum(layer.thickness_m / layer.conductivity_WmK for layer in self.stack.layers)
        return self.released_Wm2 / (1.0 + self.stack.inner_Wm2K * resistance)


def construction(surface: Surface) -> Construction:
    """Construction of a palette entry by the build of its material."""
    stack, inner_K = _behind(surface)
    return Construction(stack, inner_K, surface.released_Wm2)


def _behind(surface: Surface) -> tuple[Stack, float]:
    """Layers of a palette entry and the temperature they end in [K]."""
    m = surface.material
    skin = Layer(m.conductivity_WmK, m.density_kgm3, m.heat_capacity_JkgK, m.thickness_m)
    inside = math.isfinite(surface.interior_K)
    room = surface.interior_K if inside else ROOM_K
    endless = math.inf
    match m.build:
        case Build.GROUND:
            return Stack((skin, _SUBSOIL), endless), math.nan
        case Build.CANOPY_GROUND:
            return Stack((skin, _GRASS_SOIL), endless), math.nan
        case Build.WALL_INSULATED:
            return Stack((skin, _INSULATION, _PLASTER), _ROOM_SIDE_Wm2K), room
        case Build.ROOF_INSULATED:
            return Stack((skin, _INSULATION, _DECK), _ROOM_SIDE_Wm2K), room
        case Build.ROOF_VENTILATED:
            return Stack((skin,), _GAP_SIDE_Wm2K), surface.interior_K
        case Build.WINDOW:
            return Stack((skin, _PANE_GAP, skin), _ROOM_SIDE_Wm2K), room
        case Build.VEHICLE if inside:  # bare sheet over a running engine: no lining, no cabin
            return Stack((skin,), _ENGINE_SIDE_Wm2K), surface.interior_K
        case Build.VEHICLE:
            return Stack((skin, _LINING), _CABIN_SIDE_Wm2K), math.nan
        case Build.HUMAN:
            return Stack((skin,), _TISSUE_Wm2K), BODY_CORE_K
        case Build.PANEL | Build.SOLID if inside:  # exhaust pipes, engine covers, the heated cabin of a bus
            return Stack((skin,), _ENGINE_SIDE_Wm2K), surface.interior_K
        case Build.PANEL | Build.LEAF | Build.SOLID | Build.WATER:
            return Stack((skin,), 0.0), math.nan
