"""The tracer: one camera, one set of layers, one launch a frame."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from jaxtyping import Bool, Float32, Float64, Shaped

from scenegen.thermal_state import ThermalState
from scenegen.world import World
from scenegen_render import backend
from scenegen_render.camera import Camera
from scenegen_render.frame import Frame
from scenegen_render.knobs import RenderKnobs
from scenegen_render.scene import LoadedWorld
from scenegen_render.trace import labels, pixels, surface
from scenegen_render.trace.casting import choose
from scenegen_render.trace.lit import Lit, light
from scenegen_render.trace.pose import Pose, device_pose, relative
from scenegen_render.trace.radiance import Sampler, Samples
from scenegen_render.trace.troupe import Instant, View


class Tracer:
    """Photographs lit worlds with one camera.

    Everything that differs between frames, states and worlds is an opaque kernel argument: one tracer compiles its
    kernels once.

    Parameters
    ----------
    camera : Camera
    knobs : RenderKnobs
        Sub-samples and optional layers.
    """

    def __init__(self, camera: Camera, knobs: RenderKnobs) -> None:
        self.camera = camera
        self.knobs = knobs
        centre = np.array([[0.5, 0.5]])
        self._sampler = Sampler(camera, knobs.sub_samples)
        self._pixel = backend.upload(pixels.tiled(camera))
        self._centres = pixels.on_device(pixels.image_plane(camera, centre))

    def light(
        self,
        loaded: LoadedWorld,
        state: ThermalState,
        irradiance: Float32[np.ndarray, "sites"],
        cast: Sequence[int] = (),
    ) -> Lit:
        """Put one thermal state of a world on the device, in the camera's band; see `scenegen_render.trace.lit`.

        Movers appear if they are in the `cast`, see `cast`.
        """
        return light(loaded, state, irradiance, self.camera.band_um, cast)

    def cast(
        self, world: World, poses: Float64[np.ndarray, "poses 4 4"], times_s: Float64[np.ndarray, "poses"]
    ) -> tuple[int, ...]:
        """Which movers of a world appear in a clip with these poses and world times."""
        return choose(world.movers, self.camera, poses, times_s)

    def frame(
        self,
        lit: Lit,
        pose: Pose,
        next_pose: Pose,
        previous_pose: Pose | None = None,
        times_s: tuple[float, float, float] = (0.0, 0.0, 0.0),
    ) -> Frame:
        """Trace one frame with all its layers.

        Parameters
        ----------
        lit : Lit
        pose, next_pose : float64 (4, 4)
            `world_from_camera` of this frame and of the next one (for the flow).
        previous_pose : float64 (4, 4), optional
            Needed for backward flow.
        times_s : (float, float, float)
            World times of this frame, the next and the previous one: where the movers are.

        Raises
        ------
        FloatingPointError
            If anything but the sky's depth (or the flow of points behind the other camera) came out non-finite.
        """
        _, dr = backend.modules()
        towards = device_pose(pose)
        view = lit.troupe.seen(times_s[0], self.camera, pose)
        now = view.instant
        others = [(next_pose, lit.troupe.seen(times_s[1], self.camera, next_pose))]
        if self.knobs.backward_flow:
            if previous_pose is None:
                raise ValueError("backward flow needs the previous pose")
            others.append((previous_pose, lit.troupe.seen(times_s[2], self.camera, previous_pose)))
        samples = self._sampler.cast(lit, view, towards)
        dr.eval(samples)
        layers = self._labels(lit, now, pose, samples, others)
        radiance = self._sampler.merge(lit, now, towards, samples)
        if self._sampler.groups > 1:
            dr.eval(radiance, layers)
        layers["radiance"] = self._sampler.pixels(radiance)
        rows = {name: self._in_rows(value) for name, value in layers.items()}
        dr.eval(rows)
        return self._frame({name: value.numpy() for name, value in rows.items()})

    def _in_rows(self, lanes: Any) -> Any:
        """Put the values of the lanes, which go tile by tile, where they belong in the image."""
        _, dr = backend.modules()
        image = dr.empty(type(lanes), dr.width(self._pixel))
        dr.scatter(image, lanes, self._pixel, mode=dr.ReduceMode.Permute)
        return image

    def _labels(
        self, lit: Lit, now: Instant, pose: Pose, samples: Samples, others: list[tuple[Pose, View]]
    ) -> dict[str, Any]:
        """Layers of the ray through each pixel centre, which is the first sub-sample."""
        mi, dr = backend.modules()
        centre = dr.arange(mi.UInt, dr.width(self._centres)) * self._sampler.count
        valid = ~dr.isinf(dr.gather(mi.Float, samples.depth, centre))
        face = dr.gather(mi.UInt, samples.face, centre)
        what = surface.what(lit, face, valid)
        on = labels.footing(lit, now, face, valid)
        normal = dr.cross(on.along, on.up)
        x, y = mi.Float64(self._centres.x), mi.Float64(self._centres.y)
        exact = device_pose(pose, double=True)
        depth = mi.Float(labels.planar_depth(exact, x, y, on.corner, normal))
        layers = {
            "depth": dr.select(valid, depth, dr.inf),
            "temperature": dr.gather(mi.Float, samples.temperature_K, centre),
            "what": what >> 16 | dr.gather(mi.UInt, lit.material, what & 0xFFFF, valid) << 16,
            "instance": dr.gather(mi.UInt, lit.object, face, valid),
        }
        for name, (other, then) in zip(("flow", "flow_back"), others, strict=False):
            moved = labels.moved(
                lit,
                then,
                self.camera,
                self._centres,
                depth,
                valid,
                labels.shift(lit, now, then.instant, on, exact, x, y, depth),
                device_pose(relative(other, pose)),
                device_pose(other),
            )
            layers |= {
                name + "_u": moved.flow.x,
                name + "_v": moved.flow.y,
                name + "_covisible": moved.covisible,
            }
        if self.knobs.normals:
            facing = labels.camera_normal(pose, self._centres, normal, valid)
            layers |= {"normal_x": facing.x, "normal_y": facing.y, "normal_z": facing.z}
        return layers

    def _frame(self, layers: dict[str, Shaped[np.ndarray, "pixels"]]) -> Frame:
        shape = (self.camera.height_px, self.camera.width_px)

        def image(name: str) -> Shaped[np.ndarray, "rows columns"]:
            return layers[name].reshape(shape)

        def flow(name: str) -> Float32[np.ndarray, "rows columns 2"]:
            return np.stack([image(name + "_u"), image(name + "_v")], axis=-1)

        what = image("what")
        frame = Frame(
            radiance=image("radiance"),
            depth=image("depth"),
            temperature=image("temperature"),
            semantic=what.astype(np.uint8),
            instance=image("instance"),
            material=(what >> 16).astype(np.uint16),
            flow=flow("flow"),
            covisible=image("flow_covisible"),
            flow_back=flow("flow_back") if self.knobs.backward_flow else None,
            covisible_back=image("flow_back_covisible") if self.knobs.backward_flow else None,
            normal=np.stack([image(f"normal_{k}") for k in "xyz"], axis=-1) if self.knobs.normals else None,
        )
        check_finite(frame)
        return frame


def check_finite(frame: Frame) -> None:
    """Nothing non-finite leaves the tracer but the depth of the sky and the flow of points behind a camera.

    Raises
    ------
    FloatingPointError
        Names the layers that are broken.
    """
    flows = [(frame.flow, frame.covisible)]
    if frame.flow_back is not None and frame.covisible_back is not None:
        flows.append((frame.flow_back, frame.covisible_back))
    sky = frame.instance == 0
    holds = {
        "radiance": np.isfinite(frame.radiance.sum()),  # one pass: a sum is finite only if all its terms are
        "temperature": np.isfinite(frame.temperature.sum()),
        "depth": np.array_equal(np.isposinf(frame.depth), sky) and frame.depth.min() > 0,
        "flow": all(_sound(flow, seen) for flow, seen in flows),
    }
    broken = [name for name, ok in holds.items() if not ok]
    if broken:
        raise FloatingPointError(f"the tracer produced non-finite values in: {', '.join(broken)}")


def _sound(flow: Float32[np.ndarray, "rows columns 2"], covisible: Bool[np.ndarray, "rows columns"]) -> bool:
    """No infinity anywhere, and numbers wherever the point is seen from the other pose."""
    extremes = np.fmin.reduce(flow, axis=None), np.fmax.reduce(flow, axis=None)  # these pass over NaN
    return not np.isinf(extremes).any() and not (covisible & np.isnan(flow[..., 0])).any()
