"""The street network before it winds: rows and links of a loose lattice, some cut into dead ends, all connected."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from jaxtyping import Float64
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

TURNING_RADIUS_M = 9.5
"""Radius of the circle at the end of a dead end [m]."""

_LINK_PITCH_M = (150.0, 215.0)
_SNAP_M, _APART_M = 24.0, 48.0
_SHORTEST_STUB_M, _SHORTEST_END_M = 40.0, 62.0
_OUT_M = 35.0
_FILLET_M = 22.0


@dataclass(frozen=True, eq=False)
class Network:
    """Centre lines in the plane before the warp.

    Attributes
    ----------
    lines : tuple of float64 (points, 2)
        Between junctions, dead ends and exits; corners are rounded.
    dead_end : tuple of (bool, bool)
        Whether each line starts, ends in a turning circle.
    exits : float64 (exits, 2, 2)
        End points of lines that leave, and their directions.
    """

    lines: tuple[Float64[np.ndarray, "_ 2"], ...]
    dead_end: tuple[tuple[bool, bool], ...]
    exits: Float64[np.ndarray, "exits 2 2"]


def draw_network(
    extent_m: float, row_pitch_m: float, cul_de_sac_share: float, rng: np.random.Generator
) -> Network:
    """Draw a network around the origin.

    Parameters
    ----------
    extent_m : float
        Side of the square it fills.
    row_pitch_m : float
        Distance between parallel streets: two lots and a street.
    cul_de_sac_share : float
        Share of stretches that are cut.
    rng : numpy.random.Generator
    """
    rows = max(round(extent_m / row_pitch_m), 3)
    y = (np.arange(rows) - (rows - 1) / 2) * row_pitch_m
    half = extent_m / 2 - 0.35 * row_pitch_m
    reach = half * np.sqrt(np.clip(1.06 - (y / (1.25 * extent_m / 2)) ** 4, 0.25, 1.0))
    links = _links(reach, rng)
    edges = _edges(y, reach, links)
    kept, stubs = _cut(edges, row_pitch_m, cul_de_sac_share, rng)
    exits, out = _exits(kept, y, rng)
    lines = [shapely.LineString(e) for e in (*kept, *stubs, *out)]
    merged = shapely.get_parts(shapely.line_merge(shapely.multilinestrings(lines)))
    rounded = [_fillet(shapely.get_coordinates(line)) for line in merged]
    return Network(tuple(rounded), _dead_ends(rounded, exits[:, 0]), exits)


def _links(reach: np.ndarray, rng: np.random.Generator) -> list[np.ndarray]:
    """Abscissae of the links between each row and the next: staggered, or in line with those before."""
    pitch = rng.uniform(*_LINK_PITCH_M)
    found: list[np.ndarray] = []
    for k in range(len(reach) - 1):
        edge = min(reach[k], reach[k + 1])
        count = max(round(2 * edge / pitch), 1)
        x = np.linspace(-edge, edge, count + 1) + rng.uniform(-0.22, 0.22, count + 1) * pitch
        x = np.clip(x, -edge, edge)
        if found:
            gap = x[:, None] - found[-1][None]
            near = np.abs(gap).argmin(axis=1)
            least = gap[np.arange(len(x)), near]
            x = np.where(np.abs(least) < _SNAP_M, found[-1][near], x)
            push = (np.abs(least) >= _SNAP_M) & (np.abs(least) < _APART_M)
            x = np.where(push, found[-1][near] + np.sign(least) * _APART_M, x)
        x = np.unique(np.clip(x, -edge, edge))
        found.append(x[np.concatenate([[True], np.diff(x) > 60.0])])
    return found


def _edges(y: np.ndarray, reach: np.ndarray, links: list[np.ndarray]) -> list[np.ndarray]:
    """All stretches between nodes, rows first."""
    edges = []
    for k in range(len(y)):
        x = np.unique(np.concatenate([*links[max(k - 1, 0) : k], *links[k : k + 1]]))
        # A row goes on beyond its last link only if there is room for a few houses.
        before = [-reach[k]] if x[0] + reach[k] > _SHORTEST_END_M else []
        after = [reach[k]] if reach[k] - x[-1] > _SHORTEST_END_M else []
        x = np.concatenate([before, x, after])
        edges += [np.array([[a, y[k]], [b, y[k]]]) for a, b in pairwise(x)]
    for k, row in enumerate(links):
        edges += [np.array([[x, y[k]], [x, y[k + 1]]]) for x in row]
    return edges


def _cut(
    edges: list[np.ndarray], pitch_m: float, share: float, rng: np.random.Generator
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Stretches that stay, and the stubs left of those that are cut; what stays is connected."""
    keep = np.ones(len(edges), bool)
    wish = rng.uniform(size=len(edges)) < share
    gap = TURNING_RADIUS_M + 0.42 * pitch_m
    stubs: list[np.ndarray] = []
    for k in rng.permutation(len(edges)):
        if not wish[k]:
            continue
        keep[k] = False
        if not _connected([e for e, stay in zip(edges, keep, strict=True) if stay], edges):
            keep[k] = True
            continue
        a, b = edges[k]
        length = float(np.linalg.norm(b - a))
        step = (b - a) / length
        if length - 2 * gap > 2 * _SHORTEST_STUB_M:
            middle = length / 2 + rng.uniform(-0.1, 0.1) * length
            stubs += [
                np.array([a, a + (middle - gap) * step]),
                np.array([b, b - (length - middle - gap) * step]),
            ]
        elif length - gap - 8.0 > _SHORTEST_STUB_M:
            start, sign = (a, 1.0) if rng.uniform() < 0.5 else (b, -1.0)
            stubs.append(np.array([start, start + sign * (length - gap - 8.0) * step]))
    kept = [e for e, stay in zip(edges, keep, strict=True) if stay]
    nodes = np.concatenate(kept)
    rooted = [
        s for s in stubs if np.linalg.norm(nodes - s[0], axis=1).min() < 0.01
    ]  # its root may be gone by now
    return kept, rooted


def _connected(kept: list[np.ndarray], edges: list[np.ndarray]) -> bool:
    """Whether the stretches form one network that still reaches every node that had two or more."""
    ends = np.rint(np.concatenate(edges) * 100).astype(np.int64)
    node, degree = np.unique(ends, axis=0, return_counts=True)
    points, index = np.unique(
        np.rint(np.concatenate(kept) * 100).astype(np.int64), axis=0, return_inverse=True
    )
    needed = {tuple(n) for n in node[degree > 2].tolist()}
    if not needed <= {tuple(p) for p in points.tolist()}:
        return False
    a, b = index.ravel()[::2], index.ravel()[1::2]
    graph = coo_matrix((np.ones(len(a)), (a, b)), shape=(len(points), len(points)))
    return int(connected_components(graph, directed=False)[0]) == 1


def _exits(
    kept: list[np.ndarray], y: np.ndarray, rng: np.random.Generator
) -> tuple[np.ndarray, list[np.ndarray]]:
    """Two or three rows go on outwards, to either side by turns."""
    ends = np.concatenate(kept)
    found, lines = [], []
    order = rng.permutation(np.arange(1, len(y) - 1)) if len(y) > 3 else np.arange(len(y))
    for n, k in enumerate(order[: int(rng.integers(2, 4))]):
        side = 1.0 if n % 2 == 0 else -1.0
        row = ends[np.abs(ends[:, 1] - y[k]) < 0.05]
        if not len(row):
            continue
        start = row[int(np.argmax(side * row[:, 0]))]
        stop = np.array([side * (np.abs(ends[:, 0]).max() + _OUT_M), y[k]])
        lines.append(np.array([start, stop]))
        found.append([stop, np.array([side, 0.0])])
    return np.array(found, np.float64).reshape(-1, 2, 2), lines


def _fillet(line: np.ndarray) -> np.ndarray:
    """Corners become quadratic curves; a closed line keeps its first point."""
    pieces = [line[:1]]
    t = np.linspace(0.0, 1.0, 9)[:, None]
    for before, corner, after in zip(line[:-2], line[1:-1], line[2:], strict=True):
        u, v = before - corner, after - corner
        a = corner + u * min(_FILLET_M / np.linalg.norm(u), 0.45)
        b = corner + v * min(_FILLET_M / np.linalg.norm(v), 0.45)
        pieces.append((1 - t) ** 2 * a + 2 * t * (1 - t) * corner + t**2 * b)
    return np.concatenate([*pieces, line[-1:]])


def _dead_ends(lines: list[np.ndarray], exits: np.ndarray) -> tuple[tuple[bool, bool], ...]:
    """Which ends meet no other line and are no exits."""
    ends = np.array([[line[0], line[-1]] for line in lines])
    flat = ends.reshape(-1, 2)
    meets = (np.linalg.norm(flat[:, None] - flat[None], axis=2) < 0.05).sum(axis=1) > 1
    if len(exits):
        meets |= np.linalg.norm(flat[:, None] - exits[None], axis=2).min(axis=1) < 0.05
    free = ~meets.reshape(-1, 2)
    return tuple((bool(a), bool(b)) for a, b in free)
