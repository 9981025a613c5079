"""The tracer: one camera, one set of layers, one launch a frame."""

from __future__ import annotations

from typing import Any

import numpy as np
from jaxtyping import Float32

from scenegen.thermal_state import ThermalState
from scenegen_render import backend
from scenegen_render.camera import Camera
from scenegen_render.frame import Frame
from scenegen_render.knobs import RenderKnobs
from scenegen_render.scene import LoadedWorld
from scenegen_render.trace import labels, mirror, pixels, surface
from scenegen_render.trace.lit import Lit, light
from scenegen_render.trace.pose import DevicePose, Pose, device_pose, relative


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
        self._samples = pixels.on_device(
            pixels.image_plane(camera, pixels.subsample_pattern(knobs.sub_samples))
        )
        self._centres = pixels.on_device(pixels.image_plane(camera, centre))

    def light(
        self, loaded: LoadedWorld, state: ThermalState, irradiance: Float32[np.ndarray, "sites"]
    ) -> Lit:
        """Put one thermal state of a world on the device, in the camera's band; see `scenegen_render.trace.lit`."""
        return light(loaded, state, irradiance, self.camera.band_um)

    def frame(self, lit: Lit, pose: Pose, next_pose: Pose, previous_pose: Pose | None = None) -> Frame:
        """Trace one frame with all its layers.

        Parameters
        ----------
        lit : Lit
        pose, next_pose : float64 (4, 4)
            `world_from_camera` of this frame and of the next one (for the flow).
        previous_pose : float64 (4, 4), optional
            Needed for backward flow.

        Raises
        ------
        FloatingPointError
            If anything but the sky's depth (or the flow of points behind the other camera) came out non-finite.
        """
        _, dr = backend.modules()
        towards = device_pose(pose)
        others = [next_pose]
        if self.knobs.backward_flow:
            if previous_pose is None:
                raise ValueError("backward flow needs the previous pose")
            others.append(previous_pose)
        layers = self._labels(lit, pose, towards, others)
        layers["radiance"] = self._radiance(lit, towards)
        dr.eval(layers)
        layers["radiance"] = dr.block_sum(layers["radiance"], self.knobs.sub_samples)
        return self._frame({name: value.numpy() for name, value in layers.items()})

    def _radiance(self, lit: Lit, pose: DevicePose) -> Any:
        """Share of every sub-sample in its pixel's radiance."""
        mi, dr = backend.modules()
        direction = pose.turn(self._samples.x, self._samples.y, mi.Float(1.0))
        hit = surface.cast(lit, pose.translation, direction, coherent=True)
        on = surface.skin(lit, hit)
        length = dr.norm(direction)
        unit = direction / length
        temperature = surface.textured_K(lit, hit, on, self._footprint(hit, on, unit))
        leaving = surface.diffuse_radiance(lit, on, temperature)
        leaving = mirror.with_mirror(lit, hit, on, temperature, unit, leaving)
        arriving = lit.air.through(leaving, hit.depth * length)
        seen = dr.select(hit.valid, arriving, lit.air.sky_towards(unit, ~hit.valid))
        return seen * (1.0 / self.knobs.sub_samples)

    def _labels(self, lit: Lit, pose: Pose, towards: DevicePose, others: list[Pose]) -> dict[str, Any]:
        """Layers of the ray through each pixel centre."""
        mi, dr = backend.modules()
        direction = towards.turn(self._centres.x, self._centres.y, mi.Float(1.0))
        hit = surface.cast(lit, towards.translation, direction, coherent=True)
        on = surface.skin(lit, hit)
        corner, along, up = labels.triangle(lit, hit)
        normal = dr.cross(along, up)
        x, y = mi.Float64(self._centres.x), mi.Float64(self._centres.y)
        depth = mi.Float(labels.planar_depth(device_pose(pose, double=True), x, y, corner, normal))
        temperature = surface.textured_K(lit, hit, on, self._footprint(hit, on, dr.normalize(direction)))
        layers = {
            "depth": dr.select(hit.valid, depth, dr.inf),
            "temperature": dr.select(hit.valid, temperature, 0.0),
            "what": dr.select(hit.valid, on.what >> 16, 0)
            | dr.gather(mi.UInt, lit.material, on.what & 0xFFFF, hit.valid) << 16,
            "instance": dr.gather(mi.UInt, lit.loaded.face_object, hit.face, hit.valid),
        }
        for name, other in zip(("flow", "flow_back"), others, strict=False):
            moved = labels.moved(
                lit,
                self.camera,
                self._centres,
                depth,
                hit.valid,
                device_pose(relative(other, pose)),
                device_pose(other),
            )
            layers |= {
                name + "_u": moved.flow.x,
                name + "_v": moved.flow.y,
                name + "_covisible": moved.covisible,
            }
        if self.knobs.normals:
            facing = labels.camera_normal(pose, direction, normal, hit.valid)
            layers |= {"normal_x": facing.x, "normal_y": facing.y, "normal_z": facing.z}
        return layers

    def _footprint(self, hit: surface.Hit, on: surface.Skin, unit: Any) -> Any:
        """Longest extent of a pixel on the surface [m]."""
        _, dr = backend.modules()
        slant = dr.maximum(dr.abs(dr.dot(on.normal, unit)), 0.02)
        return hit.depth * (1.0 / self.camera.focal_px) / slant

    def _frame(self, layers: dict[str, np.ndarray[Any, Any]]) -> Frame:
        shape = (self.camera.height_px, self.camera.width_px)

        def image(name: str) -> np.ndarray[Any, Any]:
            return layers[name].reshape(shape)

        def flow(name: str) -> np.ndarray[Any, Any]:
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
        _guard(frame)
        return frame


def _guard(frame: Frame) -> None:
    """Nothing non-finite leaves the tracer but the depth of the sky and the flow of points behind a camera."""
    sky = frame.instance == 0
    holds = {
        "radiance": bool(np.isfinite(frame.radiance).all()),
        "temperature": bool(np.isfinite(frame.temperature).all()),
        "depth": bool((np.isfinite(frame.depth) != np.isposinf(frame.depth)).all()),
        "flow": not np.isinf(frame.flow).any(),
    }
    broken = [name for name, ok in holds.items() if not ok]
    if broken or sky.size == 0:
        raise FloatingPointError(f"the tracer produced non-finite values in: {', '.join(broken)}")
