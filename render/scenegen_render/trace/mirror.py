"""Glass, water and bare metal: a mirrored ray, never a random one."""

from __future__ import annotations

from typing import Any

from scenegen_render import backend
from scenegen_render.trace import ripples, surface
from scenegen_render.trace.lit import Lit
from scenegen_render.trace.pose import DevicePose
from scenegen_render.trace.troupe import Instant

_LIFT = 2e-3
"""Start of the mirrored ray above the surface [m]; far more than float32 rounding at city distances."""


def reflectance(lit: Lit, hit: surface.Hit, on: surface.Skin, unit: Any, footprint_m: Any) -> Any:
    """Mirror reflectance: Fresnel's for dielectrics, a constant for bare metals, zero for all else.

    Parameters
    ----------
    unit : mitsuba.Vector3f
        Direction from the eye.
    footprint_m : mitsuba.Float
        Longest extent of the pixel on the surface.
    """
    mi, dr = backend.modules()

    def of_mirror(what: Any, normal: Any, unit: Any, place: Any, footprint_m: Any) -> Any:
        n, k, constant, slope = dr.gather(mi.Vector4f, lit.mirror, what & 0xFFFF)
        mean = dr.mulsign(normal, -dr.dot(normal, unit))
        facet = ripples.normal(slope, mean, unit, place, footprint_m, lit.texture_seed)
        cosine = dr.maximum(-dr.dot(facet, unit), 0.01)
        fresnel = mi.fresnel_conductor(cosine, mi.Complex2f(n, k))
        return dr.select(n > 0.0, fresnel, constant)

    return dr.if_stmt(
        args=(on.what, on.normal, unit, hit.rest, footprint_m),
        cond=hit.valid & (on.mirror > 0.0),
        true_fn=of_mirror,
        false_fn=lambda *_: mi.Float(0.0),
        label="fresnel",
    )


def incoming(
    lit: Lit, now: Instant, pose: DevicePose, towards: Any, face: Any, depth: Any, metre_per_depth: float
) -> Any:
    """Radiance a mirror receives from its mirror direction, L_in.

    It is the sky, or what the mirrored ray meets (its emission and baked reflection, without texture, which averages
    out), after the air of that leg.

    Parameters
    ----------
    now : Instant
        Of the movers, which mirrors show too.
    towards : mitsuba.Vector3f
        Direction of the camera ray that met the mirror.
    face : mitsuba.UInt
        The mirror's face.
    depth : mitsuba.Float
        Distance to it in units of `towards`.
    metre_per_depth : float
        Width of a pixel at a distance of one.
    """
    mi, dr = backend.modules()
    normal = surface.face_normal(lit, now, face)
    unit = dr.normalize(towards)
    facing = -dr.dot(normal, unit)
    mean = dr.mulsign(normal, facing)
    place = dr.fma(towards, depth, pose.translation)
    slope = dr.gather(mi.Vector4f, lit.mirror, surface.what(lit, face, True) & 0xFFFF).w
    footprint_m = depth * metre_per_depth / dr.maximum(dr.abs(facing), 0.01)
    facet = ripples.normal(slope, mean, unit, place, footprint_m, lit.texture_seed)
    outgoing = dr.fma(facet, -2.0 * dr.dot(facet, unit), unit)
    start = dr.fma(mean, _LIFT, place)
    met = surface.cast(lit, now, start, outgoing, lit.troupe.present)
    there = surface.skin(lit, met)
    leaving = surface.radiance(lit, there, there.temperature_K, 0.0)
    return dr.select(met.valid, lit.air.through(leaving, met.depth), lit.air.sky_towards(outgoing))
