"""Cars: bodies lofted from side profiles, with glass, tyres and a bonnet that may be warm."""

from __future__ import annotations

import numpy as np

from scenegen.classes import Semantic
from scenegen.geometry.modelling import Modeller
from scenegen.geometry.part import LUMP_STANDOFF_M
from scenegen.geometry.template import Template

PAINT, GLASS, RUBBER = 0, 1, 2
"""Surface slots of a car."""

LENGTH_M, WIDTH_M = 4.4, 1.8
"""Size of a car of scale one."""

_RIM = 8

_PROFILES = {
    # rear end, (feet of rear screen, roof's rear and front, foot of windscreen), heights of belt, roof, nose
    "saloon": (-2.2, (-1.75, -0.95, 0.35, 1.05), 0.92, 1.43, 0.72),
    "estate": (-2.2, (-2.1, -1.8, 0.35, 1.05), 0.94, 1.47, 0.74),
    "hatch": (-1.95, (-1.9, -1.35, 0.45, 1.1), 0.95, 1.50, 0.76),
    "van": (-2.35, (-2.3, -2.25, 1.2, 1.85), 1.15, 2.0, 0.95),
}
BODIES = tuple(_PROFILES)
"""Names of the body styles."""


def rear_m(body: str) -> float:
    """Where the rear bumper of a body style lies along its length [m], negative; its front is at half its length."""
    return _PROFILES[body][0]


def car(body: str) -> Template:
    """A car of one body style, wheels on z = 0, facing +x."""
    rear, (foot, back, front, screen), belt, roof, nose = _PROFILES[body]
    half, tuck, tip = WIDTH_M / 2, 0.17, LENGTH_M / 2
    model = Modeller()
    sill = 0.28
    lower = [(rear, sill), (tip, sill), (tip, nose), (screen, belt), (foot, belt), (rear, belt - 0.06)]
    cabin = [(screen, belt), (front, roof), (back, roof), (foot, belt)]

    def point(x: float, z: float, side: float, inset: float = 0.0) -> list[float]:
        return [x, side * (half - inset), z]

    def strip(
        a: tuple[float, float], b: tuple[float, float], slot: int, inset_a: float, inset_b: float
    ) -> None:
        quad = [point(*a, -1, inset_a), point(*a, 1, inset_a), point(*b, 1, inset_b), point(*b, -1, inset_b)]
        model.quads(np.array([quad]), slot, Semantic.CAR)

    strip(lower[1], lower[2], PAINT, 0, 0)
    strip(lower[2], lower[3], PAINT, 0, 0)
    strip(lower[4], lower[5], PAINT, 0, 0)
    strip(lower[5], lower[0], PAINT, 0, 0)
    strip(cabin[0], cabin[1], GLASS, 0.0, tuck)
    strip(cabin[1], cabin[2], PAINT, tuck, tuck)
    strip(cabin[2], cabin[3], GLASS if body != "van" else PAINT, tuck, 0.0)
    for side in (-1.0, 1.0):
        ring = np.array([point(x, z, side) for x, z in lower])
        fan = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]])
        glass = np.array([[point(x, z, side, 0.0 if z == belt else tuck) for x, z in cabin]])
        if side > 0:
            fan, glass = fan[:, ::-1], glass
        else:
            glass = glass[:, ::-1]
        site = model.site(np.array([0.0, side * half, 0.6]), np.array([0.0, side, 0.0]))
        model.mesh(ring, fan.astype(np.int64), PAINT, Semantic.CAR, np.full(fan.shape, site))
        model.quads(
            _orient(glass, np.array([0.0, side, 0.3])), GLASS if body != "van" else PAINT, Semantic.CAR
        )
    _wheels(model, half, rear)
    return model.finish()


def _orient(quads: np.ndarray, outward: np.ndarray) -> np.ndarray:
    """Turn quads whose normal points inwards."""
    normal = np.cross(quads[:, 1] - quads[:, 0], quads[:, 2] - quads[:, 0])
    return np.where(((normal * outward).sum(axis=1) < 0)[:, None, None], quads[:, ::-1], quads)


def _wheels(model: Modeller, half: float, rear: float) -> None:
    """Four wheels; the two of a side share a site between them, just outside the body, that looks sideways."""
    flank = half + 0.02
    site = {
        side: model.site(np.array([0.0, side * flank, 0.31]), np.array([0.0, side, 0.0]), LUMP_STANDOFF_M)
        for side in (-1.0, 1.0)
    }
    angle = 2 * np.pi * np.arange(_RIM) / _RIM
    rim = np.column_stack([np.cos(angle), np.sin(angle)]) * 0.31
    for x in (rear + 0.75, 1.4):
        for side in (-1.0, 1.0):
            y0, y1 = side * (half - 0.2), side * flank
            inner = np.column_stack([x + rim[:, 0], np.full(_RIM, y0), 0.31 + rim[:, 1]])
            outer = np.column_stack([x + rim[:, 0], np.full(_RIM, y1), 0.31 + rim[:, 1]])
            k, after = np.arange(_RIM), (np.arange(_RIM) + 1) % _RIM
            tread = np.stack([k, after, after + _RIM, k + _RIM], axis=1)[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
            disc = _RIM + np.stack([0 * k[2:], k[1:-1], k[2:]], axis=1)
            faces = np.concatenate(
                [tread if side < 0 else tread[:, ::-1], disc[:, ::-1] if side > 0 else disc]
            )
            model.mesh(
                np.concatenate([inner, outer]), faces, RUBBER, Semantic.CAR, np.full(faces.shape, site[side])
            )
