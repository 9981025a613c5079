"""Hashed value noise: a random field that is fixed in space and costs no memory."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from scenegen_render import backend

_PRIMES = (0x8DA6B343, 0xD8163841, 0xCB1AB31F)
_CELL_VARIANCE = (26.0 / 35.0) ** 3 / 12.0
"""Variance of smoothstep-interpolated values uniform on [-1/2, 1/2], averaged over the cell."""
UNIT = 1.0 / math.sqrt(_CELL_VARIANCE)
"""Factor that gives :func:`value_noise` a standard deviation of one."""


def _tilt() -> tuple[tuple[float, float, float], ...]:
    """A rotation with no special directions, so that the lattice is parallel to no street and no wall."""
    a, b = 0.61, 1.07
    rx = np.array([[1, 0, 0], [0, math.cos(a), -math.sin(a)], [0, math.sin(a), math.cos(a)]])
    rz = np.array([[math.cos(b), -math.sin(b), 0], [math.sin(b), math.cos(b), 0], [0, 0, 1]])
    return tuple((float(x), float(y), float(z)) for x, y, z in rz @ rx @ rz)


_TILT = _tilt()


def tilted(p: Any) -> Any:
    """Rotate positions into the frame of the lattice."""
    mi, dr = backend.modules()
    return mi.Vector3f(*(dr.fma(p.x, a, dr.fma(p.y, b, p.z * c)) for a, b, c in _TILT))


def value_noise(p: Any, seed: Any) -> Any:
    """Smooth random field with unit lattice spacing; zero mean, standard deviation ``1 / UNIT``.

    Parameters
    ----------
    p : mitsuba.Vector3f
        Positions in lattice units.
    seed : mitsuba.UInt
        Opaque, else every seed compiles a kernel.
    """
    mi, dr = backend.modules()
    base = dr.floor(p)
    f = p - base
    w = f * f * dr.fma(f, -2.0, 3.0)
    cell = mi.Vector3i(base)
    low = [mi.UInt(cell[k]) * prime for k, prime in enumerate(_PRIMES)]
    high = [h + prime for h, prime in zip(low, _PRIMES, strict=True)]
    edges = []
    for y in (low[1], high[1]):
        for z in (low[2] ^ seed, high[2] ^ seed):
            edges.append(dr.lerp(_value(low[0] ^ y ^ z), _value(high[0] ^ y ^ z), w.x))
    return dr.lerp(dr.lerp(edges[0], edges[1], w.z), dr.lerp(edges[2], edges[3], w.z), w.y)


def _value(h: Any) -> Any:
    """Hash to a number in [-1/2, 1/2): two multiply-xorshift rounds, the top 23 bits as a mantissa."""
    mi, dr = backend.modules()
    h = (h ^ (h >> 16)) * 0x7FEB352D
    h = (h ^ (h >> 15)) * 0x846CA68B
    return dr.reinterpret_array(mi.Float, (h >> 9) | 0x3F800000) - 1.5
