"""Sums over the gather list, on the device: shares of sky and of emitter groups, means of any quantity."""

from __future__ import annotations

from typing import Any

import numpy as np
from jaxtyping import Float32, UInt8, UInt32

from scenegen.exposure import SKY_BINS
from scenegen_render import backend

_PER_WORD, _BITS = 5, 12
"""Counters packed into one 64-bit word: five of twelve bits, for at most 4,095 directions."""


def mean_over_list(gather: Any, values: Any, directions: int) -> Any:
    """Mean over the directions of `values` at what each ray of each site meets.

    Parameters
    ----------
    gather : mitsuba.UInt
        Gather list on the device, direction-major, of all sites or of some.
    values : mitsuba.Float
        One per site, then one per sky bin.
    directions : int

    Returns
    -------
    mitsuba.Float
        One per site of the list; summed in the order of the directions.
    """
    mi, dr = backend.modules()
    (total,) = _sums(gather, (values,), directions)
    return total / dr.opaque(mi.Float, directions)


def open_share(gather: UInt32[np.ndarray, "directions sites"]) -> Float32[np.ndarray, "sites"]:
    """Share of the directions that meet the open sky above the horizon."""
    directions, sites = gather.shape
    is_sky = np.zeros(sites + SKY_BINS, np.float32)
    is_sky[sites + 1 :] = 1.0
    return np.asarray(mean_over_list(backend.upload(gather), backend.upload(is_sky), directions))


def shares(
    gather: UInt32[np.ndarray, "directions some"], group: UInt8[np.ndarray, "sites"], groups: int
) -> tuple[Float32[np.ndarray, "some"], Float32[np.ndarray, "some groups"]]:
    """Cosine-weighted share of the hemisphere that is open sky, and that each emitter group takes.

    Rays that leave the world at or below the horizon count as neither: the heat balance treats what is missing as
    ground far away.

    Parameters
    ----------
    gather : uint32 (directions, some)
        List of all sites, or of some of them.
    group : uint8 (sites,)
        Of all sites.
    groups : int
    """
    mi, dr = backend.modules()
    directions, some = gather.shape
    sites = len(group)
    counters = groups + 1
    slot = np.concatenate([group, np.full(SKY_BINS, groups, np.uint8)]).astype(np.uint64)
    word, shift = slot // _PER_WORD, slot % _PER_WORD * _BITS
    one = np.uint64(1) << shift
    one[sites] = 0  # bin 0: the horizon and below
    tables = [
        dr.opaque(mi.UInt64(np.where(word == w, one, np.uint64(0)))) for w in range(-(-counters // _PER_WORD))
    ]
    words = _sums(backend.upload(gather), tuple(tables), directions)
    counts = np.empty((some, counters), np.float32)
    mask = np.uint64((1 << _BITS) - 1)
    for w, packed in enumerate(np.asarray(x) for x in words):
        for k in range(min(_PER_WORD, counters - w * _PER_WORD)):
            counts[:, w * _PER_WORD + k] = packed >> np.uint64(k * _BITS) & mask
    counts /= np.float32(directions)
    return counts[:, groups].copy(), counts[:, :groups].copy()


def _sums(gather: Any, tables: tuple[Any, ...], directions: int) -> tuple[Any, ...]:
    """Sum several tables over the list in one kernel, whatever the number of directions."""
    mi, dr = backend.modules()
    sites = dr.opaque(mi.UInt, dr.width(gather) // directions)
    last = dr.opaque(mi.UInt, directions)
    site = dr.arange(mi.UInt, dr.width(gather) // directions)

    def step(k: Any, *sums: Any) -> tuple[Any, ...]:
        met = dr.gather(mi.UInt, gather, k * sites + site)
        added = (s + dr.gather(type(s), table, met) for s, table in zip(sums, tables, strict=True))
        return (k + 1, *added)

    zero = tuple(dr.zeros(type(table), dr.width(site)) for table in tables)
    state = (mi.UInt(0), *zero)
    _, *totals = dr.while_loop(state, lambda k, *_: k < last, step, label="gather list")
    dr.eval(totals)
    return tuple(totals)
