"""Paths and crash sites of one pilot over the map of one world, as SVG."""

from __future__ import annotations

import base64
from collections.abc import Sequence

import numpy as np
from shapely.geometry import LineString

from scenegen.foundation.words import counted
from scenegen_datasets.pages.markup import Html, text
from scenegen_trainers.campaign.record import FlightRecord
from scenegen_trainers.campaign.report.ink import END_COLOUR, END_WORDS
from scenegen_trainers.campaign.report.plan_view import SIDE_PX, Frame

_SIMPLER_PX = 0.5
_ORDER = ("goal", "timeout", "pilot", "collision")  # crashes are drawn last, on top


def plan_svg(picture_id: str, frame: Frame, flights: Sequence[FlightRecord]) -> Html:
    """Draw flights over the picture that is defined once on the page under an id.

    Parameters
    ----------
    picture_id : str
    frame : Frame
    flights : sequence of FlightRecord
        All of one world.
    """
    drawn = sorted(flights, key=lambda flight: _ORDER.index(flight.kind))
    parts = [_flight(frame, flight) for flight in drawn]
    crashed = sum(flight.kind == "collision" for flight in flights)
    words = f"map of {picture_id} with the paths of {counted(len(flights), 'flight')}, {crashed} of which collided"
    return Html(
        f'<svg viewBox="0 0 {SIDE_PX} {SIDE_PX}" class="plan" role="img" aria-label="{text(words)}">'
        f'<use href="#{picture_id}"/>'
        f"{''.join(parts)}{_scale_bar(frame)}</svg>"
    )


def picture_definition(picture_id: str, webp: bytes) -> str:
    """The map itself, to be used by any number of plans."""
    data = base64.b64encode(webp).decode("ascii")
    return f'<image id="{picture_id}" width="{SIDE_PX}" height="{SIDE_PX}" href="data:image/webp;base64,{data}"/>'


def _flight(frame: Frame, flight: FlightRecord) -> str:
    """Path, start, goal, and a cross where it crashed; the facts appear under the pointer."""
    places = np.array([row[1:] for row in flight.path] or [flight.start_m], np.float64)
    way = frame.to_pixels(places)
    colour = END_COLOUR[flight.kind]
    start, goal = frame.to_pixels(np.array([flight.start_m, flight.goal_m]))
    end = frame.to_pixels(np.array([flight.place_m]))[0]
    left = f"M{end[0]:.1f} {end[1]:.1f}L{goal[0]:.1f} {goal[1]:.1f}" if flight.kind != "goal" else ""
    marks = [
        f'<path d="{left}" class="left" stroke="{colour}"/>' if left else "",
        f'<path d="{_path(way)}" stroke="{colour}"/>',
        f'<circle cx="{start[0]:.1f}" cy="{start[1]:.1f}" r="2.6" fill="{colour}"/>',
        f'<circle cx="{goal[0]:.1f}" cy="{goal[1]:.1f}" r="4" class="ring" stroke="{colour}"/>',
    ]
    if flight.kind == "collision":
        marks.append(_cross(end[0], end[1]))
    elif flight.kind != "goal":
        marks.append(
            f'<rect x="{end[0] - 4:.1f}" y="{end[1] - 4:.1f}" width="8" height="8" fill="{colour}"/>'
        )
    return f'<g class="flight {flight.kind}"><title>{text(_facts(flight))}</title>{"".join(marks)}</g>'


def _facts(flight: FlightRecord) -> str:
    what = f" with {flight.what.replace('_', ' ')}" if flight.what else ""
    why = f" ({flight.reason})" if flight.reason else ""
    return (
        f"flight {flight.flight}: {END_WORDS[flight.kind]}{what}{why} after {flight.time_s:.1f} s, "
        f"{flight.mean_speed_mps:.1f} m/s, {100 * flight.progress:.0f} % of the way"
    )


def _path(way: np.ndarray) -> str:
    if len(way) > 2:
        way = np.asarray(LineString(way).simplify(_SIMPLER_PX).coords)
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in way)


def _cross(x: float, y: float) -> str:
    arms = f"M{x - 6:.1f} {y - 6:.1f}l12 12m0-12l-12 12"
    return f'<path d="{arms}" class="halo"/><path d="{arms}" class="cross"/>'


def _scale_bar(frame: Frame) -> str:
    """A bar of a round length near a fifth of the map."""
    wanted = 0.2 * SIDE_PX * frame.metres_per_px()
    length = max((s for s in (10, 20, 50, 100, 200, 500, 1000, 2000) if s <= wanted), default=10)
    px = length / frame.metres_per_px()
    x, y = 24.0, SIDE_PX - 24.0
    return (
        f'<g class="scale"><path d="M{x} {y - 6}v6h{px:.1f}v-6"/>'
        f'<text x="{x + px / 2:.1f}" y="{y - 12}">{length} m</text></g>'
    )
