"""Glass, water and bare metal: one mirrored ray each, never a random one."""

from __future__ import annotations

from typing import Any

from scenegen_render import backend
from scenegen_render.trace.lit import Lit
from scenegen_render.trace.surface import Hit, Skin, cast, diffuse_radiance, skin

_LIFT = 2e-3
"""Start of the mirrored ray above the surface [m]; far more than float32 rounding at city distances."""


def with_mirror(lit: Lit, hit: Hit, on: Skin, temperature_K: Any, towards: Any, radiance: Any) -> Any:
    """Replace the radiance of mirror-like surfaces by ``(1 - rho) B(T) + rho L_in``.

    L_in is the sky, or what the mirrored ray meets (its emission and baked reflection, without texture, which
    averages out), after the air of that leg.

    Parameters
    ----------
    towards : mitsuba.Vector3f
        Unit direction of the incoming ray (from the camera).
    radiance : mitsuba.Float
        Diffuse radiance, kept where the surface is not a mirror.
    """
    _, dr = backend.modules()
    return dr.if_stmt(
        args=(radiance, hit.point, on.normal, on.what, temperature_K, towards),
        cond=hit.valid & (on.mirror > 0.0),
        true_fn=lambda _, point, normal, what, kelvin, d: _mirrored(lit, point, normal, what, kelvin, d),
        false_fn=lambda radiance, *_: radiance,
        arg_labels=("radiance", "point", "normal", "what", "temperature", "towards"),
        label="mirror",
    )


def _mirrored(lit: Lit, point: Any, normal: Any, what: Any, temperature_K: Any, towards: Any) -> Any:
    mi, dr = backend.modules()
    facing = -dr.dot(normal, towards)
    normal = dr.mulsign(normal, facing)
    cosine = dr.clip(dr.abs(facing), 1e-4, 1.0)
    outgoing = dr.fma(normal, 2.0 * cosine, towards)
    incoming = _incoming(lit, dr.fma(normal, _LIFT, point), outgoing)
    n, k, constant, _ = dr.gather(mi.Vector4f, lit.mirror, what & 0xFFFF)
    rho = dr.select(n > 0.0, mi.fresnel_conductor(cosine, mi.Complex2f(n, k)), constant)
    return dr.lerp(lit.air.blackbody(temperature_K), incoming, rho)


def _incoming(lit: Lit, origin: Any, direction: Any) -> Any:
    """Radiance arriving at a mirror along unit directions."""
    _, dr = backend.modules()
    met = cast(lit, origin, direction, coherent=False)
    there = skin(lit, met)
    surface = lit.air.through(diffuse_radiance(lit, there, there.temperature_K), met.depth)
    return dr.select(met.valid, surface, lit.air.sky_towards(direction, ~met.valid))
