"""The clip in space: its flight, the camera of the shown frame, and the frame's pixels as points."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from jaxtyping import Float64, UInt8
from nicegui import ui

from scenegen_datasets.view.library import Still
from scenegen_datasets.view.points import back_projected, edges, frustum, linear

_BACKGROUND, _FLIGHT, _CAMERA = "#0d1015", "#4ea1ff", "#ffb000"
_FAR_M = 20_000.0
_REACH = 3.0  # times the median distance: nearer pixels are drawn
_POINT = 0.009  # of the reach: neighbouring points nearly touch


class Space:
    """A scene in three dimensions; x east, y north, z up, as the dataset has it, from the flight's middle.

    A roof above the picture's upper edge tells which side of the camera is up.
    """

    def __init__(self) -> None:
        camera = ui.scene.perspective_camera(near=0.2, far=_FAR_M)
        with ui.scene(
            width=640, height=480, grid=False, background_color=_BACKGROUND, camera=camera
        ) as scene:
            self._scene = scene
        scene.classes("space").mark("space")
        scene.props('role="img" aria-label="flight, camera and pixels of the frame in space"')
        self._origin: Float64[np.ndarray, "3"] = np.zeros(3)
        self._flight: list[Any] = []
        self._frame: list[Any] = []
        self._cloud: Any = None

    def show_flight(self, poses: Float64[np.ndarray, "frames 4 4"]) -> None:
        """Draw a flight and look at its middle from behind and above."""
        self._clear(self._flight)
        self.show_nothing()  # the size of the points suits one flight
        places = poses[:, :3, 3]
        self._origin = places.mean(axis=0)
        places = places - self._origin
        with self._scene:
            for a, b in pairwise(places):
                self._flight.append(self._scene.line(a.tolist(), b.tolist()).material(_FLIGHT))
        forward = poses[len(poses) // 2, :3, 2]
        length = max(float(np.ptp(places, axis=0).max()), 20.0)
        eye = -1.2 * length * np.array([forward[0], forward[1], 0.0]) + [0.0, 0.0, 0.6 * length]
        self._scene.move_camera(*eye.tolist(), 0.0, 0.0, 0.0, duration=0.0)

    def show_frame(self, still: Still, picture: UInt8[np.ndarray, "rows columns 3"]) -> None:
        """Draw the nearer pixels in the colours of `picture`, and where the camera looks."""
        self._clear(self._frame)
        seen = still.layers["depth"][np.isfinite(still.layers["depth"])]
        reach_m = _REACH * float(np.median(seen)) if seen.size else 1.0
        points, colours = back_projected(still, picture, reach_m)
        corners = frustum(still, 0.06 * reach_m) - self._origin
        places, shades = np.round(points - self._origin, 3).tolist(), np.round(linear(colours), 4).tolist()
        with self._scene:
            if self._cloud is None:
                self._cloud = self._scene.point_cloud(places, shades, point_size=_POINT * reach_m)
            else:
                self._cloud.set_points(places, shades)
            for a, b in edges(corners):
                self._frame.append(self._scene.line(a.tolist(), b.tolist()).material(_CAMERA))

    def show_nothing(self) -> None:
        """Take camera and points away."""
        self._clear(self._frame)
        if self._cloud is not None:
            self._clear([self._cloud])
            self._cloud = None

    def _clear(self, drawn: list[Any]) -> None:
        for thing in drawn:
            thing.delete()
        drawn.clear()
