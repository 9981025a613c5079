"""What holds for the arrays of every stored frame: guarded before encoding, proven again by `verify`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenegen.classes import CLASSES, Semantic
from scenegen.materials.table import materials
from scenegen_datasets.layers import MAX_COUNT

_EDGE_PX = 1e-3
"""Flow and the covisibility test round differently in float32; a point this near to the edge may be either."""


def violations(arrays: Mapping[str, NDArray[Any]]) -> list[str]:
    """Return what is wrong with the layers of one frame, in words; empty if nothing is."""
    checks = {
        "thermal": _thermal,
        "depth": _depth,
        "radiance": _radiance,
        "temperature": _temperature,
        "semantic": _semantic,
        "material": _material,
        "flow": _flow,
        "flow_back": _flow,
        "normal": _normal,
        "imu": _imu,
    }
    found = []
    for name, check in checks.items():
        if name in arrays:
            found += [f"{name}: {text}" for text in check(arrays, name)]
    return found


def _thermal(arrays: Mapping[str, NDArray[Any]], name: str) -> Iterator[str]:
    if arrays[name].max() > MAX_COUNT:
        yield f"counts above {MAX_COUNT}"


def _depth(arrays: Mapping[str, NDArray[Any]], name: str) -> Iterator[str]:
    depth = arrays[name]
    if not (depth > 0).all():
        yield "not positive (or NaN)"
    if "semantic" in arrays and not np.array_equal(np.isinf(depth), arrays["semantic"] == Semantic.SKY):
        yield "infinite elsewhere than exactly in the sky"


def _radiance(arrays: Mapping[str, NDArray[Any]], name: str) -> Iterator[str]:
    low, high = arrays[name].min(), arrays[name].max()
    if not (low > 0 and np.isfinite(high)):
        yield "not finite and positive"


def _temperature(arrays: Mapping[str, NDArray[Any]], name: str) -> Iterator[str]:
    low, high = arrays[name].min(), arrays[name].max()
    if not (low >= 0 and np.isfinite(high)):
        yield "not finite, or below 0 K"
    if "semantic" in arrays and not np.array_equal(arrays[name] == 0, arrays["semantic"] == Semantic.SKY):
        yield "0 K elsewhere than exactly in the sky"


def _semantic(arrays: Mapping[str, NDArray[Any]], name: str) -> Iterator[str]:
    if arrays[name].max() >= len(CLASSES):
        yield f"class id {arrays[name].max()} is not in the class list"
    solid = arrays[name] != Semantic.SKY
    for ids in ("instance", "material"):
        if ids in arrays and ((arrays[ids] != 0) & ~solid).any():
            yield f"sky has an {ids} id"
    if "material" in arrays and ((arrays["material"] == 0) & solid).any():
        yield "a surface has no material"


def _material(arrays: Mapping[str, NDArray[Any]], name: str) -> Iterator[str]:
    known = _known_materials()[arrays[name]]
    if not known.all():
        yield f"material id {arrays[name][~known].min()} is not in the material table"


@cache
def _known_materials() -> NDArray[np.bool_]:
    """Look-up table over all uint16: sky, the table's ids, and a user's own from 1,000 on."""
    known = np.zeros(1 << 16, bool)
    known[[0, *(m.id for m in materials().values())]] = True
    known[1000:] = True
    return known


def _flow(arrays: Mapping[str, NDArray[Any]], name: str) -> Iterator[str]:
    flow = arrays[name]
    if np.isinf(flow).any():
        yield "infinite"
    seen = arrays.get(name.replace("flow", "covisible"))
    if seen is None:
        return
    rows, columns = seen.shape
    right = flow[..., 0] + np.arange(0.5, columns, dtype=np.float32)
    down = flow[..., 1] + np.arange(0.5, rows, dtype=np.float32)[:, None]
    inside = (
        (right >= -_EDGE_PX) & (right <= columns + _EDGE_PX) & (down >= -_EDGE_PX) & (down <= rows + _EDGE_PX)
    )
    if (seen & ~inside).any():
        yield "a covisible point lies outside the other image (or is NaN)"


def _normal(arrays: Mapping[str, NDArray[Any]], name: str) -> Iterator[str]:
    length = np.einsum("...k,...k->...", arrays[name], arrays[name])
    if not ((np.abs(length - 1) < 1e-3) | (length == 0)).all():
        yield "not of unit length"


def _imu(arrays: Mapping[str, NDArray[Any]], name: str) -> Iterator[str]:
    if not np.isfinite(arrays[name]).all():
        yield "not finite"
    if (np.diff(arrays[name][:, 0]) <= 0).any():
        yield "time does not rise"
