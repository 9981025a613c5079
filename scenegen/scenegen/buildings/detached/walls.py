"""Walls of detached houses: where bodies touch, only what rises above the lower one is built."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from scenegen.buildings.detached.body import Body, Home, Role, Top
from scenegen.classes import Semantic
from scenegen.geometry.facade import BLANK, DOOR, WINDOW, Walls, facades
from scenegen.geometry.part import Part, concatenate
from scenegen.geometry.patch import patches

_SHORT_M = 1.5
_GATE_M = 2.15
_FIRST_SITE_M = 0.15
_TUCK_M = 0.05
_BLANK_SPACING_M = 4.0


@dataclass(frozen=True)
class _Run:
    """A stretch of wall in the frame of the lot, left to right seen from outside; heights above the floor."""

    home: int
    body: Body
    a: tuple[float, float]
    b: tuple[float, float]
    low_m: float
    top_m: float
    gate: bool = False
    entrance_m: float | None = None

    @property
    def length_m(self) -> float:
        return abs(self.b[0] - self.a[0]) + abs(self.b[1] - self.a[1])


def home_walls(homes: Sequence[Home], rng: np.random.Generator) -> Part:
    """Walls with windows and doors of all bodies that have walls.

    Parameters
    ----------
    homes : sequence of Home
    rng : numpy.random.Generator
        Chooses windows, and which of them belong to unheated rooms.
    """
    runs = [run for k, home in enumerate(homes) for run in _runs(k, home)]
    blank = [r for r in runs if not r.gate and _storeys(r, homes) == 0]
    pierced = [r for r in runs if r.gate or _storeys(r, homes) > 0]
    walls, filling = _table(pierced, homes, rng)
    return concatenate([_some_unheated(facades(walls, filling), homes, rng), _blank_walls(blank, homes)])


def _runs(index: int, home: Home) -> list[_Run]:
    """All stretches of one house."""
    runs: list[_Run] = []
    for body in home.bodies:
        if body.role is Role.SHELTER:
            continue
        others = [o for o in home.bodies if o is not body and o.role is not Role.SHELTER]
        for side, a, b, top in _sides(body):
            for lo, hi, low in _free(side, a, b, top, others):
                run = _Run(index, body, lo, hi, low, top)
                runs += _with_gates(run, side)
    return [r for r in runs if r.length_m > 0.05 and r.top_m - r.low_m > 0.05]


def _sides(body: Body) -> list[tuple[str, tuple[float, float], tuple[float, float], float]]:
    """Name, ends and height of the four walls."""
    x0, x1, y0, y1 = body.x0_m, body.x1_m, body.y0_m, body.y1_m
    high = {"south": 0.0, "east": 0.0, "north": 0.0, "west": 0.0}
    if body.top is Top.SHED:
        name = ("west" if body.falling else "east") if body.turned else ("south" if body.falling else "north")
        high[name] = body.rise_m
    top = body.eave_m + _TUCK_M
    return [
        ("south", (x0, y0), (x1, y0), top + high["south"]),
        ("east", (x1, y0), (x1, y1), top + high["east"]),
        ("north", (x1, y1), (x0, y1), top + high["north"]),
        ("west", (x0, y1), (x0, y0), top + high["west"]),
    ]


def _free(
    side: str, a: tuple[float, float], b: tuple[float, float], top: float, others: Sequence[Body]
) -> list[tuple[tuple[float, float], tuple[float, float], float]]:
    """Stretches of a side and the height above which they are free of other bodies."""
    across = 1 if side in ("south", "north") else 0
    line, start, end = a[across], min(a[1 - across], b[1 - across]), max(a[1 - across], b[1 - across])
    cuts: list[tuple[float, float, float]] = []
    for other in others:
        spans = ((other.x0_m, other.x1_m), (other.y0_m, other.y1_m))
        if min(abs(spans[across][0] - line), abs(spans[across][1] - line)) > 1e-6:
            continue
        lo, hi = max(spans[1 - across][0], start), min(spans[1 - across][1], end)
        if hi - lo > 1e-6:
            cuts.append((lo, hi, other.eave_m))
    marks = sorted({start, end, *(c[0] for c in cuts), *(c[1] for c in cuts)})
    found = []
    for lo, hi in pairwise(marks):
        low = max((h for p, q, h in cuts if p <= lo + 1e-9 and hi <= q + 1e-9), default=0.0)
        if low < top - 0.3:
            found.append((lo, hi, low))
    forward = b[1 - across] > a[1 - across]

    def point(value: float) -> tuple[float, float]:
        return (value, line) if across == 1 else (line, value)

    return [(point(lo), point(hi), low) if forward else (point(hi), point(lo), low) for lo, hi, low in found]


def _with_gates(run: _Run, side: str) -> list[_Run]:
    """A southern stretch cut at garage doors, with the front door in what is left."""
    if side != "south" or run.low_m > 0.0:
        return [run]
    pieces, x = [], run.a[0]
    for name, a, b in sorted(run.body.doors):
        if name == side and x <= a and b <= run.b[0]:
            pieces += [replace(run, a=(x, run.a[1]), b=(a, run.a[1]))]
            pieces += [replace(run, a=(a, run.a[1]), b=(b, run.a[1]), gate=True)]
            x = b
    pieces.append(replace(run, a=(x, run.a[1])))
    door = run.body.entrance_m
    return [
        replace(p, entrance_m=door) if door is not None and not p.gate and p.a[0] <= door <= p.b[0] else p
        for p in pieces
    ]


def _storeys(run: _Run, homes: Sequence[Home]) -> int:
    """Window rows of a stretch; 0 for blank walls."""
    style = homes[run.home].style
    if run.length_m < _SHORT_M:
        return 0
    covered = round(run.low_m / style.storey_m)
    return max(run.body.storeys - covered, 0)


def _table(runs: Sequence[_Run], homes: Sequence[Home], rng: np.random.Generator) -> tuple[Walls, np.ndarray]:
    """One row per pierced stretch, and what fills its cells."""
    styles = [homes[r.home].style for r in runs]
    lots = [homes[r.home].lot for r in runs]
    storeys = np.array([_storeys(r, homes) or 1 for r in runs], np.int64)
    storey_m = np.array([s.storey_m for s in styles])
    hut = np.array([r.body.role is not Role.HOUSE for r in runs])
    gate = np.array([r.gate for r in runs])
    low = np.array([r.low_m for r in runs])
    covered = np.rint(low / storey_m) * storey_m
    pitch = np.array([s.pitch_m for s in styles])
    length = np.array([r.length_m for r in runs])
    columns = np.where(gate, 1, np.maximum(np.rint(length / pitch), 1)).astype(np.int64)
    sill, head = np.array([s.sill_m for s in styles]), np.array([s.head_m for s in styles])
    top = np.array([r.top_m for r in runs])
    head = np.minimum(
        head, np.array([r.body.eave_m for r in runs]) - covered - (storeys - 1) * storey_m - 0.2
    )
    sill = np.minimum(sill, head - 0.5)
    floor = np.array([homes[r.home].floor_m for r in runs])
    depth = np.array([homes[r.home].foundation_m for r in runs])
    share = np.array([s.window_share for s in styles]) * np.where(hut, 0.7, 1.0)
    walls = Walls(
        start=np.array([lot.world(np.array([r.a]))[0] for r, lot in zip(runs, lots, strict=True)]),
        end=np.array([lot.world(np.array([r.b]))[0] for r, lot in zip(runs, lots, strict=True)]),
        floor_m=floor + covered,
        foundation_m=np.where(low > 0, covered - low, depth),
        top_m=floor + top,
        storeys=storeys,
        first_storey_m=storey_m,
        storey_m=storey_m,
        columns=columns,
        window_share=np.where(gate, 0.86, np.clip(share, 0.2, 0.9)),
        sill_m=sill,
        head_m=head,
        first_sill_m=np.where(gate, 0.9, sill),
        first_head_m=np.where(gate, np.minimum(_GATE_M, top - 0.2), np.maximum(head, sill + 0.4)),
        surface=np.array([s.wall for s in styles], np.int64),
        glass=np.array([s.glass for s in styles], np.int64),
        door=np.array([s.gate if r.gate else s.door for r, s in zip(runs, styles, strict=True)], np.int64),
        object=np.array([homes[r.home].object for r in runs], np.int64),
        recess_m=np.array([s.recess_m for s in styles]),
    )
    return walls, _filling(
        walls, runs, styles_blank=np.array([s.blank_share for s in styles]), hut=hut, rng=rng
    )


def _filling(
    walls: Walls, runs: Sequence[_Run], styles_blank: np.ndarray, hut: np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    """Windows, the front door nearest to where it should be, garage doors over the whole stretch."""
    wall, column, storey = walls.cells()
    blank = np.where(hut, 0.75, styles_blank)
    filling = np.where(rng.uniform(size=len(wall)) < blank[wall], BLANK, WINDOW)
    length = np.array([r.length_m for r in runs])
    wanted = np.array([np.nan if r.entrance_m is None else r.entrance_m - r.a[0] for r in runs])
    entrance = np.where(np.isnan(wanted), -1, np.nan_to_num(wanted) / length * walls.columns).astype(np.int64)
    entrance = np.where(np.isnan(wanted), -1, np.clip(entrance, 0, walls.columns - 1))
    ground = (storey == 0) & (np.array([r.low_m for r in runs])[wall] == 0.0)
    filling[ground & (column == entrance[wall])] = DOOR
    filling[ground & np.array([r.gate for r in runs])[wall]] = DOOR
    return filling


def _some_unheated(part: Part, homes: Sequence[Home], rng: np.random.Generator) -> Part:
    """Give some panes the glass of unheated rooms; each pane is two faces with one site of their own."""
    panes = np.flatnonzero(part.semantic == int(Semantic.WINDOW))
    share = {h.object: h.style.unheated_share for h in homes}
    cold = {h.object: h.style.cold_glass for h in homes}
    first = panes[::2]
    owner = part.object[first].tolist()
    chosen = rng.uniform(size=len(first)) < np.array([share[o] for o in owner])
    skin = np.where(chosen, np.array([cold[o] for o in owner], np.int64), part.surface[first])
    surface = part.surface.copy()
    surface[panes] = np.repeat(skin, 2)
    return replace(part, surface=surface)


def _blank_walls(runs: Sequence[_Run], homes: Sequence[Home]) -> Part:
    """Walls too short or too low for a window."""
    corners = np.zeros((len(runs), 4, 3))
    for k, run in enumerate(runs):
        home = homes[run.home]
        low = home.floor_m + (run.low_m if run.low_m > 0 else -home.foundation_m)
        ends = home.lot.world(np.array([run.a, run.b, run.b, run.a]))
        corners[k] = np.column_stack([ends, [low, low, home.floor_m + run.top_m, home.floor_m + run.top_m]])
    skin = np.array([homes[r.home].style.wall for r in runs], np.int64)
    owner = np.array([homes[r.home].object for r in runs], np.int64)
    semantic = np.full(len(runs), int(Semantic.WALL))
    part = patches(corners, _BLANK_SPACING_M, skin, semantic, owner)
    floors = np.array([homes[r.home].floor_m for r in runs])
    item = np.zeros(len(part.site_position), np.int64)
    item[part.corner_site.ravel()] = np.repeat(
        np.searchsorted(np.cumsum(_faces_of(corners)), np.arange(len(part.faces)), side="right"), 3
    )
    position = part.site_position.copy()
    if len(runs):
        position[:, 2] = np.maximum(position[:, 2], floors[item] + _FIRST_SITE_M)
    return replace(part, site_position=position)


def _faces_of(corners: np.ndarray) -> np.ndarray:
    """Triangles that `patches` makes of each quad."""
    wide = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1)
    tall = np.linalg.norm(corners[:, 3] - corners[:, 0], axis=1)
    cells = [np.maximum(np.ceil(x / _BLANK_SPACING_M - 1e-9), 1).astype(np.int64) for x in (wide, tall)]
    return np.asarray(2 * cells[0] * cells[1])
