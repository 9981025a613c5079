"""How a body walks: legs and arms swing about hips and shoulders, knees bend on the way forward."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64


@dataclass(frozen=True, eq=False)
class Gait:
    """Limbs of one body, vertex by vertex, and the length of a stride. All turn about sideways axes.

    Attributes
    ----------
    stride_m : float
        Way travelled in two steps [m].
    leg_m : float
        Height of the hips [m].
    reach_rad : float
        Largest swing of the legs: the hips sink as far as it brings the feet up.
    hinge_m : float64 (vertices,)
        Height of the hip or shoulder a vertex turns about [m].
    swing_rad : float64 (vertices,)
        Largest turn about it, positive where it is forward while the right leg is; 0 for trunk and head.
    knee_m : float64 (vertices,)
        Height of the knee (or elbow) [m].
    bend_rad : float64 (vertices,)
        Largest bend of what hangs below it (feet backwards; forearms forward where negative); 0 above.
    """

    stride_m: float
    leg_m: float
    reach_rad: float
    hinge_m: Float64[np.ndarray, "vertices"]
    swing_rad: Float64[np.ndarray, "vertices"]
    knee_m: Float64[np.ndarray, "vertices"]
    bend_rad: Float64[np.ndarray, "vertices"]


@dataclass(frozen=True, eq=False)
class Walkers:
    """The gaits of many bodies together.

    Attributes
    ----------
    vertex : int64 (limbs,)
        Vertices that swing, among those of the whole company.
    body : int64 (limbs,)
        Index of their gait.
    stride_m, leg_m, reach_rad : float64 (gaits,)
    hinge_m, swing_rad, knee_m, bend_rad : float64 (limbs,)
    """

    vertex: Int64[np.ndarray, "limbs"]
    body: Int64[np.ndarray, "limbs"]
    stride_m: Float64[np.ndarray, "gaits"]
    leg_m: Float64[np.ndarray, "gaits"]
    reach_rad: Float64[np.ndarray, "gaits"]
    hinge_m: Float64[np.ndarray, "limbs"]
    swing_rad: Float64[np.ndarray, "limbs"]
    knee_m: Float64[np.ndarray, "limbs"]
    bend_rad: Float64[np.ndarray, "limbs"]

    @staticmethod
    def of(gaits: Sequence[Gait], first_vertex: Sequence[int]) -> Walkers:
        """Collect gaits; `first_vertex` is where each body begins in the company."""
        moved = [np.flatnonzero(g.swing_rad) for g in gaits]

        def column(name: str) -> Float64[np.ndarray, "limbs"]:
            parts = [getattr(g, name)[m] for g, m in zip(gaits, moved, strict=True)]
            return np.concatenate([np.zeros(0), *parts])

        vertex = [m + first for m, first in zip(moved, first_vertex, strict=True)]
        return Walkers(
            vertex=np.concatenate([np.zeros(0, np.int64), *vertex]),
            body=np.repeat(np.arange(len(gaits)), [len(m) for m in moved]),
            stride_m=np.array([g.stride_m for g in gaits], np.float64),
            leg_m=np.array([g.leg_m for g in gaits], np.float64),
            reach_rad=np.array([g.reach_rad for g in gaits], np.float64),
            hinge_m=column("hinge_m"),
            swing_rad=column("swing_rad"),
            knee_m=column("knee_m"),
            bend_rad=column("bend_rad"),
        )

    def swing(
        self, rest: Float64[np.ndarray, "vertices 3"], travelled_m: Float64[np.ndarray, "gaits"]
    ) -> tuple[Float64[np.ndarray, "vertices 3"], Float64[np.ndarray, "gaits"]]:
        """Vertices in their own frames after so much way, and how far each body sinks so that a foot stands [m].

        The right leg is foremost at a quarter of a stride. The knee of a leg bends while it comes forward.
        """
        phase = 2.0 * np.pi * travelled_m / self.stride_m
        turn, pace = np.sin(phase), np.cos(phase)
        x, z = rest[self.vertex, 0], rest[self.vertex, 2]
        forward = np.maximum(pace[self.body] * np.sign(self.swing_rad), 0.0)
        x, z = _turned(x, z, self.knee_m, -self.bend_rad * forward**2)
        x, z = _turned(x, z, self.hinge_m, self.swing_rad * turn[self.body])
        moved = rest.copy()
        moved[self.vertex, 0], moved[self.vertex, 2] = x, z
        return moved, self.leg_m * (1.0 - np.cos(self.reach_rad * turn))


def _turned(
    x: Float64[np.ndarray, "limbs"],
    z: Float64[np.ndarray, "limbs"],
    hinge_m: Float64[np.ndarray, "limbs"],
    angle_rad: Float64[np.ndarray, "limbs"],
) -> tuple[Float64[np.ndarray, "limbs"], Float64[np.ndarray, "limbs"]]:
    """Turn points about a sideways axis at x = 0, what hangs below it forward."""
    c, s, hanging = np.cos(angle_rad), np.sin(angle_rad), z - hinge_m
    return x * c - hanging * s, hinge_m + x * s + hanging * c
