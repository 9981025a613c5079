"""What a ray finds on a surface: its temperature with texture, and the radiance that leaves it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from scenegen_render import backend
from scenegen_render.trace import noise
from scenegen_render.trace.lit import Lit
from scenegen_render.trace.scenery import Scenery
from scenegen_render.trace.troupe import Instant

_OCTAVES = ((1.0, 1.0), (3.6, 0.53), (13.0, 0.28))
"""Frequency and amplitude: power falls as 1/frequency per octave, the -3 slope of real aerial LWIR spectra."""
_NORM = noise.UNIT / math.sqrt(sum(a * a for _, a in _OCTAVES))


@dataclass(frozen=True, eq=False)
class Hit:
    """Rays that met a surface (and, masked out, those that did not).

    Attributes
    ----------
    valid : mitsuba.Bool
    depth : mitsuba.Float
        Distance in units of the ray's direction.
    rest : mitsuba.Vector3f
        Position in the rest pose [m]: for the world, where it is. A mover's texture is fixed to its body.
    face : mitsuba.UInt
        Of the world, and from `Lit.first_moving` on of the movers.
    uv : mitsuba.Point2f
    moving : mitsuba.Bool
        A mover was met.
    normal : mitsuba.Vector3f
        Outward normal of what moves; zero elsewhere.
    """

    valid: Any
    depth: Any
    rest: Any
    face: Any
    uv: Any
    moving: Any
    normal: Any


@dataclass(frozen=True, eq=False)
class Skin:
    """The surface at a hit.

    Attributes
    ----------
    temperature_K : mitsuba.Float
        Interpolated from the corner sites, without texture.
    irradiance : mitsuba.Float
        Diffuse in-band irradiance, interpolated likewise [W m^-2].
    what : mitsuba.UInt
        ``surface | semantic << 16``.
    normal : mitsuba.Vector3f
    emissivity, texture_K, texture_frequency, mirror : mitsuba.Float
    """

    temperature_K: Any
    irradiance: Any
    what: Any
    normal: Any
    emissivity: Any
    texture_K: Any
    texture_frequency: Any
    mirror: Any


def cast(lit: Lit, now: Instant, origin: Any, direction: Any, near: Any) -> Hit:
    """Trace rays against the world, then as far as they came against the movers of an instant.

    Parameters
    ----------
    near : mitsuba.Bool
        Rays that can meet a mover; the others do not try.
    """
    mi, dr = backend.modules()
    world = lit.loaded.scene.ray_intersect_preliminary(mi.Ray3f(origin, direction), coherent=True)

    def among_movers(origin: Any, direction: Any, t: Any, face: Any, u: Any, v: Any) -> tuple[Any, ...]:
        ray = mi.Ray3f(origin, direction)
        ray.maxt = t
        mover = now.scene.ray_intersect_preliminary(ray, coherent=True)
        met, own, uv = mover.is_valid(), mover.prim_index, mover.prim_uv
        t, face = dr.select(met, mover.t, t), dr.select(met, own + lit.first_moving, face)
        u, v = dr.select(met, uv.x, u), dr.select(met, uv.y, v)
        rest = dr.select(met, _at_rest(lit, own, uv, met), dr.fma(direction, t, origin))
        return t, face, u, v, rest, met, dr.select(met, moving_normal(lit, now, own, met), 0.0)

    def alone(origin: Any, direction: Any, t: Any, face: Any, u: Any, v: Any) -> tuple[Any, ...]:
        return t, face, u, v, dr.fma(direction, t, origin), mi.Bool(False), mi.Vector3f(0.0)

    t, face, u, v, rest, moving, normal = dr.if_stmt(
        args=(origin, direction, world.t, world.prim_index, world.prim_uv.x, world.prim_uv.y),
        cond=near & (world.t >= 0.0),  # always true, but as wide as the rays: `near` may be one for all
        true_fn=among_movers,
        false_fn=alone,
        label="movers",
    )
    return Hit(moving | world.is_valid(), t, rest, face, mi.Point2f(u, v), moving, normal)


def _at_rest(lit: Lit, own: Any, uv: Any, active: Any) -> Any:
    """Positions on movers in their rest pose."""
    mi, dr = backend.modules()
    rest = (dr.gather(mi.Vector4f, lit.troupe.rest, own * 3 + k, active) for k in range(3))
    a, b, c = (mi.Vector3f(corner.x, corner.y, corner.z) for corner in rest)
    return dr.fma(b - a, uv.x, dr.fma(c - a, uv.y, a))


def skin(lit: Lit, hit: Hit) -> Skin:
    """Look up and interpolate what stands at a hit: two packed gathers of one row and one of the small palette."""
    mi, dr = backend.modules()
    warm = dr.gather(mi.Vector4f, lit.face, hit.face * 2, hit.valid)
    shone = dr.gather(mi.Vector4f, lit.face, hit.face * 2 + 1, hit.valid)
    what = dr.reinterpret_array(mi.UInt, warm.w)
    own = dr.gather(mi.Vector4f, lit.surface, what & 0xFFFF, hit.valid)
    u, v = hit.uv.x, hit.uv.y
    return Skin(
        temperature_K=dr.fma(u, warm.y - warm.x, dr.fma(v, warm.z - warm.x, warm.x)),
        irradiance=dr.fma(u, shone.y - shone.x, dr.fma(v, shone.z - shone.x, shone.x)),
        what=what,
        normal=dr.select(hit.moving, hit.normal, unpack_normal(dr.reinterpret_array(mi.UInt, shone.w))),
        emissivity=own.x,
        texture_K=own.y,
        texture_frequency=own.z,
        mirror=own.w,
    )


def textured_K(lit: Lit, hit: Hit, on: Skin, footprint_m: Any) -> Any:
    """Kinetic temperature with the surface's small-scale variation, fixed to its rest position.

    Parameters
    ----------
    footprint_m : mitsuba.Float
        Longest extent of the pixel on the surface. An octave vanishes between one and two lattice spacings, where it
        could only alias.
    """
    mi, dr = backend.modules()
    place = noise.tilted(hit.rest) * on.texture_frequency
    size = footprint_m * on.texture_frequency
    total = mi.Float(0.0)
    for k, (frequency, amplitude) in enumerate(_OCTAVES):
        keep = dr.clip(2.0 - size * frequency, 0.0, 1.0)
        total = dr.fma(
            keep * amplitude, noise.value_noise(place * frequency + 17.3 * k, lit.texture_seed + k), total
        )
    return dr.fma(total, on.texture_K * _NORM, on.temperature_K)


def radiance(lit: Lit, on: Skin, temperature_K: Any, mirror_reflectance: Any) -> Any:
    """Radiance that leaves a surface, but for its mirror image.

    ``eps B(T) + (1 - eps) E / pi`` where it is rough, ``(1 - rho) B(T)`` where it is a mirror (rho > 0).
    """
    mi, dr = backend.modules()
    mirrors = mi.Float(mirror_reflectance) > 0.0
    emissivity = dr.select(mirrors, 1.0 - mirror_reflectance, on.emissivity)
    reflected = dr.select(mirrors, 0.0, on.irradiance * (1.0 - on.emissivity) * (1.0 / math.pi))
    return dr.fma(emissivity, lit.air.blackbody(temperature_K), reflected)


def cosine(on: Skin, unit: Any) -> Any:
    """Cosine between a unit ray direction and the surface normal, either side; not below 0.01."""
    _, dr = backend.modules()
    return dr.maximum(dr.abs(dr.dot(on.normal, unit)), 0.01)


def what(lit: Lit, face: Any, valid: Any) -> Any:
    """``surface | semantic << 16`` of faces; 0 where invalid."""
    mi, dr = backend.modules()
    return dr.reinterpret_array(mi.UInt, dr.gather(mi.Float, lit.face, face * 8 + 3, valid))


def face_normal(lit: Lit, now: Instant, face: Any) -> Any:
    """Outward normal of faces of the world or of movers."""
    mi, dr = backend.modules()
    moving = face >= lit.first_moving
    packed = dr.gather(mi.UInt, lit.loaded.face_normal, face, ~moving)
    own = moving_normal(lit, now, dr.select(moving, face - lit.first_moving, 0))
    return dr.select(moving, own, unpack_normal(packed))


def moving_normal(lit: Lit, now: Instant, own: Any, active: Any = True) -> Any:
    """Outward normal of movers' faces, counted from the troupe's first."""
    _, dr = backend.modules()
    a, b, c = moving_corners(lit, now, own, active)
    return dr.normalize(dr.cross(b - a, c - a))


def moving_corners(lit: Scenery, now: Instant, own: Any, active: Any = True) -> tuple[Any, Any, Any]:
    """World positions of the corners of movers' faces, counted from the troupe's first [m]."""
    mi, dr = backend.modules()
    index = (dr.gather(mi.UInt, lit.troupe.faces, own * 3 + k, active) for k in range(3))
    a, b, c = (dr.gather(mi.Vector3f, now.vertices, k, active) for k in index)
    return a, b, c


def unpack_normal(packed: Any) -> Any:
    """Unit vector from two 16-bit octahedral coordinates (Cigolla et al. 2014, survey of unit vector encodings)."""
    mi, dr = backend.modules()
    x = dr.fma(mi.Float(packed & 0xFFFF), 2.0 / 65534.0, -1.0)
    y = dr.fma(mi.Float(packed >> 16), 2.0 / 65534.0, -1.0)
    z = 1.0 - dr.abs(x) - dr.abs(y)
    fold = dr.maximum(-z, 0.0)
    return dr.normalize(mi.Vector3f(x - dr.copysign(fold, x), y - dr.copysign(fold, y), z))
