"""The audit finds what floats, lies buried, stands in a house or in another thing, and nothing else."""

from __future__ import annotations

import pytest

from scenegen.classes import Semantic
from scenegen.materials.material import Surface
from scenegen.materials.table import material
from scenegen_render.audit import Audit, audit
from scenegen_render.reference_scenes import Patch, world_of
from scenegen_render.scene import load

_GROUND, _HOUSE, _CAR = 1, 2, 10


def _box(
    low: tuple[float, float, float], high: tuple[float, float, float], semantic: Semantic, owner: int
) -> list[Patch]:
    """Four sides and a lid, looking outwards."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    dx, dy, dz = x1 - x0, y1 - y0, z1 - z0
    up = (0.0, 0.0, dz)
    sides = (
        ((x0, y0, z0), (dx, 0.0, 0.0), up),
        ((x1, y0, z0), (0.0, dy, 0.0), up),
        ((x1, y1, z0), (-dx, 0.0, 0.0), up),
        ((x0, y1, z0), (0.0, -dy, 0.0), up),
        ((x0, y0, z1), (dx, 0.0, 0.0), (0.0, dy, 0.0)),
    )
    return [Patch(corner, along, rise, (1, 1), 0, semantic, owner) for corner, along, rise in sides]


def _audited(*cars: tuple[tuple[float, float, float], tuple[float, float, float]]) -> Audit:
    row = material("asphalt_aged")
    patches = [
        Patch((-50.0, -50.0, 0.0), (100.0, 0.0, 0.0), (0.0, 100.0, 0.0), (1, 1), 0, Semantic.ROAD, _GROUND),
        *_box((10.0, 10.0, -0.3), (30.0, 30.0, 8.0), Semantic.WALL, _HOUSE),
    ]
    for k, (low, high) in enumerate(cars):
        patches += _box(low, high, Semantic.CAR, _CAR + k)
    return audit(load(world_of("audit", patches, (Surface(row, row.emissivity, row.solar_absorptance),))))


def _told(found: Audit) -> list[tuple[str, int]]:
    return [(f.problem, f.object) for f in found.findings]


def test_things_in_their_places_pass() -> None:
    found = _audited(((0.0, 0.0, -0.02), (4.0, 2.0, 1.4)), ((0.0, 3.0, 0.02), (4.0, 5.0, 1.4)))
    assert found.clean and found.objects == 4


@pytest.mark.parametrize(
    ("low", "high", "problem"),
    [
        ((0.0, 0.0, 1.0), (4.0, 2.0, 2.4), "floating"),
        ((0.0, 0.0, -3.0), (4.0, 2.0, -1.0), "buried"),
        ((18.0, 18.0, 0.0), (22.0, 20.0, 1.4), "inside a building"),
    ],
)
def test_each_fault_is_found(
    low: tuple[float, float, float], high: tuple[float, float, float], problem: str
) -> None:
    assert (problem, _CAR) in _told(_audited((low, high)))


def test_what_stands_on_a_floating_thing_floats_too() -> None:
    found = _audited(((0.0, 0.0, 1.0), (4.0, 2.0, 2.4)), ((0.0, 0.0, 2.4), (4.0, 2.0, 3.4)))
    assert [t for t in _told(found) if t[0] == "floating"] == [("floating", _CAR), ("floating", _CAR + 1)]


def test_of_two_things_in_one_place_the_later_is_named() -> None:
    found = _audited(((0.0, 0.0, 0.0), (4.0, 2.0, 1.4)), ((1.0, 0.5, 0.0), (5.0, 2.5, 1.4)))
    assert _told(found) == [("overlapping", _CAR + 1)]
    assert found.findings[0].semantic == "car"
