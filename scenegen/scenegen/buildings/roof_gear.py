"""What stands on roofs: air handlers, vents, lift houses, skylights, chimneys."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from scenegen.buildings.building import Building
from scenegen.buildings.roofs import flat_outline
from scenegen.buildings.styles import Kind, Roof, Style
from scenegen.classes import Semantic
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import Part
from scenegen.geometry.placement import first_come, rectangles
from scenegen.geometry.template import Template, place

_EDGE_M = 0.9
_STACKS_APART_M = 1.5
_STACK_M = (0.9, 0.6, 2.1)
_ABOVE_ROOF = 0.75
"""Height of the sites of a stack's sides, in stack heights: the middle of what stands above the ridge."""


@dataclass(frozen=True, eq=False)
class _Model:
    """A kind of roof equipment: its template and how it is drawn."""

    template: Template
    size_m: tuple[tuple[float, float], tuple[float, float], tuple[float, float]]
    weight: float
    slots: tuple[str, ...]


def _air_handler() -> Template:
    model = Modeller()
    model.box((-0.5, -0.5, 0.12), (0.5, 0.5, 0.85), 0, Semantic.ROOF_EQUIPMENT, covered=True)
    _lid(model, 0.85)
    for x in (-0.25, 0.25):
        model.tube(
            np.array([x, 0, 0.8]), np.array([x, 0, 0.89]), 0.17, 0.17, 0, Semantic.ROOF_EQUIPMENT, sides=8
        )
        _disc(model, x, 0.88)
    return model.finish()


def _disc(model: Modeller, x: float, level: float) -> None:
    """A fan that fills its tube: between the two one would look into the handler."""
    angle = np.pi / 4 * np.arange(8)
    rim = np.column_stack([x + 0.17 * np.sin(angle), -0.17 * np.cos(angle), np.full(8, level)])
    faces = np.array([[0, k, k + 1] for k in range(1, 7)])
    site = model.site(np.array([x, 0.0, level]), np.array([0.0, 0.0, 1.0]))
    model.mesh(rim, faces, 1, Semantic.ROOF_EQUIPMENT, np.full(faces.shape, site))


def _lid(model: Modeller, top: float) -> None:
    """The upper side of a handler, its sites in the corners: the middle looks against the fans."""
    corners = np.array([[-0.5, -0.5, top], [0.5, -0.5, top], [0.5, 0.5, top], [-0.5, 0.5, top]])
    inward = np.array([0.92, 0.8, 1.0])
    sites = np.array([model.site(c * inward, np.array([0.0, 0.0, 1.0])) for c in corners])
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    model.mesh(corners, faces, 0, Semantic.ROOF_EQUIPMENT, sites[faces])


def _vent() -> Template:
    model = Modeller()
    model.tube(np.zeros(3), np.array([0, 0, 0.8]), 0.32, 0.32, 0, Semantic.ROOF_EQUIPMENT, sides=8)
    model.tube(np.array([0, 0, 0.75]), np.array([0, 0, 1.0]), 0.5, 0.12, 0, Semantic.ROOF_EQUIPMENT, sides=8)
    return model.finish()


def _house() -> Template:
    model = Modeller()
    model.box((-0.5, -0.5, 0), (0.5, 0.5, 1), 0, Semantic.ROOF_EQUIPMENT, covered=True)
    model.box((-0.54, -0.54, 1), (0.54, 0.54, 1.06), 1, Semantic.ROOF_EQUIPMENT)
    return model.finish()


def _skylight() -> Template:
    model = Modeller()
    model.box((-0.5, -0.5, 0), (0.5, 0.5, 0.5), 0, Semantic.ROOF_EQUIPMENT, covered=True)
    a, b = 0.5, 0.5
    panes = [
        [[-a, -a, b], [a, -a, b], [a, 0, 1], [-a, 0, 1]],
        [[a, a, b], [-a, a, b], [-a, 0, 1], [a, 0, 1]],
        [[a, -a, b], [a, a, b], [a, 0, 1], [a, 0, 1]],
        [[-a, a, b], [-a, -a, b], [-a, 0, 1], [-a, 0, 1]],
    ]
    model.quads(np.array(panes, np.float64), 1, Semantic.WINDOW)
    return model.finish()


_MODELS = (
    _Model(_air_handler(), ((1.6, 4.5), (1.2, 2.4), (1.2, 2.2)), 0.34, ("unit", "unit")),
    _Model(_vent(), ((0.5, 1.0), (0.5, 1.0), (0.7, 1.5)), 0.34, ("metal",)),
    _Model(_house(), ((3.0, 5.5), (2.6, 4.0), (2.2, 3.2)), 0.12, ("wall", "roof")),
    _Model(_skylight(), ((1.6, 4.0), (1.0, 1.6), (0.5, 0.9)), 0.20, ("metal", "glass")),
)


@dataclass(frozen=True, eq=False)
class RoofGear:
    """Drawn equipment: parts, and the plan of each piece (rectangles) so that no roof sites lie below."""

    parts: tuple[Part, ...]
    plans: np.ndarray


def draw_roof_gear(buildings: Sequence[Building], rng: np.random.Generator) -> RoofGear:
    """Equip all flat roofs, and put chimneys on pitched ones."""
    roofs = [(b, f) for b in buildings for v in b.volumes if (f := flat_outline(b, v)) is not None]
    area = np.array([f[0].area for _, f in roofs])
    rate = np.where([b.kind in (Kind.OFFICE, Kind.TOWER, Kind.SHED) for b, _ in roofs], 1 / 60.0, 1 / 110.0)
    roof = np.repeat(np.arange(len(roofs)), rng.poisson(area * rate) + 1)
    bounds = shapely.bounds(np.array([f[0] for _, f in roofs], dtype=object))[roof]
    centre = bounds[:, :2] + rng.uniform(size=(len(roof), 2)) * (bounds[:, 2:] - bounds[:, :2])
    model = rng.choice(len(_MODELS), len(roof), p=[m.weight for m in _MODELS])
    ranges = np.array([m.size_m for m in _MODELS])[model]
    size = ranges[..., 0] + rng.uniform(size=(len(roof), 3)) * (ranges[..., 1] - ranges[..., 0])
    heading = np.array([_heading(b) for b, _ in roofs])[roof] + 0.5 * np.pi * rng.integers(0, 2, len(roof))
    plans = rectangles(centre, size[:, 0] + 2 * _EDGE_M, size[:, 1] + 2 * _EDGE_M, heading)
    outlines = np.array([f[0] for _, f in roofs], dtype=object)[roof]
    keep = shapely.contains(outlines, plans)
    keep[np.flatnonzero(keep)] = first_come(plans[keep])
    height = np.array([f[1] for _, f in roofs])[roof]
    parts = []
    for k, kind in enumerate(_MODELS):
        mine = np.flatnonzero(keep & (model == k))
        owners = [roofs[int(roof[i])][0] for i in mine]
        skins = np.array([[_skin(b.style, s) for s in kind.slots] for b in owners], np.int64)
        position = np.column_stack([centre[mine], height[mine] - 0.02])
        objects = np.array([b.object for b in owners], np.int64)
        parts.append(
            place(
                kind.template,
                position,
                heading[mine],
                size[mine],
                skins.reshape(-1, len(kind.slots)),
                objects,
            )
        )
    chimneys, stacks = _chimneys(buildings, rng)
    occupied = shapely.buffer(plans[keep], -0.5 * _EDGE_M, join_style="mitre")
    return RoofGear((*parts, *chimneys), np.concatenate([occupied, stacks]))


def _skin(style: Style, slot: str) -> int:
    """Palette index of a slot."""
    value = getattr(style, slot)
    return style.metal if value is None else int(value)


def _heading(building: Building) -> float:
    side = building.volumes[0].rings[0]
    step = np.roll(side, -1, axis=0) - side
    longest = step[int(np.argmax(np.linalg.norm(step, axis=1)))]
    return float(np.arctan2(longest[1], longest[0]))


def _chimneys(buildings: Sequence[Building], rng: np.random.Generator) -> tuple[list[Part], np.ndarray]:
    """One or two stacks near the ridge of gables and hips, and their plans."""
    model = Modeller()
    model.box((-0.5, -0.5, 0), (0.5, 0.5, 1), 0, Semantic.CHIMNEY)
    stack = model.finish()
    middle = np.where(stack.site_normal[:, 2] < 0.5, _ABOVE_ROOF, 1.0)
    stack = replace(stack, site_position=np.column_stack([stack.site_position[:, :2], middle]))
    rows, skins, objects = [], [], []
    for building in buildings:
        volume = building.volumes[0]
        if volume.form not in (Roof.GABLE, Roof.HIP) or building.kind is Kind.SHED:
            continue
        ring = volume.rings[0]
        heading = _heading(building)
        along = np.array([np.cos(heading), np.sin(heading)])
        sides = np.sort(np.linalg.norm(np.roll(ring, -1, axis=0) - ring, axis=1))
        ridge = volume.eave_m(building.style) + sides[0] / 2 * building.style.roof_slope
        reach = max(sides[-1] / 2 - sides[0] / 2, 0.4) * 0.8
        places = rng.uniform(-reach, reach, int(rng.integers(1, 3)))
        for place_m in places[: 1 + int(np.ptp(places) > _STACKS_APART_M)]:
            xy = ring.mean(axis=0) + along * place_m
            rows.append([*xy, ridge - 0.9, heading])
            skins.append([building.style.wall])
            objects.append(building.object)
    if not rows:
        return [], np.zeros(0, dtype=object)
    table = np.array(rows)
    scale = np.tile([_STACK_M], (len(table), 1))
    plans = rectangles(table[:, :2], scale[:, 0], scale[:, 1], table[:, 3])
    return [place(stack, table[:, :3], table[:, 3], scale, np.array(skins), np.array(objects))], plans
