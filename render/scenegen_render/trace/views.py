"""Many cameras at once: what every drone of a flock sees at one instant, traced in one launch.

Lanes of all views stand side by side, each with the pose of its own view. Neither the number of views nor the time nor
the number of movers is part of a kernel, so that nothing is compiled twice while drones come down and movers pass by.
A view does not depend on the others it is traced with: depth and radiance are those of `Tracer.frame`, to the bit.
Where only depth is traced, other rays share a packet: of a million, one or two meet the edge between two faces and
choose the other one, which is the last bit of a float.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from jaxtyping import Float32, Float64, Shaped, UInt8, UInt32

from scenegen_render import backend
from scenegen_render.camera import Camera
from scenegen_render.knobs import RenderKnobs
from scenegen_render.trace import labels, pixels
from scenegen_render.trace.lit import Lit
from scenegen_render.trace.pose import Fleet
from scenegen_render.trace.radiance import Sampler
from scenegen_render.trace.scenery import Scenery, met
from scenegen_render.trace.troupe import View

Layer = Literal["depth", "radiance", "semantic", "instance"]
_DEPTH: tuple[Layer, ...] = ("depth",)
_MOST_RAYS = 8_000_000
"""Of one launch, which keep some 25 bytes each: more views than that are traced in several."""


@dataclass(frozen=True, eq=False)
class Seen:
    """What several cameras see at one instant; layers as in `docs/conventions.md`.

    Attributes
    ----------
    depth : float32 (views, rows, columns)
        Planar z of the surface through the pixel centre [m]; +inf for sky.
    radiance : float32 (views, rows, columns), optional
        Noise-free band radiance at the camera [W m^-2 sr^-1].
    semantic : uint8 (views, rows, columns), optional
    instance : uint32 (views, rows, columns), optional
    """

    depth: Float32[np.ndarray, "views rows columns"]
    radiance: Float32[np.ndarray, "views rows columns"] | None = None
    semantic: UInt8[np.ndarray, "views rows columns"] | None = None
    instance: UInt32[np.ndarray, "views rows columns"] | None = None


class Views:
    """Looks at worlds through many copies of one camera.

    Parameters
    ----------
    camera : Camera
    knobs : RenderKnobs, optional
        Sub-samples of the radiance.
    """

    def __init__(self, camera: Camera, knobs: RenderKnobs | None = None) -> None:
        self.camera = camera
        self._sampler = Sampler(camera, (knobs or RenderKnobs()).sub_samples)
        self._tiled = backend.upload(pixels.tiled(camera))
        self._centres = pixels.on_device(pixels.image_plane(camera, np.array([[0.5, 0.5]])))

    def look(
        self,
        scenery: Scenery,
        poses: Float64[np.ndarray, "views 4 4"],
        time_s: float,
        want: Collection[Layer] = _DEPTH,
    ) -> Seen:
        """Trace all views of one instant.

        Parameters
        ----------
        scenery : Scenery
            A world's shape; for radiance a `Lit`, which is one.
        poses : float64 (views, 4, 4)
            `world_from_camera` of each camera, at least one.
        time_s : float
            World time [s]: where the movers are.
        want : collection of {"depth", "radiance", "semantic", "instance"}
            Depth comes always; nothing else is computed unless it is wanted.

        Raises
        ------
        ValueError
            If radiance is wanted of a world without a thermal state.
        FloatingPointError
            If depth or radiance came out as no number.
        """
        rays = (
            self.camera.width_px * self.camera.height_px * (self._sampler.count if "radiance" in want else 1)
        )
        most = max(1, _MOST_RAYS // rays)
        parts = [self._look(scenery, poses[k : k + most], time_s, want) for k in range(0, len(poses), most)]
        return parts[0] if len(parts) == 1 else _joined(parts)

    def _look(
        self,
        scenery: Scenery,
        poses: Float64[np.ndarray, "views 4 4"],
        time_s: float,
        want: Collection[Layer],
    ) -> Seen:
        """As `look`, in one launch."""
        _, dr = backend.modules()
        fleet = Fleet.of(poses)
        view = scenery.troupe.seen_by_all(time_s, self.camera, poses, mirrors="radiance" in want)
        if "radiance" in want:
            if not isinstance(scenery, Lit):
                raise ValueError("radiance needs a lit world, see Tracer.light; this is only its shape")
            layers = self._photographed(scenery, view, fleet, want)
        else:
            face, valid = self._met(scenery, view, fleet)
            layers = self._labels(scenery, view, fleet, face, valid, want)
        rows = {name: self._in_rows(value) for name, value in layers.items()}
        dr.eval(rows)
        return self._seen({name: value.numpy() for name, value in rows.items()}, len(poses))

    def _photographed(self, lit: Lit, view: View, fleet: Fleet, want: Collection[Layer]) -> dict[str, Any]:
        """Radiance from all sub-samples, labels from the first of each pixel, which is its centre."""
        mi, dr = backend.modules()
        sampler = self._sampler.repeated(fleet.count)
        count = dr.width(self._tiled)
        samples = sampler.cast(lit, view, fleet.pose(self._view(fleet, count * sampler.count)))
        dr.eval(samples)
        centre = dr.arange(mi.UInt, fleet.count * count) * sampler.count
        valid = ~dr.isinf(dr.gather(mi.Float, samples.depth, centre))
        layers = self._labels(lit, view, fleet, dr.gather(mi.UInt, samples.face, centre), valid, want)
        towards = fleet.pose(self._view(fleet, count * sampler.groups))
        radiance = sampler.merge(lit, view.instant, towards, samples)
        if sampler.groups > 1:
            dr.eval(radiance, layers)
        return layers | {"radiance": sampler.pixels(radiance)}

    def _met(self, scenery: Scenery, view: View, fleet: Fleet) -> tuple[Any, Any]:
        """Face that the ray through each pixel centre meets, of the world or of a mover; and whether there is any."""
        mi, dr = backend.modules()
        pose = fleet.pose(self._view(fleet, dr.width(self._tiled)))
        plane = pixels.repeated(self._centres, fleet.count)
        towards = pose.turn(plane.x, plane.y, mi.Float(1.0))
        near = dr.gather(mi.Bool, view.near, pixels.place(self._tiled, dr.arange(mi.UInt, dr.width(towards))))
        return met(scenery, view.instant, pose.translation, towards, near)

    def _labels(
        self,
        scenery: Scenery,
        view: View,
        fleet: Fleet,
        face: Any,
        valid: Any,
        want: Collection[Layer],
    ) -> dict[str, Any]:
        mi, dr = backend.modules()
        on = labels.footing(scenery, view.instant, face, valid)
        plane = pixels.repeated(self._centres, fleet.count)
        pose = fleet.pose(self._view(fleet, dr.width(self._tiled)), double=True)
        depth = labels.planar_depth(
            pose, mi.Float64(plane.x), mi.Float64(plane.y), on.corner, dr.cross(on.along, on.up)
        )
        layers = {"depth": dr.select(valid, mi.Float(depth), dr.inf)}
        if "semantic" in want:
            layers["semantic"] = labels.semantic(scenery, on, face, valid)
        if "instance" in want:
            layers["instance"] = labels.instance(scenery, on, face, valid)
        return layers

    def _view(self, fleet: Fleet, lanes: int) -> Any:
        """View of each lane, with so many lanes a view."""
        mi, dr = backend.modules()
        return dr.arange(mi.UInt, fleet.count * lanes) // lanes

    def _in_rows(self, lanes: Any) -> Any:
        """Put the values of the lanes, which go tile by tile, where they belong in the images."""
        mi, dr = backend.modules()
        image = dr.empty(type(lanes), dr.width(lanes))
        place = pixels.place(self._tiled, dr.arange(mi.UInt, dr.width(lanes)))
        dr.scatter(image, lanes, place, mode=dr.ReduceMode.Permute)
        return image

    def _seen(self, layers: dict[str, Shaped[np.ndarray, "lanes"]], views: int) -> Seen:
        shape = (views, self.camera.height_px, self.camera.width_px)
        image = {name: values.reshape(shape) for name, values in layers.items()}
        radiance, semantic = image.get("radiance"), image.get("semantic")
        if not image["depth"].min() > 0.0:  # no number is less than what is none, nor is that more
            raise FloatingPointError("the tracer produced depths that are no positive numbers")
        if radiance is not None and not np.isfinite(radiance.sum()):
            raise FloatingPointError("the tracer produced non-finite radiance")
        return Seen(
            image["depth"],
            radiance,
            None if semantic is None else semantic.astype(np.uint8),
            image.get("instance"),
        )


def _joined(parts: Sequence[Seen]) -> Seen:
    layers = {
        name: [getattr(part, name) for part in parts]
        for name in ("depth", "radiance", "semantic", "instance")
    }
    return Seen(**{name: np.concatenate(all_) for name, all_ in layers.items() if all_[0] is not None})
