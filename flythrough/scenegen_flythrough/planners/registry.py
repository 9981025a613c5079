"""Planners by name, and those of others by ``module:attribute``."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from scenegen.foundation.errors import InputError, nearest
from scenegen_flythrough.loop.knobs import LoopKnobs
from scenegen_flythrough.planners.five_section import FiveSection
from scenegen_flythrough.planners.planner import Planner
from scenegen_flythrough.planners.straight import Straight
from scenegen_flythrough.planners.waypoint import Waypoint

Maker = Callable[[LoopKnobs], Planner]


@dataclass(frozen=True)
class PlannerFamily:
    """A planner users can ask for.

    Attributes
    ----------
    name, description : str
    make : callable
        From the knobs of the loop (radius, cruise speed, limits) to the planner.
    """

    name: str
    description: str
    make: Maker


_FAMILIES = (
    PlannerFamily(
        "five_section",
        "towards the furthest of five bands of the image, as AirSim's navigate.py",
        lambda knobs: FiveSection(knobs.cruise_mps),
    ),
    PlannerFamily("waypoint", "goal-directed by the depth map; brakes within what it sees", Waypoint),
    PlannerFamily(
        "straight", "heads for the goal whatever it sees", lambda knobs: Straight(knobs.cruise_mps)
    ),
)

PLANNERS: Mapping[str, PlannerFamily] = MappingProxyType({family.name: family for family in _FAMILIES})
"""All planners by name."""


def planner(name: str, knobs: LoopKnobs) -> Planner:
    """Make a planner.

    Parameters
    ----------
    name : str
        One of `PLANNERS`, or ``module:attribute`` of a callable that takes `LoopKnobs` and returns a planner.
    knobs : LoopKnobs

    Raises
    ------
    InputError
        There is none of this name, or what the module offers is no planner.
    """
    if ":" in name:
        made = plugged_in(name, "planner")(knobs)
        if not isinstance(made, Planner):
            raise InputError(f"'{name}' made no planner: it needs a name, memory() and plan()")
        return made
    if name not in PLANNERS:
        raise InputError(f"unknown planner '{name}'{nearest(name, PLANNERS)}; or give module:attribute")
    return PLANNERS[name].make(knobs)


def plugged_in(name: str, what: str) -> Callable[..., object]:
    """What stands behind ``module:attribute``.

    Raises
    ------
    InputError
        The module cannot be imported, or has no such callable.
    """
    module, _, attribute = name.partition(":")
    try:
        found = getattr(importlib.import_module(module), attribute)
    except ImportError as error:
        raise InputError(
            f"{what} '{name}': cannot import '{module}' ({error}); is it on PYTHONPATH?"
        ) from error
    except AttributeError:
        raise InputError(f"{what} '{name}': module '{module}' has no '{attribute}'") from None
    if not callable(found):
        raise InputError(f"{what} '{name}': '{attribute}' is a {type(found).__name__}, not something to call")
    return found  # type: ignore[no-any-return]
