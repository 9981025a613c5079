"""What four sub-samples leave at edges: brightness against 256 sub-samples, at edge pixels and elsewhere.

An edge pixel is one whose neighbours lie on another object, or a tenth nearer or farther. Sub-samples are a recipe key
(``render.sub_samples``); cost is linear in them.

    python benchmarks/edges.py [--place boxes]
"""

from __future__ import annotations

import numpy as np
from places import BAND_UM, HFOV_DEG, Place, chosen

from scenegen.radiometry.planck import brightness_temperature
from scenegen_render.camera import Camera
from scenegen_render.frame import Frame
from scenegen_render.knobs import RenderKnobs
from scenegen_render.trace import Tracer

TRUTH = 256


def frames(place: Place, camera: Camera, sub_samples: int) -> list[Frame]:
    tracer = Tracer(camera, RenderKnobs(sub_samples=sub_samples))
    lit = tracer.light(place.loaded, place.state, place.irradiance)
    return [tracer.frame(lit, pose, ahead) for pose, ahead in place.poses]


def edges(frame: Frame) -> np.ndarray:
    """Pixels with another object, or a jump of the depth, among their four neighbours."""
    inverse = 1.0 / frame.depth
    edge = np.zeros(frame.depth.shape, bool)
    for axis in (0, 1):
        ahead, here = [slice(None)] * 2, [slice(None)] * 2
        ahead[axis], here[axis] = slice(1, None), slice(None, -1)
        a, h = tuple(ahead), tuple(here)
        step = np.abs(inverse[a] - inverse[h]) > 0.1 * np.maximum(inverse[a], inverse[h])
        jump = (frame.instance[a] != frame.instance[h]) | (frame.semantic[a] != frame.semantic[h]) | step
        edge[a] |= jump
        edge[h] |= jump
    return edge


def main() -> None:
    place = chosen(__doc__)
    camera = Camera.from_fov(256, 256, HFOV_DEG, BAND_UM)
    truth = frames(place, camera, TRUTH)
    at_edge = np.stack([edges(frame) for frame in truth])
    exact = brightness_temperature(np.stack([f.radiance for f in truth]).astype(np.float64), BAND_UM)
    print(f"edge pixels: {100 * at_edge.mean():.1f} %")
    print(f"{'sub-samples':>12}{'edges rms K':>14}{'median |K|':>12}{'elsewhere rms K':>17}{'mean mK':>10}")
    for count in (1, 4, 8, 16):
        radiance = np.stack([f.radiance for f in frames(place, camera, count)]).astype(np.float64)
        error = brightness_temperature(radiance, BAND_UM) - exact
        edge, inside = error[at_edge], error[~at_edge]
        print(
            f"{count:>12}{np.sqrt((edge**2).mean()):>14.2f}{np.median(np.abs(edge)):>12.2f}"
            f"{np.sqrt((inside**2).mean()):>17.3f}{1e3 * error.mean():>10.1f}"
        )


if __name__ == "__main__":
    main()
