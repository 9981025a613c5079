"""A smooth displacement of the plane, so that streets and blocks bend together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Float64

_CHORD_M = 13.0


@dataclass(frozen=True, eq=False)
class Bend:
    """Sum of plane waves of displacement.

    Attributes
    ----------
    wave_vector : float64 (waves, 2)
        [rad/m].
    phase : float64 (waves,)
        [rad].
    shift_m : float64 (waves, 2)
        Displacement at a crest [m].
    """

    wave_vector: Float64[np.ndarray, "waves 2"]
    phase: Float64[np.ndarray, "waves"]
    shift_m: Float64[np.ndarray, "waves 2"]

    @staticmethod
    def draw(amplitude_m: float, rng: np.random.Generator) -> Bend:
        """Draw a bend of about the given amplitude [m], with waves of 320 to 620 m."""
        length = rng.uniform(320.0, 620.0, 4)
        heading, direction = rng.uniform(0.0, 2 * np.pi, (2, 4))
        vector = (2 * np.pi / length)[:, None] * np.column_stack([np.cos(heading), np.sin(heading)])
        shift = 0.6 * amplitude_m * np.column_stack([np.cos(direction), np.sin(direction)])
        return Bend(vector, rng.uniform(0.0, 2 * np.pi, 4), shift)

    def __call__(self, xy: Float64[np.ndarray, "points 2"]) -> Float64[np.ndarray, "points 2"]:
        """Displaced points."""
        wave = np.sin(xy[:, :1] * self.wave_vector[:, 0] + xy[:, 1:] * self.wave_vector[:, 1] + self.phase)
        return np.asarray(xy + np.column_stack([(wave * self.shift_m[:, k]).sum(axis=1) for k in (0, 1)]))

    def line(self, xy: Float64[np.ndarray, "points 2"]) -> Float64[np.ndarray, "bent 2"]:
        """A polyline in chords short enough to look curved, displaced."""
        return self(shapely.get_coordinates(shapely.segmentize(shapely.LineString(xy), _CHORD_M)))

    def polygon(self, polygon: shapely.Polygon) -> shapely.Polygon:
        """A polygon without holes, displaced."""
        return shapely.Polygon(self.line(shapely.get_coordinates(polygon.exterior)))
