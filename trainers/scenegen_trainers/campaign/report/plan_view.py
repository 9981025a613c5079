"""A world seen from straight above, as a shaded relief map to draw paths on."""

from __future__ import annotations

import io
import math
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float32, Float64, UInt8
from PIL import Image

from scenegen.classes import Semantic
from scenegen.world import World
from scenegen_render.camera import Camera
from scenegen_render.trace.scenery import Scenery
from scenegen_render.trace.views import Views

SIDE_PX = 900
"""Of the map."""

_FOV_DEG = 3.0  # from so far away that walls hardly show
_MARGIN = 1.03
_SUN = np.array([-0.55, 0.55, 0.63])  # from the north-west, as maps are lit
_OUTSIDE = (16, 19, 24)
_TALL_M = 30.0  # what stands this high above the ground is drawn half as bright again
_PALETTE = {
    Semantic.SKY: _OUTSIDE,
    Semantic.ROAD: (58, 63, 73),
    Semantic.SIDEWALK: (82, 86, 95),
    Semantic.ROAD_MARKING: (104, 108, 116),
    Semantic.SOIL: (86, 79, 70),
    Semantic.GRASS: (64, 79, 66),
    Semantic.SAND: (112, 104, 86),
    Semantic.ROCK: (88, 86, 84),
    Semantic.WATER: (35, 54, 76),
    Semantic.SPORTS_SURFACE: (92, 70, 60),
    Semantic.TREE: (44, 70, 52),
    Semantic.SHRUB: (56, 78, 56),
    Semantic.ROOF: (122, 116, 112),
}
_BUILT = (108, 106, 108)
"""Muted, so that paths stand out; whatever has no colour here was built."""


@dataclass(frozen=True)
class Frame:
    """Where a map's camera stands; maps places of the world to pixels.

    Attributes
    ----------
    centre_m : (float, float)
        East and north of the middle.
    height_m : float
        Of the camera above z = 0.
    focal_px : float
    """

    centre_m: tuple[float, float]
    height_m: float
    focal_px: float

    @classmethod
    def of(cls, world: World) -> Frame:
        """The whole flight box, north up."""
        low, high = np.asarray(world.flight_box_m, np.float64)
        middle = 0.5 * (low + high)[:2]
        ground = float(world.ground.at(middle[None])[0])
        half = 0.5 * _MARGIN * float((high - low)[:2].max())
        away = half / math.tan(math.radians(_FOV_DEG) / 2)
        return cls((float(middle[0]), float(middle[1])), ground + away, SIDE_PX / 2 * away / half)

    def to_pixels(self, place_m: Float64[np.ndarray, "points 3"]) -> Float64[np.ndarray, "points 2"]:
        """Pixels (right, down) of places."""
        scale = self.focal_px / (self.height_m - place_m[:, 2])
        right = SIDE_PX / 2 + (place_m[:, 0] - self.centre_m[0]) * scale
        down = SIDE_PX / 2 - (place_m[:, 1] - self.centre_m[1]) * scale
        return np.stack([right, down], axis=1)

    def metres_per_px(self) -> float:
        """On the ground."""
        return self.height_m / self.focal_px


def draw_plan(world: World, scenery: Scenery, time_s: float) -> bytes:
    """Draw the map as WebP.

    Parameters
    ----------
    world : World
    scenery : Scenery
    time_s : float
        World time: where the movers stand.
    """
    frame = Frame.of(world)
    camera = Camera.from_fov(SIDE_PX, SIDE_PX, _FOV_DEG)
    pose = np.eye(4)
    pose[:3, :3] = np.diag([1.0, -1.0, -1.0])
    pose[:3, 3] = (*frame.centre_m, frame.height_m)
    seen = Views(camera).look(scenery, pose[None], time_s, ("depth", "semantic"))
    assert seen.semantic is not None
    depth = np.where(np.isfinite(seen.depth[0]), seen.depth[0], np.float32(frame.height_m))
    picture = relief((frame.height_m - depth).astype(np.float32), seen.semantic[0], frame.metres_per_px())
    file = io.BytesIO()
    Image.fromarray(picture).save(file, "WEBP", quality=80, method=4)
    return file.getvalue()


def relief(
    height_m: Float32[np.ndarray, "rows columns"], semantic: UInt8[np.ndarray, "rows columns"], cell_m: float
) -> UInt8[np.ndarray, "rows columns 3"]:
    """Muted colours under light from the north-west and in the shade of what stands around.

    Parameters
    ----------
    height_m : float32 (rows, columns)
        Of the surface, rows running south.
    semantic : uint8 (rows, columns)
    cell_m : float
    """
    down, right = np.gradient(height_m.astype(np.float64), cell_m)
    normal = np.stack([-right, down, np.ones_like(right)], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    sunny = np.clip(normal @ (_SUN / np.linalg.norm(_SUN)), 0.0, 1.0)
    around = cv2.GaussianBlur(height_m, (0, 0), 6.0 / cell_m)
    hollow = np.clip((around - height_m) / 10.0, 0.0, 1.0)
    shade = (0.34 + 0.85 * sunny) * (1.0 - 0.45 * hollow) * _cast_shadow(height_m, cell_m)
    ground = cv2.GaussianBlur(cv2.erode(height_m, np.ones((3, 3)), iterations=8), (0, 0), 20.0 / cell_m)
    tall = np.clip((height_m - ground) / _TALL_M, 0.0, 1.0)[..., None]
    table = np.array([_PALETTE.get(kind, _BUILT) for kind in Semantic], np.float64)
    colour = table[semantic] * (1.0 + 0.5 * tall) * shade[..., None]
    colour[semantic == 0] = _OUTSIDE
    return np.asarray(np.rint(np.clip(colour, 0.0, 255.0)), np.uint8)


def _cast_shadow(
    height_m: Float32[np.ndarray, "rows columns"], cell_m: float
) -> Float64[np.ndarray, "rows columns"]:
    """Softly darkened where something to the north-west stands higher than the light comes in."""
    rise = float(_SUN[2] / math.hypot(_SUN[0], _SUN[1])) * 1.6
    over = np.full_like(height_m, -np.inf)
    for step in range(1, 28):
        shifted = np.full_like(height_m, -np.inf)
        shifted[step:, step:] = height_m[:-step, :-step] - rise * step * cell_m * math.sqrt(2.0)
        over = np.maximum(over, shifted)
    dark = np.clip((over - height_m) / 2.0, 0.0, 1.0)
    soft = cv2.GaussianBlur(dark.astype(np.float32), (0, 0), 1.0)
    return np.asarray(1.0 - 0.5 * soft, np.float64)
