"""The clip in space: its flight, the camera of the shown frame, and the frame's pixels as points."""

from __future__ import annotations

from typing import Any

import numpy as np
from jaxtyping import Float64, UInt8
from nicegui import ui

from scenegen_datasets.view.library import Still
from scenegen_datasets.view.points import back_projected, frustum

_BACKGROUND, _FLIGHT, _CAMERA = "#14171c", "#4ea1ff", "#ffb000"
_POINT_M = 0.004  # of the reach: a point a few pixels wide


class Space:
    """A scene in three dimensions; x east, y north, z up, as the dataset has it, from the flight's middle."""

    def __init__(self) -> None:
        with ui.scene(width=1200, height=520, grid=False, background_color=_BACKGROUND) as scene:
            self._scene = scene
        scene.classes("w-full").mark("space")
        self._origin: Float64[np.ndarray, "3"] = np.zeros(3)
        self._flight: list[Any] = []
        self._frame: list[Any] = []

    def show_flight(self, poses: Float64[np.ndarray, "frames 4 4"]) -> None:
        """Draw a flight and look at its middle from behind and above."""
        self._clear(self._flight)
        places = poses[:, :3, 3]
        self._origin = places.mean(axis=0)
        places = places - self._origin
        with self._scene:
            for a, b in zip(places[:-1], places[1:], strict=True):
                self._flight.append(self._scene.line(a.tolist(), b.tolist()).material(_FLIGHT))
        forward = poses[len(poses) // 2, :3, 2]
        length = max(float(np.ptp(places, axis=0).max()), 20.0)
        eye = -1.2 * length * np.array([forward[0], forward[1], 0.0]) + [0.0, 0.0, 0.6 * length]
        self._scene.move_camera(*eye.tolist(), 0.0, 0.0, 0.0, duration=0.0)

    def show_frame(self, still: Still, picture: UInt8[np.ndarray, "rows columns 3"], reach_m: float) -> None:
        """Draw the pixels nearer than `reach_m` in the colours of `picture`, and where the camera looks."""
        self._clear(self._frame)
        points, colours = back_projected(still, picture, reach_m)
        corners = frustum(still, 0.05 * reach_m) - self._origin
        with self._scene:
            self._frame.append(
                self._scene.point_cloud(
                    np.round(points - self._origin, 3).tolist(),
                    np.round(colours / 255.0, 3).tolist(),
                    point_size=max(_POINT_M * reach_m, 0.05),
                )
            )
            for k in range(1, 5):
                following = corners[1 + k % 4]
                for end in (corners[0], following):
                    line = self._scene.line(corners[k].tolist(), end.tolist()).material(_CAMERA)
                    self._frame.append(line)

    def _clear(self, drawn: list[Any]) -> None:
        for thing in drawn:
            thing.delete()
        drawn.clear()
