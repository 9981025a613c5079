"""Pilots put together: a source of depth and a planner. Truth (oracle) and a constant (blind) are the two ends."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float32, Int64

from scenegen_flythrough.loop.pilot import Decision, Need, Observation
from scenegen_flythrough.planners.planner import Memory, Planner

BLIND_DEPTH_M = 100.0
"""What the blind pilot takes every pixel for: nothing near, anywhere."""


@runtime_checkable
class DepthSource(Protocol):
    """Where a pilot's depth comes from."""

    @property
    def name(self) -> str:
        """What results are filed under."""
        ...

    @property
    def needs(self) -> frozenset[Need]:
        """What it must be shown."""
        ...

    def estimate(self, seen: Observation) -> Float32[np.ndarray, "n rows columns"]:
        """Planar depth [m] of every pixel, +inf where nothing is."""
        ...


@dataclass(frozen=True)
class TrueDepth:
    """The depth itself: what an oracle flies by."""

    name: str = "oracle"
    needs: frozenset[Need] = frozenset({"depth"})

    def estimate(self, seen: Observation) -> Float32[np.ndarray, "n rows columns"]:
        """Hand the truth through."""
        if seen.depth_m is None:
            raise ValueError("the oracle was shown no depth")
        return seen.depth_m


@dataclass(frozen=True)
class ConstantDepth:
    """The same depth everywhere and always: a pilot with its eyes shut."""

    depth_m: float = BLIND_DEPTH_M
    name: str = "blind"
    needs: frozenset[Need] = frozenset()

    def estimate(self, seen: Observation) -> Float32[np.ndarray, "n rows columns"]:
        """Fill the image."""
        shape = (len(seen.flight), seen.camera.height_px, seen.camera.width_px)
        return np.full(shape, self.depth_m, np.float32)


@dataclass(eq=False)
class DepthPilot:
    """A planner that flies by what a source of depth says."""

    source: DepthSource
    planner: Planner
    _memory: dict[int, Memory] = field(default_factory=dict, repr=False)

    @property
    def name(self) -> str:
        """Of the source: planners are compared with the planner held fixed."""
        return self.source.name

    @property
    def needs(self) -> frozenset[Need]:
        """Of the source."""
        return self.source.needs

    def begin(self, flights: Int64[np.ndarray, "n"], seed: int) -> None:
        """Empty memories."""
        self._memory = {int(flight): self.planner.memory() for flight in flights}
        start = getattr(self.source, "begin", None)
        if start is not None:
            start(flights, seed)

    def act(self, seen: Observation) -> Decision:
        """Estimate, then plan."""
        depth = self.source.estimate(seen)
        shape = (len(seen.flight), seen.camera.height_px, seen.camera.width_px)
        if depth.shape != shape:
            raise ValueError(f"depth of shape {depth.shape} instead of {shape}")
        memory = [self._memory[int(flight)] for flight in seen.flight]
        return Decision(self.planner.plan(depth, seen, memory), depth)
