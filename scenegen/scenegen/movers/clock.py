"""The time of a world during a clip."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

_LONGEST_S = 3600.0


@dataclass(frozen=True)
class Clock:
    """From the time of a clip, zero at its first stored frame, to the time of its world.

    Attributes
    ----------
    start_s : float
        World time when the clip begins [s].
    running : bool
        False freezes the world.
    """

    start_s: float = 0.0
    running: bool = True

    @staticmethod
    def draw(rng: np.random.Generator) -> Clock:
        """A clip that begins at any moment of an hour."""
        return Clock(float(rng.uniform(0.0, _LONGEST_S)))

    @staticmethod
    def stopped() -> Clock:
        """A world that stands as it is at time zero, in all its clips."""
        return Clock(0.0, running=False)

    def at(self, time_s: Float64[np.ndarray, "times"]) -> Float64[np.ndarray, "times"]:
        """World times of times of the clip [s]."""
        return np.asarray(self.start_s + (1.0 if self.running else 0.0) * time_s)
