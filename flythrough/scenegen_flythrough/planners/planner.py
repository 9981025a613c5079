"""What a planner is: depth images and memories in, commands out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float32

from scenegen_flythrough.loop.pilot import Command, Observation

Memory = Any
"""Whatever one planner keeps of one flight."""


@runtime_checkable
class Planner(Protocol):
    """Turns depth into commands. Everything it remembers of a flight lies in that flight's memory."""

    @property
    def name(self) -> str:
        """What users write."""
        ...

    def memory(self) -> Memory:
        """A fresh memory for one flight; the planner alone knows what is in it."""
        ...

    def plan(
        self, depth_m: Float32[np.ndarray, "n rows columns"], seen: Observation, memory: Sequence[Memory]
    ) -> Command:
        """One decision for each flight.

        Parameters
        ----------
        depth_m : float32 (n, rows, columns)
            Planar depth [m] as far as the pilot knows it; +inf where there is nothing.
        seen : Observation
        memory : sequence of memories
            Row by row; changed in place.
        """
        ...
