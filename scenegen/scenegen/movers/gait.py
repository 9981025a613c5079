"""How a body walks: its vertices through one cycle of the step, played along the way it has travelled."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Float64, Int64


@dataclass(frozen=True, eq=False)
class Gait:
    """A cycle of the step of one body.

    Attributes
    ----------
    stride_m : float
        Way travelled in a cycle: two steps [m].
    cycle : float32 (phases, vertices, 3)
        Vertices at even phases of the cycle, in the body's own frame [m]. All bodies of a world have as many phases.
    """

    stride_m: float
    cycle: Float32[np.ndarray, "phases vertices 3"]

    def after(self, travelled_m: float) -> Float64[np.ndarray, "vertices 3"]:
        """Vertices in the body's own frame after so much way [m]; the same as `Walkers.step`, for one body."""
        phases = len(self.cycle)
        phase = np.float64(travelled_m) / self.stride_m % 1.0 * phases
        k = min(int(phase), phases - 1)
        before, after = self.cycle[k], self.cycle[(k + 1) % phases]
        return np.asarray(before + (phase - k) * (after - before))


@dataclass(frozen=True, eq=False)
class Walkers:
    """The gaits of many bodies together.

    Attributes
    ----------
    vertex : int64 (limbs,)
        Their vertices among those of the whole company.
    body : int64 (limbs,)
        Index of the gait each belongs to.
    stride_m : float64 (gaits,)
    cycle : float32 (phases, limbs, 3)
    """

    vertex: Int64[np.ndarray, "limbs"]
    body: Int64[np.ndarray, "limbs"]
    stride_m: Float64[np.ndarray, "gaits"]
    cycle: Float32[np.ndarray, "phases limbs 3"]

    @staticmethod
    def of(gaits: Sequence[Gait], first_vertex: Sequence[int]) -> Walkers:
        """Collect gaits; `first_vertex` is where each body begins in the company."""
        counts = [g.cycle.shape[1] for g in gaits]
        vertex = [first + np.arange(n) for first, n in zip(first_vertex, counts, strict=True)]
        nothing = np.zeros((gaits[0].cycle.shape[0] if gaits else 1, 0, 3), np.float32)
        return Walkers(
            vertex=np.concatenate([np.zeros(0, np.int64), *vertex]),
            body=np.repeat(np.arange(len(gaits)), counts),
            stride_m=np.array([g.stride_m for g in gaits], np.float64),
            cycle=np.concatenate([nothing, *(g.cycle for g in gaits)], axis=1),
        )

    def step(self, travelled_m: Float64[np.ndarray, "gaits"]) -> Float64[np.ndarray, "limbs 3"]:
        """Vertices in their own frames after so much way [m], linear between phases."""
        phases, limbs = self.cycle.shape[:2]
        phase = travelled_m / self.stride_m % 1.0 * phases
        k = np.minimum(phase.astype(np.int64), phases - 1)
        share = (phase - k)[self.body, None]
        flat, column = self.cycle.reshape(-1, 3), np.arange(limbs)
        before = flat[k[self.body] * limbs + column]
        after = flat[((k + 1) % phases)[self.body] * limbs + column]
        return np.asarray(before + share * (after - before))
