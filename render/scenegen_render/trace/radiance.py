"""Band radiance of every pixel, in two launches: every sub-sample by itself, then what a pixel's sub-samples share.

Rays of one pixel lie side by side, which keeps Embree's packets coherent (rows of pixels cost 1.7 times as much).
What is smooth is shared: the sky is looked up once for the sub-samples of a pixel that miss the world, in their mean
direction; and glass, water and bare metal send one mirrored ray per group of up to four sub-samples, with each
sub-sample's own reflectance and path.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from typing import Any

import numpy as np

from scenegen_render import backend
from scenegen_render.camera import Camera
from scenegen_render.trace import mirror, pixels, surface
from scenegen_render.trace.lit import Lit
from scenegen_render.trace.pose import DevicePose
from scenegen_render.trace.troupe import Instant, View

_LARGEST_GROUP = 4


@dataclass(frozen=True, eq=False)
class Samples:
    """What the sub-samples of a frame met, the samples of a pixel side by side, the pixel centre first.

    Attributes
    ----------
    radiance : mitsuba.Float
        At the camera, without mirror image; 0 for sky [W m^-2 sr^-1].
    reflected : mitsuba.Float
        Mirror reflectance times transmission: what a mirror image counts; 0 where there is no mirror.
    temperature_K : mitsuba.Float
    depth : mitsuba.Float
        Planar depth from Embree [m]; infinite for sky.
    face : mitsuba.UInt
    """

    radiance: Any
    reflected: Any
    temperature_K: Any
    depth: Any
    face: Any


class Sampler:
    """The sub-samples of one camera.

    Parameters
    ----------
    camera : Camera
    count : int
        Sub-samples per pixel.

    Attributes
    ----------
    count : int
    groups : int
        Groups of up to four sub-samples that make up a pixel.
    views : int
        Images cast together; one but for `repeated`.
    """

    def __init__(self, camera: Camera, count: int) -> None:
        self.count, self.views = count, 1
        self._group = max(k for k in range(1, _LARGEST_GROUP + 1) if count % k == 0)
        self._metre_per_depth = 1.0 / camera.focal_px
        pattern = pixels.subsample_pattern(count)
        self._plane = pixels.on_device(pixels.image_plane(camera, pattern))
        self.groups = count // self._group
        self._corner = pixels.on_device(pixels.image_plane(camera, np.zeros((self.groups, 2))))
        self._offset = backend.upload(np.asarray(pattern / camera.focal_px, np.float32))
        lanes = np.arange(self.groups * camera.width_px * camera.height_px, dtype=np.uint32)
        self._tiled = backend.upload(pixels.tiled(camera))
        self._in_pixel = backend.upload(lanes % np.uint32(self.groups))

    def repeated(self, views: int) -> Sampler:
        """The same sub-samples for several views, one view after the other; the number is no part of a kernel."""
        many = copy(self)
        many.views = views
        many._plane, many._corner, many._in_pixel = (
            pixels.repeated(lanes, views) for lanes in (self._plane, self._corner, self._in_pixel)
        )
        return many

    def cast(self, lit: Lit, view: View, pose: DevicePose) -> Samples:
        """Send every sub-sample and shade what it meets."""
        mi, dr = backend.modules()
        towards = pose.turn(self._plane.x, self._plane.y, mi.Float(1.0))
        near = dr.gather(mi.Bool, view.near, self._pixel_of(dr.arange(mi.UInt, dr.width(towards))))
        hit = surface.cast(lit, view.instant, pose.translation, towards, near)
        on = surface.skin(lit, hit)
        length = dr.norm(towards)
        unit = towards / length
        footprint_m = hit.depth * self._metre_per_depth / surface.cosine(on, unit)
        temperature = surface.textured_K(lit, hit, on, footprint_m)
        rho = mirror.reflectance(lit, hit, on, unit, footprint_m)
        tau = lit.air.transmission(hit.depth * length)
        leaving = surface.radiance(lit, on, temperature, rho)
        arriving = dr.fma(tau, leaving - lit.air.air_radiance, lit.air.air_radiance)
        return Samples(
            radiance=dr.select(hit.valid, arriving, 0.0),
            reflected=dr.select(hit.valid, rho * tau, 0.0),
            temperature_K=dr.select(hit.valid, temperature, 0.0),
            depth=dr.select(hit.valid, hit.depth, dr.inf),
            face=hit.face,
        )

    def merge(self, lit: Lit, now: Instant, pose: DevicePose, samples: Samples) -> Any:
        """Radiance of every group of sub-samples, mirror images and sky included [W m^-2 sr^-1]."""
        mi, dr = backend.modules()
        lane = dr.arange(mi.UInt, dr.width(self._in_pixel))
        total = sum(self._members(samples.radiance, lane))
        reflected = self._members(samples.reflected, lane)
        total += dr.if_stmt(
            args=(lane, *reflected),
            cond=sum(reflected) > 0.0,
            true_fn=lambda lane, *shares: (
                sum(shares) * self._mirror_image(lit, now, pose, samples, lane, shares)
            ),
            false_fn=lambda lane, *shares: mi.Float(0.0),
            label="mirror",
        )
        missed = [dr.select(dr.isinf(d), mi.Float(1.0), 0.0) for d in self._members(samples.depth, lane)]
        total += dr.if_stmt(
            args=tuple(missed),
            cond=sum(missed) > 0.0,
            true_fn=lambda *missed: sum(missed) * self._sky(lit, pose, missed),
            false_fn=lambda *missed: mi.Float(0.0),
            label="sky",
        )
        return total * (1.0 / self._group)

    def pixels(self, groups: Any) -> Any:
        """Mean over the groups of each pixel, of the evaluated result of `merge`."""
        _, dr = backend.modules()
        return groups if self.groups == 1 else dr.block_sum(groups, self.groups) * (1.0 / self.groups)

    def _pixel_of(self, sample: Any) -> Any:
        """Row-major index of the pixel of a sub-sample, counted on from view to view."""
        return pixels.place(self._tiled, sample // self.count)

    def _members(self, values: Any, lane: Any) -> list[Any]:
        """Values of the sub-samples of each group."""
        mi, dr = backend.modules()
        kind = {1: mi.Float, 2: mi.Vector2f, 3: mi.Vector3f, 4: mi.Vector4f}[self._group]
        packet = dr.gather(kind, values, lane)
        return [packet] if self._group == 1 else list(packet)

    def _towards(self, pose: DevicePose, weights: tuple[Any, ...]) -> Any:
        """Camera rays (z = 1 before turning) through the weighted mean place of each group's sub-samples."""
        mi, dr = backend.modules()
        first = self._in_pixel * self._group
        offset = [dr.gather(mi.Vector2f, self._offset, first + k) for k in range(self._group)]
        mean = sum(w * o for w, o in zip(weights, offset, strict=True)) / sum(weights)
        return pose.turn(self._corner.x + mean.x, self._corner.y + mean.y, mi.Float(1.0))

    def _sky(self, lit: Lit, pose: DevicePose, missed: tuple[Any, ...]) -> Any:
        _, dr = backend.modules()
        return lit.air.sky_towards(dr.normalize(self._towards(pose, missed)))

    def _mirror_image(
        self,
        lit: Lit,
        now: Instant,
        pose: DevicePose,
        samples: Samples,
        lane: Any,
        shares: tuple[Any, ...],
    ) -> Any:
        """Radiance that arrives at the mirror which the first mirror-like sub-sample of a group met."""
        mi, dr = backend.modules()
        first = mi.UInt(0)
        for k in reversed(range(self._group)):
            first = dr.select(shares[k] > 0.0, k, first)
        chosen = tuple(dr.select(first == k, mi.Float(1.0), 0.0) for k in range(self._group))
        place = lane * self._group + first
        face = dr.gather(mi.UInt, samples.face, place)
        depth = dr.gather(mi.Float, samples.depth, place)
        return mirror.incoming(
            lit, now, pose, self._towards(pose, chosen), face, depth, self._metre_per_depth
        )
