"""Glass, water and bare metal: a mirrored ray, never a random one."""

from __future__ import annotations

from typing import Any

from scenegen_render import backend
from scenegen_render.trace import surface
from scenegen_render.trace.lit import Lit
from scenegen_render.trace.pose import DevicePose
from scenegen_render.trace.troupe import Instant

_LIFT = 2e-3
"""Start of the mirrored ray above the surface [m]; far more than float32 rounding at city distances."""


def reflectance(lit: Lit, hit: surface.Hit, on: surface.Skin, cosine: Any) -> Any:
    """Mirror reflectance: Fresnel's for smooth dielectrics, a constant for bare metals, zero for all else."""
    mi, dr = backend.modules()

    def of_mirror(what: Any, cosine: Any) -> Any:
        n, k, constant, _ = dr.gather(mi.Vector4f, lit.mirror, what & 0xFFFF)
        fresnel = mi.fresnel_conductor(cosine, mi.Complex2f(n, k))
        return dr.select(n > 0.0, fresnel, constant)

    return dr.if_stmt(
        args=(on.what, cosine),
        cond=hit.valid & (on.mirror > 0.0),
        true_fn=of_mirror,
        false_fn=lambda what, cosine: mi.Float(0.0),
        label="fresnel",
    )


def incoming(lit: Lit, now: Instant, pose: DevicePose, towards: Any, face: Any, depth: Any) -> Any:
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
    """
    _, dr = backend.modules()
    normal = surface.face_normal(lit, now, face)
    unit = dr.normalize(towards)
    facing = -dr.dot(normal, unit)
    normal = dr.mulsign(normal, facing)
    outgoing = dr.fma(normal, 2.0 * dr.abs(facing), unit)
    start = dr.fma(normal, _LIFT, dr.fma(towards, depth, pose.translation))
    met = surface.cast(lit, now, start, outgoing, lit.troupe.present)
    there = surface.skin(lit, met)
    leaving = surface.radiance(lit, there, there.temperature_K, 0.0)
    return dr.select(met.valid, lit.air.through(leaving, met.depth), lit.air.sky_towards(outgoing))
