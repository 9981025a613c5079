"""How a flight ended."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float64

End = Literal["goal", "collision", "timeout", "pilot"]
"""Reached its goal; touched something; ran out of time; its pilot failed."""


@dataclass(frozen=True, eq=False)
class Outcome:
    """One flight, flown.

    Attributes
    ----------
    flight : int
        Id of the flight.
    kind : "goal", "collision", "timeout" or "pilot"
    time_s : float
        When it ended, since its start.
    place_m : (float, float, float)
        Where the middle of the drone was then.
    object, semantic : int
        What was touched: instance id and class; 0 if nothing was.
    class_name : str
        Name of that class, lower case; empty if nothing was touched.
    progress : float
        Share 0..1 of the way from start to goal that was gained: 1 - distance left / distance at the start, at best.
    mean_speed_mps : float
        Way flown over time.
    closest_m : float
        Least distance of the drone's middle to anything [m], looked at every 50 ms and up to 3 m; +inf beyond.
    latency_s : float
        Mean delay between frame and command.
    decisions : int
        How often the pilot was asked.
    path : float64 (k, 4)
        Time [s] and place [m] at the start, after every decision period, and at the end.
    reason : str
        Why a pilot failed; empty otherwise.
    """

    flight: int
    kind: End
    time_s: float
    place_m: tuple[float, float, float]
    object: int
    semantic: int
    class_name: str
    progress: float
    mean_speed_mps: float
    closest_m: float
    latency_s: float
    decisions: int
    path: Float64[np.ndarray, "k 4"]
    reason: str
