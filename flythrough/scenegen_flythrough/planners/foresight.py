"""Where drones would go if they were told something once and then told to stop: the drone's own dynamics, run ahead."""

from __future__ import annotations

import math

import numpy as np
from jaxtyping import Float64

from scenegen_flythrough.loop.drone import DroneState, advance
from scenegen_flythrough.loop.knobs import LoopKnobs
from scenegen_flythrough.loop.pilot import Command

_STEP_S = 0.1
_SETTLE_S = 0.6
"""Longer than braking alone: the controller's lag."""


def then_stop(
    position_m: Float64[np.ndarray, "n 3"],
    velocity_mps: Float64[np.ndarray, "n 3"],
    before_mps: Float64[np.ndarray, "n 3"],
    told_mps: Float64[np.ndarray, "n 3"],
    knobs: LoopKnobs,
) -> Float64[np.ndarray, "n steps 3"]:
    """Places of drones that keep their old command for the latency, obey a new one for a period, then brake to a stop.

    Parameters
    ----------
    position_m, velocity_mps : float64 (n, 3)
        Now, in still air.
    before_mps : float64 (n, 3)
        What they were told before.
    told_mps : float64 (n, 3)
        What they would be told now.
    knobs : LoopKnobs
    """
    latency_s = knobs.latency_ms / 1e3
    # The next command, which may be to stop, comes into force a period later; a slow pilot's period is its latency.
    until_s = latency_s + max(knobs.decision_s, latency_s)
    fastest = float(max(np.linalg.norm(velocity_mps, axis=1).max(), np.linalg.norm(told_mps, axis=1).max()))
    stopped_s = until_s + fastest / knobs.drone.acceleration_mps2 + _SETTLE_S
    yaw = np.zeros(len(position_m))
    state = DroneState(position_m, velocity_mps, np.zeros_like(velocity_mps), yaw, 0.0)
    calm = np.zeros_like(position_m)
    places = []
    for k in range(math.ceil(stopped_s / _STEP_S)):
        time_s = (k + 0.5) * _STEP_S
        told = before_mps if time_s < latency_s else told_mps if time_s < until_s else calm
        state = advance(state, Command(told, yaw), knobs.drone, calm, _STEP_S)
        places.append(state.position_m)
    return np.stack(places, axis=1)


def stopping_speed(way_m: Float64[np.ndarray, "*n"], knobs: LoopKnobs) -> Float64[np.ndarray, "*n"]:
    """Speed from which a drone that is told to stop at its next decision comes to rest within a way.

    Solves ``v^2 / 2a + v t = way`` with the time until the brakes bite.
    """
    a = knobs.drone.acceleration_mps2
    late = knobs.latency_ms / 1e3 + max(knobs.decision_s, knobs.latency_ms / 1e3) + 0.5 * _SETTLE_S
    return np.asarray(-a * late + np.sqrt((a * late) ** 2 + 2.0 * a * np.maximum(way_m, 0.0)))
