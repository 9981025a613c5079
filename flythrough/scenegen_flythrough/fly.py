"""One flight through a world: drawn by its style, flown by a quadrotor in the wind, proven against the exact mesh."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from jaxtyping import Float64

from scenegen.foundation.errors import InputError, RejectedDrawError
from scenegen.movers.clock import Clock
from scenegen.world import World
from scenegen_flythrough.airspace import Airspace
from scenegen_flythrough.flown import Flown, trajectory
from scenegen_flythrough.knobs import FlightKnobs
from scenegen_flythrough.proof import REASONS, in_range
from scenegen_flythrough.quadrotor.curve import Curve
from scenegen_flythrough.quadrotor.pilotage import Wind, pilot
from scenegen_flythrough.route import Route
from scenegen_flythrough.styles.recorded import Recorded
from scenegen_flythrough.styles.registry import DRAWN
from scenegen_flythrough.styles.task import Task, between
from scenegen_flythrough.trajectory import Trajectory

_PROVEN_TOGETHER = 4
_PATIENCE = 256
"""Draws of one style before the next one of the recipe is tried."""
_FROM_ZERO = Clock()


def fly(
    world: World,
    knobs: FlightKnobs,
    frames: int,
    rng: np.random.Generator,
    airspace: Airspace,
    clock: Clock = _FROM_ZERO,
) -> Trajectory:
    """Draw a smooth collision-free flight that a quadrotor can fly.

    The style is drawn first, then speed, height and camera angle, and many paths are tried with them before they are
    drawn anew, so that low flights between houses are as likely as the easy ones above the roofs. After 256 draws in
    vain the next style has its turn.

    Parameters
    ----------
    world : World
    knobs : FlightKnobs
    frames : int
        Frames to be stored; the trajectory has one pose more at both ends.
    rng : numpy.random.Generator
        This flight's own generator.
    airspace : Airspace
        Of the same world.
    clock : Clock
        World time of the clip: where the movers are meanwhile.

    Returns
    -------
    Trajectory
        A sphere of radius `knobs.clearance_m` moved along its way touches nothing, no mover's box comes closer either,
        and at least one place is connected to the open sky, so that none lies inside anything. At no instant does it
        exceed `knobs.limits`.

    Raises
    ------
    RejectedDrawError
        `knobs.max_draws` paths were rejected.
    InputError
        A recording cannot be flown as it is.
    """
    if frames < 1:
        raise InputError(f"a clip needs at least one frame, not {frames}; raise the number of frames")
    if airspace.world is not world:
        raise AssertionError("the airspace belongs to another world")
    (order_rng,) = rng.spawn(1)
    entries = [knobs.styles[k] for k in order_rng.permutation(len(knobs.styles))]
    search = _Search(airspace, knobs, frames, clock)
    styles = list(dict.fromkeys(entries))
    turn = 0
    while search.left > 0:
        style, tried = styles[turn % len(styles)], search.rejected
        turn += 1
        while search.left > 0 and search.rejected - tried < _PATIENCE:
            (round_rng,) = rng.spawn(1)
            found = search.once(style, round_rng)
            if found is not None:
                return found
    raise RejectedDrawError(search.given_up())


class _Search:
    """Looks for one flight and counts what it turns down."""

    def __init__(self, airspace: Airspace, knobs: FlightKnobs, frames: int, clock: Clock) -> None:
        self._airspace, self._knobs, self._frames, self._clock = airspace, knobs, frames, clock
        lead_m = 0.5 * knobs.speed_mps[1] + 8.0  # where routes begin and run out
        self._task = Task(airspace, knobs, (frames + 1) * knobs.spacing_m + lead_m)
        self._why: Counter[str] = Counter()

    @property
    def rejected(self) -> int:
        """Draws so far."""
        return self._why.total()

    @property
    def left(self) -> int:
        """Draws that are still allowed."""
        return self._knobs.max_draws - self.rejected

    def once(self, style: str, rng: np.random.Generator) -> Trajectory | None:
        """All draws of one intent; the first that holds everything."""
        draw_rng, wind_rng, flown_rng = rng.spawn(3)
        if style == "recorded":
            candidates = self._recorded(draw_rng)
        else:
            wind_mps = between(self._knobs.wind_mps, wind_rng)
            candidates = self._drawn(style, wind_mps, draw_rng)
        for flown in candidates:
            made = trajectory(self._airspace, self._knobs, self._frames, flown, self._clock, flown_rng)
            if isinstance(made, str):
                self._why[made] += 1
                if self.left <= 0:
                    return None
                continue
            reasons = tuple(sorted((key, n) for key, n in self._why.items() if n))
            return replace(made, style=style, rejected=self.rejected, rejections=reasons)
        return None

    def _drawn(self, style: str, wind_mps: float, rng: np.random.Generator) -> Iterator[Flown]:
        """Motions of a style's routes, those left out that reach something already as drawn."""
        draw_rng, gust_rng = rng.spawn(2)
        for batch in DRAWN[style].draw(self._task, draw_rng):
            self._why["hopeless"] += min(batch.hopeless, self.left)
            routes = batch.routes[: self.left]
            rngs = gust_rng.spawn(len(routes))
            for first in range(0, len(routes), _PROVEN_TOGETHER):
                group = routes[first : first + _PROVEN_TOGETHER]
                for k, why in enumerate(self._objections(group)):
                    if why is not None:
                        self._why[why] += 1
                        continue
                    flown = self._piloted(group[k], wind_mps, rngs[first + k])
                    if flown is not None:
                        yield flown
            if self.left <= 0:
                return

    def _piloted(self, route: Route, wind_mps: float, rng: np.random.Generator) -> Flown | None:
        knobs, middle = self._knobs, route.points.mean(axis=0)
        height_m = float(middle[2] - self._airspace.world.ground.at(middle[None, :2])[0])
        wind_rng, gust_rng = rng.spawn(2)
        wind = Wind.draw(wind_mps, height_m, wind_rng)
        motion = pilot(route, wind, knobs.limits, knobs.bank_deg, gust_rng)
        if motion is None:
            self._why["limits"] += 1
            return None
        mean = float(wind.mean_mps[0]), float(wind.mean_mps[1])
        return Flown(motion, route.pitch_deg, _lead_m(route), route.at_end, mean)

    def _objections(self, routes: list[Route]) -> list[str | None]:
        """Why routes cannot be flown as drawn, if so; what the wind does to them is proven later."""
        places = [self._shown(route) for route in routes]
        inside = [bool(in_range(self._airspace, self._knobs, place[None])[0]) for place in places]
        why: list[str | None] = [None if good else "outside" for good in inside]
        kept = np.flatnonzero(inside)
        if len(kept) > 0:
            starts = np.concatenate([places[k][:-1] for k in kept])
            ends = np.concatenate([places[k][1:] for k in kept])
            owner = np.repeat(kept, [len(places[k]) - 1 for k in kept])
            touches = self._airspace.proximity.sweep(starts, ends, self._knobs.clearance_m).touches
            for k in np.unique(owner[touches]).tolist():
                why[k] = "blocked"
        return why

    def _shown(self, route: Route) -> Float64[np.ndarray, "places 3"]:
        """Places along what the clip surely shows of a route: not its ends, where the motion begins and runs out."""
        curve = Curve.of(route.points)
        need_m, lead_m = (self._frames + 1) * self._knobs.spacing_m, _lead_m(route)
        ends_m = lead_m + 0.2 * route.speed_mps
        low = curve.length_m - lead_m - need_m if route.at_end else ends_m
        high = curve.length_m - ends_m if route.at_end else lead_m + need_m
        s = np.linspace(max(low, 0.0), max(min(high, curve.length_m), low), max(math.ceil(need_m), 2))
        return curve.spline.at(np.clip(curve.index_at(s), 0.0, curve.u[-1]))

    def _recorded(self, rng: np.random.Generator) -> Iterator[Flown]:
        for flown in Recorded.of(self._knobs).draw(self._task, self._frames, rng):
            if isinstance(flown, str):
                self._why[flown] += 1
            else:
                yield flown
            if self.left <= 0:
                return

    def given_up(self) -> str:
        """One line: what was looked for, and why nothing was found."""
        knobs = self._knobs
        length = math.ceil((self._frames + 1) * knobs.spacing_m)
        reasons = ", ".join(f"{n} {REASONS[key]}" for key, n in self._why.most_common() if n)
        if set(knobs.styles) == {"recorded"}:
            return (
                f"{knobs.recorded.file}: no stretch of {length} m of this recording can be flown in this "
                f"{self._airspace.world.map} world ({reasons}); move it, or try recorded.place anywhere"
            )
        return (
            f"no free flight of {length} m in this {self._airspace.world.map} world after {self.rejected} draws "
            f"({reasons}); ask for a shorter clip, less clearance, other heights, a slower speed or other styles"
        )


def _lead_m(route: Route) -> float:
    """Way before the clip: ends of routes run on straight, so a bend would begin there with a jolt."""
    if route.at_end:
        return 0.0
    return 2.5 * float(np.linalg.norm(route.points[1] - route.points[0]))
