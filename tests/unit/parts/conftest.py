"""A bare workshop on level or sloping ground, and what the tests ask of templates."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from scenegen.climate.season import Season
from scenegen.geometry.builder import GeometryBuilder
from scenegen.geometry.part import Part, face_normals
from scenegen.geometry.template import Template
from scenegen.materials.palette import PaletteBuilder
from scenegen.parts.workshop import Workshop

JULY = Season(50.0, 7, 1)


def flat(xy: np.ndarray) -> np.ndarray:
    return np.zeros(len(xy))


@pytest.fixture
def workshop() -> Callable[..., Workshop]:
    def make(relief=flat, season: Season = JULY, seed: int = 0) -> Workshop:
        return Workshop(relief, PaletteBuilder(np.random.default_rng(seed)), GeometryBuilder(), season)

    return make


@pytest.fixture
def row() -> Callable[[int], np.ndarray]:
    """Places ten metres apart."""
    return lambda count: np.column_stack([10.0 * np.arange(count), np.zeros((count, 2))])


def facing_inside(template: Template, slots: tuple[int, ...]) -> float:
    """Share of the area of some slots whose outward rays next meet a face from behind: turned or buried faces."""
    corner = template.vertices[template.faces]
    normal, area = face_normals(template.vertices, template.faces)
    a = corner[:, 0]
    u, v = corner[:, 1] - a, corner[:, 2] - a
    mine = np.flatnonzero(np.isin(template.slot, slots))
    bad = np.zeros(len(area), bool)
    for i in mine:
        start, ray = corner[i].mean(axis=0) + 1e-4 * normal[i], normal[i]
        across = np.cross(ray, v)
        with np.errstate(divide="ignore", invalid="ignore"):
            det = (u * across).sum(axis=1)
            s = ((start - a) * across).sum(axis=1) / det
            q = np.cross(start - a, u)
            t, far = q @ ray / det, (v * q).sum(axis=1) / det
            hit = (s >= 0) & (t >= 0) & (s + t <= 1) & (far > 1e-6)
        if hit.any():
            first = np.flatnonzero(hit)[np.argmin(far[hit])]
            bad[i] = normal[first] @ ray > 0.01
    return float(area[bad].sum() / area[mine].sum())


@pytest.fixture(name="facing_inside")
def _facing_inside() -> Callable[[Template, tuple[int, ...]], float]:
    return facing_inside


def same(first: list[Part], second: list[Part]) -> bool:
    """Whether parts agree to the byte."""
    names = vars(first[0]).keys()
    pairs = zip(first, second, strict=True)
    return all(np.array_equal(getattr(a, n), getattr(b, n)) for a, b in pairs for n in names)


@pytest.fixture(name="same")
def _same() -> Callable[[list[Part], list[Part]], bool]:
    return same
