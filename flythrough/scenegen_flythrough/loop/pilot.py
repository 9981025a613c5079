"""What a pilot is given and what it answers.

A pilot flies any number of flights at once. Rows of all arrays belong to the flights named by `Observation.flight`;
flights that have ended are no longer among them, so a pilot that remembers anything keeps it by flight id.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float32, Float64, Int64, UInt16

from scenegen_render.camera import Camera

Need = Literal["depth", "thermal"]
"""What a pilot must be shown: true planar depth, or the counts of a thermal camera."""


@dataclass(frozen=True, eq=False)
class Observation:
    """What the drones of a batch know at one instant.

    Attributes
    ----------
    flight : int64 (n,)
        Ids of the flights, increasing.
    time_s : float
        Since the start of all flights.
    position_m, velocity_mps : float64 (n, 3)
        World frame.
    yaw_rad : float64 (n,)
        Heading, counter-clockwise from east.
    goal_m : float64 (n, 3)
    ceiling_m : float64 (n,)
        Height in the world (z) a flight may not climb above [m].
    camera : Camera
    world_from_camera : float64 (n, 4, 4)
        At this instant.
    counts, previous_counts : uint16 (n, rows, columns) or None
        Thermal frames of this decision and of the one before; the first is its own predecessor.
    depth_m : float32 (n, rows, columns) or None
        True planar depth, +inf where the sky is; only for pilots that need it.
    """

    flight: Int64[np.ndarray, "n"]
    time_s: float
    position_m: Float64[np.ndarray, "n 3"]
    velocity_mps: Float64[np.ndarray, "n 3"]
    yaw_rad: Float64[np.ndarray, "n"]
    goal_m: Float64[np.ndarray, "n 3"]
    ceiling_m: Float64[np.ndarray, "n"]
    camera: Camera
    world_from_camera: Float64[np.ndarray, "n 4 4"]
    counts: UInt16[np.ndarray, "n rows columns"] | None = None
    previous_counts: UInt16[np.ndarray, "n rows columns"] | None = None
    depth_m: Float32[np.ndarray, "n rows columns"] | None = None

    def rows(self, index: Int64[np.ndarray, "m"]) -> Observation:
        """The same for some of the flights."""
        return Observation(
            flight=self.flight[index],
            time_s=self.time_s,
            position_m=self.position_m[index],
            velocity_mps=self.velocity_mps[index],
            yaw_rad=self.yaw_rad[index],
            goal_m=self.goal_m[index],
            ceiling_m=self.ceiling_m[index],
            camera=self.camera,
            world_from_camera=self.world_from_camera[index],
            counts=None if self.counts is None else self.counts[index],
            previous_counts=None if self.previous_counts is None else self.previous_counts[index],
            depth_m=None if self.depth_m is None else self.depth_m[index],
        )


@dataclass(frozen=True, eq=False)
class Command:
    """What drones are told to do until the next command.

    Attributes
    ----------
    velocity_mps : float64 (n, 3)
        Wanted velocity in the world frame.
    yaw_rad : float64 (n,)
        Wanted heading.
    """

    velocity_mps: Float64[np.ndarray, "n 3"]
    yaw_rad: Float64[np.ndarray, "n"]


@dataclass(frozen=True, eq=False)
class Decision:
    """A pilot's answer.

    Attributes
    ----------
    command : Command
    depth_m : float32 (n, rows, columns) or None
        What the pilot took for the depth, for replays.
    latency_s : float64 (n,) or None
        How long the pilot says it took; None leaves it to the arena.
    """

    command: Command
    depth_m: Float32[np.ndarray, "n rows columns"] | None = None
    latency_s: Float64[np.ndarray, "n"] | None = None


@runtime_checkable
class Pilot(Protocol):
    """Flies drones by what they see."""

    @property
    def name(self) -> str:
        """What results are filed under."""
        ...

    @property
    def needs(self) -> frozenset[Need]:
        """What it must be shown."""
        ...

    def begin(self, flights: Int64[np.ndarray, "n"], seed: int) -> None:
        """New flights start: forget everything, and be ready for these ids."""
        ...

    def act(self, seen: Observation) -> Decision:
        """Answer to what is seen, row by row."""
        ...
