"""Who flies which style."""

from __future__ import annotations

from scenegen_flythrough.knobs import STYLES
from scenegen_flythrough.styles.approach import Approach
from scenegen_flythrough.styles.corridor import Corridor
from scenegen_flythrough.styles.explore import Explore
from scenegen_flythrough.styles.orbit import Orbit
from scenegen_flythrough.styles.survey import Survey
from scenegen_flythrough.styles.task import Style
from scenegen_flythrough.styles.terrain_follow import TerrainFollow
from scenegen_flythrough.styles.waypoints import Waypoints

DRAWN: dict[str, Style] = {
    "explore": Explore(),
    "corridor": Corridor(),
    "survey": Survey(),
    "orbit": Orbit(),
    "terrain_follow": TerrainFollow(),
    "waypoints": Waypoints(),
    "approach": Approach(),
}
"""Styles that draw routes; `recorded` plays a file instead."""

assert {*DRAWN, "recorded"} == set(STYLES)
