"""What a drone has seen: depth images with the poses they were taken from, asked whether a ball of space is free.

No map is fused. A ball is free if one of the images looks past it: every pixel it covers there lies beyond it (the
history of depth images of Florence, Carter, Ware and Tedrake 2018, "NanoMap", with the ball tested in the image as
Matthies et al. 2014 do). Minima over any square of pixels take four look-ups in a table of minima over squares of
side 1, 2, 4 ... (a two-dimensional sparse table). So what has left the picture stays known, and what no picture has
looked past is never taken for free.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int8, Int64

from scenegen_render.camera import Camera

FREE, UNKNOWN, HIT = 1, 0, -1
"""A picture looks past a ball; tells nothing about it; shows a surface inside it."""
_COLUMNS = 128
"""Images are reduced to about this width; a reduced pixel keeps the nearest of its pixels."""


@dataclass(frozen=True, eq=False)
class Sight:
    """One depth image, ready to be asked.

    Attributes
    ----------
    world_from_camera : float64 (4, 4)
    minima : float32 (levels, rows, columns)
        Least depth over the square of side ``2**level`` that begins at each reduced pixel [m].
    focal_px, centre_px : float, (float, float)
        Of the reduced image.
    time_s : float
    """

    world_from_camera: Float64[np.ndarray, "4 4"]
    minima: Float32[np.ndarray, "levels rows columns"]
    focal_px: float
    centre_px: tuple[float, float]
    time_s: float

    def ask(
        self, points: Float64[np.ndarray, "points 3"], radius_m: float, near_m: float
    ) -> Int8[np.ndarray, "points"]:
        """`FREE`, `UNKNOWN` or `HIT` for balls around points of the world.

        Parameters
        ----------
        points : float64 (points, 3)
        radius_m : float
        near_m : float
            A ball nearer than this fills the picture and more: it is judged by the ball at this range behind it. 0 for
            pictures taken elsewhere.
        """
        turn = self.world_from_camera[:3, :3]
        local = ((points - self.world_from_camera[:3, 3]) @ turn).astype(np.float32)
        if near_m > 0.0:
            away = np.sqrt((local * local).sum(axis=1))
            local *= np.maximum(near_m / np.maximum(away, 1e-6), 1.0)[:, None].astype(np.float32)
        return self._ask(local, radius_m)

    def _ask(self, local: Float32[np.ndarray, "points 3"], radius_m: float) -> Int8[np.ndarray, "points"]:
        _, rows, columns = self.minima.shape
        z = local[:, 2]
        ahead = z > radius_m
        inverse = 1.0 / np.where(ahead, z, 1.0)
        x, y = local[:, 0] * inverse, local[:, 1] * inverse
        # A ball off the axis looks longer: by the secant of its angle, at most.
        half = self.focal_px * radius_m * inverse * np.sqrt(1.0 + x * x + y * y)
        u, v = self.focal_px * x + self.centre_px[0], self.focal_px * y + self.centre_px[1]
        left, top = np.floor(u - half), np.floor(v - half)
        side = np.floor(2.0 * half) + 2.0
        inside = ahead & (left >= 0) & (top >= 0) & (left + side <= columns) & (top + side <= rows)
        side = np.where(inside, side, 1.0).astype(np.int64)
        left, top = np.where(inside, left, 0.0).astype(np.int64), np.where(inside, top, 0.0).astype(np.int64)
        least = self._least(left, top, side)
        free = inside & (least > z + radius_m)
        hit = inside & (np.abs(least - z) <= radius_m)
        return np.asarray(free.astype(np.int8) - hit.astype(np.int8))

    def _least(
        self,
        left: Int64[np.ndarray, "points"],
        top: Int64[np.ndarray, "points"],
        side: Int64[np.ndarray, "points"],
    ) -> Float32[np.ndarray, "points"]:
        """Least depth in squares of pixels that lie in the image."""
        _, rows, columns = self.minima.shape
        level = _LOG2[side]
        shift = side - (1 << level)
        first = (level * rows + top) * columns + left
        flat = self.minima.reshape(-1)
        upper = np.minimum(flat[first], flat[first + shift])
        lower = first + shift * columns
        return np.asarray(np.minimum(upper, np.minimum(flat[lower], flat[lower + shift])))


_LOG2 = np.array([0, *(int(np.log2(k)) for k in range(1, 4097))], np.int64)


def sights(
    depth_m: Float32[np.ndarray, "n rows columns"],
    camera: Camera,
    world_from_camera: Float64[np.ndarray, "n 4 4"],
    time_s: float,
) -> list[Sight]:
    """Make depth images ready to be asked. What is not a depth (NaN, negative) counts as touching the lens."""
    pool = max(1, round(depth_m.shape[2] / _COLUMNS))
    depth = _pooled(np.where(depth_m >= 0.0, depth_m, np.float32(0.0)), pool)
    levels = _LOG2[min(depth.shape[1:])] + 1
    minima = np.empty((len(depth), levels, *depth.shape[1:]), np.float32)
    minima[:, 0] = depth
    for level in range(1, levels):
        half = 1 << (level - 1)
        below, here = minima[:, level - 1], minima[:, level]
        here[:] = below
        np.minimum(here[:, :-half], below[:, half:], out=here[:, :-half])
        across = here.copy()
        np.minimum(here[:, :, :-half], across[:, :, half:], out=here[:, :, :-half])
    cx, cy = camera.centre_px
    return [
        Sight(pose, table, camera.focal_px / pool, (cx / pool, cy / pool), time_s)
        for pose, table in zip(world_from_camera, minima, strict=True)
    ]


def _pooled(depth: Float32[np.ndarray, "n rows columns"], pool: int) -> Float32[np.ndarray, "n r c"]:
    """Least depth of blocks; rows and columns that fill no block are left out."""
    rows, columns = depth.shape[1] // pool, depth.shape[2] // pool
    whole = depth[:, : rows * pool, : columns * pool]
    return np.asarray(whole.reshape(-1, rows, pool, columns, pool).min(axis=(2, 4)))


class Seen:
    """The sights one drone keeps: the fresh ones, and a few before, each taken from another place or heading."""

    def __init__(self, keep: int, spacing_m: float, turn_rad: float, fresh_s: float) -> None:
        self._keep, self._spacing_m, self._turn_cosine = keep, spacing_m, float(np.cos(turn_rad))
        self._fresh_s = fresh_s
        self._sights: list[Sight] = []

    def add(self, sight: Sight) -> None:
        """Take in the newest. What is no longer fresh stays only if it differs from the one before it."""
        kept = self._sights
        kept.append(sight)
        old = sum(s.time_s < sight.time_s - self._fresh_s for s in kept)
        if old >= 2 and not self._differs(kept[old - 1], kept[old - 2]):
            kept.pop(old - 1)
        if len(kept) > self._keep:
            kept.pop(0)

    def free(
        self, points: Float64[np.ndarray, "points 3"], radius_m: float, near_m: float, hit_s: float
    ) -> Bool[np.ndarray, "points"]:
        """Where balls are known to be free: a sight looks past them, none of the last `hit_s` shows anything inside."""
        newest = self._sights[-1]
        past, struck = np.zeros(len(points), np.bool_), np.zeros(len(points), np.bool_)
        for sight in self._sights:
            told = sight.ask(points, radius_m, near_m if sight is newest else 0.0)
            past |= told == FREE
            if sight.time_s >= newest.time_s - hit_s:
                struck |= told == HIT
        return past & ~struck

    def _differs(self, a: Sight, b: Sight) -> bool:
        p, q = a.world_from_camera, b.world_from_camera
        apart = float(np.linalg.norm(p[:3, 3] - q[:3, 3]))
        return apart >= self._spacing_m or float(p[:3, 2] @ q[:3, 2]) < self._turn_cosine
