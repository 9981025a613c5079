"""A local frame in the plan: a pitch, a stand, a car park is laid out in its own and turned into the world."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Float64


@dataclass(frozen=True)
class Frame:
    """Origin and direction of x in the plan of the world.

    Attributes
    ----------
    x_m, y_m : float
        Origin [m].
    heading_rad : float
        Of the local x axis, counter-clockwise from east.
    """

    x_m: float
    y_m: float
    heading_rad: float

    def world(self, xy: Float64[np.ndarray, "*points 2"]) -> Float64[np.ndarray, "*points 2"]:
        """Local points in the world."""
        c, s = np.cos(self.heading_rad), np.sin(self.heading_rad)
        return np.asarray(xy @ np.array([[c, s], [-s, c]]) + np.array([self.x_m, self.y_m]))

    def local(self, xy: Float64[np.ndarray, "*points 2"]) -> Float64[np.ndarray, "*points 2"]:
        """World points in the frame."""
        c, s = np.cos(self.heading_rad), np.sin(self.heading_rad)
        return np.asarray((xy - np.array([self.x_m, self.y_m])) @ np.array([[c, -s], [s, c]]))

    def at(self, x: float, y: float, turn_rad: float = 0.0) -> Frame:
        """A frame at a local point, turned."""
        origin = self.world(np.array([x, y], np.float64))
        return Frame(float(origin[0]), float(origin[1]), self.heading_rad + turn_rad)

    def box(self, x0: float, y0: float, x1: float, y1: float) -> shapely.Polygon:
        """A local rectangle in the world."""
        return shapely.Polygon(self.world(np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]], np.float64)))

    def shape(self, local: shapely.Geometry) -> shapely.Geometry:
        """Any local geometry in the world."""
        return shapely.transform(local, self.world)


@dataclass(frozen=True)
class Plot:
    """An oriented rectangle centred on its frame.

    Attributes
    ----------
    frame : Frame
    half_x_m, half_y_m : float
    """

    frame: Frame
    half_x_m: float
    half_y_m: float

    def outline(self, margin_m: float = 0.0) -> shapely.Polygon:
        """The rectangle, grown on all sides by a margin [m]."""
        a, b = self.half_x_m + margin_m, self.half_y_m + margin_m
        return self.frame.box(-a, -b, a, b)

    def distance(self, xy: Float64[np.ndarray, "points 2"]) -> Float64[np.ndarray, "points"]:
        """Distance of points from the rectangle [m], 0 inside."""
        beyond = np.abs(self.frame.local(xy)) - np.array([self.half_x_m, self.half_y_m])
        return np.asarray(np.linalg.norm(np.maximum(beyond, 0.0), axis=1))
